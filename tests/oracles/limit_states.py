"""Limit states whose probabilities are known in closed form or by quadrature, as systems that analyses may ask."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.stats import chi2, norm

from tol3d.analyses.limit_state import Side
from tol3d.analyses.response import Response, response_of
from tol3d.statistics.distributions import Distribution
from tol3d.statistics.distributions.normal import Normal
from tol3d.statistics.distributions.uniform import Uniform
from tol3d.study.system.draw import Draw, Scalar
from tol3d.study.system.method import Answers, Method, MethodKind
from tol3d.study.system.outcome import Statuses
from tol3d.study.system.plain import PlainContributor, PlainMeasure, PlainSystem
from tol3d.study.system.system import StreamKey
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study

Array = NDArray[np.float64]
Value = Callable[[Array, Array], Array]
"""Value of deviations (n, components) and the position [rad] (n,); nan where a build does not seat."""


class FormulaMethod:
    """A function of deviations and the position as a method; not a number does not seat."""

    chord_error: ClassVar[float] = 0.0

    def __init__(self, value: Value) -> None:
        self.value = value

    def answers(self, trials: Any, measures: Sequence[Any]) -> Answers:
        angle = trials.positions.get("shaft", np.zeros(len(trials)))
        values = np.asarray(self.value(trials.deviations, angle), dtype=np.float64)
        codes = np.isnan(values).astype(np.int8)
        return Answers({own.name: values[:, None] for own in measures}, status={own.name: codes for own in measures})


@dataclass(frozen=True)
class Formula(PlainSystem):
    """A measure that is a function of deviations and, where it turns, of a position."""

    value: Value = len  # type: ignore[assignment]
    turns: bool = False

    methods: ClassVar[Mapping[str, MethodKind]] = {"analytic": MethodKind("model"), "exact": MethodKind("model")}
    statuses: ClassVar[Statuses] = Statuses(("ok", "no build"))

    def method(self, name: str, materials: Any) -> Method:
        return FormulaMethod(self.value)

    @property
    def streams(self) -> Sequence[StreamKey]:
        return (("shaft", ""),) if self.turns else ()

    def positions(self, uniforms: Mapping[StreamKey, Array]) -> Mapping[str, Array]:
        return {name: 2 * math.pi * own for (name, _), own in uniforms.items()}


def formula(value: Value, laws: Sequence[Distribution | Draw] | int, *, turns: bool = False) -> Response:
    """A response of one measure, of so many standard normals or of stated laws."""
    given = [Normal(0.0, 1.0)] * laws if isinstance(laws, int) else laws
    draws = [Scalar(own) if isinstance(own, Distribution) else own for own in given]
    contributors = tuple(PlainContributor(f"x{k}", "x", own, "1", 1.0) for k, own in enumerate(draws))
    measure = PlainMeasure("value", "value", unit="1", per_internal=1.0)
    return response_of(Simulation(Formula("formula", contributors, (measure,), value, turns), Study(trials=1000)))


@dataclass(frozen=True)
class Case:
    """A limit state with its probability.

    Args:
        name: what is hard about it.
        value, laws, turns: see `formula`.
        side, limit: that is left.
        probability: exactly.
        methods: that are expected to know it.
    """

    name: str
    value: Value
    laws: Sequence[Distribution | Draw] | int
    side: Side
    limit: float
    probability: float
    turns: bool = False
    methods: tuple[str, ...] = field(default=("importance", "subset"))

    def response(self) -> Response:
        return formula(self.value, self.laws, turns=self.turns)


def averaged(of_angle: Callable[[float], float]) -> float:
    """The mean over a turn."""
    angles = (np.arange(4096) + 0.5) / 4096 * 2 * math.pi
    return float(np.mean([of_angle(own) for own in angles]))


SIXTY = np.linspace(1.0, 2.0, 60)


def _curved(kappa: float, beta: float) -> float:
    """P(z1 > β + κ z2²/2) by quadrature."""
    found: float = quad(lambda y: norm.pdf(y) * norm.sf(beta + kappa * y * y / 2), -12, 12, points=[0.0], limit=400)[0]
    return found


def _paraboloid(kappa: float, beta: float, across: int) -> float:
    """P(z1 > β + κ/2 |y|²), y of so many dimensions."""
    law = chi2(across)
    found: float = quad(lambda s: law.pdf(s) * norm.sf(beta + kappa * s / 2), 0, 400, points=[across], limit=2000)[0]
    return found


def _hypot(x: Array, _: Array) -> Array:
    return np.asarray(np.hypot(x[:, 0], x[:, 1]))


CASES = (
    Case("a plane", lambda x, _: 3 * x[:, 0] - x[:, 1] + 0.5 * x[:, 2], 3, "high", 4 * math.sqrt(10.25), norm.sf(4)),
    Case("60 contributors", lambda x, _: x @ SIXTY, 60, "low", -4.5 * float(np.linalg.norm(SIXTY)), norm.sf(4.5)),
    Case(
        "two symmetric design points",
        lambda x, _: np.abs(x[:, 0]) + 0.01 * x[:, 1],
        2,
        "high",
        4.0,
        2 * norm.sf(4 / math.hypot(1, 0.01)),
    ),
    Case(
        "a design point behind another",
        lambda x, _: np.maximum(0.025 - np.abs(x[:, 0] - 4.025), x[:, 0] - 4.4) + 0.0 * x[:, 1],
        2,
        "high",
        0.0,
        norm.cdf(4.05) - norm.cdf(4.0) + norm.sf(4.4),
    ),
    Case(
        "a wide one behind a narrow one",
        lambda x, _: np.maximum(x[:, 0] - 4.0 - 20 * x[:, 1] ** 2, -x[:, 0] - 4.2),
        2,
        "high",
        0.0,
        _curved(40.0, 4.0) + norm.sf(4.2),
    ),
    Case(
        "four design points at different distances",
        lambda x, _: np.max([x[:, 0] - 3.6, -x[:, 0] - 3.9, x[:, 1] - 3.7, -x[:, 1] - 4.4], axis=0),
        2,
        "high",
        0.0,
        1 - (norm.cdf(3.6) - norm.cdf(-3.9)) * (norm.cdf(3.7) - norm.cdf(-4.4)),
    ),
    Case(
        "four of them among 20 contributors",
        lambda x, _: np.max([x[:, 0] - 3.6, -x[:, 3] - 3.9, x[:, 1] - 3.7, -x[:, 1] - 4.4], axis=0),
        20,
        "high",
        0.0,
        1 - norm.cdf(3.6) * norm.cdf(3.9) * (norm.cdf(3.7) - norm.cdf(-4.4)),
    ),
    Case("a ball", _hypot, 2, "high", 5.0, math.exp(-12.5)),
    Case("a ball in 8 dimensions", lambda x, _: np.sqrt((x * x).sum(axis=1)), 8, "high", 6.5, chi2.sf(6.5**2, 8)),
    Case("a corner", lambda x, _: np.minimum(x[:, 0], x[:, 1]), 2, "high", 3.0, norm.sf(3.0) ** 2),
    Case("a corner of three", lambda x, _: x[:, :3].min(axis=1), 6, "high", 2.2, norm.sf(2.2) ** 3),
    Case("a kink", lambda x, _: np.maximum(x[:, 0], x[:, 1]), 3, "high", 4.2, 1 - norm.cdf(4.2) ** 2),
    Case("curved towards the origin", lambda x, _: x[:, 0] + 0.1 * x[:, 1] ** 2, 2, "high", 4.0, _curved(-0.2, 4.0)),
    Case(
        "curved towards the origin in 12 dimensions",
        lambda x, _: x[:, 0] + 0.05 * (x[:, 1:] ** 2).sum(axis=1),
        12,
        "high",
        4.0,
        _paraboloid(-0.1, 4.0, 11),
    ),
    Case(
        "curved much in 12 dimensions",
        lambda x, _: x[:, 0] + 0.1 * (x[:, 1:] ** 2).sum(axis=1),
        12,
        "high",
        5.0,
        _paraboloid(-0.2, 5.0, 11),
    ),
    Case(
        "curved in 60 dimensions",
        lambda x, _: x[:, 0] + 0.02 * (x[:, 1:] ** 2).sum(axis=1),
        60,
        "high",
        5.5,
        _paraboloid(-0.04, 5.5, 59),
    ),
    Case("curved away", lambda x, _: x[:, 0] - 0.5 * x[:, 1] ** 2, 2, "high", 4.0, _curved(1.0, 4.0)),
    Case(
        "the limit inside the mean",
        lambda x, _: x[:, 0] + 0.1 * x[:, 1],
        2,
        "high",
        -0.8,
        norm.cdf(0.8 / math.hypot(1, 0.1)),
    ),
    Case("almost all fail", lambda x, _: x[:, 0] + 0.1 * x[:, 1], 2, "high", -4.0, norm.cdf(4.0 / math.hypot(1, 0.1))),
    Case(
        "frequent",
        lambda x, _: x[:, 0] + x[:, 1] ** 2,
        2,
        "high",
        3.0,
        quad(lambda y: norm.pdf(y) * norm.sf(3.0 - y * y), -9, 9, limit=200)[0],
    ),
    Case(
        "a jam",
        lambda x, _: np.where(x[:, 0] > 3.6, np.nan, x[:, 1]),
        6,
        "low",
        -4.5,
        norm.sf(3.6) + norm.cdf(3.6) * norm.sf(4.5),
    ),
    Case(
        "a jam alone",
        lambda x, _: np.where(x[:, 0] - x[:, 1] > 5.5, np.nan, 0.1 * x[:, 2]),
        4,
        "low",
        -2.0,
        norm.sf(5.5 / math.sqrt(2)),
        methods=("importance",),
    ),
    Case("beyond bounded laws", lambda x, _: x[:, 0] + x[:, 1], [Uniform(-1.0, 1.0)] * 2, "high", 2.5, 0.0),
    Case(
        "at the end of bounded laws",
        lambda x, _: x[:, 0] + x[:, 1],
        [Uniform(-1.0, 1.0)] * 2,
        "high",
        1.99,
        0.01**2 / 8,
    ),
    Case("flat", lambda x, _: np.full(len(x), 3.0), 2, "high", 4.0, 0.0),
    Case("flat, and out", lambda x, _: np.full(len(x), 5.0), 2, "high", 4.0, 1.0),
    Case(
        "a fixed direction",
        lambda x, a: x[:, 0] + 2.0 * np.cos(a) + 0.3 * x[:, 1],
        2,
        "high",
        6.0,
        averaged(lambda a: norm.sf((6.0 - 2 * math.cos(a)) / math.hypot(1, 0.3))),
        turns=True,
    ),
    Case(
        "a strong fixed direction",
        lambda x, a: x[:, 0] + 10.0 * np.cos(a),
        1,
        "high",
        14.0,
        averaged(lambda a: norm.sf(14.0 - 10 * math.cos(a))),
        turns=True,
    ),
    Case(
        "few positions fail",
        lambda x, a: x[:, 0] + 3.0 * np.exp(-((a - 2.0) ** 2) / 0.02),
        1,
        "high",
        6.5,
        averaged(lambda a: norm.sf(6.5 - 3 * math.exp(-((a - 2.0) ** 2) / 0.02))),
        turns=True,
    ),
    Case(
        "a random direction",
        lambda x, a: x[:, 0] * np.cos(7 * a) + x[:, 1] * np.sin(7 * a) + 0.5 * x[:, 2],
        3,
        "low",
        -5.0,
        norm.sf(5.0 / math.sqrt(1.25)),
        turns=True,
    ),
    Case(
        "two of random directions",
        lambda x, a: np.abs(x[:, 0] * np.cos(7 * a) + x[:, 1] * np.sin(7 * a)) + 0.1 * x[:, 2],
        3,
        "high",
        4.5,
        2 * norm.sf(4.5 / math.hypot(1, 0.1)),
        turns=True,
    ),
)


def _across(of: Callable[[float], float], *kinks: float) -> float:
    """The mean of a function of a standard normal, by quadrature."""
    found: float = quad(lambda y: norm.pdf(y) * of(y), -12, 12, points=[0.0, *kinks], limit=1000)[0]
    return found


def _log_normal(z: Array, mean: float, sigma: float) -> Array:
    width = math.sqrt(math.log(1 + (sigma / mean) ** 2))
    return np.asarray(np.exp(math.log(mean) - width**2 / 2 + width * z))


def _frame(x: Array, _: Array) -> Array:
    strengths = [_log_normal(x[:, k], 120.0, 12.0) for k in range(4)]
    loads = [_log_normal(x[:, 4], 50.0, 10.0), _log_normal(x[:, 5], 40.0, 8.0)]
    return np.asarray(strengths[0] + 2 * strengths[1] + 2 * strengths[2] + strengths[3] - 5 * (loads[0] + loads[1]))


def _three_regions(x: Array, _: Array) -> Array:
    a, b = x.T
    first = np.maximum(-(a**2) + b**3 + 3, 2 - a - 8 * b)
    return np.asarray(np.minimum(first, (a + 3) ** 2 + (b + 3) ** 2 - 4))


def _misleading(x: Array, _: Array) -> Array:
    a, b = x.T
    first, other = np.where(a > 3.5, 4 - a, 0.85 - 0.1 * a), np.where(b <= 2, 2.3 - b, 0.5 - 0.1 * b)
    return np.asarray(np.minimum(first, other))


def _four_branches(x: Array, _: Array) -> Array:
    a, b = x.T
    bent, along, across = 3 + 0.1 * (a - b) ** 2, (a + b) / math.sqrt(2), a - b
    branches = [bent - along, bent + along, across + 7 / math.sqrt(2), 7 / math.sqrt(2) - across]
    return np.asarray(np.min(branches, axis=0))


def _product(x: Array, _: Array) -> Array:
    return np.asarray((78064.4 + 11709.7 * x[:, 0]) * (0.0104 + 0.00156 * x[:, 1]) - 146.14)


OTBENCHMARK = (
    Case("RP8", _frame, 6, "low", 0.0, 7.89e-4),
    Case(
        "RP22",
        lambda x, _: 2.5 - (x[:, 0] + x[:, 1]) / math.sqrt(2) + 0.1 * (x[:, 0] - x[:, 1]) ** 2,
        2,
        "low",
        0.0,
        _curved(0.4, 2.5),
    ),
    Case(
        "RP24",
        lambda x, _: 2.5 - 0.2357 * 3 * (x[:, 0] - x[:, 1]) + 0.00463 * (3 * (x[:, 0] + x[:, 1])) ** 4,
        2,
        "low",
        0.0,
        _across(lambda t: norm.sf((2.5 + 0.00463 * 324 * t**4) / (0.2357 * 3 * math.sqrt(2)))),
    ),
    Case(
        "RP28",
        _product,
        2,
        "low",
        0.0,
        _across(lambda y: norm.cdf((146.14 / (0.0104 + 0.00156 * y) - 78064.4) / 11709.7) if y > -6.6 else 0.0),
    ),
    Case(
        "RP31",
        lambda x, _: 2 - x[:, 1] + 256 * x[:, 0] ** 4,
        2,
        "low",
        0.0,
        _across(lambda a: norm.sf(2 + 256 * a**4), -0.2, 0.2),
    ),
    Case(
        "RP33",
        lambda x, _: np.minimum(3 * math.sqrt(3) - x.sum(axis=1), 3 - x[:, 2]),
        3,
        "low",
        0.0,
        _across(lambda c: 1.0 if c > 3 else norm.sf((3 * math.sqrt(3) - c) / math.sqrt(2)), 3.0),
    ),
    Case(
        "RP53",
        lambda x, _: np.sin(2.5 * (1.5 + x[:, 0])) + 2 - ((1.5 + x[:, 0]) ** 2 + 4) * (1.5 + x[:, 1]) / 20,
        2,
        "low",
        0.0,
        _across(lambda a: norm.sf(20 * (math.sin(2.5 * (1.5 + a)) + 2) / ((1.5 + a) ** 2 + 4) - 1.5)),
    ),
    Case("RP57", _three_regions, 2, "low", 0.0, 2.822e-2),
    Case(
        "RP75", lambda x, _: 3 - x[:, 0] * x[:, 1], 2, "low", 0.0, _across(lambda a: norm.sf(3 / abs(a)) if a else 0.0)
    ),
    Case("RP107", lambda x, _: 5 - x.sum(axis=1) / math.sqrt(10), 10, "low", 0.0, norm.sf(5)),
    Case("RP110", _misleading, 2, "low", 0.0, norm.sf(4) + norm.cdf(4) * norm.sf(5)),
    Case("four branches", _four_branches, 2, "low", 0.0, 2.2225e-3),
)
"""Limit states of otbenchmark (Fekhari and others 2021) by their numbers; RP8, RP57 and four branches by 10^7 draws."""
