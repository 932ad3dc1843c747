"""Deviations of a reducer's parts, and the effect of each contributor on them.

With given contacts, gaps and so the output's turn are linear in deviations: the turn is a sum over contributors.
Derivatives by each deviation are kept in the same arrays as the deviations themselves.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from tol3d.gears.tooth_measures import ToothMeasure
from tol3d.numerics.arrays import Array, TrialArrays

Along = Callable[[Array], Array]
"""From a contributor's components (trials, components) to the values that they add to an array."""


@dataclass(frozen=True)
class Acts:
    """Effect of a contributor on a reducer, and its factor.

    Args:
        effect: in the words of the reducer's model, such as "pin radius".
        gear: whose teeth deviate; "" for other parts.
        factor: multiplier of the deviation, such as 1/cos(alpha) for a thickness along the normals.
        over: measurement by which the scene states a tooth thickness; None if it states the arc.
        least: smallest physical deviation [mm], 0 for a clearance; None without one.
    """

    effect: str
    gear: str = ""
    factor: float = 1.0
    over: ToothMeasure | None = None
    least: float | None = None

    @property
    def turning(self) -> str | None:
        """The gear with which the deviation turns, if its teeth lie off their axis; else None."""
        return self.gear if self.gear and self.effect.endswith("offset") else None


@dataclass(frozen=True)
class Deviations(TrialArrays, ABC):
    """Deviations of a reducer's parts (trials, ...), or derivatives by each of them.

    A reducer's model adds its arrays, and tells which one a contributor acts on.
    """

    @classmethod
    @abstractmethod
    def nothing(cls, model: Any, trials: int) -> Self:
        """No deviations."""

    @abstractmethod
    def reached(self, model: Any, acts: Acts) -> tuple[Array, Along]:
        """The array that a contributor acts on, and the map from its components to that array."""

    @classmethod
    def drawn(cls, model: Any, acts: Mapping[str, Acts], drawn: Iterable[tuple[str, Array]], trials: int) -> Self:
        """Deviations of trials.

        Args:
            model: of the reducer.
            acts: effect of each contributor, by its name; others have none.
            drawn: components (trials, components) of contributors, by name.
            trials: their number.
        """
        deviations = cls.nothing(model, trials)
        for name, components in drawn:
            if name in acts:
                deviations.add(model, acts[name], components)
        return deviations

    def add(self, model: Any, acts: Acts, components: Array) -> None:
        """Add the effect of a contributor.

        Args:
            model: of the reducer.
            acts: the effect.
            components: of the contributor (trials, components) [mm or rad], part by part for several equal parts.
        """
        into, along = self.reached(model, acts)
        into += acts.factor * along(components)

    def term(self, model: Any, acts: Acts, components: Array) -> Array:
        """Change due to a contributor (trials,), if these are derivatives by the deviations; see `add`."""
        rates, along = self.reached(model, acts)
        return np.asarray(acts.factor * (rates * along(components)).reshape(len(rates), -1).sum(axis=1))


def shaped(like: Array) -> Along:
    """Map of components to the shape of an array (trials, ...)."""
    return lambda components: components.reshape(len(components), *like.shape[1:])
