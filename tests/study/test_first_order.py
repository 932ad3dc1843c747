"""Effect of each deviation on a measure, before any trial: against closed forms of a sum and of a parabola."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from tol3d.numerics.arrays import Array
from tol3d.report.check import check_report
from tol3d.report.sheet import as_text
from tol3d.statistics.distributions import Constant, Normal, Rayleigh, Uniform
from tol3d.study.effects.first_order import FirstOrder, first_orders
from tol3d.study.results.task import materials_of, method_of
from tol3d.study.system.draw import Ball, Each, Planar, Scalar
from tol3d.study.system.measure import Measure
from tol3d.study.system.plain import PlainContributor, PlainMeasure, PlainSystem
from tol3d.study.system.trials import Trials
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study

UM = 1e-3  # mm
SLOPES = {"size": (3.0,), "anywhere": (3.0, -4.0), "eastwards": (3.0, -4.0), "point": (1.0, 2.0, 2.0)}
SLOPES |= {"pins": (0.0, 1.0, -2.0), "fixed": (7.0,)}
BEND = 40.0  # 1/mm; of the exact method, in the size
MEAN, SIGMA = 20.0, 2.0  # um, of the size; its ends are 14 and 26


@dataclass(frozen=True)
class Sum(PlainSystem):
    """1 mm and a sum of effects; placed, also a square of the size."""

    def analytic(self, trials: Trials, measure: Measure) -> Array:
        return 1.0 + np.asarray(trials.deviations @ np.concatenate([SLOPES[own.name] for own in self.contributors]))

    def exact(self, trials: Trials, measure: Measure) -> Array:
        return self.analytic(trials, measure) + BEND * trials.deviations[:, 0] ** 2


def simulation(engine: str = "exact", *, adds_up: bool = True) -> Simulation:
    rayleigh = Rayleigh(5 * UM)
    contributors = (
        PlainContributor("size", "length", Scalar(Normal(MEAN * UM, SIGMA * UM))),
        PlainContributor("anywhere", "offset", Planar(rayleigh, None)),
        PlainContributor("eastwards", "offset", Planar(Uniform(1 * UM, 3 * UM), 0.0), least=0.0),
        PlainContributor("point", "place", Ball(rayleigh)),
        PlainContributor("pins", "pin", Each(Uniform(-1 * UM, 3 * UM), ("a", "b", "c"))),
        PlainContributor("fixed", "length", Scalar(Constant(0.0)), least=-1 * UM),
    )
    measure = PlainMeasure("gap", "gap", lower_limit=0.5, adds_up=adds_up)
    return Simulation(Sum("a sum", contributors, (measure,)), Study(engine=engine))


def found_by(engine: str = "exact") -> dict[str, FirstOrder]:
    asked = simulation(engine)
    return first_orders(asked, method_of(asked, materials_of(asked)), asked.system.measures)["gap"]


def test_slopes_are_those_of_the_sum_and_of_a_parabola_at_its_mean() -> None:
    """Slope of 3 x + 40 x² at 20 um: 3 + 2 * 40 / mm * 0.020 mm = 4.6; others as they are, or their size.

    Eastwards only the first component counts; a constant is moved by a um to see what it would do. Each of the pins has
    a slope of its own, of which the greatest is shown, with its sign.
    """
    slopes = {method: {own.name: own.slope for own in found.effects} for method, found in found_by().items()}
    expected = {"size": 3.0, "anywhere": 5.0, "eastwards": 3.0, "point": 3.0, "pins": -2.0, "fixed": 7.0}
    assert slopes["analytic"] == pytest.approx(expected, rel=1e-9)
    assert slopes["geometric"] == pytest.approx(expected | {"size": 4.6}, rel=1e-9)


def test_slopes_of_each_of_several_are_alike_or_the_greatest_of_them() -> None:
    """The slopes 0, 1 and -2 of the pins are not alike; all of one size and sign are, within 1e-6 of it."""
    law = Uniform(-1 * UM, 1 * UM)
    for slopes, alike in (((0.0, 1.0, -2.0), False), ((-2.0, -2.0, -2.0), True), ((-2.0, 1.0, -2.0), False)):

        @dataclass(frozen=True)
        class Pins(PlainSystem):
            def analytic(self, trials: Trials, measure: Measure) -> Array:
                return np.asarray(trials.deviations @ np.array(slopes))  # noqa: B023

        pins = PlainContributor("pins", "pin", Each(law, ("a", "b", "c")))
        asked = Simulation(Pins("pins", (pins,), (PlainMeasure("gap", "gap"),)), Study(engine="analytic"))
        (effect,) = first_orders(asked, None, asked.system.measures)["gap"]["analytic"].effects
        assert (effect.each, effect.alike) == (3, alike)
        assert effect.slope == pytest.approx(-2.0)


def test_builds_are_worked_out_by_both_methods() -> None:
    """Means: the size at 20, east at 2, pins at 1 each: 60 + 6 + 0 + 1 - 2 = 65 um, and 40 * 0.02² mm = 16 um."""
    found = found_by()
    assert [own.nominal for own in found.values()] == pytest.approx([1000.0, 1000.0])
    assert [own.mean for own in found.values()] == pytest.approx([1065.0, 1081.0])


def test_the_root_sum_of_squares_is_the_sigma_of_the_sum_drawn() -> None:
    """Against a million trials of numpy's own generators: 4 standard errors of a sigma, 1 / sqrt(2 n)."""
    count, rng = 1_000_000, np.random.default_rng(5)
    values = 3.0 * rng.normal(MEAN, SIGMA, count)
    length, angle = rng.rayleigh(5.0, count), rng.uniform(0.0, 2 * np.pi, count)
    values += length * (3.0 * np.cos(angle) - 4.0 * np.sin(angle)) + 3.0 * rng.uniform(1.0, 3.0, count)
    towards = rng.normal(size=(count, 3))
    towards /= np.linalg.norm(towards, axis=1)[:, None]
    values += rng.rayleigh(5.0, count) * (towards @ np.array([1.0, 2.0, 2.0]))
    values += rng.uniform(-1.0, 3.0, (count, 3)) @ np.array([0.0, 1.0, -2.0])
    sigma = found_by()["analytic"].sigma
    assert sigma == pytest.approx(float(values.std()), rel=4 / math.sqrt(2 * count))


def test_the_worst_cases_are_those_of_all_corners() -> None:
    """By hand: size 14 or 26, lengths at their largest along or against, pins at -1 or 3, each for itself."""
    radius = Rayleigh(5.0).radius
    low = 3 * 14 - 5 * radius + 3 * 1 - 3 * radius + (-1.0 - 2 * 3.0)
    high = 3 * 26 + 5 * radius + 3 * 3 + 3 * radius + (3.0 + 2 * 1.0)
    found = found_by()
    assert found["analytic"].ends == pytest.approx((1000 + low, 1000 + high))
    assert found["geometric"].ends == pytest.approx(
        (1000 + low + 40 * 0.014**2 * 1e3, 1000 + high + 40 * 0.026**2 * 1e3)
    )
    analytic = found["analytic"]
    reaches = {own.name: own.reach for own in analytic.effects}
    assert reaches == pytest.approx(
        {"size": 36, "anywhere": 10 * radius, "eastwards": 6, "point": 6 * radius, "pins": 12, "fixed": 0}
    )
    assert sum(analytic.reach_percent(own) for own in analytic.effects) == pytest.approx(100.0)
    assert sum(analytic.variance_percent(own) for own in analytic.effects) == pytest.approx(100.0)


def test_check_prints_contributors_measures_and_what_each_does() -> None:
    lines = [" ".join(row.split()) for row in as_text(check_report(simulation()), 120).splitlines()]
    assert "size length normal 20 2 µm –" in lines
    assert "anywhere offset rayleigh, random direction 6.267 5 µm –" in lines  # sqrt(pi / 2) * 5
    assert "eastwards offset uniform, fixed direction 2 0.577 µm 0" in lines  # 2 / sqrt(12)
    assert "pins pin uniform, each of 3 1 1.15 µm –" in lines  # 4 / sqrt(12)
    assert "gap gap ≥ 500 µm 1000.0 1000.0 1065.0 1081.0 µm" in lines
    (row,) = (line for line in lines if line.startswith("size µm/µm"))
    assert row.split()[2:4] == ["3", "4.6"]
    total = 3**2 * 4 + 25 * 25 + 9 / 3 + 9 * 2 * 25 / 3 + 5 * 16 / 12  # a Rayleigh length has mean square 2 * 5²
    assert float(row.split()[4]) == pytest.approx(100 * 36 / total, abs=0.051)
    assert any(line.startswith(f"analytic: sigma {math.sqrt(total):.3f} µm by RSS") for line in lines)
    assert lines[-1] == "study: 2000 trials, seed 1, monte_carlo, engine exact"


def test_without_an_engine_there_is_the_analytic_method_alone() -> None:
    assert list(found_by("analytic")) == ["analytic"]
    assert "exact" not in as_text(check_report(simulation("analytic")), 120)


def test_what_is_no_sum_has_no_shares_and_no_worst_case() -> None:
    printed = as_text(check_report(simulation(adds_up=False)), 120)
    assert "no sum of effects" in printed
    assert "RSS [%]" not in printed
    assert "by RSS" not in printed
