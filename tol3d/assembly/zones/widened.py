"""Zones that a bonus widens: draws from the widened zone, and processes that it judges.

Both are what a drawing may mean: by the first a maker uses the room that a size leaves, by the second his process does
not know of it and only the inspection does.
"""

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar
from typing_extensions import override

from tol3d.assembly.model.datum_frame import Modifier
from tol3d.assembly.zones.zone import Ratio, Zone
from tol3d.assembly.zones.zone_draw import ComponentLaw, Confined, Process, ZoneDraw
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions import Distribution
from tol3d.study.system.dependent import Given
from tol3d.study.system.draw import Draw
from tol3d.study.system.normals import Group

SIZES: Final = 512  # of equal probability, over which a covariance is averaged: 1e-5 of a normal's
KEPT: Final = 512  # covariances; a zone with a bonus takes some 50 ms
SIZE_XTOL: Final = 1e-9  # mm; a support is stationary there, so its error is of order 2


@dataclass(frozen=True)
class Envelope:
    """min(form, |MMC - size|): how much form the limits of size leave (ASME Y14.5 Rule #1, ISO 14405-1 with an E).

    Args:
        low, high: limits of the size, as deviations from nominal [mm].
        inner: whether the feature is a hole.
        form: width of its tolerance of form [mm].
    """

    low: float
    high: float
    inner: bool
    form: float

    def of(self, size: Array) -> Array:
        """Largest form (trials,) [mm] at deviations of size (trials,) [mm]; none past the maximum material size."""
        return np.clip(size - self.low if self.inner else self.high - size, 0.0, self.form)

    @property
    def knee(self) -> float:
        """The size from which on the tolerance of form decides [mm]."""
        return self.low + self.form if self.inner else self.high - self.form


@dataclass(frozen=True)
class Bonus:
    """t = t0 + clip(±(size - origin), 0, most): how sizes widen a zone.

    Args:
        low, high: limits of the size, as deviations from nominal [mm].
        grows: whether larger sizes widen: of a hole at MMC and of a pin at LMC.
        of_zone: whether the width of the zone has it.
        of_orientation: whether the orientation that refines the zone has it, by a modifier of its own; never beyond
            what the width of the zone leaves.
        envelope: within which the form lies that a zone holds too; None where it takes its whole tolerance.
    """

    low: float
    high: float
    grows: bool
    of_zone: bool = True
    of_orientation: bool = False
    envelope: Envelope | None = None

    def __post_init__(self) -> None:
        if not self.low <= self.high:
            raise InputError(f"bonus: expected limits of size in order, got {self.low:g} mm to {self.high:g} mm")

    @classmethod
    def at(cls, modifier: Modifier, low: float, high: float, *, inner: bool) -> Self:
        """By a drawing's modifier.

        Args:
            modifier: maximum or least material condition.
            low, high: limits of the size, as deviations from nominal [mm].
            inner: whether the feature is a hole.
        """
        return cls(low, high, (modifier == "mmc") == inner)

    @property
    def most(self) -> float:
        """The largest bonus [mm]: the whole tolerance of size."""
        return self.high - self.low

    def within(self, low: float, high: float) -> Self:
        """The same by other limits of size [mm]."""
        envelope = None if self.envelope is None else replace(self.envelope, low=low, high=high)
        return replace(self, low=low, high=high, envelope=envelope)

    def spared(self, size: Array) -> Array:
        """Part of its tolerance (trials,) [mm] that the form leaves at deviations of size (trials,) [mm]."""
        return np.zeros(np.shape(size)) if self.envelope is None else self.envelope.form - self.envelope.of(size)

    def of(self, size: Array) -> Array:
        """Bonus (trials,) [mm] of deviations of size (trials,) [mm]; none past the size that has none."""
        room = size - self.low if self.grows else self.high - size
        return np.clip(room, 0.0, self.most)

    def widths(self, zone: Zone, size: Array) -> tuple[Array, Array | None]:
        """Width t and orientation t_o (trials,) [mm] of a zone for deviations of size (trials,) [mm].

        t_o is None where it stays as the zone has it.
        """
        own = self.of(size)
        width = zone.width + own if self.of_zone else np.full(np.shape(size), zone.width)
        width += self.spared(size)
        return width, zone.orientation + own if self.of_orientation and zone.orientation is not None else None

    def zone_at(self, zone: Zone, size: float) -> Zone:
        """A zone as one deviation of size [mm] widens it."""
        width, orientation = self.widths(zone, np.asarray(size))
        own = zone.orientation if orientation is None else float(orientation)
        return replace(zone, width=float(width), orientation=None if own is None else min(own, float(width)))

    def covariance(self, draw: Confined, size: Distribution) -> Array:
        """Covariance (components, components) [mm^2] of a draw whose zone each size widens; its mean stays.

        Displacement and size depend on each other, but are not correlated, for every zone is symmetric.

        Args:
            draw: of the zone without bonus.
            size: law of the deviation of size.
        """
        return _covariance(self, draw, size)

    def support(self, draw: Confined, gradient: Array, size: Distribution, per_size: float = 0.0) -> float:
        """The largest value of gradient · components + per_size · size, over all sizes and the zones they leave.

        It is concave in the size between the sizes at which the bonus starts and ends, so that it is greatest at one
        of them, at an end of the law of size, or where one of the spans has its only maximum.

        Args:
            draw: of the zone without bonus.
            gradient: (components,), change of the measure per mm.
            size: law of the deviation of size; its ends are those of worst cases.
            per_size: change of the measure per mm of size.
        """

        def reached(own: float) -> float:
            return self.zone_at(draw.zone, own).support(gradient) + per_size * own

        knees = (self.low, self.high) + (() if self.envelope is None else (self.envelope.knee,))
        inner = (knee for knee in knees if size.low < knee < size.high)
        places = sorted({size.low, size.high, *inner})
        found = [reached(place) for place in places]
        for start, stop in pairwise(places):
            best = minimize_scalar(
                lambda own: -reached(own), bounds=(start, stop), method="bounded", options={"xatol": SIZE_XTOL}
            )
            found.append(-float(best.fun))
        return max(found)


@dataclass(frozen=True)
class SizedBy:
    """The size that widens a zone.

    Args:
        name: of its contributor.
        law: of its deviation from nominal [mm].
        bonus: what it adds.
        of_drawing: whether the bonus counts from limits that the drawing states beside the law, not from the law's.
    """

    name: str
    law: Distribution
    bonus: Bonus
    of_drawing: bool = False

    def following(self, draw: Draw) -> Self:
        """The same where the size is drawn otherwise."""
        law = draw.distribution
        if not isinstance(law, Distribution):
            raise InputError(f"{self.name}: expected a size with a law, got {type(law).__name__}")
        if self.of_drawing:
            return replace(self, law=law)
        if law.limits is None:
            raise InputError(
                f"{self.name}: expected a law with limits, from which a bonus counts, got {type(law).__name__}"
            )
        low, high = law.limits
        return replace(self, law=law, bonus=self.bonus.within(low, high))

    @property
    def words(self) -> str:
        """Its effect on a zone."""
        bonus = f"the bonus of {self.name}" if self.bonus.of_zone or self.bonus.of_orientation else ""
        form = "" if self.bonus.envelope is None else f"the form that {self.name} leaves"
        return " and ".join(filter(None, (bonus, form)))

    def of(self, given: Given) -> Array:
        """Deviations of size (trials,) [mm]."""
        return np.asarray(given[self.name][0])


@lru_cache(maxsize=KEPT)
def _covariance(bonus: Bonus, draw: Confined, size: Distribution) -> Array:
    """See Bonus; kept, since a scene that is edited has most of its zones again."""
    sizes = size.ppf((np.arange(SIZES) + 0.5) / SIZES)
    widened = np.stack([bonus.of(sizes), bonus.spared(sizes)])
    _, firsts, counts = np.unique(widened, axis=1, return_index=True, return_counts=True)
    zones = (bonus.zone_at(draw.zone, float(sizes[first])) for first in firsts)
    total = sum(count * replace(draw, zone=zone).covariance for count, zone in zip(counts, zones, strict=True))
    found = np.asarray(total / SIZES)
    found.flags.writeable = False  # shared
    return found


@dataclass(frozen=True)
class Widened(ZoneDraw):
    """Draw of a law within a zone widened by each trial's size; implements Dependent.

    Args:
        zone: without bonus.
        confined: the draw from it.
        size: size that widens it.
    """

    confined: Confined
    size: SizedBy

    @property
    @override
    def words(self) -> str:
        way = "widened by" if self.size.bonus.of_zone or self.size.bonus.of_orientation else "with"
        return f"{self.confined.words}, {way} {self.size.words}"

    @property
    def reads(self) -> tuple[str, ...]:
        """See Dependent: the size."""
        return (self.size.name,)

    @property
    def uniforms(self) -> int:
        return self.confined.uniforms

    @property
    def groups(self) -> tuple[Group, ...]:
        """See Smooth: as where the zone is as wide as in no other trial, if its orientation is limited by itself."""
        _, ratio = self.zone.halves(np.array([self.zone.width]), None)
        return self.confined.law.groups(ratio)

    @override
    def sized(self, width: float) -> Self:
        confined = self.confined.sized(width)
        return replace(self, zone=confined.zone, confined=confined)

    def following(self, name: str, draw: Draw) -> Self:
        """See Following: the size."""
        return replace(self, size=self.size.following(draw)) if name == self.size.name else self

    @property
    def fills(self) -> bool:
        """See Filled."""
        return self.confined.fills

    @property
    def mean_vector(self) -> Array:
        """See ZoneDraw; a bonus widens to all sides alike."""
        return self.confined.mean_vector

    @cached_property
    def covariance(self) -> Array:
        """See ZoneDraw; over all sizes."""
        return self.size.bonus.covariance(self.confined, self.size.law)

    @cached_property
    def distribution(self) -> ComponentLaw:
        """See ZoneDraw; over all sizes."""
        return replace(self._widest.distribution, variance=float(self.covariance[0, 0]))

    @cached_property
    def _widest(self) -> Confined:
        ends, bonus = np.array([self.size.law.low, self.size.law.high]), self.size.bonus
        wider = bonus.spared(ends) + (bonus.of(ends) if bonus.of_zone or bonus.of_orientation else 0.0)
        return self._at(float(ends[np.argmax(wider)]))

    def _at(self, size: float) -> Confined:
        return replace(self.confined, zone=self.size.bonus.zone_at(self.zone, size))

    def deviations(self, *uniforms: Array) -> tuple[Array, ...]:
        """See Dependent: not asked, for the size is missing."""
        raise TypeError(f"{self.words}: expected the sizes of the trials")

    def deviations_in(self, width: Ratio, orientation: Ratio | None, *uniforms: Array) -> tuple[Array, ...]:
        return self.confined.deviations_in(width, orientation, *uniforms)

    def deviations_given(self, given: Given, *uniforms: Array) -> tuple[Array, ...]:
        """See Dependent."""
        return self.deviations_in(*self.size.bonus.widths(self.zone, self.size.of(given)), *uniforms)

    def furthest(self, gradient: Array) -> Array:
        """See ZoneDraw: in the widest zone that a size leaves."""
        return self._widest.furthest(gradient)

    def furthest_given(self, given: Given, slopes: Array) -> Array:
        """See Dependent."""
        return self._at(float(self.size.of(given)[0])).furthest(slopes)

    def support(self, gradient: Array) -> float:
        """See ZoneDraw: in the widest zone that a size leaves."""
        return self._widest.support(gradient)


@dataclass(frozen=True)
class JudgedProcess(Process):
    """A process that its zone judges with the bonus of each trial's size; implements DependentlyJudged.

    Args:
        size: by which the zone is widened.
    """

    size: SizedBy

    @property
    @override
    def words(self) -> str:
        return f"its own process, judged with {self.size.words}"

    @property
    def reads(self) -> tuple[str, ...]:
        """See DependentlyJudged: the size."""
        return (self.size.name,)

    def beyond_given(self, given: Given, *components: Array) -> NDArray[np.bool_]:
        """See DependentlyJudged: outside the zone of the trial's width."""
        widths = self.size.bonus.widths(self.zone, self.size.of(given))
        return ~self.zone.inside(np.stack(components, axis=-1), *widths)

    def following(self, name: str, draw: Draw) -> Self:
        """See Following: the size."""
        return replace(self, size=self.size.following(draw)) if name == self.size.name else self
