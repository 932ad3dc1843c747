"""The witness: which trials FCL measures again, what it finds of them, and when that is warned of."""

import math
from collections import Counter
from collections.abc import Callable, Mapping
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from loose_summaries import typed_run
from places import SCENES, SPUR_PAIR
from scene_texts import written

from tol3d import Overrides, Run, run_scene
from tol3d.simulate import load, simulation_of
from tol3d.study.execution.pools import Execution
from tol3d.study.results.witness import witness_summary, witness_warnings, witnessed_trials
from tol3d.study.runs.summary.agreement import WitnessSummary
from tol3d.study.system.method import Method
from tol3d.study.trials.simulation import Simulation

EVERY_FIELD = SCENES / "every_field.yaml"
MEASURES = ("normal backlash", "lost motion")
WITNESSED = 25
STUDY: Mapping[str, Any] = {"trials": 300, "seed": 4}


Modelling = Callable[[str], Simulation]


# which trials ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("trials", "wanted"), [(1, 1), (20, 20), (20, 50), (2000, 20), (10**10, 1000)])
def test_witnessed_trials_are_distinct_ascending_and_of_the_study(trials: int, wanted: int) -> None:
    chosen = witnessed_trials(3, trials, wanted)
    assert len(chosen) == min(trials, wanted)
    assert (np.diff(chosen) > 0).all()
    assert chosen[0] >= 0
    assert chosen[-1] < trials


def test_every_set_of_trials_is_as_likely_as_any_other() -> None:
    seeds = 12_000
    drawn = Counter(tuple(witnessed_trials(seed, 6, 3).tolist()) for seed in range(seeds))
    sets = list(combinations(range(6), 3))
    expected = seeds / len(sets)
    chi_squared = sum((drawn[each] - expected) ** 2 / expected for each in sets)
    # 19 degrees of freedom; a fair draw exceeds 43.8 once in a thousand seeds
    assert chi_squared < 43.8


def test_a_sample_of_a_long_study_reaches_all_of_it() -> None:
    chosen = witnessed_trials(1, 10**9, 1000) / 10**9
    # of 1000 uniforms; the mean's standard error is 1/sqrt(12000)
    assert abs(chosen.mean() - 0.5) < 4 / math.sqrt(12_000)
    assert np.histogram(chosen, 10, (0, 1))[0].min() > 100 - 4 * math.sqrt(90)


def test_other_seeds_choose_other_trials() -> None:
    assert not np.array_equal(witnessed_trials(1, 2000, 20), witnessed_trials(2, 2000, 20))


# what it finds --------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    study = Overrides(**STUDY, witness=WITNESSED)
    return run_scene(SPUR_PAIR, overrides=study, out=tmp_path_factory.mktemp("runs") / "exact")


def test_the_differences_are_those_of_the_same_trials_by_a_study_of_fcl(run: Run, tmp_path: Path) -> None:
    by_fcl = run_scene(SPUR_PAIR, overrides=Overrides(**STUDY, engine="fcl"), out=tmp_path / "fcl")
    chosen = witnessed_trials(STUDY["seed"], STUDY["trials"], WITNESSED)
    witness = run.summary["witness"]
    assert (witness["engine"], witness["trials"], witness["profile_steps"]) == ("fcl", WITNESSED, 120)
    assert witness["chord_error_um"] == by_fcl.summary["chord_error_um"] > 0
    assert witness["status_differences"] == 0
    for name in MEASURES:
        column, own = f"geometric:{name}", witness["measures"][name]
        difference = (by_fcl.columns(column)[column] - run.columns(column)[column])[chosen]
        assert own["max_abs_difference"] == np.abs(difference).max()
        assert own["mean_difference"] == pytest.approx(difference.mean(), rel=1e-12)
        assert own["rms_difference"] == pytest.approx(math.sqrt((difference**2).mean()), rel=1e-12)
        assert own["trial_of_the_largest"] == chosen[np.abs(difference).argmax()]
        assert own["compared"] == WITNESSED


def test_chord_errors_are_all_that_fcl_sees_more(run: Run) -> None:
    witness = run.summary["witness"]
    normal, turn = (witness["measures"][name] for name in MEASURES)
    assert normal["expected_at_most"] == pytest.approx(4 * witness["chord_error_um"], rel=1e-12)
    # an angle of the wheel: over its base radius of 137.5 mm cos 20 deg
    arcmin_per_um = 10800 / math.pi / 137.5e3 / math.cos(math.radians(20))
    assert turn["expected_at_most"] == pytest.approx(4 * witness["chord_error_um"] * arcmin_per_um, rel=1e-9)
    for own, unit in ((normal, 1.0), (turn, arcmin_per_um)):
        assert 0 < own["mean_difference"] <= own["rms_difference"] <= own["max_abs_difference"]
        assert own["max_abs_difference"] < own["expected_at_most"] + 0.005 * unit  # and FCL's own rounding
        # at module 2.5: a tip edge's 0.03, FCL's own 0.005, a section's squares; more would hide what is wrong
        assert 0.035 * unit < own["allowance"] <= 0.0501 * unit


def test_twice_the_profile_steps_see_a_quarter_of_the_difference(model_of: Modelling) -> None:
    means = []
    for steps in (60, 120):
        model = model_of(SPUR_PAIR.read_text("utf-8").replace("witness: 20", f"witness: 100, profile_steps: {steps}"))
        means.append(summary_of(model)["measures"]["normal backlash"]["mean_difference"])
    # the mean of 100 trials has a standard error of 5 %
    assert means[0] / means[1] == pytest.approx(4.0, rel=0.2)


def test_neither_workers_nor_kept_trials_change_the_witness(run: Run, tmp_path: Path) -> None:
    study, two = Overrides(**STUDY, witness=WITNESSED), Execution(2, keep_trials=False)
    bare = run_scene(SPUR_PAIR, overrides=study, out=tmp_path / "bare", execution=two)
    assert bare.summary["witness"] == run.summary["witness"]


def test_a_run_without_a_witness_has_none(tmp_path: Path) -> None:
    run = run_scene(SPUR_PAIR, overrides=Overrides(trials=5, witness=0), out=tmp_path / "run")
    assert "witness" not in run.summary


def test_every_kind_of_measure_and_sampler_has_a_witness(tmp_path: Path) -> None:
    study = Overrides(trials=48, sampler="sobol", witness=4)
    run = run_scene(EVERY_FIELD, overrides=study, out=tmp_path / "run")
    witness = run.summary["witness"]
    assert list(witness["measures"]) == list(run.summary["measures"])
    assert not [warning for warning in run.summary["warnings"] if "witness" in warning]
    for own in witness["measures"].values():
        assert 0 < own["max_abs_difference"] <= own["expected_at_most"] + own["allowance"]
        assert own["compared"] == 4


@pytest.mark.parametrize("scene", ["bevel_pair", "bevel_pair_3dcs", "bevel_pair_shimmed"])
def test_bevel_pairs_have_a_witness_too(scene: str) -> None:
    model = simulation_of(load(SCENES / f"{scene}.yaml"), Overrides(witness=100))
    witness = summary_of(model)
    assert witness_warnings(model, witness) == []
    for own in witness["measures"].values():
        assert 0 < own["max_abs_difference"] <= own["expected_at_most"] + own["allowance"]


def test_trials_that_cannot_be_assembled_are_not_compared(tmp_path: Path) -> None:
    wide = SPUR_PAIR.read_text("utf-8").replace("lower: -20 um, upper: 20 um", "lower: -400 um, upper: 400 um")
    run = run_scene(load(scene_of(wide, tmp_path)), overrides=Overrides(trials=60, witness=60), out=tmp_path / "run")
    witness, seated = run.summary["witness"], run.summary["status"]["ok"]
    assert 0 < seated < 60
    by_fcl = run_scene(scene_of(wide, tmp_path), overrides=Overrides(trials=60, engine="fcl"), out=tmp_path / "fcl")
    columns = [each.columns() for each in (run, by_fcl)]
    values = [each["geometric:normal backlash"] for each in columns]
    own = witness["measures"]["normal backlash"]
    assert own["compared"] == np.count_nonzero(~np.isnan(values[0]) & ~np.isnan(values[1])) < 60
    assert witness["status_differences"] == np.count_nonzero(columns[0]["status"] != columns[1]["status"])


# when it warns ---------------------------------------------------------------------------------------------------


def test_an_engine_that_sees_other_gears_is_warned_of(model_of: Modelling) -> None:
    text = SPUR_PAIR.read_text("utf-8")
    model = model_of(text)
    apart = model_of(text.replace("centre_distance: 172.5 mm", "centre_distance: 172.51 mm"))
    witness = witness_summary(model, exact_method(apart), 2000)
    # 10 um further apart: 2 sin 20 deg of that more backlash, and FCL sees that much less
    assert witness["measures"]["normal backlash"]["mean_difference"] == pytest.approx(-6.840, abs=0.05)
    warnings = witness_warnings(model, witness)
    assert len(warnings) == 2
    assert warnings[0].startswith("witness: normal backlash by FCL differs by 6.8")
    assert " um in trial " in warnings[0]


@pytest.mark.parametrize(("apart", "told"), [(0.0, False), (0.4, True), (-0.4, True)])
def test_gears_that_lie_a_quarter_of_a_micrometre_otherwise_are_warned_of(
    model_of: Modelling, apart: float, told: bool
) -> None:
    """2 sin 20 deg of 0.4 um are 0.27 um, beyond 0.08 of chords and 0.05 of whatever else, of either sign.

    Chords make FCL see up to 0.08 um more, so of 0.27 um less it sees 0.19 at least.
    """
    text = SPUR_PAIR.read_text("utf-8")
    model = model_of(text)
    other = model_of(text.replace("centre_distance: 172.5 mm", f"centre_distance: {172.5 + apart / 1000} mm"))
    witness = witness_summary(model, exact_method(other), 2000)
    assert bool(witness_warnings(model, witness)) == told


def test_what_chords_and_the_allowance_explain_is_not_warned_of() -> None:
    model = simulation_of(load(SPUR_PAIR))
    own = {"expected_at_most": 0.08, "allowance": 0.05, "trial_of_the_largest": 7}

    def told(largest: float | None, other: int = 0) -> list[str]:
        measures = {"normal backlash": {**own, "max_abs_difference": largest}}
        stated = {"engine": "fcl", "trials": 20, "measures": measures, "status_differences": other}
        found = typed_run({"trials": 20, "seed": 1, "witness": stated}).witness
        assert found is not None
        return witness_warnings(model, found)

    assert told(0.129) == told(None) == []
    assert len(told(0.131)) == 1
    assert told(0.1, other=3) == ["witness: by FCL 3 of 20 trials end with another status"]


def scene_of(text: str, folder: Path) -> Path:
    return written(text, folder)


@pytest.fixture
def model_of(tmp_path: Path) -> Modelling:
    """Makes the model of a scene's text."""
    return lambda text: simulation_of(load(scene_of(text, tmp_path)))


def exact_method(model: Simulation) -> Method:
    return model.system.method("exact", None)


def summary_of(model: Simulation) -> WitnessSummary:
    return witness_summary(model, exact_method(model), model.study.trials)
