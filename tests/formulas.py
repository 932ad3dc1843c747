"""Responses that are formulas of their contributors, for analyses whose answers are known in closed form."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.analyses.response import Response, response_of
from tol3d.statistics.distributions.normal import Normal
from tol3d.study.system.copula import Block, Copula
from tol3d.study.system.draw import Draw, Scalar
from tol3d.study.system.plain import PlainContributor, PlainMeasure, PlainSystem
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study

Array = NDArray[np.float64]
Value = Callable[[Array], Array]


@dataclass(frozen=True)
class Formula(PlainSystem):
    """A measure that is a function of deviations (n, components)."""

    value: Value = len  # type: ignore[assignment]

    def analytic(self, trials: Any, measure: Any) -> Array:
        return self.value(trials.deviations)

    def exact(self, trials: Any, measure: Any) -> Array:
        return self.value(trials.deviations)


def formula(
    value: Value,
    draws: Sequence[Draw] | int,
    *,
    low: float | None = None,
    high: float | None = None,
    blocks: Sequence[Block] = (),
) -> Response:
    """Formula of contributors x0, x1 …, standard normals where only their number is given; limits of the measure."""
    given = [Scalar(Normal(0.0, 1.0))] * draws if isinstance(draws, int) else draws
    contributors = tuple(PlainContributor(f"x{k}", "x", own, "1", 1.0) for k, own in enumerate(given))
    measure = PlainMeasure("value", "value", low, high, unit="1", per_internal=1.0)
    system = Formula("formula", contributors, (measure,), value)
    return response_of(Simulation(system, Study(trials=1000), copula=Copula(tuple(blocks))))
