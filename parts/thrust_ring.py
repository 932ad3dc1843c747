"""The solid of a thrust ring: a ring with ears, in each of which is a seat for a ball."""

import math
from collections.abc import Sequence

from tol3d.errors import GeometryError
from tol3d.parts.ear import Ear, Eared
from tol3d.parts.named_solid import NamedSolid


def thrust_ring(
    inner_diameter: float,
    outer_diameter: float,
    thickness: float,
    radius: float,
    ear_width: float,
    ball_diameter: float,
    ears: Sequence[Ear],
) -> NamedSolid:
    """A ring about z on the plane z = 0, in whose middle the origin is: the centre about which it swings [mm].

    The seats are hemispheres in its bottom, about centres in the plane z = 0. Faces: "bore", "top" (z = thickness),
    "bottom", "side 1" and so on, counter-clockwise behind each ear; of an ear, "NAME", its seat (spherical), "NAME
    left" and "NAME right" as seen from the origin with +z up, "NAME end".

    Args:
        inner_diameter, outer_diameter: of the ring.
        thickness: along z.
        radius: of the circle on which the centres of the seats lie.
        ear_width: of all ears.
        ball_diameter: of all seats.
        ears: by name and angle; at least one.

    Raises:
        GeometryError: a ring without a wall round its bore or its seats, ears that overlap or do not leave it.
    """
    if not ears:
        raise GeometryError("a thrust ring has no ears: expected one at least")
    made = Eared(outer_diameter, inner_diameter, thickness, radius, ear_width, ball_diameter)
    made.refuse("a ring")
    ordered = sorted((Ear(ear.name, ear.angle % (2 * math.pi)) for ear in ears), key=lambda ear: ear.angle)
    swept = made.swept(ordered, [f"side {k}" for k in range(1, len(ordered) + 1)], "the ring")
    return made.seated(swept, ordered, 0.0, "the ring")
