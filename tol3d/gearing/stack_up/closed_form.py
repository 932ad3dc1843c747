"""Mean, standard deviation and variance shares of a measure without draws.

Contributors are independent, so means and variances add; the effects of one in several meshes are added first.
Deviations with a direction count by the mean square of their length; tilts by numerical integration of their one-sided
loss, together with all else where contributors do more than tilt one mesh (`leaning.py`); of helical gears the loss is
that of a mean position, whose own share of the variance is neglected. Offsets of fixed direction
that turn together are the exception: a random position turns them alike, so they vary together, and each takes half of
their covariance.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from tol3d.gearing.links import LinkSum
from tol3d.gearing.model import (
    AxialPlay,
    Backlash,
    Contributor,
    LostMotion,
    Measure,
    Model,
    Planar,
    Positions,
    TransmissionError,
)
from tol3d.gearing.model.measure import Slide, at_one_position
from tol3d.gearing.stack_up.leaning import leaning_groups, leaning_shares
from tol3d.gearing.stack_up.measures import per_normal_backlash, stack_of
from tol3d.gearing.stack_up.stack import Stack
from tol3d.gearing.stack_up.term import Term
from tol3d.gears import GearPair
from tol3d.statistics.distributions import Distribution
from tol3d.study.system.closed_form import ClosedForm, Share

TILT_NODES = 2000  # midpoint rule in u, a plane; its error on |x| of a normal is under 1e-6 of sigma


def closed_form(model: Model, measure: Measure) -> ClosedForm | None:
    """Closed form of a measure read at one position.

    None for extremes over a turn, parallel load paths, links whose theory is no sum, single flanks that deviate, and
    clearances that let shafts slide by more than a share of them.
    """
    sums = _link_sums(model, measure)
    slid = sliding_coefficients(model, measure)
    if measure.take != "value" or not measure.kind.adds_up or sums is None or slid is None:
        return None
    parts = tuple(_parts(model, measure))
    if any(part.stack.teeth for part in parts):
        return None
    terms = [term for part in parts for term in part.terms]
    groups = leaning_groups([part.stack for part in parts])
    alike = all(part.stack.both_sides_alike for part in parts)
    straight = not any(part.stack.pair.pinion.twist for part in parts)
    of_tilts = {group: _plain_tilts(group, terms, alike) if straight else None for group in groups}
    plain = {group: tilts for group, tilts in of_tilts.items() if tilts is not None}
    leaning = [group for group in groups if group not in plain]
    names = frozenset(contributor.name for group in leaning for contributor in group)
    linear = [term for term in terms if term.term.tilts is None and term.term.contributor.name not in names]
    plainly_slid = {name: own for name, own in slid.items() if name not in names}
    own = [own for contributor in model.contributors if (own := _linear(contributor, linear, sums, plainly_slid))]
    shares = _with_covariances(own) if measure.positions.over == "random" else [each.share for each in own]
    shares += [share for tilts in plain.values() for share in tilts]
    shares += [Share(term.term.contributor.name, 0.0, 0.0, 0.0) for term in terms if _plane(term) == "none"]
    for group in leaning:
        shares += leaning_shares([(part.factor, part.stack) for part in parts], group, slid)
    nominal = _nominal(model, measure, sums)
    together = tuple(_merged(model, shares))
    return ClosedForm(
        nominal=nominal,
        mean=nominal + sum(share.mean for share in together),
        sigma=_root(sum(share.variance for share in together)),
        shares=together,
        leaning=names,
    )


def reference_form(model: Model, measure: Measure) -> ClosedForm | None:
    """Closed form of the measure, or of its value at a random position where it takes an extreme or a curve.

    None of a transmission error, which has no value at one position.
    """
    if isinstance(measure.kind, TransmissionError):
        return None
    at_random = replace(measure, kind=at_one_position(measure.kind), positions=Positions("random", 1, 1), take="value")
    return closed_form(model, measure) or closed_form(model, at_random)


@dataclass(frozen=True)
class _ReadTerm:
    """A term of the stack-up of one mesh, as a measure reads it.

    Args:
        mesh: the mesh.
        term: of the mesh's normal backlash.
        factor: change of the measure by that [1 or rad/mm, ...].
        phase: azimuth of largest opening where the deviation is counted [rad], the first shaft at 0 or the mesh
            where it is read.
        rate: turns by which it goes back per turn of the first shaft; 0 at fixed positions and for what rests.
    """

    mesh: str
    term: Term
    factor: float
    phase: float
    rate: Fraction

    @property
    def amplitude(self) -> float:
        """Change of the measure per length in the worst direction."""
        return self.factor * self.term.coefficient


@dataclass(frozen=True)
class _Part:
    """A mesh that a measure reads."""

    model: Model
    measure: Measure
    stack: Stack[GearPair]
    factor: float

    @property
    def terms(self) -> Iterator[_ReadTerm]:
        """Its terms."""
        for term in self.stack.terms:
            turn, rate = self._turn_of(term)
            phase = term.along - term.sense * turn
            yield _ReadTerm(self.stack.mesh.name, term, self.factor, phase, int(term.sense) * rate)

    def _turn_of(self, term: Term) -> tuple[float, Fraction]:
        """Angle of the gear with which a term turns [rad], and its rate."""
        if term.turns is None:
            return 0.0, Fraction(0)
        mesh = self.stack.mesh
        turning = self.model.layout.mesh_turn[mesh.name]
        angles = self.model.driver_angles(self.measure, mesh.name)
        angle, rate = (turning.offset, turning.rate) if angles is None else (angles[0], Fraction(0))
        if term.turns == "driver":
            return angle, rate
        return float(mesh.pair.driven_angle(np.array([angle]))[0]), rate * mesh.rate


def factored_stacks(model: Model, measure: Measure) -> list[tuple[float, Stack[GearPair]]]:
    """The stack-up of each mesh that a measure reads, with the change of the measure by its normal backlash."""
    return [(part.factor, part.stack) for part in _parts(model, measure)]


def _lever(measure: Measure) -> float:
    """Factor from the play of its backlashes to the measure."""
    kind = measure.kind
    return kind.tip.lever if isinstance(kind, LostMotion) and kind.tip else 1.0


def _parts(model: Model, measure: Measure) -> Iterator[_Part]:
    for factor, backlash in measure.kind.backlashes:
        at = model.driver_angles(measure, backlash.mesh)
        stack = stack_of(model, model.mesh(backlash.mesh), backlash.reading, at)
        yield _Part(model, measure, stack, _lever(measure) * factor * per_normal_backlash(model, backlash))


Wave = tuple[float, float, Fraction]
"""Amplitude per length, phase [rad] and turns per turn of the first shaft; 0 of what rests."""

_Sums = Sequence[tuple[float, LinkSum]]
"""The links of a measure that are no meshes, with the factor from their play to the measure."""


def _link_sums(model: Model, measure: Measure) -> _Sums | None:
    """None where one of them has none."""
    found = []
    for factor, name in measure.kind.links:
        own = model.link(name).sum_of(
            [contributor for contributor in model.contributors if contributor.effect.acts_on(name)]
        )
        if own is None:
            return None
        found.append((_lever(measure) * factor, own))
    return found


def _nominal(model: Model, measure: Measure, sums: _Sums) -> float:
    of_links = sum(factor * own.nominal for factor, own in sums)
    return of_links + sum(part.factor * part.stack.nominal for part in _parts(model, measure))


@dataclass(frozen=True)
class _Linear:
    """A contributor's linear part: its share, and the waves in which a fixed direction acts as the gears turn.

    A wave is its mean amplitude, phase [rad] and rate.
    """

    share: Share
    waves: tuple[Wave, ...] = ()


def _of_link(factor: float, rates: Sequence[float]) -> Wave:
    """Effect of a deviation through a link whose play is the same at every position."""
    if len(rates) == 1:
        return factor * rates[0], 0.0, Fraction(0)
    x, y = rates
    return factor * math.hypot(x, y), math.atan2(y, x), Fraction(0)


Slid = Mapping[str, float]
"""Change of a measure per deviation by the shafts that slide, by contributor."""


def sliding_coefficients(model: Model, measure: Measure) -> Slid | None:
    """None where the play of a shaft is not in proportion, or that to the length of a deviation with a direction."""
    found: dict[str, float] = {}
    for factor, slide in _slides(measure):
        for contributor in model.contributors:
            for effect in contributor.effect.singles:
                if isinstance(effect, AxialPlay) and effect.slides(slide.shaft):
                    if isinstance(contributor.draw, Planar) or effect.coefficient is None:
                        return None
                    own = factor * slide.factor * effect.coefficient
                    found[contributor.name] = found.get(contributor.name, 0.0) + own
    return found


def _slides(measure: Measure) -> Iterator[tuple[float, Slide]]:
    """Shafts that slide, each with the factor from what it turns to the measure."""
    kind = measure.kind
    if isinstance(kind, Backlash):
        yield from ((1.0, slide) for slide in kind.slides)
    elif isinstance(kind, LostMotion):
        for stage in kind.stages:
            yield from ((_lever(measure) * stage.factor, slide) for slide in stage.slides)


def _linear(contributor: Contributor, terms: Sequence[_ReadTerm], sums: _Sums, slid: Slid) -> _Linear | None:
    own = [(term.amplitude, term.phase, term.rate) for term in terms if term.term.contributor is contributor]
    own += [_of_link(factor, one.rates[contributor.name]) for factor, one in sums if contributor.name in one.rates]
    own += [(slid[contributor.name], 0.0, Fraction(0))] if contributor.name in slid else []
    if not own:
        return None
    law, draw = contributor.distribution, contributor.draw
    if not isinstance(draw, Planar):
        coefficient = sum(amplitude for amplitude, _, _ in own)
        return _Linear(Share(contributor.name, coefficient, coefficient * law.mean, coefficient**2 * law.variance))
    square = law.variance + law.mean**2
    if draw.direction is None:
        worst = _root(sum(a[0] * b[0] * _alike(a, b) for a in own for b in own))
        return _Linear(Share(contributor.name, worst, 0.0, worst**2 * square / 2))
    waves = tuple((amplitude, phase - draw.direction, rate) for amplitude, phase, rate in own)
    resting = sum(amplitude * math.cos(phase) for amplitude, phase, rate in waves if not rate)
    turning = tuple(wave for wave in waves if wave[2])
    squares = sum(a * b * _product(p, q, v, w) for a, p, v in turning for b, q, w in turning)
    variance = resting**2 * law.variance + squares * square
    coefficient = resting if not turning else _root(resting**2 + 2 * squares)
    share = Share(contributor.name, coefficient, resting * law.mean, variance)
    return _Linear(share, tuple((amplitude * law.mean, phase, rate) for amplitude, phase, rate in turning))


def _root(square: float) -> float:
    """Square root of a sum whose terms may cancel to just below 0, as for an idler between two gears facing it."""
    return math.sqrt(max(square, 0.0))


def _alike(first: Wave, second: Wave) -> float:
    """Mean over the positions of the cosine between the worst directions of two terms."""
    return math.cos(first[1] - second[1]) if first[2] == second[2] else 0.0


def _product(first: float, second: float, first_rate: Fraction, second_rate: Fraction) -> float:
    """Mean over the positions of the product of two cosines that go on with the turns."""
    same = math.cos(first - second) / 2 if first_rate == second_rate else 0.0
    opposite = math.cos(first + second) / 2 if first_rate == -second_rate else 0.0
    return same + opposite


def _with_covariances(each: Sequence[_Linear]) -> list[Share]:
    """Shares with the covariances of offsets that turn together at a random position."""
    laws = {linear.share.name: linear for linear in each}
    shares = []
    for name, linear in laws.items():
        others = [other for known, other in laws.items() if known != name]
        added = sum(
            a * b * _product(p, q, v, w) for other in others for a, p, v in linear.waves for b, q, w in other.waves
        )
        shares.append(replace(linear.share, variance=linear.share.variance + added))
    return shares


def _merged(model: Model, shares: Sequence[Share]) -> Iterator[Share]:
    """One share per contributor, in the model's order: its tilts and other effects added up."""
    for contributor in model.contributors:
        own = [share for share in shares if share.name == contributor.name]
        if own:
            yield Share(
                contributor.name,
                sum(share.coefficient for share in own),
                sum(share.mean for share in own),
                sum(share.variance for share in own),
            )


def _plain_tilts(group: Sequence[Contributor], terms: Sequence[_ReadTerm], alike: bool) -> list[Share] | None:
    """Shares of -max(|in plane|, |out of plane|) for a mesh whose tilts have no other effect; None for other groups.

    Of two tilts only where both flank sides are read alike: else the loss is another.

    The variance is split by the conditional means (first-order Sobol'), the rest in equal parts.
    """
    own = [term for term in terms if term.term.contributor in group]
    only_tilts = len(own) == len(group) and all(term.term.tilts for term in own)
    laws = [law for law in (term.term.contributor.distribution for term in own) if isinstance(law, Distribution)]
    if not only_tilts or len(laws) < len(own) or any(isinstance(contributor.draw, Planar) for contributor in group):
        return None
    if len(own) > 2 or (len(own) == 2 and (not alike or sorted(_plane(term) for term in own) != ["across", "in"])):
        return None
    nodes = (np.arange(TILT_NODES) + 0.5) / TILT_NODES
    losses = [np.abs(term.amplitude * law.ppf(nodes)) for term, law in zip(own, laws, strict=True)]
    loss = -losses[0] if len(losses) == 1 else -np.maximum(losses[0][:, None], losses[1][None, :])
    mean, variance = float(loss.mean()), float(loss.var())
    alone = [variance] if len(losses) == 1 else [float(loss.mean(axis=1).var()), float(loss.mean(axis=0).var())]
    rest = (variance - sum(alone)) / len(alone)
    return [
        Share(term.term.contributor.name, -abs(term.amplitude), mean / len(own), v + rest)
        for term, v in zip(own, alone, strict=True)
    ]


def _plane(term: _ReadTerm) -> str:
    """Plane in which a term tilts; none if the middle of the face is read."""
    if term.term.tilts is None:
        return "no tilt"
    in_plane, across = term.term.tilts
    if not term.term.leans:
        return "none"
    return "in" if not any(across) else "across" if not any(in_plane) else "both"
