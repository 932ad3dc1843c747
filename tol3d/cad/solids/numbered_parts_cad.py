"""The CAD side of machined parts: their builders of tol3d.parts.

The CAD side of parts of linkages: their builders of tol3d.parts.
"""

from tol3d.cad.solids.numbered_parts import (
    BallScrew,
    BallSocket,
    Block,
    Bracket,
    CastLink,
    Cover,
    Housing,
    Nut,
    Plate,
    Rod,
    SphericalGear,
    ThrustRing,
)
from tol3d.parts.ball_screw import ball_screw
from tol3d.parts.ball_socket import ball_socket
from tol3d.parts.block import block
from tol3d.parts.bracket import bracket
from tol3d.parts.cast_link import cast_link
from tol3d.parts.cover import cover
from tol3d.parts.ear import Ear
from tol3d.parts.housing import housing
from tol3d.parts.named_solid import NamedSolid
from tol3d.parts.nut import nut
from tol3d.parts.plate import plate
from tol3d.parts.rod import rod
from tol3d.parts.spherical_gear import spherical_gear
from tol3d.parts.thrust_ring import thrust_ring


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


def cast_link_of(shape: CastLink) -> NamedSolid:
    """The solid of a link."""
    return cast_link(shape.proximal, shape.distal, shape.wall, shape.body)


def rod_of(shape: Rod) -> NamedSolid:
    """The solid of a rod."""
    return rod(shape.length, shape.diameter, shape.ball_diameter)


def ball_socket_of(shape: BallSocket) -> NamedSolid:
    """The solid of a socket."""
    return ball_socket(shape.ball_diameter, shape.mouth, shape.diameter, shape.height)


def nut_of(shape: Nut) -> NamedSolid:
    """The solid of a nut."""
    return nut(shape.diameter, shape.length, shape.bore, shape.reach, shape.ear_width, shape.ball_diameter)


def ball_screw_of(shape: BallScrew) -> NamedSolid:
    """The solid of the shaft of a ball screw."""
    return ball_screw(shape.diameter, shape.length, shape.journal)


def thrust_ring_of(shape: ThrustRing) -> NamedSolid:
    """The solid of a thrust ring."""
    ears = [Ear(name, angle) for name, angle in shape.ears]
    return thrust_ring(
        shape.inner_diameter,
        shape.outer_diameter,
        shape.thickness,
        shape.radius,
        shape.ear_width,
        shape.ball_diameter,
        ears,
    )


def spherical_gear_of(shape: SphericalGear) -> NamedSolid:
    """The solid of a spherical gear."""
    return spherical_gear(shape.section, shape.reach, tooth_at_pole=shape.tooth_at_pole, bore=shape.bore)
