"""The whole report of a run, or of several: one file, nothing of it from outside, the same bytes for the same runs."""

import base64
import hashlib
import json
import shlex
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from importlib import import_module, resources
from pathlib import Path
from typing import Final

import numpy as np

from tol3d.errors import InputError, RunError, SceneError
from tol3d.report.bars import Bars, bars_of
from tol3d.report.chart import Charts
from tol3d.report.column import shares_of, unexplained_words
from tol3d.report.compare import difference_of, measures_of
from tol3d.report.heading import WORST_FIRST, shown_measures
from tol3d.report.html.blocks import CARDS, Inside, Markup, page_blocks, tag, together
from tol3d.report.html.svg import figure, illustrated
from tol3d.report.joint import correlation_blocks
from tol3d.report.measure_charts import chart_of
from tol3d.report.page import Page, Table, note, warning
from tol3d.report.presenter import Display, Presenter, Which, presenter_of
from tol3d.report.report_sections import (
    CORRELATIONS,
    MEASURES,
    MORE,
    PROVENANCE,
    RUNS,
    TRIALS,
    VERDICT,
    compared_blocks,
    more_blocks,
    provenance_blocks,
    runs_blocks,
    trials_blocks,
)
from tol3d.report.share_charts import FEWEST, Shares, matrix, pareto, shares_in
from tol3d.report.shown_unit import shown_run
from tol3d.report.table import meanings, measure_blocks
from tol3d.report.trial_charts import convergence, convergence_of, differences, shown_runs
from tol3d.report.verdict import accepted_text, verdict_report
from tol3d.scene.place import plain
from tol3d.scene.text import scene_text
from tol3d.study.runs.run import Run
from tol3d.study.runs.summary.judged import Accepted, JudgedMeasure, demand_of
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.system.outcome import value_column

VIEW_3D: Final = "tol3d.report.html.view_3d"  # loads VTK, a hundred megabytes
TRIALS_A_BAR: Final = 5
MOST_READ: Final = 200_000
"""Trials searched for those of each bar."""
POLICY: Final = (
    "default-src 'none'; script-src {scripts}; style-src 'sha256-{style}'; img-src data:; base-uri 'none'; "
    "form-action 'none'"
)
NOT_TOGETHER: Final = (
    "no 3D view of several runs, whose parts would stand in each other: tol3d report RUN shows those of one"
)
POINTS: Final = 48
"""Numbers of trials at which a convergence is drawn."""
MATRIX: Final = "share of the variance [%]"
VERDICTS: Final = {"ok": "OK", "not-ok": "NOT OK", "open": "too few trials to say", "none": "no limits to judge"}


def report_html(
    runs: Sequence[Run],
    *,
    accepted: Accepted | None = None,
    analyses: Mapping[str, Page] | None = None,
    charts: Mapping[str, Charts] | None = None,
    shares: Mapping[str, Shares] | None = None,
    best: str = "",
    trials: Sequence[int] = (),
    in_3d: bool = True,
    missing: Sequence[str] = (),
    made: str = "",
) -> str:
    """One run, or several beside each other, as a page.

    Args:
        runs: finished ones.
        accepted: what is asked of a measure; default: what the study asks.
        analyses: sections of the first run by their titles.
        charts: of sections that have them.
        shares: of contributors [%] by measure, of sections that show these instead.
        best: change to the first run's scene, in a line; "" for none.
        trials: of the first run, that the 3D view has besides its nominal and its worst build.
        in_3d: True to show the first run's parts in 3D.
        missing: what is left out, and why.
        made: when and where, the one element that differs between two reports of the same runs in the same place.

    Raises:
        InputError: no run, or runs that share no measure.
        RunError: a run was changed since it was made.
    """
    first = runs[0].found if runs else None
    if first is None:
        raise InputError("nothing to report: give the folder of at least one run")
    body = [tag("h1", first.scene), *_head(runs[0]), *(tag("p", own, class_="warning") for own in missing)]
    kept = _kept(analyses or {}, charts or {}, shares or {})
    body += (
        [*_compared(runs)] if len(runs) > 1 else [*_single(runs[0], accepted, best, kept, trials if in_3d else None)]
    )
    body.append(tag("footer", tag("p", made, class_="note", id="made")))
    return _document(first.scene, body)


def moving_page(
    run: Run, display: Display, which: Which, *, motion: str | None = None, frames: int | None = None
) -> str:
    """A build in motion, as a page.

    Args:
        run: whose.
        display, which, motion, frames: see `moving_3d`.

    Raises:
        InputError: no such motion, or none that a page can show.
    """
    moving: Markup = import_module(VIEW_3D).moving_3d(run, display, which, motion, frames)
    scene = run.found.scene
    return _document(scene, [tag("h1", f"{scene}, {display.label}"), moving])


def _head(run: Run) -> Iterator[Markup]:
    found = run.found
    trials = f"{found.trials} trial{'' if found.trials == 1 else 's'}"
    yield tag("p", f"{trials} · seed {found.seed} · engine {found.engine}", class_="dim")
    if description := _described(run):
        yield tag("p", description)


def _described(run: Run) -> str:
    """Description of the scene in its own words."""
    try:
        node, _ = scene_text(run.scene_path, run.scene_path.read_bytes())
        found = plain(node).get("description")
    except (SceneError, RunError, OSError, AttributeError):
        return ""
    return found.strip() if isinstance(found, str) else ""


# one run ------------------------------------------------------------------------------------------


def _single(
    run: Run, accepted: Accepted | None, best: str, kept: Mapping[str, Markup], trials: Sequence[int] | None
) -> Iterator[Markup]:
    found, shown, presenter = run.found, shown_run(run.found), _presenter(run.found)
    asked = demand_of(found.study.accept_ppk, accepted)
    sections: dict[str, Inside] = {VERDICT: together(_badge(shown, asked), _verdict(shown, asked, best))}
    sections[MEASURES] = together(*_measures(run, shown, presenter))
    if own := page_blocks(more_blocks(found, presenter)):
        sections[MORE] = own
    if len(shares := shares_in(shown)) >= FEWEST:
        sections["which tolerance matters where"] = _matrix(shares)
    if pairs := page_blocks(correlation_blocks(found)):
        sections[CORRELATIONS] = pairs
    sections |= kept
    if trials is not None:
        sections["in 3D"] = import_module(VIEW_3D).view_3d(run, presenter, trials)
    sections[TRIALS] = together(*_trials(shown))
    sections[PROVENANCE] = page_blocks(provenance_blocks(run))
    anchors = {name: f"section-{number}" for number, name in enumerate(sections)}
    yield tag("nav", tag("ul", *(tag("li", tag("a", name, href=f"#{own}")) for name, own in anchors.items())))
    for name, inside in sections.items():
        yield tag("section", tag("h2", name), inside, id=anchors[name])


def _kept(
    analyses: Mapping[str, Page], charts: Mapping[str, Charts], shares: Mapping[str, Shares]
) -> Mapping[str, Markup]:
    """Sections of analyses, with their charts, or the matrix of contributors and measures where they have one."""
    found = dict[str, Markup]()
    for title, page in analyses.items():
        own = shares.get(title)
        if own is None:
            found[title] = illustrated(page, charts.get(title, Charts(())))
        else:
            found[title] = together(page_blocks(page.blocks), _matrix(own) if len(own) >= FEWEST else None)
    return found


def _matrix(shares: Shares) -> Markup:
    return figure(matrix(shares, MATRIX), note=MATRIX)


def _presenter(run: RunSummary) -> Presenter:
    """Presenter of the run's system; one that adds nothing if its mechanism is not installed here."""
    return presenter_of(run)


def _badge(run: RunSummary, accepted: Accepted) -> Markup:
    verdicts = {JudgedMeasure.of(measure, accepted).verdict for measure in run.measures.values()}
    kind = "not-ok" if "NOT OK" in verdicts else "open" if "too few trials" in verdicts else "ok"
    kind = "none" if verdicts == {"no limits"} else kind
    return tag("p", VERDICTS[kind], class_=f"verdict {kind}")


def _verdict(run: RunSummary, accepted: Accepted, best: str) -> Markup:
    blocks = verdict_report(run, accepted, blame=True)
    asked = tag("p", f"accepted: {accepted_text(accepted, run.measures.values())}", class_="dim")
    advice = [tag("p", f"what to change: {best}", class_="advice")] if best else []
    return together(asked, *advice, page_blocks([*map(warning, run.warnings), *blocks[1:]], narrow=CARDS))


def _measures(run: Run, shown: RunSummary, presenter: Presenter) -> Iterator[Markup]:
    names = shown_measures(shown.measures)
    if len(names) < len(shown.measures):
        yield tag("p", f"the {len(names)} worst of {len(shown.measures)} measures {WORST_FIRST}", class_="note")
    for number, name in enumerate(names):
        measure = shown.measures[name]
        blocks = measure_blocks(name, measure, shown, presenter)
        first = next((k for k, own in enumerate(blocks) if isinstance(own, Table)), len(blocks))
        yield page_blocks(blocks[:first])
        trials = [*_bar_trials(run, name, measure, number)]
        yield figure(chart_of(name, measure), *trials, data_trials=f"trials-{number}" if trials else None)
        yield page_blocks(blocks[first:], 4)
        if measure.take != "curve" and any(own.method != "published" for own in shares_of(measure)):
            yield figure(pareto(measure), note=unexplained_words(measure))
        if run.keeps_trials and (found := difference_of(run, name)) and measure.unit == run.found.measures[name].unit:
            yield figure(differences(name, measure.unit, [(shown_runs([run])[0], found)]))
        yield from _convergence(run, name, measure)
    yield page_blocks(map(note, meanings(shown)))


def _convergence(run: Run, name: str, measure: MeasureSummary) -> Iterator[Markup]:
    """Convergence of mean and sigma; nothing for a curve, for few trials, and for a run that kept none."""
    try:
        found = convergence_of(run, name, POINTS)
    except (InputError, RunError):
        return
    yield figure(convergence(name, measure, found, _factor(run, name, measure)))


def _factor(run: Run, name: str, measure: MeasureSummary) -> float:
    """From the unit of the run's columns to the one in which a measure is shown."""
    return 1.0 if run.found.measures[name].unit == measure.unit else 1e-3


def _bar_trials(run: Run, name: str, measure: MeasureSummary, number: int) -> Iterator[Markup]:
    """The first kept trials of each bar as data, and the place where they are listed."""
    if measure.take == "curve" or not run.keeps_trials or not bars_of(measure):
        return
    column = value_column(measure.best_method, name)
    bars = _first_trials(run, column, bars_of(measure)[measure.best_method], _factor(run, name, measure))
    data = {"run": _as_argument(run.path), "bars": bars}
    text = json.dumps(data, sort_keys=True).replace("<", "\\u003c")
    yield tag("script", Markup(text), type="application/json", id=f"trials-{number}")
    yield tag("p", "Click a bar to list trials in it.", class_="picked note")


def _as_argument(folder: Path) -> str:
    """A run's folder as an argument of a command, quoted for a shell: as it was given, or from the current folder.

    >>> _as_argument(Path("runs/two plates")), _as_argument(Path("-v"))
    ("'runs/two plates'", './-v')
    """
    here = Path.cwd()
    text = str(folder.relative_to(here) if folder.is_absolute() and folder.is_relative_to(here) else folder)
    return shlex.quote(f"./{text}" if text.startswith("-") else text)


def _first_trials(run: Run, column: str, bars: Bars, factor: float) -> Mapping[str, list[int]]:
    found: dict[int, list[int]] = {}
    first = 0
    for piece in run.pieces(column):
        values = np.asarray(piece[column], dtype=np.float64) * factor
        places = np.searchsorted(bars.edges, values, side="right") - 1
        for bar in range(len(bars.counts)):
            own = found.setdefault(bar, [])
            room = TRIALS_A_BAR - len(own)
            own += (first + np.flatnonzero(places == bar)[:room]).tolist() if room else []
        first += len(values)
        if first >= MOST_READ:
            break
    return {str(bar): own for bar, own in found.items() if own}


def _trials(run: RunSummary) -> Iterator[Markup]:
    """Numbers of trials by status, with reasons."""
    yield page_blocks(trials_blocks(run))
    if run.witness:
        words = f"witness: {run.witness.engine.upper()} measured {run.witness.trials} of these trials again"
        yield tag("p", f"{words}; what it found stands with each measure", class_="note")


# several runs -------------------------------------------------------------------------------------


def _compared(runs: Sequence[Run]) -> Iterator[Markup]:
    """Runs of one scene, or of scenes that share measures, beside each other."""
    blocks = compared_blocks(runs)
    yield tag("section", tag("h2", RUNS), page_blocks(runs_blocks(runs)), id="section-0")
    yield tag("section", tag("h2", MEASURES), page_blocks(blocks), id="section-1")
    for measure in measures_of(runs):
        for label, run in measure.found_in(runs):
            own = shown_run(run.found).measures[measure.name]
            yield tag("h3", f"{measure.name} · {label}")
            yield figure(chart_of(measure.name, own))
    yield tag("section", tag("h2", "in 3D"), tag("p", NOT_TOGETHER, class_="note"), id="section-2")


# the file -----------------------------------------------------------------------------------------


def _document(name: str, body: Sequence[Inside]) -> str:
    style, scripts = _resource("style.css"), [_resource("script.js")]
    if any('class="view"' in own for own in body if isinstance(own, Markup)):
        scripts.append(_resource("viewer.js"))
    allowed = " ".join(f"'sha256-{_hash_of(script)}'" for script in scripts)
    policy = POLICY.format(scripts=allowed, style=_hash_of(style))
    head = tag(
        "head",
        tag("meta", http_equiv="Content-Security-Policy", content=policy),
        tag("meta", charset="utf-8"),
        tag("meta", name_="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name_="color-scheme", content="light dark"),
        tag("title", f"{name} · tol3d"),
        tag("style", Markup(style)),
    )
    inside = tag("body", tag("main", *body), *(tag("script", Markup(script)) for script in scripts))
    return f"<!doctype html>\n{tag('html', head, inside, lang='en')}\n"


def _hash_of(text: str) -> str:
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


@cache
def _resource(name: str) -> str:
    return resources.files(__package__).joinpath(name).read_text("utf-8")
