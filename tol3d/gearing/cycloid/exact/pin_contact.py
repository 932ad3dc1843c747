"""One pin of a cycloid stage and one disc: the turn at which they touch, and their gap; parts of the contact kernels.

Unknown are the carrier's turn delta and the parameter u of the foot on the path c of pin centres that the disc is
ground for. In the frame of the lobe that is touched, the pin's centre q lies off the foot by d = r_pin - r_ground +
f_profile along the normal n = -i c'/|c'|:

    q(delta) = c(u) + d n(u),   dq/d delta = -i (q + rho a e^(i Zp u)) but for terms in errors.

A disc that leans meets the pin in each of its sections as an ellipse whose centre moves across the section by tau per
height, tau the tangent of the lean: q is stretched by 1 / cos(lean) along tau, zeta tau is added at the height zeta,
and the ellipse of a pin of radius r stands off by r (n + tau (tau . n)) / sqrt(1 + (tau . n)^2) instead of r n.

Newton's method solves both coordinates at once. The rate leaves terms in errors out, some 1e-4 of it, so that each step
still gains four digits; d n/du is exact. See contact.py for the pose and for what errors move. It finds no
turn at which a pin touches where none would have it touch, at a root whose lever is next to nothing, or where the flank
bends within micrometres. Whether such a pin is in the way is told by its gap where the others stop the disc.
"""

from typing import Any, Final, NamedTuple

import numpy as np

from tol3d.numerics.compiled import part
from tol3d.numerics.quick_angles import turned_by

MOST_STEPS: Final = 30  # three are needed where errors are some 20 um
TURN_XTOL: Final = 1e-11  # rad; the next step is a thousandth of it
FOOT_XTOL: Final = 1e-9  # rad, of a foot alone; gaps change by the square of it
LAST_FOOT_XTOL: Final = 1e-8  # rad, of a foot that is found with a turn: the next step is a thousandth of it
SETTLED: Final = 0.01  # of the step before; Newton's method then errs by less than its last step
LONGEST_STEP: Final = 0.05  # of a lobe pitch, by which the foot moves
TURN: Final = 2.0 * np.pi


class ContactShape(NamedTuple):
    """Nominal numbers that a contact kernel reads [mm, rad]; counts are floats, too.

    Attributes:
        pins, lobes: Zp and Zc.
        eccentricity: a.
        ground_circle, ground_radius: of the pins that the discs are ground for: shift and offset are in them.
        pin_circle, pin_radius: rp and r.
        rotation: of the right flanks, as tol3d.gearing.cycloid.model.profile has it.
        window: least lever of a working pin over a Zc.
        rolling: turns of the cranks in space per turn of the carrier where its transmission error turns it.
        sharpest: largest curvature of convex parts of the ground path [1/mm].
        sharpest_cosine: cosine of its phase.
        deflection: pins with at most this gap in contact are counted; below 0 for no count.
    """

    pins: float
    lobes: float
    eccentricity: float
    ground_circle: float
    ground_radius: float
    pin_circle: float
    pin_radius: float
    rotation: float
    window: float
    rolling: float
    sharpest: float
    sharpest_cosine: float
    deflection: float


@part
def placed(linkage: Any, cos_phi: float, sin_phi: float, cos_chi: float, sin_chi: float) -> Any:
    """The disc's turn off the nominal frame's, as cosine and sine, and its centre [mm]; see contact.linkage."""
    x = cos_chi * linkage[6] - sin_chi * linkage[7] + cos_phi * linkage[8] - sin_phi * linkage[9]
    y = sin_chi * linkage[6] + cos_chi * linkage[7] + sin_phi * linkage[8] + cos_phi * linkage[9]
    size = 1.0 / np.sqrt(x * x + y * y)
    cos_psi, sin_psi = x * size, y * size
    centre_x = cos_chi * linkage[0] - sin_chi * linkage[1] + cos_phi * linkage[2] - sin_phi * linkage[3]
    centre_y = sin_chi * linkage[0] + cos_chi * linkage[1] + sin_phi * linkage[2] + cos_phi * linkage[3]
    centre_x -= cos_psi * linkage[4] - sin_psi * linkage[5]
    centre_y -= sin_psi * linkage[4] + cos_psi * linkage[5]
    return cos_psi, sin_psi, centre_x, centre_y


@part
def lobe_at(u: float, lobes: float) -> int:
    """The lobe on which a parameter lies, 0 to lobes - 1."""
    turns = u * (lobes / TURN)
    lobe = int(np.floor(turns - lobes * np.floor(turns * (1.0 / lobes))))
    return lobe if lobe < int(lobes) else 0


@part
def lobe_turn(shape: Any, lobe_pitch: Any, lobe: int, right: float) -> float:
    """Turn of a flank about the disc's axis [rad]: its lobe's pitch error, and the modification."""
    turned: float = shape.rotation if right > 0.0 else -shape.rotation
    found: float = lobe_pitch[lobe] * (shape.pins / (shape.lobes * shape.pin_circle)) + turned
    return found


@part
def crank_at(shape: Any, phi: float) -> tuple[float, float, float, float, float]:
    """A crank angle, and cosine and sine of it and of the nominal turn of the carrier."""
    chi = -phi / shape.lobes
    return phi, np.cos(phi), np.sin(phi), np.cos(chi), np.sin(chi)


@part
def write_facing(shape: Any, throw: float, crank: Any, facing: Any) -> None:
    """Write how a disc's profile faces the pins at a crank angle; `facing` has 9 numbers.

    They are the parameter of its foot at the first pin, cosine and sine of it, of as many times it as there are pins,
    and, which are given, of the profile's turn against its crank holes, and of the throw's direction.
    """
    facing[0] = (crank[0] + throw) / shape.lobes
    c, s = crank[3] * facing[5] - crank[4] * facing[6], -crank[4] * facing[5] - crank[3] * facing[6]
    cos, sin = crank[1] * facing[7] - crank[2] * facing[8], crank[2] * facing[7] + crank[1] * facing[8]
    facing[1], facing[2] = c, s
    facing[3], facing[4] = cos * c - sin * s, sin * c + cos * s


@part
def seen_from_lobe(shape: Any, linkage: Any, crank: Any, turn: float, pin: Any, own: Any, lean: Any) -> Any:
    """Contact point of a pin and a section of a disc, and tau, in the frame of a lobe turned by own in its disc.

    Args:
        crank: of crank_at.
        own: cosine and sine.
    """
    tau_x, tau_y, height = lean
    _, cos_phi, sin_phi, cos_chi, sin_chi = crank
    cos_phi, sin_phi = turned_by(cos_phi, sin_phi, shape.rolling * turn)
    cos_chi, sin_chi = turned_by(cos_chi, sin_chi, turn)
    cos_psi, sin_psi, x, y = placed(linkage, cos_phi, sin_phi, cos_chi, sin_chi)
    x, y = pin[0] - x, pin[1] - y
    x, y = cos_psi * x + sin_psi * y, cos_psi * y - sin_psi * x
    if tau_x != 0.0 or tau_y != 0.0:
        stretch = 1.0 / (1.0 + np.sqrt(1.0 + tau_x * tau_x + tau_y * tau_y))  # (1 / cos - 1) / tan^2
        across = stretch * (tau_x * x + tau_y * y) + height
        x, y = x + across * tau_x, y + across * tau_y
    c, s = own
    return c * x + s * y, c * y - s * x, c * tau_x + s * tau_y, c * tau_y - s * tau_x


@part
def touched(
    shape: Any, linkage: Any, facing: Any, flanks: Any, pin: Any, crank: Any, u: float, extra: float, lean: Any,
    sense: float, enough: float,
) -> tuple[float, float, bool]:  # fmt: skip
    """The carrier's turn [rad] at which one pin touches one section of a disc, beyond -phi / Zc.

    A step that is settled, the foot near, is more than what is left to go: a turn beyond what is enough is only shown
    to be so, not found.

    Args:
        shape: ContactShape.
        linkage: of the disc (10,).
        facing: of the disc, see write_facing.
        flanks: pitch and profile errors of the disc's lobes.
        pin: x and y of its centre, its radius [mm], and cosine and sine of its azimuth.
        crank: of crank_at.
        u: where the foot is sought first [rad].
        extra: added to the pin's radius [mm].
        lean: tau in the frame of the disc's holes, and the section's height [mm].
        sense, enough: turns beyond this one in a sense are all alike to who asks [rad]; infinite where they are not.

    Returns:
        The turn, the growth of the gap per height, and True if they were found.
    """
    lobe_pitch, lobe_profile = flanks
    longest = LONGEST_STEP * TURN / shape.lobes
    shortening = shape.eccentricity * shape.pins / shape.ground_circle
    c, s = pin[3] * facing[1] - pin[4] * facing[2], pin[4] * facing[1] + pin[3] * facing[2]
    e, f = facing[3], facing[4]
    turn, before = 0.0, 0.0
    for _ in range(MOST_STEPS):
        right = f * c - e * s  # sin(Zc u)
        lobe = lobe_at(u, shape.lobes)
        own = turned_by(facing[5], facing[6], lobe_turn(shape, lobe_pitch, lobe, right))
        x, y, tau_x, tau_y = seen_from_lobe(shape, linkage, crank, turn, pin, own, lean)
        speed = np.sqrt((c - shortening * e) ** 2 + (s - shortening * f) ** 2)
        n_x, n_y = (c - shortening * e) / speed, (s - shortening * f) / speed
        leans = n_x * tau_x + n_y * tau_y
        stands = pin[2] + extra if leans == 0.0 else (pin[2] + extra) / np.sqrt(1.0 + leans * leans)
        off = stands - shape.ground_radius + lobe_profile[lobe]
        miss_x = x - shape.ground_circle * c + shape.eccentricity * e - off * n_x - stands * leans * tau_x
        miss_y = y - shape.ground_circle * s + shape.eccentricity * f - off * n_y - stands * leans * tau_y
        arm = shape.rolling * shape.eccentricity
        rate_x, rate_y = y + arm * f, -(x + arm * e)
        step = -(n_x * miss_x + n_y * miss_y) / (n_x * rate_x + n_y * rate_y)
        cos_phase = e * c + f * s
        bend = 1.0 + shortening * (shortening * shape.pins - (1.0 + shape.pins) * cos_phase)
        along = shape.ground_circle * speed + off * bend / (speed * speed)
        foot = (-n_y * (miss_x + rate_x * step) + n_x * (miss_y + rate_y * step)) / along
        if not along > 0.0 or not abs(step) < 1.0:
            return np.nan, leans, False
        foot = min(max(foot, -longest), longest)
        turn += step
        u += foot
        if abs(step) < TURN_XTOL and abs(foot) < LAST_FOOT_XTOL:
            return turn, leans, True
        if abs(step) < SETTLED * before and abs(foot) < longest and sense * turn - abs(step) > enough:
            return turn, leans, True
        before = abs(step)
        c, s = turned_by(c, s, foot)
        e, f = turned_by(e, f, shape.pins * foot)
    return np.nan, 0.0, False


FEET: Final = 64  # parameters over a lobe, from the nearest of which Newton's method starts


@part
def standing_gap(
    shape: Any, linkage: Any, clock: float, flanks: Any, pin: Any, crank: Any, u: float, turn: float, lean: Any
) -> float:
    """Gap along the normal [mm] between a pin and a section of a disc; below 0 they overlap, -inf where it is unknown.

    Args:
        shape, linkage, clock, flanks, pin, crank, u, lean: see touched.
        turn: of the carrier beyond -phi / Zc [rad].
    """
    lobe_pitch, lobe_profile = flanks
    shortening = shape.eccentricity * shape.pins / shape.ground_circle
    cos_clock, sin_clock = np.cos(clock), np.sin(clock)
    turned = lobe_turn(shape, lobe_pitch, lobe_at(u, shape.lobes), np.sin(shape.lobes * u))
    own = turned_by(cos_clock, sin_clock, turned)
    x, y, _, _ = seen_from_lobe(shape, linkage, crank, turn, pin, own, lean)
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
        own = turned_by(cos_clock, sin_clock, lobe_turn(shape, lobe_pitch, lobe, f * c - e * s))
        x, y, tau_x, tau_y = seen_from_lobe(shape, linkage, crank, turn, pin, own, lean)
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
