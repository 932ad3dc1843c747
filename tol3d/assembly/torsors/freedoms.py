"""The freedoms of a rigid body, taken by groups of equations one after the other."""

from collections.abc import Iterable
from copy import copy

import numpy as np

from tol3d.assembly.torsors.torsor import cross_matrix, shift_at, torsor_of, turn_about
from tol3d.numerics.arrays import Array

INDEPENDENT = 1e-6
"""Least part of an equation that must act on the freedoms left, else it is rounding of directions stated by six or more
digits; a turn counts by the length it moves."""


class Freedoms:
    """A torsor that is found by equations in groups, the first leading.

    A group is met as nearly as the freedoms left allow: least squares over its equations, which are all lengths or all
    turns. What earlier groups hold stays. Freedoms without an equation: no turn, and no shift of the centres of the
    turns (`settle`).

    Args:
        origin: at which shifts are counted inside (3,) [mm]; what is found does not depend on it.
        points: of the equations (points, 3) [mm]: their distance from there weighs a turn.
        columns: of the torsor.
    """

    def __init__(self, origin: Array, points: Iterable[Array], columns: int) -> None:
        self._origin = origin
        self._length = max([1.0, *(float(np.linalg.norm(point - origin)) for point in points)])
        self._left = np.eye(6)
        self._found = np.zeros((6, columns))
        self._settled = np.zeros((6, columns))

    @property
    def scale(self) -> Array:
        """(6, 6): shift at `origin` and turn as a length [mm] -> the torsor."""
        scale = np.eye(6)
        scale[:3, 3:] = cross_matrix(self._origin) / self._length
        scale[3:, 3:] /= self._length
        return scale

    @property
    def torsor(self) -> Array:
        """Torsor found so far (6, columns); undetermined components are arbitrary."""
        return self.scale @ self._found

    @property
    def count(self) -> int:
        """Number of freedoms that no equation holds."""
        return int(self._left.shape[1])

    @property
    def left(self) -> Array:
        """The torsors (6, freedoms) that no equation holds."""
        return self.scale @ self._left

    def take(self, equations: Array, values: Array) -> int:
        """Solve a group of equations.

        Args:
            equations: (equations, 6), applied to the torsor.
            values: right-hand sides (equations, columns).

        Returns:
            Number of freedoms that it takes.
        """
        asked = equations @ self.scale
        left, strengths, right = np.linalg.svd(asked @ self._left, full_matrices=True)
        count = int(np.sum(strengths > INDEPENDENT * np.linalg.norm(asked, axis=1).max(initial=0.0)))
        missing = values - asked @ self._found
        step = (left[:, :count].T @ missing) / strengths[:count, None]
        self._found = self._found + self._left @ right[:count].T @ step
        self._left = self._left @ right[count:].T
        return count

    def holds(self, equations: Array) -> bool:
        """True if earlier groups leave nothing for this one to take."""
        asked = equations @ self.scale
        return bool(np.abs(asked @ self._left).max(initial=0.0) <= INDEPENDENT * np.linalg.norm(asked))

    def settle(self, centre: Array) -> None:
        """Set a centre (3,) [mm] for the turns by groups since the last call; it stays as far as shifts are free.

        The turn is the least that meets all groups; that of earlier ones is settled.
        """
        least = copy(self)
        least.take(turn_about(np.eye(3)), np.zeros_like(self._found[3:]))
        turn = least.torsor[3:] - self._settled[3:]
        self._settled = self._settled + torsor_of(centre, np.zeros_like(turn), turn)

    def rest(self) -> Array:
        """The torsor, with the least turn where no equation decides, and shifts as settled."""
        self.take(turn_about(np.eye(3)), np.zeros_like(self._found[3:]))
        at_origin = shift_at(self._origin)
        self.take(at_origin, at_origin @ self._settled)
        return self.torsor


def freedom_in_words(torsors: Array) -> str:
    """The simplest of some freedoms (6, freedoms), such as "shift along x" or "turn about z through (0, 40, 0)"."""
    turns = torsors[3:]
    _, strengths, right = np.linalg.svd(turns)
    size = np.abs(torsors).max()
    if np.sum(strengths > INDEPENDENT * size) < torsors.shape[1]:
        return f"shift along {_direction(torsors[:3] @ right[-1])}"
    torsor = torsors[:, 0] / np.linalg.norm(turns[:, 0])
    point = np.cross(torsor[3:], torsor[:3])
    return f"turn about {_direction(torsor[3:])} through {_numbers(point)}"


def _direction(vector: Array) -> str:
    vector = vector / np.linalg.norm(vector)
    largest = np.argmax(np.abs(vector))
    if abs(vector[largest]) > 1.0 - 1e-8:
        return "xyz"[largest]
    return _numbers(vector * np.sign(vector[largest]))


def _numbers(vector: Array) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in vector.round(9) + 0.0) + ")"
