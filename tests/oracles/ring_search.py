"""Distance of the flanks of a gear and of a ring in any pose: dense points of all teeth near the mesh, then a search.

The flanks are surfaces of roll and height: points of involutes, extruded. Nothing is known here of feet, lines of
action or which teeth meet. Lengths in mm, angles in rad.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.spatial.distance import cdist

Array = NDArray[np.float64]

ROLLS, HEIGHTS = 60, 5  # points of a flank to begin with
NEAR = 2  # teeth on either side of the one at the mesh
DOUBT = 0.04  # mm; pairs of flanks whose points are no further than this beyond the nearest are searched
ROUNDS = 3  # of the search, each without what the one before knew of the curvature


@dataclass(frozen=True)
class ToothedGear:
    """Flanks of one gear of a build.

    Args:
        teeth, module, pressure_angle: as drawn.
        thickness: of a tooth at the reference circle, before growth.
        tip, root: radii between which the flanks lie, before growth.
        width: of the face, before growth.
        inside: whether it is a ring.
        offset: of the flanks along their normals.
        growth: of the whole gear.
        world_from_gear: (4, 4), at its turn.
    """

    teeth: int
    module: float
    pressure_angle: float
    thickness: float
    tip: float
    root: float
    width: float
    inside: bool
    offset: float
    growth: float
    world_from_gear: Array

    @property
    def base(self) -> float:
        return self.module * self.teeth * math.cos(self.pressure_angle) / 2

    @property
    def rolls(self) -> tuple[float, float]:
        ends = [math.sqrt(max((radius / self.base) ** 2 - 1.0, 0.0)) for radius in (self.tip, self.root)]
        return min(ends), max(ends)

    def flank(self, tooth: int, right: bool) -> "FlankSurface":
        """One flank of a tooth."""
        flat = math.tan(self.pressure_angle) - self.pressure_angle
        half = self.thickness / (self.module * self.teeth)
        # where the involute leaves the base circle, from the middle of the tooth
        start = half - flat if self.inside else half + flat
        return FlankSurface(self, 2 * math.pi * tooth / self.teeth, -1.0 if right else 1.0, start)


@dataclass(frozen=True)
class FlankSurface:
    """A flank of a gear's tooth at an azimuth, on the side of lower (-1) or higher azimuths (1)."""

    gear: ToothedGear
    azimuth: float
    side: float
    start: float

    def at(self, roll: Array, height: Array) -> tuple[Array, Array, Array]:
        """Points (n, 3) in the world and their derivatives by roll and height."""
        gear = self.gear
        # outside teeth grow thinner with the radius, inside ones thicker
        towards = self.side if gear.inside else -self.side
        turn = self.azimuth + self.side * self.start + towards * roll
        cos, sin, none = np.cos(turn), np.sin(turn), np.zeros_like(turn)
        string = np.stack([towards * sin, -towards * cos, none], axis=-1)
        radial = np.stack([cos, sin, none], axis=-1)
        length = gear.growth * gear.base
        out = -1.0 if gear.inside else 1.0
        point = length * radial + (length * roll + out * gear.offset)[:, None] * string
        point[:, 2] = height
        by_roll = (length * roll + out * gear.offset)[:, None] * radial
        rotation, shift = gear.world_from_gear[:3, :3], gear.world_from_gear[:3, 3]
        along = np.broadcast_to(rotation[:, 2], point.shape)
        return point @ rotation.T + shift, by_roll @ rotation.T, along

    @property
    def bounds(self) -> list[tuple[float, float]]:
        half = self.gear.growth * self.gear.width / 2
        return [self.gear.rolls, (-half, half)]

    def grid(self, heights: Array) -> Array:
        """Rolls at some heights in the world, or at the ends of the face, (n, 2); rolls vary first."""
        low, high = self.bounds[1]
        own = np.clip(heights - self.gear.world_from_gear[2, 3], low, high)
        rolls = np.linspace(*self.bounds[0], ROLLS)
        return np.stack([np.tile(rolls, len(own)), np.repeat(own, ROLLS)], axis=-1)


def distance(driver: ToothedGear, driven: ToothedGear, *, right: bool) -> float:
    """Shortest distance of the driver's flanks of one side from the flanks that face them."""
    # a space of the ring faces a gear: there a right flank meets a left one
    first = [driver.flank(tooth, right) for tooth in teeth_at_mesh(driver)]
    second = [driven.flank(tooth, not right) for tooth in teeth_at_mesh(driven)]
    pairs = [_Pair(own, its) for own in first for its in second]
    least = min(pair.nearest for pair in pairs)
    return min(pair.searched() for pair in pairs if pair.nearest < least + DOUBT)


class _Pair:
    """Two flanks, and how far points of them are apart at HEIGHTS sections."""

    def __init__(self, own: FlankSurface, its: FlankSurface) -> None:
        self.own, self.its = own, its
        heights = np.linspace(*own.bounds[1], HEIGHTS) + own.gear.world_from_gear[2, 3]
        self.grids = own.grid(heights), its.grid(heights)
        points = own.at(*self.grids[0].T)[0].reshape(HEIGHTS, ROLLS, 3), its.at(*self.grids[1].T)[0]
        each = zip(points[0], points[1].reshape(HEIGHTS, ROLLS, 3), strict=True)
        self.apart = np.array([cdist(one, other) for one, other in each])
        self.nearest = float(self.apart.min())

    def searched(self) -> float:
        """Their shortest distance, searched from either end of the face and from the middle."""
        found = []
        for section in (0, HEIGHTS // 2, HEIGHTS - 1):
            one, other = np.unravel_index(np.argmin(self.apart[section]), (ROLLS, ROLLS))
            start = [grid[section * ROLLS + k] for grid, k in zip(self.grids, (one, other), strict=True)]
            found.append(_lowest(self.own, self.its, np.concatenate(start)))
        return min(found)


def teeth_at_mesh(gear: ToothedGear) -> range:
    """Teeth about the direction of the world's x."""
    ahead = math.atan2(gear.world_from_gear[1, 0], gear.world_from_gear[0, 0])
    middle = round(-ahead * gear.teeth / (2 * math.pi))
    return range(middle - NEAR, middle + NEAR + 1)


def _lowest(own: FlankSurface, its: FlankSurface, start: Array) -> float:
    """Search for the shortest way between two flanks; rolls count as lengths, so that all of it is alike."""
    scales = np.array([own.gear.base, 1.0, its.gear.base, 1.0])

    def value(place: Array) -> tuple[float, Array]:
        roll, height, mate_roll, mate_height = place / scales
        first, by_roll, by_height = own.at(np.array([roll]), np.array([height]))
        second, by_mate, by_mate_height = its.at(np.array([mate_roll]), np.array([mate_height]))
        way = first[0] - second[0]
        length = float(np.sqrt(way @ way))
        slopes = np.array([by_roll[0] @ way, by_height[0] @ way, -by_mate[0] @ way, -by_mate_height[0] @ way])
        return length, slopes / (length * scales)

    ends = [(low * by, high * by) for (low, high), by in zip([*own.bounds, *its.bounds], scales, strict=True)]
    options = {"maxiter": 2000, "maxfun": 4000, "ftol": 1e-15, "gtol": 1e-9, "maxcor": 30}
    place, least = start * scales, math.inf
    for _ in range(ROUNDS):
        found = minimize(value, place, jac=True, bounds=ends, method="L-BFGS-B", options=options)
        place, least = found.x, float(found.fun)
    return least
