"""The solid of a rod between two balls."""

import math

from tol3d.errors import GeometryError
from tol3d.parts.details import LEAST_WALL
from tol3d.parts.named_solid import NamedSolid
from tol3d.parts.turned import AXIS, section, turned


def rod(length: float, diameter: float, ball_diameter: float) -> NamedSolid:
    """A round rod along z from the centre of its bottom ball, which is the origin, to that of its top ball [mm].

    Faces: "bottom ball", "side", "top ball".

    Args:
        length: between the centres of both balls.
        diameter: of the rod.
        ball_diameter: of both balls.

    Raises:
        GeometryError: a rod that is not thinner than its balls, or of which the balls leave nothing.
    """
    if not LEAST_WALL <= diameter <= ball_diameter - LEAST_WALL < math.inf:
        raise GeometryError(f"a rod of {diameter:g} mm is not thinner than its balls of {ball_diameter:g} mm")
    ball = ball_diameter / 2
    begin = math.sqrt(ball**2 - (diameter / 2) ** 2)
    if not 2 * begin + LEAST_WALL <= length < math.inf:
        raise GeometryError(
            f"balls of {ball_diameter:g} mm with centres {length:g} mm apart leave nothing of the rod between them"
        )
    corners = [
        ("bottom ball", 0.0, -ball),
        ("side", diameter / 2, begin),
        ("top ball", diameter / 2, length - begin),
        (AXIS, 0.0, length + ball),
    ]
    return turned(section(corners, {"bottom ball": (ball, 0.0), "top ball": (ball, length)}), "the rod")
