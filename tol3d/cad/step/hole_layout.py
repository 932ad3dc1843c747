"""Layouts of equal holes by their places in a plane: rows, grids and circles, of all of them or of some."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Final, Literal

import numpy as np

from tol3d.numerics.arrays import Array

LEAST: Final = 3  # holes of a row or a circle
LEAST_UNEQUAL: Final = 5  # holes of a circle at unequal angles; fewer lie on one by chance
MOST_PARTED: Final = 36  # holes that are parted into several layouts: 7140 circles through three of them

Order = tuple[int, ...]


@dataclass(frozen=True)
class Layout:
    """Places of equal holes.

    Args:
        kind: of the layout.
        middle: of it in the plane [mm].
        counts: holes of a row or circle, or along and across a grid.
        pitches: distances of neighbours along and across [mm]; none of a circle.
        diameter: of a circle [mm]; 0 of others.
        equal: whether the holes of a circle stand at equal angles.
    """

    kind: Literal["row", "grid", "circle"]
    middle: tuple[float, float]
    counts: tuple[int, ...]
    pitches: tuple[float, ...] = ()
    diameter: float = 0.0
    equal: bool = True


def layouts(places: Array, round_middles: Array, same: float) -> Iterator[tuple[Order, Layout]]:
    """The layout of all holes, or else those of some of them; each with its holes in order.

    Args:
        places: (n, 2) [mm].
        round_middles: of other round features, about which holes may stand (m, 2) [mm].
        same: distance that counts as none [mm].
    """
    whole = _whole(places, round_middles, same)
    if whole is not None:
        yield whole
        return
    left = list(range(len(places)))
    while LEAST <= len(left) <= MOST_PARTED:
        found = _largest_circle(places, left, same) or _longest_row(places, left, same)
        if found is None:
            return
        order, layout = found
        own = _whole(places[list(order)], round_middles, same)  # a square is a grid where nothing stands in its middle
        if own is not None:
            order, layout = tuple(order[k] for k in own[0]), own[1]
        yield order, layout
        left = [k for k in left if k not in order]


def _whole(places: Array, round_middles: Array, same: float) -> tuple[Order, Layout] | None:
    """The layout of all holes."""
    if (row := _row(places, same)) is not None:
        return row
    circle, grid = _circle(places, same), _grid(places, same)
    if circle is not None and len(round_middles):
        off = np.linalg.norm(round_middles - np.array(circle[1].middle), axis=1)
        if circle[1].equal and off.min() < same:
            return circle
    return grid or circle


def _row(places: Array, same: float) -> tuple[Order, Layout] | None:
    """Holes in line at equal distances."""
    order = np.lexsort((places[:, 1], np.round(places[:, 0] / same)))
    first, last = places[order[0]], places[order[-1]]
    size = float(np.linalg.norm(last - first))
    pitch = size / (len(places) - 1)
    steps = first + (last - first) * np.linspace(0.0, 1.0, len(places))[:, None]
    if pitch < same or np.linalg.norm(places[order] - steps, axis=1).max() > same:
        return None
    return tuple(order.tolist()), Layout("row", _pair((first + last) / 2), (len(places),), (pitch,))


def _circle(places: Array, same: float) -> tuple[Order, Layout] | None:
    """Holes on a circle: at equal angles, or at least LEAST_UNEQUAL of them."""
    terms = np.column_stack([2.0 * places, np.ones(len(places))])
    if np.linalg.matrix_rank(terms, same) < 3:
        return None
    middle = np.linalg.lstsq(terms, (places * places).sum(axis=1), rcond=None)[0][:2]
    radii = np.linalg.norm(places - middle, axis=1)
    radius = float(radii.mean())
    if np.abs(radii - radius).max() > same:
        return None
    angles = np.arctan2(*(places - middle).T[::-1])
    order = np.argsort(angles)
    gaps = np.diff(np.append(angles[order], angles[order[0]] + 2.0 * math.pi))
    equal = bool(np.abs(gaps - 2.0 * math.pi / len(places)).max() * radius < 2.0 * same)
    if not equal and len(places) < LEAST_UNEQUAL:
        return None
    layout = Layout("circle", _pair(middle), (len(places),), diameter=2.0 * radius, equal=equal)
    return tuple(order.tolist()), layout


def _grid(places: Array, same: float) -> tuple[Order, Layout] | None:
    """Holes in equal rows and columns that are square to each other."""
    first = places[0]
    for other in sorted(range(1, len(places)), key=lambda k: float(np.linalg.norm(places[k] - first))):
        x = (places[other] - first) / np.linalg.norm(places[other] - first)
        y = np.array([-x[1], x[0]])
        if x[0] < -same or (abs(x[0]) <= same and x[1] < 0.0):
            x, y = -x, -y
        along, across = _levels(places @ x, same), _levels(places @ y, same)
        counts = len(along), len(across)
        if min(counts) < 2 or counts[0] * counts[1] != len(places):
            continue
        pitches = tuple((own[-1] - own[0]) / (len(own) - 1) for own in (along, across))
        even = all(
            np.abs(np.diff(own) - pitch).max() < 2.0 * same for own, pitch in zip((along, across), pitches, strict=True)
        )
        if even:
            middle = (along[0] + along[-1]) / 2 * x + (across[0] + across[-1]) / 2 * y
            order = np.lexsort((places @ x, np.round(places @ y / same)))
            return tuple(order.tolist()), Layout("grid", _pair(middle), counts, pitches)
    return None


def _levels(values: Array, same: float) -> Array:
    """Different values among some, in order."""
    ordered = np.sort(values)
    return np.asarray(ordered[np.append(True, np.diff(ordered) > same)])


def _largest_circle(places: Array, left: Sequence[int], same: float) -> tuple[Order, Layout] | None:
    """The circle at equal angles of most holes, of those the smallest."""
    best: tuple[Order, Layout] | None = None
    for three in combinations(left, 3):
        a, b, c = places[list(three)]
        u, v = b - a, c - a
        twice = 2.0 * float(u[0] * v[1] - u[1] * v[0])
        if abs(twice) < same * same:
            continue
        off = np.array([v[1] * (u @ u) - u[1] * (v @ v), u[0] * (v @ v) - v[0] * (u @ u)]) / twice
        radius = float(np.linalg.norm(off))
        on = [k for k in left if abs(float(np.linalg.norm(places[k] - a - off)) - radius) < same]
        if best is not None and (len(on), -radius) <= (len(best[0]), -best[1].diameter / 2 + same):
            continue
        found = _circle(places[on], same)
        if found is not None and found[1].equal:
            best = tuple(on[k] for k in found[0]), found[1]
    return best


def _longest_row(places: Array, left: Sequence[int], same: float) -> tuple[Order, Layout] | None:
    """The row of most holes, of those the one of least pitch."""
    best: tuple[Order, Layout] | None = None
    for first, second in combinations(left, 2):
        step = places[second] - places[first]
        row = [first]
        while True:
            ahead = np.linalg.norm(places[left] - places[row[-1]] - step, axis=1)
            if ahead.min() > same:
                break
            row.append(left[int(ahead.argmin())])
        if len(row) >= LEAST and (
            best is None or (len(row), -float(np.linalg.norm(step))) > (len(best[0]), -best[1].pitches[0])
        ):
            found = _row(places[row], same)
            best = best if found is None else (tuple(row[k] for k in found[0]), found[1])
    return best


def _pair(place: Array) -> tuple[float, float]:
    return float(place[0]), float(place[1])
