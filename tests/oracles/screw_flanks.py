"""Screw involute flanks by the polar equation of the transverse involute, with no foot point and no plane of action.

A flank point has a radius and a height; its azimuth is half the tooth there, and the helix. Distances and turns are
least values over grids that shrink about the best point. Nothing here comes from tol3d.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

Deviation = Callable[[int, int, Array, Array], Array]
"""Offset [mm] out of the tooth in the transverse section, along the tangent of the base circle.

Of tooth, side (1 right, -1 left), rolls [rad] and heights [mm].
"""


def no_deviation(tooth: int, side: int, roll: Array, z: Array) -> Array:
    """None."""
    return np.zeros(np.broadcast_shapes(roll.shape, z.shape))


GOLDEN = (math.sqrt(5.0) - 1) / 2
GRID, ROUNDS, SHRINK = 41, 14, 0.2  # points a side; a grid reaches 0.4 of the one before, the last 4e-6 of the first


@dataclass(frozen=True)
class ScrewGear:
    """A helical gear: normal module [mm], normal pressure angle and helix angle [rad], hand 1 or -1.

    Teeth of a ring point inwards: they grow wider with the radius, and a positive shift and addendum go inwards.
    """

    teeth: int
    module: float
    alpha: float
    beta: float
    hand: int
    face: float
    shift: float = 0.0
    thinner: float = 0.0
    addendum: float = 1.0
    inside: bool = False
    deviation: Deviation = no_deviation

    @property
    def out(self) -> int:
        """-1 of a ring."""
        return -1 if self.inside else 1

    @property
    def reference(self) -> float:
        """r [mm]."""
        return self.module * self.teeth / (2 * math.cos(self.beta))

    @property
    def transverse(self) -> float:
        """alpha_t [rad]."""
        return math.atan2(math.tan(self.alpha), math.cos(self.beta))

    @property
    def base(self) -> float:
        """r_b [mm]."""
        return self.reference * math.cos(self.transverse)

    @property
    def tip(self) -> float:
        """r_a [mm]."""
        return self.reference + self.out * self.module * (self.addendum + self.shift)

    @property
    def ends(self) -> tuple[float, float]:
        """Radii between which its flanks are looked at: base and tip, of a ring tip and 2.2 modules further."""
        return (self.tip, self.tip + 2.2 * self.module) if self.inside else (self.base * 1.0001, self.tip)

    @property
    def twist(self) -> float:
        """Azimuth per height [rad/mm]."""
        return self.hand * math.tan(self.beta) / self.reference

    def half_angle(self, radius: Array) -> Array:
        """Half a tooth at radii [rad]."""
        normal = self.module * (math.pi / 2 + 2 * self.shift * math.tan(self.alpha)) - self.thinner
        at_reference = normal / math.cos(self.beta) / (2 * self.reference)
        inv = [np.sqrt(np.maximum((own / self.base) ** 2 - 1, 0.0)) for own in (np.float64(self.reference), radius)]
        first, second = (own - np.arctan(own) for own in inv)
        return np.asarray(at_reference + self.out * (first - second))

    def before(self, radius: Array, z: Array, side: int, tooth: int) -> Array:
        """Radius [mm] of the point without deviation that came to a radius and height along its tangent."""
        if self.deviation is no_deviation:
            return radius
        roll = np.sqrt(np.maximum((radius / self.base) ** 2 - 1, 0.0)) - self.out * self.further(radius, z, side, tooth)
        return np.asarray(np.where(roll > 0.0, self.base * np.hypot(1.0, roll), 0.0))

    def further(self, radius: Array, z: Array, side: int, tooth: int) -> Array:
        """Angle [rad] by which a flank stands out of its tooth: along the base tangent an involute comes to one turned.

        There it is as much further on the tangent as the deviation of the point from which it came; of a ring, back.
        """
        roll, angle = np.sqrt(np.maximum((radius / self.base) ** 2 - 1, 0.0)), np.zeros(1)
        for _ in range(1 if self.deviation is no_deviation else 4):
            angle = self.deviation(tooth % self.teeth, side, roll - self.out * angle, z) / self.base
        return angle

    def points(self, radius: Array, z: Array, side: int, tooth: int, turn: float) -> Array:
        """Points (..., 3) [mm] of a flank; side 1 is the right one, on the low-azimuth side of its tooth."""
        roll = np.sqrt(np.maximum((radius / self.base) ** 2 - 1, 0.0))
        off = self.deviation(tooth % self.teeth, side, roll, z) / self.base
        radius = self.base * np.hypot(1.0, roll + self.out * off) if self.deviation is not no_deviation else radius
        half = self.half_angle(radius) + off
        azimuth = turn + 2 * math.pi * tooth / self.teeth + self.twist * z - side * half
        return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=-1)


@dataclass(frozen=True)
class Placed:
    """A gear in the world: rotation (3, 3) of its axis's frame and its origin [mm], and its centre off the axis."""

    gear: ScrewGear
    rotation: Array
    origin: Array
    centre: tuple[float, float] = (0.0, 0.0)

    def world(self, points: Array, turn: float) -> Array:
        """Points of the gear's flanks, turned with it, in the world."""
        (x, y), cos, sin = self.centre, math.cos(turn), math.sin(turn)
        off = np.array([cos * x - sin * y, sin * x + cos * y, 0.0])
        return np.asarray((points + off) @ self.rotation.T + self.origin)

    def own(self, points: Array, turn: float) -> Array:
        """Points of the world in the frame of the gear's centre, its axis as z."""
        (x, y), cos, sin = self.centre, math.cos(turn), math.sin(turn)
        off = np.array([cos * x - sin * y, sin * x + cos * y, 0.0])
        return np.asarray((points - self.origin) @ self.rotation - off)


def lag(driver: Placed, driven: Placed, turns: tuple[float, float], side: int, teeth: tuple[int, int]) -> float:
    """Arc [mm] on the driven base circle by which a pair of flanks is apart, its least over both bounded flanks.

    A point of one flank is that arc off the other one of the same height; below 0 they overlap. Flanks of the driven
    gear end at its tip and at both ends of its face. Where one is a ring, its flank is the one of the other side.
    """
    gear = driver.gear
    low, high = gear.ends
    return least(lag_at(driver, driven, turns, side, teeth), (low, -gear.face / 2), (high, gear.face / 2))


def lag_at(
    driver: Placed, driven: Placed, turns: tuple[float, float], side: int, teeth: tuple[int, int]
) -> Callable[[Array, Array], Array]:
    """The same arc for a point of the driver's flank, by its radius and height."""
    gear, mate = driver.gear, driven.gear
    mating = side * gear.out * mate.out

    def apart(radius: Array, z: Array) -> Array:
        points = driven.own(driver.world(gear.points(radius, z, side, teeth[0], turns[0]), turns[0]), turns[1])
        rho = np.hypot(points[..., 0], points[..., 1])
        azimuth = np.arctan2(points[..., 1], points[..., 0])
        middle = turns[1] + 2 * math.pi * teeth[1] / mate.teeth + mate.twist * points[..., 2]
        off = np.remainder(azimuth - middle + math.pi, 2 * math.pi) - math.pi
        half = mate.half_angle(rho) + mate.further(rho, points[..., 2], mating, teeth[1])
        found = mate.base * (-mating * off - half)
        own = mate.before(rho, points[..., 2], mating, teeth[1])
        first, last = (mate.tip, mate.ends[1]) if mate.inside else (mate.base, mate.tip)
        outside = (own > last) | (own < first) | (np.abs(points[..., 2]) > mate.face / 2)
        return np.where(outside, np.inf, found)

    return apart


SLICES = 161  # across a face, in which a form of some waves shows
LOWEST = 4  # least slices whose neighbourhood is looked at again
AGAIN = 4  # times, each a twentieth as wide


def lag_in_slices(
    driver: Placed, driven: Placed, turns: tuple[float, float], side: int, teeth: tuple[int, int]
) -> float:
    """As `lag`, slice by slice: of flanks whose forms may be nearest at several heights."""
    apart, gear = lag_at(driver, driven, turns, side, teeth), driver.gear
    half = gear.face / 2

    def of_slices(z: Array) -> Array:
        first, last = (np.full((len(z), 1), end) for end in gear.ends)
        best = np.full(len(z), np.inf)
        for _ in range(ROUNDS):
            radius = first + (last - first) * np.linspace(0.0, 1.0, GRID)
            values = apart(radius, np.broadcast_to(z[:, None], radius.shape))
            best = np.minimum(best, values.min(axis=1))
            middle, reach = np.take_along_axis(radius, values.argmin(axis=1)[:, None], axis=1), (last - first) * SHRINK
            first, last = np.maximum(middle - reach, gear.ends[0]), np.minimum(middle + reach, gear.ends[1])
        return best

    heights, step = np.linspace(-half, half, SLICES), gear.face / (SLICES - 1)
    values = of_slices(heights)
    lowest = [k for k in range(SLICES) if values[k] <= values[max(k - 1, 0) : k + 2].min() < np.inf]
    found = math.inf
    for k in sorted(lowest, key=lambda own: float(values[own]))[:LOWEST]:
        middle, reach = heights[k], step
        for _ in range(AGAIN):
            near = np.clip(np.linspace(middle - reach, middle + reach, GRID), -half, half)
            own = of_slices(near)
            middle, reach, found = near[own.argmin()], reach / 20 * 1.5, min(found, float(own.min()))
    return found


def caliper(gear: ScrewGear, teeth: int, reach: float) -> float:
    """Least distance [mm] of two parallel planes that touch the outer flanks over so many teeth, over all their tilts.

    Each plane touches its flank where that reaches furthest along the planes' normal, no further than `reach` [mm] from
    the middle of the face: on an endless one it would at any tilt but that of the generators.
    """
    at = math.pi * (teeth - 1) / gear.teeth  # a span symmetric about the tooth or space on +x

    def width(lean: float) -> float:
        z = np.linspace(-reach, reach, 9)[:, None]
        first, last, furthest = np.zeros(z.shape), np.full(z.shape, 2.0), -math.inf
        for _ in range(ROUNDS):  # at each height on grids of its own, which shrink about the best roll
            roll = first + (last - first) * np.linspace(0.0, 1.0, GRID)
            radius = gear.base * np.hypot(1.0, roll)
            azimuth = at + gear.twist * z + gear.half_angle(radius)
            reaches = radius * np.sin(azimuth) * math.cos(lean) - gear.hand * z * math.sin(lean)
            best = np.take_along_axis(roll, np.argmax(reaches, axis=1)[:, None], axis=1)
            furthest, half = max(furthest, float(reaches.max())), (last - first) * SHRINK
            first, last = best - half, best + half
        return 2 * furthest

    low, high = 0.0, 1.9 * gear.beta  # beyond, planes touch other parts of the flanks
    for _ in range(70):  # golden section: the width has a kink where the planes touch along generators
        first, second = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        low, high = (low, second) if width(first) < width(second) else (first, high)
    return width((low + high) / 2)


def ball_distance(gear: ScrewGear, centre: float) -> float:
    """Least distance [mm] from a point in the middle of a space, at a radius in the plane z = 0, to its flank."""
    return pin_distance(gear, centre, None)


def _rolls(gear: ScrewGear) -> tuple[float, float]:
    """Rolls [rad] between which a flank is looked at for a ball: far beyond the tooth."""
    if not gear.inside:
        return 0.0, 2.0
    first, last = (math.sqrt((radius / gear.base) ** 2 - 1.0) for radius in (gear.tip, gear.tip + 4 * gear.module))
    return first, last


def pin_distance(gear: ScrewGear, centre: float, lean: float | None) -> float:
    """The same to a straight line through that point, across the radius, that leans by an angle towards the helix."""
    space = math.pi / gear.teeth
    through = centre * np.array([math.cos(space), math.sin(space), 0.0])
    lean_to = 0.0 if lean is None else lean
    along = np.array([-math.sin(space) * math.sin(lean_to), math.cos(space) * math.sin(lean_to), math.cos(lean_to)])

    def square(roll: Array, z: Array) -> Array:
        apart = gear.points(gear.base * np.hypot(1.0, roll), z, -1, 0, 0.0) - through
        found = (apart**2).sum(axis=-1)
        return found if lean is None else found - (apart @ along) ** 2

    first, last = _rolls(gear)
    return math.sqrt(least(square, (first, -3 * gear.module), (last, 3 * gear.module)))


def least(function: Callable[[Array, Array], Array], low: tuple[float, float], high: tuple[float, float]) -> float:
    """Least value of a function of two numbers between their ends, on grids that shrink about the best point."""
    ends = np.array([low, high])
    first, last, best = *ends.copy(), math.inf
    for _ in range(ROUNDS):
        one, other = (np.linspace(a, b, GRID) for a, b in zip(first, last, strict=True))
        values = np.broadcast_to(function(*np.broadcast_arrays(one[:, None], other[None, :])), (GRID, GRID))
        i, j = np.unravel_index(np.argmin(values), values.shape)
        best = min(best, float(values[i, j]))
        middle, reach = np.array([one[i], other[j]]), (last - first) * SHRINK
        first, last = np.maximum(middle - reach, ends[0]), np.minimum(middle + reach, ends[1])
    return best
