"""The solid of a socket: a round housing with a seat for a ball."""

import math

from tol3d.errors import GeometryError
from tol3d.parts.details import LEAST_WALL
from tol3d.parts.named_solid import NamedSolid
from tol3d.parts.turned import AXIS, section, turned


def ball_socket(ball_diameter: float, mouth: float, diameter: float, height: float) -> NamedSolid:
    """A cylinder along z that opens to +z; the origin is the centre of its seat [mm].

    A mouth as wide as the ball makes the seat a hemisphere; a narrower one reaches round the ball and keeps it. How the
    ball gets in, through a split or a cap, is not modelled. Faces: "seat" (spherical), "rim", "side", "bottom".

    Args:
        ball_diameter: of the seat.
        mouth: diameter of the opening in the rim.
        diameter: outside.
        height: from the bottom to the centre of the seat.

    Raises:
        GeometryError: a mouth wider than the seat, or a seat that leaves no wall.
    """
    seat = ball_diameter / 2
    if not LEAST_WALL <= mouth <= ball_diameter < math.inf:
        raise GeometryError(f"a mouth of {mouth:g} mm is wider than the seat of {ball_diameter:g} mm, or none")
    if not (seat + LEAST_WALL <= height < math.inf and seat + LEAST_WALL <= diameter / 2 < math.inf):
        raise GeometryError(
            f"a seat of {ball_diameter:g} mm leaves no wall in a socket of {diameter:g} mm, {height:g} mm high below it"
        )
    rim = math.sqrt(max(0.0, seat**2 - (mouth / 2) ** 2))
    corners = [
        ("bottom", 0.0, -height),
        ("side", diameter / 2, -height),
        ("rim", diameter / 2, rim),
        ("seat", mouth / 2, rim),
        (AXIS, 0.0, -seat),
    ]
    halfway = -seat * math.sqrt(0.5)
    return turned(section(corners, {"seat": (-halfway, halfway)}), "the socket")
