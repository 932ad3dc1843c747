"""Rare events: probabilities in closed form, design points that must not be missed, and the spur pair's tail."""

import json
import math
import signal
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest
from fixtures import Command
from oracles.limit_states import CASES, OTBENCHMARK, Case, Value, formula
from scipy.optimize import brentq
from scipy.stats import norm
from toys.parabola import PARABOLA
from toys.registered import TOYS, known

from tol3d import InputError
from tol3d.analyses.limit_state import Side
from tol3d.analyses.rare_events import Method, limits_left, rare_event
from tol3d.analyses.rare_section import RareEvents
from tol3d.analyses.response import Response, response_of
from tol3d.analyses.subject import sections_of
from tol3d.simulate import load, simulation_of
from tol3d.study.runs.run import open_run

SPUR_15 = 0.0507e-6
"""Probability of the spur pair below 15 µm: by 10^10 draws of an independent formula."""
SLOW = ("curved much in 12 dimensions", "curved in 60 dimensions", "60 contributors", "a ball in 8 dimensions")
QUICK = [own for own in (*CASES, *OTBENCHMARK) if own.name not in SLOW]


def test_a_plane_is_met_exactly() -> None:
    """A linear measure of normals is normal: β is its distance, whatever the direction; no curvature corrects it."""
    slopes = np.array([3.0, -1.0, 0.5])
    limit = 4.0 * float(np.linalg.norm(slopes))
    own = rare_event(formula(lambda x, _: x @ slopes, 3), "high", limit, method="sorm")
    assert own.points[0].beta == pytest.approx(4.0, abs=1e-6)
    assert own.points[0].sensitivities == pytest.approx(slopes / np.linalg.norm(slopes), abs=1e-6)
    assert own.first_order == pytest.approx(norm.sf(4.0), rel=1e-5)
    assert own.second_order is not None
    assert own.probability == own.second_order.hohenbichler == pytest.approx(norm.sf(4.0), rel=1e-4)
    assert own.interval == (0.0, 1.0)


def _holds(case: Case, method: Method, seed: int) -> None:
    """The truth is within five standard errors or the interval, and the error is not idle."""
    own = rare_event(case.response(), case.side, case.limit, method=method, seed=seed)
    low, high = own.interval
    assert low <= case.probability <= high or abs(own.probability - case.probability) < 5 * own.error
    if 0.0 < case.probability < 0.5:
        assert own.error < 0.35 * case.probability
    assert own.evaluations > 0


@pytest.mark.parametrize("case", QUICK, ids=lambda own: own.name)
def test_importance_sampling_knows_what_is_known(case: Case) -> None:
    _holds(case, "importance", 1)


def _away(law: Callable[[float], float], probability: float) -> float:
    """The distance that so many are beyond."""
    found: float = brentq(lambda own: math.log(law(own)) - math.log(probability), 0.1, 9.0)
    return found


def _several_regions(kind: str, probability: float) -> Case:
    """A distance across, by second order alone: both signs of one contributor, a ring of two, one side likelier."""
    laws: Mapping[str, Callable[[float], float]] = {
        "two regions": lambda own: 2 * norm.sf(own),
        "a ring": lambda own: math.exp(-own * own / 2),
        "unequal regions": lambda own: norm.sf(own - 0.4) + norm.sf(own + 0.4),
    }
    values: Mapping[str, Value] = {
        "two regions": lambda x, _: np.sqrt(1.0 + 0.01 * x[:, 0] ** 2),
        "a ring": lambda x, _: np.sqrt(1.0 + 0.01 * (x[:, 0] ** 2 + x[:, 1] ** 2)),
        "unequal regions": lambda x, _: np.sqrt(1.0 + 0.01 * (x[:, 0] + 0.4) ** 2),
    }
    limit = math.hypot(1.0, 0.1 * _away(laws[kind], probability))
    return Case(kind, values[kind], 3, "high", limit, probability)


def _holding(kind: str, probability: float, widest: float, seeds: int) -> int:
    case, held = _several_regions(kind, probability), 0
    for seed in range(1, seeds + 1):
        own = rare_event(case.response(), case.side, case.limit, seed=seed)
        low, high = own.interval
        held += low <= probability <= high
        assert high < widest * low
        assert own.evaluations <= 50_000
    return held


REGIONS = ("two regions", "a ring", "unequal regions")


@pytest.mark.parametrize("kind", REGIONS)
def test_no_region_that_acts_by_second_order_is_left_out(kind: str) -> None:
    """One of two regions left out is out of an interval of 10 %; three of four at 95 % each fail once in 70."""
    assert _holding(kind, 1e-6, 2.0, 4) >= 3


@pytest.mark.slow
@pytest.mark.parametrize(("probability", "widest"), [(1e-3, 1.5), (1e-6, 2.0)])
@pytest.mark.parametrize("kind", REGIONS)
def test_intervals_of_several_regions_hold_the_truth(kind: str, probability: float, widest: float) -> None:
    """An exact interval of 95 % holds it in fewer than 88 of 100 seeds once in 700."""
    assert _holding(kind, probability, widest, 100) >= 88


MORE = {"a plane": (1000, 931)}
"""Seeds, and how many must hold, one of 300 again: of the first 100 only 85 do, of 2000 others 1911."""


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(own, marks=pytest.mark.nightly if own.name in MORE else pytest.mark.slow, id=own.name)
        for own in (*CASES, *OTBENCHMARK)
    ],
)
def test_its_interval_holds_the_truth_in_about_95_of_100_seeds(case: Case) -> None:
    """Fewer than 88 of 100 at 95 % happen in one of 300; wider intervals where the method cannot know are no fault."""
    seeds, least = MORE.get(case.name, (100, 88))
    found = [rare_event(case.response(), case.side, case.limit, method="importance", seed=k) for k in range(seeds)]
    assert sum(own.interval[0] <= case.probability <= own.interval[1] for own in found) >= least
    if case.probability > 0.0:
        spread = float(np.mean([own.error for own in found])) / math.sqrt(len(found))
        assert abs(np.mean([own.probability for own in found]) - case.probability) < 4 * spread + 1e-12


SUBSETS = ("two symmetric design points", "a corner", "almost all fail", "beyond bounded laws", "flat")


@pytest.mark.parametrize("case", [own for own in CASES if own.name in SUBSETS], ids=lambda own: own.name)
def test_subset_simulation_knows_it_too(case: Case) -> None:
    _holds(case, "subset", 2)


@pytest.mark.slow
@pytest.mark.parametrize("case", [own for own in CASES if "subset" in own.methods], ids=lambda own: own.name)
def test_the_interval_of_subset_simulation_holds_the_truth(case: Case) -> None:
    found = [rare_event(case.response(), case.side, case.limit, method="subset", seed=k) for k in range(30)]
    assert sum(own.interval[0] <= case.probability <= own.interval[1] for own in found) >= 25


def test_of_two_design_points_none_is_left_out() -> None:
    case = next(own for own in CASES if own.name == "two symmetric design points")
    points = rare_event(case.response(), case.side, case.limit, method="form").points
    assert sorted(own.normals[0] for own in points) == pytest.approx([-4.0, 4.0], abs=0.01)


@pytest.mark.parametrize(("curvature", "beta"), [(-0.1, 4.0), (0.5, 3.0)])
def test_second_order_knows_curvatures(curvature: float, beta: float) -> None:
    """A parabola's main curvature is its own; Breitung's factor is written out here."""
    response = formula(lambda x, _: x[:, 0] - curvature / 2 * x[:, 1] ** 2, 3)
    own = rare_event(response, "high", beta, method="sorm")
    assert own.second_order is not None
    assert own.second_order.breitung == pytest.approx(norm.sf(beta) / math.sqrt(1 + beta * curvature), rel=1e-3)
    mills = norm.pdf(beta) / norm.sf(beta)
    assert own.second_order.hohenbichler == pytest.approx(norm.sf(beta) / math.sqrt(1 + mills * curvature), rel=1e-3)


def test_builds_that_do_not_seat_are_told() -> None:
    """Most failures of the jam do not seat: their share is that of the two probabilities."""
    case = next(own for own in CASES if own.name == "a jam")
    own = rare_event(case.response(), case.side, case.limit)
    assert own.estimate.unseated == pytest.approx(norm.sf(3.6) / case.probability, abs=0.01)


def test_a_method_that_cannot_know_says_so() -> None:
    case = next(own for own in CASES if own.name == "beyond bounded laws")
    own = rare_event(case.response(), case.side, case.limit)
    assert (own.probability, own.points) == (0.0, ())
    assert own.interval[1] == pytest.approx(-math.log(0.025) / own.estimate.draws, rel=1e-3)
    assert "no design point was found" in own.estimate.warnings[0]
    assert rare_event(case.response(), case.side, case.limit, method="form").estimate.probability is None


def test_a_draw_without_a_smooth_map_is_refused_by_name_and_asked_of_subsets(monkeypatch: pytest.MonkeyPatch) -> None:
    response = formula(lambda x, _: x[:, 0] + x[:, 1], 2)
    monkeypatch.setattr(Response, "rough", ("x1",))
    with pytest.raises(InputError, match=r"--method subset\) does without: x1 has none"):
        rare_event(response, "high", 5.0, method="form")
    own = rare_event(response, "high", 5.0)
    assert own.method == "subset"
    assert own.probability == pytest.approx(norm.sf(5.0 / math.sqrt(2)), abs=5 * own.error)


# the spur pair ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def spur() -> Response:
    return response_of(simulation_of(load("spur_pair"))).of("normal backlash")


def test_the_spur_pair_below_15_um(spur: Response) -> None:
    """Fewer than 8000 builds know it within 5 %."""
    own = rare_event(spur, "low", 15.0)
    assert own.evaluations < 8000
    assert own.first_order == pytest.approx(SPUR_15, rel=0.02)
    assert own.error < 0.05 * own.probability
    assert own.probability == pytest.approx(SPUR_15, rel=0.2)


@pytest.mark.parametrize(("limit", "ppm"), [(20.0, 1.8), (25.0, 41.0), (30.0, 591.0)])
def test_other_limits_of_the_spur_pair(spur: Response, limit: float, ppm: float) -> None:
    """By 10^7 plain trials, which know 1.8 ppm within 50 %, 41 within 10 % and 591 within 3 %."""
    own = rare_event(spur, "low", limit)
    known = 1.96 * math.sqrt(ppm * 10.0) / 10.0
    assert 1e6 * own.interval[0] - known < ppm < 1e6 * own.interval[1] + known
    assert own.error < 0.06 * own.probability


@pytest.mark.slow
def test_its_interval_holds_the_truth_as_often_as_it_says(spur: Response) -> None:
    found = [rare_event(spur, "low", 15.0, seed=seed) for seed in range(100)]
    held = sum(own.interval[0] <= SPUR_15 <= own.interval[1] for own in found)
    assert 90 <= held <= 99
    assert np.mean([own.probability for own in found]) == pytest.approx(SPUR_15, rel=0.01)
    assert max(own.error / own.probability for own in found) < 0.05


def test_what_cannot_be_asked_is_refused(spur: Response) -> None:
    with pytest.raises(InputError, match="expected one measure, got normal backlash, lost motion"):
        rare_event(response_of(spur.simulation), "low", 15.0)
    with pytest.raises(InputError, match=r"expected a limit .* of 'lost motion', got none"):
        limits_left(response_of(spur.simulation), "lost motion")


# the command --------------------------------------------------------------------------------------


def test_the_command_keeps_its_section_and_shows_the_design_point(tol3d: Command, tmp_path: Path) -> None:
    run = tmp_path / "run"
    assert tol3d("run", "spur_pair", "--trials", "50", "--no-picture", "--out", str(run))[0] == 0
    asked = ("--measure", "normal backlash", "--method", "form")
    files = (
        "--csv",
        str(tmp_path / "t.csv"),
        "--picture",
        str(tmp_path / "p.png"),
        "--export",
        str(tmp_path / "b.glb"),
    )
    code, out, _ = tol3d("rare", str(run), *asked, *files)
    assert code == 0
    assert "centre distance" in out
    assert all((tmp_path / name).stat().st_size > 100 for name in ("t.csv", "p.png", "b.glb"))
    kept = sections_of(open_run(run))["rare"]
    assert isinstance(kept, RareEvents)
    (limit,) = kept.limits
    assert limit.first_order_ppm == pytest.approx(1e6 * SPUR_15, rel=0.02)
    assert limit.design_point is not None
    assert limit.design_point.contributors[0].name == "centre distance"
    assert json.loads((run / "analyses" / "rare.json").read_text("utf-8"))["limits"][0]["ppm_interval"] is None


def test_a_mechanism_from_outside_has_rare_events_too(tol3d: Command) -> None:
    """Springs of a toy mechanism: limits, among them one beyond which a spring is lost; curves by their ends."""
    with known(PARABOLA):
        code, out, err = tol3d("rare", str(TOYS / "parabola" / "spring.yaml"), "--draws", "500")
    assert code == 0, err
    assert "room" in out


@pytest.mark.parametrize("side", ["low", "high"])
def test_fortinis_clutch_is_known_in_closed_form(side: Side) -> None:
    """The contact angle acos((a + c)/(e - c)) is beyond a limit where a + c - cos(limit) (e - c) has a sign: normal.

    Half height of the hub 27.645 ±0.05, radii of roller 11.43 ±0.01 and ring 50.8 ±0.0125, at 3 sigma. Far from the
    scene's own limits, which a percent of the builds leave, so that it is rare.
    """
    degrees = 5.9 if side == "low" else 8.1
    cosine = math.cos(math.radians(degrees))
    mean = 27.645 + 11.43 - cosine * (50.8 - 11.43)
    sigma = math.sqrt(0.05**2 + (1 + cosine) ** 2 * 0.01**2 + cosine**2 * 0.0125**2) / 3
    exact = norm.cdf(mean / sigma) if side == "low" else norm.sf(mean / sigma)
    response = response_of(simulation_of(load("clutch"))).of("contact angle")
    own = rare_event(response, side, 60 * degrees)
    assert own.first_order == pytest.approx(exact, rel=1e-3)
    assert own.probability == pytest.approx(exact, abs=4 * own.error)
    assert own.error < 0.04 * exact


def test_an_interrupted_question_ends_in_one_line(tol3d: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tol3d.analyses.rare_events.searched", lambda *_: signal.raise_signal(signal.SIGINT))
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's `&` has it ignored
    code, out, err = tol3d("rare", "spur_pair")
    signal.signal(signal.SIGINT, before)
    assert (code, out) == (130, "")
    assert err.removeprefix("evaluations are kept: the same command resumes from there\n") == "stopped\n"


def test_an_export_is_of_one_measure(tol3d: Command) -> None:
    code, _, err = tol3d("rare", "spur_pair", "--export", "build.glb")
    assert code == 2
    assert "--export: expected with --measure NAME" in err
