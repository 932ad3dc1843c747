"""The gap between one pin and one disc as they stand: a compiled part of the contact kernels.

Newton's method finds no turn at which a pin touches where none would have it touch, at a root whose lever is next to
nothing, or where the flank bends within micrometres. Whether such a pin is in the way is told by its gap where the
others stop the disc.
"""

from typing import Any, Final

import numpy as np

from tol3d.cycloid.contact_newton import FOOT_XTOL, MOST_STEPS, TURN, lobe_at, lobe_turn, seen_from_lobe
from tol3d.numerics.compiled import part

FEET: Final = 64  # parameters over a lobe, from the nearest of which Newton's method starts


@part
def standing_gap(
    shape: Any, linkage: Any, clock: float, flanks: Any, pin: Any, phi: float, u: float, turn: float, lean: Any
) -> float:
    """Gap along the normal [mm] between a pin and a section of a disc; below 0 they overlap, -inf where it is unknown.

    Args:
        shape, linkage, clock, flanks, pin, phi, u, lean: see contact_newton.touched.
        turn: of the carrier beyond -phi / Zc [rad].
    """
    lobe_pitch, lobe_profile = flanks
    shortening = shape.eccentricity * shape.pins / shape.ground_circle
    own = clock + lobe_turn(shape, lobe_pitch, lobe_at(u, shape.lobes), np.sin(shape.lobes * u))
    x, y, _, _ = seen_from_lobe(shape, linkage, phi, turn, pin, own, lean)
    nearest, foot = np.inf, u
    for k in range(FEET + 1):
        at = u + TURN / shape.lobes * (k / FEET - 0.5)
        off_x = x - shape.ground_circle * np.cos(at) + shape.eccentricity * np.cos(shape.pins * at)
        off_y = y - shape.ground_circle * np.sin(at) + shape.eccentricity * np.sin(shape.pins * at)
        if off_x * off_x + off_y * off_y < nearest:
            nearest, foot = off_x * off_x + off_y * off_y, at
    for _ in range(MOST_STEPS):
        c, s, e, f = np.cos(foot), np.sin(foot), np.cos(shape.pins * foot), np.sin(shape.pins * foot)
        lobe = lobe_at(foot, shape.lobes)
        own = clock + lobe_turn(shape, lobe_pitch, lobe, f * c - e * s)
        x, y, tau_x, tau_y = seen_from_lobe(shape, linkage, phi, turn, pin, own, lean)
        speed = np.sqrt((c - shortening * e) ** 2 + (s - shortening * f) ** 2)
        n_x, n_y = (c - shortening * e) / speed, (s - shortening * f) / speed
        leans = n_x * tau_x + n_y * tau_y
        stands = pin[2] / np.sqrt(1.0 + leans * leans)
        off_x = x - shape.ground_circle * c + shape.eccentricity * e - stands * leans * tau_x
        off_y = y - shape.ground_circle * s + shape.eccentricity * f - stands * leans * tau_y
        away = n_x * off_x + n_y * off_y
        bend = 1.0 + shortening * (shortening * shape.pins - (1.0 + shape.pins) * (e * c + f * s))
        along = shape.ground_circle * speed + away * bend / (speed * speed)
        if not along > 0.0:
            return -np.inf
        step = (n_x * off_y - n_y * off_x) / along
        if abs(step) < FOOT_XTOL:
            gap: float = away - stands + shape.ground_radius - lobe_profile[lobe]
            return gap
        foot += step
    return -np.inf
