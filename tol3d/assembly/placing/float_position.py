"""Position of a part with play within its clearance, from its centred pose: see model.Floating."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.assembly.model import Engage
from tol3d.assembly.placing.actual_feature import ActualFeature
from tol3d.assembly.placing.play_rooms import Push
from tol3d.assembly.placing.poses import Pose, column
from tol3d.assembly.placing.world import World
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array

NEWTONS: Final = 12
"""Steps to the angle of a segment, from the cube root's: 5 reach rounding, more if it is small."""
SEES: Final = 1e-4
"""Share of a shift or turn of length 1 that freedoms let it have, and counts as some."""
PART: Final = 1e-6
"""Change of an offset per unit freedom that counts as none."""


@dataclass(frozen=True, eq=False)
class Floats:
    """Float of a move.

    Args:
        move: the move.
        freedoms: (6, freedoms), orthonormal.
        along: direction in the world in which its point is pushed to the limit (3,); 0 for none.
        push: the direction of the freedoms in which the part is pushed to the limit (freedoms,), that of the nominal
            point where one is; None where it is not pushed.
        turn: of the part as it lies nominally (3, 3).
        by_pairs: True for a random float pin by pin.
    """

    move: Engage
    freedoms: Array
    along: Array
    push: Array | None
    turn: Array
    by_pairs: "Discs | None" = None

    def at_support_point(self, push: Array) -> "Floats":
        """The float pushed to the limit along a direction of the freedoms (freedoms,); centred along 0."""
        return Floats(self.move, self.freedoms, np.zeros(3), np.ascontiguousarray(push), self.turn)

    def goal(self, world: World, origin: Array) -> Push | None:
        """The goal of a part that is pushed; None for any other.

        Args:
            world: before the move.
            origin: the middle of all places in the part's frame (3,) [mm].
        """
        if self.push is None or not self.push.any():
            return None
        point = _pushed_point(self.move, world).origin - column(origin) if self.along.any() else np.zeros((3, 1))
        return Push(self.push, point, self.along, self.turn)

    def sweeps(self, world: World) -> tuple[Array, Array] | None:
        """Axes of the room (freedoms, freedoms) and uniforms (sweeps * freedoms, n) of a random float; else None."""
        floating = self.move.floating
        if self.push is not None or floating.kind != "random" or self.by_pairs is not None:
            return None
        order, axes = axes_of(self.freedoms)
        bolts = sum(engagement.bolt is not None for engagement in self.move.engagements)
        return axes, floating.sweeps(world.columns[floating.columns], order, bolts)


def axes_of(freedoms: Array) -> tuple[Sequence[int], Array]:
    """Axes of a room (freedoms, freedoms) by shift and turn, and which of these (6) each stands for.

    The same whatever basis (6, freedoms) the freedoms have: projections of x, y, z, of turns about them, each less its
    part along those before it.
    """
    order, found = [], np.zeros((freedoms.shape[1], 0))
    for k, own in enumerate(freedoms):
        left = own - found @ (found.T @ own)
        size = float(np.linalg.norm(left))
        if size > SEES and found.shape[1] < len(found):
            order.append(k)
            found = np.column_stack([found, left / size])
    return order, np.ascontiguousarray(found.T)


def _pushed_point(move: Engage, world: World) -> ActualFeature:
    """The feature pushed along a direction, in the part's frame; nominal if it belongs to no such part."""
    at, part = move.floating.at, move.part
    if world.part_of(at) in world.bodies[part]:
        return world.on_body(at, part)
    return world.placed(at).moved(Pose.of(world.assembly.part[part].pose).inverse)


def floats_of(move: Engage, world: World, freedoms: Array, rows: Array, middle: Array, reach: float) -> Floats:
    """Float of a part within its clearance.

    Args:
        move: the move.
        world: nominal, with the part as placed by its relations.
        freedoms: shift of the middle and turn times reach (6, freedoms).
        rows: B_k (cones, 2, freedoms).
        middle: (3,) [mm].
        reach: [mm].

    Raises:
        InputError: the part has no play along the direction.
    """
    floating, along, push = move.floating, np.zeros(3), None
    turn = np.ascontiguousarray(world.poses[move.part].turn[:, :, 0])
    if floating.kind == "toward":
        assert floating.along is not None
        along = np.ascontiguousarray(world.poses[world.part_of(floating.at)].turn[:, :, 0] @ floating.along)
        arm = world.placed(floating.at).origin[:, 0] - middle
        push = np.concatenate([along, np.cross(arm, along) / reach]) @ freedoms
        if np.abs(push).max(initial=0.0) < PART:
            raise InputError(f"moves.{move.name}: {floating.at} does not move along its direction: it is held there")
    if not freedoms.shape[1]:  # relations hold the part: it has no place to float to
        return Floats(move, freedoms, along, np.zeros(0), turn)
    discs = discs_of(move, rows) if floating.kind == "random" and floating.by_pairs else None
    return Floats(move, freedoms, along, push, turn, discs)


@dataclass(frozen=True, eq=False)
class Discs:
    """A pin anywhere in its hole, then a second one anywhere in the rest of its slot.

    Args:
        inverse: of what the hole sees: the middle of both ends, or one end after the other (freedoms, 2 or 4).
        turn: the freedom that the slot has left (freedoms,), by which what is seen of the pin across it falls; None
            without one.
    """

    inverse: Array
    turn: Array | None

    def steps(self, offsets: Array, clearances: Array, rows: Array, drawn: Array) -> Array:
        """Steps (freedoms, n) from a pose to where pins are drawn.

        Args:
            offsets, clearances: o_k (cones, 2, n), c_k (cones, n) of the pose [mm].
            rows: B_k (cones, 2, freedoms).
            drawn: (draws, n).
        """
        at = offsets
        if self.inverse.shape[1] == 4:
            lacking = [clearances[k] * drawn[2 * k + r] - at[k][r] for k in (0, 1) for r in (0, 1)]
        else:
            apart = [(at[0][r] - at[1][r]) / 2 for r in (0, 1)]
            goal = in_lens(apart[0], apart[1], clearances[0], drawn[0], drawn[1])
            lacking = [goal[r] - (at[0][r] + at[1][r]) / 2 for r in (0, 1)]
        found = np.stack([_along(own, lacking) for own in self.inverse])
        if self.turn is None:
            return found
        low, high = np.full(offsets.shape[2], -np.inf), np.full(offsets.shape[2], np.inf)
        for k in range(2, len(rows)):
            gain = float(rows[k, 0] @ self.turn)
            middle = -(offsets[k, 0] + _along(rows[k, 0], found)) / gain
            half = clearances[k] / abs(gain)
            low, high = np.maximum(low, middle - half), np.minimum(high, middle + half)
        share = (low + high) / 2 + drawn[-1] * np.maximum(high - low, 0.0) / 2
        return np.asarray(found + self.turn[:, None] * share)


def _along(row: Array, steps: Sequence[Array] | Array) -> Array:
    return np.asarray(sum((row[f] * steps[f] for f in range(len(row))), np.zeros(1)))


def discs_of(move: Engage, rows: Array) -> Discs:
    """Discs of a pin in its hole and of the next in its slot, by their rows over the freedoms.

    Raises:
        InputError: relations hold one tilt of the hole and not the other, or the slot does not hold one turn.
    """
    floating, (_, *others) = move.floating, move.engagements
    alone = floating.columns.stop - floating.columns.start - len(others) == 4
    seen = rows[:2].reshape(4, -1) if alone else rows[:2].mean(axis=0)
    left, sizes, right = np.linalg.svd(seen)
    rank = int(np.sum(sizes > PART))
    tilts = np.linalg.matrix_rank(rows[:2].reshape(4, -1), PART)
    if rank != len(left) or (not alone and tilts != 2):
        raise InputError(
            f"moves.{move.name}: a random float needs relations that hold both tilts of its first pin, or none; "
            "take a pattern"
        )
    free, turn = right[rank:], None
    if others:
        held = rows[2:, 0] @ free.T
        if free.shape[0] != 1 or np.abs(held).min(initial=np.inf) < PART:
            raise InputError(f"moves.{move.name}: a random float needs a slot that holds the turn; take a pattern")
        turn = -free[0] if held[0, 0] > 0.0 else free[0]
    return Discs(np.asarray(np.linalg.pinv(seen)), turn)


def in_lens(x: Array, y: Array, clearance: Array, u: Array, v: Array) -> tuple[Array, Array]:
    """Points of the lens that two discs share, as a point of the disc of radius 1 maps to it, areas kept.

    Along the line of the centres a segment of the lens beyond a point has the share of that of the disc; across, the
    shares of the chords are the same.

    Args:
        x, y: from the middle to one centre (n,) [mm]; the other lies opposite.
        clearance: radius of both discs (n,) [mm].
        u, v: of the disc (n,).
    """
    length = np.sqrt(x * x + y * y)
    some = length > 0.0
    a, b = np.where(some, x / np.where(some, length, 1.0), 1.0), np.where(some, y / np.where(some, length, 1.0), 0.0)
    along, across = u * a + v * b, v * a - u * b
    along = np.where(np.abs(along) <= 1.0, along, np.nan)  # off the disc of radius 1: invalid
    share = np.minimum(length / np.where(clearance > 0.0, clearance, 1.0), 1.0)
    cut = _segment(np.abs(along)) / (np.pi / 2) * _segment(share)
    angle = np.minimum(np.cbrt(12 * cut), np.pi)  # of the segment: (angle - sin angle) / 2 is its area
    for _ in range(NEWTONS):
        slope = 1 - np.cos(angle)
        off = (angle - np.sin(angle) - 2 * cut) / np.where(slope > 0.0, slope, 1.0)
        angle = angle - np.where(slope > 0.0, off, 0.0)
    out = np.where(along == 0.0, share, np.cos(angle / 2))
    chord = np.sqrt(np.maximum(1 - along * along, 0.0))
    aside = across / np.where(chord > 0.0, chord, 1.0) * np.sqrt(np.maximum(1 - out * out, 0.0))
    forth = np.copysign(np.maximum(out - share, 0.0), along)
    return clearance * (forth * a - aside * b), clearance * (forth * b + aside * a)


def _segment(height: Array) -> Array:
    """Area of a disc's segment beyond a height, radius 1."""
    return np.asarray(np.arccos(height) - height * np.sqrt(np.maximum(1 - height * height, 0.0)))
