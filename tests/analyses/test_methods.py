"""Methods side by side: published stacks, closed forms, and worst cases by brute force."""

import itertools
import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from formulas import Formula
from formulas import formula as response_with
from numpy.typing import NDArray
from scipy import stats
from toys.parabola import PARABOLA
from toys.registered import TOYS, known
from toys.rods import RODS
from typer.testing import CliRunner

from tol3d import InputError, Overrides, run_scene
from tol3d.analyses.fitted_law import KINDS, Moments, fitted
from tol3d.analyses.methods_section import MeasureMethods, Methods
from tol3d.analyses.response import Response, response_of
from tol3d.analyses.shown_methods import NO_SLOPE, methods_report
from tol3d.analyses.side_by_side import Drawn, methods, modified_factor
from tol3d.analyses.subject import sections_of, text_of_section
from tol3d.cli import app
from tol3d.report.page import Line
from tol3d.simulate import load, simulation_of
from tol3d.statistics.distributions import Distribution, Normal, Uniform
from tol3d.study.effects.worst_cases import worst_cases
from tol3d.study.results.task import materials_of, method_of
from tol3d.study.runs.run import open_run
from tol3d.study.system.copula import Block
from tol3d.study.system.draw import Ball, Draw, Each, Planar, Scalar
from tol3d.study.system.each_planar import EachPlanar
from tol3d.study.system.plain import PlainContributor, PlainMeasure
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study

Array = NDArray[np.float64]
INCH = 25.4  # mm


def formula(value: Callable[[Array], Array], draws: Sequence[Draw], trials: int = 2000) -> Response:
    contributors = tuple(PlainContributor(f"x{k}", "x", draw, "um", 1e-3) for k, draw in enumerate(draws))
    system = Formula("formula", contributors, (PlainMeasure("value", "value"),), value)
    return response_of(Simulation(system, Study(trials=trials)))


def scalars(laws: Sequence[Distribution]) -> list[Draw]:
    return [Scalar(law) for law in laws]


def alone(response: Response) -> MeasureMethods:
    (found,) = methods(response).measures.values()
    return found


def worst_of(found: MeasureMethods) -> tuple[float, float]:
    assert found.worst is not None
    assert found.worst.low is not None
    assert found.worst.high is not None
    assert found.worst.low.measured is not None
    assert found.worst.high.measured is not None
    return found.worst.low.measured, found.worst.high.measured


MOTOR = {  # name: dimension, slope, tolerance [inch]; Drake 1999, chapter 9
    "screw thread depth": (0.3595, -1, 0.0155),
    "washer": (0.0320, 1, 0.0020),
    "inner bearing cap": (0.0600, 1, 0.0030),
    "bearing": (0.4305, 1, 0.0075),
    "spacer": (0.1200, 1, 0.0050),
    "rotor": (1.5030, 1, 0.0070),
    "second spacer": (0.1200, 1, 0.0050),
    "second bearing": (0.4305, 1, 0.0075),
    "pulley casting": (0.4500, 1, 0.0070),
    "shaft": (3.0250, -1, 0.0060),
    "tapped hole depth": (0.3000, 1, 0.0300),
}


def test_the_motor_assembly_has_its_published_worst_case_rss_and_modified_rss() -> None:
    """Gap 0.0615 in: worst ±0.0955, RSS ±0.0381, modified ±0.0505, as printed, to half of their last digit."""
    sizes, slopes, tolerances = (np.array(own) for own in zip(*MOTOR.values(), strict=True))
    gap = float(sizes @ slopes)
    assert gap == pytest.approx(0.0615)
    laws = [Normal(0.0, own * INCH / 3, (-own * INCH, own * INCH)) for own in tolerances]
    found = alone(formula(lambda x: INCH * gap + x @ slopes, scalars(laws)))
    per_inch = 1e3 * INCH
    low, high = worst_of(found)
    assert (high - low) / 2 / per_inch == pytest.approx(0.0955, abs=1e-9)
    assert found.by_slopes is not None
    assert found.rss is not None
    assert found.by_slopes / per_inch == pytest.approx(0.0955, abs=1e-9)
    assert found.rss / per_inch == pytest.approx(0.0381, abs=0.00005)
    assert found.modified_rss is not None
    assert found.modified_rss / per_inch == pytest.approx(0.0505, abs=0.00005)
    assert found.contributors == 11
    assert found.factor == pytest.approx(modified_factor(0.0955, found.rss / per_inch, 11))
    assert found.worst is not None
    assert found.worst.low is not None
    expected = {f"x{k}": [-sign * own * per_inch] for k, (_, sign, own) in enumerate(MOTOR.values())}
    assert dict(found.worst.low.deviations) == {name: pytest.approx(own) for name, own in expected.items()}


@pytest.mark.parametrize("rho", [0.6, -0.6])
def test_rss_of_correlated_normals_is_that_of_their_covariance(rho: float) -> None:
    """Three sigma of 2 x - y: 3 √(4 σ² + τ² - 4 ρ σ τ)."""
    draws = scalars([Normal(0.0, 0.01), Normal(0.0, 0.03)])
    block = Block(("x0", "x1"), ((1.0, rho), (rho, 1.0)))
    own = response_with(lambda x: 2 * x[:, 0] - x[:, 1], draws, blocks=[block])
    truth = 3 * math.sqrt(4e-4 + 9e-4 - 4 * rho * 3e-4)
    assert methods(own).measures["value"].rss == pytest.approx(truth, rel=1e-9)


def test_a_linear_sum_of_normals_has_the_same_ends_by_rss_and_by_simulation() -> None:
    """Three sigma of each give three of the sum; 5 standard errors of a sigma from 20 000 trials."""
    slopes, sigmas = np.array([2.0, -1.0, 0.5]), np.array([0.01, 0.02, 0.03])
    own = formula(lambda x: x @ slopes, scalars([Normal(0.0, sigma) for sigma in sigmas]), 20_000)
    found = alone(own)
    truth = 3e3 * float(np.linalg.norm(slopes * sigmas))
    assert found.rss == pytest.approx(truth, rel=1e-9)
    sample = found.simulation
    assert sample.sigma is not None
    assert 3 * sample.sigma == pytest.approx(truth, rel=5 / math.sqrt(2 * 20_000))
    assert sample.p99_865 == pytest.approx(truth, rel=0.08)
    assert sample.law is not None
    assert sample.law.name == "normal"
    assert found.by_slopes == pytest.approx(3e3 * float(np.abs(slopes * sigmas).sum()), rel=1e-9)


def clutch(x: Array) -> Array:
    """Fortini's one-way clutch: the contact angle [rad] of deviations of hub, two rollers and cage [mm]."""
    hub, first, second, cage = (np.array([55.29, 22.86, 22.86, 101.69]) + x).T
    return np.asarray(np.arccos((hub + (first + second) / 2) / (cage - (first + second) / 2)))


def test_the_worst_case_of_the_clutch_is_at_corners() -> None:
    """Monotonic in each dimension: the worst of all sixteen corners."""
    ends = np.array([0.0762, 0.0127, 0.0127, 0.0762])
    corners = np.array([*itertools.product(*((-own, own) for own in ends))])
    values = 1e3 * clutch(corners)
    found = alone(formula(clutch, scalars([Uniform(-own, own) for own in ends])))
    assert worst_of(found) == pytest.approx((values.min(), values.max()), rel=1e-9)


def test_a_worst_case_inside_the_tolerances_is_found() -> None:
    """-(x - 0.3)² - 2 (y + 0.2)² + 0.4 (x - 0.3) (y + 0.2): the highest point is (0.3, -0.2), the lowest a corner."""

    def hill(x: Array) -> Array:
        a, b = x[:, 0] - 0.3, x[:, 1] + 0.2
        return 1.0 - a * a - 2 * b * b + 0.4 * a * b

    found = alone(formula(hill, scalars([Uniform(-1.0, 1.0)] * 2)))
    low, high = worst_of(found)
    assert high == pytest.approx(1000.0, abs=1e-3)
    corners = hill(np.array([*itertools.product((-1.0, 1.0), repeat=2)]))
    assert low == pytest.approx(1e3 * corners.min(), rel=1e-9)
    assert found.worst is not None
    assert found.worst.high is not None
    assert [own[0] for own in found.worst.high.deviations.values()] == pytest.approx([300.0, -200.0], abs=1.0)


def test_a_measure_that_has_no_slope_at_its_mean_has_a_worst_case_all_the_same() -> None:
    own = formula(lambda x: np.abs(x[:, 0]) * np.abs(x[:, 1]), scalars([Uniform(-1.0, 1.0)] * 2))
    found = alone(own)
    assert worst_of(found) == pytest.approx((0.0, 1000.0), abs=1e-9)
    assert (found.by_slopes, found.rss, found.factor, found.modified_rss) == (None, None, None, None)
    page = methods_report(methods(own))
    told = {row.label: [str(cell) for cell in row.cells[:2]] for row in page.tables[0].rows}
    assert {name: told[name] for name in ("worst by slopes", "RSS")} == {"worst by slopes": ["–"] * 2, "RSS": ["–"] * 2}
    assert NO_SLOPE in "".join(str(block) for block in page.blocks if isinstance(block, Line))


def test_directions_are_all_at_their_worst_together() -> None:
    """Lengths of a plane, of space, of each of three features, and features alone: radii times sizes of gradients."""
    law = Uniform(0.0, 0.01)
    names = ("a", "b", "c")
    draws: list[Draw] = [Planar(law, None), Ball(law), EachPlanar(law, names, None), Each(Uniform(-0.02, 0.01), names)]
    slopes = np.array([3.0, -4.0, 1.0, 2.0, 2.0, 1.0, 0.0, 0.0, -2.0, 3.0, 4.0, 1.0, -1.0, 0.5])
    found = alone(formula(lambda x: x @ slopes, draws))
    rounds = 0.01 * (5 + 3 + 1 + 2 + 5)
    assert worst_of(found) == pytest.approx(
        (1e3 * (-rounds - 0.02 * 1.5 - 0.01), 1e3 * (rounds + 0.01 * 1.5 + 0.02)), rel=1e-9
    )
    assert found.contributors == 8
    assert found.rss == pytest.approx(
        1e3 * math.sqrt(0.01**2 * (25 + 9 + 1 + 4 + 25) + 0.015**2 * (1 + 1 + 0.25)), rel=1e-9
    )


def test_no_worst_case_is_inside_a_trial() -> None:
    """A rough function of six tolerances against 200 000 trials and all corners."""

    def rough(x: Array) -> Array:
        return np.sin(2 * x[:, 0]) + x[:, 1] * x[:, 2] - np.maximum(x[:, 3], x[:, 4]) ** 2 + 0.3 * x[:, 5] * x[:, 0]

    own = formula(rough, scalars([Uniform(-1.0, 1.0)] * 6), 200_000)
    found = alone(own)
    low, high = worst_of(found)
    corners = 1e3 * rough(np.array([*itertools.product((-1.0, 0.0, 1.0), repeat=6)]))
    assert low <= min(found.simulation.sample_min or 0.0, corners.min()) + 1e-6
    assert high >= max(found.simulation.sample_max or 0.0, corners.max()) - 1e-6
    assert found.simulation.beyond_worst == 0


def test_trials_beyond_the_worst_case_are_counted() -> None:
    """A normal law draws beyond ±3 sigma: as many as the numbers say."""
    own = formula(lambda x: x[:, 0], scalars([Normal(0.0, 0.01)]), 20_000)
    drawn = Drawn.of(own, 20_000)
    found = methods(own, drawn).measures["value"]
    assert worst_of(found) == pytest.approx((-30.0, 30.0))
    assert found.simulation.beyond_worst == int(np.sum(np.abs(drawn.column("value")) > 30.0)) > 0
    assert found.factor is None


# laws -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("law", "name"),
    [
        (stats.norm(3.0, 2.0), "normal"),
        (stats.pearson3(1.2, 5.0, 2.0), "Pearson III"),
        (stats.beta(1.0, 1.0), "Pearson I"),
        (stats.t(8.0), "Pearson VII"),
    ],
)
def test_the_law_of_a_sample_is_found_again(law: Any, name: str) -> None:
    """Its outer quantiles too, within 10 % of their distance from the mean."""
    values = np.asarray(law.rvs(2000, random_state=11))
    found = fitted(values)
    assert found.name == name
    assert found.p_value > 0.05
    for share, own in ((0.00135, found.low), (0.99865, found.high)):
        assert own == pytest.approx(float(law.ppf(share)), abs=0.1 * abs(float(law.ppf(share) - law.mean())))


def test_a_law_that_is_none_of_them_is_rejected() -> None:
    """Two thirds normal, a third far aside."""
    found = fitted(np.concatenate([stats.norm().rvs(1000, random_state=3), np.linspace(5.0, 5.2, 500)]))
    assert found.p_value <= 0.05


# scenes -----------------------------------------------------------------------------------------------------


def test_the_gearboxs_first_backlash_is_lower_than_its_ends_by_slopes_say() -> None:
    """14.56 µm by a million builds of a descent of its own; ends by slopes 19.88 µm."""
    simulation = simulation_of(load("gearbox_in_housing"))
    measure = next(own for own in simulation.system.measures if own.name == "first normal backlash")
    found = worst_cases(simulation, method_of(simulation, materials_of(simulation)), [measure])[measure.name]
    for own in found.values():
        assert own is not None
        assert own.low is not None
        assert own.low.value <= 14.6


@pytest.mark.slow
def test_the_3k_reducers_lost_motion_is_lower_than_its_ends_by_slopes_say() -> None:
    """At most 4.3′; ends by slopes 7.4′, and 1.6 million trials reached 6.5′."""
    simulation = simulation_of(load("reducer_3k"))
    measure = next(own for own in simulation.system.measures if own.name == "lost motion")
    found = worst_cases(simulation, method_of(simulation, materials_of(simulation)), [measure])[measure.name]
    for own in found.values():
        assert own is not None
        assert own.low is not None
        assert own.low.value <= 4.3


def test_contributors_that_read_others_are_worst_where_these_leave_them() -> None:
    """A rod's length is 0 to 100 µm, its tip ±20 (1 + length / 100), a mark ±5 tip / 10: -30 and 160 µm at the most."""
    with known(RODS):
        response = response_of(simulation_of(load(TOYS / "rods" / "rods.yaml")))
    assert worst_of(alone(response)) == pytest.approx((100_000 - 30, 100_000 + 160), rel=1e-9)


def test_a_jam_is_told() -> None:
    found = methods(response_of(simulation_of(load("spur_pair"))).of("normal backlash")).measures["normal backlash"]
    assert found.worst is not None
    assert found.worst.low is not None
    assert found.worst.low.status == "interferes"
    assert found.worst.low.measured is not None
    assert found.worst.low.measured < 0.0
    assert found.worst.met > 0


def test_a_mechanism_from_outside_has_all_methods_and_a_run_keeps_them(tmp_path: Path) -> None:
    picture, table = tmp_path / "methods.png", tmp_path / "methods.csv"
    with known(PARABOLA):
        scene = TOYS / "parabola" / "spring.yaml"
        run = run_scene(scene, overrides=Overrides(trials=500, witness=0), out=tmp_path / "run")
        asked = f"methods {run.path} --measure height --picture {picture} --csv {table}"
        told = CliRunner().invoke(app, asked.split())
        assert told.exit_code == 0, told.output
        found = sections_of(open_run(run.path))["methods"]
        kept = np.asarray(run.columns("geometric:height")["geometric:height"], dtype=np.float64)
    assert "worst found" in told.output
    assert picture.stat().st_size > 5000
    assert "modified RSS" in table.read_text("utf-8")
    assert isinstance(found, Methods)
    of_old = json.loads(text_of_section(found).replace('"method":', '"road":', 1))
    assert Methods.model_validate(of_old) == found  # as runs kept it until November 2026
    sample = found.measures["height"].simulation
    assert sample.trials == 500
    assert sample.mean == pytest.approx(float(kept.mean()))


def test_what_cannot_be_asked_is_refused() -> None:
    with pytest.raises(InputError, match="expected a measure, got"):
        response_of(simulation_of(load("spur_pair"))).of("backlash of nothing")


@pytest.mark.parametrize(("a", "b"), [(2.0, 5.0), (5.0, 2.0), (1.5, 9.0)])
def test_a_beta_law_is_found_by_its_moments_on_the_side_to_which_it_leans(a: float, b: float) -> None:
    """Between 3 and 10, by scipy's moments of that law."""
    mean, variance, skewness, kurtosis = stats.beta(a, b, 3.0, 7.0).stats("mvsk")
    (kind,) = [own for own in KINDS if own.name == "Pearson I"]
    own = Moments(*(np.array([float(each)]) for each in (mean, np.sqrt(variance), skewness, kurtosis)))
    assert [float(each[0]) for each in kind.fit(own)] == pytest.approx([a, b, 3.0, 7.0], rel=1e-9)
