"""Sums of normal deviations, whose sigma and tails are known in closed form."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.analyses.response import Response, response_of
from tol3d.statistics.distributions import Distribution
from tol3d.statistics.distributions.normal import Normal
from tol3d.study.system.draw import Scalar
from tol3d.study.system.plain import PlainContributor, PlainMeasure, PlainSystem
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Stack(PlainSystem):
    """Measures are weighted sums of deviations [mm]."""

    weights: Any = None

    def analytic(self, trials: Any, measure: Any) -> Array:
        return np.asarray(trials.deviations @ self.weights[measure.name])

    def exact(self, trials: Any, measure: Any) -> Array:
        return self.analytic(trials, measure)


def stack(
    slopes: Sequence[float] | Array,
    sigmas: Sequence[float] | Array,
    low: float | None = None,
    high: float | None = None,
    least: float | None = None,
    laws: Sequence[Distribution] | None = None,
) -> Response:
    """One measure "gap" in mm of deviations "x0", "x1" … in mm: slopes times normals of these sigmas."""
    drawn = laws or [Normal(0.0, sigma) for sigma in sigmas]
    contributors = tuple(
        PlainContributor(f"x{k}", "x", Scalar(law), "um", 1e-3, least=least if k == 0 else None)
        for k, law in enumerate(drawn)
    )
    measure = PlainMeasure("gap", "gap", low, high, unit="mm", per_internal=1.0)
    system = Stack("stack", contributors, (measure,), {"gap": np.array(slopes)})
    return response_of(Simulation(system, Study(trials=1000)))
