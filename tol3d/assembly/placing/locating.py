"""Parts on six locators, 3-2-1 or six planes: what their contacts ask, trial by trial."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Locate, Pair, Rest
from tol3d.assembly.model.statuses import OK, SINGULAR
from tol3d.assembly.placing.actual_feature import total
from tol3d.assembly.placing.contacts import contacts_met
from tol3d.assembly.placing.free_motion import free_motions, in_words
from tol3d.assembly.placing.poses import Codes, Pose, column, dot, rotated
from tol3d.assembly.placing.world import World
from tol3d.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Locating:
    """A move on six locators, as its contacts are nominally.

    What the points ride on is found in the frame of what the planes stay with: of the first target's part, or of the
    part that is placed, where points are on the fixture.

    Args:
        move: which.
        middle: of the points, in the frame of what they ride on (3, 1) [mm].
        origin: where that lies in the frame of what the planes stay with (3, 1) [mm].
        reach: of the points about it [mm].
        inverse: turn times reach, and shift, of what the contacts lack (6, 6).
        start: the pose about both, nominally (3, 4).
    """

    move: Locate
    middle: Array
    origin: Array
    reach: float
    inverse: Array
    start: Array

    def placed(self, world: World) -> tuple[World, Codes]:
        """The world after the move, and what became of it (n,)."""
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


def locating(move: Locate, nominal: World) -> Locating:
    """A move on six locators.

    Args:
        move: which.
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
    """Refuse contacts that leave a freedom, said in the world."""
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
    """Of the side of a contact on which its plane is, a point of that and its normal as it tilts (3, n).

    In the frame of the target's part; with points on the fixture in that of the part that is placed. What is no point
    of a plane has the normal of the pair.
    """
    if move.points_on == "part":
        name = world.assembly.features[pair.target].plane
        side, sign = world.on_part(name or pair.target), 1.0
    else:
        name = world.assembly.features[pair.moving].plane
        side, sign = world.on_body(name or pair.moving, move.part), -1.0
    return side.origin, sign * side.direction if name else column(pair.normal)


def _stacked(arrays: Sequence[Array]) -> Array:
    """Of all contacts, (6, ..., n) or (6, ..., 1)."""
    trials = max(own.shape[-1] for own in arrays)
    found = np.empty((len(arrays), *arrays[0].shape[:-1], trials))
    for place, own in zip(found, arrays, strict=True):
        place[...] = own
    return found
