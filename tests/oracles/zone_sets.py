"""Tolerance zones as drawings define them, by what lies in them; drawn by rejection. Shares no code with tol3d."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Inside = Callable[[Array, float, float], NDArray[np.bool_]]
"""Which points (n, components) [mm] lie in a zone of width t, orientation t_o."""
Placed = Callable[[Array, Array], Array]
"""Points (n, components) of a middle (n, coordinates) and a tilt or half difference (n, coordinates)."""

HALVINGS = 60


@dataclass(frozen=True)
class ZoneSet:
    """A kind of zone.

    Args:
        inside: which points lie in it.
        tilts: which components the orientation zone limits to t_o / 2, the others being limited to t / 2.
        placed: points of a middle and a tilt; None where a point is one or the other.
        sizes: how many coordinates middle and tilt have.
        directed: whether the tilt has a uniform direction of its own, and is normal along it only.
        squeezed: whether only the first coordinate of the tilt is limited to t_o / 2; its direction is uniform in units
            of both limits.
    """

    inside: Inside
    tilts: tuple[bool, ...]
    placed: Placed | None = None
    sizes: tuple[int, int] = (0, 0)
    directed: bool = False
    squeezed: bool = False

    def reach(self, width: float, orientation: float) -> Array:
        """Largest value of each component."""
        return np.where(self.tilts, orientation, width) / 2

    def rejected(self, law: str, width: float, orientation: float, count: int, seed: int) -> Array:
        """So many points (count, components), uniform in the zone or by the law `normal`."""
        rng = np.random.default_rng(seed)
        if law == "normal" and self.placed is not None:
            return self._middle_first(width, orientation, count, rng)
        reach = self.reach(width, orientation)
        found: list[Array] = []
        while sum(map(len, found)) < count:
            shape = (max(count, 40_000), len(reach))
            unit = rng.uniform(-1.0, 1.0, shape) if law == "uniform" else rng.standard_normal(shape) / 3
            points = unit * reach
            found.append(points[self.inside(points, width, orientation)])
        return np.concatenate(found)[:count]

    def _middle_first(self, width: float, orientation: float, count: int, rng: np.random.Generator) -> Array:
        """Middles of 3 sigma = t / 2, redrawn until in the zone; then tilts of 3 sigma = t_o / 2, until both are.

        A tilt is proposed uniform in the box (or, directed, along the radius of a disc) that the middle leaves, whose
        size is found by halving, and kept as often as its normal density says.
        """
        assert self.placed is not None
        placed = self.placed
        coordinates, tilted = self.sizes
        middle = np.empty((count, coordinates))
        out = np.ones(count, dtype=bool)
        while out.any():
            middle[out] = rng.standard_normal((out.sum(), coordinates)) * (width / 6)
            out = ~self.inside(placed(middle, np.zeros((count, tilted))), width, orientation)
        angle = rng.uniform(0.0, 2 * math.pi, count)
        direction = np.stack([np.cos(angle), np.sin(angle)], axis=1) if self.directed else np.eye(1, tilted)
        limit = orientation
        if self.squeezed:
            direction, limit = direction * np.array([orientation / width, 1.0]), width
        reach, above = np.zeros((count, 1)), np.full((count, 1), width)
        for _ in range(HALVINGS):
            between = 0.5 * (reach + above)
            within = self.inside(placed(middle, between * direction), width, orientation)[:, None]
            reach, above = np.where(within, between, reach), np.where(within, above, between)
        tilt, out = np.empty((count, tilted)), np.ones(count, dtype=bool)
        while out.any():
            if self.directed:
                tilt[out] = (reach * direction)[out] * np.sqrt(rng.random((out.sum(), 1)))
            else:
                tilt[out] = reach[out] * rng.uniform(-1.0, 1.0, (out.sum(), tilted))
            lengths = (tilt**2).sum(axis=1) / (direction**2).sum(axis=1) if self.squeezed else (tilt**2).sum(axis=1)
            kept = rng.random(count) < np.exp(-0.5 * lengths / (limit / 6) ** 2)
            fresh = out & kept & self.inside(placed(middle, tilt), width, orientation)
            out &= ~fresh
        return placed(middle, tilt)


def _corners(points: Array, width: float, orientation: float) -> NDArray[np.bool_]:
    """Corners of a rectangle: heights of them in the zone, and those of its tilt alone in the orientation zone."""
    offset, x, y = points.T
    tilt = np.stack([sx * x + sy * y for sx in (-1, 1) for sy in (-1, 1)])
    return (np.abs(offset + tilt).max(axis=0) <= width / 2) & (np.abs(tilt).max(axis=0) <= orientation / 2)


def _rim(points: Array, width: float, orientation: float) -> NDArray[np.bool_]:
    """Rim of a round face: its highest and its lowest point."""
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


def _round_ends_along(points: Array, width: float, orientation: float) -> NDArray[np.bool_]:
    """Both ends in discs, their difference between two planes."""
    return _both_ends(points, width, 2 * width) & (np.abs(points[:, 2] - points[:, 0]) <= orientation)


def _flat_ends_round(points: Array, width: float, orientation: float) -> NDArray[np.bool_]:
    """Both ends between two planes, half their difference in a disc."""
    start, end, across = points.T
    apart = np.sqrt(((end - start) / 2) ** 2 + across**2)
    return (np.abs(points[:, :2]).max(axis=1) <= width / 2) & (apart <= orientation / 2)


def _sum(points: Array, width: float, orientation: float) -> NDArray[np.bool_]:
    return np.abs(points).sum(axis=1) <= width / 2


def _length(points: Array, width: float, orientation: float) -> NDArray[np.bool_]:
    return np.sqrt((points**2).sum(axis=1)) <= width / 2


def _beside(middle: Array, tilt: Array) -> Array:
    return np.concatenate([middle, tilt], axis=1)


def _about(middle: Array, half: Array) -> Array:
    return np.concatenate([middle - half, middle + half], axis=1)


def _about_and_across(middle: Array, half: Array) -> Array:
    return np.concatenate([middle - half[:, :1], middle + half[:, :1], half[:, 1:]], axis=1)


def _motion(shifts: int) -> Inside:
    """Motion of a pattern as a whole: the length of its shift, so many numbers, and that of its turn add up."""

    def inside(points: Array, width: float, orientation: float) -> NDArray[np.bool_]:
        squares = points**2
        lengths = np.sqrt(squares[:, :shifts].sum(axis=1)), np.sqrt(squares[:, shifts:].sum(axis=1))
        return lengths[0] + lengths[1] <= width / 2

    return inside


MOTIONS = ((2, 1), (2, 0), (1, 2), (3, 3))
"""Directions of shifts and of turns."""

SETS = {
    "rectangle": ZoneSet(_corners, (False, True, True), _beside, (1, 2)),
    "round face": ZoneSet(_rim, (False, True, True), _beside, (1, 2)),
    "rectangle's orientation": ZoneSet(_sum, (False, False)),
    "round face's orientation": ZoneSet(_length, (False, False)),
    "axis": ZoneSet(_both_ends, (False,) * 4, _about, (2, 2), directed=True),
    "axis' orientation": ZoneSet(_length, (False, False)),
    "axis at a section": ZoneSet(_length, (False, False)),
    "axis along": ZoneSet(_round_ends_along, (False,) * 4, _about, (2, 2), directed=True, squeezed=True),
    "flat axis round": ZoneSet(_flat_ends_round, (False, False, True), _about_and_across, (1, 2), directed=True),
    "flat axis": ZoneSet(_both_heights, (False, False), _about, (1, 1)),
    "flat axis' orientation": ZoneSet(_length, (False,)),
    "point in a sphere": ZoneSet(_length, (False,) * 3),
    "point in a disc": ZoneSet(_length, (False, False)),
    "point between planes": ZoneSet(_length, (False,)),
    **{
        f"{a} shifts and {b} turns": ZoneSet(_motion(a), (False,) * (a + b), _beside if b else None, (a, b))
        for a, b in MOTIONS
    },
}
"""By name."""

REFINED = ("rectangle", "round face", "axis", "flat axis", "axis along", "flat axis round")
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
    elif name == "axis along":
        zero, strip = np.zeros_like(round_), np.array([[-1.0, 0.0, 1.0, 0.0]])
        rows = [np.hstack([round_, zero]), np.hstack([zero, round_]), strip, -strip]
        limits = [width / 2, width / 2, orientation, orientation]
    elif name == "flat axis round":
        ends = np.hstack([np.eye(2), np.zeros((2, 1))])
        rows = [ends, -ends, np.hstack([-round_[:, :1] / 2, round_[:, :1] / 2, round_[:, 1:]])]
        limits = [width / 2, width / 2, orientation / 2]
    elif name == "flat axis":
        rows = [np.eye(2), -np.eye(2), np.array([[-1.0, 1.0], [1.0, -1.0]])]
        limits = [width / 2, width / 2, orientation]
    else:
        raise ValueError(f"no facets of {name}")
    return np.vstack(rows), np.concatenate([np.full(len(own), limit) for own, limit in zip(rows, limits, strict=True)])
