"""Deviations of a reducer's parts, and the effect of each contributor on them.

Gaps are linear in deviations, so that with the contacts of a trial a turn of the output is a sum of parts, one of each
contributor: derivatives by each deviation lie in the same arrays as the deviations themselves.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from tol3d.gears.tooth_measures import ToothMeasure
from tol3d.numerics.arrays import Array, TrialArrays

Along = Callable[[Array], Array]
"""From a contributor's components (trials, components) to the part of an array that they are."""


@dataclass(frozen=True)
class Acts:
    """Effect of a contributor on a reducer, and its factor.

    Args:
        effect: in the words of the reducer's model, such as "pin radius".
        gear: whose teeth deviate; "" of other parts.
        factor: multiplier of the deviation, such as 1/cos(alpha) for a thickness along the normals.
        over: how teeth are measured, where the scene says so.
        least: smallest physical deviation [mm]: 0 of a clearance.
    """

    effect: str
    gear: str = ""
    factor: float = 1.0
    over: ToothMeasure | None = None
    least: float | None = None

    @property
    def turning(self) -> str | None:
        """The gear with which the deviation turns: one whose teeth lie off their axis."""
        return self.gear if self.gear and self.effect.endswith("offset") else None


@dataclass(frozen=True)
class Deviations(TrialArrays, ABC):
    """Deviations of a reducer's parts (trials, ...), or derivatives by each of them.

    A model adds its arrays, and says which one a contributor reaches; `own` is that model.
    """

    @classmethod
    @abstractmethod
    def nothing(cls, own: Any, trials: int) -> Self:
        """No deviations."""

    @abstractmethod
    def reached(self, own: Any, acts: Acts) -> tuple[Array, Along]:
        """The array that a contributor reaches, and the part of it that its components are."""

    @classmethod
    def drawn(cls, own: Any, acts: Mapping[str, Acts], drawn: Iterable[tuple[str, Array]], trials: int) -> Self:
        """Deviations of trials.

        Args:
            own: the model.
            acts: effect of each contributor, by its name; others have none.
            drawn: components (trials, components) of contributors, by name.
            trials: their number.
        """
        found = cls.nothing(own, trials)
        for name, components in drawn:
            if name in acts:
                found.add(own, acts[name], components)
        return found

    def add(self, own: Any, acts: Acts, components: Array) -> None:
        """Add the effect of a contributor.

        Args:
            own, acts: the model, and the effect.
            components: of the contributor (trials, components) [mm or rad], of alike parts one after the other.
        """
        into, along = self.reached(own, acts)
        into += acts.factor * along(components)

    def term(self, own: Any, acts: Acts, components: Array) -> Array:
        """Change due to a contributor (trials,), where this is the change per deviation; see `add`."""
        rates, along = self.reached(own, acts)
        return np.asarray(acts.factor * (rates * along(components)).reshape(len(rates), -1).sum(axis=1))


def shaped(like: Array) -> Along:
    """Components one after the other, in the form of an array (trials, ...)."""
    return lambda components: components.reshape(len(components), *like.shape[1:])
