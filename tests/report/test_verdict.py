"""The verdict at the terminal: a row a measure, by a rule that can be checked, and how much is printed beside it."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fixtures import Command
from loose_summaries import typed_measure, typed_run
from places import SCENES, SPUR_PAIR
from printing import printed
from rich.console import RenderableType
from scipy import stats

from tol3d import Overrides, Run, run_scene
from tol3d.report.page import page
from tol3d.report.sheet import as_text
from tol3d.report.table import Detail, run_report
from tol3d.report.verdict import accepted_text, short_verdict, verdict_table
from tol3d.statistics.estimates.performance_bounds import CHANCE, rank_below
from tol3d.study.runs.summary.judged import ACCEPTED_PPM, AcceptedPpk, JudgedMeasure, all_ok, trials_to_judge


def lines_of(shown: RenderableType, width: int = 200) -> list[str]:
    return printed(shown, width).splitlines()


def spur(folder: Path, limits: str, trials: int = 4000, centre: float = 172.5) -> Run:
    """The spur pair with other limits of its normal backlash, N(53.4, 7.2) um."""
    text = SPUR_PAIR.read_text("utf-8")
    for old, new in (
        ("    lower_limit: 15 um  # the paper's lower limit\n", limits),
        ("centre_distance: 172.5 mm", f"centre_distance: {centre} mm"),
        ("witness: 20", "witness: 0"),
    ):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    folder.mkdir(exist_ok=True)
    (folder / "scene.yaml").write_text(text, "utf-8")
    return run_scene(folder / "scene.yaml", overrides=Overrides(trials=trials), out=folder / "run")


def stated(below: int, trials: int, limit: float | None = 15.0) -> dict[str, Any]:
    ci = stats.binomtest(below, trials).proportion_ci(0.95, "exact")
    sample = {"trials": trials, "out_ppm": 1e6 * below / trials, "out_ppm_95": [1e6 * ci.low, 1e6 * ci.high]}
    return {"take": "value", "geometric": sample, "lower_limit": limit, "upper_limit": None}


@pytest.mark.parametrize(
    ("below", "trials", "verdict"),
    [
        (0, 1364, "too few trials"),  # 1 - 0.025^(1/n) falls below 0.0027 at n = 1365
        (0, 1365, "OK"),
        (540, 200_000, "too few trials"),  # exactly what is accepted: no number of trials tells
        (485, 200_000, "OK"),  # 55 is 2.4 standard errors of sqrt(540)
        (595, 200_000, "NOT OK"),
        (1, 20, "too few trials"),
        (5, 20, "NOT OK"),
    ],
)
def test_a_verdict_is_told_where_the_whole_interval_is_on_one_side(below: int, trials: int, verdict: str) -> None:
    assert pytest.approx(2e6 * stats.norm.sf(3), rel=1e-3) == ACCEPTED_PPM
    assert JudgedMeasure.of(typed_measure(stated(below, trials))).verdict == verdict


def test_verdicts_are_wrong_for_one_study_in_twenty_at_most() -> None:
    """Measures with just as much out as is accepted, by the binomial law of 5000 trials: no sampling."""
    counts = np.arange(40)
    wrong = [JudgedMeasure.of(typed_measure(stated(int(k), 5000))).verdict != "too few trials" for k in counts]
    assert stats.binom(5000, 0.0027).pmf(counts) @ wrong <= 0.05
    assert stats.binom(5000, 0.0027).sf(39) < 1e-6


def test_without_limits_only_failed_trials_are_judged() -> None:
    assert JudgedMeasure.of(typed_measure(stated(0, 20, limit=None))).verdict == "no limits"
    assert JudgedMeasure.of(typed_measure(stated(5, 20, limit=None))).verdict == "NOT OK"


def test_a_study_that_cannot_bound_its_share_has_too_few_trials() -> None:
    own = stated(3, 4096)
    own["geometric"]["out_ppm_95"] = None  # of replicates with few trials out
    assert JudgedMeasure.of(typed_measure(own)).verdict == "too few trials"


@pytest.mark.parametrize(("below", "trials"), [(0, 200), (0, 1364), (3, 500), (12, 3000), (9, 5000), (40, 12_000)])
def test_as_many_trials_as_are_advised_give_a_verdict_and_a_few_per_cent_fewer_do_not(below: int, trials: int) -> None:
    """With the same share out of limits; none of n is below 0.27 % from ln 0.025 / ln(1 - 0.0027) = 1365 on."""
    measure = typed_measure(stated(below, trials))
    enough = trials_to_judge(measure.shares, ACCEPTED_PPM, limited=True)
    assert enough is not None

    def verdict(count: int) -> str:
        return JudgedMeasure.of(typed_measure(stated(round(below / trials * count), count))).verdict

    assert verdict(enough) != "too few trials"
    assert [verdict(round(share * enough)) for share in (0.6, 0.75)] == ["too few trials"] * 2
    if not below:
        assert 1365 <= enough <= 1365 * 1.02


def test_no_number_of_trials_judges_a_share_that_is_what_is_accepted() -> None:
    measure = typed_measure(stated(27, 10_000))
    assert trials_to_judge(measure.shares, ACCEPTED_PPM, limited=True) is None


@pytest.mark.parametrize(("accepted", "factor"), [(1.1, (0.2 / 0.1) ** 2), (1.35, (0.3 / 0.15) ** 2), (1.2, None)])
def test_trials_for_a_ppk_grow_with_the_square_of_its_bounds_over_its_margin(
    accepted: float, factor: float | None
) -> None:
    own = typed_measure(stated(1, 400)).shares.model_copy(update={"ppk": 1.2, "ppk_95": [1.0, 1.5]})
    found = trials_to_judge(own, AcceptedPpk(accepted), limited=True)
    assert found == (None if factor is None else pytest.approx(400 * factor, abs=1.0))


def test_a_ppk_without_a_bound_needs_trials_enough_for_a_quantile_of_0_135_per_cent() -> None:
    own = typed_measure(stated(0, 400)).shares.model_copy(update={"ppk": 1.2, "ppk_95": [None, 1.5]})
    enough = trials_to_judge(own, AcceptedPpk(1.1), limited=True)
    assert enough is not None
    assert (rank_below(enough, 0.00135, CHANCE), rank_below(enough - 1, 0.00135, CHANCE)) == (1, 0)


def test_a_row_has_what_is_counted_of_the_trials(tmp_path: Path) -> None:
    run = spur(tmp_path, "    lower_limit: 45 um\n    upper_limit: 70 um\n")
    values = run.columns("geometric:normal backlash")["geometric:normal backlash"]
    out = int(((values < 45) | (values > 70)).sum())
    ci = stats.binomtest(out, 4000).proportion_ci(0.95, "exact")
    (row,) = [line for line in lines_of(verdict_table(run.found)) if line.startswith("normal backlash")]
    mean, sigma = values.mean(), values.std(ddof=1)
    ends = "  ".join(f"{value:.1f} µm" for value in (mean, mean - 3 * sigma, mean + 3 * sigma))
    shares = [f"{100 * share:.4g} %" for share in (out / 4000, ci.low, ci.high)]
    told = f"{shares[0]} (95 %: {shares[1]} to {shares[2]})"
    ppk = min(mean - 45, 70 - mean) / 3 / sigma
    assert row.split("  ", 1)[1].strip() == f"NOT OK   {ends}  45 to 70 µm  {told}  {ppk:.2f}  mean, sigma"
    narrow = as_text(verdict_table(run.found), 80).splitlines()
    assert [line.strip() for line in narrow if "fraction out" in line] == [
        f"normal backlash: fraction out of limits · {told}"  # in a line of its own
    ]
    (other,) = [line for line in lines_of(verdict_table(run.found)) if line.startswith("lost motion")]
    assert other.split()[2] == "–"  # no limits, no verdict


def test_failed_builds_are_out_of_a_measure_that_has_no_limits(tmp_path: Path) -> None:
    run = spur(tmp_path, "", centre=172.442)
    status = run.summary["measures"]["lost motion"]["status"]
    share = 100 * status["interferes"] / 4000
    assert share > 2
    (row,) = [line for line in lines_of(verdict_table(run.found)) if line.startswith("lost motion")]
    assert "NOT OK" in row
    assert f"{share:.4g} %" in row
    assert not all_ok(run.found, ACCEPTED_PPM)
    assert all_ok(run.found, 50_000)


def test_a_curve_and_a_bounded_measure_say_what_their_ends_are(tmp_path: Path) -> None:
    each = "  {0}: {{kind: normal_backlash, of: gear pair, over: turn, positions: 6, take: {1}, lower_limit: 40 um}}\n"
    text = SPUR_PAIR.read_text("utf-8").replace(
        "measures:\n  normal", f"measures:\n{each.format('curve', 'curve')}  normal", 1
    )
    (tmp_path / "scene.yaml").write_text(text, "utf-8")
    run = run_scene(tmp_path / "scene.yaml", overrides=Overrides(trials=500, witness=0), out=tmp_path / "run")
    curve = run.columns("geometric:curve")["geometric:curve"]
    (row,) = [line for line in lines_of(verdict_table(run.found)) if line.startswith("curve")]
    low = (curve.mean(axis=0) - 3 * curve.std(axis=0, ddof=1)).min()
    high = (curve.mean(axis=0) + 3 * curve.std(axis=0, ddof=1)).max()
    assert f"–  {low:.1f} µm  {high:.1f} µm" in row
    assert f"{100 * (curve < 40).any(axis=1).mean():.4g} %" in row
    lowest = curve.min(axis=1)
    assert row.rstrip().endswith(f"{(lowest.mean() - 40) / lowest.std(ddof=1) / 3:.2f}  mean, sigma")
    assert "of a curve over its positions" in " ".join(lines_of(run_report(run.found, Detail.VERDICT)))


# how much is printed --------------------------------------------------------------------------------------------------


def test_many_measures_are_a_row_each_and_their_tables_come_when_asked(tmp_path: Path) -> None:
    study = Overrides(trials=200, witness=0)
    run = run_scene(SCENES / "robot_shoulder.yaml", overrides=study, out=tmp_path / "run")
    short, whole = (lines_of(run_report(run.found, each), 120) for each in (Detail.SHORT, Detail.MEASURES))
    assert len(short) < 40 < 200 < len(whole)
    for name, own in run.summary["measures"].items():
        _, told = (line for line in short if line.startswith(f"{name}  "))
        largest = max(each["geometric_percent"] for each in own["contributors"])
        assert told.rstrip().endswith(f" {largest:.0f} %"), name
    assert any("train shoulder swing" in line for line in whole)
    assert any("more with -v: all tables" in line for line in short)
    shares = "squared range of each contributor alone"
    assert sum(shares in line for line in whole) == 1  # once for all measures
    assert not any(shares in line for line in short)


def test_the_screen_of_two_measures_has_its_verdict_first_and_thirty_lines(tmp_path: Path) -> None:
    """At 80 columns, with two lines left for the folder and its pictures. What is not explained is told, and which Ppk.

    So are warnings.
    """
    run = spur(tmp_path, "    lower_limit: 45 um\n", trials=200)
    lines = as_text(run_report(run.found, Detail.SHORT), 80).splitlines()
    assert len(lines) <= 28
    assert max(map(len, lines)) <= 80
    assert any(line.startswith("verdict: NOT OK · accepted: 0.27 % out of limits") for line in lines[:5])
    summary = dict(run.summary)
    measure = dict(summary["measures"]["lost motion"])
    fault = "part of wheel eccentricity"
    explanation = measure["agreement"]["explanation"] | {"faults": [fault]}
    measure["agreement"] = measure["agreement"] | {"explanation": explanation}
    limited = dict(summary["measures"]["normal backlash"])
    limited["geometric"] = limited["geometric"] | {"ppk_by": "share out of limits", "ppk_reason": "4 failed"}
    changed = {"lost motion": measure, "normal backlash": limited}
    summary |= {"measures": summary["measures"] | changed, "warnings": ["too warm"]}
    told = lines_of(run_report(typed_run(summary), Detail.SHORT), 80)
    assert f"lost motion: NOT EXPLAINED: {fault}" in told
    assert any(line.startswith(" Ppk of normal backlash: by share out of limits (4 failed)") for line in told)
    assert not any("Ppk of" in line for line in lines)
    assert told[-1] == "warning: too warm"


@pytest.mark.slow
def test_quiet_prints_the_verdict_and_verbose_every_table(tol3d: Command, tmp_path: Path) -> None:
    arguments = ("run", "robot_shoulder", "--trials", "100", "--witness", "0", "--no-picture")
    lengths = {}
    for said in ((), ("-q",), ("-v",)):
        code, out, _ = tol3d(*arguments, *said, "--out", str(tmp_path / "run"))
        assert code == 0
        lengths[said] = len(out.splitlines())
        assert "verdict" in out
        assert ("run: " in out) == (said != ("-q",))
    assert lengths["-q",] < lengths[()] < lengths["-v",]
    code, _, err = tol3d(*arguments, "-q", "-v")
    assert code == 2
    assert "leave out one of them" in err


def test_the_exit_code_follows_the_accepted_share_where_one_is_said(tol3d: Command, tmp_path: Path) -> None:
    """Below 40 um lie 3.1 % of N(53.4, 7.2): of 4000 trials 125, and 88 to 161 but for one seed in a thousand."""
    text = (
        SPUR_PAIR.read_text("utf-8")
        .replace("lower_limit: 15 um", "lower_limit: 40 um")
        .replace("witness: 20", "witness: 0")
    )
    (tmp_path / "scene.yaml").write_text(text, "utf-8")
    arguments = (
        "run",
        str(tmp_path / "scene.yaml"),
        "--trials",
        "4000",
        "--no-picture",
        "--out",
        str(tmp_path / "run"),
    )
    for said, code in (
        ((), 0),
        (("--accept", "1 %"), 0),
        (("--fail-on-limits",), 1),
        (("--fail-on-limits", "--accept", "1 %"), 1),
        (("--fail-on-limits", "--accept", "3.1 %"), 1),  # too few trials to say
        (("--fail-on-limits", "--accept", "50000 ppm"), 0),
    ):
        assert tol3d(*arguments, *said)[0] == code, said
    for wrong in ("0.27", "-1 %", "100 %", "few"):
        code, _, err = tol3d(*arguments, "--accept", wrong)
        assert code == 2
        assert "expected a share of the trials" in err


def test_no_count_and_no_range_is_said_to_end_below_0() -> None:
    """Quantiles of so few trials would not tell; a length of the same sample may lie on either side of 0."""
    sample = stated(0, 20)["geometric"] | {
        "count": 20,
        "mean": 1.5,
        "sigma": 1.0,
        "low_3sigma": -1.5,
        "high_3sigma": 4.5,
    }
    sample |= {"p0.135": 0.0, "p99.865": 4.0}
    shown: dict[str, dict[str, object]] = {
        "count": {"unit": "pins", "take": "value", "lower_limit": 1.0, "upper_limit": None},
        "range": {"unit": "um", "take": "range", "lower_limit": None, "upper_limit": None},
        "length": {"unit": "um", "take": "value", "lower_limit": None, "upper_limit": None},
    }
    run = typed_run({"trials": 20, "measures": {name: own | {"geometric": sample} for name, own in shown.items()}})
    cells = {row.label: [str(cell) for cell in row.cells[1:5]] for row in verdict_table(run).rows}
    assert cells["count *"] == ["1.5 pins", "0 pins", "4 pins", "≥ 1 pin"]
    assert cells["range *"][:3] == ["1.5 µm", "0.0 µm", "4.0 µm"]
    assert cells["length"][:3] == ["1.5 µm", "-1.5 µm", "4.5 µm"]


def test_a_study_asks_for_a_ppk_and_the_verdict_says_what_it_stands_for(tmp_path: Path) -> None:
    """N(53.4, 7.2) um with a lower limit of 15 um has Ppk 1.76: asked for 1.6 and for 1.9, the latter by the call."""
    text = SPUR_PAIR.read_text("utf-8").replace("witness: 20", "witness: 0, accept: {ppk: 1.6}")
    (tmp_path / "scene.yaml").write_text(text, "utf-8")
    run = run_scene(tmp_path / "scene.yaml", out=tmp_path / "run")
    assert run.summary["study"]["accept_ppk"] == 1.6
    low, high = run.summary["measures"]["normal backlash"]["geometric"]["ppk_95"]
    assert 1.6 < low < 1.76 < high < 1.9
    lines = as_text(page(*short_verdict(run.found)), 80).splitlines()
    share = f"{1e6 * stats.norm.sf(4.8):.3g} ppm"
    assert any(line.startswith(f"verdict: OK · accepted: Ppk 1.6 ({share} beyond each limit)") for line in lines)
    assert f" normal backlash: 95 % of Ppk · {low:.2f} to {high:.2f}" in [line.rstrip() for line in lines]
    assert all_ok(run.found)
    assert not all_ok(run.found, AcceptedPpk(1.9))
    assert all_ok(run.found, 2700.0)


def test_the_share_that_is_accepted_says_which_ppk_it_is() -> None:
    """Half of 0.27 % beyond each of two limits is 3 sigma, all of it beyond one 2.782 sigma."""
    shown: dict[str, Any] = {"take": "value", "geometric": {}, "lower_limit": 1.0}
    one, two = (shown | {"upper_limit": upper} for upper in (None, 2.0))
    each = {"1": [one], "2": [two], "12": [one, two]}
    words = {ends: accepted_text(2700.0, map(typed_measure, own)) for ends, own in each.items()}
    assert words["1"] == f"0.27 % out of limits (Ppk {stats.norm.isf(0.0027) / 3:.2f})"
    assert words["2"] == f"0.27 % out of limits (Ppk {stats.norm.isf(0.00135) / 3:.2f})"
    assert words["12"] == "0.27 % out of limits (Ppk 1.00 with two limits, 0.93 with one)"
