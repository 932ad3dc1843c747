"""The pair of measured teeth: its numbers beside it, its files read anew, and trials by dense points of its flanks."""

import csv
import math
from collections.abc import Callable, Mapping
from itertools import accumulate
from pathlib import Path

import numpy as np
import pytest
from expected import PRINTED, assert_all_met
from numpy.typing import NDArray
from oracles.deviated_flanks import DeviatedGear, DeviatedPair, active_rolls, between, parts
from places import SCENES

from tol3d import Overrides, Run, load_scene, run_scene
from tol3d.gearing.model import model_from_scene
from tol3d.gears import SpurGear

Array = NDArray[np.float64]

SCENE = "measured_teeth"
SEEN = 1e-5  # where the exact engine's steps end
COS = math.cos(math.radians(20))
BASES = (24 * COS, 36 * COS)  # mm
SIDES = ("right", "left")
ARCMIN = 60 * 180 / math.pi
FACES = (16.0, 14.0)  # mm


@pytest.mark.slow
def test_the_scene_meets_its_expected_numbers(run_of: Callable[[str], Run]) -> None:
    assert_all_met(run_of(SCENE), SCENE, PRINTED + SEEN)


def measured() -> Mapping[str, Array]:
    """The deviations of every flank [um] as the scene's words place them, right flanks first, (2, teeth)."""
    pinion = list(csv.DictReader((SCENES / "measured_pinion.csv").open(encoding="utf-8")))
    wheel = list(csv.DictReader((SCENES / "measured_wheel.csv").open(encoding="utf-8"), delimiter=";"))

    def of_pinion(column: str) -> Array:
        return np.array([[float(row[column]) for row in pinion if row["flank"] == side] for side in SIDES])

    ahead = of_pinion("F_p [um]")
    turned, slopes = [], []
    for side in SIDES:
        rows = [row for row in wheel if row["Flank"] == side]
        assert [int(row["Tooth"]) for row in rows] == list(range(1, 37))
        single = [float(row["fp (µm)"].replace(",", ".")) for row in rows]
        closed = [value - sum(single) / 36 for value in single]
        clockwise = np.array(list(accumulate(closed)))  # F of tooth k, positive clockwise
        turned.append([-clockwise[-k % 36] for k in range(36)])
        found = [float(row["fHa (µm)"].replace(",", ".")) for row in rows if row["fHa (µm)"]]
        assert len(found) == 4
        slopes.append(sum(found) / 4)
    wheel_ahead = np.array(turned)
    return {
        "pinion pitch": ahead - ahead.mean(axis=1, keepdims=True),
        "wheel pitch": wheel_ahead - wheel_ahead.mean(axis=1, keepdims=True),
        "pinion profile slope": of_pinion("f_Ha [um]"),
        "wheel profile slope": np.array(slopes)[:, None],
        "pinion helix slope": of_pinion("f_Hb [um]"),
    }


def test_components_of_every_trial_are_those_of_the_files(tmp_path: Path) -> None:
    overrides = Overrides(trials=8, engine="analytic")  # what is drawn does not depend on who measures it
    columns = run_scene(SCENES / f"{SCENE}.yaml", overrides=overrides, out=tmp_path / "run").columns()
    for name, values in measured().items():
        for side, own in zip(SIDES, values, strict=True):
            for tooth, value in enumerate(own):
                column = f"{name}.{side} {tooth:02d} [um]" if len(own) > 1 else f"{name}.{side} [um]"
                assert columns[column] == pytest.approx(value, abs=1e-10)


@pytest.mark.slow
def test_trials_are_dense_points_of_the_measured_flanks(run_of: Callable[[str], Run]) -> None:
    """Both backlashes, to a hundredth of a um."""
    run, own = run_of(SCENE), measured()
    columns = run.columns()
    gears = [part.gear for part in model_from_scene(load_scene(SCENES / f"{SCENE}.yaml")).gears]

    def gear_of(gear: SpurGear, name: str, face: float, thicker: float) -> DeviatedGear:
        def deviation(tooth: int, flank: int, roll: Array, z: float) -> Array:
            side = 0 if flank == 1 else 1
            part, _ = parts(roll, active_rolls(36, 24, 2.0, 60.03))
            if name == "pinion":
                part = between(roll, 24, 2.0, (46.4, 51.6))
            slopes = own[f"{name} profile slope"][side]
            slope = slopes[tooth] if len(slopes) > 1 else slopes[0]
            helix = own["pinion helix slope"][side][tooth] if name == "pinion" else 0.0
            return np.asarray(
                1e-3 * (-flank * own[f"{name} pitch"][side][tooth] * COS + slope * part + helix * z / 14.4)
            )

        first = math.sqrt(max((gear.form_radius / gear.base_radius) ** 2 - 1, 0.0))
        return DeviatedGear(gear.teeth, 2.0, first, deviation, thicker)

    pinion, wheel = (gear for gear in gears if isinstance(gear, SpurGear))
    for trial in range(4):
        distance = 60.03 + 1e-3 * columns["centre distance [um]"][trial]
        pair = DeviatedPair(
            gear_of(pinion, "pinion", FACES[0], 0.0), gear_of(wheel, "wheel", FACES[1], -0.03), distance, (-7.0, 7.0)
        )
        driver = math.radians(columns["position:gear pair [deg]"][trial])
        start = math.pi + math.pi / 36 - driver * 24 / 36
        rest = start + pair.turn_to_touch(-1, driver, start)
        turn = pair.turn_to_touch(1, driver, rest) * ARCMIN
        assert columns["geometric:lost motion"][trial] == pytest.approx(turn, abs=0.01e-3 / BASES[1] * ARCMIN)
        gap = 1e3 * pair.gap(1, driver, rest)
        assert columns["geometric:normal backlash"][trial] == pytest.approx(gap, abs=0.01)
