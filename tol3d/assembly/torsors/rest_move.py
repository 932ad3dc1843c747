"""Rest: the torsor that goes farthest along a force without interference at contacts."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, islice
from math import comb

import numpy as np

from tol3d.assembly.model import Rest
from tol3d.assembly.torsors.freedoms import INDEPENDENT, Freedoms, freedom_in_words
from tol3d.assembly.torsors.mate_move import contact, take_relations
from tol3d.assembly.torsors.terms import Form
from tol3d.assembly.torsors.torsor import height_at, ordered_product
from tol3d.assembly.torsors.world import World
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class Corner:
    """Contacts that balance the force by themselves: as many as unknowns.

    Args:
        contacts: the contacts.
        solution: unknowns from their gaps, (unknowns, unknowns).
        loads: on each contact by the force, 0 or more.
        slight: on each by the perturbation that decides between corners with the same loads.
    """

    contacts: tuple[int, ...]
    solution: Array
    loads: Array
    slight: Array


@dataclass(frozen=True, eq=False)
class OneSided:
    """The unknowns z that go farthest along a force while no gap A z + g is below 0.

    The path of the force is the least of loads . g over all corners of the dual. Corners with the same loads leave z
    open; among them the slight loads decide in the same way.

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
            found += self._largest_motion(groups, read) / len(self._groups)
        return found

    def _largest_motion(self, groups: list[tuple[Array, list[Corner]]], read: Array) -> Array:
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


MOST_SETS = 500_000
"""Largest number of sets of contacts to try, once: 36 contacts of three freedoms, or 20 of six, have far fewer."""
TOGETHER = 10_000
"""Sets at once."""
NONE = 1e-9
"""Fraction of the force below which a contact carries nothing."""
SLIGHTER = 1e-4
"""Perturbation of an objective, so that it is parallel to nothing in particular."""
ALIKE = 1e-6
"""Least singular value of rows, lengths of about 1, that are independent."""


def rested(move: Rest, world: World, leaning: Array | None = None) -> World:
    """The world with a part at rest; in the middle of its rocking range.

    Args:
        move: the move.
        world: before it.
        leaning: direction along its unknowns (unknowns,) in which it rocks; default to the middle.

    Raises:
        InputError: no contacts balance the force, or too many of them to try.
    """
    contacts = [contact(pair, move, world) for pair in move.pairs]
    rows, values = (np.concatenate(each) for each in zip(*contacts, strict=True))
    part = world.assembly.part[move.part]
    points = [world.origin(pair.moving) for pair in move.pairs]
    points += [world.origin(name) for relation in move.relations for name in (relation.moving, relation.target)]
    freedoms = Freedoms(part.pose[:3, 3], points, world.columns.count)
    take_relations(freedoms, move, world)
    before = rows @ freedoms.torsor
    asked = rows @ freedoms.left
    _, strengths, right = np.linalg.svd(asked)
    seen = right[: int(np.sum(strengths > INDEPENDENT * strengths[0]))]
    at = part.pose[:3, :3] @ move.at + part.pose[:3, 3]
    pull = (height_at(at, move.force) @ freedoms.left)[0]
    size = np.linalg.norm(pull)
    beside = pull - seen.T @ (seen @ pull)
    if np.linalg.norm(beside) > ALIKE * size:
        _refuse(move, freedoms.left @ (beside / size)[:, None])
    matrix = asked @ seen.T
    generic = along_nothing(len(seen))
    wishes = [generic, -generic] if leaning is None else [_clear(leaning, generic)]
    corners = []
    for wish in wishes:
        corners.append(corners_of(matrix, seen @ pull / size, wish / np.linalg.norm(wish)))
        if not corners[-1]:
            _refuse(move, freedoms.left @ seen.T @ _given_way(matrix, seen @ pull)[:, None])
    if not any(np.any(corner.loads < NONE) for corner in corners[0]):
        corners = corners[:1]  # it never rocks
    found = world.columns.made_by(OneSided(before - values, matrix, tuple(tuple(corner) for corner in corners)))
    back = np.linalg.pinv(matrix)
    freedoms.take(back @ rows, found + back @ before)
    freedoms.settle(np.mean([world.origin(pair.moving) for pair in move.pairs], axis=0))
    return world.with_part_at(move.part, freedoms.rest())


def along_nothing(count: int) -> Array:
    """Unknowns (count,) parallel to nothing in particular."""
    return np.asarray(np.sqrt(2.0 + np.arange(count)) % 1.0 + 0.1)


def _clear(leaning: Array, generic: Array) -> Array:
    """A wish that also decides, slightly, where a part may rock across it."""
    return leaning + SLIGHTER * max(float(np.linalg.norm(leaning)), 1e-9) * generic


def corners_of(matrix: Array, pull: Array, wish: Array) -> list[Corner]:
    """The sets of contacts that balance a force, and a slight one along a wish where several sets do.

    Args:
        matrix: how gaps change with the unknowns (contacts, unknowns).
        pull, wish: along the unknowns (unknowns,).
    """
    count = matrix.shape[1]
    if comb(len(matrix), count) > MOST_SETS:
        told = f"{len(matrix)} one-sided contacts for {count} freedoms"
        raise InputError(f"{told}: expected fewer by the analytic method")
    found: list[Corner] = []
    sets = combinations(range(len(matrix)), count)
    while some := list(islice(sets, TOGETHER)):
        chosen = np.array(some)
        chosen = chosen[np.linalg.svd(matrix[chosen], compute_uv=False)[:, -1] > ALIKE]
        inverses = np.linalg.inv(matrix[chosen])
        loads, slight = -pull @ inverses, -wish @ inverses
        loads[np.abs(loads) < NONE] = 0.0
        carry = np.all(loads >= 0.0, axis=1) & np.all((loads > 0.0) | (slight >= -NONE), axis=1)
        for k in np.flatnonzero(carry):
            found.append(Corner(tuple(chosen[k].tolist()), -inverses[k], loads[k], slight[k]))
    return found


def _given_way(matrix: Array, pull: Array) -> Array:
    """A motion (unknowns,) along a force that closes no gap, as near to it as can be (Hildreth's projection)."""
    motion, shares = pull.copy(), np.zeros(len(matrix))
    for _ in range(2000):
        for k, row in enumerate(matrix):
            change = max(-shares[k], -(row @ motion) / (row @ row))
            shares[k] += change
            motion += change * row
    return motion


def _refuse(move: Rest, torsors: Array) -> None:
    raise InputError(
        f"moves.{move.name}: its contacts do not hold {move.part} against the force: {freedom_in_words(torsors)}; "
        "expected contacts on all sides to which it would give way"
    )
