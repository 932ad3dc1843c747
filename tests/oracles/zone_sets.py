"""Tolerance zones as drawings define them, by what lies in them; drawn by rejection. Shares no code with tol3d."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Inside = Callable[[Array, float, float], NDArray[np.bool_]]
"""Which points (n, components) [mm] lie in a zone of width t, orientation t_o."""


@dataclass(frozen=True)
class ZoneSet:
    """A kind of zone.

    Args:
        inside: which points lie in it.
        tilts: which components the orientation zone limits to t_o / 2, the others being limited to t / 2.
    """

    inside: Inside
    tilts: tuple[bool, ...]

    def reach(self, width: float, orientation: float) -> Array:
        """Largest value of each component."""
        return np.where(self.tilts, orientation, width) / 2

    def rejected(self, law: str, width: float, orientation: float, count: int, seed: int) -> Array:
        """So many points (count, components), uniform in the zone, or normal of sigma reach / 3 and within it."""
        rng = np.random.default_rng(seed)
        reach = self.reach(width, orientation)
        found: list[Array] = []
        while sum(map(len, found)) < count:
            shape = (max(count, 40_000), len(reach))
            unit = rng.uniform(-1.0, 1.0, shape) if law == "uniform" else rng.standard_normal(shape) / 3
            points = unit * reach
            found.append(points[self.inside(points, width, orientation)])
        return np.concatenate(found)[:count]


def _corners(points: Array, width: float, orientation: float) -> NDArray[np.bool_]:
    """Of a rectangle: heights of its corners in the zone, and those of its tilt alone in the orientation zone."""
    offset, x, y = points.T
    tilt = np.stack([sx * x + sy * y for sx in (-1, 1) for sy in (-1, 1)])
    return (np.abs(offset + tilt).max(axis=0) <= width / 2) & (np.abs(tilt).max(axis=0) <= orientation / 2)


def _rim(points: Array, width: float, orientation: float) -> NDArray[np.bool_]:
    """Of a round face: the highest and the lowest point of its rim."""
    offset, x, y = points.T
    tilt = np.sqrt(x**2 + y**2)
    return (np.abs(offset) + tilt <= width / 2) & (tilt <= orientation / 2)


def _both_ends(points: Array, width: float, orientation: float) -> NDArray[np.bool_]:
    start, end = points[:, :2], points[:, 2:]
    lengths = [np.sqrt((own**2).sum(axis=1)) for own in (start, end, (end - start) / 2)]
    return (lengths[0] <= width / 2) & (lengths[1] <= width / 2) & (lengths[2] <= orientation / 2)


def _both_heights(points: Array, width: float, orientation: float) -> NDArray[np.bool_]:
    start, end = points.T
    return (np.abs(points).max(axis=1) <= width / 2) & (np.abs(end - start) <= orientation)


def _sum(points: Array, width: float, orientation: float) -> NDArray[np.bool_]:
    return np.abs(points).sum(axis=1) <= width / 2


def _length(points: Array, width: float, orientation: float) -> NDArray[np.bool_]:
    return np.sqrt((points**2).sum(axis=1)) <= width / 2


SETS = {
    "rectangle": ZoneSet(_corners, (False, True, True)),
    "round face": ZoneSet(_rim, (False, True, True)),
    "rectangle's orientation": ZoneSet(_sum, (False, False)),
    "round face's orientation": ZoneSet(_length, (False, False)),
    "axis": ZoneSet(_both_ends, (False,) * 4),
    "axis' orientation": ZoneSet(_length, (False, False)),
    "axis at a section": ZoneSet(_length, (False, False)),
    "flat axis": ZoneSet(_both_heights, (False, False)),
    "flat axis' orientation": ZoneSet(_length, (False,)),
    "flat axis at a section": ZoneSet(_length, (False,)),
    "point in a sphere": ZoneSet(_length, (False,) * 3),
    "point in a disc": ZoneSet(_length, (False, False)),
    "point between planes": ZoneSet(_length, (False,)),
}
"""By name."""

REFINED = ("rectangle", "round face", "axis", "flat axis")
"""Those whose orientation may be refined."""


def facets(name: str, width: float, orientation: float, sides: int) -> tuple[Array, Array]:
    """Half spaces a · point <= b of a zone; round limits by polygons of so many sides around them: (rows, n), (rows,).

    A zone holds these shrunk by cos(pi / sides), and lies in these.
    """
    signs = np.array([(sx, sy) for sx in (-1.0, 1.0) for sy in (-1.0, 1.0)])
    turns = 2 * math.pi * np.arange(sides) / sides
    round_ = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    if name in ("rectangle", "round face"):
        tilt = signs if name == "rectangle" else round_
        zero, one = np.zeros((len(tilt), 1)), np.ones((len(tilt), 1))
        rows = [np.hstack([one, tilt]), np.hstack([-one, tilt]), np.hstack([zero, tilt])]
        limits = [width / 2, width / 2, orientation / 2]
    elif name == "axis":
        zero = np.zeros_like(round_)
        rows = [np.hstack([round_, zero]), np.hstack([zero, round_]), np.hstack([-round_, round_])]
        limits = [width / 2, width / 2, orientation]
    elif name == "flat axis":
        rows = [np.eye(2), -np.eye(2), np.array([[-1.0, 1.0], [1.0, -1.0]])]
        limits = [width / 2, width / 2, orientation]
    else:
        raise ValueError(f"no facets of {name}")
    return np.vstack(rows), np.concatenate([np.full(len(own), limit) for own, limit in zip(rows, limits, strict=True)])
