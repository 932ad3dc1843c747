"""Spur flanks that deviate tooth by tooth, by dense points: no foot or line of action, only curves in the plane.

Each flank is a curve of points, moved along their normals by any function of roll and height. Two gears on parallel
axes touch where the azimuths of two curves about one axis are nearest at one radius; gaps are distances of dense points
from dense polylines. A deviation that goes with the height is looked at in slices.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

Array = NDArray[np.float64]
Deviation = Callable[[int, int, Array, float], Array]
"""Offset [mm] out of the tooth, of tooth, flank (1 right, -1 left), rolls (n,) [rad] and height [mm]."""

POINTS = 6_001


FORM_SHARE = 0.95  # of the active profile, from its begin on, in which forms count


def active_rolls(teeth: int, mate: int, module: float, apart: float) -> tuple[float, float]:
    """Rolls at which the active profile of a gear of addendum 1 begins and ends: its mate's tip, and its own."""
    base, other = (z * module / 2 * math.cos(math.radians(20)) for z in (teeth, mate))
    tip, other_tip = (math.sqrt(((z + 2) * module / 2) ** 2 - own**2) for z, own in ((teeth, base), (mate, other)))
    return (math.sqrt(apart**2 - (base + other) ** 2) - other_tip) / base, tip / base


def parts(roll: Array, active: tuple[float, float]) -> tuple[Array, Array]:
    """Places of rolls in the ranges of slopes and of forms, -1/2 to 1/2 from end to end."""
    first, last = active
    return (roll - first) / (last - first) - 0.5, (roll - first) / (FORM_SHARE * (last - first)) - 0.5


def between(roll: Array, teeth: int, module: float, diameters: tuple[float, float]) -> Array:
    """Places of rolls between two diameters, -1/2 to 1/2 from end to end."""
    base = teeth * module * math.cos(math.radians(20))
    first, last = (math.sqrt((own / base) ** 2 - 1) for own in diameters)
    return (roll - first) / (last - first) - 0.5


@dataclass(frozen=True)
class DeviatedGear:
    """A gear without profile shift of addendum 1, its pressure angle 20 deg.

    Args:
        teeth, module: z, m [mm].
        first_roll: where its involutes begin [rad].
        deviation: of its flanks.
        thicker: of each tooth, an arc at the reference circle [mm].
    """

    teeth: int
    module: float
    first_roll: float
    deviation: Deviation
    thicker: float = 0.0

    @property
    def base(self) -> float:
        return self.teeth * self.module / 2 * math.cos(math.radians(20))

    @property
    def last_roll(self) -> float:
        tip = self.teeth * self.module / 2 + self.module
        return math.sqrt((tip / self.base) ** 2 - 1)

    def curve(self, tooth: int, flank: int, z: float, turn: float) -> Array:
        """Points (POINTS, 2) [mm] of a flank in the gear's plane, its tooth 0 at azimuth `turn` [rad]."""
        roll = np.linspace(self.first_roll, self.last_roll, POINTS)
        radius = self.base * np.hypot(1.0, roll)
        alpha = np.arctan(roll)
        half = (math.pi / 2 + self.thicker / self.module) / self.teeth + math.tan(math.radians(20)) - math.radians(20)
        azimuth = half - (np.tan(alpha) - alpha)  # of the left flank off the middle of its tooth
        points = radius[:, None] * np.stack([np.cos(azimuth), np.sin(azimuth)], axis=-1)
        # the normal is a tangent of the base circle: it leans outwards by alpha off the direction across the radius
        out = np.stack([-np.sin(azimuth - alpha), np.cos(azimuth - alpha)], axis=-1)
        points = points + self.deviation(tooth % self.teeth, flank, roll, z)[:, None] * out
        if flank == 1:
            points[:, 1] *= -1.0
        angle = turn + 2 * math.pi * tooth / self.teeth
        cos, sin = math.cos(angle), math.sin(angle)
        return points @ np.array([[cos, sin], [-sin, cos]])


@dataclass(frozen=True)
class DeviatedPair:
    """Two such gears on parallel axes.

    Args:
        driver, driven: the gears.
        apart: distance of the axes [mm], the driven one at +x.
        heights: slices that are looked at [mm].
    """

    driver: DeviatedGear
    driven: DeviatedGear
    apart: float
    heights: tuple[float, ...] = (0.0,)

    def turn_to_touch(self, flank: int, driver_turn: float, driven_turn: float) -> float:
        """By how much the driven gear turns towards the driver's flanks of a side until they touch [rad], unsigned."""
        found = [self._turn(tooth, flank, z, driver_turn, driven_turn) for tooth, z in self._looked_at(driver_turn)]
        return min(found)

    def gap(self, flank: int, driver_turn: float, driven_turn: float) -> float:
        """The least distance of the flanks of a side [mm], of gears that do not touch there."""
        return min(self._gap(tooth, flank, z, driver_turn, driven_turn) for tooth, z in self._looked_at(driver_turn))

    def _looked_at(self, driver_turn: float) -> list[tuple[int, float]]:
        nearest = -round(driver_turn / (2 * math.pi / self.driver.teeth))
        return [(nearest + k, z) for k in (-2, -1, 0, 1, 2) for z in self.heights]

    def _curves(self, tooth: int, flank: int, z: float, driver_turn: float, driven_turn: float) -> tuple[Array, Array]:
        """Curves of a tooth of the driver and of the nearest tooth that it meets, about the driven axis."""
        own = self.driver.curve(tooth, flank, z, driver_turn) - np.array([self.apart, 0.0])
        # the driven tooth whose flank of the same hand follows that one: its middle half a pitch on, or back
        middle = (
            math.pi - (driver_turn + 2 * math.pi * tooth / self.driver.teeth) * self.driver.teeth / self.driven.teeth
        )
        wanted = middle + flank * math.pi / self.driven.teeth
        mate = round((wanted - driven_turn) / (2 * math.pi / self.driven.teeth))
        return own, self.driven.curve(mate, flank, z, driven_turn)

    def _turn(self, tooth: int, flank: int, z: float, driver_turn: float, driven_turn: float) -> float:
        own, mate = self._curves(tooth, flank, z, driver_turn, driven_turn)
        radius, azimuth = np.hypot(*own.T), np.unwrap(np.arctan2(*own.T[::-1]))
        mate_radius, mate_azimuth = np.hypot(*mate.T), np.unwrap(np.arctan2(*mate.T[::-1]))
        low, high = max(radius.min(), mate_radius.min()), min(radius.max(), mate_radius.max())
        if low >= high:
            return math.inf
        order = np.argsort(radius)
        at = np.linspace(low, high, 4 * POINTS)
        first, second = (
            CubicSpline(r, a)(at) for r, a in ((radius[order], azimuth[order]), (mate_radius, mate_azimuth))
        )
        apart = np.remainder(flank * (second - first) + math.pi, 2 * math.pi) - math.pi
        return float(apart.min())

    def _gap(self, tooth: int, flank: int, z: float, driver_turn: float, driven_turn: float) -> float:
        own, mate = self._curves(tooth, flank, z, driver_turn, driven_turn)
        tree = cKDTree(mate)
        distance, nearest = tree.query(own)
        best = np.argsort(distance)[:200]
        return min(_to_polyline(own[k], mate, int(nearest[k])) for k in best)


def _to_polyline(point: Array, line: Array, nearest: int) -> float:
    """Distance of a point from the two pieces of a polyline at its nearest corner."""
    found = []
    for start in (nearest - 1, nearest):
        if 0 <= start < len(line) - 1:
            along = line[start + 1] - line[start]
            share = min(max(float((point - line[start]) @ along / (along @ along)), 0.0), 1.0)
            found.append(float(np.hypot(*(point - line[start] - share * along))))
    return min(found)
