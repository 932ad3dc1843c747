"""A contributor: one toleranced deviation, how it is drawn, and what it does to the parts.

Every tolerance kind of a scene comes down to one of eight effects, or several of them together. The geometric road
(build.py) and the analytic road (analytic/) each say for themselves what an effect does.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.distributions import Distribution
from tol3d.units import RAD_PER_ARCMIN

Array = NDArray[np.float64]
Unit = Literal["um", "mrad", "K", "arcmin"]

INTERNAL_PER_UNIT: dict[Unit, float] = {"um": 1e-3, "mrad": 1e-3, "K": 1.0, "arcmin": RAD_PER_ARCMIN}


@dataclass(frozen=True)
class Plane:
    """How a gear lies to the frame in which a deviation with a direction is counted, such as its shaft's.

    Args:
        azimuth: of that frame's x axis in the gear's frame [rad].
        mirrored: whether the two count azimuths in opposite senses, as a gear does that faces backward on its shaft.
    """

    azimuth: float = 0.0
    mirrored: bool = False

    @property
    def matrix(self) -> Array:
        """(x, y) of the gear's frame from (x, y) of the other, (2, 2)."""
        cos, sin, sense = math.cos(self.azimuth), math.sin(self.azimuth), -1.0 if self.mirrored else 1.0
        return np.array([[cos, -sense * sin], [sin, sense * cos]])

    def turned(self, columns: Array) -> Array:
        """Deviations (rows, 2) in the gear's frame."""
        if self == AS_COUNTED:
            return columns
        (xx, xy), (yx, yy) = self.matrix
        x, y = columns[:, 0], columns[:, 1]
        return np.stack([xx * x + xy * y, yx * x + yy * y], axis=1)

    def seen_from(self, azimuth: float) -> "Plane":
        """The same in a frame whose x axis lies at an azimuth [rad] of the gear's."""
        return Plane(self.azimuth - azimuth, self.mirrored)


AS_COUNTED = Plane()


@dataclass(frozen=True)
class ToothThickness:
    """Deviation of the tooth thickness of a gear [mm], positive is thicker; half of it on each flank.

    Each flank turns out of its tooth by `turn` [rad/mm], and moves out along its normal by `offset` [mm/mm].
    """

    part: str
    turn: float
    offset: float = 0.0


@dataclass(frozen=True)
class TurningOffset:
    """Offset (x, y) [mm] of a gear's centre from its rotation axis, in the gear's frame; it turns with the gear."""

    part: str
    plane: Plane = AS_COUNTED


@dataclass(frozen=True)
class AxisOffset:
    """Shift of a gear's rotation axis [mm], in the gear's frame at rest.

    Scalar: `direction` (unit vector) times `factor` times the deviation. Planar (components x, y): `factor`
    times the vector as `plane` turns it. It acts in all meshes of the gear, or in one only, in whose frame
    `direction` then is.
    """

    part: str
    direction: tuple[float, float, float] = (1.0, 0.0, 0.0)
    factor: float = 1.0
    mesh: str | None = None
    plane: Plane = AS_COUNTED


@dataclass(frozen=True)
class AxisTilt:
    """Turn of a gear's axis: the deviation [rad] times `axis`, a unit vector of the gear's frame at rest.

    Planar (components x, y): the axis leans towards the vector as `plane` turns it, by the vector's length.
    `per_length` [1/mm] makes an angle of a deviation that is given as a length. The turn is about the point
    of the axis at z = `pivot` [mm] of that frame. It acts in all meshes of the gear, or in one only, in whose frame
    `axis` then is.
    """

    part: str
    axis: tuple[float, float, float] = (0.0, 0.0, 0.0)
    per_length: float = 1.0
    pivot: float = 0.0
    mesh: str | None = None
    plane: Plane = AS_COUNTED

    def matrix(self, azimuth: float) -> Array:
        """Rotation vector per component where it is planar, (3, 2), in a frame whose x lies at an azimuth [rad]."""
        (xx, xy), (yx, yy) = self.plane.seen_from(azimuth).matrix
        return self.per_length * np.array([[-yx, -yy], [xx, xy], [0.0, 0.0]])


@dataclass(frozen=True)
class AxesOffset:
    """Distance [mm] by which two axes that should meet pass each other: the driven one lies at +y of the mesh."""

    part: str
    mesh: str


@dataclass(frozen=True)
class Temperature:
    """Temperature of some parts above the reference 20 degC [K]; each grows by its own coefficient."""

    parts: tuple[str, ...]


@dataclass(frozen=True)
class ReducerBacklash:
    """Angular backlash of a data-sheet reducer, at the shaft that it drives [rad]."""

    reducer: str


@dataclass(frozen=True)
class Clocking:
    """Turn of a gear on its shaft [rad], about its own z."""

    part: str


@dataclass(frozen=True)
class Together:
    """Several effects of one deviation, such as a shaft that moves with all that it carries."""

    effects: tuple["SingleEffect", ...]


SingleEffect = (
    ToothThickness | TurningOffset | AxisOffset | AxisTilt | AxesOffset | Temperature | ReducerBacklash | Clocking
)
Effect = SingleEffect | Together


def turns_with_gears(effect: Effect) -> bool:
    """Whether its deviation turns with the gears that it acts on."""
    return isinstance(single_effects(effect)[0], TurningOffset)


def single_effects(effect: Effect) -> tuple[SingleEffect, ...]:
    """The effects that an effect is made of."""
    return effect.effects if isinstance(effect, Together) else (effect,)


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
