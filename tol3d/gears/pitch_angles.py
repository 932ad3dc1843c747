"""Pitch angles of a bevel pair from its teeth and the angle between its shafts."""

import math

from tol3d.errors import GeometryError


def pitch_angles(pinion_teeth: int, wheel_teeth: int, shaft_angle: float) -> tuple[float, float]:
    """Pitch angles [rad] of pinion and wheel: tan(delta_1) = sin(Sigma)/(z_2/z_1 + cos(Sigma)).

    Raises:
        GeometryError: the shaft angle [rad] is not between 0 and 180 deg, or a pitch cone would be flat or hollow.

    >>> [round(math.degrees(angle), 4) for angle in pitch_angles(17, 43, math.radians(90))]
    [21.5713, 68.4287]
    """
    degrees = math.degrees(shaft_angle)
    if not 0.0 < shaft_angle < math.pi:
        raise GeometryError(f"shaft_angle: expected more than 0 and less than 180 deg, got {degrees:g} deg")
    sin, cos = math.sin(shaft_angle), math.cos(shaft_angle)
    pinion = math.atan2(sin, wheel_teeth / pinion_teeth + cos)
    wheel = math.atan2(sin, pinion_teeth / wheel_teeth + cos)
    for name, angle in (("driver", pinion), ("driven", wheel)):
        if angle >= math.pi / 2:
            raise GeometryError(
                f"shaft_angle {degrees:g} deg: with {pinion_teeth} and {wheel_teeth} teeth the {name} gear's pitch "
                f"angle would be {math.degrees(angle):.4f} deg, expected less than 90 deg"
            )
    return pinion, wheel
