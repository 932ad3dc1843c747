"""Freedoms that each feature takes of those left by earlier ones: the nominal analysis of a sequential alignment."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tol3d.assembly.placing.alignment import Alignment, Seat, Shift, Step, Tie, drift
from tol3d.assembly.placing.poses import Pose, column, cross
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array

HELD = 1e-6
"""Sine of an angle, or lever [mm], below which a freedom counts as held."""


def aligned(ties: Sequence[Tie], seats: Sequence[Seat], start: Pose) -> Alignment:
    """The steps by which features are placed on their targets.

    Args:
        ties: in order.
        seats: nominally.
        start: the nominal pose before anything is aligned.

    Raises:
        InputError: a tie that turns by more than 90 deg, or that cannot be met in order.
    """
    freedoms = _Freedoms(tuple(ties), tuple(seats), start)
    idle = tuple(tie for tie in range(len(ties)) if not freedoms.take(tie))
    freedoms.lay_down()
    return replace(freedoms.alignment, idle=idle)


class _Freedoms:
    """The freedoms left, tie by tie."""

    def __init__(self, ties: tuple[Tie, ...], seats: tuple[Seat, ...], start: Pose) -> None:
        self.ties, self.seats, self.start = ties, seats, start
        self.turns: list[tuple[Step, int]] = []
        self.shifts: list[Shift] = []
        self.taken = np.zeros((0, 3))  # directions of shifts, orthonormal
        self.turning: Array | str = "all"  # or the direction about which a turn is left, or "none"
        self.pivot = -1
        self.lying = -1  # what is to lie square to its target's direction, while nothing else turns

    @property
    def alignment(self) -> Alignment:
        return Alignment(self.ties, tuple(self.turns), tuple(self.shifts))

    def take(self, index: int) -> bool:
        """Take the freedoms that a tie constrains; True if any were left."""
        tie, before = self.ties[index], (len(self.turns), len(self.shifts), self.lying)
        if self._by_place(index):
            self._turn_by_point(index, taken_before=False)
        elif tie.held == "along":
            self._turn_by_direction(index)
            if not self._shift(index):
                self._turn_by_point(index, taken_before=(len(self.turns), self.lying) != (before[0], before[2]))
        else:
            pivot, placed = self.pivot, self._shift(index)
            if not isinstance(self.turning, str) or (pivot >= 0 and not placed):
                self._turn_by_point(index, taken_before=False)
            self._turn_by_direction(index)
        if self.pivot < 0 and tie.held != "along" and self._centred:
            self.pivot = index
        return (len(self.turns), len(self.shifts), self.lying) != before

    def lay_down(self) -> None:
        """Lay the tie that still has to lie, as nothing else turns."""
        if self.lying >= 0 and isinstance(self.turning, str):
            self._turn(Step("lie", self.lying))

    @property
    def _centred(self) -> bool:
        """True if all shifts across the turning axis are taken."""
        if isinstance(self.turning, str):
            return len(self.taken) == 3
        across = np.eye(3) - np.outer(self.turning, self.turning)
        return bool(np.linalg.norm(self._free @ across) < HELD)

    @property
    def _free(self) -> Array:
        return np.asarray(np.eye(3) - self.taken.T @ self.taken)

    def _pose(self) -> Pose:
        return self.alignment.poses(self.seats, self.start)[0]

    def _turn_by_direction(self, index: int) -> None:
        tie, seat = self.ties[index], self.seats[index]
        if tie.turning == "none" or (isinstance(self.turning, str) and self.turning == "none"):
            return
        start = self._pose().turn[:, :, 0] @ seat.its_direction[:, 0]
        end = seat.its_toward[:, 0]
        if isinstance(self.turning, str):
            if tie.turning == "level" or self.lying >= 0:
                self._turn_lying(index, start, end)
                return
            if start @ end < HELD:
                raise InputError(
                    f"{tie.name} lies {np.degrees(np.arccos(np.clip(start @ end, -1, 1))):.0f} deg from its target: "
                    "expected less than 90 deg; turn the nominal pose"
                )
            self._turn(Step("aim", index))
            self.turning = end
            return
        across = start if tie.turning == "level" else end
        if np.linalg.norm(np.cross(across, self.turning)) < HELD:
            return
        if tie.turning == "level" and abs(np.cross(self.turning, start) @ end) < HELD:
            return
        self._turn(Step("level" if tie.turning == "level" else "azimuth", index))
        self.turning = "none"

    def _turn_lying(self, index: int, start: Array, end: Array) -> None:
        """A direction that comes to lie, or one that is aimed while another lies; `start` and `end` are its own."""
        earlier = self.lying
        if earlier < 0:
            self.lying = index
            return
        axis = self._pose().turn[:, :, 0] @ self.seats[earlier].its_direction[:, 0]
        normal = self.seats[earlier].its_toward[:, 0]
        along = np.linalg.norm(np.cross(axis, start)) < HELD
        if self.ties[index].turning == "direction" and along:
            self._turn(Step("lie", earlier), Step("azimuth", index), Step("hold", earlier))
            self.turning = _unit(end - end @ normal * normal)
        elif self.ties[index].turning == "direction":
            self._turn(Step("lie", earlier), Step("aim", index), Step("level", earlier, owner=index))
            self.turning = "none"
        elif along and np.linalg.norm(np.cross(normal, end)) > HELD:
            self._turn(
                Step("lie", earlier),
                Step("lie between", index, earlier),
                Step("level", earlier, owner=index),
                Step("hold", index),
            )
            self.turning = _unit(np.cross(normal, end))
        elif not along:
            raise InputError(
                f"{self.ties[index].name} turns about two directions: expected a relation before it that holds one"
            )

    def _turn(self, *steps: Step) -> None:
        self.turns += [(step, len(self.shifts)) for step in steps]

    def _shift(self, index: int) -> bool:
        """Shifts that a tie takes, as free of earlier ones as possible; True if there are any."""
        tie, seat = self.ties[index], self.seats[index]
        if tie.held == "all":
            asked = np.eye(3)
        elif tie.held == "along":
            asked = seat.its_toward.T
        else:
            asked = np.linalg.svd(seat.its_toward.T)[2][1:]
        left, sizes, _ = np.linalg.svd(asked @ self._free)
        directions = [left[:, k] @ asked for k, size in enumerate(sizes) if size > HELD]
        for direction in directions:
            self.shifts.append(Shift(index, None if tie.held == "along" else direction.reshape(3, 1)))
            free = self._free @ direction
            self.taken = np.vstack([self.taken, free / np.linalg.norm(free)])
        return bool(directions)

    def _turn_by_point(self, index: int, taken_before: bool) -> None:
        """A turn about a pivot that brings a point to its tie's target."""
        tie, seat = self.ties[index], self.seats[index]
        if isinstance(self.turning, str) and self.turning == "none":
            return
        if taken_before:
            return
        if isinstance(self.turning, str):
            self._aim_at(index)
            return
        swung = self._swung(seat)
        around = tie.held == "across" and abs(self.turning @ seat.its_toward[:, 0]) > 1 - HELD**2
        if tie.held != "all":
            toward = seat.its_toward[:, 0]
            swung = swung @ toward if tie.held == "along" else swung - swung @ toward * toward
        if np.linalg.norm(swung) > HELD:
            turning = self.pivot >= 0 and (around or tie.held == "all")
            step = Step("turn to", index, self.pivot) if turning else Step("swing", index)
            self._turn(step)
            self.turning = "none"

    def _swung(self, seat: Seat) -> Array:
        """Displacement of its point per unit of the remaining turn, with shifts as constrained (3,) [mm]."""
        pose, axis = self._pose(), column(np.asarray(self.turning))
        directions, _ = self.alignment.shift_directions(self.seats)
        shift = drift(pose, self.seats, directions, axis, pose.point(seat.its_centre))
        return np.asarray((shift + cross(axis, pose.point(seat.point)))[:, 0])

    def _by_place(self, index: int) -> bool:
        """True if the one turn left moves the middle of a slot across it by more than its ends against that.

        Walls that close in on the slot about its nominal place turn it so that |middle| + |ends over it| is least:
        the one that the turn moves more becomes 0.
        """
        seat = self.seats[index]
        if seat.across is None or isinstance(self.turning, str):
            return False
        toward = seat.its_toward[:, 0]
        if np.linalg.norm(self._free @ toward) > HELD:
            return False
        lever = abs(self._swung(seat) @ toward)
        arms = [self._pose().turn[:, :, 0] @ span[:, 0] for span in seat.across.spans]
        ends = sum(abs(np.cross(self.turning, arm) @ toward) for arm in arms)
        return bool(lever > HELD and lever > ends - HELD)

    def _aim_at(self, index: int) -> None:
        """The line from a held point to another point takes two of three turns."""
        tie, seat = self.ties[index], self.seats[index]
        if self.pivot < 0 or self.lying >= 0:
            raise InputError(
                f"{tie.name} would turn a part that no plane, axis or point holds: expected one of these before it; "
                "points on planes alone are contacts of three_two_one or six_plane"
            )
        arm = (self._pose().turn[:, :, 0] @ (seat.point - self.seats[self.pivot].point))[:, 0]
        length = np.linalg.norm(arm)
        if length < HELD:
            return
        if tie.held == "along" or (
            tie.held == "across" and np.linalg.norm(np.cross(arm / length, seat.its_toward[:, 0])) > HELD
        ):
            raise InputError(
                f"{tie.name} lies beside the point that is held: expected it through that point, or a plane or another "
                "point before it"
            )
        self._turn(Step("aim at", index, self.pivot))
        self.turning = arm / length


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))


FREE = 1e-9
"""Largest change of a contact, over the motion of the contacts' middle, that counts as none."""


def free_motions(rows: Array, middle: Array, reach: float) -> Array:
    """Motions (motions, 6) that change none of some contacts; shift of the world's origin [mm], then turn [rad].

    Args:
        rows: of each contact how it changes with the shift at a middle and the turn (contacts, 6).
        middle: of what the contacts are about (3,), in the world [mm].
        reach: of that about it [mm].
    """
    scale = np.array([1.0, 1.0, 1.0, 1 / reach, 1 / reach, 1 / reach])
    _, sizes, right = np.linalg.svd(rows * scale)
    sizes = np.concatenate([sizes, np.zeros(6 - len(sizes))])
    motions = right[sizes <= FREE * max(float(sizes[0]), 1.0)] * scale
    motions[:, :3] -= np.cross(motions[:, 3:], middle)
    return np.asarray(motions)


def seen_steps(free: Array, reach: float) -> Array:
    """Steps (6, steps), turn times reach and shift, without free motions: least turn, then least shift of the origin.

    Args:
        free: motions (motions, 6) that nothing sees, shift of the origin [mm] and turn [rad].
        reach: [mm].
    """
    turns, sizes, _ = np.linalg.svd(free[:, 3:] * reach, full_matrices=True)
    rank = int(np.sum(sizes > 1e-9))
    not_asked = [np.concatenate([row[3:] * reach, np.zeros(3)]) for row in turns.T[:rank] @ free]
    not_asked += [np.concatenate([np.zeros(3), row[:3]]) for row in turns.T[rank:] @ free]
    _, _, right = np.linalg.svd(np.array([*not_asked, np.zeros(6)]))
    return np.ascontiguousarray(right[len(not_asked) :].T)


def in_words(motions: Array) -> str:
    """The simplest of some motions, such as "it shifts along x" or "it turns about z through (0, 40, 0)"."""
    length = max(float(np.abs(motions).max()), 1.0)
    left, sizes, _ = np.linalg.svd(motions[:, 3:] * length)
    if len(motions) > np.sum(sizes > FREE * length):
        shift = left[:, -1] @ motions[:, :3]
        return f"it shifts along {direction_in_words(shift)}"
    shift, turn = np.split(motions[0] / np.linalg.norm(motions[0, 3:]), 2)
    words = f"it turns about {direction_in_words(turn)} through {_numbers(np.cross(turn, shift))}"
    return words if abs(turn @ shift) < FREE * length else f"{words} and shifts along it"


def direction_in_words(vector: Array) -> str:
    """x, y, z, or three numbers."""
    vector = vector / np.linalg.norm(vector)
    largest = int(np.argmax(np.abs(vector)))
    if abs(vector[largest]) > 1.0 - FREE:
        return "xyz"[largest]
    return _numbers(vector * np.sign(vector[largest]))


def _numbers(vector: Array) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in vector.round(6) + 0.0) + ")"
