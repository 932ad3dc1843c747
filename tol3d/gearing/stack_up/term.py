"""One contributor's term in a stack-up, and first-order terms neglected by a stack-up, with their sizes."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from tol3d.gearing.model import Contributor
from tol3d.numerics.arrays import Array

Role = Literal["driver", "driven"]


@dataclass(frozen=True)
class Term:
    """A contributor's first-order change of the normal backlash.

    Args:
        contributor: its contributor.
        coefficient: change of j_bn per deviation [mm/mm, mm/rad, mm/K]; for a deviation with a
            direction, per length along its worst direction.
        along: that direction for Planar draws, as the azimuth [rad] of largest opening in the gear's frame at
            rest; for a turning offset the gear's turn is subtracted.
        turns: which gear the deviation turns with, or None when it rests.
        sense: in which azimuths of the deviation count, against those of the gear.
        tilts: for what enters through the one-sided loss by tilts, not linearly: loss in the plane of the axes (about
            y) and across it (about x) per component of the deviation; `coefficient` is the largest of them.
    """

    contributor: Contributor
    coefficient: float
    along: float = 0.0
    turns: Role | None = None
    sense: float = 1.0
    tilts: tuple[tuple[float, ...], tuple[float, ...]] | None = None

    @property
    def leans(self) -> bool:
        """True if it enters through the loss by tilts; none does in a mesh read in the middle of its face."""
        return self.tilts is not None and any(map(any, self.tilts))

    def change(self, deviation: Array, angles: tuple[Array, Array]) -> Array:
        """Change of j_bn [mm], (rows,), for deviations (rows, components) at turns (driver, driven) [rad]."""
        if deviation.shape[1] == 1:
            return self.coefficient * deviation[:, 0]
        turn = np.zeros(1) if self.turns is None else angles[0 if self.turns == "driver" else 1]
        azimuth = self.along - self.sense * turn
        return self.coefficient * (np.cos(azimuth) * deviation[:, 0] + np.sin(azimuth) * deviation[:, 1])

    def times(self, factor: float) -> "Term":
        """The same with another coefficient; not for tilts."""
        return replace(self, coefficient=factor * self.coefficient)


@dataclass(frozen=True)
class Bound:
    """A bound: `factor` times the absolute value of the sum of some terms."""

    factor: float
    terms: tuple[Term, ...]


@dataclass(frozen=True)
class Neglect:
    """A term that a stack-up neglects on purpose, and a bound of its effect on j_bn.

    Args:
        words: description for people.
        parts: bounds that add up [mm].
    """

    words: str
    parts: tuple[Bound, ...]

    def bound(self, slices: Mapping[str, slice], deviations: Array, angles: tuple[Array, Array]) -> Array:
        """Largest neglected change of j_bn [mm], (rows,); 0 where no deviation of its terms acts.

        Args:
            slices: columns of each contributor in the deviations.
            deviations: (rows, components) [mm, rad, K].
            angles: turns of driver and driven gear [rad], each (rows,).
        """
        total = np.zeros(len(deviations))
        for part in self.parts:
            change = np.zeros(len(deviations))
            for term in part.terms:
                change = change + term.change(deviations[:, slices[term.contributor.name]], angles)
            total = total + part.factor * np.abs(change)
        return total
