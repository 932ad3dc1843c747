"""Parts at rest on one-sided contacts: nominal contacts, and the pose of each trial."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog, nnls

from tol3d.assembly.model import Assembly, Pair, Rest
from tol3d.assembly.model.statuses import NO_BUILD, NOT_HELD, OK, SINGULAR
from tol3d.assembly.placing.actual_feature import total
from tol3d.assembly.placing.freedoms import free_motions, in_words, seen_steps
from tol3d.assembly.placing.locator_move import side_of
from tol3d.assembly.placing.mate_move import NOTHING, KeptRelations, kept_motions, kept_relations, kept_rows
from tol3d.assembly.placing.placer import Asked, RockingPlacer, listed, rows_about, touched
from tol3d.assembly.placing.poses import Codes, Pose, column, dot, product, rotated
from tol3d.assembly.placing.rest_balance import balances_found
from tol3d.assembly.placing.rest_solver import BETWEEN, LOST, RESTS, TIED, rests_found
from tol3d.assembly.placing.tilted_rest_solver import tilted_rests_found
from tol3d.assembly.placing.world import World
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array

SLIGHT = 1e-5
"""Fraction of the force added to it to see which contacts would carry if it pointed slightly aside."""
MISSED = 1e-9
"""Fraction of a force left over by contacts that counts as none."""
OUTCOMES: Codes = np.array([OK, NO_BUILD, SINGULAR, NOT_HELD, SINGULAR], dtype=np.int8)


@dataclass(frozen=True, eq=False)
class Resting(RockingPlacer):
    """A rest with its nominal contacts; solved in the world, with the middle of the part's features at 0.

    Args:
        move: the move.
        middle: of the part's features that touch, in its frame (3, 1) [mm].
        origin: where that lies nominally in the world (3, 1) [mm].
        reach: of the contacts about it [mm].
        start: the nominal pose there (3, 4, 1).
        relations: that are kept, if there are any.
        undo: steps that undo a change of what they keep (6, kept).
        all_rows: how nominal gaps change with turn times reach and shift (contacts, 6). steps: motions that contacts
            see and relations leave, turn times reach and shift (6, motions).
        rows: how nominal gaps change with the motions (contacts, motions).
        pull: of the force, along the motions (motions,).
        basis: contacts that would carry if all were touched, one for each motion.
        inverse: of their rows (motions, motions).
        loads: on them, of the force and of what it leans to (2, motions).
        nudge: by which the part is moved on once it rests, along the motions (motions, n); default: none.
    """

    move: Rest
    middle: Array
    origin: Array
    reach: float
    start: Array
    relations: KeptRelations | None
    undo: Array
    all_rows: Array
    steps: Array
    rows: Array
    pull: Array
    basis: NDArray[np.int64]
    inverse: Array
    loads: Array
    nudge: Array | None = None

    @property
    def contacts(self) -> Sequence[tuple[str, str]]:
        return [(pair.moving, pair.target) for pair in self.move.pairs]

    def placed(self, world: World) -> tuple[World, Codes]:
        """The world after the move, and status codes (n,)."""
        trials = world.trials
        turn, shift = np.empty((3, 3, trials)), np.empty((3, trials))
        carried, outcomes = np.empty((len(self.rows), trials)), np.empty(trials, dtype=np.int8)
        start, kept, before = self.start, NOTHING, np.full(1, OK, dtype=np.int8)
        if self.relations is not None:
            pose, before, kept = self.relations.met(world)
            start, kept = _array(pose, self.middle, self.origin), kept.about(self.middle)
        contacts = _contacts(self.move, world, self.middle, self.origin)
        self._found((*contacts, kept.vectors, kept.normals, start), kept.shifts, (turn, shift, carried, outcomes))
        if self.nudge is not None:
            turn, shift = self._moved_on(self.nudge, turn, shift)
        pose = Pose(turn, shift + self.origin - rotated(turn, self.middle))
        placed = world.with_part_at(self.move.part, pose).with_loads(self.move.name, carried)
        return placed, np.where(before == OK, OUTCOMES[outcomes], before).astype(np.int8)

    def _found(self, given: Sequence[Array], kept_shifts: Array, results: Sequence[Array | Codes]) -> None:
        """Fill in poses (3, 3, n) and (3, n), loads of contacts (contacts, n), and outcomes (n,).

        Args:
            given: points, normals and heights of contacts, constraints by relations, and the first pose; (..., n) or
                (..., 1).
            kept_shifts: see Kept.
            results: filled in.
        """
        on_part, force = self.move.points_on == "part", (self.undo, self.move.force, self.move.at - self.middle[:, 0])
        nominal = (self.all_rows, self.rows, self.steps, self.basis, self.inverse, self.loads)
        *contacts, start = given
        rests_found(
            *contacts[:3], on_part, *contacts[3:], kept_shifts, *force, *nominal, start, self.reach, *results
        )  # fmt: skip
        for outcome, found in ((LOST, tilted_rests_found), (BETWEEN, balances_found)):
            trials = np.flatnonzero(results[-1] == outcome)
            if len(trials):
                *own, begin = (each if each.shape[-1] == 1 else _of(each, trials) for each in given)
                some = [_of(result, trials) for result in results]
                found(*own[:3], on_part, *own[3:], kept_shifts, *force, self.steps, begin, self.reach, *some)
                for each, its in zip(results, some, strict=True):
                    each[..., trials] = its
        for pose in results[:2]:
            pose[..., results[-1] != RESTS] = np.nan

    def _moved_on(self, by: Array, turn: Array, shift: Array) -> tuple[Array, Array]:
        moved = self.steps @ by
        x, y, z = moved[:3] / self.reach
        none = np.zeros_like(x)
        skew = np.array([[none, -z, y], [z, none, -x], [-y, x, none]])
        once = product(skew, turn)
        return turn + once + product(skew, once) / 2.0, shift + moved[3:]

    def carries(self) -> tuple[Array, Array]:
        """The least and the largest part of the force that each contact may carry (contacts,).

        Contacts that may press against each other have no largest part: inf.
        """
        least, most = [], []
        for one in np.eye(len(self.rows)):
            low, high = (
                linprog(sign * one, A_eq=self.rows.T, b_eq=-self.pull, method="highs").fun for sign in (1.0, -1.0)
            )
            least.append(low)
            most.append(np.inf if high is None else -high)
        return np.array(least), np.array(most)

    def asked(self, assembly: Assembly, middle: Array) -> Iterator[Asked]:
        """Its relations, then its contacts all at once."""
        if self.relations is not None:
            yield from self.relations.mating.asked(assembly, middle)
        rows = np.hstack([self.all_rows[:, 3:], self.reach * self.all_rows[:, :3]])
        targets = dict.fromkeys(touched(assembly, pair.target) for pair in self.move.pairs)
        words = f"contacts with {listed(list(targets))}, pressed on"
        yield Asked(words, rows_about(rows, self.origin[:, 0] - middle))

    def leaning(self, along: Array) -> "Resting":
        """The same, pushed to the limit along a motion (motions,) where it may rock."""
        basis, inverse, loads = first_basis(self.rows, self.pull, along)
        return replace(self, basis=basis, inverse=inverse, loads=loads)

    def nudged(self, by: Array) -> "Resting":
        """The same, moved on along the motions (motions, n), to second order."""
        return replace(self, nudge=by)


def resting(move: Rest, nominal: World) -> Resting:
    """A rest.

    Args:
        move: the move.
        nominal: the world before it without deviations, the part at its nominal pose.

    Raises:
        InputError: the contacts do not hold the part against the force, or leave it free to move across the force.
    """
    pose = nominal.poses[move.part]
    on_part = move.points_on == "part"
    middle = np.mean([nominal.on_body(pair.moving, move.part).origin for pair in move.pairs], axis=0)
    at, turn, origin = move.at - middle[:, 0], pose.turn[:, :, 0], pose.point(middle)[:, 0]
    points, normals, _ = (contact[..., 0] for contact in _contacts(move, nominal, middle, column(origin)))
    arms, normals = (points @ turn.T, normals) if on_part else (points, normals @ turn.T)
    reach = max(float(np.linalg.norm(arms, axis=1).max()), 1.0)
    relations = kept_relations(move, nominal, reach)
    kept = NOTHING if relations is None else relations.met(nominal)[2].about(middle)
    rows = np.hstack([np.cross(arms, normals) / reach, normals])
    pull = np.concatenate([np.cross(turn @ at, move.force) / reach, move.force])
    left, _ = kept_motions(kept, turn, reach, np.eye(6))
    _refuse_unheld(move, rows, pull, left, reach, origin)
    steps, undo = kept_motions(kept, turn, reach, _seen(rows, kept_rows(kept, turn, reach), reach))
    if not steps.shape[1]:
        raise InputError(f"moves.{move.name}: its relations leave its contacts nothing to hold; leave one of them out")
    _refuse_loose(move, rows, pull, steps, reach, origin)
    own_rows, own_pull = np.ascontiguousarray(rows @ steps), steps.T @ pull
    basis, inverse, loads = first_basis(own_rows, own_pull, generic(len(own_pull)))
    start = _array(pose, middle, column(origin))
    return Resting(
        move, middle, column(origin), reach, start, relations, undo,
        np.ascontiguousarray(rows), np.ascontiguousarray(steps), own_rows, own_pull, basis, inverse, loads,
    )  # fmt: skip


def _of(array: NDArray[Any], trials: NDArray[np.intp]) -> NDArray[Any]:
    return np.ascontiguousarray(array[..., trials])


def _array(pose: Pose, middle: Array, origin: Array) -> Array:
    """Poses (3, 4, n) of a middle (3, 1) about an origin (3, 1)."""
    shift = pose.point(middle) - origin
    made = np.empty((3, 4, max(pose.turn.shape[-1], shift.shape[-1])))
    made[:, :3], made[:, 3] = pose.turn, shift
    return made


def _seen(rows: Array, kept: Array, reach: float) -> Array:
    """Steps, turn times reach and shift (6, steps), that contacts or relations see."""
    both = np.vstack([rows, kept])
    return seen_steps(free_motions(np.hstack([both[:, 3:], both[:, :3] * reach]), np.zeros(3), reach), reach)


def generic(motions: int) -> Array:
    """A motion parallel to nothing in particular (motions,)."""
    return np.asarray(np.sqrt(2.0 + np.arange(motions)) % 1.0 + 0.1)


def first_basis(rows: Array, pull: Array, along: Array) -> tuple[NDArray[np.int64], Array, Array]:
    """Contacts that carry a force and, if several sets do, a force tilted along another motion too.

    Returns:
        Contacts (motions,), the inverse of their rows (motions, motions), loads on them of both (2, motions).
    """
    wanted = along / max(float(np.linalg.norm(along)), 1e-300)
    shares, _ = nnls(rows.T, -(pull + SLIGHT * wanted))
    basis = np.argsort(-shares, kind="stable")[: len(pull)]
    if np.linalg.matrix_rank(rows[basis]) < len(pull):
        basis = _completed(rows, np.flatnonzero(shares > 0.0))
    inverse = np.ascontiguousarray(np.linalg.inv(rows[basis]))
    loads = np.array([-(pull @ inverse), -(wanted @ inverse)])
    loads[0, np.abs(loads[0]) < TIED] = 0.0
    return basis.astype(np.int64), inverse, loads


def _completed(rows: Array, chosen: NDArray[np.int64]) -> NDArray[np.int64]:
    """Contacts that carry, and others that make them as many as motions."""
    basis = list(chosen)
    for k in range(len(rows)):
        if len(basis) < rows.shape[1] and np.linalg.matrix_rank(rows[[*basis, k]], tol=1e-9) > len(basis):
            basis.append(k)
    return np.array(basis)


def _refuse_unheld(move: Rest, rows: Array, pull: Array, free: Array, reach: float, origin: Array) -> None:
    """Refuse contacts whose forces cannot balance the one on the part, with its resulting motion.

    Args:
        free: steps that relations leave (6, steps).
    """
    shares, left = nnls((rows @ free).T, -(pull @ free))
    if left > MISSED * np.linalg.norm(pull):
        motion = _world_motion(free @ ((pull + rows.T @ shares) @ free), reach, origin)
        raise InputError(
            f"moves.{move.name}: its contacts do not hold {move.part} against the force: {in_words(motion)}; expected "
            "contacts on all sides to which it would give way"
        )


def _refuse_loose(move: Rest, rows: Array, pull: Array, steps: Array, reach: float, origin: Array) -> None:
    """Refuse contacts against which no force presses the part, with the motion by which it may leave them."""
    own_rows, own_pull = rows @ steps, pull @ steps
    for step in np.eye(len(own_pull)):
        for aside in (step, -step):
            leaning = own_pull + SLIGHT * aside
            shares, left = nnls(own_rows.T, -leaning)
            if left > 1e-3 * SLIGHT:
                motion = _world_motion(steps @ (leaning + own_rows.T @ shares), reach, origin)
                raise InputError(
                    f"moves.{move.name}: the force does not press {move.part} against all of its contacts: "
                    f"{in_words(motion)}, away from some; expected a force that points towards those too, or contacts "
                    "on both sides"
                )


def _world_motion(step: Array, reach: float, origin: Array) -> Array:
    """A step, turn times reach and shift at an origin, as a motion about the world's (1, 6)."""
    turn, shift = step[:3] / reach, step[3:]
    size = max(float(np.abs(step).max()), 1e-300)
    return np.concatenate([shift - np.cross(turn, origin), turn])[None] / size


def _contacts(move: Rest, world: World, middle: Array, origin: Array) -> tuple[Array, Array, Array]:
    """Points, normals (contacts, 3, n) and heights (contacts, n); a gap is as `rests.gap_of` has it.

    Args:
        move: the move.
        world: before it.
        middle: about which they are in the part's frame (3, 1) [mm].
        origin: about which they are in the world (3, 1) [mm].
    """
    contacts = [_contact(move, pair, world, middle, origin) for pair in move.pairs]
    return _stacked([contact[0] for contact in contacts]), _stacked([contact[1] for contact in contacts]), _stacked(
        [contact[2] for contact in contacts]
    )  # fmt: skip


def _contact(move: Rest, pair: Pair, world: World, middle: Array, origin: Array) -> tuple[Array, Array, Array]:
    locator, (foot, normal) = total(pair.locator, 1, world.columns)[0], side_of(pair, move, world)
    if move.points_on == "part":
        pose = world.poses[world.part_of(pair.target)]
        normal = rotated(pose.turn, normal)
        moving = world.on_body(pair.moving, move.part).origin - middle
        return moving, normal, dot(normal, pose.point(foot) - origin) + locator
    return world.placed(pair.target).origin - origin, normal, locator - dot(normal, foot - middle)


def _stacked(arrays: Sequence[Array]) -> Array:
    """Arrays of all contacts, (contacts, ..., n) or (contacts, ..., 1)."""
    return np.ascontiguousarray(np.stack(np.broadcast_arrays(*arrays)))
