"""What-if studies: sums of normals in closed form, and the tail of the spur pair by importance sampling and trials."""

import math
import time
from pathlib import Path

import numpy as np
import pytest
from analyses.linear_stacks import stack
from fixtures import Command
from formulas import Array, formula
from scipy.stats import norm
from toys.parabola import PARABOLA
from toys.registered import TOYS, known

from tol3d import InputError, Overrides, run_scene
from tol3d.analyses.before_after import WhatIf, first_order_ppm, what_if
from tol3d.analyses.response import Response, response_of
from tol3d.analyses.shown_what_if import what_if_report
from tol3d.analyses.stated_changes import Change, change_of, changed, factor_of, slips
from tol3d.analyses.subject import sections_of
from tol3d.assembly.zones.float_draw import FloatDraw
from tol3d.report.sheet import as_text
from tol3d.simulate import load, simulation_of
from tol3d.statistics.distributions.normal import Normal
from tol3d.study.runs.run import open_run
from tol3d.study.runs.summary.judged import JudgedMeasure
from tol3d.study.system.copula import Block
from tol3d.study.system.draw import Scalar

CENTRE = "centre distance"


def test_of_a_sum_of_normals_all_is_known() -> None:
    """sigma² = Σ (a σ)²; below -0.03 lie Φ(-0.03/σ). By rates and first order exactly, by draws within their errors."""
    slopes, sigmas = np.array([1.0, -2.0, 0.5]), np.array([0.003, 0.002, 0.008])
    own = stack(slopes, sigmas, low=-0.03)
    found = what_if(own, [Change("x1", factor=2.0)], trials=20_000).measures["gap"]
    for state, scale in ((found.before, 1.0), (found.after, 2.0)):
        sigma = float(np.linalg.norm(slopes * sigmas * [1.0, scale, 1.0]))
        assert state.sigma_by_rates == pytest.approx(sigma, rel=1e-9)
        assert state.sigma == pytest.approx(sigma, rel=4 / math.sqrt(2 * 20_000))
        limit, ppm = state.limits["low"], 1e6 * norm.cdf(-0.03 / sigma)
        assert limit.first_order == pytest.approx(ppm, rel=1e-4)
        assert limit.interval is not None
        assert limit.interval[0] * 0.9 < ppm < limit.interval[1] * 1.1
    assert found.before.failed == found.after.failed == 0


def test_correlated_contributors_add_up_by_their_correlation() -> None:
    """Var(x + y) = σ² + τ² + 2 ρ σ τ of normals; of a change of one as well."""
    draws = [Scalar(Normal(0.0, 3.0)), Scalar(Normal(1.0, 2.0))]
    own = formula(lambda x: x[:, 0] + x[:, 1], draws, blocks=[Block(("x0", "x1"), ((1.0, 0.6), (0.6, 1.0)))])
    found = what_if(own, [Change("x0", factor=2.0)], trials=0).measures["value"]
    assert found.before.sigma_by_rates == pytest.approx(math.sqrt(9 + 4 + 2 * 0.6 * 6), rel=1e-9)
    assert found.after.sigma_by_rates == pytest.approx(math.sqrt(36 + 4 + 2 * 0.6 * 12), rel=1e-9)


def test_a_float_in_a_room_has_no_rates() -> None:
    """Its measure jumps with its start, where a central difference is the jump over its step; trials know sigma.

    Where it starts decides its offset, of -1 to 1 alike: the variance is 1/3.
    """
    laws = FloatDraw(("room",), (*(f"d{k}" for k in range(6)), "start"))

    def offset(x: Array) -> Array:
        elsewhere = 2.0 * (math.e * 1e7 * x[:, 6] % 1.0) - 1.0
        return np.asarray(np.where(x[:, 6] == 0.0, x[:, 0], elsewhere) + x[:, 7])

    own = formula(offset, [laws, Scalar(Normal(0.0, 0.5))], high=1.0)
    found = what_if(own, [Change("x1", factor=0.5)], trials=4000, draws=400)
    state = found.measures["value"].before
    assert state.sigma_by_rates is None
    assert state.limits["high"].first_order is None
    assert state.sigma == pytest.approx(math.sqrt(1 / 3 + 0.25), rel=4 / math.sqrt(2 * 4000))
    assert "floats anywhere in its room" in as_text(what_if_report("play", found), 80).replace("\n ", " ")
    quick = what_if(own, [Change("x1", factor=0.5)], trials=0, draws=0)
    assert "value: known only by simulation" in as_text(what_if_report("play", quick), 80)


def test_the_answer_is_printed_first() -> None:
    """Sigma, and the fraction out of limits, before and after, above every table."""
    found = what_if(stack([1.0], [2.0], low=-5.0), [Change("x0", factor=0.5)], trials=0, draws=0)
    ppm = 1e6 * norm.cdf([-2.5, -5.0])
    lines = as_text(what_if_report("stack", found), 80).splitlines()
    assert (
        lines[2] == f"gap: sigma 2.0000 mm → 1.0000 mm (-50 %); out of limits {ppm[0] / 1e4:.4g} % → {ppm[1]:.3g} ppm"
    )


def test_a_limit_beyond_nine_sigma_is_told_by_its_bound_and_its_distance() -> None:
    """At 11.5 sigma before and at 23 after: of 300 draws none, which leaves 1 - 0.05^(1/300) = 9936 ppm."""
    own = stack([1.0], [2.0], low=-23.0, high=4.0)
    found = what_if(own, [Change("x0", factor=0.5)], trials=4000, draws=300)
    low = found.measures["gap"].before.limits["low"]
    assert (low.ppm, low.beta) == (0.0, None)
    assert low.below == pytest.approx(1e6 * (1 - 0.05 ** (1 / 300)))
    assert found.measures["gap"].before.limits["high"].below is None
    told = as_text(what_if_report("stack", found), 200)
    assert "< 9936" in told
    assert sum(line.strip().startswith("95 %") for line in told.splitlines()) == 1  # of the other limit
    mean = found.measures["gap"].before.mean
    assert mean is not None
    assert f"by slopes it lies sigmas away: before {(mean + 23) / 2:.3g}, after " in told
    assert "(+ < 0.9936 %)" in told.splitlines()[2]


def test_both_sides_see_the_same_draws() -> None:
    """With ten times the spread of what does not act on the tail the difference of the means is not noise."""
    own = stack([1.0, 1.0], [0.1, 0.001])
    found = what_if(own, [Change("x1", limits=(0.001, 0.007))], trials=500).measures["gap"]
    assert found.after.mean is not None
    assert found.before.mean is not None
    assert found.after.mean - found.before.mean == pytest.approx(0.004, abs=4 * 0.002 / math.sqrt(500))


@pytest.fixture(scope="module")
def spur() -> Response:
    return response_of(simulation_of(load("spur_pair"))).of("normal backlash")


TRUTH = {10: 1.28, 15: 7.34, 20: 40.9, 25: 184.4, 30: 639.5}
"""ppm below 25 um by half tolerance of the centre distance [um]: 40 000 draws of importance sampling each, to 1 %."""


@pytest.mark.parametrize("half", TRUTH)
def test_the_tail_of_the_spur_pair_by_first_order(spur: Response, half: int) -> None:
    found, _ = first_order_ppm(changed(spur, [change_of(spur, f"{CENTRE}=±{half}um")]), "low", 25.0)
    assert found == pytest.approx(TRUTH[half], rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("half", TRUTH)
def test_the_tail_of_the_spur_pair_by_plain_trials(spur: Response, half: int) -> None:
    own, count, below = changed(spur, [change_of(spur, f"{CENTRE}=±{half}um")]), 1_000_000, 0
    for seed in range(4):
        below += int((own.values(*own.drawn(count, seed)).values[:, 0] < 25.0).sum())
    expected = 4 * count * TRUTH[half] / 1e6
    assert abs(below - expected) < 4 * math.sqrt(expected) + 0.02 * expected


@pytest.mark.slow
def test_the_first_order_is_there_at_once(spur: Response) -> None:
    first_order_ppm(spur, "low", 25.0)
    begun = time.perf_counter()
    first_order_ppm(changed(spur, [change_of(spur, f"{CENTRE}=±10um")]), "low", 25.0)
    assert time.perf_counter() - begun < 0.2


@pytest.mark.parametrize(
    ("text", "limits"),
    [
        ("±10um", (-0.01, 0.01)),
        ("+-10 um", (-0.01, 0.01)),
        ("+/- 0.01 mm", (-0.01, 0.01)),
        ("-5 um..+10 um", (-0.005, 0.01)),
        (" -5um .. 0.01mm ", (-0.005, 0.01)),
        ("+0.02/0 mm", (0.0, 0.02)),
        ("+20 um/-5 um", (-0.005, 0.02)),
        ("[-30 um, 0.01 mm]", (-0.03, 0.01)),
    ],
)
def test_values_are_read_as_scenes_say_them(spur: Response, text: str, limits: tuple[float, float]) -> None:
    assert change_of(spur, f"{CENTRE}={text}").limits == pytest.approx(limits)
    assert changed(spur, [change_of(spur, f"{CENTRE}={text}")]).draws[CENTRE].distribution.low == limits[0]


def test_one_number_is_a_width_or_a_scale(spur: Response) -> None:
    own = changed(spur, [change_of(spur, "wheel eccentricity=4 um")]).draws["wheel eccentricity"].distribution
    assert own.mean == pytest.approx(0.004 * math.sqrt(math.pi / 2))
    gearbox = response_of(simulation_of(load("gearbox_in_housing")))
    seat = changed(gearbox, [change_of(gearbox, "dowel 1 seat=5 um")])
    same = gearbox.scaled({"dowel 1 seat": 0.5})
    assert np.array_equal(seat.drawn(20)[0], same.drawn(20)[0])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("centre=±10um", "--set: expected a contributor, got 'centre'"),
        ("centre distance", "--set: expected NAME=VALUE"),
        ("centre distance=10", "a bare number without its unit"),
        ("centre distance=±10 arcmin", "expected a length with its unit"),
        ("centre distance=5 um", "centre distance: expected limits of a law that is normal, such as ±10 um"),
        ("centre distance=172.5 mm +0.02/0", "expected limits alone, got .* with a nominal size; leave 172.5 mm out"),
        ("centre distance=+0.02/0", "expected a unit in it"),
        ("centre distance=3um..-3um", "expected a lower limit below the upper one"),
        ("wheel eccentricity=±3um", "wheel eccentricity: expected a law with limits, got Rayleigh; state one number"),
        ("bearing clearance=±3um", "bearing clearance: expected at least 0 um, for less is not physical"),
    ],
)
def test_what_cannot_be_asked_is_refused(spur: Response, text: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        changed(spur, [change_of(spur, text)])


def test_a_slip_in_the_unit_is_warned_of(spur: Response) -> None:
    """Limits of ±20 um in the scene: a hundred times as wide is ±2 mm."""
    for limits, count in (("±1.99 mm", 0), ("±2.01 mm", 1)):
        said = list(slips(spur, changed(spur, [change_of(spur, f"{CENTRE}={limits}")])))
        assert len(said) == count
    assert said == [f"{CENTRE}: normal -2010 … 2010 µm is 100 times as wide as in the scene; check the unit"]


def test_what_nobody_changes_is_refused(spur: Response) -> None:
    with pytest.raises(InputError, match="expected a change such as"):
        what_if(spur, [])
    with pytest.raises(InputError, match="expected a factor above 0 such as"):
        factor_of(spur, f"{CENTRE}=-1")
    with pytest.raises(InputError, match="centre distance: expected one change of it, got 2"):
        changed(spur, [Change(CENTRE, factor=0.5), Change(CENTRE, factor=0.5)])
    gearbox = response_of(simulation_of(load("gearbox_in_housing")))
    with pytest.raises(InputError, match="expected contributors on which 'cover gap' depends, got second wheel ecc"):
        what_if(gearbox, [Change("second wheel eccentricity", factor=0.5)], "cover gap")


def test_the_command_of_a_run_keeps_what_it_found(tol3d: Command, tmp_path: Path) -> None:
    folder = tmp_path / "run"
    run_scene("spur_pair", overrides=Overrides(trials=200), out=folder)
    files = ("--csv", f"{tmp_path}/numbers.csv", "--picture", f"{tmp_path}/picture.png")
    code, said, _ = tol3d("what-if", str(folder), "--set", f"{CENTRE}=±10um", "--draws", "400", *files)
    assert code == 0
    assert "normal -20 … 20 µm" in said
    assert "normal -10 … 10 µm" in said
    assert "sigma by rates" in (tmp_path / "numbers.csv").read_text(encoding="utf-8")
    assert (tmp_path / "picture.png").stat().st_size > 10_000
    kept = sections_of(open_run(folder))["what-if"]
    assert isinstance(kept, WhatIf)
    assert kept.changes[0].contributor == CENTRE
    assert kept.trials == 200


def test_the_command_refuses_in_one_line(tol3d: Command) -> None:
    code, _, said = tol3d("what-if", "spur_pair", "--factor", "bearing clearance=1.2", "--quick")
    assert code == 2
    assert said.strip().splitlines() == [
        "bearing clearance: expected at least 0 um, for less is not physical, got down to -0.8 um"
    ]


def test_a_mechanism_that_a_test_registers() -> None:
    with known(PARABOLA):
        own = response_of(simulation_of(load(TOYS / "parabola" / "spring.yaml")))
        name = own.contributors[0].name
        found = what_if(own, [Change(name, factor=0.5)], trials=100, draws=0)
    assert found.evaluations > 0
    for measure in found.measures.values():
        assert (measure.after.sigma_by_rates or 0.0) <= (measure.before.sigma_by_rates or 0.0)


@pytest.mark.parametrize(
    "scene", ["two_plates", *(pytest.param(own, marks=pytest.mark.slow) for own in ("spur_pair", "door"))]
)
def test_before_a_change_all_of_the_trials_is_what_a_run_has(scene: str, tmp_path: Path) -> None:
    """Parts that fail at times, gears, and parts that may overlap: to the bit."""
    run = run_scene(scene, overrides=Overrides(trials=300, witness=0), out=tmp_path / "run")
    response = response_of(simulation_of(load(scene), Overrides(trials=300)))
    found = what_if(response, [Change(next(iter(response.lines)), factor=0.9)], draws=0)
    for measure, own in found.measures.items():
        summary, before = run.found.measures[measure], own.before
        sample = summary.geometric
        assert sample is not None
        assert (before.mean, before.sigma, before.ppk) == (sample.mean, sample.sigma, sample.ppk)
        assert (before.low, before.high) == (sample.p0_135, sample.p99_865)
        assert before.failed == summary.trials - summary.seated
        verdict = JudgedMeasure.of(summary).verdict
        judged = (verdict, sample.out_ppm, sample.out_ppm_95) if verdict != "no limits" else (None, None, None)
        assert (before.verdict, before.out_ppm, before.out_ppm_95) == judged
