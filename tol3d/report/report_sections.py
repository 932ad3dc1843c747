"""Sections of a report: a page shows them between its charts, their tables go into files too."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import count
from typing import Annotated

from tol3d.errors import InputError
from tol3d.report.compare import comparison_report, labelled
from tol3d.report.declared import declared_table
from tol3d.report.heading import MOST_MEASURES, shown_measures
from tol3d.report.joint import correlation_blocks
from tol3d.report.number import number_cell
from tol3d.report.page import Line, Page, PageItem, Table
from tol3d.report.presenter import Presenter, presenter_of
from tol3d.report.published import published_blocks
from tol3d.report.shown_unit import shown_run
from tol3d.report.table import measure_blocks, status_line
from tol3d.report.verdict import verdict_report
from tol3d.study.runs.run import Run
from tol3d.study.runs.summary.judged import Accepted
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.summary.shows import Computed, RowOf, Shows

VERDICT, MORE, CORRELATIONS, TRIALS, PROVENANCE = "verdict", "more", "correlations", "trials", "provenance"
RUNS, MEASURES = "runs", "measures"
WIDE = frozenset((MORE, CORRELATIONS, MEASURES))
"""Sections whose titles say less than those in them."""


@dataclass(frozen=True)
class ReportSection:
    """Lines and tables below a title."""

    title: str
    blocks: tuple[PageItem, ...]


def report_sections(
    runs: Sequence[Run], accepted: Accepted | None = None, analyses: Mapping[str, Page] | None = None
) -> list[ReportSection]:
    """The sections of one run, or of several beside each other.

    Args:
        runs: finished ones.
        accepted: what is asked of a measure; default: what the study asks.
        analyses: sections of the one run by their titles.

    Raises:
        InputError: no run, or runs that share no measure.
    """
    if not runs:
        raise InputError("nothing to report: give the folder of at least one run")
    if len(runs) > 1:
        return [ReportSection(RUNS, tuple(runs_blocks(runs))), ReportSection(MEASURES, tuple(compared_blocks(runs)))]
    (run,) = runs
    shown, presenter = shown_run(run.found), presenter_of(run.found)
    found = [(VERDICT, verdict_report(shown, accepted, blame=True))]
    for name in shown_measures(shown.measures):
        found.append((name, measure_blocks(name, shown.measures[name], shown, presenter)))
    found += [
        (MORE, more_blocks(run.found, presenter)),
        (CORRELATIONS, correlation_blocks(run.found)),
        *((title, [*page.blocks]) for title, page in (analyses or {}).items()),
        (TRIALS, trials_blocks(shown)),
        (PROVENANCE, provenance_blocks(run)),
    ]
    return [ReportSection(title, tuple(blocks)) for title, blocks in found if blocks]


def more_blocks(run: RunSummary, presenter: Presenter) -> list[PageItem]:
    """Further blocks of its system, and published figures."""
    return [*presenter.sections(run), *published_blocks(run)]


@dataclass(frozen=True)
class ReasonRow:
    """Why builds failed, and how many."""

    reason: Annotated[str, Shows("why builds failed", "words")]
    trials: Annotated[int, Shows("trials", "d")]


@dataclass(frozen=True)
class MadeRow:
    """Sources of a run."""

    text: Annotated[str, Shows("", "words")]


class RunRow(RowOf[Run]):
    """One of several runs."""

    scene = Computed(Shows("scene", "words"), lambda own: own.of.found.scene)
    trials = Computed(Shows("trials", "d"), lambda own: own.of.trials)
    seed = Computed(Shows("seed"), lambda own: str(own.of.found.seed))
    engine = Computed(Shows("engine", "words"), lambda own: own.of.found.engine)


def trials_blocks(run: RunSummary) -> list[PageItem]:
    """Numbers of trials by status, with reasons."""
    found: list[PageItem] = [status_line(run)]
    reasons = [
        (name, ReasonRow(reason, count))
        for name, own in run.measures.items()
        for reason, count in (own.reasons or {}).items()
    ]
    if reasons:
        found.append(declared_table("measure", reasons[:MOST_MEASURES]))
    return found


def provenance_blocks(run: Run) -> list[PageItem]:
    """Provenance of a run: seed, engine, checksums, versions."""
    found = run.found
    made = {
        "seed": str(found.seed),
        "sampler": found.study.sampler.replace("_", " "),
        "engine": found.engine,
        "chord error [µm]": number_cell(found.chord_error_um),
        **{f"SHA-256 of {name}": own for name, own in found.files.items()},
        **found.versions,
    }
    return [declared_table("made from", [(name, MadeRow(own)) for name, own in made.items()])]


def runs_blocks(runs: Sequence[Run]) -> list[PageItem]:
    """Which runs are beside each other."""
    return [declared_table("run", [(label, RunRow(run)) for label, run in labelled(runs)])]


def compared_blocks(runs: Sequence[Run]) -> list[PageItem]:
    """The measures of runs beside each other.

    Raises:
        InputError: they share none.
    """
    return [*comparison_report(runs).blocks]


def section_tables(sections: Sequence[ReportSection]) -> Iterator[tuple[str, Table]]:
    """Every table with a name of its own: its section, the title above it, and what sets it apart from others."""
    names = set[str]()
    for section in sections:
        for title, table in _titled(section):
            name = title if not title or section.title in WIDE else f"{section.title} · {title}"
            name = name if title and title != section.title else section.title
            if name in names:
                name = f"{name} · {table.corner}"
            first = name
            for number in count(2):
                if name not in names:
                    break
                name = f"{first} {number}"
            names.add(name)
            yield name, table


def _titled(section: ReportSection) -> Iterator[tuple[str, Table]]:
    """Its tables with the last title above each, "" for none."""
    title = ""
    for block in Page(section.blocks).whole_blocks():
        if isinstance(block, Table):
            yield title, block
        elif isinstance(block, Line) and block.title:
            title = block.title
