"""Bonus: how much a zone grows as its feature departs from its maximum (or least) material size."""

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final, Self

import numpy as np
from scipy.optimize import minimize_scalar

from tol3d.assembly.model.bonus import Modifier
from tol3d.assembly.zones.domain import Array
from tol3d.assembly.zones.zone import Zone
from tol3d.assembly.zones.zone_draw import Confined
from tol3d.distributions import Distribution
from tol3d.errors import InputError

SIZES: Final = 512  # of equal probability, over which a covariance is averaged: 1e-5 of a normal's
SIZE_XTOL: Final = 1e-9  # mm; a support is stationary there, so its error is of order 2


@dataclass(frozen=True)
class Bonus:
    """t = t0 + clip(±(size - origin), 0, most): how sizes widen a zone.

    Args:
        low, high: limits of the size, as deviations from nominal [mm].
        grows: whether larger sizes widen: of a hole at MMC and of a pin at LMC.
        of_zone: whether the width of the zone has it.
        of_orientation: whether the orientation that refines the zone has it, by a modifier of its own; never beyond
            what the width of the zone leaves.
    """

    low: float
    high: float
    grows: bool
    of_zone: bool = True
    of_orientation: bool = False

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
        sizes = size.ppf((np.arange(SIZES) + 0.5) / SIZES)
        _, firsts, counts = np.unique(self.of(sizes), return_index=True, return_counts=True)
        zones = (self.zone_at(draw.zone, float(sizes[first])) for first in firsts)
        total = sum(count * replace(draw, zone=zone).covariance for count, zone in zip(counts, zones, strict=True))
        return np.asarray(total / SIZES)

    def support(self, draw: Confined, gradient: Array, size: Distribution, per_size: float = 0.0) -> float:
        """The largest value of gradient · components + per_size · size, over all sizes and the zones they leave.

        It is concave in the size between the sizes at which the bonus starts and ends, so that it is greatest at one
        of them, at an end of the law of size, or where one of three spans has its only maximum.

        Args:
            draw: of the zone without bonus.
            gradient: (components,), change of the measure per mm.
            size: law of the deviation of size; its ends are those of worst cases.
            per_size: change of the measure per mm of size.
        """

        def reached(own: float) -> float:
            return self.zone_at(draw.zone, own).support(gradient) + per_size * own

        inner = (own for own in (self.low, self.high) if size.low < own < size.high)
        places = sorted({size.low, size.high, *inner})
        found = [reached(own) for own in places]
        for start, stop in pairwise(places):
            best = minimize_scalar(
                lambda own: -reached(own), bounds=(start, stop), method="bounded", options={"xatol": SIZE_XTOL}
            )
            found.append(-float(best.fun))
        return max(found)
