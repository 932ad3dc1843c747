"""The arc between a spur gear's flank and its root circle."""

import math


def fillet_azimuth(radius: float, root_radius: float, base_radius: float, base_half_angle: float) -> float:
    """Azimuth [rad] of the fillet's centre off the tooth's middle.

    An offset of an involute is the same involute turned, so the centre of an arc that touches flank and root circle is
    in closed form: on the involute of roll t + radius/r_b. Where the arc would touch below the base circle it touches
    the radial line instead.

    Args:
        radius: of the fillet [mm].
        root_radius, base_radius: of the gear [mm].
        base_half_angle: half a tooth at the base circle [rad].
    """
    centre = root_radius + radius
    beyond = centre**2 - base_radius**2
    if beyond > radius**2:
        along = math.sqrt(beyond)
        roll = (along - radius) / base_radius
        return base_half_angle - roll + math.atan2(along, base_radius)
    return base_half_angle + math.asin(radius / centre)
