"""Allocation: sums of normals by Lagrange in closed form, a clutch on a grid, and the spur pair's least cost."""

import io
import math
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from analyses.linear_stacks import stack
from fixtures import Command
from formulas import formula
from rich.console import Console
from scipy.stats import norm
from toys.parabola import PARABOLA
from toys.registered import TOYS, known

from tol3d import InputError, Overrides, run_scene
from tol3d.analyses.allocate_table import allocation_report
from tol3d.analyses.allocation import allocation, ppm_of_ppk
from tol3d.analyses.allocation_section import Allocation
from tol3d.analyses.asked_allocation import bounds_of, stays_of, targets_of
from tol3d.analyses.costs import Costs, Exponential, Grades, Reciprocal, costs_from
from tol3d.analyses.response import Response, response_of
from tol3d.analyses.subject import sections_of
from tol3d.analyses.tolerance_search import Question, Target
from tol3d.simulate import load, simulation_of
from tol3d.statistics.distributions.normal import Normal
from tol3d.statistics.distributions.uniform import Uniform
from tol3d.study.runs.run import open_run
from tol3d.study.system.draw import Scalar

SLOPES, SIGMAS = np.array([1.0, -2.0, 0.5, 1.5]), np.array([0.004, 0.002, 0.006, 0.001])
WIDE = (0.05, 20.0)


def test_a_sum_of_normals_has_the_least_cost_of_lagrange() -> None:
    """Σ c/t under Σ (a σ t)² = s²: t_i ~ (c_i/(a σ)_i²)^(1/3), s the margin over the quantile of the ppm."""
    limit, ppm = -0.03, 200.0
    weights = np.array([1.0, 2.0, 0.5, 1.0])
    own = stack(SLOPES, SIGMAS, low=limit)
    costs = Costs({f"x{k}": Reciprocal(b=weight) for k, weight in enumerate(weights)})
    found = allocation(own, [Target("gap", (), ppm)], Question(costs, WIDE), draws=4000)
    parts = (SLOPES * SIGMAS) ** 2
    shape = (weights / parts) ** (1 / 3)
    reach = -limit / norm.isf(1e-6 * found.targets[0].first_order)
    factors = shape * reach / math.sqrt(float((parts * shape**2).sum()))
    assert [found.factors[f"x{k}"] for k in range(4)] == pytest.approx(factors, rel=3e-3)
    assert found.cost == pytest.approx(float((weights / factors).sum()), rel=1e-3)
    low, high = found.targets[0].interval
    assert low < ppm < high * 1.05
    equal = reach / math.sqrt(float(parts.sum()))
    assert found.equal_factor == pytest.approx(equal, rel=0.01)
    assert found.equal_cost == pytest.approx(weights.sum() / equal, rel=0.01)
    curve = [point.cost for point in found.trade_off if point.cost is not None]
    assert curve == sorted(curve, reverse=True)
    assert len(curve) == 5


def test_a_share_that_sampling_does_not_confirm_is_warned_of() -> None:
    own = stack(SLOPES, SIGMAS, low=-0.03)
    found = allocation(own, [Target("gap", (), 200.0)], Question(bounds=WIDE), draws=1000)
    missed = found.targets[0].model_copy(update={"ppm": 400.0, "interval": (380.0, 420.0)})
    words = "200 ppm were wanted, sampling says 400"
    assert words in _printed(found.model_copy(update={"targets": [missed]}))
    assert words not in _printed(found)


def _printed(found: Allocation) -> str:
    console = Console(width=200, file=io.StringIO(), record=True)
    console.print(allocation_report("stack", found))
    return console.export_text()


@pytest.mark.slow
def test_two_limits_share_a_ppm() -> None:
    """Symmetric limits: each side has half of it."""
    own = stack(SLOPES, SIGMAS, low=-0.03, high=0.03)
    found = allocation(own, [Target("gap", (), 200.0)], Question(bounds=WIDE), draws=4000)
    one = allocation(own, [Target("gap", ("low",), 100.0)], Question(bounds=WIDE), draws=4000)
    assert found.cost == pytest.approx(one.cost, rel=0.01)


def test_exponential_costs_are_stationary() -> None:
    """d cost/d log t over d β/d log t is the same for all that are within their bounds."""
    own = stack(SLOPES, SIGMAS, low=-0.03)
    costs = Costs(other=Exponential(b=3.0, k=1.2))
    found = allocation(own, [Target("gap", (), 200.0)], Question(costs, WIDE), draws=4000)
    factors = np.array([found.factors[f"x{k}"] for k in range(4)])
    slopes = np.array([Exponential(b=3.0, k=1.2).slope(factor) for factor in factors])
    rates = slopes / (SLOPES * SIGMAS * factors) ** 2
    assert rates == pytest.approx(rates.mean(), rel=0.05)


@pytest.mark.slow
def test_grades_are_the_best_of_the_table() -> None:
    """Against all combinations, by the closed form."""
    own = stack(SLOPES, SIGMAS, low=-0.03)
    table = Grades((0.63, 1.0, 1.6, 2.5), (4.0, 2.2, 1.3, 0.9))
    found = allocation(own, [Target("gap", (), 200.0)], Question(Costs(other=table), WIDE), draws=4000)

    def ppm(factors: tuple[float, ...]) -> float:
        return 1e6 * float(norm.cdf(-0.03 / np.linalg.norm(SLOPES * SIGMAS * factors)))

    fitting = [own for own in product(table.factors, repeat=4) if ppm(own) <= 200.0]
    least = min(sum(map(table.of, own)) for own in fitting)
    assert set(found.factors.values()) <= set(table.factors)
    assert found.cost == pytest.approx(least)


def test_the_clutch_costs_what_a_grid_finds() -> None:
    """Fortini's clutch: contact angle acos((hub + roller)/(cage - roller)) of four lengths, on a grid of factors."""
    nominal, sigmas = np.array([27.645, 11.43, 11.43, 50.8]), np.array([0.0167, 0.0033, 0.0033, 0.0042]) * 0.2

    def angle(x: np.ndarray) -> np.ndarray:
        hub, first, second, cage = (nominal + x).T
        half = (first + second) / 2
        return np.asarray(np.arccos(np.clip((hub + half) / (cage - half), -1.0, 1.0)))

    at = float(angle(np.zeros((1, 4)))[0])
    low = at - 0.0035  # within which the angle is straight to about 2 %
    own = formula(angle, [Scalar(Normal(0.0, sigma)) for sigma in sigmas], low=low)
    found = allocation(own, [Target("value", (), 1350.0)], Question(bounds=(0.3, 3.0)), draws=6000)
    step = 1e-5
    slopes = np.array([(angle(step * row[None]) - angle(-step * row[None]))[0] / (2 * step) for row in np.eye(4)])
    grid = np.exp(np.linspace(math.log(0.3), math.log(3.0), 31))
    factors = np.stack(np.meshgrid(grid, grid, grid, grid, indexing="ij"), axis=-1).reshape(-1, 4)
    reach = (at - low) / np.linalg.norm(slopes * sigmas * factors, axis=1)
    fitting = factors[norm.sf(reach) <= 1350e-6]
    least = float((1.0 / fitting).sum(axis=1).min())
    assert found.cost == pytest.approx(least, rel=0.03)  # a step of the grid is 8 %, along which cost is flat
    draws = np.random.default_rng(3).standard_normal((1_000_000, 4)) * sigmas * [*found.factors.values()]
    assert float((angle(draws) < low).mean()) == pytest.approx(1350e-6, rel=0.12)


@pytest.fixture(scope="module")
def spur() -> Response:
    """Below 25 um."""
    own = response_of(simulation_of(load("spur_pair"))).of("normal backlash")
    measure: Any = own.measures[0]
    return replace(own, measures=(replace(measure, lower_limit=0.025),))


@pytest.mark.slow
def test_the_spur_pair(spur: Response) -> None:
    """Equal factors cost 5.86 of 7; the least is about 5.0, and 5.2 with a bearing clearance that stays above 0."""
    question = Question(beyond_least=True)
    found = allocation(spur, [Target("normal backlash", (), 500.0)], question, draws=6000)
    assert found.equal_cost == pytest.approx(5.86, rel=0.01)
    assert found.cost == pytest.approx(5.03, rel=0.01)
    assert found.targets[0].ppm == pytest.approx(500.0, rel=0.08)
    physical = allocation(spur, [Target("normal backlash", (), 500.0)], draws=6000)
    assert physical.equal_cost == pytest.approx(5.86, rel=0.01)
    assert physical.cost == pytest.approx(5.2, rel=0.01)
    assert physical.tolerances["bearing clearance"].factor <= 16 / 14
    assert physical.tolerances["bearing clearance"].held == "at its physical least"


@pytest.mark.slow
def test_what_is_frozen_stays_and_a_limit_may(spur: Response) -> None:
    question = Question(frozen=frozenset(("reducer run-out",)), stays={"pinion tooth thickness": "high"})
    found = allocation(spur, [Target("normal backlash", (), 500.0)], question, draws=2000)
    assert found.tolerances["reducer run-out"].factor == 1.0
    assert found.tolerances["reducer run-out"].held == "frozen"
    assert found.tolerances["pinion tooth thickness"].after.endswith("… -19 µm")


def test_what_no_factor_reaches_is_refused_with_the_nearest() -> None:
    own = stack(SLOPES, SIGMAS, low=-0.01)
    nearest = 1e6 * norm.cdf(-0.01 / (0.5 * np.linalg.norm(SLOPES * SIGMAS)))
    with pytest.raises(InputError, match="gap: expected a ppm that factors within their bounds reach, got 1;") as told:
        allocation(own, [Target("gap", (), 1.0)], draws=20_000)
    said = float(str(told.value).partition("limit is ")[2].partition(" ppm")[0])
    assert said == pytest.approx(nearest, rel=0.1)


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda own: allocation(own, []), "expected a measure with limits, got none"),
        (lambda own: allocation(own, [Target("gap", ("high",), 10.0)]), "gap: expected a measure with a limit"),
        (lambda own: allocation(own, [Target("gap", (), 0.0)]), "expected a ppm above 0 and below 500000, got 0"),
        (lambda own: allocation(own, [Target("gab", (), 1.0)]), "expected a measure, got 'gab'"),
        (
            lambda own: allocation(own, [Target("gap", (), 1.0)], Question(frozen=frozenset(("x7",)))),
            "--freeze: expected a contributor, got 'x7'",
        ),
        (
            lambda own: allocation(own, [Target("gap", (), 1.0)], Question(frozen=frozenset(("x0", "x1", "x2", "x3")))),
            "expected contributors whose tolerances can be scaled, got none",
        ),
        (lambda own: targets_of(own, (), 1.0, 1.0), "expected --ppm or --ppk, got both"),
        (lambda own: bounds_of("--bounds", "2..3"), "expected bounds above 0 with 1 between them"),
        (lambda own: stays_of(["x0=up"], {}), "expected NAME=low or NAME=high, got 'x0=up'"),
    ],
)
def test_what_cannot_be_asked_is_refused(ask: object, words: str) -> None:
    assert callable(ask)
    with pytest.raises(InputError, match=words):
        ask(stack(SLOPES, SIGMAS, low=-0.03))


def test_costs_are_read_from_a_file(tmp_path: Path) -> None:
    path = tmp_path / "costs.yaml"
    path.write_text(
        "default: {kind: reciprocal, a: 1, b: 2, k: 0.5}\n"
        "contributors:\n"
        "  x0: {kind: exponential, b: 3, k: 2}\n"
        "  x1: {kind: grades, grades: {1: 2, 0.5: 5, 2: 1}}\n",
        encoding="utf-8",
    )
    costs = costs_from(path, ("x0", "x1", "x2"))
    assert costs.of("x2").of(4.0) == pytest.approx(2.0)
    assert costs.of("x0").of(0.5) == pytest.approx(3.0 * math.exp(-1.0))
    assert costs.of("x1") == Grades((0.5, 1.0, 2.0), (5.0, 2.0, 1.0))
    assert costs.of("x1").of(math.sqrt(2.0)) == pytest.approx(1.5)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("contributors: {x7: {kind: reciprocal}}", "expected a contributor, got 'x7'"),
        ("default: {kind: cubic}", "default: expected kind: reciprocal, exponential, grades"),
        ("default: {kind: reciprocal, c: 1}", "expected of reciprocal a, b, k, got 'c'"),
        ("default: {kind: reciprocal, b: -1}", "default.b: expected a number above 0"),
        ("default: {kind: grades, grades: {1: 1, 2: 3}}", "expected costs that fall as factors rise"),
        ("default: {kind: grades, grades: {1: 1}}", "expected two or more costs by factor"),
        ("costs: 1", "expected the keys default and contributors"),
        ("a: [", "not YAML: did not find expected node content"),
    ],
)
def test_costs_that_make_no_sense_are_refused(text: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "costs.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=words):
        costs_from(path, ("x0",))


@pytest.mark.slow
def test_a_ppk_is_a_share_beyond_each_limit() -> None:
    own = stack(SLOPES, SIGMAS, low=-0.03, high=0.04)
    targets = targets_of(own, (), None, 1.0)
    assert [(each.sides, each.ppm) for each in targets] == [(("low",), ppm_of_ppk(1.0)), (("high",), ppm_of_ppk(1.0))]
    found = allocation(own, targets, Question(bounds=WIDE), draws=4000)
    sigma = float(np.linalg.norm(SLOPES * SIGMAS * [*found.factors.values()]))
    assert 0.03 / (3 * sigma) == pytest.approx(1.0, rel=0.01)


def test_a_clearance_is_capped_where_it_would_be_less_than_nothing() -> None:
    laws = [Uniform(0.003, 0.013), Normal(0.0, 0.001)]
    own = stack([1.0, 1.0], [0.0, 0.0], low=-0.02, laws=laws, least=0.0)
    found = allocation(own, [Target("gap", (), 100.0)], draws=1000)
    assert found.factors["x0"] == pytest.approx(1.6, rel=1e-3)
    assert found.factors["x1"] == pytest.approx(3.0)


def test_the_command_writes_a_scene_that_is_as_good(tol3d: Command, tmp_path: Path) -> None:
    scene = tmp_path / "spur.yaml"
    scene.write_text(load("spur_pair").text.replace("lower_limit: 15 um", "lower_limit: 25 um"), encoding="utf-8")
    out = tmp_path / "new.yaml"
    files = ("--csv", f"{tmp_path}/a.csv", "--picture", f"{tmp_path}/a.png", "--out", str(out))
    code, said, _ = tol3d("allocate", str(scene), "--ppm", "500", "--draws", "2000", *files)
    assert code == 0
    assert "least cost" in said
    assert "equal factors" in (tmp_path / "a.csv").read_text(encoding="utf-8")
    assert (tmp_path / "a.png").stat().st_size > 10_000
    written = response_of(simulation_of(load(out))).of("normal backlash")
    below = float((written.values(*written.drawn(200_000)).values < 25.0).mean())
    assert 1e6 * below == pytest.approx(500.0, abs=4 * math.sqrt(500.0 * 5) + 60.0)


def test_a_run_keeps_it(tol3d: Command, tmp_path: Path) -> None:
    folder = tmp_path / "run"
    run_scene("spur_pair", overrides=Overrides(trials=100), out=folder)
    code, _, said = tol3d("allocate", str(folder), "--ppm", "500", "--draws", "1000", "--bounds", "0.9..1.1")
    assert code == 0, said
    assert "allocation" in sections_of(open_run(folder))


@pytest.mark.slow
def test_the_gearbox_s_first_stage_saves_a_fifth() -> None:
    """Below 60 um with temperatures frozen; first order alone is off by a factor, which sampling mends."""
    own = response_of(simulation_of(load("gearbox_in_housing"))).of("first normal backlash")
    measure: Any = own.measures[0]
    own = replace(own, measures=(replace(measure, lower_limit=0.060),))
    question = Question(frozen=frozenset(("housing temperature", "gear temperature")))
    found = allocation(own, [Target("first normal backlash", (), 500.0)], question)
    assert found.equal_cost is not None
    assert found.cost < 0.8 * found.equal_cost
    assert found.targets[0].interval[0] < 500.0
    assert found.targets[0].ppm < 515.0


@pytest.mark.slow
def test_a_mechanism_that_a_test_registers() -> None:
    with known(PARABOLA):
        own = response_of(simulation_of(load(TOYS / "parabola" / "spring.yaml")))
        found = allocation(own, [Target("room", (), 500.0)], draws=1000)
    assert found.evaluations > 0
    assert found.cost > 0.0
