"""A study as a whole: its mean build, its grids, its blocks, its worst trial."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tol3d import Overrides, Run, Scene, SceneError, run_scene
from tol3d.simulate import load, simulation_of
from tol3d.study.results.task import BLOCK_VALUES, block_trials
from tol3d.study.runs.worst import worst_trial

FEW = Overrides(trials=200, engine="analytic")


def made(tolerances: dict[str, Any], measures: dict[str, Any], **changes: Any) -> Scene:
    gear = {"kind": "spur_gear", "module": "2.5 mm", "face_width": "20 mm"}
    fields = {
        "scene": "study",
        "parts": {"pinion": {**gear, "teeth": 28}, "wheel": {**gear, "teeth": 110}},
        "tolerances": tolerances,
        "moves": {"pair": {"kind": "mesh", "driver": "pinion", "driven": "wheel", "centre_distance": "172.52 mm"}},
        "measures": {name: {"kind": "normal_backlash", "of": "pair", **m} for name, m in measures.items()},
    }
    return Scene.model_validate(fields | changes)


TOWARDS = {
    # 50 um, the pinion's teeth towards the wheel at driver angle 0: 34 um less play there, 14 um nominal
    "towards the wheel": {
        "kind": "eccentricity",
        "of": "pinion",
        "direction": {"at": "0 deg"},
        "distribution": {"kind": "constant", "value": "50 um"},
    }
}


def test_an_offset_that_turns_is_not_judged_at_one_position_of_random_ones(tmp_path: Path) -> None:
    run = run_scene(made(TOWARDS, {"play": {}}), overrides=FEW, out=tmp_path / "run")
    play = run.summary["measures"]["play"]
    assert play["mean_build"]["analytic"] == pytest.approx(play["nominal"]["analytic"])
    for over in ({"at": "0 deg"}, "turn"):
        take = {"take": "min"} if over == "turn" else {}
        with pytest.raises(SceneError, match="interfere at the mean build"):
            run_scene(made(TOWARDS, {"play": {"over": over, **take}}), overrides=FEW, out=tmp_path / "other")


def tilt(of: str, size: str) -> dict[str, Any]:
    return {"kind": "axis_in_plane", "of": of, "distribution": {"kind": "normal", "lower": f"-{size}", "upper": size}}


def test_measures_without_a_closed_form_have_quantiles_too(tmp_path: Path) -> None:
    tilts = {"bores": tilt("pair", "10 um"), "bearings": tilt("pair", "6 um")}
    widest = {"over": "turn", "take": "max", "positions": 4}
    run = run_scene(made(tilts, {"play": widest}), overrides=FEW, out=tmp_path / "run")
    play = run.summary["measures"]["play"]
    assert "analytic_closed_form" not in play
    values = np.sort(run.columns("analytic:play")["analytic:play"])
    # the order statistic of rank p n lies in the bin that was told
    assert play["analytic"]["p50"] == pytest.approx(values[99], abs=play["analytic"]["quantile_error"])
    assert play["analytic"]["outside_grid"] == 0
    assert sum(play["histogram"]["counts"]["analytic"]) == 200


def test_a_geometric_spread_that_the_stack_up_does_not_see_has_quantiles_too(tmp_path: Path) -> None:
    shift = {"kind": "axial_shift", "of": "wheel", "distribution": {"kind": "normal", "mean": "0 um", "sigma": "50 um"}}
    tilted = {"kind": "axis_in_plane", "of": "pair", "distribution": {"kind": "constant", "value": "0.5 mrad"}}
    scene = made({"shift": shift, "tilted": tilted}, {"play": {}})
    run = run_scene(scene, overrides=Overrides(trials=60), out=tmp_path / "run")
    play = run.summary["measures"]["play"]
    assert play["analytic_closed_form"]["sigma"] < 1e-9  # um; an axial shift moves no flank, to first order
    assert play["geometric"]["sigma"] > 1e-3
    assert play["geometric"]["outside_grid"] == 0
    values = np.sort(run.columns("geometric:play")["geometric:play"])
    assert play["geometric"]["p50"] == pytest.approx(values[29], abs=play["geometric"]["quantile_error"])


def test_blocks_of_long_curves_hold_fewer_trials() -> None:
    def trials_of(measures: dict[str, Any]) -> int:
        return block_trials(simulation_of(load(made({}, measures))))

    assert trials_of({"play": {}}) == 65_536
    assert trials_of({"least": {"over": "long_period", "take": "min", "positions": 1000}}) == 65_536
    positions = 55 * 1000  # the long period of 28/110 is 55 turns of the pinion
    curve = trials_of({"curve": {"over": "long_period", "take": "curve", "positions": 1000}})
    assert curve == 64
    assert curve * positions <= BLOCK_VALUES < 2 * curve * positions


NORMAL = {"kind": "normal", "lower": "-8 um", "upper": "8 um"}
DISTANCE = {"distance": {"kind": "centre_distance", "of": "pair", "distribution": NORMAL}}
ECCENTRIC = {
    "eccentricity": {"kind": "eccentricity", "of": "pinion", "distribution": {"kind": "rayleigh", "scale": "2 um"}}
}


@pytest.fixture(scope="module")
def curve_run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    measures = {"play": {}, "curve": {"over": "turn", "take": "curve", "upper_limit": "20 um"}}
    return run_scene(made(DISTANCE | ECCENTRIC, measures), overrides=FEW, out=tmp_path_factory.mktemp("runs") / "run")


def test_the_worst_trial_of_a_curve_is_the_one_whose_peak_is_nearest_to_its_limit(curve_run: Run) -> None:
    peaks = curve_run.columns("analytic:curve")["analytic:curve"].max(axis=1)
    assert worst_trial(curve_run) == int(np.argmax(peaks)) != 0


def test_the_deepest_jam_is_the_worst(tmp_path: Path) -> None:
    wide_law = {"kind": "normal", "lower": "-40 um", "upper": "40 um"}
    wide = {"distance": {**DISTANCE["distance"], "distribution": wide_law}}
    scene = made(wide, {"play": {"lower_limit": "2 um"}})
    run = run_scene(scene, overrides=Overrides(trials=60), out=tmp_path / "run")
    play = run.columns("geometric:play")["geometric:play"]
    assert play.min() < 0.0  # it keeps how deep its teeth overlap
    assert worst_trial(run) == int(np.argmin(play))
