"""Sequential alignment: features laid on their targets in order, each by the freedoms that those before it left.

The freedoms are analysed once, on the nominal geometry (`freedoms.aligned`); the resulting steps are vectorised over
trials (`Alignment.poses`). Rotations follow from directions first; heights are met by shifts, solved in order along
directions free of earlier ones, so that earlier ones stay met. Freedoms taken by none stay nominal: least rotation, and
no shift of the centre about which a feature turns, its own in the trial. So the origin of the moving frame does not
matter.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from tol3d.assembly.model.feature import Held, Turning
from tol3d.assembly.model.statuses import NO_CONTACT, OK, SINGULAR
from tol3d.assembly.placing.actual_feature import ActualFeature
from tol3d.assembly.placing.poses import (
    IDENTITY,
    Codes,
    Pose,
    about,
    column,
    cross,
    dot,
    least_rotation,
    product,
    rotated,
    rotated_back,
    unit,
)
from tol3d.numerics.arrays import Array

ROUNDS = 6
"""Repetitions of a turn and the shifts that follow it where targets are tilted: each leaves their slope times as much,
1e-3 or less."""

_MET: Codes = np.full(1, OK, dtype=np.int8)
_LOST = 1e-6  # sine: a freedom with less left is held


@dataclass(frozen=True)
class Tie:
    """Constraint by one feature.

    Args:
        name: used in messages.
        held: of its point.
        turning: of its direction.
    """

    name: str
    held: Held
    turning: Turning = "none"


@dataclass(frozen=True, eq=False)
class Seat:
    """A tie in its trials.

    Args:
        point: in the frame that is moved (3, n) [mm]; about it the tie turns what it turns, where shifts are free.
        target: the point over, around or at which it is to lie (3, n) [mm].
        direction: of the feature, in the frame that is moved (3, n), of unit length; None without a direction.
        toward: the target's direction (3, n), of unit length; None of a point.
        height: over the target, along its direction (n,) [mm].
        outermost: a feature whose outermost point along the direction counts instead of `point`.
        across: a slot or tab, whose place comes before its direction where one turn alone is left to it.
        centre: about which it turns instead of `point` (3, n) [mm].
    """

    point: Array
    target: Array
    direction: Array | None = None
    toward: Array | None = None
    height: Array | float = 0.0
    outermost: ActualFeature | None = None
    across: ActualFeature | None = None
    centre: Array | None = None

    @property
    def its_centre(self) -> Array:
        """Centre of its turns (3, n) [mm]."""
        return self.point if self.centre is None else self.centre

    @property
    def its_direction(self) -> Array:
        """The feature's direction, where there is one."""
        assert self.direction is not None
        return self.direction

    @property
    def its_toward(self) -> Array:
        """The target's direction, where there is one."""
        assert self.toward is not None
        return self.toward


@dataclass(frozen=True)
class Step:
    """A rotation that a tie takes.

    Args:
        kind: aim: its direction becomes the target's by the least rotation; azimuth: as far as a rotation about the
            held direction goes; level: its direction becomes square to the target's by such a rotation; aim at: the
            line from the pivot to its point goes to the target; turn to: by a rotation about the held direction, as
            far as that goes; swing: its height is met by such a rotation, or its point comes nearest; lie: its
            direction becomes square to the target's by the least rotation, and the target's is held; lie between: also
            to that of the pivot's; hold: no rotation, its direction is held.
        tie: the tie.
        pivot: the tie whose point stays, or that lies; -1 where shifts decide in each trial about what it swings.
        owner: the tie for which it is, about whose centre; its own where it is -1.
    """

    kind: Literal["aim", "azimuth", "level", "aim at", "turn to", "swing", "lie", "lie between", "hold"]
    tie: int
    pivot: int = -1
    owner: int = -1

    @property
    def repeated(self) -> bool:
        """True if it uses points, which shifts move."""
        return self.kind in ("aim at", "turn to", "swing")


@dataclass(frozen=True, eq=False)
class Shift:
    """A shift that a tie takes, along a nominal direction (3, 1); along that of the target where it is None."""

    tie: int
    along: Array | None = None


@dataclass(frozen=True, eq=False)
class ShiftDirection:
    """The direction of a shift in the trials.

    Args:
        tie: whose height it meets.
        normal: along which that counts (3, n).
        along: the direction, free of earlier ones (3, n), of unit length.
    """

    tie: int
    normal: Array
    along: Array

    @cached_property
    def steepness(self) -> Array:
        """Height gained per length of the shift (n,)."""
        return dot(self.normal, self.along)


@dataclass(frozen=True, eq=False)
class Alignment:
    """The steps of a sequential alignment.

    Args:
        ties: in order.
        turns: rotations in order, each with the number of shifts that come before it.
        shifts: in order.
        rounds: how often a turn about a pivot is repeated.
        idle: ties that take no freedom, for those before them hold all that they could take.
    """

    ties: tuple[Tie, ...]
    turns: tuple[tuple[Step, int], ...]
    shifts: tuple[Shift, ...]
    rounds: int = ROUNDS
    idle: tuple[int, ...] = ()

    def poses(self, seats: Sequence[Seat], start: Pose) -> tuple[Pose, Codes]:
        """Poses that place features on their targets, and status codes (n,).

        Args:
            seats: one of each tie.
            start: the pose before anything is aligned.
        """
        directions, codes = self.shift_directions(seats)
        turn, shift, held = start.turn, start.shift, column(np.zeros(3))
        for number, (step, shifts_before) in enumerate(self.turns):
            known = directions if number == len(self.turns) - 1 else directions[:shifts_before]
            centre = seats[step.tie if step.owner < 0 else step.owner].its_centre
            for _ in range(self.rounds if step.repeated else 1):
                if step.repeated:
                    turned, held, reached = self._by_point(step, seats, known, Pose(turn, shift), held)
                else:
                    turned, held, reached = _by_direction(step, seats, turn, held)
                codes, before = np.maximum(codes, reached), rotated(turn, centre)
                turn = product(turned, turn)
                shift = shift + (before - rotated(turn, centre))
        return Pose(turn, _shifted(turn, shift, seats, directions)), codes

    def _by_point(
        self, step: Step, seats: Sequence[Seat], directions: Sequence[ShiftDirection], start: Pose, held: Array
    ) -> tuple[Array, Array, Codes]:
        """A rotation by a point, the direction held after it, and status codes."""
        turn, seat = start.turn, seats[step.tie]
        pose = Pose(turn, _shifted(turn, start.shift, seats, directions))
        stays = step.pivot >= 0
        about_own = drift(pose, seats, directions, held, pose.point(seat.its_centre))
        pivot = pose.point(seats[step.pivot].point) if stays else cross(held, about_own)
        point = pose.point(seat.point)
        arm, line = point - pivot, self._target(step.tie, seat, point) - pivot
        if step.kind == "aim at":
            held = unit(line)
            return least_rotation(unit(arm), held), held, _MET
        if step.kind == "turn to":
            return _same_azimuth(held, arm, line), held, _MET
        if self.ties[step.tie].held == "along":
            turned, reached = _met(held, arm, seat.its_toward, dot(seat.its_toward, line) + seat.height)
            return turned, held, reached
        return _nearer(held, arm, line, seat.toward if self.ties[step.tie].held == "across" else None), held, _MET

    def shift_directions(self, seats: Sequence[Seat]) -> tuple[list[ShiftDirection], Codes]:
        """Directions of the shifts in the trials, and whether each still has one (n,)."""
        directions, codes = list[ShiftDirection](), _MET
        for shift in self.shifts:
            seat, held = seats[shift.tie], self.ties[shift.tie].held
            normal = seat.its_toward if shift.along is None else shift.along
            if held == "across":
                normal = normal - dot(normal, seat.its_toward) * seat.its_toward
            along = normal
            for taken in directions:
                along = along - dot(along, taken.along) * taken.along
            codes = np.maximum(codes, np.where(dot(along, along) > _LOST**2 / 4, OK, SINGULAR).astype(np.int8))
            along = unit(along)
            directions.append(ShiftDirection(shift.tie, along if held == "all" else normal, along))
        return directions, codes

    def _target(self, tie: int, seat: Seat, point: Array) -> Array:
        """Target of a point; along an axis, level with the point."""
        if self.ties[tie].held != "across":
            return seat.target
        return seat.target + dot(point - seat.target, seat.its_toward) * seat.its_toward


def drift(pose: Pose, seats: Sequence[Seat], directions: Sequence[ShiftDirection], axis: Array, centre: Array) -> Array:
    """Shift of the world's origin per turn about an axis through a centre, with shifts that keep their constraints.

    Args:
        pose: from which it turns.
        seats: one of each tie.
        directions: of the shifts.
        axis: about which it turns (3, n), of unit length.
        centre: through which the axis goes (3, n) [mm].

    Returns:
        Per turn (3, n) [mm / rad].
    """
    moved = cross(centre, axis)
    for direction in directions:
        rate = dot(direction.normal, moved + cross(axis, pose.point(seats[direction.tie].point)))
        moved = moved - rate / direction.steepness * direction.along
    return moved


def _shifted(turn: Array, start: Array, seats: Sequence[Seat], directions: Sequence[ShiftDirection]) -> Array:
    """The shift (3, n) that meets heights one after the other."""
    shift = start
    for direction in directions:
        seat = seats[direction.tie]
        height = dot(direction.normal, rotated(turn, seat.point) + shift - seat.target)
        if seat.outermost is not None:
            height = height + seat.outermost.rise(rotated_back(turn, direction.normal))
        shift = shift + (seat.height - height) / direction.steepness * direction.along
    return shift


def _by_direction(step: Step, seats: Sequence[Seat], turn: Array, held: Array) -> tuple[Array, Array, Codes]:
    """A rotation by a direction, the direction held after it, and status codes."""
    seat = seats[step.tie]
    own, toward = rotated(turn, seat.its_direction), seat.its_toward
    match step.kind:
        case "aim":
            return least_rotation(own, toward), toward, _MET
        case "azimuth":
            return _same_azimuth(held, own, toward), held, _MET
        case "level":
            turned, reached = _met(held, own, toward, np.zeros(1))
            return turned, held, reached
        case "lie":
            return least_rotation(own, unit(own - dot(own, toward) * toward)), toward, _MET
        case "lie between":
            goal = unit(cross(seats[step.pivot].its_toward, toward))
            return least_rotation(own, np.where(dot(own, goal) < 0, -goal, goal)), toward, _MET
    return IDENTITY.turn, own, _MET


def _same_azimuth(axis: Array, start: Array, end: Array) -> Array:
    """Rotations about an axis (3, n) that bring a vector to the azimuth of another."""
    start = start - dot(start, axis) * axis
    end = end - dot(end, axis) * axis
    cos, sin = dot(start, end), dot(axis, cross(start, end))
    length = cos * cos + sin * sin
    some = length > 0
    length = np.sqrt(np.where(some, length, 1.0))
    return about(axis, np.where(some, cos / length, 1.0), np.where(some, sin / length, 0.0))


def _nearer(axis: Array, arm: Array, line: Array, along: Array | None) -> Array:
    """Rotations about an axis by Newton's step to where an arm's end is nearest to that of a line.

    Args:
        axis: (3, n), of unit length.
        arm, line: from a point of the axis (3, n) [mm].
        along: in which their distance does not count (3, n), if there is one.
    """
    lacking, motion = arm - line, cross(axis, arm)
    bend = cross(axis, motion)
    if along is not None:
        lacking, motion = lacking - dot(lacking, along) * along, motion - dot(motion, along) * along
    square = dot(motion, motion)
    curvature = square + dot(lacking, bend)
    angle = -dot(lacking, motion) / np.where(curvature > 0, curvature, square)
    cos = 1.0 / np.sqrt(1.0 + angle * angle)
    return about(axis, cos, angle * cos)


def _met(axis: Array, arm: Array, normal: Array, height: Array) -> tuple[Array, Codes]:
    """Rotations about an axis after which normal . arm = height, the one nearer to none; code `no contact` without.

    a cos + b sin = k, a and b the arm's parts along the normal before and after a quarter turn, k what the axis leaves.
    """
    lasting = dot(axis, normal) * dot(axis, arm)
    a, b, k = dot(normal, arm) - lasting, dot(normal, cross(axis, arm)), height - lasting
    square = a * a + b * b
    rest = square - k * k
    reached = (rest >= 0) & (square > 0)
    root = np.copysign(np.sqrt(np.where(reached, rest, 0.0)), b)
    safe = np.where(reached, square, 1.0)
    cos = np.where(reached, (a * k + b * root) / safe, 1.0)
    sin = np.where(reached, (b * k - a * root) / safe, 0.0)
    return about(axis, cos, sin), np.where(reached, OK, NO_CONTACT).astype(np.int8)
