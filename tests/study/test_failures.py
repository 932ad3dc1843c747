"""Builds that cannot be put together: what a jammed one measures, and that none of them leaves the statistics."""

import math
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from fixtures import Command
from oracles import exact_eccentric
from oracles.involute_gear import InvoluteGear
from places import SPUR_PAIR
from printing import printed
from scipy import stats
from vectors import vector

from tol3d import Overrides, Run, run_scene
from tol3d.gearing.engines import STATUS_TEXT
from tol3d.gearing.engines.gaps import STATUSES
from tol3d.report import comparison_report, run_report
from tol3d.report.compare import difference_of
from tol3d.study.results import task
from tol3d.study.runs.worst import worst_trial
from tol3d.study.system.outcome import SEATED, outcome_of

JAMMED = "interferes"
ALPHA = math.radians(20.0)
TRIALS, SEED = 20_000, 1
CENTRE = 172.442  # mm; takes 2 tan 20 deg (172.5 - 172.442) = 39.6 um of 53.4: at 7.2 um sigma one build in 36 jams
LIMIT = 15.0  # um
EXACT = 1e-6  # um; what the exact engine promises of parallel axes
FREE = 1e-3  # um; a play above minus this is called free
ARC = 1e-3 * 180 * 60 / math.pi / (137.5 * math.cos(ALPHA))  # arc minutes of the wheel for 1 um of normal backlash

TRAIN = """
scene: a train whose second mesh is tight
parts:
  motor: {{kind: shaft, carries: {{a: {{}}}}}}
  mid: {{kind: shaft, carries: {{b: {{}}, c: {{at: 30 mm}}}}}}
  out: {{kind: shaft, carries: {{d: {{}}}}}}
  a: {{kind: spur_gear, teeth: 20, module: 1 mm, face_width: 8 mm}}
  b: {{kind: spur_gear, teeth: 40, module: 1 mm, face_width: 8 mm}}
  c: {{kind: spur_gear, teeth: 20, module: 1 mm, face_width: 8 mm}}
  d: {{kind: spur_gear, teeth: 50, module: 1 mm, face_width: 8 mm}}
tolerances:
  ta: {{kind: tooth_thickness, of: a, distribution: {{kind: uniform, lower: -220 um, upper: -180 um}}}}
  tc: {{kind: tooth_thickness, of: c, distribution: {{kind: uniform, lower: -30 um, upper: 10 um}}}}
moves:
  m1: {{kind: mesh, driver: a, driven: b, centre_distance: 30 mm}}
  m2: {{kind: mesh, driver: c, driven: d, centre_distance: 35 mm}}
  t: {{kind: train, driven: motor, output: out}}
measures:
  first: {{kind: normal_backlash, of: m1}}
  second: {{kind: normal_backlash, of: m2}}
  to out: {{kind: lost_motion, of: t, {limits}}}
  to mid: {{kind: lost_motion, of: t, shaft: mid}}
study: {{trials: 4000, seed: 2, engine: {engine}}}
"""


def tight(folder: Path, *changes: tuple[str, str], centre: float = CENTRE) -> Path:
    """The spur pair at another centre distance, its text changed."""
    text = SPUR_PAIR.read_text("utf-8").replace("witness: 20", "witness: 0")
    for old, new in (("centre_distance: 172.5 mm", f"centre_distance: {centre} mm"), *changes):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    folder.mkdir(exist_ok=True)
    (folder / "scene.yaml").write_text(text, "utf-8")
    return folder / "scene.yaml"


def closed_form(columns: Mapping[str, np.ndarray], centre: float = CENTRE) -> np.ndarray:
    """Normal backlash [um] of each trial of such a scene, negative where its teeth overlap."""

    apart = centre + 1e-3 * (columns["centre distance [um]"] + columns["bearing clearance [um]"] / 2)
    angle = np.radians(columns["position:gear pair [deg]"])
    return 1e3 * exact_eccentric.normal_backlash(
        InvoluteGear(28, 2.5, ALPHA, 20.0),
        InvoluteGear(110, 2.5, ALPHA, 20.0),
        1e-3 * (columns["pinion tooth thickness [um]"] + columns["wheel tooth thickness [um]"]),
        np.stack([apart, np.zeros_like(apart)], axis=1),
        (
            1e-3 * vector(columns, "pinion eccentricity", "reducer run-out"),
            1e-3 * vector(columns, "wheel eccentricity"),
        ),
        angle,
        1,
    )


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("tight")
    return run_scene(tight(folder), overrides=Overrides(trials=TRIALS), out=folder / "run")


@pytest.fixture(scope="module")
def truth(run: Run) -> np.ndarray:
    return closed_form(run.columns())


# what a jammed build measures -----------------------------------------------------------------------------------------


def test_a_jammed_build_s_backlash_is_the_negative_one_of_the_closed_form(run: Run, truth: np.ndarray) -> None:
    columns = run.columns()
    jammed = columns["status:normal backlash"] == JAMMED
    assert 400 < jammed.sum() < 700
    assert np.array_equal(jammed, truth < -FREE)
    assert np.abs(columns["geometric:normal backlash"] - truth).max() <= EXACT
    assert run.summary["measures"]["normal backlash"]["geometric"]["deepest_overlap"] == pytest.approx(truth.min())


def test_a_jammed_build_s_free_turn_is_negative(run: Run, truth: np.ndarray) -> None:
    turn = run.columns("geometric:lost motion")["geometric:lost motion"]
    # the wheel's eccentricity of up to 30 um moves its arm by that of 129 mm: 3e-4 of 40 um
    assert np.abs(turn / ARC - truth).max() <= 3e-4 * 60
    assert np.array_equal(turn[np.abs(truth) > FREE] < 0, truth[np.abs(truth) > FREE] < 0)


@pytest.mark.parametrize("engine", ["exact", "fcl"])
def test_both_gears_and_the_arc_tell_an_overlap_by_either_engine(tmp_path: Path, engine: str) -> None:
    """Centres on their axes: an angle is the gap over the base radius, an arc that of the pitch circle."""
    turned = "lost motion:\n    kind: angular_backlash\n    of: gear pair\n    gear: wheel\n"
    more = (
        "  pinion's: {kind: angular_backlash, of: gear pair, gear: pinion}\n"
        "  arc: {kind: circumferential_backlash, of: gear pair}\n"
    )
    still = [(f"scale: {scale} um", "scale: 1e-6 um") for scale in ("5.166666666666667", "4.5", "1.3333333333333333")]
    scene = tight(tmp_path, (turned, turned + more), *still)
    columns = run_scene(scene, overrides=Overrides(trials=300, engine=engine), out=tmp_path / "run").columns()
    wanted = closed_form(columns)
    assert (wanted < -1).any()
    chords = EXACT if engine == "exact" else 0.09  # um; four chord errors of 0.021 um, and FCL's rounding
    base = {"lost motion": 137.5, "pinion's": 35.0}
    for name, radius in base.items():
        told_um = columns[f"geometric:{name}"] * math.pi / 10.8 * radius * math.cos(ALPHA)
        assert np.abs(told_um - wanted).max() <= chords + 1e-5, name
    pitch = 137.5 * CENTRE / 172.5  # the working pitch circle of the nominal pair
    arc = columns["geometric:arc"] * 137.5 * math.cos(ALPHA) / pitch
    assert np.abs(arc - wanted).max() <= chords + 1e-5


def test_an_overlap_deeper_than_fcl_can_tell_is_jammed_all_the_same(tmp_path: Path) -> None:
    """FCL measures 59 um of overlap; at a sigma of 34 um about a mean of 14 um one build in sixty is deeper."""
    wide = ("lower: -20 um, upper: 20 um", "lower: -150 um, upper: 150 um")
    study = Overrides(trials=400, engine="fcl")
    run = run_scene(tight(tmp_path, wide), overrides=study, out=tmp_path / "run")
    columns = run.columns()
    wanted, found = closed_form(columns), columns["geometric:normal backlash"]
    deep = wanted < -60
    assert deep.any()
    assert np.isnan(found[deep]).all()
    assert np.isnan(found).sum() <= (wanted < -58).sum()
    assert (columns["status:normal backlash"][deep] == JAMMED).all()
    own = run.summary["measures"]["normal backlash"]["geometric"]
    # a chord error may call a build free that is not, and put one above the limit that is below it
    sure = (wanted < LIMIT - 0.1).sum(), (wanted < LIMIT + 0.1).sum()
    assert sure[0] <= own["below_limit_ppm"] * 400 / 1e6 <= sure[1]
    assert worst_trial(run) in np.flatnonzero(deep)


# which measures fail --------------------------------------------------------------------------------------------------


def train(folder: Path, limits: str = "lower_limit: 0.5 arcmin", engine: str = "exact") -> Run:
    folder.mkdir(exist_ok=True)
    (folder / "scene.yaml").write_text(TRAIN.format(limits=limits, engine=engine), "utf-8")
    return run_scene(folder / "scene.yaml", out=folder / "run")


def test_only_measures_whose_path_holds_the_jammed_mesh_fail(tmp_path: Path) -> None:
    """A thickness above 0 jams the second mesh, a quarter of uniform draws; the first one has 170 um of backlash."""
    run = train(tmp_path)
    columns = run.columns()
    thick = columns["tc [um]"] > 0
    assert abs(thick.sum() - 1000) < 4 * math.sqrt(4000 * 0.25 * 0.75)
    for name, failed in (("first", 0 * thick), ("to mid", 0 * thick), ("second", thick), ("to out", thick)):
        assert np.array_equal(columns[f"status:{name}"] == JAMMED, failed), name
        assert run.summary["measures"][name]["status"][JAMMED] == failed.sum()
    assert np.array_equal(columns["status"] == JAMMED, thick)
    # 0.05 um of thickness is free within FREE only if the build jams by less
    assert np.array_equal(columns["geometric:second"] < 0, thick)


def test_a_train_jammed_at_one_mesh_is_not_free_by_the_play_of_the_others(tmp_path: Path) -> None:
    """Its lost motion is what the jammed mesh lacks at the output: j/r_b of d, below 0, whatever the first leaves."""
    run = train(tmp_path)
    columns = run.columns()
    thick = columns["tc [um]"] > 0
    lacks = columns["tc [um]"] / 25.0 / 1e3 * 10800 / math.pi  # j = s cos alpha, r_b = 25 mm cos alpha
    assert columns["geometric:to out"][thick] == pytest.approx(-lacks[thick], abs=1e-6)
    own = run.summary["measures"]["to out"]["geometric"]
    assert own["count"] == (~thick).sum()
    assert own["sample_min"] > 0.5  # the first mesh alone leaves 170 um/50 mm, 13 minutes
    assert own["below_limit_ppm"] == pytest.approx(1e6 * thick.mean())
    assert own["out_ppm"] == own["below_limit_ppm"] == own["failed_ppm"]
    trains = run.summary["trains"]["t"]["stages"]
    assert [stage["methods"]["geometric"]["sample_min"] > 0 for stage in trains] == [True, True]


@pytest.mark.parametrize(
    ("limits", "below"), [("upper_limit: 100 arcmin", 0.0), ("", 0.0), ("lower_limit: -500 arcmin", 1.0)]
)
def test_a_jam_is_out_by_a_limit_of_any_kind_and_below_every_lower_one(
    tmp_path: Path, limits: str, below: float
) -> None:
    run = train(tmp_path, limits or "over: random")
    own = run.summary["measures"]["to out"]
    share = 1e6 * own["status"][JAMMED] / 4000
    assert share > 2e5
    assert own["geometric"]["below_limit_ppm"] == below * share
    assert (own["geometric"]["above_limit_ppm"], own["geometric"]["out_ppm"]) == (0.0, share)
    assert (own["geometric"]["ppk"] is None) == (limits == "")
    assert own["analytic"]["out_ppm"] == 0.0  # the stack-up puts every build together


def test_a_curve_fails_as_a_whole_and_a_range_lacks_nothing(tmp_path: Path) -> None:
    """A pinion that wobbles by 20 um jams at some positions of its turn and not at others."""
    each = "kind: normal_backlash, of: gear pair, over: turn, positions: 8"
    more = (
        f"  curve: {{{each}, take: curve, lower_limit: 5 um, upper_limit: 25 um}}\n"
        f"  least: {{{each}, take: min, lower_limit: 5 um}}\n"
        f"  swing: {{{each}, take: range, lower_limit: 0 um, upper_limit: 15 um}}\n"
    )
    wobbles = ("{kind: rayleigh, scale: 4.5 um}", "{kind: constant, value: 12 um}")
    scene = tight(tmp_path, ("measures:\n", f"measures:\n{more}"), wobbles)
    run = run_scene(scene, overrides=Overrides(trials=1500), out=tmp_path / "run")
    columns, measures = run.columns(), run.summary["measures"]
    curve = columns["geometric:curve"]
    jams = (curve < -FREE).any(axis=1)
    assert (jams & (curve > FREE).any(axis=1)).any()  # some jam at a part of the turn only
    assert not np.isnan(curve).any()
    for name in ("curve", "least", "swing"):
        assert np.array_equal(columns[f"status:{name}"] == JAMMED, jams), name
    own = measures["curve"]["curve"]["geometric"]
    assert own["mean"] == pytest.approx(curve[~jams].mean(axis=0))
    below, above = (curve < 5).any(axis=1) | jams, ((curve > 25).any(axis=1) & ~jams)
    assert own["below_limit_ppm"] == pytest.approx(1e6 * below.mean())
    assert own["above_limit_ppm"] == pytest.approx(1e6 * above.mean())
    assert own["out_ppm"] == pytest.approx(1e6 * (below | above).mean())
    assert (below & above).any()
    least, swing = (measures[name]["geometric"] for name in ("least", "swing"))
    assert least["below_limit_ppm"] == pytest.approx(1e6 * (columns["geometric:least"] < 5).mean())
    out = (columns["geometric:swing"] > 15) & ~jams
    assert (swing["below_limit_ppm"], swing["failed_ppm"]) == (0.0, pytest.approx(1e6 * jams.mean()))
    assert swing["above_limit_ppm"] == pytest.approx(1e6 * out.mean())
    assert swing["out_ppm"] == pytest.approx(1e6 * (out | jams).mean())


# the statistics -------------------------------------------------------------------------------------------------------


def test_what_is_below_a_limit_is_counted_of_all_builds_jams_included(run: Run, truth: np.ndarray) -> None:
    own, below = run.summary["measures"]["normal backlash"]["geometric"], int((truth < LIMIT).sum())
    assert own["below_limit_ppm"] == 1e6 * below / TRIALS
    exact = stats.binomtest(below, TRIALS).proportion_ci(0.95, "exact")
    assert own["below_limit_ppm_95"] == pytest.approx([1e6 * exact.low, 1e6 * exact.high], rel=1e-9)
    assert (own["out_ppm"], own["out_ppm_95"]) == (own["below_limit_ppm"], own["below_limit_ppm_95"])
    assert own["ppk"] == pytest.approx(stats.norm.isf(below / TRIALS) / 3, abs=1e-12)
    assert own["ppk_by"] == "share out of limits"
    # the stack-up, which seats them all, is within the few builds that lie between both methods of the limit
    analytic = run.summary["measures"]["normal backlash"]["analytic"]
    assert abs(analytic["below_limit_ppm"] - own["below_limit_ppm"]) < 300
    assert analytic["ppk_by"] == "mean and sigma"


def test_mean_sigma_quantiles_bars_and_differences_are_of_the_builds_that_seated(run: Run, truth: np.ndarray) -> None:
    measure = run.summary["measures"]["normal backlash"]
    own, seated = measure["geometric"], truth[truth >= -FREE]
    assert (own["count"], own["trials"]) == (len(seated), TRIALS)
    assert own["mean"] == pytest.approx(seated.mean(), abs=EXACT)
    assert own["sigma"] == pytest.approx(seated.std(ddof=1), abs=EXACT)
    assert own["mean_se"] == pytest.approx(seated.std(ddof=1) / math.sqrt(len(seated)), abs=EXACT)
    assert own["sample_min"] == pytest.approx(seated.min(), abs=EXACT)
    assert own["p0.135"] == pytest.approx(np.quantile(seated, 0.00135), abs=0.02)  # between neighbours of 19 441
    assert sum(measure["histogram"]["counts"]["geometric"]) == len(seated)
    assert measure["agreement"]["compared"] == len(seated)
    difference = difference_of(run, "normal backlash")
    assert difference is not None
    assert difference.largest == pytest.approx(measure["agreement"]["max_abs_difference"], rel=1e-12)
    shares = {own["name"]: own["geometric_percent"] for own in measure["contributors"]}
    assert sum(shares.values()) == pytest.approx(100, abs=0.5)


def test_failed_builds_count_the_same_in_any_blocks(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(task, "BLOCK_TRIALS", 3000)
    cut = run_scene(tight(tmp_path), overrides=Overrides(trials=TRIALS), out=tmp_path / "run")
    for name, measure in run.summary["measures"].items():
        assert cut.summary["measures"][name]["status"] == measure["status"]
        for key in ("below_limit_ppm", "out_ppm", "out_ppm_95", "failed_ppm", "ppk", "deepest_overlap", "count"):
            assert cut.summary["measures"][name]["geometric"][key] == measure["geometric"][key], key


def test_replicates_count_failed_builds_too(tmp_path: Path) -> None:
    study = ("sampler: monte_carlo", "sampler: sobol, replicates: 8")
    run = run_scene(tight(tmp_path, study), overrides=Overrides(trials=8192), out=tmp_path / "run")
    truth = closed_form(run.columns())
    own = run.summary["measures"]["normal backlash"]["geometric"]
    assert own["below_limit_ppm"] == 1e6 * (truth < LIMIT).sum() / 8192
    parts = 1e6 * (truth < LIMIT).reshape(8, 1024).mean(axis=1)  # replicates follow each other
    half = parts.std(ddof=1) / math.sqrt(8) * stats.t.ppf(0.975, 7)
    assert own["out_ppm_95"] == pytest.approx([parts.mean() - half, parts.mean() + half], rel=1e-9)


def test_builds_out_of_range_are_out_of_limits_and_said_aloud(tmp_path: Path) -> None:
    """A centre distance a hundred times too coarse: the stack-up has 467 250 ppm, the builds that seat 48 000."""
    wide = ("lower: -20 um, upper: 20 um", "lower: -2 mm, upper: 2 mm")
    scene = tight(tmp_path, wide, centre=172.5)
    run = run_scene(scene, overrides=Overrides(trials=TRIALS), out=tmp_path / "run")
    measure, columns = run.summary["measures"]["normal backlash"], run.columns()
    status, values = columns["status:normal backlash"], columns["geometric:normal backlash"]
    assert measure["status"] == {text: int((status == text).sum()) for text in STATUS_TEXT.values()}
    assert measure["status"]["ok"] == 4983
    assert np.isnan(values[status == "out of range"]).all()
    own = measure["geometric"]
    jammed, seated = status == JAMMED, status == SEATED
    assert own["below_limit_ppm"] == 1e6 * (jammed | (seated & (values < LIMIT))).mean()
    assert own["out_ppm"] == 1e6 * (~seated | (values < LIMIT)).mean()
    assert own["out_ppm"] > measure["analytic"]["out_ppm"] > 460_000
    assert own["ppk"] < measure["analytic"]["ppk"] < 0.05
    loud = run.summary["warnings"][0]
    assert loud.startswith(
        "normal backlash, lost motion: 75.1 % of 20000 builds could not be assembled (3280 jam, 11737 are out of range)"
    )
    assert "of the 4983 assembled builds" in loud


@pytest.mark.parametrize(("centre", "loud"), [(172.456, False), (172.454, True)])
def test_failures_are_said_aloud_from_one_in_a_thousand_on(tmp_path: Path, centre: float, loud: bool) -> None:
    """Means of 23.4 and 22.0 um at a sigma of 7.2 um: 0.6 and 1.1 builds in a thousand, of 20 000."""
    run = run_scene(tight(tmp_path, centre=centre), overrides=Overrides(trials=TRIALS), out=tmp_path / "run")
    failed = TRIALS - run.summary["measures"]["normal backlash"]["status"]["ok"]
    assert (failed > 20) == loud
    assert failed > 0
    assert ("jam" in run.summary["warnings"][0]) == loud


# where it is shown ----------------------------------------------------------------------------------------------------


WORDS = ("assembled", "jammed")


def test_tables_say_of_how_many_builds_they_are(run: Run, truth: np.ndarray) -> None:
    seated = int((truth >= -FREE).sum())
    lines = printed(run_report(run.found)).splitlines()
    seats, jams = (next(line.split() for line in lines if line.startswith(f"trials {word}")) for word in WORDS)
    # columns: closed form, same trials, 3D simulation, two published ones
    assert seats[2:] == ["–", str(TRIALS), str(seated), "–", "–"]
    assert jams[2:] == ["–", "0", str(TRIALS - seated), "–", "–"]
    told = r"warning: normal backlash, lost motion: [\d.]+ % of 20000 builds could not"
    assert any(re.match(told, line) for line in lines)
    assert f"{seated} of {TRIALS}" in printed(comparison_report([run]))


def test_the_worst_build_is_the_one_that_is_jammed_deepest(run: Run, truth: np.ndarray, tmp_path: Path) -> None:
    assert worst_trial(run) == int(truth.argmin())
    jammed_lost_motion = train(tmp_path, "upper_limit: 100 arcmin")
    assert worst_trial(jammed_lost_motion) == int(jammed_lost_motion.columns("tc [um]")["tc [um]"].argmax())


def test_the_command_fails_on_limits_where_a_build_jams_without_any(tol3d: Command, tmp_path: Path) -> None:
    scene = tight(tmp_path, ("    lower_limit: 15 um  # the paper's lower limit\n", ""))
    arguments = ("run", str(scene), "--trials", "2000", "--out", str(tmp_path / "run"), "--no-picture")
    code, out, _ = tol3d(*arguments, "--fail-on-limits")
    assert code == 1
    assert re.search(r"\d+ could not be assembled \(.* %\): \d+ jammed", out)
    assert tol3d(*arguments)[0] == 0


def test_a_high_low_mean_share_is_not_told_where_an_end_jams(tmp_path: Path) -> None:
    """An end of the centre distance alone jams: 53.4 um less 2 tan 20 deg of 100 um."""
    wide = ("lower: -20 um, upper: 20 um", "lower: -100 um, upper: 100 um")
    run = run_scene(tight(tmp_path, wide, centre=172.5), overrides=Overrides(trials=50), out=tmp_path / "run")
    own = run.summary["measures"]["normal backlash"]["contributors"]
    assert {row["high_low_mean_percent"] for row in own} == {None}


def test_the_witness_compares_builds_that_end_alike(tmp_path: Path) -> None:
    """FCL sees a jam up to 0.084 um later: a train's values jump by the other meshes' play there."""
    (tmp_path / "scene.yaml").write_text(TRAIN.format(limits="over: random", engine="exact"), "utf-8")
    study = Overrides(trials=400, witness=400)
    run = run_scene(tmp_path / "scene.yaml", overrides=study, out=tmp_path / "run")
    witness = run.summary["witness"]
    status = run.summary["measures"]["to out"]["status"]
    assert status[JAMMED] > 60
    assert witness["measures"]["to out"]["compared"] == 400 - witness["status_differences"]
    assert not [warning for warning in run.summary["warnings"] if warning.startswith("witness: ")]


def test_columns_without_a_status_of_their_own_are_read_by_their_gaps() -> None:
    """Runs made before measures had a status left failed trials empty."""
    columns = {"geometric:a": np.array([1.0, math.nan]), "status": np.array(["ok", "interferes"])}
    found = outcome_of(columns, "geometric", "a", {JAMMED})
    assert np.array_equal(found.values, columns["geometric:a"], equal_nan=True)
    assert (found.lacking, found.deepest) == (None, math.inf)


def test_words_of_outcomes_are_those_of_the_engines() -> None:
    assert {SEATED, JAMMED} == {STATUS_TEXT[0], STATUS_TEXT[1]} == {STATUSES.seated, *STATUSES.lacking}
