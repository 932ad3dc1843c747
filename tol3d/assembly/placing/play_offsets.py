"""Offsets and clearances at a part's engagements at finite poses, and the forces by which they change with the pose.

Poses are about the middle of all places: R p + t with p from the middle in the part, t from where that lies nominally.
Arrays have the trial last, with 1 for what trials share.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final, NamedTuple, Self

import numpy as np

from tol3d.assembly.model import Engage, Engagement
from tol3d.assembly.placing.actual_feature import ActualFeature, mating_size, total
from tol3d.assembly.placing.poses import Pose, column, cross, dot, rotated
from tol3d.assembly.placing.world import World
from tol3d.contact.seat import taken
from tol3d.numerics.arrays import Array, Places

ENDS: Final = 4
"""Ends of both holes of a bolt; and its unknowns: two shifts and two leans."""


class Seen(NamedTuple):
    """Offset of a place: by how much (n,) [mm], and how it changes with a motion of the part and of a bolt.

    Args:
        offset: as it is.
        arm, force: it changes as a point at an arm from the middle of the part moves along a force (3, n).
        moment: and with the turn [mm] (3, n); None for nothing more.
        bolt: and with the shifts and leans of the bolt (4, n); None without one.
    """

    offset: Array
    arm: Array
    force: Array
    moment: Array | None = None
    bolt: Array | None = None


@dataclass(frozen=True, eq=False)
class _Place:
    """A place where a part engages.

    Args:
        moving: the point of the part, from the middle in its frame (3, n) [mm].
        fixed: that of what it engages, from the middle in the world (3, n) [mm].
        axes: directions of offsets (3, n), in the frame of the inner one: of the part, or of the world.
        other: direction of the outer one, or of a bolt's hole, the same way (3, n).
        inner, outer: half of their sizes (n,) [mm].
        inner_moves: True where the inner one is of the part.
    """

    moving: Array
    fixed: Array
    axes: tuple[Array, ...]
    other: Array
    inner: Array
    outer: Array
    inner_moves: bool

    def of(self, trials: Places) -> Self:
        """The same in some trials."""
        return replace(
            self, moving=taken(self.moving, trials), fixed=taken(self.fixed, trials), other=taken(self.other, trials),
            inner=taken(self.inner, trials), outer=taken(self.outer, trials),
            axes=tuple(taken(axis, trials) for axis in self.axes),
        )  # fmt: skip

    def unturned(self, pose: Pose, nominal: Array, offsets: Array) -> Array:
        """Offsets (2, n) in axes turned back with the part about the hole's, as near as may be to where they lie.

        Args:
            pose: of the part.
            nominal: turn of the part as it lies nominally (3, 3, 1).
            offsets: in the axes at the pose.
        """
        if not self.inner_moves or len(self.axes) < 2:
            return offsets
        x, own = rotated(pose.turn, self.axes[0]), rotated(nominal, self.axes[0])
        a, b = dot(x, own), dot(rotated(pose.turn, self.axes[1]), own)
        length = np.sqrt(a * a + b * b)
        return np.stack([(a * offsets[0] + b * offsets[1]) / length, (a * offsets[1] - b * offsets[0]) / length])

    def _carried(self, pose: Pose, direction: Array, moves: bool) -> Array:
        return rotated(pose.turn, direction) if moves else direction


class InHole(_Place):
    """An end of a pin in a hole, whose two offsets are across the hole."""

    def seen(self, pose: Pose, bolts: Array) -> tuple[Array, list[Seen]]:
        """Clearance (n,) [mm], and offsets: of the outer one from the inner one."""
        turned = rotated(pose.turn, self.moving)
        apart, arm = turned + pose.shift - self.fixed, turned
        if self.inner_moves:
            apart, arm = -apart, self.fixed - pose.shift
        offsets = []
        for axis in self.axes:
            normal = self._carried(pose, axis, self.inner_moves)
            offsets.append(Seen(dot(normal, apart), arm, -normal if self.inner_moves else normal))
        return self.inner - self.outer, offsets


@dataclass(frozen=True, eq=False)
class InSlot(InHole):
    """An end of a tab or pin in a slot, whose one offset is across the slot; one that leans takes less or more of it.

    Args:
        share: part of the outer one's half that the slot sees, and its change, by the cosine of their directions.
    """

    share: Callable[[Array], tuple[Array, Array]]

    def seen(self, pose: Pose, bolts: Array) -> tuple[Array, list[Seen]]:
        """Clearance (n,) [mm], and the offset.

        |o + B q| <= c + C q is on the side of o the same as |o + (B - C o / |o|) q| <= c.
        """
        _, (own,) = super().seen(pose, bolts)
        normal = self._carried(pose, self.axes[0], self.inner_moves)
        other = self._carried(pose, self.other, not self.inner_moves)
        share, slope = self.share(dot(normal, other))
        gain = self.outer * slope  # less of the clearance, by the cosine of both directions
        gain = np.where((own.offset < 0.0) != self.inner_moves, -gain, gain)
        # a turn w of the one that moves changes the cosine by w . (other x normal), or by less that
        return self.inner - self.outer * share, [own._replace(moment=gain * cross(other, normal))]


@dataclass(frozen=True, eq=False)
class BoltInHole(_Place):
    """An end of a hole over a bolt that is loose in it.

    Args:
        number: of the bolt.
        frame: its middle from that of all places in the world, two directions across it, that along it, each (3, 1).
        reach: distance over which its tilt counts [mm].
    """

    number: int
    frame: tuple[Array, ...]
    reach: float

    def seen(self, pose: Pose, bolts: Array) -> tuple[Array, list[Seen]]:
        """Clearance (n,) [mm], and offsets of the bolt's axis across that of the hole, where it passes the hole's end.

        The bolt's axis passes base + h n + (p + h l / its reach) across n, h along its nominal direction n.
        """
        base, x, y, ahead = self.frame
        end = rotated(pose.turn, self.moving) + pose.shift if self.inner_moves else self.fixed
        height, (p, q, lean_x, lean_y) = dot(ahead, end - base), bolts[self.number]
        share = height / self.reach
        point = base + height * ahead + x * (p + share * lean_x) + y * (q + share * lean_y)
        along, way = self._carried(pose, self.other, self.inner_moves), ahead + (x * lean_x + y * lean_y) / self.reach
        lean, arm, apart, offsets = dot(along, way), point - pose.shift, point - end, []
        for axis in self.axes:
            normal = self._carried(pose, axis, self.inner_moves)
            normal = normal - dot(normal, way) / lean * along
            by_x, by_y = dot(normal, x), dot(normal, y)
            force = -normal if self.inner_moves else np.zeros((3, 1))
            by_bolt = np.stack([by_x, by_y, share * by_x, share * by_y])
            offsets.append(Seen(dot(normal, apart), arm, force, bolt=by_bolt))
        return self.inner - self.outer, offsets


EngagedPlace = InHole | BoltInHole


def engaged_places(move: Engage, world: World, origin: Array, middle: Array) -> list[EngagedPlace]:
    """Places of a move's engagements, by trial.

    Args:
        move: the move.
        world: before it.
        origin: the middle of all places in the part's frame (3,) [mm].
        middle: that in the world (3,) [mm].
    """
    found, number, none = list[EngagedPlace](), 0, np.zeros((3, 1))
    for engagement in move.engagements:
        if engagement.bolt is not None:
            half = (engagement.bolt.diameter + total(engagement.bolt.size_by, 1, world.columns)[0]) / 2
            turn = engagement.bolt.frame[:3, :3]
            frame = tuple(column(each) for each in (engagement.bolt.frame[:3, 3] - middle, *turn.T))
            for name, places in ((engagement.inner, engagement.places), (engagement.outer, engagement.outer_places)):
                moves = world.part_of(name) in world.bodies[move.part]
                hole = world.on_body(name, move.part) if moves else world.placed(name)
                axes, size = hole.pose.turn, mating_size(hole.feature, world.columns) / 2
                for end in (hole.at(place) for place in places):
                    moving, fixed = (end - column(origin), none) if moves else (none, end - column(middle))
                    at = moving, fixed, (axes[:, 0], axes[:, 1]), axes[:, 2]
                    found.append(BoltInHole(*at, size, half, moves, number, frame, engagement.bolt.reach))
            number += 1
            continue
        moves = world.part_of(engagement.inner) in world.bodies[move.part]
        inner, outer = (
            world.on_body(name, move.part) if own_moves else world.placed(name)
            for name, own_moves in ((engagement.inner, moves), (engagement.outer, not moves))
        )
        half_inner, half_outer = (mating_size(each.feature, world.columns) / 2 for each in (inner, outer))
        for place, its in zip(engagement.places, engagement.outer_places, strict=True):
            points = inner.within(place), outer.at(its)
            moving, fixed = points if moves else points[::-1]
            moving, fixed = moving - column(origin), fixed - column(middle)
            common = moving, fixed, inner.axes
            if len(inner.axes) == 2:
                found.append(InHole(*common, none, half_inner, half_outer, moves))
            else:
                found.append(InSlot(*common, outer.direction, half_inner, half_outer, moves, outer.seen))
    return found


def at_places(
    engagement: Engagement, inner: ActualFeature, outer: ActualFeature, columns: Array
) -> list[tuple[list[Array], Array]]:
    """Offsets (one or two) and clearance at each place (n,) or (1,)."""
    inside, outside = mating_size(inner.feature, columns), mating_size(outer.feature, columns)
    along = dot(inner.direction, outer.direction)
    taken_up = outside if len(inner.axes) == 2 else outside * outer.seen(along)[0]
    found = []
    for place, its in zip(engagement.places, engagement.outer_places, strict=True):
        apart = outer.at(its) - inner.within(place)
        found.append(([dot(axis, apart) for axis in inner.axes], (inside - taken_up) / 2))
    return found
