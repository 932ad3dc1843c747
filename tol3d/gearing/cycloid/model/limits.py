"""Limits of the numbers of a cycloid disc: that it can be made, runs among its pins, and keeps walls between its holes.

Sources: the radius of curvature of a shortened epitrochoid, and its equidistant (F. L. Litvin, A. Fuentes, Gear
Geometry and Applied Theory, 2nd ed., Cambridge 2004, chapter 13), derived anew in profile.py.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from tol3d.gearing.cycloid.model.profile import UNMODIFIED, DiscProfile
from tol3d.gearing.cycloid.model.shapes import DiscHoles
from tol3d.numerics.arrays import Array

FEWEST_PINS: Final = 4
LEAST_GAP: Final = (
    1e-5  # mm; offset = shift sqrt(1 - K^2) overlaps by (K shift)^2 / (2 rp sqrt(1 - K^2)), 2e-6 at 20 um
)
LEAST_DIGIT: Final = 1e-3  # of the last digit printed
BISECTIONS: Final = 53  # of a share, to its last bit
PHASES: Final = 361  # of a flank where gaps are looked at; between two of them a gap differs by 1e-5 of its range
FEET: Final = 361  # points of a flank, from the nearest of which Newton's method starts
PROJECTIONS: Final = 20  # Newton steps at most; three or four are needed
PARAMETER_XTOL: Final = 1e-13  # rad
FLAT: Final = 1e-12  # of a distance's second derivative; keeps the step finite


@dataclass(frozen=True)
class Fault:
    """Reason why a disc cannot be made or run.

    Args:
        field: of DiscProfile, or of its Modification, that is at fault.
        words: what was expected, what came, and the remedy.
    """

    field: str
    words: str


def lobes_fault(lobes: int, pins: int) -> Fault | None:
    """Fault of a disc with this number of lobes among the pins; None if it runs.

    >>> lobes_fault(38, 40).words
    'expected 39 lobes, one fewer than the 40 pins, got 38; or take 39 pins'
    """
    if lobes == pins - 1:
        return None
    return Fault(
        "lobes", f"expected {pins - 1} lobes, one fewer than the {pins} pins, got {lobes}; or take {lobes + 1} pins"
    )


def largest_window(profile: DiscProfile) -> float:
    """Share of the longest lever at which some position has no working pin; a window must be smaller.

    Levers beyond a share w have sin² t > w² (1 + K² - 2 K cos t), between two phases with
    cos t = K w² +- sqrt((1 - w²) (1 - K² w²)); the phases of neighbouring pins differ by 2 pi / Zp.
    """
    shortening, apart = profile.shortening, 2 * math.pi / profile.pins
    low, high = 0.0, 1.0
    for _ in range(BISECTIONS):
        share = (low + high) / 2
        half = math.sqrt((1 - share**2) * (1 - (shortening * share) ** 2))
        middle = shortening * share**2
        wide = math.acos(max(middle - half, -1.0)) - math.acos(min(middle + half, 1.0)) > apart
        low, high = (share, high) if wide else (low, share)
    return low


def faults(profile: DiscProfile) -> Iterator[Fault]:
    """Faults of a disc, each with the number that would do; none if it can be made and run."""
    for asked in (_sizes, _ring, _modified):
        found = list(asked(profile))
        yield from found
        if found:  # what follows has no meaning
            return


def _sizes(profile: DiscProfile) -> Iterator[Fault]:
    """Numbers that make no curve."""
    if profile.pins < FEWEST_PINS:
        yield Fault("pins", f"expected {FEWEST_PINS} pins or more, got {profile.pins}")
        return
    for field in ("pin_circle_radius", "pin_radius", "eccentricity"):
        value = getattr(profile, field)
        if not 0.0 < value < math.inf:
            yield Fault(field, f"expected more than 0 mm, got {value:g} mm")
            return
    most = profile.pin_circle_radius / profile.pins
    if profile.eccentricity >= most:
        yield Fault(
            "eccentricity",
            f"expected less than {_below(most)} mm, the pin circle's radius over the {profile.pins} pins, where the "
            f"path of the pins has cusps, got {profile.eccentricity:g} mm",
        )
    elif not (profile.ground.pin_circle_radius > 0.0 and profile.ground.shortening < 1.0):
        least = profile.eccentricity * profile.pins - profile.pin_circle_radius
        yield Fault(
            "shift",
            f"expected more than {_above(least)} mm, where the path of the pins that the disc is ground for has cusps, "
            f"got {profile.modification.shift:g} mm",
        )


def neighbours_touch_at(profile: DiscProfile) -> float:
    """Pin radius rp sin(pi / Zp) [mm] at which neighbouring pins touch."""
    return profile.pin_circle_radius * math.sin(math.pi / profile.pins)


def largest_pin_radius(profile: DiscProfile) -> float:
    """Pin radius [mm] that the pins of an unmodified disc must stay below: no undercut, and no pin touches the next."""
    return min(replace(profile, modification=UNMODIFIED).smallest_convex_radius, neighbours_touch_at(profile))


def _ring(profile: DiscProfile) -> Iterator[Fault]:
    """Pins that are too large for their circle or for the lobes."""
    radius, bent = profile.pin_radius, replace(profile, modification=UNMODIFIED).smallest_convex_radius
    apart = neighbours_touch_at(profile)
    if radius >= min(bent, apart):
        reasons = sorted(
            [
                (bent, f"the lobes are undercut from {bent:.4f} mm"),
                (apart, f"neighbouring pins touch from {apart:.4f} mm"),
            ]
        )
        words = ", and ".join(reason for limit, reason in reasons if radius >= limit)
        yield Fault("pin_radius", f"expected less than {_below(min(bent, apart))} mm: {words}, got {radius:g} mm")
    elif profile.root_radius <= 0.0:
        room = profile.pin_circle_radius - profile.eccentricity
        yield Fault(
            "pin_radius", f"expected less than {_below(room)} mm, which leave nothing of the disc, got {radius:g} mm"
        )


def _modified(profile: DiscProfile) -> Iterator[Fault]:
    """Modifications that undercut the lobes or leave no clearance."""
    own, bent = profile.modification, profile.smallest_convex_radius
    if abs(own.rotation) >= profile.lobe_pitch / 2:
        half = math.degrees(profile.lobe_pitch / 2)
        words = f"expected less than {_below(half)} deg either way, which turn a flank past the whole of its lobe"
        yield Fault("rotation", f"{words}, got {math.degrees(own.rotation):g} deg")
        return
    most = bent - profile.pin_radius
    grown = profile.ground.pin_radius
    if grown <= 0.0:
        words = f"expected more than {-1e3 * profile.pin_radius:.3f} um, which leave no pin to grind for"
        yield Fault("offset", f"{words}, got {1e3 * own.offset:g} um")
        return
    if grown >= bent:
        words = (
            f"expected less than {math.floor(1e6 * most) / 1e3:.3f} um: the lobes are undercut where they are ground"
        )
        yield Fault("offset", f"{words} for pins of {_below(bent)} mm or more, got {1e3 * own.offset:g} um")
    least = least_gap(profile)
    if least < -LEAST_GAP:
        enough = math.ceil(1e6 * (own.offset - least) - LEAST_DIGIT) / 1e3
        yield Fault(
            "offset",
            f"lobes and pins interfere by {-1e3 * least:.3f} um: expected an offset of at least {enough:.3f} um with "
            f"this shift and rotation, got {1e3 * own.offset:g} um",
        )


def least_gap(profile: DiscProfile, circle_growth: float = 0.0, pin_growth: float = 0.0) -> float:
    """Smallest gap [mm] between the lobes and their pins in the middle of their lost motion, at any crank angle.

    Exact: pins stand on the path of their centres, and the nearest point of the profile is found. Flanks are alike, so
    no turn of the disc makes the smallest gap larger than this.

    Args:
        circle_growth: of the pins' circle, its radius against the nominal one [mm].
        pin_growth: of the pins, their radius against the nominal one [mm].
    """
    gaps = flank_gaps(profile, np.linspace(0.0, profile.lobe_pitch / 2, PHASES), circle_growth, pin_growth)
    return float(gaps.min())


def flank_gaps(profile: DiscProfile, u: Array, circle_growth: float = 0.0, pin_growth: float = 0.0) -> Array:
    """Gaps [mm] between the right flank of lobe 0, corners included, and pins at parameters u (n,) of their path.

    Args: as of `least_gap`.
    """
    ground, real = profile.ground, replace(profile, pin_circle_radius=profile.pin_circle_radius + circle_growth)
    cos, sin = math.cos(profile.modification.rotation), math.sin(profile.modification.rotation)
    pins = real.pin_centres(u) @ np.array([[cos, -sin], [sin, cos]])  # as the flank sees them
    foot = _nearest(ground, profile.flank_ends, pins)
    apart = np.linalg.norm(pins - ground.points(foot), axis=-1)
    inside = ((pins - ground.points(foot)) * ground.normals(foot)).sum(axis=-1) < 0.0
    return np.asarray(np.where(inside, -apart, apart) - profile.pin_radius - pin_growth)


def _nearest(ground: DiscProfile, ends: tuple[float, float], places: Array) -> Array:
    """Parameters (n,) of the points between two ends of a profile that are nearest to places (n, 2)."""
    looked_at, apart_by = np.linspace(*ends, FEET, retstep=True)
    between = places[:, None] - ground.points(looked_at)
    foot = looked_at[(between * between).sum(axis=-1).argmin(axis=1)]
    low, high = np.maximum(foot - apart_by, ends[0]), np.minimum(foot + apart_by, ends[1])
    for _ in range(PROJECTIONS):
        apart = places - ground.pin_centres(foot)
        normals = ground.normals(foot)
        along = normals[:, 1] * -apart[:, 0] + normals[:, 0] * apart[:, 1]
        above = (apart * normals).sum(axis=-1)
        bowl = np.abs(1 + above * ground.path_curvature(foot)) + FLAT  # downhill, where the distance is largest too
        step = along / (ground.path_speed(foot) * bowl)
        moved = np.clip(foot + step, low, high)
        still, foot = np.abs(moved - foot).max() < PARAMETER_XTOL, moved
        if still:
            break
    return np.asarray(foot)


def _below(limit: float) -> str:
    """A limit, rounded down, so that the printed value keeps to it."""
    return f"{math.floor(limit * 1e4) / 1e4:.4f}"


def _above(limit: float) -> str:
    return f"{math.ceil(limit * 1e4) / 1e4:.4f}"


LEAST_WALL: Final = 1.0  # mm; between two holes, or a hole and the lobes


def lobe_reach(profile: DiscProfile) -> float:
    """Largest distance of a lobe from the axis of the ring [mm]: its tip, where the eccentricity points at it."""
    return profile.tip_radius + profile.eccentricity


def circle_fault(profile: DiscProfile, cranks: int, radius: float) -> Fault | None:
    """Fault of crankshafts on a circle of this radius [mm], which do not go through the discs; None if they do.

    Their holes are wider than twice the eccentricity, for an eccentric reaches round its crankshaft's axis.

    >>> profile = DiscProfile(pins=40, pin_circle_radius=114.5, pin_radius=5.0, eccentricity=2.2)
    >>> circle_fault(profile, 3, 1.0).words
    "expected more than 3.1177 mm, or holes of 4.4 mm for 3 cranks' eccentrics meet, got 1 mm"
    """
    least = (2 * profile.eccentricity + LEAST_WALL) / (2 * math.sin(math.pi / cranks))
    most = profile.root_radius - LEAST_WALL - profile.eccentricity
    hole = f"holes of {2 * profile.eccentricity:g} mm for {cranks} cranks' eccentrics"
    if least >= most:
        return Fault("cranks", f"expected fewer cranks: {hole} leave no wall between them and the lobes' roots")
    if radius <= least:
        limit = f"more than {math.ceil(least * 1e4) / 1e4:.4f} mm, or {hole} meet"
    elif radius >= most:
        limit = f"less than {math.floor(most * 1e4) / 1e4:.4f} mm, or {hole} leave no wall to the lobes' roots"
    else:
        return None
    return Fault("radius", f"expected {limit}, got {radius:g} mm")


def largest_hole(profile: DiscProfile, cranks: int, radius: float) -> float:
    """Diameter [mm] of holes on a circle of this radius that leave walls of LEAST_WALL, to the roots and each other."""
    return min(2 * (profile.root_radius - LEAST_WALL - radius), 2 * radius * math.sin(math.pi / cranks) - LEAST_WALL)


def hole_faults(profile: DiscProfile, holes: DiscHoles) -> Iterator[Fault]:
    """Holes of a disc too small for an eccentric, or that leave no wall of LEAST_WALL between them or to the roots."""
    least = 2 * profile.eccentricity
    if holes.crank_diameter <= least:
        words = f"expected more than {least:g} mm, twice the eccentricity: an eccentric reaches round its crank's axis"
        yield Fault("crank_diameter", f"{words}, got {holes.crank_diameter:g} mm")
        return
    outwards = 2 * (profile.root_radius - LEAST_WALL - holes.circle_radius)
    limits = {
        "the lobes' roots": outwards,
        "the next one": 2 * holes.circle_radius * math.sin(math.pi / holes.cranks) - LEAST_WALL,
    }
    if holes.bore_diameter:
        limits["the bore"] = 2 * (holes.circle_radius - LEAST_WALL) - holes.bore_diameter
    beside = 2 * (2 * holes.circle_radius * math.sin(math.pi / (2 * holes.cranks)) - LEAST_WALL)
    for field, diameter, other in (
        ("crank_diameter", holes.crank_diameter, holes.window_diameter),
        ("window_diameter", holes.window_diameter, holes.crank_diameter),
    ):
        own = dict(limits)
        if other and field == "window_diameter":
            own["the crank holes beside it"] = beside - other
        meets = min(own, key=lambda name: own[name])
        if diameter and diameter > own[meets]:
            most = math.floor(own[meets] * 1e3) / 1e3
            words = (
                f"expected at most {most:.3f} mm, which leave a wall of {LEAST_WALL:g} mm to {meets}"
                if most > 0.0
                else f"expected a smaller circle, on which there is a wall of {LEAST_WALL:g} mm to {meets}"
            )
            yield Fault(field, f"{words}, got {diameter:g} mm")
