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
"""Fraction of the force added aside of it, to see which contacts would carry if it pointed slightly aside."""
MISSED = 1e-9
"""Fraction of a force not balanced by contacts that counts as none."""
MISSED_ASIDE = 1e-3
"""The same of the force added aside."""
DEPENDENT = 1e-9
"""Singular value of contacts' rows below which one of them depends on the others."""
SHORTEST = 1e-300  # a length by which a vector is divided, which may be 0
OUTCOMES: Codes = np.array([OK, NO_BUILD, SINGULAR, NOT_HELD, SINGULAR], dtype=np.int8)
"""Status by outcome of the solver: RESTS, CLASHES, LOST, TIPS, BETWEEN."""


@dataclass(frozen=True, eq=False)
class Resting(RockingPlacer):
    """A rest with its nominal contacts; solved in the world, about the middle of the touching features.

    Args:
        move: the move.
        middle: of the part's touching features, in its frame (3, 1) [mm].
        origin: nominal place of the middle in the world (3, 1) [mm].
        reach: largest distance of the contacts from it [mm].
        start: the nominal pose about it (3, 4, 1).
        relations: that are kept, if there are any.
        undo: steps that undo a change of the kept constraints (6, kept).
        all_rows: changes of nominal gaps per turn times reach and shift (contacts, 6) [mm/mm].
        steps: motions that change gaps and keep relations, turn times reach and shift (6, motions).
        rows: changes of nominal gaps per motion (contacts, motions).
        pull: generalised force along the motions (motions,).
        basis: contacts that would carry if all touched, one per motion.
        inverse: of their rows (motions, motions).
        loads: on them, by the force and by the direction that decides where the force does not (2, motions).
        nudge: displacement of the part after it rests, along the motions (motions, n); default: none.
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
        self._solve((*contacts, kept.vectors, kept.normals, start), kept.shifts, (turn, shift, carried, outcomes))
        if self.nudge is not None:
            turn, shift = self._moved_on(self.nudge, turn, shift)
        pose = Pose(turn, shift + self.origin - rotated(turn, self.middle))
        placed = world.with_part_at(self.move.part, pose).with_loads(self.move.name, carried)
        return placed, np.where(before == OK, OUTCOMES[outcomes], before).astype(np.int8)

    def _solve(self, given: Sequence[Array], kept_shifts: Array, results: Sequence[Array | Codes]) -> None:
        """Solve for poses (3, 3, n) and (3, n), loads of contacts (contacts, n), and outcomes (n,).

        Args:
            given: points, normals and heights of contacts, constraints by relations, and the first pose; (..., n) or
                (..., 1).
            kept_shifts: see Kept.
            results: these arrays, written.
        """
        on_part, force = self.move.points_on == "part", (self.undo, self.move.force, self.move.at - self.middle[:, 0])
        nominal = (self.all_rows, self.rows, self.steps, self.basis, self.inverse, self.loads)
        *contacts, start = given
        rests_found(
            *contacts[:3], on_part, *contacts[3:], kept_shifts, *force, *nominal, start, self.reach, *results
        )  # fmt: skip
        for outcome, solve in ((LOST, tilted_rests_found), (BETWEEN, balances_found)):
            trials = np.flatnonzero(results[-1] == outcome)
            if len(trials):
                *inputs, begin = (array if array.shape[-1] == 1 else _of(array, trials) for array in given)
                parts = [_of(result, trials) for result in results]
                solve(*inputs[:3], on_part, *inputs[3:], kept_shifts, *force, self.steps, begin, self.reach, *parts)
                for result, part in zip(results, parts, strict=True):
                    result[..., trials] = part
        for pose in results[:2]:
            pose[..., results[-1] != RESTS] = np.nan

    def _moved_on(self, by: Array, turn: Array, shift: Array) -> tuple[Array, Array]:
        """Rotations and shifts after a small displacement along the motions (motions, n), to second order."""
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
        """The constraints of its relations, then those of its contacts, all at once."""
        if self.relations is not None:
            yield from self.relations.mating.asked(assembly, middle)
        rows = np.hstack([self.all_rows[:, 3:], self.reach * self.all_rows[:, :3]])
        targets = dict.fromkeys(touched(assembly, pair.target) for pair in self.move.pairs)
        words = f"contacts with {listed(list(targets))}, pressed on"
        yield Asked(words, rows_about(rows, self.origin[:, 0] - middle))

    def leaning(self, along: Array) -> "Resting":
        """The same rest, with the part pushed along a motion (motions,) if it may rock."""
        basis, inverse, loads = first_basis(self.rows, self.pull, along)
        return replace(self, basis=basis, inverse=inverse, loads=loads)

    def nudged(self, by: Array) -> "Resting":
        """The same rest, with the part displaced along the motions afterwards (motions, n), to second order."""
        return replace(self, nudge=by)


def resting(move: Rest, nominal: World) -> Resting:
    """Nominal contacts of a rest.

    Args:
        move: the move.
        nominal: the world before it without deviations, the part at its nominal pose.

    Raises:
        InputError: the contacts do not hold the part against the force, the force does not press it against all of
            them, or relations leave them nothing to hold.
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
    poses = np.empty((3, 4, max(pose.turn.shape[-1], shift.shape[-1])))
    poses[:, :3], poses[:, 3] = pose.turn, shift
    return poses


def _seen(rows: Array, kept: Array, reach: float) -> Array:
    """Steps, turn times reach and shift (6, steps), that change gaps or kept constraints."""
    both = np.vstack([rows, kept])
    return seen_steps(free_motions(np.hstack([both[:, 3:], both[:, :3] * reach]), np.zeros(3), reach), reach)


def generic(motions: int) -> Array:
    """A motion parallel to nothing in particular (motions,)."""
    return np.asarray(np.sqrt(2.0 + np.arange(motions)) % 1.0 + 0.1)


def first_basis(rows: Array, pull: Array, along: Array) -> tuple[NDArray[np.int64], Array, Array]:
    """Contacts that carry a force; if several sets do, those that carry it tilted slightly along another motion, too.

    Args:
        rows: changes of gaps per motion (contacts, motions).
        pull: generalised force (motions,).
        along: the other motion (motions,).

    Returns:
        Contacts (motions,), the inverse of their rows (motions, motions), loads on them of both (2, motions).
    """
    direction = along / max(float(np.linalg.norm(along)), SHORTEST)
    shares, _ = nnls(rows.T, -(pull + SLIGHT * direction))
    basis = np.argsort(-shares, kind="stable")[: len(pull)]
    if np.linalg.matrix_rank(rows[basis]) < len(pull):
        basis = _completed(rows, np.flatnonzero(shares > 0.0))
    inverse = np.ascontiguousarray(np.linalg.inv(rows[basis]))
    loads = np.array([-(pull @ inverse), -(direction @ inverse)])
    loads[0, np.abs(loads[0]) < TIED] = 0.0
    return basis.astype(np.int64), inverse, loads


def _completed(rows: Array, chosen: NDArray[np.int64]) -> NDArray[np.int64]:
    """Contacts that carry, and others with independent rows that make them as many as motions."""
    basis = list(chosen)
    for k in range(len(rows)):
        if len(basis) < rows.shape[1] and np.linalg.matrix_rank(rows[[*basis, k]], tol=DEPENDENT) > len(basis):
            basis.append(k)
    return np.array(basis)


def _refuse_unheld(move: Rest, rows: Array, pull: Array, free: Array, reach: float, origin: Array) -> None:
    """Refuse contacts whose forces cannot balance the one on the part; the message names the resulting motion.

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
    """Refuse contacts against which the force does not press the part; the message names the motion away from them."""
    own_rows, own_pull = rows @ steps, pull @ steps
    for step in np.eye(len(own_pull)):
        for aside in (step, -step):
            leaning = own_pull + SLIGHT * aside
            shares, left = nnls(own_rows.T, -leaning)
            if left > MISSED_ASIDE * SLIGHT:
                motion = _world_motion(steps @ (leaning + own_rows.T @ shares), reach, origin)
                raise InputError(
                    f"moves.{move.name}: the force does not press {move.part} against all of its contacts: "
                    f"{in_words(motion)}, away from some; expected a force that points towards those too, or contacts "
                    "on both sides"
                )


def _world_motion(step: Array, reach: float, origin: Array) -> Array:
    """A step, turn times reach and shift at an origin, as a motion about the world's origin (1, 6), largest entry 1."""
    turn, shift = step[:3] / reach, step[3:]
    size = max(float(np.abs(step).max()), SHORTEST)
    return np.concatenate([shift - np.cross(turn, origin), turn])[None] / size


def _contacts(move: Rest, world: World, middle: Array, origin: Array) -> tuple[Array, Array, Array]:
    """Points and normals (contacts, 3, n) and heights (contacts, n) of the gaps by `one_sided_gaps.gap_of`.

    Args:
        move: the move.
        world: before it.
        middle: point of the part's frame about which those of the part are (3, 1) [mm].
        origin: point of the world about which those of the world are (3, 1) [mm].
    """
    contacts = [_contact(move, pair, world, middle, origin) for pair in move.pairs]
    points, normals, heights = (_stacked(arrays) for arrays in zip(*contacts, strict=True))
    return points, normals, heights


def _contact(move: Rest, pair: Pair, world: World, middle: Array, origin: Array) -> tuple[Array, Array, Array]:
    """Point, normal (3, n) and height (n,) of one contact; see `_contacts`."""
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
