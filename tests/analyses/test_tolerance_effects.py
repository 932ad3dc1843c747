"""Effects: Sobol' indices and Shapley effects known in closed form, changes of linear measures, blame for failures."""

import math
from itertools import permutations
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from formulas import formula
from scipy.stats import multivariate_normal, norm
from toys.parabola import PARABOLA
from toys.registered import TOYS, known
from typer.testing import CliRunner

from tol3d import InputError, Overrides, open_run, run_scene
from tol3d.analyses import blame
from tol3d.analyses.response import response_of
from tol3d.analyses.shown_effects import effects_report, whole_table
from tol3d.analyses.subject import sections_of
from tol3d.analyses.tolerance_effects import Effects, Index, MeasureEffects, default_base, effects
from tol3d.cli import app
from tol3d.simulate import load, simulation_of
from tol3d.statistics.distributions.normal import Normal
from tol3d.statistics.distributions.uniform import Uniform
from tol3d.statistics.estimates.shapley import linear_shapley
from tol3d.study.system.copula import Block
from tol3d.study.system.draw import Draw, Planar, Scalar

Array = np.ndarray


def shares(own: MeasureEffects, which: str) -> list[float]:
    found = [getattr(each, which) for each in own.contributors.values()]
    return [each.share for each in found]


def only(found: Effects) -> MeasureEffects:
    (own,) = found.measures.values()
    return own


def holds(index: Index | None, truth: float, sigmas: float = 2.5) -> bool:
    """Within so many standard errors; Sobol' points are better than their bootstrap says."""
    assert index
    return abs(index.share - truth) <= sigmas * (index.high - index.low) / (2 * 1.96) + 1e-12


# indices known in closed form ---------------------------------------------------------------------------


def test_indices_of_ishigami() -> None:
    """sin x0 + 7 sin² x1 + 0.1 x2⁴ sin x0, uniform within ±π: Ishigami and Homma 1990."""
    own = formula(
        lambda x: np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0]),
        [Scalar(Uniform(-math.pi, math.pi))] * 3,
    )
    found = only(effects(own, base=8192))
    variances = [0.5 * (1 + 0.1 * math.pi**4 / 5) ** 2, 49 / 8, 8 * 0.01 * math.pi**8 / 225]
    whole = sum(variances)
    assert found.sigma == pytest.approx(math.sqrt(whole), rel=0.01)
    first = [variances[0], variances[1], 0.0]
    total = [variances[0] + variances[2], variances[1], variances[2]]
    for each, one, every in zip(found.contributors.values(), first, total, strict=True):
        assert holds(each.first, one / whole)
        assert holds(each.total, every / whole)
        assert each.first
        assert each.first.high - each.first.low < 0.06


def test_indices_of_the_g_function() -> None:
    """Π (|4 u - 2| + a) / (1 + a): Saltelli and Sobol' 1995."""
    a = np.array([0.0, 1.0, 4.5, 9.0])
    own = formula(lambda x: np.prod((np.abs(4 * x - 2) + a) / (1 + a), axis=1), [Scalar(Uniform(0.0, 1.0))] * 4)
    alone = 1 / 3 / (1 + a) ** 2
    whole = np.prod(1 + alone) - 1
    found = only(effects(own, base=8192))
    for each, v in zip(found.contributors.values(), alone, strict=True):
        assert holds(each.first, v / whole)
        assert holds(each.total, v * (whole + 1) / (1 + v) / whole)


def test_normals_of_a_direction_are_one_input() -> None:
    """x y of a length in a random direction has no part of x or y alone, and all of it is the contributor's."""
    draws: list[Draw] = [Planar(Normal(2.0, 0.5), None), Scalar(Normal(0.0, 1.0))]
    own = formula(lambda x: x[:, 0] * x[:, 1] + 2 * x[:, 2], draws)
    # E of r⁴ for the law of the length, times 1/8, the mean of (sin 2φ / 2)²
    moment = 2.0**4 + 6 * 2.0**2 * 0.5**2 + 3 * 0.5**4
    found = only(effects(own, base=8192))
    directed, plain = found.contributors.values()
    assert holds(directed.first, moment / 8 / (moment / 8 + 4))
    assert holds(directed.total, moment / 8 / (moment / 8 + 4))
    assert holds(plain.first, 4 / (moment / 8 + 4))


def test_intervals_hold_the_truth() -> None:
    """95 % intervals over seeds; Sobol' points are better than that, so that they may only hold it more often."""
    own = formula(lambda x: x[:, 0] + 2 * x[:, 1] * x[:, 2], 3)
    held = 0
    for seed in range(40):
        found = only(effects(own, base=256, seed=seed))
        firsts = zip(found.contributors.values(), (0.2, 0.0, 0.0), strict=True)
        held += sum(holds(each.first, truth, 1.96) for each, truth in firsts)
    assert held >= 107  # of 120 intervals of 95 %: 114 expected, 3 sigma


def test_a_roller_in_a_clutch() -> None:
    """Fortini's clutch by a formula of its own: conditional means by quadrature in normals."""
    response = response_of(simulation_of(load("clutch")))
    nodes, weights = np.polynomial.hermite_e.hermegauss(12)
    weights = weights / weights.sum()
    hub, roller, ring = np.meshgrid(*[nodes] * 3, indexing="ij")
    angle = np.arccos(
        (27.645 + 0.05 / 3 * hub + 11.43 + 0.01 / 3 * roller) / (50.8 + 0.0125 / 3 * ring - 11.43 - 0.01 / 3 * roller)
    )
    mean = np.einsum("ijk,i,j,k", angle, weights, weights, weights)
    variance = np.einsum("ijk,i,j,k", (angle - mean) ** 2, weights, weights, weights)
    means = [
        np.einsum("ijk,j,k->i", angle, weights, weights),
        np.einsum("ijk,i,k->j", angle, weights, weights),
        np.einsum("ijk,i,j->k", angle, weights, weights),
    ]
    expected = [float(weights @ (own - mean) ** 2 / variance) for own in means]
    found = only(effects(response, base=4096))
    assert found.sigma == pytest.approx(math.degrees(math.sqrt(variance)) * 60, rel=0.01)
    for each, truth in zip(found.contributors.values(), expected, strict=True):
        assert holds(each.first, truth)


# the scenes of the numbers ----------------------------------------------------------------------


def test_eccentricities_of_the_spur_pair_at_a_common_position() -> None:
    own = response_of(simulation_of(load("spur_pair"))).of("normal backlash")
    assert default_base(own, 7) == 16384  # 147 456 builds
    found = only(effects(own, base=4096))
    contributors = found.contributors
    assert contributors["wheel eccentricity"].total is not None
    assert contributors["wheel eccentricity"].total.share == pytest.approx(0.24, abs=0.01)
    assert contributors["pinion eccentricity"].total is not None
    assert contributors["pinion eccentricity"].total.share == pytest.approx(0.18, abs=0.01)
    assert found.sum_of_first is not None
    assert found.sum_of_first.share == pytest.approx(1.0, abs=0.03)


def test_a_position_as_input_hides_eccentricities() -> None:
    own = response_of(simulation_of(load("spur_pair"))).of("normal backlash")
    found = only(effects(own, base=4096, position=True))
    assert found.sum_of_first is not None
    assert found.sum_of_first.share == pytest.approx(0.58, abs=0.06)
    assert found.position
    assert holds(found.position.first, 0.0)
    assert holds(found.contributors["wheel eccentricity"].first, 0.0)


@pytest.mark.slow
def test_contributors_of_a_3k_set_act_together() -> None:
    own = response_of(simulation_of(load("reducer_3k"))).of("lost motion")
    found = only(effects(own))
    assert found.sum_of_total is not None
    assert found.sum_of_total.share == pytest.approx(1.3, abs=0.05)


# changes ------------------------------------------------------------------------------------------------


def test_changes_of_a_linear_measure_are_slopes_times_ranges() -> None:
    draws: list[Draw] = [Scalar(Normal(0.0, 1.0)), Scalar(Uniform(-2.0, 4.0)), Planar(Normal(0.0, 0.5), None)]
    own = formula(lambda x: 3 * x[:, 0] - 2 * x[:, 1] + 3 * x[:, 2] + 4 * x[:, 3], draws)
    found = only(effects(own, base=2)).contributors
    assert [each.slope for each in found.values()] == pytest.approx([3.0, -2.0, 5.0], abs=1e-8)
    radius = Normal(0.0, 0.5).radius
    law = Normal(0.0, 1.0)
    assert [each.change for each in found.values()] == pytest.approx([3 * (law.high - law.low), 12.0, 10 * radius])


def test_changes_are_averaged_over_positions() -> None:
    """An eccentricity's steepest direction turns with the position: its change does not, and is not lost."""
    own = response_of(simulation_of(load("spur_pair"))).of("normal backlash")
    found = only(effects(own, base=2)).contributors["wheel eccentricity"]
    draw = own.draws["wheel eccentricity"]
    assert isinstance(draw, Planar)
    assert found.slope == pytest.approx(2 * math.sin(math.radians(20)), rel=1e-3)
    assert found.change == pytest.approx(2 * math.sin(math.radians(20)) * 2e3 * draw.distribution.radius, rel=1e-2)


# Shapley effects ----------------------------------------------------------------------------------------

CORRELATION = np.array([[1.0, 0.6, -0.3], [0.6, 1.0, 0.2], [-0.3, 0.2, 1.0]])


def brute(slopes: Array, correlation: Array) -> list[float]:
    """By conditional variances of all subsets, order by order."""

    def explained(known: tuple[int, ...]) -> float:
        if not known:
            return 0.0
        mine = list(known)
        across = correlation[mine] @ slopes
        return float(across @ np.linalg.solve(correlation[np.ix_(mine, mine)], across))

    found = np.zeros(len(slopes))
    orders = list(permutations(range(len(slopes))))
    for order in orders:
        for place, own in enumerate(order):
            found[own] += (explained(order[: place + 1]) - explained(order[:place])) / len(orders)
    return found.tolist()


def test_shapley_effects_of_correlated_normals() -> None:
    slopes = np.array([1.0, 2.0, -1.5])
    expected = brute(slopes, CORRELATION)
    whole = slopes @ CORRELATION @ slopes
    assert linear_shapley(slopes, CORRELATION) == pytest.approx(expected, rel=1e-12)
    block = Block(("x2", "x0", "x1"), tuple(map(tuple, CORRELATION[np.ix_([2, 0, 1], [2, 0, 1])].tolist())))
    own = formula(lambda x: x[:, :3] @ slopes + x[:, 3], 4, blocks=[block])
    found = only(effects(own, base=8192))
    assert found.sigma == pytest.approx(math.sqrt(whole + 1), rel=0.02)
    for each, truth in zip(found.contributors.values(), [*expected, 1.0], strict=True):
        assert holds(each.shapley, truth / (whole + 1))
    assert sum(shares(found, "shapley")) == pytest.approx(1.0, abs=1e-9)
    assert found.contributors["x0"].together == ["x2", "x0", "x1"]
    assert holds(found.contributors["x1"].total, whole / (whole + 1))


def test_two_correlated_normals() -> None:
    """Owen and Prieur 2017: b1² + ρ b1 b2 + ρ² (b2² - b1²) / 2."""
    rho, slopes = 0.8, np.array([1.0, 3.0])
    expected = [a * a + rho * a * b + rho**2 * (b * b - a * a) / 2 for a, b in ((1.0, 3.0), (3.0, 1.0))]
    assert linear_shapley(slopes, np.array([[1.0, rho], [rho, 1.0]])) == pytest.approx(expected)


# failures -----------------------------------------------------------------------------------------------


def test_frequent_failures_are_blamed_by_indices_of_failing() -> None:
    """For x0 + 2 x1 beyond 3, pairs with one in common are both normal, correlated by its share."""
    own = formula(lambda x: x[:, 0] + 2 * x[:, 1], 2, high=3.0)
    found = only(effects(own, base=16384))
    limit = 3.0 / math.sqrt(5.0)
    p = norm.sf(limit)

    def both(share: float) -> float:
        return float(multivariate_normal.cdf([-limit, -limit], cov=[[1.0, share], [share, 1.0]]))

    first = [(both(share) - p * p) / (p * (1 - p)) for share in (0.2, 0.8)]
    assert found.failures_by == "simulation"
    assert found.failing_ppm == pytest.approx(1e6 * p, rel=0.05)
    for each, alone, other in zip(found.contributors.values(), first, first[::-1], strict=True):
        assert holds(each.failures, alone)
        assert holds(each.failures_total, 1 - other)


@pytest.mark.parametrize(
    ("minutes", "streams", "expected"),
    [(1e-12, True, (8, "drawn")), (4e-4, True, (5, "drawn")), (1.0, True, (2, "drawn")), (1e-12, False, (1, "rest"))],
)
def test_design_points_are_sought_at_as_many_positions_as_time_allows(
    minutes: float, streams: bool, expected: tuple[int, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """0.02 minutes a step, two builds for each of five that act: from two to eight positions; one if nothing turns."""
    simulation = SimpleNamespace(system=SimpleNamespace(streams=streams))
    response = SimpleNamespace(minutes=minutes, simulation=simulation, positions=lambda *asked: asked[:2])
    sought = list[tuple[int, str]]()

    def design_points(state: Any, positions: tuple[int, str], *others: Any) -> list[Any]:
        sought.append(positions)
        return []

    monkeypatch.setattr(blame, "design_points", design_points)
    blame._points(SimpleNamespace(response=response, acting=range(5)), 1)  # type: ignore[arg-type]
    assert sought == [expected]


@pytest.mark.parametrize("rho", [0.0, 0.5])
def test_rare_failures_are_blamed_by_design_points(rho: float) -> None:
    """For a plane, squared direction cosines are shares of the variance, or Shapley effects of correlated ones."""
    slopes, correlation = np.array([1.0, 2.0]), np.array([[1.0, rho], [rho, 1.0]])
    blocks = [Block(("x0", "x1"), ((1.0, rho), (rho, 1.0)))] if rho else []
    own = formula(lambda x: x @ slopes, 2, low=-15.0, blocks=blocks)
    found = only(effects(own, base=256))
    expected = linear_shapley(slopes, correlation) / (slopes @ correlation @ slopes)
    assert found.failures_by == "design points"
    assert shares(found, "failures") == pytest.approx(expected.tolist(), abs=1e-4)


def test_builds_that_do_not_seat_are_left_out_and_blamed() -> None:
    """Above 1 no build seats for x1 alone: x0 keeps its index among the others, and failing is all x1's."""
    own = formula(lambda x: np.where(x[:, 1] > 1.0, np.nan, x[:, 0] + 0.0 * x[:, 1]), 2)
    found = only(effects(own, base=4096))
    assert found.not_seated == pytest.approx(8192 * norm.sf(1.0), rel=0.03)
    assert found.pairs == pytest.approx(4096 * norm.cdf(1.0) ** 2, rel=0.03)
    assert holds(found.contributors["x0"].first, 1.0)
    assert found.failures_by == "simulation"
    assert shares(found, "failures") == pytest.approx([0.0, 1.0], abs=1e-9)
    assert "could not be assembled" in effects_report_text(effects(own, base=256))


def effects_report_text(found: Effects) -> str:
    return "\n".join(str(block) for block in effects_report(found).blocks)


# commands -----------------------------------------------------------------------------------------------


def test_a_run_keeps_its_effects(tmp_path: Path) -> None:
    run_scene("clutch", overrides=Overrides(trials=50), out=tmp_path / "run")
    done = CliRunner().invoke(
        app, f"effects {tmp_path}/run --base 64 --csv {tmp_path}/own.csv --picture {tmp_path}/own.png".split()
    )
    assert done.exit_code == 0, done.output
    kept = sections_of(open_run(tmp_path / "run"))["effects"]
    assert isinstance(kept, Effects)
    assert kept.evaluations >= 64 * 5
    lines = (tmp_path / "own.csv").read_text().splitlines()
    assert lines == whole_table(kept).csv().splitlines()
    assert len(lines) == 4
    assert (tmp_path / "own.png").stat().st_size > 5000


def test_what_cannot_be_asked_is_refused() -> None:
    own = formula(lambda x: x[:, 0], 1)
    with pytest.raises(InputError, match="expected a power of two pairs of builds, such as 4096, got 100"):
        effects(own, base=100)
    with pytest.raises(InputError, match="expected measures that are read at random positions, got none"):
        effects(own, position=True)
    with pytest.raises(InputError, match="got 'normal backlash curve', a curve; ask for '"):
        response_of(simulation_of(load("every_field"))).of("normal backlash curve")


KINDS = ("bevel_pair", "every_field", "housed_gears", "robot_shoulder_swing", "slider_crank")


@pytest.mark.slow
@pytest.mark.parametrize("name", KINDS)
def test_scenes_of_every_mechanism_have_effects(name: str) -> None:
    """All measures, ends of curves too, with all that acts on each; what is shown of them has as many rows."""
    response = response_of(simulation_of(load(name)))
    found = effects(response, base=4)
    assert list(found.measures) == [own.name for own in response.measures]
    for own in response.measures:
        acting = {each.name for each in response.acting(own)}
        assert acting <= set(found.measures[own.name].contributors)
    rows = sum(len(own.contributors) for own in found.measures.values())
    assert len(whole_table(found).csv().splitlines()) == rows + 1


def test_a_mechanism_from_outside() -> None:
    """The bundled spring: what terms of second order add is no share of the first order, but of the total."""
    with known(PARABOLA):
        response = response_of(simulation_of(load(TOYS / "parabola" / "spring.yaml")))
        found = effects(response, base=1024)
        for own in found.measures.values():
            assert own.sum_of_first is not None
            assert own.sum_of_first.share == pytest.approx(1.0, abs=0.1)
        assert "not a" not in effects_report_text(found)
