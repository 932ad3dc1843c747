"""Contributors that act without a slope: dead centres, distances across, cosine errors; oracles by quadrature."""

import math
import pickle
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from oracles.limit_states import Formula, Value
from printing import printed
from scene_texts import scene_of
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.stats import norm

from tol3d.analyses.allocation import allocation
from tol3d.analyses.before_after import what_if
from tol3d.analyses.rare_events import limits_left
from tol3d.analyses.response import Response, response_of
from tol3d.analyses.shown_changes import changes_lines
from tol3d.analyses.side_by_side import methods
from tol3d.analyses.stated_changes import Change
from tol3d.analyses.tolerance_effects import effects
from tol3d.analyses.tolerance_search import Question, Target
from tol3d.analyses.what_to_change import changes_of
from tol3d.errors import InputError
from tol3d.report.page import page
from tol3d.statistics.distributions.normal import Normal
from tol3d.study.effects.acting_contributors import acting, looked_at
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.draw import Scalar
from tol3d.study.system.measure import Measure
from tol3d.study.system.plain import PlainContributor, PlainMeasure
from tol3d.study.trials.overrides import simulation_of
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study

SCENES = Path(__file__).parents[2] / "scenes"
LIMIT = 1.03
"""mm; of the distance of two points 1 mm apart along z."""


def scene(folder: Path, tolerances: str, more: str = "", measures: str = "", trials: int = 2000) -> Simulation:
    """Two points of a part, b 1 mm above a, and their distance."""
    own = measures or f"  d: {{kind: distance, from: base.a, to: base.b, upper_limit: {LIMIT} mm}}"
    text = f"""
scene: across
parts:
  base:
    kind: solid
    features:
      a: {{kind: point, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1]}}
      b: {{kind: point, at: [0 mm, 0 mm, 1 mm], normal: [0, 0, 1]}}
      c: {{kind: point, at: [7 mm, 2 mm, 1 mm], normal: [0, 0, 1]}}
{more}
tolerances:
{tolerances}
moves:
  table: {{kind: fix, part: base}}
measures:
{own}
study: {{trials: {trials}, seed: 1}}
"""
    return simulation_of(scene_of(text, folder))


def along(name: str, axis: str, law: str, of: str = "base.b") -> str:
    return f"  {name}: {{kind: plus_minus, of: {of}, along: {axis}, distribution: {law}}}\n"


SECOND_ORDER = along("x", "[1, 0, 0]", "{kind: normal, mean: 0 um, sigma: 100 um}") + along(
    "z", "[0, 0, 1]", "{kind: normal, mean: 0 um, sigma: 1 um}"
)


def ppm_beyond(limit: float, x: float, z: float) -> float:
    """Share [ppm] of (1 + Z)² + X² beyond limit², normal with sigmas x and z [mm], by quadrature over Z."""

    def beyond(u: float) -> float:
        room = limit**2 - (1 + z * u) ** 2
        return 2 * norm.sf(math.sqrt(max(room, 0.0)) / x) * norm.pdf(u)

    return 1e6 * quad(beyond, -10, 10, points=[0.0], epsabs=0, epsrel=1e-10, limit=400)[0]


def share_of_x(x: float, z: float) -> float:
    """Total Sobol' index of X in the distance, by Gauss and Hermite: mean over Z of the variance over X."""
    u, weights = np.polynomial.hermite_e.hermegauss(60)
    weights = weights / weights.sum()
    values = np.hypot(1 + z * u[:, None], x * u[None])
    mean = weights @ values @ weights
    within = weights @ (values**2 @ weights - (values @ weights) ** 2)
    return float(within / (weights @ values**2 @ weights - mean**2))


@pytest.fixture(scope="module")
def second_order(tmp_path_factory: pytest.TempPathFactory) -> Response:
    return response_of(scene(tmp_path_factory.mktemp("second"), SECOND_ORDER))


def test_a_distance_across_acts_by_second_order(second_order: Response) -> None:
    (measure,) = second_order.measures
    assert [own.name for own in second_order.acting(measure)] == ["x", "z"]
    assert looked_at(second_order.simulation, measure).names == {"x"}
    told = effects(second_order, base=2**12).measures["d"].contributors
    expected = share_of_x(0.1, 0.001)
    assert expected == pytest.approx(0.98, abs=0.005)
    total = told["x"].total
    assert total is not None
    assert total.low < expected < total.high
    assert total.high - total.low < 0.03


def test_halving_what_acts_by_second_order_is_worth_what_quadrature_says(second_order: Response) -> None:
    assert ppm_beyond(LIMIT, 0.1, 0.001) == pytest.approx(13_686, abs=1)
    assert ppm_beyond(LIMIT, 0.05, 0.001) == pytest.approx(0.872, abs=0.001)
    found = what_if(second_order, [Change("x", factor=0.5)], trials=200).measures["d"]
    for state, x in ((found.before, 0.1), (found.after, 0.05)):
        low, high = state.limits["high"].interval or (math.nan, math.nan)
        assert low < ppm_beyond(LIMIT, x, 0.001) < high < 1.35 * low


def test_changes_halve_what_moves_the_measure(second_order: Response) -> None:
    best = changes_of(second_order).measures["d"].proposals[0]
    assert [step.contributor for step in best.steps] == ["x"]
    assert best.after.out_ppm == 0.0


def test_worst_cases_move_what_has_no_slope(second_order: Response) -> None:
    worst = methods(second_order).measures["d"].worst
    assert worst is not None
    assert worst.high is not None
    assert worst.high.measured == pytest.approx(1000 * math.hypot(1.003, 0.3), abs=1e-3)


def test_an_allocation_tightens_what_has_no_slope(second_order: Response) -> None:
    factor = brentq(lambda own: ppm_beyond(LIMIT, 0.1 * own, 0.001) - 1000.0, 0.5, 1.0)
    assert factor == pytest.approx(0.7490, abs=5e-4)
    found = allocation(second_order, [Target("d", (), 1000.0)], Question(frozen=frozenset({"z"})), draws=4000)
    assert found.tolerances["x"].factor == pytest.approx(factor, rel=0.01)  # of 4000 draws, 2 % of the ppm
    both = allocation(second_order, [Target("d", (), 1000.0)], draws=4000)
    factors = {name: own.factor for name, own in both.tolerances.items()}
    assert ppm_beyond(LIMIT, 0.1 * factors["x"], 0.001 * factors["z"]) == pytest.approx(1000.0, rel=0.08)


def test_a_measure_on_which_nothing_acts_gets_a_sentence(tmp_path: Path) -> None:
    simulation = scene(tmp_path, along("x", "[1, 0, 0]", "{kind: normal, mean: 0 um, sigma: 9 um}", "base.c"))
    response = response_of(simulation)
    (measure,) = response.measures
    words = "no tolerance was seen to act on it in 48 builds"
    assert not response.acting(measure)
    assert effects(response, base=128).measures["d"].failures_words == words
    assert methods(response).measures["d"].nothing_acts == words
    (event,) = limits_left(response)
    assert event.probability == 0.0
    assert event.estimate.warnings[0].startswith(words)
    with pytest.raises(InputError, match="not seen to act in 48 builds"):
        what_if(response, [Change("x", factor=0.5)])
    with pytest.raises(InputError, match=words):
        allocation(response, [Target("d", (), 1000.0)])


def test_advice_on_a_measure_on_which_nothing_acts_names_no_tolerance(tmp_path: Path) -> None:
    own = "  d: {kind: distance, from: base.a, to: base.b, upper_limit: 0.9 mm}"
    simulation = scene(tmp_path, along("x", "[1, 0, 0]", "{kind: normal, sigma: 9 um, mean: 0 um}", "base.c"), "", own)
    found = changes_of(response_of(simulation))
    assert found.measures["d"].now.out_ppm == 1e6
    assert not found.measures["d"].proposals
    said = " ".join(printed(page(*changes_lines(found, "scene")), 120).split())
    assert said.endswith("no tolerance that acts on it can be changed: change the nominal geometry or the limit")


def test_what_acts_alone_without_a_slope_has_the_whole_variance(tmp_path: Path) -> None:
    simulation = scene(tmp_path, along("x", "[1, 0, 0]", "{kind: normal, mean: 0 um, sigma: 100 um}"))
    own = effects(response_of(simulation), base=512).measures["d"].contributors["x"]
    assert own.total is not None
    assert own.total.share == pytest.approx(1.0, abs=1e-9)
    (measure,) = simulation.system.measures
    assert [each.name for each in acting(pickle.loads(pickle.dumps(simulation)), measure)] == ["x"]


# systems whose theory leaves contributors out ------------------------------------------------------


@dataclass(frozen=True)
class Partly(Formula):
    """A formula of which theory knows some contributors alone; it counts the builds."""

    known: tuple[str, ...] = ()

    def acting(self, measure: Measure) -> Sequence[Contributor]:
        return [own for own in self.contributors if own.name in self.known]


def partly(value: Value, count: int, known: Sequence[str], trials: int = 1000) -> Simulation:
    """Standard normals x0, x1, …, of which theory knows some."""
    laws = [Scalar(Normal(0.0, 1.0))] * count
    contributors = tuple(PlainContributor(f"x{k}", "x", own, "1", 1.0) for k, own in enumerate(laws))
    measures = (PlainMeasure("value", "value", unit="1", per_internal=1.0),)
    return Simulation(Partly("partly", contributors, measures, value, known=tuple(known)), Study(trials=trials))


def acts(simulation: Simulation) -> list[str]:
    return [own.name for own in acting(simulation, simulation.system.measures[0])]


def test_where_all_have_slopes_no_build_is_made() -> None:
    def refused(x: np.ndarray, _: np.ndarray) -> np.ndarray:
        raise AssertionError("a build")

    assert acts(partly(refused, 3, ("x0", "x1", "x2"))) == ["x0", "x1", "x2"]


def test_each_of_many_is_told_apart_within_a_twentieth_of_the_run() -> None:
    rows = []

    def value(x: np.ndarray, _: np.ndarray) -> np.ndarray:
        rows.append(len(x))
        return x[:, 0] + 0.4 * x[:, 3] ** 2 + 0.3 * x[:, 11] * x[:, 0]

    simulation = partly(value, 30, ("x0", "x7"), trials=20_000)
    assert acts(simulation) == ["x0", "x3", "x7", "x11"]
    assert sum(rows) <= 20_000 / 20
    acts(simulation)
    assert sum(rows) <= 20_000 / 20


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_what_acts_in_builds_at_limits_alone_is_seen(sign: float) -> None:
    def value(x: np.ndarray, _: np.ndarray) -> np.ndarray:  # x1 acts in 1 % of the builds
        return x[:, 0] + np.where(sign * x[:, 0] > 2.33, x[:, 1], 0.0)

    assert acts(partly(value, 4, ("x0",))) == ["x0", "x1"]


def test_what_decides_if_a_build_can_be_assembled_acts() -> None:
    value = lambda x, _: np.where(x[:, 2] > 1.5, np.nan, x[:, 0])  # noqa: E731
    assert acts(partly(value, 3, ("x0",))) == ["x0", "x2"]


def test_what_moves_a_measure_by_scraps_of_its_sigma_does_not_count() -> None:
    value = lambda x, _: 3.0 * x[:, 0] + 1e-3 * x[:, 1] ** 2  # noqa: E731
    assert acts(partly(value, 3, ("x0",))) == ["x0"]


# a linkage at its dead centre ----------------------------------------------------------------------


@pytest.mark.slow
def test_an_encoder_acts_at_a_dead_centre(tmp_path: Path) -> None:
    text = (
        (SCENES / "slider_crank.yaml")
        .read_text("utf-8")
        .replace("-2 arcmin, upper: 2 arcmin", "-120 arcmin, upper: 120 arcmin")
    )
    simulation = simulation_of(scene_of(text, tmp_path))
    far, halfway = (own for own in simulation.system.measures if own.name in ("far end", "halfway"))
    assert "encoder of angle" in looked_at(simulation, far).names
    assert "encoder of angle" not in looked_at(simulation, halfway).names  # it has a slope
    response = response_of(simulation).of("far end")
    told = effects(response, base=2**9).measures["far end"].contributors["encoder of angle"].total
    # x = -e sin a + sqrt(l² - (e cos a)² - h²); near the dead centre e (1 + e / sqrt(l² - h²)) a² / 2
    turn, root = np.radians(2.0 / 3.0), math.sqrt(130.0**2 - 30.0**2)
    by_turn = 2 * (40.0 * (1 + 40.0 / root) * turn**2 / 2) ** 2  # variance of a² is 2 sigma⁴
    others = 0.02**2 / 9 + (0.03 / 3 * 130.0 / root) ** 2  # throw, rod
    assert told is not None
    assert told.low - 0.05 < by_turn / (by_turn + others) < told.high + 0.05
