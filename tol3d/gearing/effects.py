"""Effects: on what one deviation acts, and in which sense. Data for both methods; each has its own formulas for it."""

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from typing_extensions import override

from tol3d.gearing.raceways import ObliqueContact, Raceways
from tol3d.gearing.shafts import Mesh
from tol3d.gears.flank import Flank
from tol3d.gears.tooth_measures import ToothMeasure
from tol3d.numerics.arrays import Array


class Effect(ABC):
    """Effect of a deviation. Frozen data.

    The geometric method reads its displacements (builds/), the analytic method its terms (stack_up/terms.py), each
    registered there for the class of the effect.
    """

    @property
    def singles(self) -> tuple["Effect", ...]:
        """Its elementary effects; itself alone."""
        return (self,)

    @property
    def reversed(self) -> "Effect":
        """Effect while the other flanks carry the load; itself if the load moves nothing."""
        return self

    @abstractmethod
    def acts_in(self, mesh: Mesh) -> bool:
        """True if it changes the relative position of the gears of a mesh, or their flanks."""

    def clocking(self, mesh: Mesh) -> float:
        """Turn of the shaft that a mesh drives, about the driven gear's z, with the teeth in contact [rad per unit]."""
        return 0.0

    def acts_on(self, link: str) -> bool:
        """True if it is a deviation of a link that is no gear mesh."""
        return False

    def slides(self, shaft: str) -> bool:
        """True if it lets a shaft slide along its axis."""
        return False

    @property
    def turns_with(self) -> str | None:
        """The gear with which the deviation turns; None where it rests."""
        return None

    def deviates_teeth(self, gear: str) -> bool:
        """True if it makes the teeth of a gear differ from each other, so that curves have tooth-mesh orders."""
        return False

    @property
    def mirrored(self) -> bool:
        """True if the deviation's azimuths count against those of the gear with which it turns."""
        return False


@dataclass(frozen=True)
class CombinedEffect(Effect):
    """Several effects of one deviation, such as a shaft that moves with all that it carries."""

    effects: tuple[Effect, ...]

    @property
    @override
    def singles(self) -> tuple[Effect, ...]:
        return self.effects

    @override
    def acts_in(self, mesh: Mesh) -> bool:
        return any(effect.acts_in(mesh) for effect in self.effects)

    @override
    def clocking(self, mesh: Mesh) -> float:
        return sum(effect.clocking(mesh) for effect in self.effects)

    @override
    def acts_on(self, link: str) -> bool:
        return any(effect.acts_on(link) for effect in self.effects)

    @override
    def slides(self, shaft: str) -> bool:
        return any(effect.slides(shaft) for effect in self.effects)

    @override
    def deviates_teeth(self, gear: str) -> bool:
        return any(effect.deviates_teeth(gear) for effect in self.effects)

    @property
    def turns_with(self) -> str | None:
        """The first gear: they all turn alike."""
        return self.effects[0].turns_with if self.effects else None

    @property
    def mirrored(self) -> bool:
        """Flag of the same gear."""
        return self.effects[0].mirrored if self.effects else False


NOTHING = CombinedEffect(())


@dataclass(frozen=True)
class Reversing(CombinedEffect):
    """Several effects of one deviation while the working flanks carry the load, as many while the others do.

    A shaft crosses its clearance where the load changes sides.

    Args:
        others: in the same order, of the same classes and parts.
    """

    others: tuple[Effect, ...] = ()

    @property
    @override
    def reversed(self) -> CombinedEffect:
        return CombinedEffect(self.others)


Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Plane:
    """Orientation of a gear to the frame of a deviation with a direction, such as its shaft's frame.

    Args:
        azimuth: of that frame's x axis in the gear's frame [rad].
        mirrored: True if the two count azimuths in opposite senses, as a gear that faces backward on its shaft.
    """

    azimuth: float = 0.0
    mirrored: bool = False

    @property
    def matrix(self) -> Array:
        """(x, y) of the gear's frame from (x, y) of the other, (2, 2)."""
        cos, sin, sense = math.cos(self.azimuth), math.sin(self.azimuth), -1.0 if self.mirrored else 1.0
        return np.array([[cos, -sense * sin], [sin, sense * cos]])

    def seen_from(self, azimuth: float) -> "Plane":
        """The same in a frame whose x axis lies at an azimuth [rad] of the gear's."""
        return Plane(self.azimuth - azimuth, self.mirrored)


AS_COUNTED = Plane()


@dataclass(frozen=True)
class AxisOffset(Effect):
    """Shift of a gear's rotation axis [mm], in the gear's frame at rest.

    Scalar: `direction` (unit vector) times `factor` times the deviation. Planar (components x, y): `factor`
    times the vector as `plane` turns it. It acts in all meshes of the gear, or in one only, in whose frame
    `direction` then is.
    """

    part: str
    direction: Vector = (1.0, 0.0, 0.0)
    factor: float = 1.0
    mesh: str | None = None
    plane: Plane = AS_COUNTED

    def acts_in(self, mesh: Mesh) -> bool:
        """In every mesh of the gear, or in the one that is named."""
        return self.mesh in (None, mesh.name) and self.part in (mesh.driver, mesh.driven)


@dataclass(frozen=True)
class AxesOffset(Effect):
    """Distance [mm] by which two axes that should meet pass each other: the driven one lies at +y of the mesh."""

    part: str
    mesh: str

    def acts_in(self, mesh: Mesh) -> bool:
        """In that mesh."""
        return self.mesh == mesh.name


@dataclass(frozen=True)
class AxisTilt(Effect):
    """Turn of a gear's axis: the deviation [rad] times `axis`, a unit vector of the gear's frame at rest.

    Planar (components x, y): the axis leans towards the vector as `plane` turns it, by the vector's length.
    `per_length` [1/mm] makes an angle of a deviation that is given as a length. The turn is about the point
    of the axis at z = `pivot` [mm] of that frame. It acts in all meshes of the gear, or in one only, in whose frame
    `axis` then is.
    """

    part: str
    axis: Vector = (0.0, 0.0, 0.0)
    per_length: float = 1.0
    pivot: float = 0.0
    mesh: str | None = None
    plane: Plane = AS_COUNTED

    def matrix(self, azimuth: float) -> Array:
        """Rotation vector per component where it is planar, (3, 2), in a frame whose x lies at an azimuth [rad]."""
        (xx, xy), (yx, yy) = self.plane.seen_from(azimuth).matrix
        return self.per_length * np.array([[-yx, -yy], [xx, xy], [0.0, 0.0]])

    def acts_in(self, mesh: Mesh) -> bool:
        """In every mesh of the gear, or in the one that is named."""
        return self.mesh in (None, mesh.name) and self.part in (mesh.driver, mesh.driven)


@dataclass(frozen=True)
class Clocking(Effect):
    """Turn of a gear on its shaft [rad], about its own z."""

    part: str

    def acts_in(self, mesh: Mesh) -> bool:
        """A mesh finds its rest for any turn of its gears; the shafts turn, see `clocking`."""
        return False

    def clocking(self, mesh: Mesh) -> float:
        """A driver that sits ahead takes the driven gear with it; a driven gear ahead leaves its shaft behind."""
        return float(mesh.rate) * (self.part == mesh.driver) - (self.part == mesh.driven)


TINY: Final = 1e-12  # mm; a clearance of that length has no direction


@dataclass(frozen=True)
class AxialPlay(Effect):
    """Total play of a shaft along its axis [mm]: the deviation, or what a bearing with that radial clearance leaves.

    Nothing moves while a load stays on one side: where it changes, the shaft slides from one end to the other, and
    helical gears on it screw in their mates' teeth. By how much that turns a train is of its layout: model/slides.py.
    """

    shaft: str
    raceways: Raceways | None = None

    def acts_in(self, mesh: Mesh) -> bool:
        """Teeth have the same backlash wherever the shaft lies."""
        return False

    @override
    def slides(self, shaft: str) -> bool:
        return shaft == self.shaft

    def play(self, columns: Array) -> Array:
        """Play [mm] (trials,) of deviations (trials, components); of one with a direction by its length."""
        length = columns[:, 0] if columns.shape[1] == 1 else np.hypot(columns[:, 0], columns[:, 1])
        return length if self.raceways is None else self.raceways.axial(length)

    def rates(self, columns: Array) -> Array:
        """Its derivatives, (trials, components)."""
        planar = columns.shape[1] == 2
        length = np.hypot(columns[:, 0], columns[:, 1]) if planar else columns[:, 0]
        along = columns / np.maximum(length, TINY)[:, None] if planar else np.ones_like(columns)
        return along if self.raceways is None else along * self.raceways.slope(length)[:, None]

    @property
    def coefficient(self) -> float | None:
        """Play per deviation; None where it is not in proportion."""
        if self.raceways is None:
            return 1.0
        return 1 / math.tan(self.raceways.angle) if isinstance(self.raceways, ObliqueContact) else None


UNIFORM: Final = 0
SLOPE: Final = 1
FORM: Final = 2
HELIX: Final = 3
SHAPES: Final = 4
"""Shapes of an offset over a flank: constant, along the profile, in its form, along the face."""


@dataclass(frozen=True)
class Place:
    """A flank that a component of a deviation moves out of its tooth, by `factor` [mm/mm] along its normal."""

    tooth: int
    flank: Flank
    factor: float


@dataclass(frozen=True)
class FlankDeviation(Effect):
    """Offsets of single flanks of a gear along their normals, positive adds material.

    With the roll t of a point, its height z over the middle of the face b, and u = (t - t_mid)/(t_tip - t_form) over
    the whole involute: a mix of 1, u, a form and z/b, times the deviation.

    Args:
        part: the gear.
        shape: UNIFORM, SLOPE, FORM or HELIX: what the deviation is.
        places: by component of the deviation the flanks that it moves.
        waves: of a FORM, how many cosine waves there are over `span`, (1/2) cos(2 pi waves u); 0 for a barrel,
            1/3 - 4 u^2.
        mix: (SHAPES,), what one of the deviation adds to each; of its own shape alone where none is given.
        span: of waves, the rolls from which u goes from -1/2 to 1/2 [rad]; None over the whole involute.
    """

    part: str
    shape: int
    places: tuple[tuple[Place, ...], ...]
    waves: float = 0.0
    mix: tuple[float, ...] = ()
    span: tuple[float, float] | None = None

    @property
    def terms(self) -> Iterator[tuple[int, Place, int, float]]:
        """Component, flank and shape of each term, and the shape's amount per unit of the component."""
        mix = self.mix or tuple(float(shape == self.shape) for shape in range(SHAPES))
        for component, places in enumerate(self.places):
            for place in places:
                for shape, factor in enumerate(mix):
                    if factor:
                        yield component, place, shape, factor * place.factor

    def acts_in(self, mesh: Mesh) -> bool:
        """In every mesh of the gear."""
        return self.part in (mesh.driver, mesh.driven)

    @override
    def deviates_teeth(self, gear: str) -> bool:
        return gear == self.part


@dataclass(frozen=True)
class LinkDeviation(Effect):
    """A deviation of a link: what it does to the play is the link's own, see links/.

    Args:
        link: its name.
        turning: the part in the link with which the deviation turns; None where it rests.
    """

    link: str
    turning: str | None = None

    def acts_in(self, mesh: Mesh) -> bool:
        """It moves no axis and no flank."""
        return False

    def acts_on(self, link: str) -> bool:
        """On that link."""
        return link == self.link

    @property
    def turns_with(self) -> str | None:
        """The part in the link."""
        return self.turning


@dataclass(frozen=True)
class Temperature(Effect):
    """Temperature of some parts above the reference 20 degC [K]; each grows by its own coefficient."""

    parts: tuple[str, ...]

    def acts_in(self, mesh: Mesh) -> bool:
        """True if a gear of the mesh, or its housing, is one of the parts."""
        return not {mesh.driver, mesh.driven, mesh.housing}.isdisjoint(self.parts)


@dataclass(frozen=True)
class ToothThickness(Effect):
    """Deviation of the tooth thickness of a gear [mm], positive is thicker; half of it on each flank.

    Each flank turns out of its tooth by `turn` [rad/mm], and moves out along its normal by `offset` [mm/mm]. `over` is
    how the teeth are measured, where the scene says so.
    """

    part: str
    turn: float
    offset: float = 0.0
    over: ToothMeasure | None = None

    def acts_in(self, mesh: Mesh) -> bool:
        """In every mesh of the gear."""
        return self.part in (mesh.driver, mesh.driven)


@dataclass(frozen=True)
class TurningOffset(Effect):
    """Offset (x, y) [mm] of a gear's centre from its rotation axis, in the gear's frame; it turns with the gear."""

    part: str
    plane: Plane = AS_COUNTED

    def acts_in(self, mesh: Mesh) -> bool:
        """In every mesh of the gear."""
        return self.part in (mesh.driver, mesh.driven)

    @property
    def turns_with(self) -> str:
        """The gear."""
        return self.part

    @property
    def mirrored(self) -> bool:
        """As its plane is."""
        return self.plane.mirrored
