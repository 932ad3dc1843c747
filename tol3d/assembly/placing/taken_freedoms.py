"""Freedoms of a part as shifts and turns, as what it lies against takes them one after the other: for lists.

Of the motions that are left, shifts alone are directions, and so are the turns that are in some of them, wherever their
axes are: as many of both together as there are motions. So what is taken of them depends on no origin.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

HELD: Final = 1e-6
"""Part of what is asked that must act on the motions left, else earlier ones hold it: directions have some digits."""


@dataclass(frozen=True, eq=False)
class Asked:
    """What one feature, contact or relation asks, or several of them at once.

    Args:
        words: what it is.
        rows: how it changes with a shift of the point about which motions are, and with a turn (rows, 6) [mm].
        is_room: whether it takes nothing, but leaves a clearance.
    """

    words: str
    rows: Array
    is_room: bool = False


@dataclass(frozen=True, eq=False)
class Taken:
    """Freedoms that something takes.

    Args:
        words: what takes them.
        shifts: orthonormal directions (shifts, 3).
        turns: orthonormal directions of their axes (turns, 3).
        is_room: whether they are not taken, but limited by a clearance.
    """

    words: str
    shifts: Array
    turns: Array
    is_room: bool = False

    @property
    def count(self) -> int:
        """How many."""
        return len(self.shifts) + len(self.turns)


@dataclass(frozen=True, eq=False)
class Freedoms:
    """How freedoms are taken.

    Args:
        taken: in order.
        left: that none takes.
        where: where the axis of the one turn that is left lies, such as "through (0, 40, 0)"; else "".
    """

    taken: tuple[Taken, ...]
    left: Taken
    where: str


def taken(asked: Sequence[Asked], middle: Array, reach: float) -> Freedoms:
    """What each takes of the six freedoms, of those that earlier ones left.

    Args:
        asked: in order.
        middle: the point (3,) about which their rows are [mm].
        reach: of what they are about from there [mm].
    """
    scale = np.array([1.0, 1.0, 1.0, 1 / reach, 1 / reach, 1 / reach])
    left, found = np.eye(6), []
    for own in asked:
        rows = own.rows * scale
        size = max(float(np.linalg.norm(rows, axis=1).max(initial=0.0)), 1e-300)
        _, sizes, right = np.linalg.svd(rows @ left)
        after = left @ right[int(np.sum(sizes > HELD * size)) :].T
        pairs = zip(_parts(left), _parts(after), strict=True)
        shifts, turns = (_without(before, rest) for before, rest in pairs)
        found.append(Taken(own.words, shifts, turns, own.is_room))
        left = after
    return Freedoms(
        tuple(found), Taken("", *_parts(left)), _place(left[:, 0] * scale, middle) if left.size == 6 else ""
    )


def _place(motion: Array, middle: Array) -> str:
    """Through which point the axis of a motion (6,) passes, the nearest to the origin; "" for a shift."""
    shift, turn = np.split(motion, 2)
    size = float(turn @ turn)
    if size * max(1.0, float(middle @ middle)) < HELD**2:
        return ""
    place = np.cross(turn, shift - np.cross(turn, middle)) / size
    return "through (" + ", ".join(f"{value:.6g}" for value in place.round(6) + 0.0) + ")"


def _parts(motions: Array) -> tuple[Array, Array]:
    """Directions of the shifts alone and of the turns among motions (6, motions), shift and turn times reach."""
    turns, sizes, right = np.linalg.svd(motions[3:], full_matrices=True)
    rank = int(np.sum(sizes > HELD))
    shifts = np.linalg.svd(motions[:3] @ right[rank:].T)[0][:, : motions.shape[1] - rank]
    return shifts.T, turns[:, :rank].T


def _without(directions: Array, others: Array) -> Array:
    """Of a space of directions (n, 3) those square to a part of it (m, 3): (n - m, 3)."""
    inside = directions - directions @ others.T @ others
    return np.linalg.svd(inside)[2][: len(directions) - len(others)]


def in_words(taken: Taken) -> str:
    """Freedoms, such as "z, turns x, y": a shift along z, turns about x and y."""
    if taken.count == 6:
        return "all six"
    words = [_directions(taken.shifts)] if len(taken.shifts) else []
    words += [f"turns {_directions(taken.turns)}"] if len(taken.turns) else []
    return ", ".join(words) or "none"


def _directions(directions: Array) -> str:
    """The axes that orthonormal directions (n, 3) span: "x, y", "(0.6, 0.8, 0)", "all across (0.6, 0.8, 0)"."""
    span = directions.T @ directions
    axes = [k for k in range(3) if abs(span[k, k] - 1.0) < HELD]
    words = ["xyz"[k] for k in axes]
    others = np.linalg.svd(span - np.diag([float(k in axes) for k in range(3)]))[0][:, : len(directions) - len(axes)]
    if others.shape[1] == 1:
        words.append(_numbers(others[:, 0]))
    elif others.shape[1] == 2:
        words.append(f"all across {_numbers(np.cross(others[:, 0], others[:, 1]))}")
    return ", ".join(words)


def _numbers(vector: Array) -> str:
    vector = vector * np.sign(vector[int(np.argmax(np.abs(vector.round(6))))])
    return "(" + ", ".join(f"{value:.4g}" for value in vector.round(6) + 0.0) + ")"
