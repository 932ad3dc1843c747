"""Expected accuracy of a rig: half-widths of 95 % intervals from the design matrix, before anything is measured.

Noise of a row is that of both encoders, sigma^2 (1 + (z1/z2)^2), with steps q of the encoders as q^2/12 more of each,
which holds where the noise is not much smaller than the steps, or the rows do not fall in time with them.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tol3d.apps.records.cautions import LARGEST_CONDITION, condition_of
from tol3d.apps.records.identification import told_apart_teeth, told_apart_twice
from tol3d.apps.records.pair import TURN, RigPair, Side, Specimen, driven_angle
from tol3d.apps.records.prediction import BacklashModel, Figure, length_and_phase, quantile_of
from tol3d.apps.records.rig import Rig
from tol3d.apps.records.terms import ECCENTRIC, ENCODERS, Points, Terms, columns, difference_columns
from tol3d.numerics.arrays import Array

MOST_POSITIONS = 500  # a turn of the driver at which columns are evaluated; more rows are weights of these
SIDES: tuple[Side, ...] = ("drive", "back")


@dataclass(frozen=True)
class RigPlan:
    """Expected findings of a rig with a number of turns.

    Args:
        turns: of the driver on each side.
        rows: of both sides together.
        condition: number of the columns once per turn of either gear and the constant.
        figures: e1, theta1, e2, theta2, jc, j0, the ends of the backlash of the eccentricities alone, their places and
            the encoders' parts once per turn, with half-widths [mm, rad]; none where turns do not suffice.
    """

    turns: float
    rows: int
    condition: float
    figures: Mapping[str, Figure]

    @property
    def suffices(self) -> bool:
        """True if driver and driven gear can be told apart."""
        return self.condition <= LARGEST_CONDITION


def plan_rig(specimen: Specimen, rig: Rig, turns: Sequence[float], *, drift: bool = False) -> tuple[RigPlan, ...]:
    """Plans for several numbers of turns.

    Args:
        specimen: to be measured, as far as it is known; phases matter little.
        rig: for the measurement, apart from its turns.
        turns: of the driver.
        drift: whether a linear drift of each side would be fitted along.
    """
    return tuple(_plan(specimen, rig, turn, drift=drift) for turn in turns)


def row_variance(pair: RigPair, rig: Rig) -> float:
    """Variance of phi2 - phi1 z1/z2 in one row [rad^2]."""
    return (rig.noise**2 + rig.resolution**2 / 12) * (1 + pair.rate**2)


def _plan(specimen: Specimen, rig: Rig, turns: float, *, drift: bool) -> RigPlan:
    pair, rows = specimen.pair, round(turns * rig.samples) * rig.repeats
    phi1 = np.linspace(0.0, TURN * turns, max(2, round(turns * min(rig.samples, MOST_POSITIONS))), endpoint=False)
    condition = condition_of(pair, phi1, np.ones_like(phi1))
    if condition > LARGEST_CONDITION:
        return RigPlan(turns, 2 * rows, condition, {})
    sides = [(phi1, np.ones_like(phi1))]
    twice, teeth = told_apart_twice(pair, sides), told_apart_teeth(pair, sides)
    terms = Terms(twice=twice, drift=drift, teeth=teeth)
    normal = sum(_normal(specimen, terms, side, phi1) for side in SIDES) * (rows / len(phi1))
    covariance = np.asarray(np.linalg.inv(normal) * row_variance(pair, rig), dtype=np.float64)
    return RigPlan(turns, 2 * rows, condition, _figures(specimen, terms, covariance, 2 * rows))


def _normal(specimen: Specimen, terms: Terms, side: Side, phi1: Array) -> Array:
    """Normal matrix of one side, one row at each position."""
    travel = phi1 - phi1.mean()
    phi2 = driven_angle(specimen, phi1, side)
    own = columns(specimen.pair, terms, side, Points(phi1, phi2, travel, np.zeros_like(phi1)))
    return np.asarray(own.T @ own)


def _figures(specimen: Specimen, terms: Terms, covariance: Array, rows: int) -> Mapping[str, Figure]:
    quantile = quantile_of(rows - len(terms.names))
    index = terms.index((*ECCENTRIC, "constant part"))
    own = covariance[np.ix_(index, index)]
    x1, y1 = specimen.e1 * math.cos(specimen.theta1), specimen.e1 * math.sin(specimen.theta1)
    x2, y2 = specimen.e2 * math.cos(specimen.theta2), specimen.e2 * math.sin(specimen.theta2)
    vector = np.array([x1, y1, x2, y2])
    model = BacklashModel(specimen.pair, vector, 0.0, specimen.constant_part, own, quantile)
    found = dict(zip(("e1", "theta1"), length_and_phase(vector[:2], own[:2, :2], quantile), strict=True))
    found |= zip(("e2", "theta2"), length_and_phase(vector[2:], own[2:4, 2:4], quantile), strict=True)
    found["jc"] = Figure(model.constant_part, model.constant_half_width)
    start = np.zeros(1)
    rates = difference_columns(specimen.pair, terms, start, driven_angle(specimen, start, "drive"))[0]
    found["j0"] = Figure(float(model.backlash(start)[0]), quantile * math.sqrt(float(rates @ covariance @ rates)))
    for name, sense in (("jmin eccentric", -1), ("jmax eccentric", +1)):
        end = model.extreme(sense)
        found |= {name: end.backlash, f"{name} at": end.place}
    parts = terms.index(ENCODERS)
    for name, part, gain in (("encoder 1", parts[:2], 1 / specimen.pair.rate), ("encoder 2", parts[2:], 1.0)):
        anywhere, _ = length_and_phase(np.zeros(2), covariance[np.ix_(part, part)], quantile)
        found[name] = Figure(0.0, gain * anywhere.half_width)
    return found
