"""A contributor: one toleranced deviation, how it is drawn, and what it does to the parts."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.distributions import Distribution
from tol3d.gearing.effects import Effect
from tol3d.units import RAD_PER_ARCMIN

Array = NDArray[np.float64]
Unit = Literal["um", "mrad", "K", "arcmin"]

INTERNAL_PER_UNIT: dict[Unit, float] = {"um": 1e-3, "mrad": 1e-3, "K": 1.0, "arcmin": RAD_PER_ARCMIN}


@dataclass(frozen=True)
class Scalar:
    """One component, drawn straight from the distribution."""

    distribution: Distribution

    uniforms = 1
    components = ("",)

    @property
    def sigma(self) -> float:
        """Standard deviation of the component [mm, rad or K]."""
        return self.distribution.sigma

    def deviations(self, *uniforms: Array) -> tuple[Array]:
        """One array of uniforms (trials,) in (0, 1) to the deviations of the component (trials,) [mm, rad or K]."""
        (u,) = uniforms
        return (self.distribution.ppf(u),)


@dataclass(frozen=True)
class Planar:
    """A length in a direction of the transverse plane: components x, y.

    `direction` None draws it uniform over the circle (a Rayleigh length then makes x and y two
    independent normals); an angle [rad] fixes it.
    """

    distribution: Distribution
    direction: float | None

    components = ("x", "y")

    @property
    def uniforms(self) -> int:
        """How many uniforms a trial takes: the length, and the direction unless it is fixed."""
        return 1 if self.direction is not None else 2

    @property
    def sigma(self) -> float:
        """Standard deviation along any one axis [mm] for a random direction; else that of the length."""
        if self.direction is not None:
            return self.distribution.sigma
        return math.sqrt((self.distribution.variance + self.distribution.mean**2) / 2)

    def deviations(self, *uniforms: Array) -> tuple[Array, Array]:
        """One or two arrays of uniforms (trials,) in (0, 1) to x and y (trials,) [mm]."""
        length = self.distribution.ppf(uniforms[0])
        if self.direction is not None:
            return length * math.cos(self.direction), length * math.sin(self.direction)
        angle = 2 * math.pi * uniforms[1]
        return length * np.cos(angle), length * np.sin(angle)


@dataclass(frozen=True)
class Contributor:
    """A tolerance as the simulation sees it.

    Args:
        name: as in the scene.
        kind: the tolerance's kind, the scene's word.
        effect: what a deviation does.
        draw: how its components come from uniforms.
        unit: unit of its columns in results ("um", "mrad", "arcmin", "K").
        description: the scene's own words.
        least: smallest physical deviation [mm, rad or K], such as 0 for a clearance; draws below it are kept
            as they come, and counted.
    """

    name: str
    kind: str
    effect: Effect
    draw: Scalar | Planar
    unit: Unit
    description: str = ""
    least: float | None = None

    @property
    def columns(self) -> tuple[str, ...]:
        """Column names in results: `name.component [unit]`."""
        return tuple(f"{self.name}{'.' + c if c else ''} [{self.unit}]" for c in self.draw.components)

    @property
    def per_unit(self) -> float:
        """What one of its unit is in mm, rad or K."""
        return INTERNAL_PER_UNIT[self.unit]

    @property
    def distribution(self) -> Distribution:
        """The law of the deviation, or of its length where it has a direction."""
        return self.draw.distribution
