"""Joint results of measures in a study: yield within all limits, and correlations, with failed trials among them."""

import csv
import math
from collections.abc import Mapping, Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from printing import printed
from schemas import validate
from scipy import stats
from toys.registered import TOYS, spring_scene

from tol3d import Overrides, Run, RunError, open_run, run_scene
from tol3d.report import run_report
from tol3d.simulate import Watch
from tol3d.study.execution.pools import Execution
from tol3d.study.results import task
from tol3d.study.runs.summary.kinds import default_kinds
from tol3d.study.runs.summary.text import typed
from tol3d.study.tallies import joint as joint_of_study
from tol3d.study.tallies.joint import MOST_IN_SUMMARY

pytestmark = pytest.mark.usefixtures("springs")

SPRING = TOYS / "parabola" / "spring.yaml"
TRIALS = 20_000
SURE = 5.0  # standard errors
ROUNDING = 1e-11  # of r
REPLICATES = 16

A, X, OFFSET, WAVE = 0.5, 50.0, 20.0, 8.0  # of the scene; um: sigmas, and half the width of the offset
RIPPLES = 2.0 * math.sqrt(20.0)  # of forty coils of 2 um, weighted by cosines
HEIGHT = A**2 * X**2 + RIPPLES**2 + OFFSET**2 / 3  # um^2, variance of the theory at rest
SCALARS = ("height", "anywhere", "highest", "room")

Limits = tuple[float | None, float | None]
LIMITS: Mapping[str, Limits] = {
    "height": (-60.0, 90.0),
    "highest": (None, 100.0),
    "profile": (None, 100.0),
    "room": (5.0, None),
}


@pytest.fixture(scope="module")
def run(springs: None, tmp_path_factory: pytest.TempPathFactory) -> Run:
    return run_scene(SPRING, overrides=Overrides(trials=TRIALS), out=tmp_path_factory.mktemp("joint") / "run")


def values_of(run: Run, method: str, name: str) -> NDArray[np.float64]:
    """Kept values of the trials, nan where one did not seat."""
    column = f"{method}:{name}"
    values = np.array(run.columns(column)[column], dtype=np.float64)
    if method == "geometric":
        values[run.columns(f"status:{name}")[f"status:{name}"] != "ok"] = np.nan
    return values


def good(run: Run, method: str) -> NDArray[np.bool_]:
    """Trials within all limits, one measure and one position at a time."""
    found = np.ones(run.trials, dtype=bool)
    for name, (lower, upper) in LIMITS.items():
        for values in np.atleast_2d(values_of(run, method, name).T):
            found &= ~np.isnan(values)
            found &= True if lower is None else ~(values < lower)
            found &= True if upper is None else ~(values > upper)
    return found


# yield --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["analytic", "geometric"])
def test_the_yield_is_of_all_trials_failed_ones_are_out(method: str, run: Run) -> None:
    own = run.summary["joint"]["yields"][method]
    within = np.count_nonzero(good(run, method))
    assert (own["trials"], own["within"]) == (TRIALS, within)
    assert own["yield_ppm"] == pytest.approx(1e6 * within / TRIALS)
    exact = stats.binomtest(within, TRIALS).proportion_ci(0.95, "exact")
    assert own["yield_ppm_95"] == pytest.approx([1e6 * exact.low, 1e6 * exact.high])
    alone = [run.summary["measures"][name].get(method, {}).get("out_ppm", 0.0) for name in LIMITS]
    assert max(alone) <= 1e6 - own["yield_ppm"] <= sum(alone) + 1e-6  # Bonferroni; `highest` has the curve's limit
    assert run.summary["joint"]["limited"] == list(LIMITS)


def test_trials_fail_in_this_study(run: Run) -> None:
    status = run.summary["measures"]["room"]["status"]
    assert min(status["lost"], status["too long"]) > 50


def test_of_one_limited_measure_the_yield_is_what_is_not_out(tmp_path: Path) -> None:
    scene = spring_scene(tmp_path, (", lower_limit: -60 um, upper_limit: 90 um", ""))
    scene.write_text(scene.read_text("utf-8").replace(", upper_limit: 100 um", ""), "utf-8")
    summary = run_scene(scene, overrides=Overrides(trials=3000), out=tmp_path / "run").summary
    assert summary["joint"]["limited"] == ["room"]
    for method, own in summary["joint"]["yields"].items():
        alone = summary["measures"]["room"][method]
        assert own["yield_ppm"] == pytest.approx(1e6 - alone["out_ppm"])
        assert own["yield_ppm_95"] == pytest.approx([1e6 - bound for bound in reversed(alone["out_ppm_95"])])


PAIRS = """scene: two pairs
parts:
  pinion: {{kind: spur_gear, teeth: 28, module: 2.5 mm, pressure_angle: 20 deg, face_width: 20 mm}}
  wheel:  {{kind: spur_gear, teeth: 110, module: 2.5 mm, pressure_angle: 20 deg, face_width: 20 mm}}
  other:  {{kind: spur_gear, teeth: 90, module: 2.5 mm, pressure_angle: 20 deg, face_width: 20 mm}}
tolerances:
  distance: {{kind: centre_distance, of: first, distribution: {{kind: normal, mean: 100 um, sigma: 9 um}}}}
  another:  {{kind: centre_distance, of: second, distribution: {{kind: normal, mean: 100 um, sigma: 15 um}}}}
  tooth: {{kind: tooth_thickness, of: pinion, distribution: {{kind: normal, mean: 0 um, sigma: {tooth} um}}}}
moves:
  first:  {{kind: mesh, driver: pinion, driven: wheel, centre_distance: 172.5 mm}}
  second: {{kind: mesh, driver: pinion, driven: other, centre_distance: 147.5 mm, azimuth: 180 deg}}
measures:
  near: {{kind: normal_backlash, of: first, lower_limit: {near} um}}
  far:  {{kind: normal_backlash, of: second, upper_limit: {far} um}}
study: {{trials: 40000, seed: 3, engine: analytic}}
"""
OPENS, CLOSES = 2 * math.sin(math.radians(20)), math.cos(math.radians(20))


@pytest.mark.parametrize("tooth", [0.0, 8.0])
def test_two_measures_that_share_a_contributor_have_the_correlation_worked_out_by_hand(
    tooth: float, tmp_path: Path
) -> None:
    """j = 2 sin(alpha) da - cos(alpha) ds: the shared tooth gives covariance cos^2(alpha) s^2, positive."""
    shared = (CLOSES * tooth) ** 2
    sigmas = [math.hypot(OPENS * own, CLOSES * tooth) for own in (9.0, 15.0)]
    truth = shared / math.prod(sigmas)
    limits = [100 * OPENS - 1.0 * sigmas[0], 100 * OPENS + 0.5 * sigmas[1]]
    scene = tmp_path / "pairs.yaml"
    scene.write_text(PAIRS.format(tooth=tooth or 1e-9, near=limits[0], far=limits[1]), "utf-8")
    run = run_scene(scene, out=tmp_path / "run")
    joint = run.summary["joint"]
    own = joint["correlations"]["analytic"]
    count = run.trials
    assert own["trials"] == [[count, count], [count, count]]
    assert abs(own["r"][0][1] - truth) < SURE * (1 - truth**2) / math.sqrt(count)
    assert own["r_low_95"][0][1] < own["r"][0][1] < own["r_high_95"][0][1]
    both = float(stats.multivariate_normal.cdf([1.0, 0.5], cov=[[1.0, -truth], [-truth, 1.0]]))
    if not tooth:
        assert both == pytest.approx(stats.norm.cdf(1.0) * stats.norm.cdf(0.5))  # independent: the product
    found = joint["yields"]["analytic"]["within"] / count
    assert abs(found - both) < SURE * math.sqrt(both * (1 - both) / count)


# correlation --------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["analytic", "geometric"])
def test_correlations_are_numpys_of_the_kept_trials_that_have_both(method: str, run: Run) -> None:
    joint = run.summary["joint"]
    assert joint["correlated"] == list(SCALARS)  # no curve
    own = joint["correlations"][method]
    values = [values_of(run, method, name) for name in SCALARS]
    for i, x in enumerate(values):
        for j, y in enumerate(values):
            both = ~np.isnan(x) & ~np.isnan(y)
            assert own["trials"][i][j] == np.count_nonzero(both)
            assert own["r"][i][j] == pytest.approx(np.corrcoef(x[both], y[both])[0, 1], abs=ROUNDING)
            bounds = stats.pearsonr(x[both], y[both]).confidence_interval(0.95)
            assert own["r_low_95"][i][j] == pytest.approx(bounds.low, abs=1e-6)  # artanh near 1 magnifies rounding
            assert own["r_high_95"][i][j] == pytest.approx(bounds.high, abs=1e-6)


def test_springs_have_the_correlations_worked_out_by_hand(run: Run) -> None:
    """At a random position w sin u comes to the height, of variance w^2/2; a room is what the height leaves."""
    r = run.summary["joint"]["correlations"]["analytic"]["r"]
    truth = math.sqrt(HEIGHT / (HEIGHT + WAVE**2 / 2))
    # both near normal; a kurtosis of 1 of both adds at most half as much again to Fisher's error
    assert abs(r[0][1] - truth) < SURE * 1.5 * (1 - truth**2) / math.sqrt(TRIALS)
    assert r[0][3] == pytest.approx(-1.0, abs=ROUNDING)
    geometric = run.summary["joint"]["correlations"]["geometric"]
    assert geometric["r"][0][3] == pytest.approx(-1.0, abs=ROUNDING)  # of those that seated
    assert geometric["trials"][0][3] == run.summary["measures"]["room"]["status"]["ok"]


def pairs_of(run: Run) -> dict[tuple[str, str], dict[str, str]]:
    """Lines of a run's correlations.csv by their two measures."""
    with (run.path / "correlations.csv").open(newline="") as file:
        return {(line["measure"], line["other"]): line for line in csv.DictReader(file)}


def test_the_table_of_correlations_has_numpys_of_every_pair_of_measures_the_largest_first(run: Run) -> None:
    found = pairs_of(run)
    assert {frozenset(pair) for pair in found} == {frozenset(pair) for pair in combinations(SCALARS, 2)}
    assert len(found) == len(SCALARS) * (len(SCALARS) - 1) // 2
    for (one, other), line in found.items():
        for method, words in (("analytic", "analytic"), ("geometric", "3D simulation")):
            x, y = values_of(run, method, one), values_of(run, method, other)
            both = ~np.isnan(x) & ~np.isnan(y)
            assert float(line[f"r, {words}"]) == pytest.approx(np.corrcoef(x[both], y[both])[0, 1], abs=ROUNDING)
            assert int(line[f"trials, {words}"]) == np.count_nonzero(both)
            bounds = stats.pearsonr(x[both], y[both]).confidence_interval(0.95)
            assert float(line[f"95 % from, {words}"]) == pytest.approx(bounds.low, abs=1e-6)
            assert float(line[f"95 % to, {words}"]) == pytest.approx(bounds.high, abs=1e-6)
    sizes = [abs(float(line["r, 3D simulation"])) for line in found.values()]
    assert sizes == sorted(sizes, reverse=True)


def test_of_more_measures_than_fit_the_summary_has_the_most_correlated(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(joint_of_study, "MOST_IN_SUMMARY", 2)
    again = run_scene(spring_scene(tmp_path), out=tmp_path / "run")
    whole, own = run.summary["joint"], again.summary["joint"]
    first, second = (SCALARS.index(name) for name in next(iter(pairs_of(run))))
    which = sorted((first, second))
    assert own["correlated"] == [SCALARS[k] for k in which]
    assert own["correlated_of"] == len(SCALARS)
    assert "correlated_of" not in whole
    for method in ("analytic", "geometric"):
        matrix = whole["correlations"][method]["r"]
        assert own["correlations"][method]["r"] == [[matrix[i][j] for j in which] for i in which]
    assert pairs_of(again) == pairs_of(run)
    assert f"the largest of {len(SCALARS)} measures" in printed(run_report(again.found))


@pytest.mark.slow
def test_correlations_of_more_measures_than_fit_the_summary_are_all_in_the_table(tmp_path: Path) -> None:
    more = "".join(f"  h{k}: {{kind: height, of: lift, upper_limit: {90 + k} um}}\n" for k in range(MOST_IN_SUMMARY))
    scene = spring_scene(tmp_path, ("measures:\n", f"measures:\n{more}"))
    run = run_scene(scene, overrides=Overrides(trials=400), out=tmp_path / "run")
    own, count = run.summary["joint"], MOST_IN_SUMMARY + len(SCALARS)
    assert len(own["correlated"]) == MOST_IN_SUMMARY
    assert own["correlated_of"] == count
    assert len(pairs_of(run)) == count * (count - 1) // 2
    assert len(own["limited"]) == MOST_IN_SUMMARY + len(LIMITS)


# samplers and bits --------------------------------------------------------------------------------


def test_even_samplers_tell_the_error_of_the_yield_by_replicates_and_none_of_r(tmp_path: Path) -> None:
    study = f"trials: 16384, seed: 7, sampler: sobol, replicates: {REPLICATES}"
    run = run_scene(spring_scene(tmp_path, ("trials: 20000, seed: 7", study)), out=tmp_path / "run")
    joint = run.summary["joint"]
    shares = 1e6 * good(run, "geometric").reshape(REPLICATES, -1).mean(axis=1)
    half = stats.t.ppf(0.975, REPLICATES - 1) * shares.std(ddof=1) / math.sqrt(REPLICATES)
    own = joint["yields"]["geometric"]
    assert own["yield_ppm_95"] == pytest.approx([shares.mean() - half, shares.mean() + half])
    found = joint["correlations"]["analytic"]
    assert found["r_low_95"] is None
    assert found["r_high_95"] is None
    assert found["r"][0][1] == pytest.approx(math.sqrt(HEIGHT / (HEIGHT + WAVE**2 / 2)), abs=1e-3)


@pytest.mark.slow
def test_bits_do_not_depend_on_workers_nor_on_an_interruption(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The interrupted run keeps no trials, so that what it had counted comes from its checkpoint."""
    monkeypatch.setattr(task, "BLOCK_TRIALS", 1000)
    asked, kept_not = Overrides(trials=7700), Execution(keep_trials=False)
    first = run_scene(SPRING, overrides=asked, out=tmp_path / "one").summary["joint"]
    several = run_scene(SPRING, overrides=asked, out=tmp_path / "two", execution=Execution(workers=3))
    told: list[int] = []

    def stop(count: int) -> None:
        told.append(count)
        if sum(told) >= 4000:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_scene(SPRING, overrides=asked, out=tmp_path / "cut", execution=kept_not, watch=Watch(progress=stop))
    again = Execution(keep_trials=False, resume=True)
    resumed = run_scene(SPRING, overrides=asked, out=tmp_path / "cut", execution=again).summary
    assert resumed["timing"]["resumed_trials"] > 0
    assert several.summary["joint"] == first == resumed["joint"]


# the summary --------------------------------------------------------------------------------------


def refused(place: str, words: str) -> Exception:
    return RunError(f"{place}: {words}")


def test_it_is_in_the_schema_and_reads_back(run: Run) -> None:
    validate(run.summary, default_kinds().run.model_json_schema())
    joint = open_run(run.path).found.joint
    assert joint is not None
    assert joint.correlations is not None
    assert joint.correlations["geometric"].r == run.summary["joint"]["correlations"]["geometric"]["r"]


def test_a_run_made_before_is_opened_without_it(run: Run) -> None:
    before = {key: value for key, value in run.summary.items() if key != "joint"}
    assert typed(before, refused).joint is None


@pytest.mark.parametrize(
    ("path", "value", "said"),
    [
        (("limited",), ["height", "nobody"], "joint.limited: expected names of measures, got nobody"),
        (("correlated",), ["height"], r"joint.correlations.analytic.r: expected 1 rows of 1, as correlated"),
        (("yields", "analytic", "within"), TRIALS + 1, f"joint.yields.analytic.within: expected at most the {TRIALS}"),
        (("correlations", "analytic", "r"), [[2.0]], "joint.correlations.analytic.r"),
        (("yields",), {}, "joint.yields: expected a yield where measures have limits"),
    ],
)
def test_one_that_contradicts_itself_is_refused(path: Sequence[str], value: Any, said: str, run: Run) -> None:
    def changed(there: Mapping[str, Any], keys: Sequence[str]) -> dict[str, Any]:
        key, *others = keys
        return {**there, key: changed(there[key], others) if others else value}

    with pytest.raises(RunError, match=said):
        typed({**run.summary, "joint": changed(run.summary["joint"], path)}, refused)
