"""Machined parts by their numbers [mm, rad]. Loads no CAD."""

from dataclasses import dataclass
from typing import ClassVar

from tol3d.parts.details import Bore, Boss, Hole, Pin, Slot, Spigot
from tol3d.solids.built_shape import BuiltShape

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Plate(BuiltShape):
    """See tol3d.parts.plate."""

    builder: ClassVar[str] = "tol3d.solids.machined_cad:plate_of"

    length: float
    width: float
    thickness: float
    holes: tuple[Hole, ...] = ()
    slots: tuple[Slot, ...] = ()
    pins: tuple[Pin, ...] = ()


@dataclass(frozen=True)
class Block(BuiltShape):
    """See tol3d.parts.block."""

    builder: ClassVar[str] = "tol3d.solids.machined_cad:block_of"

    length: float
    width: float
    height: float
    holes: tuple[Hole, ...] = ()
    slots: tuple[Slot, ...] = ()
    pins: tuple[Pin, ...] = ()


@dataclass(frozen=True)
class Bracket(BuiltShape):
    """See tol3d.parts.bracket."""

    builder: ClassVar[str] = "tol3d.solids.machined_cad:bracket_of"

    length: float
    height: float
    width: float
    thickness: float
    fillet: float = 0.0
    holes: tuple[Hole, ...] = ()


@dataclass(frozen=True)
class Housing(BuiltShape):
    """See tol3d.parts.housing."""

    builder: ClassVar[str] = "tol3d.solids.machined_cad:housing_of"

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

    builder: ClassVar[str] = "tol3d.solids.machined_cad:cover_of"

    length: float
    width: float
    thickness: float
    holes: tuple[Hole, ...] = ()
    spigot: Spigot | None = None
    slots: tuple[Slot, ...] = ()
