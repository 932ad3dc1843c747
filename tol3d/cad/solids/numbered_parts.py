"""Machined parts by their numbers [mm, rad]. Loads no CAD.

Parts of linkages by their numbers [mm, rad]. Loads no CAD.
"""

from dataclasses import dataclass
from typing import ClassVar

from tol3d.cad.solids.built_shape import BuiltShape
from tol3d.gears import SpurGear
from tol3d.parts.details import Bore, Boss, Hole, Pin, Slot, Spigot
from tol3d.parts.link_ends import Distal, Proximal

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Plate(BuiltShape):
    """See tol3d.parts.plate."""

    builder: ClassVar[str] = "tol3d.cad.solids.numbered_parts_cad:plate_of"

    length: float
    width: float
    thickness: float
    holes: tuple[Hole, ...] = ()
    slots: tuple[Slot, ...] = ()
    pins: tuple[Pin, ...] = ()


@dataclass(frozen=True)
class Block(BuiltShape):
    """See tol3d.parts.block."""

    builder: ClassVar[str] = "tol3d.cad.solids.numbered_parts_cad:block_of"

    length: float
    width: float
    height: float
    holes: tuple[Hole, ...] = ()
    slots: tuple[Slot, ...] = ()
    pins: tuple[Pin, ...] = ()


@dataclass(frozen=True)
class Bracket(BuiltShape):
    """See tol3d.parts.bracket."""

    builder: ClassVar[str] = "tol3d.cad.solids.numbered_parts_cad:bracket_of"

    length: float
    height: float
    width: float
    thickness: float
    fillet: float = 0.0
    holes: tuple[Hole, ...] = ()


@dataclass(frozen=True)
class Housing(BuiltShape):
    """See tol3d.parts.housing."""

    builder: ClassVar[str] = "tol3d.cad.solids.numbered_parts_cad:housing_of"

    corner: Point
    size: Point
    walls: float
    floor: float
    bores: tuple[Bore, ...] = ()
    holes: tuple[Hole, ...] = ()
    bosses: tuple[Boss, ...] = ()
    pins: tuple[Pin, ...] = ()
    opening: str = "top"


@dataclass(frozen=True)
class Cover(BuiltShape):
    """See tol3d.parts.cover."""

    builder: ClassVar[str] = "tol3d.cad.solids.numbered_parts_cad:cover_of"

    length: float
    width: float
    thickness: float
    holes: tuple[Hole, ...] = ()
    spigot: Spigot | None = None
    slots: tuple[Slot, ...] = ()


@dataclass(frozen=True)
class CastLink(BuiltShape):
    """See tol3d.parts.cast_link."""

    builder: ClassVar[str] = "tol3d.cad.solids.numbered_parts_cad:cast_link_of"

    proximal: Proximal
    distal: Distal
    wall: float
    body: float | None = None


@dataclass(frozen=True)
class Rod(BuiltShape):
    """See tol3d.parts.rod."""

    builder: ClassVar[str] = "tol3d.cad.solids.numbered_parts_cad:rod_of"

    length: float
    diameter: float
    ball_diameter: float


@dataclass(frozen=True)
class BallSocket(BuiltShape):
    """See tol3d.parts.ball_socket."""

    builder: ClassVar[str] = "tol3d.cad.solids.numbered_parts_cad:ball_socket_of"

    ball_diameter: float
    mouth: float
    diameter: float
    height: float


@dataclass(frozen=True)
class Nut(BuiltShape):
    """See tol3d.parts.nut."""

    builder: ClassVar[str] = "tol3d.cad.solids.numbered_parts_cad:nut_of"

    diameter: float
    length: float
    bore: float
    reach: float
    ear_width: float
    ball_diameter: float


@dataclass(frozen=True)
class BallScrew(BuiltShape):
    """See tol3d.parts.ball_screw; its journal by diameter and length."""

    builder: ClassVar[str] = "tol3d.cad.solids.numbered_parts_cad:ball_screw_of"

    diameter: float
    length: float
    journal: tuple[float, float] | None = None


@dataclass(frozen=True)
class ThrustRing(BuiltShape):
    """See tol3d.parts.thrust_ring; its ears by name and angle."""

    builder: ClassVar[str] = "tol3d.cad.solids.numbered_parts_cad:thrust_ring_of"

    inner_diameter: float
    outer_diameter: float
    thickness: float
    radius: float
    ear_width: float
    ball_diameter: float
    ears: tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class SphericalGear(BuiltShape):
    """See tol3d.parts.spherical_gear; its bore by diameter and depth."""

    builder: ClassVar[str] = "tol3d.cad.solids.numbered_parts_cad:spherical_gear_of"

    teeth: int
    module: float
    pressure_angle: float
    reach: float
    tooth_at_pole: bool
    thinned: float = 0.0
    bore: tuple[float, float] | None = None

    @property
    def section(self) -> SpurGear:
        """The spur gear whose profile it has; its width does not matter.

        Raises:
            GeometryError: there is none.
        """
        return SpurGear(
            self.teeth, self.module, self.pressure_angle, self.module, tooth_thickness_deviation=-self.thinned
        )
