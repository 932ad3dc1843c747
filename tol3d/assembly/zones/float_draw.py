"""Draws of where a part with play lies in its room, as shares of the room of each trial."""

from dataclasses import dataclass
from functools import cached_property
from typing import Final, Literal

import numpy as np

from tol3d.assembly.zones.domain import Array
from tol3d.distributions import Distribution, Normal, Uniform
from tol3d.system.draw import Values
from tol3d.system.normals import Group, scalars

Law = Literal["disc", "interval", "direction", "fraction"]

SIZES: Final = {"disc": 2, "interval": 1, "direction": 6, "fraction": 1}
"""Components of each law, and uniforms."""
SIGMAS: Final = {"disc": 0.5, "interval": 1 / np.sqrt(3.0), "direction": 1.0, "fraction": 1 / np.sqrt(12.0)}


@dataclass(frozen=True)
class FloatDraw:
    """Numbers without unit; see model.Floating for what they mean. Implements Draw and Joint.

    Args:
        laws: a point of a disc of radius 1, of -1 to 1, a direction (six independent normals), 0 to 1.
        components: names of all their components.
    """

    laws: tuple[Law, ...]
    components: tuple[str, ...]

    words = "uniform in the room of the trial"

    @property
    def distribution(self) -> Distribution:
        """Of a component, in words."""
        return Normal(0.0, 1.0) if "direction" in self.laws else Uniform(-1.0, 1.0)

    @property
    def uniforms(self) -> int:
        """One a component."""
        return len(self.components)

    @property
    def groups(self) -> tuple[Group, ...]:
        """See Smooth."""
        kinds = (
            (Group("plane", (own.start, own.start + 1)),) if law == "disc" else scalars(SIZES[law], own.start)
            for law, own in self._blocks
        )
        return tuple(group for own in kinds for group in own)

    @cached_property
    def _blocks(self) -> tuple[tuple[Law, slice], ...]:
        found, start = [], 0
        for law in self.laws:
            found.append((law, slice(start, start + SIZES[law])))
            start += SIZES[law]
        return tuple(found)

    @property
    def sigma(self) -> float:
        """The largest of a component."""
        return max(float(SIGMAS[law]) for law in self.laws)

    @property
    def covariance(self) -> Array:
        """See Joint: no component goes with another."""
        return np.diag([float(SIGMAS[law]) ** 2 for law in self.laws for _ in range(SIZES[law])])

    def deviations(self, *uniforms: Array) -> tuple[Array, ...]:
        """See Draw."""
        found: list[Array] = []
        for law, own in self._blocks:
            u = uniforms[own]
            if law == "disc":
                radius, angle = np.sqrt(u[0]), 2 * np.pi * u[1]
                found += [radius * np.cos(angle), radius * np.sin(angle)]
            elif law == "direction":
                found += [Normal(0.0, 1.0).ppf(own_u) for own_u in u]
            else:
                found.append(2 * u[0] - 1 if law == "interval" else u[0])
        return tuple(found)

    def mean(self, *, turning: bool) -> tuple[float, ...]:
        """See Draw: in the middle of the room."""
        return tuple(0.5 if law == "fraction" else 0.0 for law in self.laws for _ in range(SIZES[law]))

    def ends(self, values: Values, *, turning: bool) -> Array:
        """See Draw: where the room ends both ways along the steepest direction of each law."""
        count = len(self.components)
        last = np.array([1.0 if law == "fraction" else 0.0 for law in self.laws for _ in range(SIZES[law])])
        found = values(np.concatenate([last + np.eye(count), last - np.eye(count)]))
        slope = np.where(last > 0.0, 0.0, found[:count] - found[count:])
        along = np.zeros(count)
        for _, own in self._blocks:
            size = float(np.sqrt(slope[own] @ slope[own]))
            along[own] = slope[own] / size if size > 0.0 else 0.0
        return np.stack([last + along, last - along])
