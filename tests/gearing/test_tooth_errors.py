"""Transmission error of teeth that deviate: sums of tooth errors at the contact points, and orders of the teeth."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from tol3d import load_scene
from tol3d.gearing.system import GearSystem, gear_system
from tol3d.study.system.taken import taken
from tol3d.study.system.trials import Trials

Array = NDArray[np.float64]

TEETH = (20, 30)
TURNS = 3  # until the same teeth meet again
POSITIONS = 640  # a turn: 32 a tooth
COS = math.cos(math.radians(20))
BASES = (20 * COS, 30 * COS)  # mm
CENTRE_DISTANCE = 50.2  # mm
COUNT = 12

SCENE = """
scene: teeth
parts:
  pinion: {kind: spur_gear, teeth: 20, module: 2 mm, face_width: 12 mm}
  wheel: {kind: spur_gear, teeth: 30, module: 2 mm, face_width: 10 mm}
tolerances:
  pinion pitch: {kind: pitch_deviation, of: pinion, flanks: each, limits: {iso_class: 5}, law: LAW}
  wheel pitch: {kind: pitch_deviation, of: wheel, flanks: each, limits: {iso_class: 5}, law: LAW}
moves:
  pair: {kind: mesh, driver: pinion, driven: wheel, centre_distance: 50.2 mm}
measures:
  drive: {kind: transmission_error, of: pair, flank: drive, take: range, positions: 640}
  back: {kind: transmission_error, of: pair, flank: back, take: range, positions: 640}
""".replace("LAW", "{kind: run_out_and_random, run_out: 0, fill: [0.71, 1]}")


@pytest.fixture(scope="module")
def system(tmp_path_factory: pytest.TempPathFactory) -> GearSystem:
    path = tmp_path_factory.mktemp("teeth") / "teeth.yaml"
    path.write_text(SCENE, "utf-8")
    return gear_system(load_scene(path))


@pytest.fixture(scope="module")
def trials(system: GearSystem) -> Trials:
    generator = np.random.default_rng(5)
    columns = [
        np.stack(own.draw.deviations(*generator.random((own.draw.uniforms, COUNT))), axis=-1)
        for own in system.contributors
    ]
    return Trials(np.concatenate(columns, axis=1), {"pair": np.zeros(COUNT)})


@pytest.fixture(scope="module")
def curves(system: GearSystem, trials: Trials) -> dict[str, Array]:
    """By the exact engine, (trials, positions) [um at the wheel's base circle]."""
    values = system.method("exact", {}).answers(trials, system.measures).values
    return {side: 1e3 * BASES[1] * values[side] for side in ("drive", "back")}


def summed(row: Array, side: int) -> tuple[Array, NDArray[np.bool_]]:
    """Protrusion of the most prominent pair [um], and where no edge may touch beyond the path of contact.

    The driver's tooth k stands at the azimuth theta + 2 pi k/z1 and touches from where the wheel's tip meets it to
    where its own tip does; along the line of contact that is a path from a sin(alpha_w) - (the wheel tip's radius of
    curvature) to the driver's. Worked out in teeth, pairs and arcs, without rolls and without anything of the product.
    """
    working = math.acos(sum(BASES) / CENTRE_DISTANCE)
    whole = CENTRE_DISTANCE * math.sin(working)
    tips = [math.sqrt((z + 2) ** 2 - base**2) for z, base in zip(TEETH, BASES, strict=True)]
    half = math.pi / 40 + math.tan(math.radians(20)) - math.radians(20)  # of a tooth at the base circle
    theta = np.arange(TURNS * POSITIONS) * 2 * math.pi / POSITIONS
    best, clear = np.full(len(theta), -np.inf), np.ones(len(theta), dtype=bool)
    index = {1: (0, 40), -1: (20, 70)}[side]
    for k in range(-TURNS * 20 - 3, 4):
        # the string from the driver's base circle to the contact, r_b (alpha_w + half - side azimuth)
        string = BASES[0] * (working + half - side * (theta + 2 * math.pi * k / 20))
        inside = (string >= whole - tips[1]) & (string <= tips[0])
        own = row[index[0] + k % 20]
        mate = row[index[1] + (-k - (0 if side == 1 else 1)) % 30]
        out = -side * COS * (own + mate) * 1e3
        best = np.where(inside, np.maximum(best, out), best)
        near = (np.abs(string - (whole - tips[1])) < 1.6) | (np.abs(string - tips[0]) < 1.6)
        clear &= ~(near & ~inside)
    return best, clear


@pytest.mark.slow
@pytest.mark.parametrize(("name", "side"), [("drive", 1), ("back", -1)])
def test_errors_are_those_of_the_tooth_that_stands_out_most(
    name: str, side: int, trials: Trials, curves: dict[str, Array]
) -> None:
    """On the right flank a pair that stands out turns the wheel on, on the left one back."""
    for row, curve in zip(trials.deviations, curves[name], strict=True):
        best, clear = summed(row, side)
        assert clear.mean() > 0.3
        off = (curve - side * best)[clear]
        assert np.ptp(off) < 2e-6  # both from a place of their own; 1e-3 um of the first position cancels
        # edges hold pairs longer: peaks are the same, and valleys are at most those of the path of contact
        assert np.ptp(curve) <= np.ptp(best) + 1e-6
        assert np.ptp(curve) > 0.5 * np.ptp(best)
        highest = best.max() + float(np.median(side * off))
        assert (side * curve).max() == pytest.approx(highest, abs=1e-5)


def test_teeth_turn_up_at_the_order_of_the_teeth_and_its_harmonics(curves: dict[str, Array]) -> None:
    """With two pairs in mesh the better one of them carries: once a tooth, whatever the teeth are."""
    power = (np.abs(np.fft.rfft(curves["drive"], axis=1)) ** 2).mean(axis=0)
    for harmonic in (1, 2):
        order = TURNS * TEETH[0] * harmonic
        beside = np.concatenate([power[order - 12 : order], power[order + 1 : order + 13]])
        assert power[order] > 4 * np.median(beside)
    assert power[TURNS * TEETH[0]] > 4 * np.median(power[TURNS * TEETH[0] + 20 : TURNS * TEETH[0] + 40])


def test_peaks_of_errors_are_those_of_the_positions_and_no_parabola_beside_a_jump(
    system: GearSystem, curves: dict[str, Array]
) -> None:
    measure = next(own for own in system.measures if own.name == "drive")
    found = taken(measure, curves["drive"])
    assert found == pytest.approx(np.ptp(curves["drive"], axis=1), abs=1e-12)


def test_both_methods_have_the_same_errors_tooth_by_tooth(
    system: GearSystem, trials: Trials, curves: dict[str, Array]
) -> None:
    by_theory = system.method("analytic", None).answers(trials, system.measures).values
    for side, curve in curves.items():
        assert 1e3 * BASES[1] * by_theory[side] == pytest.approx(curve, abs=0.02)
