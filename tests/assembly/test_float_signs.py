"""A float has one sense: both methods lay the pin on the same side of its slot, wherever hole and slot are."""

import math
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import assembled
from numpy.typing import NDArray

from tol3d.assembly.placing.method import features_placed
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]

HOLES = ("hole", "slot")


def scene(hole: tuple[float, float], slot: tuple[float, float], turn: float, *, pins_placed: bool) -> str:
    """A plate on two pins; `turn` [deg] of the slot's length from the line to the hole, which holes are on the plate or
    on the base."""
    length = np.subtract(slot, hole)
    across = math.atan2(length[1], length[0]) + math.radians(90 + turn)
    normal = f"[{math.cos(across)!r}, {math.sin(across)!r}, 0]"
    (x, y), (a, b) = hole, slot
    holes = f"""
      hole: {{kind: cylinder, at: [{x} mm, {y} mm, 0 mm], axis: [0, 0, 1], length: 8 mm, diameter: 8.1 mm, hole: true}}
      slot: {{kind: slot, at: [{a} mm, {b} mm, 0 mm], normal: {normal}, extent: [14 mm, 8 mm], width: 8.06 mm}}"""
    pins = "".join(
        f"\n      pin {k}: {{kind: cylinder, at: [{u} mm, {v} mm, 0 mm], axis: [0, 0, 1], "
        "length: 8 mm, diameter: 8 mm}"
        for k, (u, v) in enumerate((hole, slot), 1)
    )
    carried, fixed = (pins, holes) if pins_placed else (holes, pins)
    names = {"hole": "pin 1", "slot": "pin 2"}
    parts = {"hole": "base", "pin": "plate"} if pins_placed else {"hole": "plate", "pin": "base"}
    ends = [(f"{parts['hole']}.{name}", f"{parts['pin']}.{names[name]}") for name in HOLES]
    placed = [pair[::-1] if pins_placed else pair for pair in ends]
    pairs = "".join(f"      - {{from: {own}, to: {other}}}\n" for own, other in placed)
    sizes = "".join(
        f"  size {k}: {{kind: size, of: {name}, distribution: {{kind: constant, value: 0 mm}}}}\n"
        for k, name in enumerate(name for pair in ends for name in pair)
    )
    return f"""
scene: a plate on two pins
parts:
  base:
    kind: solid
    features:
      top: {{kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], extent: [200 mm, 200 mm]}}{fixed}
  plate:
    kind: solid
    features:
      bottom: {{kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [200 mm, 200 mm]}}{carried}
tolerances:
{sizes}moves:
  table: {{kind: fix, part: base}}
  lay:
    kind: pin_and_hole
    part: plate
    relations: [{{kind: coincident, from: plate.bottom, to: base.top}}]
    float: {{kind: random}}
    pairs:
{pairs}measures:
  across: {{kind: gap, from: {ends[1][0]}, to: {ends[1][1]}, along: {normal}}}
"""


@pytest.mark.parametrize("pins_placed", [False, True])
@pytest.mark.parametrize(
    ("hole", "slot", "turn"),
    [((-60.0, 0.0), (60.0, 0.0), 0.0), ((0.0, 0.0), (120.0, 0.0), 0.0), ((0.0, 0.0), (-70.0, 0.0), 180.0),
     ((10.0, 5.0), (10.0, 90.0), 20.0), ((-20.0, 30.0), (50.0, -40.0), -30.0), ((5.0, 5.0), (-65.0, -40.0), 160.0)],
)  # fmt: skip
def test_a_positive_draw_lets_the_pin_lie_against_the_normal_of_its_slot(
    tmp_path: Path, hole: tuple[float, float], slot: tuple[float, float], turn: float, pins_placed: bool
) -> None:
    """Offsets are clearances, 0.05 and 0.03 mm, times draws: of finite poses in the frames of hole and slot as they
    lie, of small displacements along nominal directions. All cases have a thousand trials together."""
    made = assembled(scene(hole, slot, turn, pins_placed=pins_placed), tmp_path)
    trials = drawn(made.simulation, 0, 90)
    draws = next(trials.deviations[:, own] for each, own in made.slices if each.kind == "float")
    assert np.ptp(draws, axis=0).min() > 1
    linear = made.values(trials, "analytic")["across"]
    np.testing.assert_allclose(linear, -0.03 * draws[:, 2], atol=1e-9)
    frames = features_placed(made.system.assembly, trials.deviations)
    holes, pins = ("base", "plate") if pins_placed else ("plate", "base")

    def offset(name: str, pin: str) -> Array:
        inner, outer = frames[f"{holes}.{name}"], frames[f"{pins}.{pin}"]
        return np.asarray(np.einsum("nji,nj->ni", inner[:, :3, :3], outer[:, :3, 3] - inner[:, :3, 3]))

    np.testing.assert_allclose(offset("hole", "pin 1")[:, :2], 0.05 * draws[:, :2], atol=1e-9)
    np.testing.assert_allclose(offset("slot", "pin 2")[:, 2], -0.03 * draws[:, 2], atol=1e-9)
