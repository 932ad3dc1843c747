"""What a deviation does to a seat: all that builds, their rates and the compiled builds know of an effect."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import singledispatch

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.effects import Effect, FlankDeviation
from tol3d.gearing.model import Model

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Displacement:
    """Change of some slots of a seat, linear in the components of a deviation.

    Args:
        seat: its place in `model.seats`.
        slot: the first of the slots, see slots.py.
        matrix: (slots, components) [mm or rad per mm or rad].
        factor: by which the deviation is multiplied first.
    """

    seat: int
    slot: int
    matrix: Array
    factor: float = 1.0

    @property
    def slots(self) -> slice:
        """All of its slots."""
        return slice(self.slot, self.slot + len(self.matrix))

    @property
    def rates(self) -> Array:
        """Change of its slots per component, (components, slots)."""
        return self.factor * self.matrix.T

    def change(self, columns: Array) -> Array:
        """Change of its slots, (trials, slots), by deviations (trials, components)."""
        first, *others = (self.factor * columns[:, k, None] * own for k, own in enumerate(self.matrix.T))
        return np.asarray(sum(others, first))


@dataclass(frozen=True, eq=False)
class PivotShift:
    """Shift of a seat's origin because its axis turns about another point of the axis.

    Not linear: the pivot less the turned pivot. The turn itself is a Displacement of its own.

    Args:
        seat: its place in `model.seats`.
        turn: rotation vector per deviation (3,) [rad per mm or rad], in the seat's frame at rest; of one component.
        pivot: z of that point [mm], in the same frame.
    """

    seat: int
    turn: Array
    pivot: float


@dataclass(frozen=True)
class Growth:
    """Temperature of a part: the deviation [K]. Every length of it grows by its coefficient of expansion."""

    part: str


@dataclass(frozen=True)
class FlankOffsets:
    """Offsets of single flanks of a gear, in all of its meshes: what the effect says."""

    effect: FlankDeviation


AnyDisplacement = Displacement | PivotShift | Growth | FlankOffsets


@singledispatch
def displacements(effect: Effect, model: Model, components: int) -> Iterator[AnyDisplacement]:
    """What a deviation of so many components displaces in a model; each file of this folder registers one effect."""
    raise TypeError(f"displacements/ has no file for the effect {type(effect).__name__}")
