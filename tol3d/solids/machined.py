"""Machined parts by their numbers [mm, rad]: plates. Loads no CAD."""

from dataclasses import dataclass
from typing import ClassVar

from tol3d.parts.details import Hole, Pin, Slot
from tol3d.solids.built_shape import BuiltShape


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
