"""Form: what it takes of the zone of an axis, a face or a run-out; zones per unit of length and area; axial run-out."""

from pathlib import Path

import numpy as np
import pytest
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray
from scene_texts import refusal
from scipy.optimize import linprog

from tol3d.assembly.zones import ZoneDraw
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]

SHAFT = """scene: shaft
parts:
  shaft:
    kind: solid
    features:
      seat: {kind: cylinder, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 40 mm, diameter: 20 mm}
      nose: {kind: cylinder, at: [0 mm, 0 mm, 70 mm], axis: [0, 0, 1], length: 60 mm, diameter: 30 mm}
      shoulder: {kind: plane, at: [0 mm, 0 mm, 40 mm], normal: [0, 0, -1], radius: 15 mm}
      rail: {kind: plane, at: [0 mm, 30 mm, 70 mm], normal: [0, 1, 0], extent: [60 mm, 20 mm], along: [0, 0, 1]}
      top: {kind: point, at: [0 mm, 0 mm, 100 mm], normal: [0, 0, 1]}
tolerances:
EXTRA
moves:
  bench: {kind: fix, part: shaft}
measures:
  off: {kind: inspected_position, of: shaft.nose, datums: [seat]}
  askew: {kind: inspected_orientation, of: shaft.shoulder, datums: [seat]}
  height: {kind: gap, from: shaft.top, to: shaft.rail, along: [0, 1, 0]}
"""
UNIFORM = "law: {kind: uniform}"
RUN_OUT = (
    f"  run-out: {{kind: circular_run_out, of: shaft.nose, zone: {{width: 0.05 mm}}, {UNIFORM}, datums: [seat]}}\n"
)
TOTAL = RUN_OUT.replace("circular", "total")
POSITION = f"  place: {{kind: position, of: shaft.nose, zone: {{diameter: 0.1 mm}}, {UNIFORM}, datums: [seat]}}\n"
PROFILE = f"  rail: {{kind: profile, of: shaft.rail, zone: {{width: 0.2 mm}}, {UNIFORM}}}\n"
AXIAL = f"  wobble: {{kind: axial_run_out, of: shaft.shoulder, zone: {{width: 0.03 mm}}, {UNIFORM}, datums: [seat]}}\n"


def form(kind: str, zone: str, of: str = "nose", more: str = "", name: str = "") -> str:
    return f"  {name or kind}: {{kind: {kind}, of: shaft.{of}, zone: {{{zone}}}{more}}}\n"


ROUND, CYLINDER = form("roundness", "width: 0.01 mm"), form("cylindricity", "width: 0.02 mm")
LINES, BENT = form("straightness", "width: 0.015 mm"), form("straightness", "diameter: 0.012 mm", name="bend")
FLAT = form("flatness", "width: 0.004 mm", "shoulder")


def made_of(text: str, folder: Path) -> Assembled:
    return assembled(SHAFT.replace("EXTRA\n", text), folder)


def left(made: Assembled) -> float:
    """The rest of a width [mm]: twice the half width of the first zone."""
    (draw, *_) = (own.draw for own in made.system.contributors if isinstance(own.draw, ZoneDraw))
    return 2.0 * draw.zone.half


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (POSITION + ROUND, 0.1),  # a round section moves no axis
        (POSITION + CYLINDER, 0.08),  # between two cylinders the axis may bend so far
        (POSITION + LINES, 0.085),  # and with the lines of the surface
        (POSITION + BENT, 0.088),
        (POSITION + CYLINDER + LINES + BENT + ROUND, 0.088),  # the narrowest of those that hold the bend
        (RUN_OUT, 0.05),
        (RUN_OUT + ROUND, 0.04),  # the dial reads the section's form
        (RUN_OUT + CYLINDER, 0.03),  # which is no rounder than that
        (RUN_OUT + ROUND + CYLINDER, 0.04),
        (RUN_OUT + LINES, 0.05),  # lines along the axis are not seen at one section
        (TOTAL + CYLINDER + ROUND, 0.03),
        (TOTAL + ROUND + LINES, 0.025),  # both together make up the surface
        (PROFILE + form("straightness", "width: 0.03 mm", "rail", ", lines: x"), 0.17),
        (PROFILE + form("flatness", "width: 0.02 mm", "rail"), 0.18),
        # each piece of 20 mm within 0.01 mm: 60 mm bow by 9 times as much
        (PROFILE + form("straightness", "width: 0.01 mm", "rail", ", lines: x, per: 20 mm"), 0.11),
        (PROFILE + form("straightness", "width: 0.01 mm", "rail", ", lines: y, per: 20 mm"), 0.19),
        (PROFILE + form("flatness", "width: 0.01 mm", "rail", ", per: [30 mm, 10 mm]"), 0.16),
        (
            PROFILE
            + form("flatness", "width: 0.01 mm", "rail", ", per: [20 mm, 20 mm]")
            + form("flatness", "width: 0.05 mm", "rail", name="whole"),
            0.15,
        ),
        (POSITION + form("straightness", "diameter: 0.01 mm", more=", per: 30 mm"), 0.06),
    ],
)
def test_form_takes_of_a_zone_what_it_lets_deviate_there(text: str, expected: float, tmp_path: Path) -> None:
    assert left(made_of(text, tmp_path)) == pytest.approx(expected, rel=1e-12)


def straight(places: Array, heights: Array) -> float:
    """Distance of two parallel lines about points of a profile, along the height: a linear programme."""
    one = np.ones((len(places), 1))
    rows = np.vstack([np.hstack([-places[:, None], -one, -one]), np.hstack([places[:, None], one, -one])])
    found = linprog([0, 0, 1], A_ub=rows, b_ub=np.concatenate([-heights, heights]), bounds=[(None, None)] * 3)
    assert found.status == 0
    return float(2.0 * found.fun)


def worst_piece(places: Array, heights: Array, piece: float) -> float:
    step = places[1] - places[0]
    count = round(piece / step) + 1
    starts = range(0, len(places) - count + 1, 2)
    return max(straight(places[k : k + count], heights[k : k + count]) for k in starts)


@pytest.mark.parametrize("ratio", [1.0, 2.0, 3.0])
def test_a_line_that_is_bent_evenly_fills_every_piece_and_bows_by_the_square_of_the_ratio(ratio: float) -> None:
    """A dense profile of 60 mm: a parabola whose pieces all take the whole zone of the unit."""
    places = np.linspace(0.0, 60.0, 121)
    piece = 60.0 / ratio
    heights = 4.0 * 0.01 * (places / piece) ** 2
    assert worst_piece(places, heights, piece) == pytest.approx(0.01, rel=1e-6)
    assert straight(places, heights) == pytest.approx(0.01 * ratio**2, rel=1e-6)


def test_no_line_within_the_zone_of_each_piece_bows_more_than_that_and_one_zone() -> None:
    """Random profiles, scaled until their worst piece of 20 mm takes 0.01 mm, of 60 mm: 0.09 mm, and 0.01 mm between
    the points at which pieces join."""
    places, rng, most = np.linspace(0.0, 60.0, 61), np.random.default_rng(1), 0.0
    for _ in range(12):
        weights = rng.standard_normal(6) / (1.0 + np.arange(6)) ** 2
        heights = np.polynomial.legendre.legval(places / 30.0 - 1.0, [0.0, 0.0, *weights])
        heights *= 0.01 / worst_piece(places, heights, 20.0)
        most = max(most, straight(places, heights))
    assert 0.03 < most <= 0.09 + 0.01


def test_axial_run_out_with_its_form_is_what_a_dial_reads_in_a_turn(tmp_path: Path) -> None:
    """2 R tilt + f <= t, and it is reached; both methods read 2 R tilt. By hand: rises of the face, square to each
    other, are those of its rim, and a turn reads twice their length."""
    made = made_of(AXIAL + FLAT, tmp_path)
    deviations = drawn(made.simulation, 0, 50_000).deviations
    wobble = 2.0 * np.hypot(deviations[:, 0], deviations[:, 1])
    assert 0.026 * 0.99 < wobble.max() <= 0.026 * (1 + 1e-12)
    for method in ("exact", "analytic"):
        assert made.drawn(2000, method)["askew"] == pytest.approx(wobble[:2000], abs=1e-7)
    smaller = made_of(AXIAL.replace("datums", "radius: 5 mm, datums"), tmp_path)  # the circle that is read
    assert left(smaller) == pytest.approx(0.09)


@pytest.mark.parametrize("text", [TOTAL + CYLINDER + AXIAL + FLAT, POSITION + BENT + PROFILE])
def test_both_methods_differ_by_second_order_beside_forms(text: str, tmp_path: Path) -> None:
    made = made_of(text, tmp_path)
    trials = drawn(made.simulation, 0, 200)
    apart = []
    for scale in (1.0, 0.25):
        exact, linear = (made.values(trials.scaled(scale), method) for method in ("exact", "analytic"))
        apart.append(max(float(np.abs(exact[name] - linear[name]).max()) for name in exact))
    assert apart[1] < max(apart[0] / 10, 1e-12)


def test_a_form_that_acts_on_nothing_is_told(tmp_path: Path) -> None:
    made = made_of(POSITION + ROUND, tmp_path)
    (words,) = made.system.warnings
    assert "roundness" in words
    assert "has no run-out or profile that it could narrow" in words
    assert made_of(RUN_OUT + ROUND, tmp_path).system.warnings == ()
    assert made_of(AXIAL + FLAT, tmp_path).system.warnings == ()


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        (
            form("straightness", "diameter: 0.01 mm", more=", per: 100 mm"),
            "straightness.per",
            "expected a piece of the feature, which is 60 mm long, got 100 mm; leave `per` out, and the zone is of the "
            "whole",
        ),
        (
            form("flatness", "width: 0.01 mm", "rail", ", per: [30 mm, 25 mm]"),
            "flatness.per",
            "expected a piece of the feature, which is 20 mm long, got 25 mm",
        ),
        (form("roundness", "diameter: 0.01 mm"), "roundness.zone", "expected a width alone"),
        (form("roundness", "width: 0.01 mm", "rail"), "roundness.of", "expected a cylinder or cone or sphere"),
        (
            form("straightness", "width: 0.01 mm", "rail"),
            "straightness.lines",
            "expected x or y, along which lines of the plane run, got none",
        ),
        (
            form("straightness", "width: 0.01 mm", more=", lines: x"),
            "straightness.lines",
            "expected none: lines run along",
        ),
        (CYLINDER + CYLINDER.replace("cylindricity:", "again:"), "again", "for its form, got 'cylindricity' too"),
        (
            RUN_OUT + form("roundness", "width: 0.05 mm"),
            "run-out.zone",
            "expected more than the 50 um of 'roundness', which refines it, got 50 um",
        ),
        (
            AXIAL.replace("shoulder", "rail"),
            "wobble.of",
            "expected a plane with a `radius`, which turns about the axis",
        ),
        (AXIAL.replace("[seat]", "[rail]"), "wobble.datums", "expected an axis among them"),
        (
            AXIAL.replace("datums", "radius: 20 mm, datums"),
            "wobble.radius",
            "expected a circle on the face, whose radius is 15 mm, got 20 mm",
        ),
        (
            AXIAL + FLAT.replace("0.004", "0.03"),
            "wobble.zone",
            "expected more than the 30 um of its form, which it holds too, got 30 um",
        ),
    ],
)
def test_what_no_form_says_is_refused(text: str, place: str, words: str, tmp_path: Path) -> None:
    said = refusal(SHAFT.replace("EXTRA\n", text), tmp_path)
    assert f"tolerances.{place}: " in said
    assert words in said
