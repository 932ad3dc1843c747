"""A float has one sense: both methods lay the pin on the same side of its slot, wherever hole and slot are."""

import math
from pathlib import Path

import numpy as np
import pytest
from assembly import plates
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
    place = f"at: [{slot[0]} mm, {slot[1]} mm, 0 mm]"
    holes = {
        "hole": plates.hole((*hole, 0), 8.1, 8),
        "slot": f"{{kind: slot, {place}, normal: {normal}, extent: [14 mm, 8 mm], width: 8.06 mm}}",
    }
    pins = {f"pin {k}": plates.pin((*own, 0), 8, 8) for k, own in enumerate((hole, slot), 1)}
    base, plate = ("plate", "base") if pins_placed else ("base", "plate")  # of the pins, of the holes
    ends = [(f"{plate}.{name}", f"{base}.{own}") for name, own in zip(holes, pins, strict=True)]
    sizes = "".join(
        f"  size {k}: {{kind: size, of: {name}, distribution: {{kind: constant, value: 0 mm}}}}\n"
        for k, name in enumerate(name for pair in ends for name in pair)
    )
    upper, lower = (pins, holes) if pins_placed else (holes, pins)
    across_slot = f"  across: {{kind: gap, from: {ends[1][0]}, to: {ends[1][1]}, along: {normal}}}"
    pairs = [*zip(upper, lower, strict=True)]
    return plates.two_plates(lower, upper, pairs, sizes, across_slot, move="lay", kind="pin_and_hole")


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
