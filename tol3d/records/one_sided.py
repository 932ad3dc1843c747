"""Each side fitted alone, as if the encoders had no error of their own, beside the joint fit."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.records.exact_play import Side
from tol3d.records.fit import Fit, fitted
from tol3d.records.prediction import BacklashModel, Extreme, Figure, length_and_phase
from tol3d.records.terms import ECCENTRIC, ENCODERS, Terms

DISAGREEING = 3.0  # standard errors of the difference


@dataclass(frozen=True)
class OneSided:
    """What one side alone would say.

    Args:
        figures: e1, theta1, e2, theta2 [mm, rad].
        least, largest: the backlash over the long period that it predicts from the joint fit's at phi1 = 0.
        apart: largest difference of the four figures from the joint fit's, in standard errors of the difference.
    """

    figures: Mapping[str, Figure]
    least: Extreme
    largest: Extreme
    apart: float

    @property
    def disagrees(self) -> bool:
        """Whether it cannot be the same eccentricities."""
        return self.apart > DISAGREEING


def one_sided(side: Side, fit: Fit, model: BacklashModel) -> OneSided:
    """One side's own fit.

    Args:
        side: which.
        fit: the joint one.
        model: the joint fit's backlash.
    """
    terms = Terms((side,), encoders=False, drift=fit.terms.drift, teeth=fit.terms.teeth)
    own = fitted(fit.measured, terms, constant_part=model.constant_part)
    vector, covariance = own.of(ECCENTRIC)
    start = float(model.backlash(np.zeros(1))[0])
    full = np.zeros((5, 5))
    full[:4, :4], full[4, 4] = covariance, (float(model.half_width(np.zeros(1))[0]) / model.quantile) ** 2
    alone = replace(model, eccentric=vector, covariance=full, anchored=0.0).starting_with(start)
    figures = dict(zip(("e1", "theta1"), length_and_phase(vector[:2], covariance[:2, :2], model.quantile), strict=True))
    figures |= zip(("e2", "theta2"), length_and_phase(vector[2:], covariance[2:, 2:], model.quantile), strict=True)
    return OneSided(figures, alone.extreme(-1), alone.extreme(+1), _apart(side, fit, vector))


def _apart(side: Side, fit: Fit, alone: Array) -> float:
    """Largest difference from the joint fit in its standard errors.

    A side alone reads the encoders' part p + i q of Im((p + i q) exp(i phi)) as an eccentricity: the difference is
    r_b2 (p + i q) turned by the working angle, whatever the noise of the side; so is its covariance.
    """
    joint = fit.of(ECCENTRIC)[0]
    _, covariance = fit.of(ENCODERS)
    sense = 1.0 if side == "drive" else -1.0
    alpha, arm = fit.measured.pair.working_angle, fit.measured.pair.driven_base_radius
    found = 0.0
    for gear, angle in ((0, -sense * alpha), (2, sense * alpha)):
        turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        spread = arm**2 * turn @ covariance[gear : gear + 2, gear : gear + 2] @ turn.T
        difference = alone[gear : gear + 2] - joint[gear : gear + 2]
        length = float(np.hypot(*joint[gear : gear + 2]))
        along = joint[gear : gear + 2] / length if length > 0.0 else np.array([1.0, 0.0])
        for axis in (along, np.array([-along[1], along[0]])):
            error = math.sqrt(max(float(axis @ spread @ axis), 1e-300))
            found = max(found, abs(float(axis @ difference)) / error)
    return found
