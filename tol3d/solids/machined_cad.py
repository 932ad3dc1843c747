"""The CAD side of machined parts: their builders of tol3d.parts."""

from tol3d.parts.named_solid import NamedSolid
from tol3d.parts.plate import plate
from tol3d.solids.machined import Plate


def plate_of(shape: Plate) -> NamedSolid:
    """The solid of a plate."""
    return plate(shape.length, shape.width, shape.thickness, shape.holes, shape.slots, shape.pins)
