"""The solid of a nut: a cylinder with a bore, and an ear at its side with a seat for a ball."""

from tol3d.parts.ear import Ear, Eared
from tol3d.parts.named_solid import NamedSolid


def nut(
    diameter: float, length: float, bore: float, reach: float, ear_width: float, ball_diameter: float
) -> NamedSolid:
    """A cylinder along z from the middle of its bottom, which is the origin; its ear is at +x [mm].

    The seat of the ear is a hemisphere in its top, about a centre at z = length. The thread is not cut: the bore is a
    cylinder. Faces: "bore", "seat" (spherical), "top", "bottom", "side", "ear left" (+y), "ear right", "ear end".

    Args:
        diameter: outside.
        length: along z, of the ear as well.
        bore: diameter.
        reach: from the axis to the centre of the seat.
        ear_width: along y.
        ball_diameter: of the seat.

    Raises:
        GeometryError: a nut without a wall round its bore or its seat, or an ear that does not leave it.
    """
    made = Eared(diameter, bore, length, reach, ear_width, ball_diameter)
    made.refuse("a nut")
    swept = made.swept([Ear("ear", 0.0)], ["side"], "the nut")
    return made.seated(swept, [Ear("seat", 0.0)], length, "the nut")
