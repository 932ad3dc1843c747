"""Rests of deviated teeth at many positions, taken from the line of action, against dense points and Newton's feet."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gearing.deviating_pair import BASES, PITCH, SCENE, SHAPES, TURN, Builds, dense, drawn
from numpy.typing import NDArray

from tol3d import load_scene
from tol3d.gearing.engines import OUT_OF_RANGE
from tol3d.gearing.engines.exact.deviated import DeviatedTooth
from tol3d.gearing.engines.exact.tooth_contact import beside, edge_gap
from tol3d.gearing.engines.gaps import MeshReading
from tol3d.gearing.model import Reading, model_from_scene
from tol3d.gears.flank import LEFT, RIGHT

Array = NDArray[np.float64]

COMPILED: tuple[Any, Any] = (beside, edge_gap)
WORKED_OUT, BOUND = (own.py_func for own in COMPILED)
POSITIONS = 320  # a turn of the driver, 16 a tooth
ALL = f"{PITCH}\n{SHAPES}"
ECCENTRIC = "  {gear} run-out: {{kind: eccentricity, of: {gear}, distribution: {{kind: rayleigh, scale: 8 um}}}}"
NEWTON_UM = 5e-4  # squares of slopes, of gaps that are sought from the edge where a face ends
DENSE_UM = 2e-3  # dense points lie a um apart, and squares of slopes are left out: see test_single_flanks.py


def rests(builds: Builds, angles: Array) -> Array:
    """The driven gear's angles [rad] at rest, (builds, positions, 2): drive side, back side."""
    made = builds.engine.build(builds.deviations)
    found = builds.engine.rests(made, builds.mesh, Reading(), angles)
    assert all((side.status == 0).all() for side in found)
    return np.stack([side.driven_angle for side in found], axis=-1)


@pytest.mark.slow
@pytest.mark.parametrize(("tolerances", "heights"), [(PITCH, (0.0,)), (ALL, (-5.0, 5.0))])
def test_at_each_rest_dense_points_touch(tolerances: str, heights: tuple[float, ...], tmp_path: Path) -> None:
    """A position every seventh, so that all places of the path of contact and both gears' edges have their turn."""
    builds, angles = drawn(tolerances, tmp_path, 2, 5), np.arange(POSITIONS) * TURN / POSITIONS
    found = rests(builds, angles)
    for row in range(2):
        pair = dense(builds, row, heights)
        for k in range(1, POSITIONS, 29):
            for side, flank in enumerate((1, -1)):
                off = pair.turn_to_touch(flank, angles[k], found[row, k, side])
                assert 1e3 * BASES[1] * off == pytest.approx(0.0, abs=DENSE_UM)


@pytest.mark.slow
@pytest.mark.parametrize(
    "more",
    ["", pytest.param("\n".join(ECCENTRIC.format(gear=gear) for gear in ("pinion", "wheel")), marks=pytest.mark.slow)],
)
def test_at_each_rest_newton_finds_no_gap_and_no_overlap(more: str, tmp_path: Path) -> None:
    """Gaps of single positions are sought foot by foot on both flanks."""
    count = 20
    builds, angles = drawn(f"{ALL}\n{more}", tmp_path, count, 7), np.arange(0, 960, 7) * TURN / POSITIONS
    found, made = rests(builds, angles), builds.engine.build(builds.deviations)
    for k, angle in enumerate(angles):
        teeth = np.tile(np.arange(-2, 3) - round(angle / (TURN / 20)), (count, 1))
        for side, flank in enumerate((RIGHT, LEFT)):
            stand = (np.full(count, angle), found[:, k, side])
            gaps = builds.engine.gaps(made, builds.mesh, flank, stand, teeth, np.ones(teeth.shape, dtype=bool))
            within = np.where(gaps.at_end, np.inf, gaps.value)  # beyond both ends a gap is no more than a bound
            assert 1e3 * np.abs(gaps.value).min(axis=1).max() < NEWTON_UM
            assert 1e3 * within.min() > -NEWTON_UM


IDLER = """  before: {kind: mesh, driver: first, driven: pinion, centre_distance: 45.3 mm, azimuth: 150 deg}
"""


def thinned(tolerances: str, folder: Path, *, in_train: bool) -> Builds:
    """The pair with gears thinner by 60 and 20 um and nothing else, alone or driven by a gear of 25 teeth."""
    thin = "  thin {gear}: {{kind: tooth_thickness, of: {gear}, distribution: {{kind: constant, value: {value} um}}}}\n"
    lines = thin.format(gear="pinion", value=-60) + thin.format(gear="wheel", value=-20) + tolerances
    text = SCENE.format(tolerances=lines, flank="right")
    if in_train:
        first = "parts:\n  first: {kind: spur_gear, teeth: 25, module: 2 mm, face_width: 12 mm}\n"
        text = text.replace("parts:\n", first).replace("moves:\n", f"moves:\n{IDLER}")
    (folder / "thinned.yaml").write_text(text, "utf-8")
    model = model_from_scene(load_scene(folder / "thinned.yaml"))
    found = Builds(model, np.zeros((5, model.component_count)), np.zeros(5))
    found.of("thin pinion")[:], found.of("thin wheel")[:] = -0.06, -0.02
    return found


@pytest.mark.parametrize("in_train", [False, True])
def test_teeth_that_do_not_deviate_rest_as_involutes_do(in_train: bool, tmp_path: Path) -> None:
    """Two kernels, one answer: thinner gears, then one of them grown, in range and out of it."""
    angles, read = np.array([0.3, 0.4, 1.0, 3.0]), list[tuple[MeshReading, MeshReading]]()
    for tolerances in ("", ALL):
        builds = thinned(tolerances, tmp_path, in_train=in_train)
        made, mesh = builds.engine.build(builds.deviations), builds.model.mesh("pair")
        scale = np.ones_like(made.scale)
        for gear, grown in (("pinion", [0.0, 0.003, 0.0, 0.006, 0.0]), ("wheel", [0.0, 0.0, 0.003, 0.0, 0.006])):
            scale[:, builds.model.seat_index["pair", gear]] += grown
        read.append(builds.engine.rests(replace(made, scale=scale), mesh, Reading(contact="section"), angles))
    out = read[0][0].status == OUT_OF_RANGE
    assert out.all(axis=1).tolist() == out.any(axis=1).tolist() == [False, False, False, True, True]
    for plain, level in zip(*read, strict=True):
        np.testing.assert_array_equal(level.status, plain.status)
        np.testing.assert_array_equal(level.tooth, plain.tooth)
        assert level.driven_angle == pytest.approx(plain.driven_angle, abs=1e-9, nan_ok=True)
        assert level.contact == pytest.approx(plain.contact, abs=1e-6, nan_ok=True)


# beside the line of action --------------------------------------------------------------------------------------


def tooth(teeth: int, pressure_angle: float, tip_radius: float) -> DeviatedTooth:
    base = 0.5 * teeth * math.cos(pressure_angle)
    end = math.sqrt(tip_radius**2 - base**2) / base
    zeros = dict.fromkeys(set(DeviatedTooth._fields) - {"base", "end"}, 0.0)
    return DeviatedTooth(base=base, end=end, **zeros)


def apart(own: float, mate: float, centre_distance: float, roll: float, beyond: float) -> float:
    """By how much a point of an involute at a roll has left its mate [mm] that touched `beyond` of roll before.

    Both gears stand where the point's tooth would touch at the roll `roll + beyond`. The point is turned back by that
    from where it touches itself; the mate's flank through any point is found by the length of its string.
    """
    working = math.acos((own + mate) / centre_distance)
    tangent = centre_distance * math.sin(working)
    towards = working - beyond  # azimuth at which the point's string leaves own base circle, from the line of centres
    x = own * math.cos(towards) + own * roll * math.sin(towards)
    y = own * math.sin(towards) - own * roll * math.cos(towards)
    x, y = centre_distance - x, -y  # from the mate's centre, its axis towards own gear
    string = math.sqrt(x * x + y * y - mate * mate)
    rolled = string / mate  # of the mate's involute through the point; it begins at:
    begins = math.atan2(y, x) + math.atan2(string, mate) - rolled
    mate_string = tangent - own * (roll + beyond)
    stands = working - mate_string / mate
    return mate * (stands - begins)


def test_tip_edges_leave_their_mates_by_as_much_as_is_worked_out_and_more_than_the_bound() -> None:
    generator, checked = np.random.default_rng(3), 0
    while checked < 2000:
        z, mate_z = (int(own) for own in generator.integers(8, 150, 2))
        pressure = math.radians(generator.uniform(14.5, 30.0))
        own = tooth(z, pressure, 0.5 * z + generator.uniform(0.6, 1.4))
        mate = tooth(mate_z, pressure, 0.5 * mate_z + 1.0)
        centre_distance = 0.5 * (z + mate_z) * generator.uniform(0.99, 1.05)
        bases, beyond = own.base + mate.base, generator.uniform(0.0, 1.2) * TURN / z
        if centre_distance <= bases:
            continue
        tangent = math.sqrt(centre_distance**2 - bases**2)
        if own.base * (own.end + beyond) > 0.98 * tangent:
            continue
        checked += 1
        left = apart(own.base, mate.base, centre_distance, own.end, beyond)
        rho = own.base * (own.end + beyond)
        found, _, _ = WORKED_OUT(own.base, mate.base, rho, tangent - rho, beyond)
        assert found == pytest.approx(left, abs=1e-11)
        assert BOUND(own, mate, tangent, beyond) <= left
