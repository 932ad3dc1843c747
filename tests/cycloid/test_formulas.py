"""The tables of the published formula and first principles, as they are printed."""

from types import SimpleNamespace
from typing import cast

import pytest
from rv_250 import TOLERANCES, rv_250

from tol3d.gearing.cycloid.presenting import PRESENTER
from tol3d.gearing.cycloid.presenting.tables import stage_blocks
from tol3d.gearing.cycloid.reducer.formula import (
    SOURCES,
    PaperSources,
    Source,
    sigma_of,
    stage_by_formula,
    sun_held_factor,
)
from tol3d.report.page import Page, Table
from tol3d.report.presenter import ShowsNotes
from tol3d.study.runs.summary.run import RunSummary

SUN_HELD = sun_held_factor(39, 21, 42)


def page_of(
    sources: tuple[Source, ...] = tuple(TOLERANCES), sun_held: float | None = SUN_HELD, *, by_formula: bool = True
) -> Page:
    """Contributors as drawn by the example's tolerances, and one that the formula does not know."""
    drawn = [(own, effect, sigma_of(own, TOLERANCES[own])) for effect, own in SOURCES.items() if own in sources]
    found = PaperSources.of([*drawn, ("lapped pins", "pin radius", 0.001)])
    return Page(tuple(stage_blocks({"reducer": stage_by_formula(rv_250(), found, sun_held, by_formula=by_formula)})))


@pytest.mark.parametrize(
    ("label", "cells"),
    [
        ("disc run-out", ["12", "10.81", "14.42", "2.4040"]),  # 12/6 um: over 114.5 mm 3.60" a sigma, over 85.8 4.81"
        ("pin circle radius", ["17.5", "22.29", "26.92", "1.5380"]),  # 17.5/3 um: / sqrt 2 over 114.5; x 1.5380
        ("disc pitch", ["10", "18.48", "18.48", "1.8476"]),
        ("main bearing run-out", ["5", "2.00", "6.01", "2.4040"]),
        ("cycloid stage, ±3σ", ["31.138", "36.034"]),
        ("99.73 % half-range of its law", ["33.689", "36.034"]),
        ("carrier, ±3σ", ["6.335", "8.499"]),
        ("both added, as published", ["37.473", "44.534"]),
        ("both, root sum square", ["31.776", "37.023"]),
        ("times 0.96296, sun held", ["", "35.652"]),
    ],
)
def test_published_figures_and_ours_stand_beside_each_other(label: str, cells: list[str]) -> None:
    printed = {row.label.strip(): list(row.cells) for table in page_of().tables for row in table.rows}
    assert printed[label] == cells


def test_what_the_formula_does_not_know_and_that_its_law_is_not_normal_is_said() -> None:
    words = [str(block) for block in page_of().blocks]
    assert any("±3σ covers 99.49 %" in own for own in words)
    assert any("not in the formula: lapped pins" in own for own in words)


def test_a_reducer_driven_at_its_cranks_has_no_line_for_the_sun() -> None:
    labels = [row.label for table in page_of(sun_held=None).tables for row in table.rows]
    assert not any("sun held" in label for label in labels)


def test_a_scene_with_nothing_that_the_formula_knows_has_totals_of_nothing() -> None:
    rows = page_of(()).tables[-1].rows
    assert {cell for row in rows[:5] for cell in row.cells} == {"0.000"}


@pytest.mark.parametrize(
    ("analytic", "geometric", "noted"), [(-0.27, -0.25, True), (0.3, 0.29, False), (None, -1.0, True)]
)
def test_a_lost_motion_below_zero_is_said_to_be_no_play(analytic: float | None, geometric: float, noted: bool) -> None:
    methods = {"analytic": SimpleNamespace(mean=analytic), "geometric": SimpleNamespace(mean=geometric)}
    measures = {
        "play": SimpleNamespace(kind="cycloid_lost_motion", **methods),
        "error": SimpleNamespace(kind="cycloid_transmission_error", **methods),
    }
    presenter = PRESENTER
    assert isinstance(presenter, ShowsNotes)  # on the first screen too
    said = [str(line) for line in presenter.first_notes(cast(RunSummary, SimpleNamespace(measures=measures)))]
    assert [line.strip().startswith("play: negative where pins press on both sides") for line in said] == [True] * noted


def test_the_papers_formula_stands_only_beside_its_published_figures() -> None:
    """Another user's reducer has first principles alone; a run says so by a key that is not there."""
    table, totals = (own for own in page_of(by_formula=False).blocks if isinstance(own, Table))
    assert [own.text for own in table.headings] == ["tolerance [µm]", "first principles [″]", "per µm [″]"]
    assert [row.label for row in totals.rows] == [
        "cycloid stage, ±3σ", "carrier, ±3σ", "both added", "both, root sum square", "  times 0.96296, sun held",
    ]  # fmt: skip
    assert [own.text for own in totals.headings] == ["first principles [″]"]
