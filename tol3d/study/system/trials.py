"""Consecutive trials as both methods get them: deviations, and the position at which each trial is read."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from tol3d.numerics.arrays import Array


@dataclass(frozen=True)
class Trials:
    """Trials with their deviations and positions.

    Args:
        deviations: (trials, components) [mm, rad, K]; the components of the contributors in their order.
        positions: from a trial's uniforms, such as the angle of a shaft [rad]: (trials,) by name.
    """

    deviations: Array
    positions: Mapping[str, Array]

    def __len__(self) -> int:
        return len(self.deviations)

    def part(self, first: int, end: int) -> Self:
        """Trials first ... end - 1."""
        positions = {name: values[first:end] for name, values in self.positions.items()}
        return replace(self, deviations=self.deviations[first:end], positions=positions)

    def scaled(self, factor: float | Array) -> Self:
        """The same trials with all deviations multiplied by a factor, or each component by its own (components,)."""
        return replace(self, deviations=factor * self.deviations)


def joined(pieces: Sequence[Trials]) -> Trials:
    """Several trials as one, in their order."""
    names = pieces[0].positions
    return Trials(
        np.concatenate([piece.deviations for piece in pieces]),
        {name: np.concatenate([piece.positions[name] for piece in pieces]) for name in names},
    )
