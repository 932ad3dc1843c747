"""Largest contributors of measures that no regression explains, held to quadratures of what each one does."""

import csv
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.limit_states import formula
from printing import printed
from scipy import integrate, stats

from tol3d import Run, run_scene
from tol3d.gearing.machine.open_chains import EitherSide
from tol3d.report.column import unexplained_words
from tol3d.report.html.document import report_html
from tol3d.report.html.frame import NARROW
from tol3d.report.html.svg import svg
from tol3d.report.measure_table import contributors_table
from tol3d.report.share_charts import pareto, percents_of, shown_names
from tol3d.report.table import Detail, run_report
from tol3d.statistics.distributions.base import Distribution
from tol3d.statistics.distributions.normal import Normal
from tol3d.study.results import attribution
from tol3d.study.results.summary import study_summary
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.system.plain import PlainMeasure, PlainSystem
from tol3d.study.tallies.tally import PILOT_TRIALS, Tally, grids_of
from tol3d.study.trials.columns import columns_of
from tol3d.study.trials.draws import drawn, redrawn

Array = NDArray[np.float64]
SURE = 5.0  # standard errors


def measured(value: Callable[[Array], Array], laws: Sequence[Distribution], trials: int) -> MeasureSummary:
    """A study of one number [um] that is a function of deviations (n, contributors) [mm]."""
    plain = formula(lambda rows, _: value(rows), laws).simulation
    assert isinstance(plain.system, PlainSystem)
    system = replace(plain.system, measures=(PlainMeasure("value", "value"),))
    simulation = replace(plain, system=system, study=replace(plain.study, trials=trials))
    method = system.method("exact", None)
    pilot = columns_of(system, method, drawn(simulation, 0, PILOT_TRIALS))
    tally = Tally.of(simulation, grids_of(system, pilot), columns_of(system, method, drawn(simulation, 0, trials)))
    found: MeasureSummary = study_summary(simulation, method, tally).measures["value"]
    return found


def geometric(measure: MeasureSummary) -> dict[str, float]:
    return {own.name: own.geometric_percent for own in measure.contributors if own.geometric_percent is not None}


def assert_near(measure: MeasureSummary, effects: Sequence[float], variance: float) -> None:
    """Shares are known total effects, as parts of a known variance, within the errors that they state."""
    expected = {f"x{k}": 100 * own / variance for k, own in enumerate(effects)}
    for own in measure.contributors:
        assert own.geometric_percent is not None
        assert own.geometric_percent_se is not None
        assert abs(own.geometric_percent - expected[own.name]) < SURE * own.geometric_percent_se, own.name
        assert own.geometric_percent_se < 15.0
    found = geometric(measure)
    assert max(found.values()) <= 100.0
    assert max(found, key=found.__getitem__) == max(expected, key=expected.__getitem__)


# total effects --------------------------------------------------------------------------------------------------------


def test_a_product_names_its_factors_and_not_the_summand_that_a_regression_sees() -> None:
    """(x + a)(y + b) + c z: E of the variance over x alone is s² (t² + b²), exactly."""
    a, b, c = 0.2, -0.01, 0.7
    laws = [Normal(a, 0.3), Normal(b, 0.5), Normal(0.04, 0.2)]
    measure = measured(lambda x: x[:, 0] * x[:, 1] + c * x[:, 2], laws, 16_000)
    effects = [0.3**2 * (0.5**2 + b**2), 0.5**2 * (0.3**2 + a**2), (c * 0.2) ** 2]
    linear = (b * 0.3) ** 2 + (a * 0.5) ** 2 + (c * 0.2) ** 2  # of the measure about the means
    variance = (0.3 * 0.5) ** 2 + linear
    assert_near(measure, effects, variance)
    assert measure.shares_by is not None
    own = measure.shares_by["geometric"]
    assert own.by == "total effects"
    assert own.explained_percent == pytest.approx(100 * linear / variance, abs=5.0)  # 5 standard errors of r²
    largest_alone = max(measure.contributors, key=lambda each: each.high_low_mean_percent or 0.0)
    assert largest_alone.name == "x2"  # a product of deviations is 0 at the others' means: high–low–mean sees little


def folded_variance(middle: float, sigma: float) -> float:
    """Variance of |N(middle, sigma)|; Leone, Nelson, Nottingham, Technometrics 3 (1961)."""
    mean = sigma * math.sqrt(2 / math.pi) * math.exp(-(middle**2) / 2 / sigma**2)
    mean += middle * (1 - 2 * stats.norm.cdf(-middle / sigma))
    return middle**2 + sigma**2 - mean**2


SIGMAS, MIDDLE = (0.11, 0.03, 0.06, 0.02), 0.04


def total_of_size(k: int) -> float:
    """Total effect of one summand of the size of a sum: mean over the others of the variance that it leaves."""
    across = math.sqrt(sum(own**2 for own in SIGMAS) - SIGMAS[k] ** 2)
    found: float = integrate.quad(
        lambda w: stats.norm.pdf(w, MIDDLE, across) * folded_variance(w, SIGMAS[k]),
        MIDDLE - 9 * across,
        MIDDLE + 9 * across,
        limit=200,
    )[0]
    return found


def size_of_sum(deviations: Array) -> Array:
    return np.asarray(np.abs(deviations.sum(axis=1)))


def of_size(trials: int) -> MeasureSummary:
    return measured(size_of_sum, [Normal(MIDDLE, SIGMAS[0]), *(Normal(0.0, own) for own in SIGMAS[1:])], trials)


def test_the_size_of_a_sum_has_the_total_effects_of_a_quadrature() -> None:
    variance = folded_variance(MIDDLE, math.sqrt(sum(own**2 for own in SIGMAS)))
    assert_near(of_size(8000), [total_of_size(k) for k in range(len(SIGMAS))], variance)


def test_the_largest_of_several_has_the_total_effects_of_a_quadrature() -> None:
    """max(x, y, z, ...) by a grid of quantiles; its error is of second order in 1/60."""
    laws = [Normal(0.0, 0.04), Normal(-0.01, 0.09), Normal(0.03, 0.06)]
    measure = measured(lambda x: np.abs(x).max(axis=1), laws, 12_000)
    grid = stats.norm.ppf((np.arange(60) + 0.5) / 60)
    x, y, z = np.meshgrid(*(law.mean + law.sigma * grid for law in laws), indexing="ij")
    cube = np.maximum(np.maximum(np.abs(x), np.abs(y)), np.abs(z))
    assert_near(measure, [float(cube.var(axis=k).mean()) for k in range(3)], float(cube.var()))


@pytest.mark.parametrize("trials", [300, 8])
def test_few_trials_take_high_low_mean_two_builds_a_contributor(trials: int) -> None:
    """A tenth of 300 is 6 pairs of builds of each of four; 8 trials are fewer than a regression has unknowns."""
    states = [[MIDDLE, abs(MIDDLE + 3 * own), abs(MIDDLE - 3 * own)] for own in SIGMAS]
    squares = [(max(own) - min(own)) ** 2 for own in states]
    measure = of_size(trials)
    assert measure.shares_by is not None
    assert measure.shares_by["geometric"].by == "high-low-mean"
    assert (measure.shares_by["geometric"].explained_percent is None) == (trials == 8)
    expected = {f"x{k}": 100 * own / sum(squares) for k, own in enumerate(squares)}
    assert geometric(measure) == pytest.approx(expected, rel=1e-3)
    assert all(own.geometric_percent_se is None for own in measure.contributors)


# two-valued contributors ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("alone", [0.0, 0.02])
@pytest.mark.parametrize("trials", [50, 400])
def test_a_product_of_two_sides_names_both(alone: float, trials: int) -> None:
    """k s1 s2 + a s1 + c z, s of -1 or 1: variance k² + a² + (c sigma)², total effects k² + a², k² and (c sigma)².

    High–low–mean sees a and c alone: s is 0 in the mean. Of n pairs a share of 2 m / n, m the pairs in which s turns
    over, each in one of two: standard error 1 / sqrt(n).
    """
    k, c, sigma = 0.3, 0.5, 0.02
    laws: list[Distribution] = [Normal(0.01, sigma), EitherSide(), EitherSide()]
    measure = measured(lambda x: k * x[:, 1] * x[:, 2] + alone * x[:, 1] + c * x[:, 0], laws, trials)
    assert measure.shares_by is not None
    own = measure.shares_by["geometric"]
    assert own.by == "total effects"
    # of r² of three columns about 0: chi² of 3 degrees of freedom over the trials, less its mean
    assert own.explained_percent is not None
    assert own.explained_percent < 100 * 17.0 / trials  # once in 2000
    found = geometric(measure)
    pairs = 16
    for name in ("x1", "x2"):
        assert 100 - 100 * 3.0 / math.sqrt(pairs) < found[name] <= 100.0
    assert found["x0"] < 5.0  # truly 0.1 %


def test_draws_of_two_values_turn_over_in_half_of_the_pairs() -> None:
    """The first binary digits of n Sobol' points are one of n - 1 rows: of 60 some would be alike, pair by pair."""
    simulation = formula(lambda rows, _: rows.sum(axis=1), [EitherSide() for _ in range(60)]).simulation
    names = [own.name for own in simulation.system.contributors]
    for count in (16, 64, 256):
        before, after = (redrawn(simulation, count, some).deviations for some in ((), names))
        turned = (before != after).sum(axis=0)
        assert np.abs(turned - count / 2).max() < SURE * math.sqrt(count) / 2, count
        assert abs(turned.mean() - count / 2) < SURE * math.sqrt(count / 60) / 2


def test_a_short_run_of_many_contributors_says_how_little_its_regression_explains() -> None:
    """A product of two of 14: 100 builds are 6 pairs of each, too few, and high–low–mean sees the scraps alone."""
    laws: list[Distribution] = [EitherSide(), EitherSide(), *(Normal(0.0, 0.01) for _ in range(12))]
    measure = measured(lambda x: x[:, 0] * x[:, 1] + x[:, 2:].sum(axis=1), laws, 120)
    assert measure.shares_by is not None
    own = measure.shares_by["geometric"]
    assert own.by == "regression"
    assert own.explained_percent is not None
    assert own.explained_percent < 100 * 36.0 / 120  # chi² of 14, once in 1000
    words = f"not attributed {100 - own.explained_percent:.0f} %; by regression"
    assert unexplained_words(measure) == words


# what a regression explains -------------------------------------------------------------------------------------------


def test_a_sum_keeps_the_shares_of_its_regression_and_pays_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(attribution, "redrawn", lambda *_: pytest.fail("a scene that is explained builds no pairs"))
    laws = [Normal(0.01, 0.03), Normal(-0.02, 0.05), Normal(0.0, 0.01)]
    measure = measured(lambda x: x @ np.array([1.0, -0.7, 2.0]) + x[:, 0] * x[:, 1], laws, 2000)
    assert measure.shares_by is None
    variances = np.array([0.03, 0.7 * 0.05, 0.02]) ** 2
    for own, part in zip(measure.contributors, 100 * variances / variances.sum(), strict=True):
        assert own.geometric_percent_se is not None
        assert abs((own.geometric_percent or 0.0) - part) < SURE * own.geometric_percent_se


# builds that could not be assembled -----------------------------------------------------------------------------------


def test_no_share_is_over_all_where_assembled_builds_are_correlated() -> None:
    """x + y/2 of builds with |x + y| < w: there y is mostly -x, and covariances give x more than all.

    Of two columns relative weights are the averages over both orders, each by the covariance of the assembled builds.
    """
    s, t, w = 0.06, 0.1, 0.03
    keeps = stats.truncnorm(-w / math.hypot(s, t), w / math.hypot(s, t)).var()  # of (x + y) over its sigma
    across = np.array([s * s, t * t]) / math.hypot(s, t)
    covariance = np.diag([s * s, t * t]) - (1 - keeps) * np.outer(across, across)
    slopes = np.array([1.0, 0.5])
    whole = float(slopes @ covariance @ slopes)
    assert slopes[0] * (covariance[0] @ slopes) / whole > 1.05  # what came before
    with_each = (covariance @ slopes) ** 2 / np.diagonal(covariance) / whole  # r² of each alone
    expected = 100 * (with_each + 1 - with_each[::-1]) / 2

    def value(x: Array) -> Array:
        return np.where(np.abs(x.sum(axis=1)) < w, x @ slopes, np.nan)

    measure = measured(value, [Normal(0.0, s), Normal(0.0, t)], 4000)
    assert 0.1 < measure.seated / measure.trials < 0.3
    found = geometric(measure)
    # 1 % of its sigma in each of three covariances of 800 builds
    assert [found["x0"], found["x1"]] == pytest.approx(expected.tolist(), abs=6.0)
    assert sum(found.values()) == pytest.approx(100.0, abs=0.1)


# as printed -----------------------------------------------------------------------------------------------------------

SCENE = """
scene: a size that no regression explains
description: distance of two points that lie on each other but for 5 um; base lean is their largest contributor
parts:
  base:
    kind: solid
    features:
      a: {{kind: point, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1]}}
      b: {{kind: point, at: [0.005 mm, 0 mm, 0 mm], normal: [0, 0, 1]}}
      c: {{kind: point, at: [0 mm, 3 mm, 0 mm], normal: [0, 0, 1]}}
tolerances:
{tolerances}
moves:
  table: {{kind: fix, part: base}}
measures:
  size: {{kind: distance, from: base.a, to: base.b, upper_limit: 0.5 mm}}
  plain: {{kind: distance, from: base.a, to: base.c}}
study: {{trials: {trials}, seed: 3, witness: 0}}
"""
LENGTHS = {  # of a or b, along, mean and sigma [um]
    "first": ("a", (1, 0, 0), 3, 30),
    "largest": ("b", (1, 0, 0), -4, 70),
    "third": ("b", (0.8, 0.6, 0), 0, 25),
    "of c": ("c", (0, 1, 0), 2, 10),
}


def total_of(name: str) -> tuple[float, float]:
    """Total effect on the size, and its variance, by quadrature of 81 nodes of Hermite for each of three lengths."""
    nodes, weights = np.polynomial.hermite_e.hermegauss(81)
    weights = weights / weights.sum()
    vectors = {key: (-1 if of == "a" else 1) * np.array(along) for key, (of, along, _, _) in LENGTHS.items()}
    keys = [key for key in LENGTHS if key != "of c"]
    middle = np.array([5.0, 0.0, 0.0]) + sum(LENGTHS[key][2] * vectors[key] for key in keys)
    each = np.meshgrid(*(LENGTHS[key][3] * nodes for key in keys), indexing="ij")
    moved = [middle[k] + sum(own * vectors[key][k] for own, key in zip(each, keys, strict=True)) for k in range(3)]
    size = np.sqrt(sum(own**2 for own in moved))
    at = np.moveaxis(size, keys.index(name), -1)
    variance = at**2 @ weights - (at @ weights) ** 2
    whole = float(weights @ (at**2 @ weights) @ weights) - float(weights @ (at @ weights) @ weights) ** 2
    return float(weights @ variance @ weights), whole


@pytest.fixture(scope="module", params=[6000, 120], ids=["total effects", "high-low-mean"])
def run(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("sizes")
    lines = [
        f"  {name}: {{kind: plus_minus, of: base.{of}, along: {list(along)}, "
        f"distribution: {{kind: normal, mean: {mean} um, sigma: {sigma} um}}}}"
        for name, (of, along, mean, sigma) in LENGTHS.items()
    ]
    (folder / "scene.yaml").write_text(SCENE.format(tolerances="\n".join(lines), trials=request.param), "utf-8")
    return run_scene(folder / "scene.yaml", out=folder / "run")


def test_screen_page_chart_map_and_table_name_the_same_largest_contributor_first(run: Run) -> None:
    measure = run.found.measures["size"]
    assert measure.shares_by is not None
    way, left = measure.shares_by["geometric"].by, 100 - (measure.shares_by["geometric"].explained_percent or 0.0)
    assert way == ("total effects" if run.trials == 6000 else "high-low-mean")
    truth = {name: total_of(name) for name in ("first", "largest", "third")}
    assert max(truth, key=lambda name: truth[name][0]) == "largest"
    found = geometric(measure)
    if way == "total effects":
        errors = {own.name: own.geometric_percent_se or 0.0 for own in measure.contributors}
        for name, (effect, variance) in truth.items():
            assert abs(found[name] - 100 * effect / variance) < SURE * errors[name]
    words = f"not attributed {left:.0f} %; by {way.replace('-', '–')}: largest {found['largest']:.0f} %"
    screen = printed(run_report(run.found, Detail.SHORT)).splitlines()
    assert any(line.startswith("size ") and words in " ".join(line.split()) for line in screen), screen
    assert words in report_html([run], in_3d=False)
    first, second, *_ = contributors_table(measure).rows
    assert (first.label, second.label) == ("not attributed", "largest")
    assert shown_names(measure)[0][0] == "largest"
    assert percents_of(measure) == found
    drawn = svg(pareto(measure), NARROW)
    assert drawn.index(">largest<") < drawn.index(">first<") < drawn.index(">third<")
    with (run.path / "contributors.csv").open(newline="") as file:
        head, *rows = csv.reader(file)
    column = head.index("size")
    by_csv = {row[1]: float(row[column]) for row in rows if row[0] == "3D simulation" and row[column]}
    assert next(iter(by_csv)) == "not attributed"
    assert by_csv.pop("not attributed") == pytest.approx(left)
    assert by_csv == found
    assert ["shares by", "3D simulation", way, "regression"] in rows


def test_the_measure_beside_it_keeps_its_regression(run: Run) -> None:
    beside: Mapping[str, float] = geometric(run.found.measures["plain"])
    assert run.found.measures["plain"].shares_by is None
    assert max(beside, key=beside.__getitem__) == "of c"
