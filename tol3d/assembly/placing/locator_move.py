"""Parts on six locators, 3-2-1 or six planes: poses by their contacts, trial by trial.

Points on planes are met by a kernel of 7 parts; `touches`, which knows them among eight other kinds, has 26 to compile.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from tol3d.assembly.model import Assembly, Locate, Pair, Rest
from tol3d.assembly.model.statuses import OK, SINGULAR
from tol3d.assembly.placing.actual_feature import total
from tol3d.assembly.placing.freedoms import free_motions, in_words
from tol3d.assembly.placing.one_sided_gaps import stepped
from tol3d.assembly.placing.placer import Asked, Placer, frame_in_world, listed, point_rows, touched
from tol3d.assembly.placing.poses import Codes, Pose, column, dot, rotated
from tol3d.assembly.placing.world import World
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.numerics.compiled import kernel, nested
from tol3d.numerics.loops import copy_matrix, eliminated

CHORDS: Final = 14
"""Steps with the nominal inverse before Newton's method; a turn of 1e-2 takes seven."""
NEWTONS: Final = 60
MET: Final = 1e-13
"""Step [rad, and mm per mm of the points' reach] at which a trial is done: the next one would be even shorter."""

ORDER: Final = ("primary", "secondary", "tertiary")
SAME: Final = 1e-6
"""Sine of the angle between directions that are the same."""


@nested
def missing(pose: Any, contacts: Any, i: int, arms: Any, right: Any) -> None:
    """Residual of each contact, and the arms R p of the points."""
    points, normals, heights = contacts
    p, q, h = min(i, points.shape[2] - 1), min(i, normals.shape[2] - 1), min(i, heights.shape[1] - 1)
    for k in range(6):
        x, y, z = points[k, 0, p], points[k, 1, p], points[k, 2, p]
        for r in range(3):
            arms[k, r] = pose[r, 0] * x + pose[r, 1] * y + pose[r, 2] * z
        right[k] = heights[k, h] - (
            normals[k, 0, q] * (arms[k, 0] + pose[0, 3])
            + normals[k, 1, q] * (arms[k, 1] + pose[1, 3])
            + normals[k, 2, q] * (arms[k, 2] + pose[2, 3])
        )


@nested
def by_chords(pose: Any, contacts: Any, i: int, inverse: Any, reach: float, rooms: Any) -> bool:
    """Find the pose by the nominal inverse; True if found."""
    arms, right, step, _ = rooms
    before = np.inf
    for _ in range(CHORDS):
        missing(pose, contacts, i, arms, right)
        for r in range(6):
            total = 0.0
            for k in range(6):
                total += inverse[r, k] * right[k]
            step[r] = total
        length = stepped(pose, step, reach)
        if length <= MET:
            return True
        if not length < before / 2:
            return False
        before = length
    return False


@nested
def by_newton(pose: Any, contacts: Any, i: int, reach: float, rooms: Any) -> bool:
    """Find the pose by Newton's method; True if found."""
    normals = contacts[1]
    q = min(i, normals.shape[2] - 1)
    arms, right, _, matrix = rooms
    for _ in range(NEWTONS):
        missing(pose, contacts, i, arms, right)
        for k in range(6):
            a, b, c = normals[k, 0, q], normals[k, 1, q], normals[k, 2, q]
            x, y, z = arms[k, 0], arms[k, 1], arms[k, 2]
            matrix[k, 0], matrix[k, 1], matrix[k, 2] = (
                (y * c - z * b) / reach,
                (z * a - x * c) / reach,
                (x * b - y * a) / reach,
            )
            matrix[k, 3], matrix[k, 4], matrix[k, 5] = a, b, c
        if eliminated(matrix, right, 6)[0] == 0.0:
            return False
        length = stepped(pose, right, reach)
        if length <= MET:
            return True
        if not length < np.inf:
            return False
    return False


@kernel(
    arrays="float64[:,:,::1], float64[:,:,::1], float64[:,::1], float64[:,::1], float64[:,::1], float64, "
    "float64[:,:,::1], float64[:,::1], boolean[::1]"
)
def contacts_met(
    points: Any, normals: Any, heights: Any, inverse: Any, start: Any, reach: float, turns: Any, shifts: Any, met: Any
) -> None:
    """Poses of contacts: of the middle of the points, from where it lies nominally.

    Args:
        points, normals, heights: p from the middle, n (6, 3, n) and h (6, n) of the contacts [mm]; (..., 1) of what
            does not vary.
        inverse: of the contacts' rows as they are nominally: turn by reach, then shift (6, 6).
        start: the nominal pose (3, 4).
        reach: of the points about the middle [mm].
        turns, shifts: found (3, 3, n), (3, n) [mm]; NaN where they are not met.
        met: whether they are (n,).
    """
    contacts = (points, normals, heights)
    rooms = (np.empty((6, 3)), np.empty(6), np.empty(6), np.empty((6, 6)))
    pose = np.empty((3, 4))
    for i in range(met.shape[0]):
        copy_matrix(pose, start)
        found = by_chords(pose, contacts, i, inverse, reach, rooms)
        if not found:
            copy_matrix(pose, start)
            found = by_newton(pose, contacts, i, reach, rooms)
        met[i] = found
        for r in range(3):
            for c in range(3):
                turns[r, c, i] = pose[r, c] if found else np.nan
            shifts[r, i] = pose[r, 3] if found else np.nan


@dataclass(frozen=True, eq=False)
class Locating(Placer):
    """A move on six locators, with its nominal contacts.

    The part with the points is placed in the frame of the part with the planes: of the first target's part, or of the
        placed part if points are on the fixture.

    Args:
        move: the move.
        middle: of the points, in the frame of their part (3, 1) [mm].
        origin: its place in the frame of the planes' part (3, 1) [mm].
        reach: of the points about it [mm].
        inverse: turn times reach, and shift, per contact residual (6, 6).
        start: the pose about both, nominally (3, 4).
    """

    move: Locate
    middle: Array
    origin: Array
    reach: float
    inverse: Array
    start: Array

    def placed(self, world: World) -> tuple[World, Codes]:
        """The world after the move, and status codes (n,)."""
        move, reference = self.move, world.part_of(self.move.pairs[0].target)
        contacts = [_contact(move, pair, world, reference) for pair in move.pairs]
        points = _stacked([point for point, _, _, _ in contacts])
        points -= self.middle
        normals = _stacked([normal for _, _, normal, _ in contacts])
        heights = _stacked([dot(normal, foot - self.origin) + up for _, foot, normal, up in contacts])
        for pair in move.pairs:
            world.forget(pair.moving)
        turn, shift = np.empty((3, 3, world.trials)), np.empty((3, world.trials))
        met = np.empty(world.trials, dtype=bool)
        contacts_met(points, normals, heights, self.inverse, self.start, self.reach, turn, shift, met)
        found = Pose(turn, shift + self.origin - rotated(turn, self.middle))
        pose = world.poses[reference] @ (found if move.points_on == "part" else found.inverse)
        return world.with_part_at(move.part, pose), np.where(met, OK, SINGULAR).astype(np.int8)

    def asked(self, assembly: Assembly, middle: Array) -> Iterator[Asked]:
        """Contacts with one normal together."""
        move, groups = self.move, list[list[tuple[Pair, Array]]]()
        for pair in move.pairs:
            stays = pair.target if move.points_on == "part" else pair.moving
            normal = assembly.part[assembly.features[stays].part].pose[:3, :3] @ pair.normal
            if groups and np.linalg.norm(groups[-1][-1][1] - normal) < SAME:
                groups[-1].append((pair, normal))
            else:
                groups.append([(pair, normal)])
        in_order = [len(group) for group in groups] == [3, 2, 1]
        first = 1
        for k, group in enumerate(groups):
            last = first + len(group) - 1
            name = ORDER[k] if in_order else f"contact {first}" if first == last else f"contacts {first} to {last}"
            points = [own.moving if move.points_on == "part" else own.target for own, _ in group]
            rows = [
                point_rows(frame_in_world(assembly, at)[:3, 3] - middle, own[1][None])
                for at, own in zip(points, group, strict=True)
            ]
            targets = dict.fromkeys(touched(assembly, own.target) for own, _ in group)
            moving = dict.fromkeys(touched(assembly, own.moving) for own, _ in group)
            yield Asked(f"{name}: {listed(list(moving))} on {listed(list(targets))}", np.concatenate(rows))
            first = last + 1


def locating(move: Locate, nominal: World) -> Locating:
    """A move on six locators.

    Args:
        move: the move.
        nominal: the world before it without deviations, the part at its nominal pose.

    Raises:
        InputError: the contacts leave a freedom.
    """
    reference = nominal.part_of(move.pairs[0].target)
    contacts = [_contact(move, pair, nominal, reference) for pair in move.pairs]
    points = np.array([point[:, 0] for point, _, _, _ in contacts])
    normals = np.array([normal[:, 0] for _, _, normal, _ in contacts])
    middle = points.mean(axis=0)
    reach = max(float(np.linalg.norm(points - middle, axis=1).max()), 1.0)
    relative = nominal.poses[reference].inverse @ nominal.poses[move.part]
    start = relative if move.points_on == "part" else relative.inverse
    turn, shift = start.turn[:, :, 0], start.shift[:, 0]
    arms = (points - middle) @ turn.T
    rows = np.hstack([np.cross(arms, normals) / reach, normals])
    _refuse_free(move, nominal, reference, normals, turn @ middle + shift, arms)
    return Locating(
        move,
        column(middle),
        column(turn @ middle + shift),
        reach,
        np.ascontiguousarray(np.linalg.inv(rows)),
        np.ascontiguousarray(np.column_stack([turn, np.zeros(3)])),
    )


def _refuse_free(move: Locate, nominal: World, reference: str, normals: Array, middle: Array, arms: Array) -> None:
    """Refuse contacts that leave a freedom, named in the world."""
    reach = max(float(np.linalg.norm(arms, axis=1).max()), 1.0)
    frame = nominal.poses[reference if move.points_on == "part" else move.part]
    turn, shift = frame.turn[:, :, 0], frame.shift[:, 0]
    arms, normals = arms @ turn.T, normals @ turn.T
    motions = free_motions(np.hstack([normals, np.cross(arms, normals)]), turn @ middle + shift, reach)
    if len(motions):
        raise InputError(
            f"moves.{move.name}: its six contacts leave {move.part} free: {in_words(motions)}; "
            "expected contacts that hold all six freedoms"
        )


def _contact(move: Locate, pair: Pair, world: World, reference: str) -> tuple[Array, Array, Array, Array]:
    """Point, foot, normal (3, n) and height over the foot (n,) of a contact: normal . (pose point - foot) = height."""
    height = total(pair.locator, 1, world.columns)[0]
    if move.points_on == "fixture":
        target, (foot, inward) = world.on_part(pair.target), side_of(pair, move, world)
        if (part := world.part_of(pair.target)) != reference:
            target = target.moved(world.poses[reference].inverse @ world.poses[part])
        return target.origin, foot, inward, -height
    foot, normal = side_of(pair, move, world)
    if (part := world.part_of(pair.target)) != reference:
        relative = world.poses[reference].inverse @ world.poses[part]
        foot, normal = relative.point(foot), rotated(relative.turn, normal)
    return world.on_body(pair.moving, move.part).origin, foot, normal, height


def side_of(pair: Pair, move: Locate | Rest, world: World) -> tuple[Array, Array]:
    """Point and tilted normal (3, n) of the plane of a contact, on the side that has the plane.

    In the frame of the target's part; with points on the fixture in that of the placed part. A point of no plane has
    the normal of the pair.
    """
    if move.points_on == "part":
        name = world.assembly.features[pair.target].plane
        side, sign = world.on_part(name or pair.target), 1.0
    else:
        name = world.assembly.features[pair.moving].plane
        side, sign = world.on_body(name or pair.moving, move.part), -1.0
    return side.origin, sign * side.direction if name else column(pair.normal)


def _stacked(arrays: Sequence[Array]) -> Array:
    """Arrays of all contacts, (6, ..., n) or (6, ..., 1)."""
    trials = max(array.shape[-1] for array in arrays)
    found = np.empty((len(arrays), *arrays[0].shape[:-1], trials))
    for place, own in zip(found, arrays, strict=True):
        place[...] = own
    return found
