"""Both methods of a measure, and their difference, on the regressors of the measure."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates.linear_fit import LinearFit
from tol3d.study.effects.regressors import Regressed, regressor_set
from tol3d.study.system.measure import Measure
from tol3d.study.system.system import Theory
from tol3d.study.tallies.tally import Disagreement, MeasureTally
from tol3d.study.trials.simulation import Simulation

LEAST_OWN = 1e-3  # of the measure's sigma; effects below it count as that, or rounding errors would be compared


@dataclass(frozen=True, eq=False)
class MethodFits:
    """Both methods and their difference on a measure's regressors, all its trials.

    Args:
        regressed: their regressors.
        disagreement: of the methods.
        difference, analytic, geometric: the fits.
        sigma: of the measure, the larger of both methods'.
        magnitude: the largest |value| by the stack-up.
        own: effect of each contributor (contributors,), a standard deviation, the larger of both methods'.

    Both are of an extreme over positions at least what they are at one of them: what chooses another position changes
    by that what a contributor does.
    """

    regressed: Regressed
    disagreement: Disagreement
    difference: LinearFit
    analytic: LinearFit
    geometric: LinearFit
    sigma: float
    magnitude: float
    own: Array

    @classmethod
    def of(cls, simulation: Simulation, measure: Measure, tally: MeasureTally) -> "MethodFits | None":
        """None if there are too few trials."""
        if tally.disagreement is None or tally.geometric_regressors is None:
            return None
        regressed = regressor_set(simulation, measure).of(measure)
        methods = (tally.analytic_regressors, tally.geometric_regressors)
        fits = [LinearFit.of(sums, regressed.parts) for sums in (tally.disagreement.sums, *methods)]
        difference, analytic, geometric = fits
        if difference is None or analytic is None or geometric is None:
            return None
        alone = _effects_at_one_position(simulation.system, measure)
        sigma = max(*(method.target_sigma for method in methods), math.hypot(*alone.values()))
        least = np.maximum([alone.get(name, 0.0) for name in regressed.names], LEAST_OWN * sigma)
        own = np.maximum(np.maximum(analytic.effects, geometric.effects), least)
        ends = tally.analytic.moments
        magnitude = max(-ends.minimum, ends.maximum)
        return cls(regressed, tally.disagreement, difference, analytic, geometric, sigma, magnitude, own)


def _effects_at_one_position(system: Theory, measure: Measure) -> Mapping[str, float]:
    """Standard deviations by the stack-up, at a random position, of a measure that takes an extreme; else none."""
    form = system.reference_form(measure) if measure.take != "value" else None
    shares = form.shares if form else ()
    return {share.name: math.sqrt(max(share.variance, 0.0)) * measure.per_internal for share in shares}
