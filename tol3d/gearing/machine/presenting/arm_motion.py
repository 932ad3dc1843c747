"""An arm in motion: from pose to pose, and in each of them its joints through their play.

Joints move, and the chain places its links by where they stand, as it does in trials.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np

from tol3d.assembly.presenting.shown_assembly import Placed, moved_from, placed_each, seen_whole
from tol3d.errors import RunError
from tol3d.gearing.machine.presenting.trains_in_joints import TrainInJoint
from tol3d.gearing.machine.system import MachineSystem
from tol3d.numerics.arrays import Array
from tol3d.report.body import World
from tol3d.report.motion import Frame, Motion, Shot
from tol3d.report.ticks import even_step
from tol3d.study.system.stated import magnified
from tol3d.study.system.trials import Trials

POSES: Final = "poses"
"""Name of the motion."""
SWINGING, TRAVELLING = 16, 12
"""Frames of a swing, and from pose to pose, by default."""
SWUNG: Final = 0.06
"""Fraction of the arm's size: how far the play of its joints moves some feature at least, as it is shown."""
MOST_TURN: Final = math.radians(15.0)
"""Turn of a joint from the middle of its play to an end, as it is shown, at most, to a digit of the factor."""
NO_PLAY: Final = 1e-6
"""mm; play that moves no feature by more is rounding."""
QUARTERS: Final = (0.0, 0.25, 0.75, 1.0)
"""Fractions of a swing at which joints rest, lie at an end, at the other, and rest again."""


class Leg(NamedTuple):
    """A stretch of the motion: from a pose to another, or through the play in one; and how many frames it takes."""

    start: str
    end: str
    frames: int


@dataclass(frozen=True, eq=False)
class Arm:
    """An arm of a build.

    Args:
        system: whose.
        trials: the build, without magnification.
        magnify: factor of its deviations.
        world: the first of its display, in its first pose.
        placed: its parts there.
        trains: that turn its joints.
    """

    system: MachineSystem
    trials: Trials
    magnify: float
    world: World
    placed: Placed
    trains: tuple[TrainInJoint, ...] = ()

    @cached_property
    def _columns(self) -> Sequence[int]:
        return list(self.system.turns.values())

    @cached_property
    def _inputs(self) -> Mapping[str, Array]:
        """Inputs of its joints beyond those of the first pose (joints,) [rad], by pose."""
        first = np.array(self.system.inputs_in(next(iter(self.system.poses))))
        return {pose: np.array(self.system.inputs_in(pose)) - first for pose in self.system.arm_poses}

    @cached_property
    def _halves(self) -> Mapping[str, Array]:
        """From the middle of its play to where each joint lies (joints,) [rad], by pose; the other end is opposite."""
        return {pose: self.system.in_pose(self.trials, pose)[0, self._columns] for pose in self._inputs}

    @cached_property
    def _row(self) -> Array:
        """Deviations (columns,) as they are shown; of joints others are put in."""
        drawn = self.system.drawn
        own = Trials(self.system.in_pose(self.trials, next(iter(self._inputs))), {})
        return np.asarray(magnified(drawn, own, self.magnify).deviations[0])

    def at(self, turns: Sequence[Array]) -> Sequence[Placed]:
        """Its parts with joints at some turns (joints,) [rad] beyond the inputs of the first pose.

        Raises:
            RunError: they cannot be placed.
        """
        rows = np.repeat(self._row[None], len(turns), axis=0)
        rows[:, self._columns] = turns
        found = [own for own in placed_each(self.system.drawn.assembly, rows) if own is not None]
        if len(found) < len(rows):
            raise RunError("its parts cannot be placed everywhere between its poses")
        return found

    @cached_property
    def factor(self) -> float:
        """Factor by which the play of its joints is shown: as large as is seen, and that of deviations at least."""
        ends = [self._inputs[pose] + sign * half for pose, half in self._halves.items() for sign in (1.0, -1.0)]
        places = [np.array([frame[:3, 3] for frame in own.frames.values()]) for own in self.at(ends)]
        swung = max(
            float(np.linalg.norm(one - other, axis=1).max())
            for one, other in zip(places[::2], places[1::2], strict=True)
        )
        if swung < NO_PLAY:
            return 0.0
        size = float(np.linalg.norm(np.ptp(places[0], axis=0)))
        most = MOST_TURN / max(float(np.abs(half).max()) for half in self._halves.values())
        return max(min(even_step(SWUNG * size / swung), float(f"{most:.1g}")), self.magnify)

    def rests(self, pose: str) -> Array:
        """Turns (joints,) where joints lie in a pose, as their loads have it."""
        return np.asarray(self._inputs[pose] + self.magnify * self._halves[pose])

    def swung(self, pose: str, u: float) -> Array:
        """Turns (joints,) on a swing in a pose, at u from 0 to 1: to where joints lie, the other ends, and back."""
        ends = [self.magnify, self.factor, -self.factor, self.magnify]
        k = min(int(np.searchsorted(QUARTERS, u, side="right")), len(QUARTERS) - 1)
        share = _eased((u - QUARTERS[k - 1]) / (QUARTERS[k] - QUARTERS[k - 1]))
        return np.asarray(self._inputs[pose] + (ends[k - 1] + share * (ends[k] - ends[k - 1])) * self._halves[pose])

    def legs(self, frames: int | None) -> Iterator[Leg]:
        """Its swings and travels in turn, of the frames that are asked for."""
        poses, swings = list(self._inputs), bool(self.factor)
        every = [(poses[0], poses[0])] if swings else []
        for start, end in pairwise(poses):
            every += [(start, end), *([(end, end)] if swings else [])]
        usual = [SWINGING if start == end else TRAVELLING for start, end in every]
        ends = np.cumsum([0, *usual], dtype=np.float64)
        if frames is not None:
            ends = np.round(ends * (frames - 1) / max(ends[-1], 1.0))
        for (start, end), count in zip(every, np.diff(ends).astype(int).tolist(), strict=True):
            yield Leg(start, end, count)

    def turns(self, leg: Leg) -> Iterator[tuple[str, str, Array]]:
        """Caption, pose if joints rest in it, and turns (joints,) of each frame of a leg, but its last place."""
        marks = sorted({round(own * leg.frames) for own in QUARTERS})
        for k in range(leg.frames):
            if leg.start != leg.end:
                share = _eased(k / leg.frames)
                words = f"{leg.start} to {leg.end}" if k else leg.start
                yield words, "" if k else leg.start, (1.0 - share) * self.rests(leg.start) + share * self.rests(leg.end)
            else:
                u = float(np.interp(k, marks, QUARTERS)) if len(marks) == len(QUARTERS) else k / leg.frames
                words = f"{leg.start}: {self.play_words}" if k else leg.start
                yield words, "" if k else leg.start, self.swung(leg.start, u)

    def poses_of_trains(self, placed: Placed) -> Mapping[str, Array]:
        """Poses (4, 4) of the bodies of its trains, by name, as its parts lie."""
        return {body.name: body.world_from_part for train in self.trains for body in train.placed(placed)}

    @property
    def play_words(self) -> str:
        """The factor of the play, in words."""
        return f"play of the joints × {self.factor:g}"


def _eased(share: float) -> float:
    """A fraction of a way, by that of its time: it begins and ends at rest.

    >>> _eased(0.0), _eased(0.25), _eased(0.5), _eased(1.0)
    (0.0, 0.15625, 0.5, 1.0)
    """
    return share * share * (3.0 - 2.0 * share)


def arm_motion(arm: Arm, frames: int | None) -> Motion:
    """An arm through its poses, in each of which its joints swing through their play.

    Args:
        arm: in its first pose.
        frames: how many; None: as many as suit it.

    Raises:
        RunError: its parts cannot be placed on the way.
    """
    steps = [step for leg in arm.legs(frames) for step in arm.turns(leg)]
    last = arm.system.arm_poses[-1]
    steps.append((last, last, arm.rests(last)))
    every = arm.at([turns for _, _, turns in steps])
    shown = tuple(
        Frame(words, {**moved_from(arm.placed, own, arm.world), **arm.poses_of_trains(own)}, stop=stop)
        for (words, stop, _), own in zip(steps, every, strict=True)
    )
    notes = (f"{arm.play_words}, both ends of it in every pose",) if arm.factor else ("its joints have no play",)
    look = seen_whole(arm.world, [frame.poses for frame in shown])
    return Motion(arm.world, shown, (Shot(POSES, (look,)),), back=True, notes=notes)
