"""The CAD side of parts of linkages: their builders of tol3d.parts."""

from tol3d.parts.ball_screw import ball_screw
from tol3d.parts.ball_socket import ball_socket
from tol3d.parts.ear import Ear
from tol3d.parts.named_solid import NamedSolid
from tol3d.parts.nut import nut
from tol3d.parts.rod import rod
from tol3d.parts.spherical_gear import spherical_gear
from tol3d.parts.thrust_ring import thrust_ring
from tol3d.solids.linkage_parts import BallScrew, BallSocket, Nut, Rod, SphericalGear, ThrustRing


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
