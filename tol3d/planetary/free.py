"""How far a shaft of a set turns in some trials."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Codes = NDArray[np.int8]


@dataclass(frozen=True)
class Free:
    """What a shaft can turn in some trials.

    Args:
        ends: smallest and largest turn (trials, 2) [rad]; nan where the set cannot be assembled.
        status: of the programme (trials,).
        row: planet x meshes + mesh that has no room (trials,), -1 where all have.
        lacking: how much each contact of a closed loop lacks [mm] (trials,).
    """

    ends: Array
    status: Codes
    row: NDArray[np.int64]
    lacking: Array

    @classmethod
    def of(cls, trials: int) -> "Free":
        """Room for some trials."""
        return cls(
            np.empty((trials, 2)), np.empty(trials, np.int8), np.empty(trials, np.int64), np.empty(trials, np.float64)
        )


def turned(vectors: Array, turns: Array) -> Array:
    """Vectors (trials, ..., 2) turned by so many turns (trials, ...)."""
    angles = 2 * np.pi * (turns - np.round(turns))
    cos, sin = np.cos(angles), np.sin(angles)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)


@dataclass(frozen=True)
class Followed:
    """Where a shaft rests at positions one after another in some trials.

    Args:
        ends: its turn (trials, positions) [rad]; 0 where the set jams.
        status: of the programme, the worst position's (trials,).
        row: that has no room there, see Free (trials,).
        lacking: how much each contact of a closed loop lacks at most [mm] (trials,).
    """

    ends: Array
    status: Codes
    row: NDArray[np.int64]
    lacking: Array

    @classmethod
    def of(cls, trials: int, positions: int) -> "Followed":
        """Room for some trials."""
        return cls(
            np.zeros((trials, positions)), np.empty(trials, np.int8), np.empty(trials, np.int64), np.empty(trials)
        )


def cosines_and_sines(turns: Array) -> Array:
    """Of turns (...), (..., 2)."""
    angles = 2 * np.pi * (turns - np.round(turns))
    return np.ascontiguousarray(np.stack([np.cos(angles), np.sin(angles)], axis=-1))
