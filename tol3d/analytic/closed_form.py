"""Mean, standard deviation and variance shares of a measure without drawing anything.

The terms of the stack-up are independent, so means and variances add. Deviations with a direction
count by the mean square of their length; tilts by numerical integration of their one-sided loss.
Offsets of fixed direction that turn together are the exception: a random position turns them alike,
so they vary together, and each takes half of their covariance.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from tol3d.analytic.backlash import per_normal_backlash, stack_of
from tol3d.analytic.stack import Stack, Term
from tol3d.gears import GearPair
from tol3d.model import Measure, Model, Planar, Positions

TILT_NODES = 2000  # midpoint rule in u, a plane; its error on |x| of a normal is under 1e-6 of sigma


@dataclass(frozen=True)
class Share:
    """A contributor's part in a measure.

    Args:
        name: the contributor's.
        coefficient: change of the measure per deviation, internal units (mm, rad, K).
        mean, variance: its part of the measure's mean [mm or rad] and variance.
    """

    name: str
    coefficient: float
    mean: float
    variance: float


@dataclass(frozen=True)
class ClosedForm:
    """Moments of a measure by the stack-up [mm or rad]."""

    nominal: float
    mean: float
    sigma: float
    shares: tuple[Share, ...]

    def percent(self, name: str) -> float:
        """Share of the variance [%] of a contributor; 0 when nothing varies."""
        total = sum(share.variance for share in self.shares)
        own = sum(share.variance for share in self.shares if share.name == name)
        return 100.0 * own / total if total > 0.0 else 0.0


def closed_form(model: Model, measure: Measure) -> ClosedForm | None:
    """Closed form of a measure read at one position; None for extremes over a turn, which have none here."""
    if measure.take != "value":
        return None
    stack = stack_of(model, model.mesh(measure.kind.mesh), measure.kind.reading)
    factor = per_normal_backlash(model, measure.kind)
    linear = [_linear_share(term, stack, measure.positions, factor) for term in stack.terms if not term.one_sided]
    if measure.positions.over == "random":
        linear = _with_covariances(linear, [term for term in stack.terms if not term.one_sided], stack)
    tilts = _tilt_shares([term for term in stack.terms if term.one_sided], factor)
    if tilts is None:
        return None
    by_name = {share.name: share for share in (*linear, *tilts)}
    shares = tuple(by_name[c.name] for c in model.contributors if c.name in by_name)
    nominal = stack.nominal * factor
    return ClosedForm(
        nominal=nominal,
        mean=nominal + sum(share.mean for share in shares),
        sigma=math.sqrt(sum(share.variance for share in shares)),
        shares=shares,
    )


def reference_form(model: Model, measure: Measure) -> ClosedForm | None:
    """Closed form of the measure, or of its value at a random position where it takes an extreme."""
    at_random = replace(measure, positions=Positions("random", 1, 1), take="value")
    return closed_form(model, measure) or closed_form(model, at_random)


def _linear_share(term: Term, stack: Stack[GearPair], positions: Positions, factor: float) -> Share:
    law, coefficient = term.contributor.distribution, term.coefficient * factor
    draw = term.contributor.draw
    if not isinstance(draw, Planar):
        mean, variance = coefficient * law.mean, coefficient**2 * law.variance
    elif draw.direction is None or (term.turns and positions.over == "random"):
        # a cosine of a uniform angle: mean 0, mean square 1/2
        mean, variance = 0.0, coefficient**2 * (law.variance + law.mean**2) / 2
    else:
        turn = 0.0
        if term.turns:
            driver = np.array([positions.angle])
            turn = float((driver if term.turns == "driver" else stack.pair.driven_angle(driver))[0])
        coefficient *= math.cos(term.along - turn - draw.direction)
        mean, variance = coefficient * law.mean, coefficient**2 * law.variance
    return Share(term.contributor.name, coefficient, mean, variance)


def _with_covariances(shares: list[Share], terms: list[Term], stack: Stack[GearPair]) -> list[Share]:
    """Shares with the covariances of offsets that turn together at a random position."""
    added = [0.0] * len(shares)
    for i, first in enumerate(terms):
        for j, second in enumerate(terms):
            if i != j:
                lengths = first.contributor.distribution.mean * second.contributor.distribution.mean
                added[i] += shares[i].coefficient * shares[j].coefficient * lengths * _turn_alike(first, second, stack)
    return [replace(share, variance=share.variance + own) for share, own in zip(shares, added, strict=True)]


def _turn_alike(first: Term, second: Term, stack: Stack[GearPair]) -> float:
    """Mean over the long period of the product of the cosines with which two turning offsets act."""
    draws = (first.contributor.draw, second.contributor.draw)
    if not (first.turns and second.turns):
        return 0.0
    phases = [
        term.along - draw.direction
        for term, draw in zip((first, second), draws, strict=True)
        if isinstance(draw, Planar) and draw.direction is not None
    ]
    if len(phases) < 2:
        return 0.0
    if first.turns == second.turns:
        return math.cos(phases[0] - phases[1]) / 2
    if stack.pair.pinion.teeth != stack.pair.wheel.teeth:
        return 0.0
    start = float(stack.pair.driven_angle(np.zeros(1))[0])  # the wheel turns against the pinion from there
    return math.cos(phases[0] + phases[1] - start) / 2


def _tilt_shares(terms: list[Term], factor: float) -> list[Share] | None:
    """Shares of -max(|in plane|, |out of plane|); None with several tilts in one plane.

    The variance is split by the conditional means (first-order Sobol'), the rest in equal parts.
    """
    planes = [term.in_plane for term in terms]
    if len(set(planes)) < len(planes):
        return None
    if not terms:
        return []
    nodes = (np.arange(TILT_NODES) + 0.5) / TILT_NODES
    losses = [np.abs(factor * t.coefficient * t.contributor.distribution.ppf(nodes)) for t in terms]
    loss = -losses[0] if len(losses) == 1 else -np.maximum(losses[0][:, None], losses[1][None, :])
    mean, variance = float(loss.mean()), float(loss.var())
    own = [variance] if len(losses) == 1 else [float(loss.mean(axis=1).var()), float(loss.mean(axis=0).var())]
    rest = (variance - sum(own)) / len(own)
    return [
        Share(t.contributor.name, -abs(t.coefficient) * factor, mean / len(terms), v + rest)
        for t, v in zip(terms, own, strict=True)
    ]
