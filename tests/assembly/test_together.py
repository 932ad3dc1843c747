"""Simultaneous requirements: features of several tolerances in one frame, over one place of its gauges."""

from pathlib import Path

import numpy as np
import pytest
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray
from scene_texts import Edit, edited, refusal
from scipy.optimize import minimize

from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]

ON_GAUGE = "[floor, {feature: bore, mmb: least}]"
ROOM, WIDTHS = (0.06 + 0.02) / 2, (0.2, 0.1)
"""A bore 0.06 mm over its least size, upright within 0.02 mm there: a gauge of 9.98 mm; zones of the holes."""


def plate(
    datums: str = "[floor, {feature: bore, mmb: least}]", more: str = "", modifier: str = "", x: float = 0
) -> str:
    hole = "axis: [0, 0, 1], length: 10 mm, diameter: 6 mm, hole: true"
    place = "law: {kind: uniform}, datums: [floor, bore]"
    return f"""scene: two holes on a gauge
parts:
  plate:
    kind: solid
    features:
      floor: {{kind: plane, at: [{50 + x} mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [120 mm, 60 mm]}}
      bore: {{kind: cylinder, at: [{x} mm, 0 mm, 5 mm], axis: [0, 0, 1], length: 10 mm, diameter: 10 mm, hole: true}}
      near: {{kind: cylinder, at: [{44 + x} mm, 0 mm, 5 mm], {hole}}}
      far: {{kind: cylinder, at: [{90 + x} mm, 20 mm, 5 mm], {hole}}}
tolerances:
  upright:
    kind: perpendicularity
    of: plate.bore
    zone: {{diameter: 0.02 mm}}
    law: {{kind: process, distribution: {{kind: constant, value: 0 mm}}}}
    datums: [floor]
  bore size: {{kind: size, of: plate.bore, distribution: {{kind: constant, value: 0.06 mm}}, limits: [0 mm, 0.1 mm]}}
  near: {{kind: position, of: plate.near, zone: {{diameter: 0.2 mm}}, {place}}}
  far: {{kind: position, of: plate.far, zone: {{diameter: 0.1 mm}}, {place}}}
  near size: {{kind: size, of: plate.near, distribution: {{kind: uniform, lower: 0 mm, upper: 0.08 mm}}}}
  far size: {{kind: size, of: plate.far, distribution: {{kind: uniform, lower: 0 mm, upper: 0.04 mm}}}}
{more}moves:
  machine: {{kind: fix, part: plate}}
measures:
  both: {{kind: inspected_together, of: [plate.near, plate.far], zones: [0.2 mm, 0.1 mm], datums: {datums}{modifier}}}
  near on it: {{kind: inspected_position, of: plate.near, datums: [floor, {{feature: bore, mmb: least}}]}}
  far on it: {{kind: inspected_position, of: plate.far, datums: [floor, {{feature: bore, mmb: least}}]}}
  near off: {{kind: inspected_position, of: plate.near, datums: [floor, bore]}}
  far off: {{kind: inspected_position, of: plate.far, datums: [floor, bore]}}
"""


def columns(made: Assembled, count: int) -> dict[str, Array]:
    deviations = drawn(made.simulation, 0, count).deviations
    return {own.name: deviations[:, where] for own, where in made.slices}


def least(ends: Array, radii: Array) -> float:
    """Twice the least w for which a shift of the gauge in its room brings every end (ends, 2) within w + its radius."""
    cones = {"type": "ineq", "fun": lambda q: q[2] + radii - np.hypot(*(ends - q[:2]).T)}
    room = {"type": "ineq", "fun": lambda q: ROOM**2 - q[:2] @ q[:2]}
    start = [0.0, 0.0, float((np.hypot(*ends.T) - radii).max())]
    found = minimize(lambda q: q[2], start, constraints=[cones, room], method="SLSQP", options={"ftol": 1e-14})
    return float(2.0 * found.x[2])


@pytest.mark.parametrize("modifier", ["", ", modifier: mmc"])
@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_all_features_share_one_place_of_the_gauge(method: str, modifier: str, tmp_path: Path) -> None:
    """Against a convex programme on 100 builds: one shift of the gauge for both holes, each with its own zone."""
    made = assembled(plate(modifier=modifier), tmp_path)
    found, own = made.drawn(100, method)["both"], columns(made, 100)
    for k, value in enumerate(found):
        ends = np.concatenate([own[name][k].reshape(2, 2) for name in ("near", "far")])
        bonus = [own[f"{name} size"][k, 0] if modifier else 0.0 for name in ("near", "far")]
        radii = np.repeat([(width + more) / 2 for width, more in zip(WIDTHS, bonus, strict=True)], 2)
        assert value == pytest.approx(least(ends, radii), abs=2e-6)


def test_together_asks_more_than_each_by_itself_and_less_than_on_a_fixed_gauge(tmp_path: Path) -> None:
    found = assembled(plate(), tmp_path).drawn(2000)
    apart = np.maximum(found["near on it"] - 0.2, found["far on it"] - 0.1)
    fixed = np.maximum(found["near off"] - 0.2, found["far off"] - 0.1)
    assert (found["both"] >= apart - 1e-9).all()
    assert (found["both"] <= fixed + 1e-9).all()
    assert (found["both"] > apart + 1e-3).mean() > 0.1
    assert (found["both"] < fixed - 1e-3).mean() > 0.5


@pytest.mark.parametrize("modifier", ["", ", modifier: mmc"])
def test_without_gauges_it_is_the_largest_of_both_positions_less_their_zones(modifier: str, tmp_path: Path) -> None:
    made = assembled(plate("[floor, bore]", modifier=modifier), tmp_path)
    own = columns(made, 500)
    bonus = [own[f"{name} size"][:, 0] if modifier else 0.0 for name in ("near", "far")]
    for method in ("exact", "analytic"):
        found = made.drawn(500, method)
        expected = np.maximum(found["near off"] - 0.2 - bonus[0], found["far off"] - 0.1 - bonus[1])
        np.testing.assert_allclose(found["both"], expected, rtol=0, atol=1e-12)


def test_both_methods_differ_by_second_order_and_an_origin_elsewhere_changes_nothing(tmp_path: Path) -> None:
    floor = "  floor: {kind: profile, of: plate.floor, zone: {width: 0.1 mm}, law: {kind: uniform}}\n"
    made = assembled(plate(more=floor), tmp_path)
    trials = drawn(made.simulation, 0, 200)
    apart = []
    for scale in (1.0, 0.25):
        exact, linear = (made.values(trials.scaled(scale), method)["both"] for method in ("exact", "analytic"))
        apart.append(float(np.abs(exact - linear).max()))
    assert apart[1] < max(apart[0] / 10, 1e-9)
    other = assembled(plate(more=floor, x=-700), tmp_path)
    np.testing.assert_allclose(other.drawn(200)["both"], made.drawn(200)["both"], rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("zones: [0.2 mm, 0.1 mm]", "zones: [0.2 mm, 0.1 mm, 0.1 mm]"), "expected one of each feature, 2, got 3"),
        (("[plate.near, plate.far]", "[plate.near, plate.near]"), "expected each feature once, got 'plate.near'"),
        (("[plate.near, plate.far]", "[plate.near]"), "of"),
        (
            ("mmb: least}]}\n  near on", "mmb: random}]}\n  near on"),
            "expected datums without mmb, or mmb: least of what is inspected",
        ),
    ],
)
def test_what_is_not_inspected_together_is_refused(change: Edit, words: str, tmp_path: Path) -> None:
    assert words in refusal(edited(plate(), change), tmp_path)
