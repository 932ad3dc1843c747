"""A system of known moments through everything that a study does: it knows no gear, and needs none."""

import math
import os
import pickle
import re
import signal
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from numpy.typing import NDArray
from places import TESTS
from printing import printed
from runs.test_kill import HANGS, SMALL_BLOCKS
from scene_texts import scene_of
from schemas import validate
from scipy import integrate, stats
from toys.parabola import methods
from toys.parabola.cumulants import Cumulants, parabola, uniform
from toys.parabola.springs import LOST_LEVER, coil_weights
from toys.parabola.system import KNOTS_TO, ParabolaSystem
from toys.registered import TOYS, offered, spring_scene

from tol3d import Overrides, Run, SceneError, load_scene, open_run, run_scene
from tol3d.report.table import Detail, run_report
from tol3d.simulate import Watch, replay, simulation_of
from tol3d.study.execution.pools import Execution
from tol3d.study.results import replaying, task
from tol3d.study.results import task as task_module
from tol3d.study.runs.summary.kinds import default_kinds
from tol3d.study.runs.summary.sample import SpectrumSample
from tol3d.study.runs.worst import worst_trial
from tol3d.study.system.method import Answers
from tol3d.study.system.trials import Trials

pytestmark = pytest.mark.usefixtures("springs")

SPRING = TOYS / "parabola" / "spring.yaml"
TRIALS = 60_000
WITNESSED = 200
SURE = 5.0  # standard errors

A, B, Q = 0.5, 2e-3, 3e-3  # of the scene; 1/um
X, OFFSET, RIPPLE, WAVE = 50.0, 20.0, 2.0, 8.0  # um: sigmas, and half the width of the offset
RIPPLES = RIPPLE * math.sqrt(float(np.sum(coil_weights(40) ** 2)))
ROOM, LOST_BEYOND = 75.0, 125.0

EXACT = parabola(A, B, X) + parabola(1.0, Q, RIPPLES) + uniform((1 + LOST_LEVER) * OFFSET)
THEORY = Cumulants(0.0, A**2 * X**2 + RIPPLES**2) + uniform(OFFSET)
AT_RANDOM = Cumulants(0.0, WAVE**2 / 2, 0.0, (3 * 3 / 8 - 3 / 4) * WAVE**4)
"""Cumulants of w sin u: its fourth moment is 3 s^4 3/8."""
HALF_NORMAL = Cumulants(WAVE * math.sqrt(2 / math.pi), WAVE**2 * (1 - 2 / math.pi))
"""Cumulants of |w|, which the highest of a turn adds."""


@pytest.fixture(scope="module")
def run(springs: None, tmp_path_factory: pytest.TempPathFactory) -> Run:
    out = tmp_path_factory.mktemp("parabola") / "run"
    return run_scene(SPRING, overrides=Overrides(trials=TRIALS, witness=WITNESSED), out=out)


@pytest.fixture
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(task, "BLOCK_TRIALS", 1000)


def found(run: Run, name: str, method: str = "geometric") -> Mapping[str, Any]:
    own: Mapping[str, Any] = run.summary["measures"][name][method]
    return own


def assert_bits(first: Run, second: Run) -> None:
    """Columns and statistics, to the last bit."""
    for key in ("measures", "status", "terms", "joint"):
        assert second.summary[key] == first.summary[key]
    mine, its = first.columns(), second.columns()
    assert list(mine) == list(its)
    for name, column in mine.items():
        same = np.array_equal(column, its[name], equal_nan=column.dtype.kind == "f")
        assert same, name


# moments ------------------------------------------------------------------------------------------

MOMENTS = {
    "height": (THEORY, EXACT),
    "anywhere": (THEORY + AT_RANDOM, EXACT + AT_RANDOM),
    "highest": (THEORY + HALF_NORMAL, EXACT + HALF_NORMAL),
}


@pytest.mark.parametrize("name", MOMENTS)
@pytest.mark.parametrize("method", ["analytic", "geometric"])
def test_moments_are_those_of_the_closed_form(name: str, method: str, run: Run) -> None:
    known_moments = MOMENTS[name][method == "geometric"]
    own = found(run, name, method)
    bend = known_moments.excess_kurtosis if name != "highest" else own["kurtosis"]
    assert own["count"] == own["trials"] == TRIALS
    assert abs(own["mean"] - known_moments.k1) < SURE * known_moments.sigma / math.sqrt(TRIALS)
    sigma_error = known_moments.sigma * math.sqrt((bend + 2) / TRIALS) / 2
    assert abs(own["sigma"] - known_moments.sigma) < SURE * sigma_error
    assert own["mean_se"] == pytest.approx(known_moments.sigma / math.sqrt(TRIALS), rel=0.05)
    assert own["sigma_se"] == pytest.approx(sigma_error, rel=0.1)
    if name != "highest":
        assert own["skewness"] == pytest.approx(known_moments.skewness, abs=SURE * 3 * math.sqrt(6 / TRIALS))
        assert own["kurtosis"] == pytest.approx(known_moments.excess_kurtosis, abs=SURE * 6 * math.sqrt(24 / TRIALS))


def test_the_closed_form_of_the_theory_is_told(run: Run) -> None:
    form = run.summary["measures"]["height"]["analytic_closed_form"]
    assert (form["mean"], form["sigma"]) == pytest.approx((0.0, THEORY.sigma))
    assert "analytic_closed_form" not in run.summary["measures"]["highest"]


def test_shares_are_parts_of_the_variance_a_group_of_forty_is_one(run: Run) -> None:
    parts = {
        "x": parabola(A, B, X).k2,
        "offset": uniform((1 + LOST_LEVER) * OFFSET).k2,
        "ripple": parabola(1.0, Q, RIPPLES).k2,
    }
    theory = {"x": (A * X) ** 2, "offset": OFFSET**2 / 3, "ripple": RIPPLES**2}
    shares = run.summary["measures"]["height"]["contributors"]
    assert [own["name"] for own in shares] == list(parts)
    for own in shares:
        name = own["name"]
        assert own["analytic_percent"] == pytest.approx(100 * theory[name] / THEORY.k2)
        expected = 100 * parts[name] / EXACT.k2
        assert abs(own["geometric_percent"] - expected) < SURE * own["geometric_percent_se"] + 1e-9
        assert own["geometric_percent_se"] < 0.5


def test_high_low_mean_is_of_each_ones_ends(run: Run) -> None:
    def lifted(x: float, offset: float, ripple: float) -> float:
        return A * x + B * x**2 + (1 + LOST_LEVER) * offset + ripple + Q * ripple**2

    reach = 3 * RIPPLE * float(np.sqrt(np.sum(coil_weights(40) ** 2)))  # along the steepest direction
    three = 3 * X
    states = {
        "x": [lifted(s * three, 0, 0) for s in (-1, 0, 1)],
        "offset": [lifted(0, s * OFFSET, 0) for s in (-1, 0, 1)],
        "ripple": [lifted(0, 0, s * reach) for s in (-1, 0, 1)],
    }
    squares = {name: (max(own) - min(own)) ** 2 for name, own in states.items()}
    for own in run.summary["measures"]["height"]["contributors"]:
        expected = 100 * squares[own["name"]] / sum(squares.values())
        assert own["high_low_mean_percent"] == pytest.approx(expected, rel=1e-6)


def test_a_curve_has_the_moments_of_each_position(run: Run) -> None:
    own = run.summary["measures"]["profile"]
    angles = np.radians(own["position_deg"])
    assert len(angles) == 25
    sigmas = np.sqrt(EXACT.k2 + (WAVE * np.sin(angles)) ** 2)
    curve = own["curve"]["geometric"]
    np.testing.assert_allclose(curve["mean"], EXACT.k1, atol=SURE * sigmas.max() / math.sqrt(TRIALS))
    np.testing.assert_allclose(curve["sigma"], sigmas, rtol=SURE * 0.6 * math.sqrt(3 / TRIALS))
    assert curve["out_ppm"] == pytest.approx(found(run, "highest")["out_ppm"], abs=1e6 / TRIALS)


@pytest.mark.parametrize("method", ["analytic", "geometric"])
def test_a_curve_s_spectrum_is_pooled_over_the_trials(run: Run, method: str) -> None:
    """w sin of the position: order 1 has |w|, a half normal, of which the mean curve shows nothing."""
    spectrum = run.summary["measures"]["profile"]["curve"][method]["spectrum"]
    assert spectrum["order"] == [1.0, 2.0, 5.0]
    sigma = math.sqrt(HALF_NORMAL.k2)
    assert abs(spectrum["mean"][0] - HALF_NORMAL.k1) < SURE * sigma / math.sqrt(TRIALS)
    assert spectrum["sigma"][0] == pytest.approx(sigma, rel=SURE * math.sqrt(0.7 / TRIALS))  # kurtosis 3.87
    drawn = np.abs(run.columns("wave [um]")["wave [um]"])
    assert spectrum["max"][0] == pytest.approx(drawn.max(), rel=1e-12)
    bin_width = (HALF_NORMAL.k1 + 12 * sigma) * 1.5 / 2**12  # of a pilot's 64 trials, sigma to 9 %
    for key, share in (("p0.135", 0.00135), ("p50", 0.5), ("p99.865", 0.99865)):
        ordered = float(np.sort(drawn)[math.ceil(share * TRIALS) - 1])
        assert spectrum[key][0] == pytest.approx(ordered, abs=bin_width), key
    assert np.abs(spectrum["max"][1:]).max() < 1e-12
    assert SpectrumSample.model_validate(spectrum).p99_865 == spectrum["p99.865"]


def test_terms_of_a_breakdown_are_pooled_and_shown(run: Run) -> None:
    terms = run.summary["terms"]["height"]["geometric"]
    bow = terms["bow"]
    assert abs(bow["mean"] - B * X**2) < SURE * math.sqrt(2 / TRIALS) * B * X**2
    assert bow["share_percent"] == pytest.approx(100 * 2 * (B * X**2) ** 2 / EXACT.k2, abs=0.5)
    assert sum(term["share_percent"] for term in terms.values()) == pytest.approx(100.0)
    assert run.summary["terms"]["height"]["analytic"]["bow"] == {"mean": 0.0, "sigma": 0.0, "share_percent": 0.0}
    columns = run.columns("geometric:height", *(f"geometric:height:{term} [um]" for term in methods.TERMS))
    whole = columns.pop("geometric:height")
    np.testing.assert_allclose(sum(columns.values()), whole, atol=1e-9)


# failures -----------------------------------------------------------------------------------------


def chances() -> tuple[float, float]:
    """Probabilities of loss, and of being too long and not lost: the sum of x, ripple and offset over |x| < 125 um."""
    lost = 2 * stats.norm.sf(LOST_BEYOND / X)
    half = (1 + LOST_LEVER) * OFFSET

    x = np.linspace(-LOST_BEYOND, LOST_BEYOND, 401)[:, None]
    t = np.linspace(-6 * RIPPLES, 6 * RIPPLES, 401)[None, :]
    free = ROOM - (A * x + B * x**2 + t + Q * t**2)
    chance = np.clip((half - free) / (2 * half), 0.0, 1.0)  # that the offset takes more
    dense = chance * stats.norm.pdf(t, scale=RIPPLES) * stats.norm.pdf(x, scale=X)
    return float(lost), float(integrate.simpson(integrate.simpson(dense, t[0]), x[:, 0]))


def test_failures_are_counted_by_their_own_words_and_stay_in_the_statistics(run: Run) -> None:
    own = run.summary["measures"]["room"]
    status, sample = own["status"], own["geometric"]
    for text, chance in zip(("lost", "too long"), chances(), strict=True):
        assert abs(status[text] - TRIALS * chance) < SURE * math.sqrt(TRIALS * chance)
    assert list(run.summary["status"]) == ["ok", "too long", "lost"]
    assert run.summary["statuses"] == {"ok": "seated", "too long": "lacking", "lost": "unknown"}
    columns = run.columns("geometric:room", "status:room")
    values, texts = columns["geometric:room"], columns["status:room"]
    good = values[texts == "ok"]
    assert sample["count"] == status["ok"] == len(good)
    assert (sample["mean"], sample["sigma"]) == pytest.approx((good.mean(), good.std(ddof=1)))
    assert values[texts == "too long"].max() < 0.0
    assert np.isnan(values[texts == "lost"]).all()
    assert sample["deepest_overlap"] == np.nanmin(values)
    below = np.count_nonzero(good < 5.0) + status["too long"]
    assert sample["below_limit_ppm"] == pytest.approx(1e6 * below / TRIALS)
    assert sample["failed_ppm"] == pytest.approx(1e6 * (status["too long"] + status["lost"]) / TRIALS)
    assert sample["out_ppm"] == pytest.approx(1e6 * (below + status["lost"]) / TRIALS)
    (warning,) = (text for text in run.summary["warnings"] if text.startswith("room: ") and " lost" in text)
    assert f"{status['too long']} do not fit" in warning
    assert f"{status['lost']} lost" in warning


@pytest.mark.slow
def test_the_worst_trial_is_the_one_that_overlaps_most(run: Run) -> None:
    columns = run.columns("geometric:room", "status:room")
    deepest = int(np.nanargmin(columns["geometric:room"]))
    assert worst_trial(run) == deepest
    assert columns["status:room"][deepest] == "too long"


# what explains the methods' difference ----------------------------------------------------------------


def test_what_the_theory_leaves_out_explains_the_difference(run: Run) -> None:
    for name in ("height", "anywhere", "highest", "room"):
        own = run.summary["measures"][name]["agreement"]["explanation"]
        assert own["faults"] == []
        by = {part["contributor"]: part["by"] for part in own["linear"]}
        assert by["offset"] == "the lever of the offset"
        assert own["left_rms"] < 1e-6
    own = run.summary["measures"]["height"]["agreement"]["explanation"]
    curved = parabola(0.0, B, X) + parabola(0.0, Q, RIPPLES)
    assert own["second_order_mean"] == pytest.approx(curved.k1, rel=0.3)
    assert own["second_order_of"] == ["x"]
    assert not [text for text in run.summary["warnings"] if "methods" in text]


def test_a_wrong_coefficient_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    made = methods.Theory.answers

    def wrong(self: methods.Theory, trials: Trials, measures: Any) -> Answers:
        spring = replace(self.springs.spring, a=1.04 * self.springs.spring.a)
        return made(replace(self, springs=replace(self.springs, spring=spring)), trials, measures)

    monkeypatch.setattr(methods.Theory, "answers", wrong)
    run = run_scene(SPRING, overrides=Overrides(trials=20_000), out=tmp_path / "run")
    faults = run.summary["measures"]["height"]["agreement"]["explanation"]["faults"]
    assert faults
    assert faults[0].startswith("the two methods disagree on x: ")
    assert not any(" ripple" in fault or " offset" in fault for fault in faults)


# the witness --------------------------------------------------------------------------------------


def test_the_witness_knows_its_own_errors(run: Run) -> None:
    own = run.summary["witness"]
    error = 1e3 * 2.0 * (2 * KNOTS_TO / 120) ** 2 / 4
    assert (own["engine"], own["trials"], own["status_differences"]) == ("chords", WITNESSED, 0)
    assert own["chord_error_um"] == pytest.approx(error)
    for measure in own["measures"].values():
        assert measure["expected_at_most"] == own["chord_error_um"]
        assert 0.5 * error < measure["max_abs_difference"] <= error * (1 + 1e-9)
    assert own["measures"]["height"]["mean_difference"] > 0.0  # chords lie above
    assert not [text for text in run.summary["warnings"] if text.startswith("witness")]


def test_a_witness_that_is_further_off_than_it_says_is_told_of(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(methods.Chords, "bounds", lambda self, measure: (0.1 * 1e3 * self.chord_error, 0.0))
    run = run_scene(SPRING, overrides=Overrides(trials=2000, witness=20), out=tmp_path / "run")
    (first, *_) = (text for text in run.summary["warnings"] if text.startswith("witness"))
    assert first.startswith("witness: height by CHORDS differs by ")


@pytest.mark.slow
def test_chords_are_an_engine_of_processes_and_made_once_in_the_parent(tmp_path: Path, small_blocks: None) -> None:
    asked = Overrides(trials=400, engine="chords")
    alone = run_scene(SPRING, overrides=asked, out=tmp_path / "alone")
    several = run_scene(SPRING, overrides=asked, out=tmp_path / "several", execution=Execution(workers=2))
    assert_bits(alone, several)
    assert several.summary["timing"]["workers"] == 2
    system = simulation_of(load_scene(SPRING), asked).system
    assert int(system.materials("chords")["made by"]) == os.getpid()


# samplers -----------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("sampler", ["sobol", "latin_hypercube"])
def test_even_samplers_find_the_moments_and_tell_their_errors_by_replicates(sampler: str, tmp_path: Path) -> None:
    study = f"trials: 32768, seed: 7, sampler: {sampler}, replicates: 16"
    run = run_scene(spring_scene(tmp_path, ("trials: 20000, seed: 7", study)), out=tmp_path / "run")
    own = found(run, "height")
    assert own["error_by"] == "replicates"
    plain = EXACT.sigma / math.sqrt(32768)
    assert own["mean_se"] < 0.5 * plain  # sums of terms are what they are even in
    assert abs(own["mean"] - EXACT.k1) < SURE * 1.5 * own["mean_se"]
    assert own["sigma"] == pytest.approx(EXACT.sigma, rel=0.02)


def test_automatic_trials_stop_at_the_error_that_was_asked_for(tmp_path: Path) -> None:
    until = "trials: auto, until: {height: {mean: 0.2 um, sigma: 0.3 um}}, seed: 7"
    run = run_scene(spring_scene(tmp_path, ("trials: 20000, seed: 7", until)), out=tmp_path / "run")
    own = found(run, "height")
    assert own["mean_se"] <= 0.2
    assert own["sigma_se"] <= 0.3
    assert run.trials == task.AUTO_BLOCK_TRIALS * math.ceil((EXACT.sigma / 0.2) ** 2 / task.AUTO_BLOCK_TRIALS)


# bits ---------------------------------------------------------------------------------------------

FEW = Overrides(trials=7700, witness=20)


@pytest.mark.slow
@pytest.mark.usefixtures("small_blocks")
def test_bits_are_those_of_any_blocks_workers_and_resume(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = run_scene(SPRING, overrides=FEW, out=tmp_path / "one")
    assert_bits(first, run_scene(SPRING, overrides=FEW, out=tmp_path / "two", execution=Execution(workers=3)))
    told: list[int] = []

    def stop(count: int) -> None:
        told.append(count)
        if sum(told) >= 4000:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_scene(SPRING, overrides=FEW, out=tmp_path / "cut", watch=Watch(progress=stop))
    resumed = run_scene(SPRING, overrides=FEW, out=tmp_path / "cut", execution=Execution(resume=True))
    assert 0 < resumed.summary["timing"]["resumed_trials"] < 7700
    assert_bits(first, resumed)
    monkeypatch.setattr(task, "BLOCK_TRIALS", 4096)
    other = run_scene(SPRING, overrides=FEW, out=tmp_path / "other")
    for name, column in first.columns().items():
        assert np.array_equal(column, other.columns(name)[name], equal_nan=column.dtype.kind == "f"), name


@pytest.mark.slow
def test_a_process_that_is_killed_is_gone_on_with_by_another(tmp_path: Path) -> None:
    """The command knows the mechanism by the package that offers it."""
    offering = offered(tmp_path / "site", springs="toys.parabola:PARABOLA")
    paths = os.pathsep.join(map(str, (offering, TESTS)))

    def ended(out: Path, killed_at: int) -> int:
        words = ("run", str(SPRING), "--trials", "9000", "--workers", "1", "--no-picture", "--out", str(out))
        code = (sys.executable, "-c", SMALL_BLOCKS, str(int(signal.SIGKILL)), str(killed_at), *words)
        environment = {**os.environ, "PYTHONPATH": paths}
        return subprocess.run(code, env=environment, capture_output=True, timeout=HANGS).returncode

    assert ended(tmp_path / "whole", -1) == 0
    assert ended(tmp_path / "killed", 9) == -signal.SIGKILL
    assert not (tmp_path / "killed").exists()
    assert ended(tmp_path / "killed", -1) == 0
    resumed = open_run(tmp_path / "killed")
    assert 0 < resumed.summary["timing"]["resumed_trials"] < 9000
    assert_bits(open_run(tmp_path / "whole"), resumed)


def test_what_it_requires_and_the_files_that_it_reads_are_in_the_fingerprint(run: Run, tmp_path: Path) -> None:
    assert "jsonschema" in run.fingerprint["versions"]
    assert "python-fcl" not in run.fingerprint["versions"]
    assert set(run.summary["files"]) == {"scene.yaml", "spring.csv"}


def test_a_trial_is_replayed_from_the_files_of_the_run(run: Run) -> None:
    names = ("geometric:height", "analytic:height", "status", "x [um]", "bow [um]")
    columns = open_run(run.path).columns(*names)
    for trial in (0, 17, TRIALS - 1):
        again = replay(run.path, trial)
        assert again.geometric["height"] == columns["geometric:height"][trial]
        assert again.analytic["height"] == columns["analytic:height"][trial]
        assert again.status == columns["status"][trial]
        assert again.build.height * 1e3 == columns["geometric:height"][trial]
    assert isinstance(replaying.simulation_again(run, load_scene(SPRING).grammar).system, ParabolaSystem)


def test_columns_are_what_the_formula_says(run: Run) -> None:
    coils = [f"ripple.{coil:02d} [um]" for coil in range(40)]
    names = ["x [um]", "offset [um]", "wave [um]", "position:spring [deg]", "geometric:anywhere", "bow [um]"]
    own: dict[str, NDArray[np.float64]] = run.columns(*names, *coils)
    ripple = sum(weight * own[name] for weight, name in zip(coil_weights(40), coils, strict=True))
    expected = A * own["x [um]"] + B * own["x [um]"] ** 2 + (1 + LOST_LEVER) * own["offset [um]"] + ripple
    expected += Q * ripple**2 + own["wave [um]"] * np.sin(np.radians(own["position:spring [deg]"]))
    np.testing.assert_allclose(own["geometric:anywhere"], expected, atol=1e-9)


# the summary --------------------------------------------------------------------------------------


def test_the_summary_is_the_schemas_and_reads_back(run: Run) -> None:
    kinds = default_kinds()
    validate(run.summary, kinds.run.model_json_schema())
    again = open_run(run.path).found
    assert again.measures["height"].words == "value of the height of lift"
    assert again.measures["room"].kind == "room"
    broken = {**run.summary, "measures": {**run.summary["measures"], "room": dict(run.summary["measures"]["room"])}}
    del broken["measures"]["room"]["room_um"]
    with pytest.raises(jsonschema.ValidationError):
        validate(broken, kinds.run.model_json_schema())


def test_a_published_column_stands_beside_ours(run: Run) -> None:
    published = run.summary["measures"]["height"]["published"]["theirs"]
    assert published == {
        "mean": 5.0,
        "sigma": 30.0,
        "contributors": {"x": 80.0, "offset": 15.0},
        "description": "by hand",
    }


def test_a_system_from_outside_has_figures_of_its_own_sections_published(run: Run, tmp_path: Path) -> None:
    """0.002 mm are 2 um; ours beside them is found under the same keys."""
    assert run.summary["published"] == {"theirs": {"terms": {"height": {"bow": {"mean": 2.0, "share_percent": 3.0}}}}}
    rows = [line.split() for line in printed(run_report(run.found, Detail.MEASURES), 120).splitlines()]
    own = run.summary["terms"]["height"]
    row = next(row for row in rows if row[:5] == ["terms", "·", "height", "·", "bow"] and "mean" in row)
    assert [float(cell) for cell in row[-3:]] == pytest.approx(
        [own["analytic"]["bow"]["mean"], own["geometric"]["bow"]["mean"], 2.0], abs=6e-4
    )
    text = SPRING.read_text("utf-8")
    (tmp_path / "spring.csv").write_bytes((SPRING.parent / "spring.csv").read_bytes())
    for change, words in (
        (("terms: {height:", "terms: {hight:"), "published.theirs.terms.hight: expected the name of a height"),
        (("    terms:", "    term:"), 'published.theirs.term: unknown key "term"; did you mean "terms"?'),
        (("mean: 0.002 mm", "mean: 2 deg"), "published.theirs.terms.height.bow.mean: expected a length"),
        (("share_percent: 3", "share_percents: 3"), 'unknown key "share_percents"; did you mean "share_percent"?'),
    ):
        assert change[0] in text
        with pytest.raises(SceneError, match=re.escape(words)):
            scene_of(text.replace(*change), tmp_path)


# what is refused ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("trials: 20000", "engine: fcl, trials: 20000"), "study.engine: expected one of exact, chords, analytic"),
        (("trials: 20000", "engine: chordz, trials: 20000"), "expected one of exact, fcl, chords, analytic"),
        (
            ("trials: 20000", "engine: chords, witness: 3, trials: 20000"),
            "study.witness: expected none for chords, which is the witness itself",
        ),
    ],
)
def test_engines_and_witnesses_of_others_are_refused(change: tuple[str, str], words: str, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=words):
        simulation_of(load_scene(spring_scene(tmp_path, change)))


def test_a_file_that_makes_no_sense_and_a_system_that_cannot_be_studied_are_refused_at_their_place(
    tmp_path: Path,
) -> None:
    path = spring_scene(tmp_path)
    (tmp_path / "spring.csv").write_text("a,b\n1,2\n", "utf-8")
    with pytest.raises(SceneError, match=r"scene.yaml:3: .*spring.csv: expected a row of a, b and q"):
        simulation_of(load_scene(path))
    (tmp_path / "spring.csv").write_text("a,b,q\n0,2,3\n", "utf-8")
    with pytest.raises(SceneError, match=r"scene.yaml:3: .*a spring of a = 0 does not lift"):
        simulation_of(load_scene(path))


def test_method_tasks_pickle_without_the_registry(run: Run) -> None:
    simulation = simulation_of(load_scene(SPRING))
    task = task_module.task_of(simulation, "x", keep_trials=True)
    again = pickle.loads(pickle.dumps(task))
    mine, its = task.columns(10, 20), again.columns(10, 20)
    assert all(np.array_equal(mine[name], its[name], equal_nan=mine[name].dtype.kind == "f") for name in mine)
