"""What is read of a planetary set."""

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.planetary.planetary_set import PlanetarySet
from tol3d.system.plain import PlainMeasure

Array = NDArray[np.float64]

Reading = Literal["lost motion", "low stiffness", "lag", "lead"]


@dataclass(frozen=True, kw_only=True)
class PlanetaryMeasure(PlainMeasure):
    """A measure of one set.

    Args:
        reading: the whole free turn of a shaft, what it turns against springs alone, or where the output rests while
            its load resists (lag) or drives it.
        set_name: of the set.
        shaft: that turns.
    """

    reading: Reading
    set_name: str
    shaft: str

    @property
    def is_free_turn(self) -> bool:
        """Whether it is a free turn of a shaft at one position, or a part of it."""
        return self.reading in ("lost motion", "low stiffness")

    @property
    def curve_key(self) -> Hashable:
        """Measures of one key are read from the same curve."""
        return self.reading, self.shaft, self.positions

    def sense(self, own: PlanetarySet) -> float:
        """1 where the output turns counter-clockwise while the input does, else -1."""
        return 1.0 if own.ratio > 0 else -1.0

    def turns_of(self, at_random: Array) -> Array:
        """Turns of the output (trials,) where a lost motion is read: those of the trials, or a fixed one."""
        if self.positions.over == "random":
            return at_random
        return np.full(len(at_random), self.positions.angle / (2 * np.pi))

    def weights(self, curves: Array) -> Array:
        """What is taken of curves (trials, positions) is the sum of their values times these, near these curves.

        Curves are read from their first position on. A harmonic is read along its own phase.
        """
        found, rows = np.zeros_like(curves), np.arange(len(curves))
        if self.take == "harmonic":
            assert self.spectrum is not None
            count = self.positions.count
            cycles = float(self.spectrum.orders[0]) * np.arange(count) / count
            waves = np.exp(-2j * np.pi * cycles)
            sums = curves[:, :count] @ waves
            sizes = np.abs(sums)
            phases = np.conj(sums) / np.where(sizes > 0.0, sizes, 1.0)
            found[:, :count] = 4 / count * (phases[:, None] * waves).real
            return found
        if self.take in ("max", "range"):
            found[rows, curves.argmax(axis=1)] += 1.0
        if self.take in ("min", "range"):
            found[rows, curves.argmin(axis=1)] += -1.0 if self.take == "range" else 1.0
        if self.take != "range":
            found[:, 0] -= 1.0
        return found

    def end(self, own: PlanetarySet) -> int:
        """Which end of its free turn the output rests at: the lower (0) or the upper one (1)."""
        return 0 if (self.reading == "lag") == (self.sense(own) > 0.0) else 1
