"""One-sided contacts under a force: a linear programme, trial by trial, by the corners of its dual."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.torsors.ordered import ordered_product
from tol3d.assembly.torsors.terms import Form

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Corner:
    """Contacts that balance the force by themselves: as many as unknowns.

    Args:
        contacts: which.
        solution: unknowns from their gaps, (unknowns, unknowns).
        loads: on each contact by the force, 0 or more.
        slight: on each by what decides between corners with the same loads.
    """

    contacts: tuple[int, ...]
    solution: Array
    loads: Array
    slight: Array


@dataclass(frozen=True, eq=False)
class OneSided:
    """The unknowns z that go farthest along a force while no gap A z + g is below 0.

    How far the force moves is at most loads . g of every corner of the dual, and as much as the least of them. Corners
    with the same loads leave z open; among them the slight loads decide in the same way.

    Args:
        forms: g, (contacts, columns).
        matrix: A, (contacts, unknowns).
        corners: for each wish, of which the mean is taken.
    """

    forms: Array
    matrix: Array
    corners: tuple[Sequence[Corner], ...]
    form: Form = "one-sided contacts"

    @property
    def count(self) -> int:
        """Unknowns."""
        return int(self.matrix.shape[1])

    @cached_property
    def _groups(self) -> list[list[tuple[Array, list[Corner]]]]:
        """For each wish, loads over all contacts (contacts,), and the corners that have them."""
        found = []
        for corners in self.corners:
            groups: dict[tuple[int, ...], tuple[Array, list[Corner]]] = {}
            for corner in corners:
                own = tuple(k for k, load in zip(corner.contacts, corner.loads, strict=True) if load > 0.0)
                loads = self._over_all(corner, corner.loads)
                groups.setdefault(own, (loads, []))[1].append(corner)
            found.append(list(groups.values()))
        return found

    def _over_all(self, corner: Corner, loads: Array) -> Array:
        spread = np.zeros(len(self.matrix))
        spread[list(corner.contacts)] = loads
        return spread

    def values(self, read: Array) -> Array:
        """z (unknowns, trials) from g (contacts, trials)."""
        found = np.zeros((self.count, read.shape[1]))
        for groups in self._groups:
            found += self._farthest(groups, read) / len(self._groups)
        return found

    def _farthest(self, groups: list[tuple[Array, list[Corner]]], read: Array) -> Array:
        chosen = np.argmin(ordered_product(np.array([loads for loads, _ in groups]), read), axis=0)
        found = np.empty((self.count, read.shape[1]))
        for k, (_, corners) in enumerate(groups):
            trials = np.flatnonzero(chosen == k)
            own = read[:, trials]
            slight = np.array([self._over_all(corner, corner.slight) for corner in corners])
            nearest = np.argmin(ordered_product(slight, own), axis=0) if len(corners) > 1 else np.zeros(len(trials))
            for c, corner in enumerate(corners):
                here = nearest == c
                found[:, trials[here]] = ordered_product(corner.solution, own[list(corner.contacts)][:, here])
        return found
