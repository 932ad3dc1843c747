"""The pair whose teeth deviate one by one: its numbers beside it, and trials by dense points of its deviated flanks."""

import math
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest
from expected import PRINTED, assert_all_met, expected
from numpy.typing import NDArray
from oracles.deviated_flanks import DeviatedGear, DeviatedPair, active_rolls, between, parts
from places import SCENES
from scene_texts import scene_of

from tol3d import Overrides, Run, run_scene
from tol3d.gearing.model import model_from_scene
from tol3d.gears import SpurGear

Array = NDArray[np.float64]

SCENE = "tooth_deviations"
SEEN = 1e-5  # where the exact engine's steps end
COS = math.cos(math.radians(20))
BASES = (24 * COS, 36 * COS)  # mm
CENTRE_DISTANCE = 60.05  # mm
HALF_FACE = 7.0  # mm, of the common one
ARCMIN = 60 * 180 / math.pi


@pytest.mark.slow
def test_the_scene_meets_its_expected_numbers(run_of: Callable[[str], Run]) -> None:
    assert_all_met(run_of(SCENE), SCENE, PRINTED + SEEN)


def test_the_nominal_backlash_is_that_of_the_involutes() -> None:
    working = math.acos(sum(BASES) / CENTRE_DISTANCE)
    apart = 2 * sum(BASES) * (math.tan(working) - working - math.tan(math.radians(20)) + math.radians(20))
    assert expected(SCENE)["normal backlash"]["nominal"]["geometric"] == pytest.approx(1e3 * apart, abs=PRINTED)


def columns_of(run: Run) -> Mapping[str, Array]:
    return {name: np.asarray(values) for name, values in run.columns().items() if values.dtype == np.float64}


def test_pitches_sum_to_zero_within_their_limits_in_every_trial(tmp_path: Path) -> None:
    overrides = Overrides(trials=8, engine="analytic")  # what is drawn does not depend on who measures it
    columns = columns_of(run_scene(SCENES / f"{SCENE}.yaml", overrides=overrides, out=tmp_path / "run"))
    for side, teeth, name, single, cumulative in (
        ("right ", 24, "pinion pitch", 6.0, 17.0),
        ("left ", 24, "pinion pitch", 6.0, 17.0),
        ("", 36, "wheel pitch", 6.0, 18.0),
    ):
        index = np.stack([columns[f"{name}.{side}{tooth:02d} [um]"] for tooth in range(teeth)])
        pitches = index - np.roll(index, 1, axis=0)
        assert np.abs(pitches.sum(axis=0)).max() < 1e-12
        filled = np.maximum(np.abs(pitches).max(axis=0) / single, np.ptp(index, axis=0) / cumulative)
        assert filled.min() >= 0.71 - 1e-12
        assert filled.max() <= 1.0 + 1e-12


def pair_of(columns: Mapping[str, Array], trial: int, roll_at: Callable[[int], float]) -> DeviatedPair:
    """A trial by the words of the scene; involutes begin at `roll_at(teeth)`."""

    def of(name: str) -> float:
        return 1e-3 * float(columns[f"{name} [um]"][trial])

    def pinion(tooth: int, flank: int, roll: Array, z: float) -> Array:
        side = "right" if flank == 1 else "left"
        part, part_of_form = parts(roll, active_rolls(24, 36, 2.0, CENTRE_DISTANCE))
        slope, form = of(f"pinion profile slope.{side}"), of("pinion profile form")
        helix = {1: 3e-3, -1: -2e-3}[flank]
        ahead = of(f"pinion pitch.{side} {tooth:02d}")
        return -flank * ahead * COS + slope * part + form * (1 / 3 - 4 * part_of_form**2) + helix * z / 16

    def wheel(tooth: int, flank: int, roll: Array, z: float) -> Array:
        side = "right" if flank == 1 else "left"
        part, _ = parts(roll, active_rolls(36, 24, 2.0, CENTRE_DISTANCE))
        part_of_form = between(roll, 36, 2.0, (69.6, 75.6))
        slope = of(f"wheel profile slope.right {tooth:02d}") if flank == 1 else 0.0
        form, helix = of(f"wheel profile form.{side} {tooth:02d}"), of(f"wheel helix slope.{side} {tooth:02d}")
        ahead = of(f"wheel pitch.{tooth:02d}")
        return -flank * ahead * COS + slope * part + form * np.cos(2 * math.pi * part_of_form) / 2 + helix * z / 14

    gears = (DeviatedGear(24, 2.0, roll_at(24), pinion), DeviatedGear(36, 2.0, roll_at(36), wheel))
    return DeviatedPair(*gears, CENTRE_DISTANCE, (-HALF_FACE, HALF_FACE))


@pytest.mark.slow
def test_trials_without_eccentricity_are_dense_points_of_their_flanks(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Both backlashes of some trials whose wheel runs true, to a hundredth of a um."""
    folder = tmp_path_factory.mktemp("true")
    text = (SCENES / f"{SCENE}.yaml").read_text("utf-8")
    text = text.replace("distribution: {kind: rayleigh, scale: 3 um}", "distribution: {kind: constant, value: 0 um}")
    scene = scene_of(text, folder)
    run = run_scene(scene, overrides=Overrides(trials=6), out=folder / "run")
    columns, gears = columns_of(run), [part.gear for part in model_from_scene(scene).gears]
    rolls = {
        own.teeth: math.sqrt(max((own.form_radius / own.base_radius) ** 2 - 1, 0.0))
        for own in gears
        if isinstance(own, SpurGear)
    }
    for trial in range(6):
        pair = pair_of(columns, trial, rolls.__getitem__)
        driver = math.radians(columns["position:gear pair [deg]"][trial])
        start = math.pi + math.pi / 36 - driver * 24 / 36
        rest = start + pair.turn_to_touch(-1, driver, start)  # the wheel comes back against the left flanks
        turn = pair.turn_to_touch(1, driver, rest) * ARCMIN
        assert columns["geometric:lost motion"][trial] == pytest.approx(turn, abs=0.01e-3 / BASES[1] * ARCMIN)
        gap = 1e3 * pair.gap(1, driver, rest)
        assert columns["geometric:normal backlash"][trial] == pytest.approx(gap, abs=0.01)
