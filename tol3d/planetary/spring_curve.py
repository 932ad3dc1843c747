"""Torque against turn of a set whose flexible carrier presses its planets apart with one spring.

Without friction. Up to the breakaway torque the spring holds the planets where contacts stop them; beyond it gives way,
and the shaft crosses what the rigid set has as dead band at a stiffness that is the spring's alone.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import InputError
from tol3d.planetary.deviated import Deviated
from tol3d.planetary.free import Free
from tol3d.planetary.planetary_set import MOST_PUSH, PlanetarySet
from tol3d.planetary.programme import ranges
from tol3d.planetary.stack_up import StackUp

Array = NDArray[np.float64]

THIRDS: Final = 90  # of the spring's way: (2/3)^90 of 0.1 mm is less than rounding


def turns_under(
    own: PlanetarySet,
    deviated: Deviated,
    torques: Array,
    shaft: str,
    force: float,
    stiffness: float,
    turns: float = 0.0,
) -> Array:
    """Turn of a shaft [rad] under torques (torques,) [N mm], the opposite one held, by first-order gaps.

    At rest the work of the torque and of the spring is largest: T theta(S) + Q0 S - k (S - S0)^2 / 2 over the
    displacement S of each planet, S0 that at which contacts stop it; theta(S) is concave, the end of the shaft's play
    where planets are displaced by S.

    Args:
        own: a set with one spring, or one whose carrier is rigid.
        deviated: of one trial.
        torques: on the shaft, positive is counter-clockwise.
        shaft: the input or the output.
        force: Q0 of the spring against S where planets are stopped [N], its work being Q0 S.
        stiffness: k of the spring against S [N/mm].
        turns: of the output, at which gears stand.

    Raises:
        InputError: no spring or several, or planets that find no room.
    """
    if len(own.springs) != 1:
        raise InputError(f"expected a flexible carrier with one spring, got {len(own.springs)}")
    lower, upper = StackUp(own).sides(deviated, np.array([turns]))
    programme = _Programme(own, shaft, lower, upper)
    least, closed = programme.room()
    low, high = np.full(len(torques), least), np.full(len(torques), closed)
    for _ in range(THIRDS):
        first, second = low + (high - low) / 3, high - (high - low) / 3
        work = [
            torques * programme.ends(at, torques) + (force - stiffness * (at - closed) / 2) * (at - closed)
            for at in (first, second)
        ]
        rising = work[0] < work[1]
        low, high = np.where(rising, first, low), np.where(rising, high, second)
    return programme.ends(high, torques)


@dataclass(frozen=True)
class _Programme:
    """That of one trial: sides of its contacts (1, rows) [mm]."""

    own: PlanetarySet
    shaft: str
    lower: Array
    upper: Array

    def room(self) -> tuple[float, float]:
        """Least and largest displacement [mm] for which the set has room."""
        stands = self.own.opposite(self.shaft)
        push = np.zeros(len(self.own.unknowns(stands)))
        push[-1] = 1.0
        free = self._solved(push, np.full((1, 1), -MOST_PUSH), np.full((1, 1), MOST_PUSH))
        if free.status[0] != 0 or free.ends[0, 1] <= 0.0:
            raise InputError("planets find no room: the set jams before its spring pushes")
        return float(free.ends[0, 0]), float(free.ends[0, 1])

    def ends(self, displacements: Array, senses: Array) -> Array:
        """Ends of the shaft's play [rad] in the senses of torques, where planets are displaced [mm]."""
        turn = self.own.objective(self.own.opposite(self.shaft), self.shaft)
        free = self._solved(turn, displacements[:, None], displacements[:, None])
        return np.where(senses > 0.0, free.ends[:, 1], free.ends[:, 0])

    def _solved(self, turn: Array, least: Array, largest: Array) -> Free:
        own, stands, count = self.own, self.own.opposite(self.shaft), len(least)
        free = Free.of(count)
        lower = np.hstack([np.repeat(self.lower, count, axis=0), least])
        upper = np.hstack([np.repeat(self.upper, count, axis=0), largest])
        begun, wanted = own.begun(stands), np.stack([-turn, turn])
        ranges(
            own.rows(stands), lower, upper, turn, wanted, begun, free.ends, free.status, free.row, free.lacking
        )  # fmt: skip
        return free
