"""Correlated contributors: what they draw, what sums of them have, how they are said and refused."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from formulas import Formula, formula
from scipy.stats import kstest, norm, pearsonr, spearmanr

from tol3d import Overrides, SceneError, run_scene
from tol3d.analyses.rare_events import rare_event
from tol3d.analyses.response import response_of
from tol3d.analyses.tolerance_effects import effects
from tol3d.simulate import load, replay, simulation_of
from tol3d.statistics.distributions.normal import Normal
from tol3d.statistics.distributions.uniform import Uniform
from tol3d.statistics.estimates.variance_shares import RegressorSums, shares
from tol3d.study.effects.first_order import first_orders
from tol3d.study.execution.pools import Execution
from tol3d.study.system.closed_form import ClosedForm, Share
from tol3d.study.system.copula import INDEPENDENT, Block, Copula
from tol3d.study.system.draw import Draw, Scalar
from tol3d.study.system.measure import Measure
from tol3d.study.system.stated import component_slices
from tol3d.study.trials.correlated import closed_form_of, value_correlations
from tol3d.study.trials.draws import drawn, drawn_ones

DOOR = Path(__file__).parents[2] / "scenes" / "door.yaml"
UPPER, DOOR_HINGE, BODY_HINGE = "upper edge x", "door upper hinge x", "body upper hinge x"
SLOPES = {UPPER: 1.0, DOOR_HINGE: 1.25, BODY_HINGE: -1.25, "door lower hinge x": -0.25, "body lower hinge x": 0.25}


def door(folder: Path, correlations: str) -> Path:
    """The door, all of whose laws are normal, with correlations; its gaps are sums."""
    path = folder / "door.yaml"
    path.write_text(f"{DOOR.read_text()}\ncorrelations:\n{correlations}\n")
    return path


def correlated(folder: Path, rho: float, first: str = UPPER, second: str = DOOR_HINGE) -> Path:
    return door(folder, f"  - {{between: [{first}, {second}], rho: {rho}}}")


# sums in closed form ------------------------------------------------------------------------------------


@pytest.mark.parametrize("rho", [0.8, -0.8])
@pytest.mark.parametrize("second", [DOOR_HINGE, BODY_HINGE], ids=["sum", "difference"])
def test_sigma_of_a_sum_of_two_correlated_lengths(rho: float, second: str, tmp_path: Path) -> None:
    """sigma² = Σ (b sigma)² + 2 ρ b b' sigma sigma', by the stack-up, its trials, the 3D simulation and check."""
    made = simulation_of(load(correlated(tmp_path, rho, UPPER, second)))
    sigmas = {own.name: own.draw.sigma for own in made.system.contributors}
    square = sum((slope * sigmas[name]) ** 2 for name, slope in SLOPES.items())
    square += 2 * rho * SLOPES[UPPER] * SLOPES[second] * sigmas[UPPER] * sigmas[second]
    expected = 1000 * math.sqrt(square)
    run = run_scene(correlated(tmp_path, rho, UPPER, second), overrides=Overrides(trials=8000), out=tmp_path / "run")
    own = run.found.measures["upper gap"]
    assert own.analytic_closed_form is not None
    assert own.analytic_closed_form.sigma == pytest.approx(expected, rel=1e-9)
    for sample in (own.analytic, own.geometric):
        assert sample is not None
        assert sample.sigma == pytest.approx(expected, rel=5 / math.sqrt(2 * 8000))
    found = first_orders(made, None, [made.system.measures[0]])["upper gap"]["analytic"]
    assert found.sigma == pytest.approx(expected, rel=1e-9)
    # LMG of two, Owen and Prieur 2017
    a, b = SLOPES[UPPER] * sigmas[UPPER], SLOPES[second] * sigmas[second]
    share = 100 * (a * a + rho * a * b + rho**2 * (b * b - a * a) / 2) / square
    told = next(each for each in own.contributors if each.name == UPPER)
    assert told.analytic_percent == pytest.approx(share, abs=1e-6)
    assert told.geometric_percent == pytest.approx(share, abs=2.5)
    assert sum(each.geometric_percent or 0.0 for each in own.contributors) == pytest.approx(100.0, abs=0.2)
    assert any(text.startswith(f"correlated: {second}, {UPPER}") or UPPER in text for text in run.found.warnings)


def test_uniform_lengths_have_another_correlation_than_their_normals() -> None:
    """Pearson's of two uniforms is 6/π asin(ρ/2), which is Spearman's of any two laws."""
    draws: dict[str, Draw] = {"a": Scalar(Uniform(-1.0, 3.0)), "b": Scalar(Uniform(0.0, 1.0))}
    for rho in (-0.95, -0.3, 0.5, 0.9):
        found = value_correlations(Block(("a", "b"), ((1.0, rho), (rho, 1.0))), draws)[0, 1]
        assert found == pytest.approx(6 / math.pi * math.asin(rho / 2), abs=2e-6)
    normal: dict[str, Draw] = {"a": Scalar(Normal(1.0, 0.2)), "b": Scalar(Normal(0.0, 3.0))}
    assert value_correlations(Block(("a", "b"), ((1.0, 0.7), (0.7, 1.0))), normal)[0, 1] == pytest.approx(0.7, abs=1e-9)


def test_shares_by_regression_are_those_of_correlated_groups() -> None:
    """A group of x and x² with one of y; a third one that is independent keeps its share."""
    generator = np.random.default_rng(3)
    z = generator.multivariate_normal([0.0, 0.0], [[1.0, 0.6], [0.6, 1.0]], size=200_000)
    w = generator.standard_normal(200_000)
    target = z[:, 0] + 2 * z[:, 1] + w
    sums = RegressorSums.of(np.column_stack([z[:, 0], z[:, 0] ** 2, z[:, 1], w]), target)
    groups = {"x": slice(0, 2), "y": slice(2, 3), "w": slice(3, 4)}
    found = shares(sums, groups, [("y", "x")])
    whole = 1 + 4 + 2.4 + 1
    assert found.share["x"] == pytest.approx((1 + 1.2 + 0.36 * 1.5) / whole, abs=0.005)
    assert found.share["y"] == pytest.approx((4 + 1.2 - 0.36 * 1.5) / whole, abs=0.005)
    assert found.share["w"] == pytest.approx(1 / whole, abs=0.005)


# draws --------------------------------------------------------------------------------------------------

THREE = """\
  - between: [upper edge x, door upper hinge x, door lower hinge x]
    matrix: [[1, 0.5, -0.2], [0.5, 1, 0.3], [-0.2, 0.3, 1]]"""


@pytest.mark.parametrize("sampler", ["monte_carlo", "sobol", "latin_hypercube"])
def test_trials_have_the_matrix_and_keep_each_law(sampler: str, tmp_path: Path) -> None:
    scene = load(door(tmp_path, THREE))
    simulation = simulation_of(scene, Overrides(trials=16384, sampler=sampler))
    plain = simulation_of(load(DOOR), Overrides(trials=16384, sampler=sampler))
    found, without = drawn(simulation, 0, 16384).deviations, drawn(plain, 0, 16384).deviations
    slices = component_slices(simulation.system)
    names = ["door upper hinge x", "door lower hinge x", "upper edge x"]  # in the order of the scene
    columns = [found[:, slices[name]][:, 0] for name in names]
    laws = {own.name: own.draw.distribution for own in simulation.system.contributors}
    for name, column in zip(names, columns, strict=True):
        assert kstest(column, norm(laws[name].mean, laws[name].sigma).cdf).pvalue > 1e-4
    for (i, j), rho in {(0, 2): 0.5, (1, 2): -0.2, (0, 1): 0.3}.items():
        assert pearsonr(columns[i], columns[j])[0] == pytest.approx(rho, abs=4 * (1 - rho**2) / 128)
        assert spearmanr(columns[i], columns[j])[0] == pytest.approx(6 / math.pi * math.asin(rho / 2), abs=0.035)
    first = slices[names[0]]
    others = [k for name, own in slices.items() if name not in names for k in range(own.start, own.stop)]
    assert np.array_equal(found[:, others], without[:, others])
    assert np.array_equal(found[:, first], without[:, first])


def test_a_trial_is_its_own(tmp_path: Path) -> None:
    """Whatever is drawn with it: part of a block, alone, as analyses draw it."""
    simulation = simulation_of(load(door(tmp_path, THREE)), Overrides(trials=300))
    every = drawn(simulation, 0, 300).deviations
    assert np.array_equal(drawn(simulation, 100, 37).deviations, every[100:137])
    assert np.array_equal(drawn_ones(simulation, [299, 7]).deviations, every[[299, 7]])
    assert np.array_equal(response_of(simulation).drawn(300)[0], every)


def test_runs_replay_correlated_trials(tmp_path: Path) -> None:
    path = correlated(tmp_path, 0.8)
    run = run_scene(path, overrides=Overrides(trials=400), out=tmp_path / "run", execution=Execution(workers=2))
    again = replay(run, 123)
    column = run.columns()["geometric:upper gap"]
    assert again.geometric["upper gap"] == column[123]


def test_analyses_draw_the_same_law(tmp_path: Path) -> None:
    response = response_of(simulation_of(load(door(tmp_path, THREE))))
    normals = np.random.default_rng(4).standard_normal((40_000, response.dimension))
    found = response.deviations(normals)
    upper, hinge = (found[:, response.slices[name]][:, 0] for name in (UPPER, DOOR_HINGE))
    assert pearsonr(upper, hinge)[0] == pytest.approx(0.5, abs=4 * 0.75 / 200)
    assert upper.std() == pytest.approx(response.draws[UPPER].sigma, rel=0.02)


def test_design_points_know_what_goes_with_those_that_act(tmp_path: Path) -> None:
    """A gap's law does not change by what one of its lengths is correlated with; the blame is shared with it: ρ²/2."""
    folder = tmp_path / "alone"
    folder.mkdir()
    near = " lower_limit: 2.5 mm", " lower_limit: 2.0 mm"
    found, blame = [], []
    for path in (
        correlated(tmp_path, 0.8, UPPER, "body upper hinge y"),
        correlated(folder, 0.8, UPPER, "lower edge y"),
    ):
        path.write_text(path.read_text().replace(*near))
        response = response_of(simulation_of(load(path))).of("upper gap")
        found.append(rare_event(response, "low", 2000.0, method="form").estimate.probability)
        own = effects(response, base=256).measures["upper gap"].contributors
        blame.append({name: each.failures.share for name, each in own.items() if each.failures})
    sigma = math.sqrt(sum((b * response.draws[name].sigma) ** 2 for name, b in SLOPES.items()))
    assert found[0] == pytest.approx(found[1], rel=2e-3)
    assert found == pytest.approx([norm.sf(2.0 / sigma)] * 2, rel=0.05)  # terms of second order move the gap by 3 um
    alone = (response.draws[UPPER].sigma / sigma) ** 2
    assert blame[0]["body upper hinge y"] == pytest.approx(0.32 * alone, rel=0.02)
    assert blame[0][UPPER] == pytest.approx(0.68 * alone, rel=0.02)


def test_a_sum_of_uniform_lengths() -> None:
    """By draws of normals through the response: its sigma has the covariance of the copula."""
    block = Block(("x0", "x1"), ((1.0, 0.8), (0.8, 1.0)))
    own = formula(lambda x: x[:, 0] + x[:, 1], [Scalar(Uniform(-1.0, 1.0))] * 2, blocks=[block])
    found = own.values(own.drawn(100_000)[0]).values
    expected = math.sqrt(2 / 3 * (1 + 6 / math.pi * math.asin(0.4)))
    assert found.std() == pytest.approx(expected, rel=0.01)


def test_scenes_without_correlations_are_independent() -> None:
    assert simulation_of(load("spur_pair")).copula is INDEPENDENT


# what is said and refused -------------------------------------------------------------------------------


def test_pairs_make_one_matrix(tmp_path: Path) -> None:
    pairs = f"  - {{between: [{UPPER}, {DOOR_HINGE}], rho: 0.5}}\n  - {{between: [{BODY_HINGE}, {UPPER}], rho: 0.4}}"
    (block,) = simulation_of(load(door(tmp_path, pairs))).copula.blocks
    assert block.names == (BODY_HINGE, DOOR_HINGE, UPPER)
    assert block.matrix == ((1.0, 0.0, 0.4), (0.0, 1.0, 0.5), (0.4, 0.5, 1.0))


def test_included_files_bring_their_correlations(tmp_path: Path) -> None:
    correlated(tmp_path, 0.8)
    text = "scene: two doors\ninclude: {left: door.yaml}\n"
    (tmp_path / "two.yaml").write_text(text)
    (block,) = simulation_of(load(tmp_path / "two.yaml")).copula.blocks
    assert block.names == (f"left {DOOR_HINGE}", f"left {UPPER}")


def test_what_acts_otherwise_than_by_a_slope_has_no_closed_form() -> None:
    """Tooth thicknesses are slopes of the backlash of a spur pair; a length with a direction cannot be correlated."""
    made = simulation_of(load("spur_pair"))
    measure = made.system.measures[0]
    assert closed_form_of(made, measure) == made.system.closed_form(measure)


REFUSED = {
    f"  - {{between: [{UPPER}, {DOOR_HINGE}], rho: 1.0}}": "expected a number of less than 1, got 1",
    f"  - {{between: [{UPPER}, {UPPER}], rho: 0.5}}": "expected each name once, got 'upper edge x' twice",
    f"  - {{between: [{UPPER}], rho: 0.5}}": "expected a list of 2 or more names, got a list of 1",
    f"  - {{between: [{UPPER}, {DOOR_HINGE}]}}": "expected rho or matrix, got neither",
    f"  - {{between: [{UPPER}, upper hinge], rho: 0.5}}": "expected the name of a contributor, got 'upper hinge'",
    f"  - {{between: [{UPPER}, {DOOR_HINGE}, {BODY_HINGE}], rho: -0.6}}": (
        "expected correlations that are consistent, a positive definite matrix, got one with the eigenvalue -0.2"
    ),
    f"  - {{between: [{UPPER}, {DOOR_HINGE}], matrix: [[1, 0.5], [0.4, 1]]}}": (
        "expected one correlation of 'upper edge x' and 'door upper hinge x', got 0.5 and 0.4"
    ),
    f"  - {{between: [{UPPER}, {DOOR_HINGE}], rho: 0.5}}\n  - {{between: [{DOOR_HINGE}, {UPPER}], rho: 0.5}}": (
        "expected one correlation of 'door upper hinge x' and 'upper edge x', got a second one"
    ),
    f"  - {{between: [{UPPER}, {DOOR_HINGE}], rho: 0.9}}\n  - {{between: [{DOOR_HINGE}, {BODY_HINGE}], rho: 0.9}}": (
        "got one with the eigenvalue -0.273; that of 'body upper hinge x' and 'upper edge x' is not stated, so 0"
    ),
}


@pytest.mark.parametrize("said", REFUSED)
def test_what_is_no_correlation_is_refused(said: str, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=re.escape(REFUSED[said])) as caught:
        simulation_of(load(door(tmp_path, said)))
    assert re.match(r".*door\.yaml:\d+: correlations", str(caught.value))


def test_contributors_of_several_numbers_and_constants_are_refused(tmp_path: Path) -> None:
    text = (DOOR.parent / "spur_pair.yaml").read_text()
    own = tmp_path / "own.yaml"
    own.write_text(text + "\ncorrelations: [{between: [centre distance, wheel eccentricity], rho: 0.5}]\n")
    with pytest.raises(SceneError, match="got 'wheel eccentricity', a length with its direction; take it out"):
        simulation_of(load(own))
    upper = "along: [1, 0, 0], distribution: {kind: normal, mean: 0 mm, sigma: 0.30 mm}"
    plain = DOOR.read_text()
    assert upper in plain
    constant = plain.replace(upper, "along: [1, 0, 0], distribution: {kind: constant, value: 0 mm}")
    own.write_text(constant + f"\ncorrelations: [{{between: [{UPPER}, {DOOR_HINGE}], rho: 0.5}}]\n")
    with pytest.raises(SceneError, match="got 'upper edge x', a constant; take it out"):
        simulation_of(load(own))


@dataclass(frozen=True)
class Formed(Formula):
    """A formula whose moments somebody states."""

    form: ClosedForm | None = None

    def closed_form(self, measure: Measure) -> ClosedForm | None:
        return self.form


def formed(shares: Sequence[Share], leaning: frozenset[str] = frozenset()) -> ClosedForm | None:
    """The moments of x0 + 2 x1 + x2 with normals of sigma 1.5, 0.5 and 1; x0 and x1 are correlated by -0.6."""
    own = formula(lambda x: x[:, 0], [Scalar(Normal(3.0, 1.5)), Scalar(Normal(-1.0, 0.5)), Scalar(Normal(0.0, 1.0))])
    simulation, sigma = own.simulation, math.sqrt(sum(share.variance for share in shares))
    system = Formed(**{**vars(simulation.system), "form": ClosedForm(7.0, 8.0, sigma, tuple(shares), leaning)})
    copula = Copula((Block(("x0", "x1"), ((1.0, -0.6), (-0.6, 1.0))),))
    return closed_form_of(replace(simulation, system=system, copula=copula), system.measures[0])


def test_a_closed_form_is_claimed_only_where_correlated_contributors_act_by_a_slope() -> None:
    """Var = 2.25 + 1 + 2 (1)(2)(-0.6)(1.5)(0.5) + 1; none where x1's variance is not that of its slope, or it leans."""
    first, second, third = Share("x0", 1.0, 3.0, 2.25), Share("x1", 2.0, -2.0, 1.0), Share("x2", 1.0, 0.0, 1.0)
    found = formed((first, second, third))
    assert found is not None
    assert found.sigma == pytest.approx(math.sqrt(2.25 + 1.0 - 1.8 + 1.0), rel=1e-9)
    assert found.mean == 8.0
    assert formed((first, replace(second, variance=1.3), third)) is None
    assert formed((first, second, third), frozenset({"x1"})) is None
    bent = formed((first, second, replace(third, variance=1.7)))  # x2 goes with no other
    assert bent is not None
    assert bent.sigma == pytest.approx(math.sqrt(2.25 + 1.0 - 1.8 + 1.7), rel=1e-9)
