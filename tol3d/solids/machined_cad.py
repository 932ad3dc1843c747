"""The CAD side of machined parts: their builders of tol3d.parts."""

from tol3d.parts.block import block
from tol3d.parts.bracket import bracket
from tol3d.parts.cover import cover
from tol3d.parts.housing import housing
from tol3d.parts.named_solid import NamedSolid
from tol3d.parts.plate import plate
from tol3d.solids.machined import Block, Bracket, Cover, Housing, Plate


def plate_of(shape: Plate) -> NamedSolid:
    """The solid of a plate."""
    return plate(shape.length, shape.width, shape.thickness, shape.holes, shape.slots, shape.pins)


def block_of(shape: Block) -> NamedSolid:
    """The solid of a block."""
    return block(shape.length, shape.width, shape.height, shape.holes, shape.slots, shape.pins)


def bracket_of(shape: Bracket) -> NamedSolid:
    """The solid of a bracket."""
    return bracket(shape.length, shape.height, shape.width, shape.thickness, shape.fillet, shape.holes)


def housing_of(shape: Housing) -> NamedSolid:
    """The solid of a housing."""
    return housing(
        shape.corner,
        shape.size,
        shape.walls,
        shape.floor,
        shape.bores,
        shape.holes,
        shape.bosses,
        shape.pins,
        shape.opening,
    )


def cover_of(shape: Cover) -> NamedSolid:
    """The solid of a cover."""
    return cover(shape.length, shape.width, shape.thickness, shape.holes, shape.spigot, shape.slots)
