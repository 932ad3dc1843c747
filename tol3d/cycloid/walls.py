"""Whether the parts of a cycloid stage leave each other room: walls between holes, lobes in their ring."""

import math
from collections.abc import Iterator
from typing import Final

from tol3d.cycloid.limits import Fault
from tol3d.cycloid.profile import DiscProfile
from tol3d.cycloid.shapes import DiscHoles

LEAST_WALL: Final = 1.0  # mm; between two holes, or a hole and the lobes


def lobe_reach(profile: DiscProfile) -> float:
    """Largest distance of a lobe from the axis of the ring [mm]: its tip, where the eccentricity points at it."""
    return profile.tip_radius + profile.eccentricity


def ring_bore_fault(profile: DiscProfile, bore_radius: float) -> Fault | None:
    """Why lobes or pins do not go with the bore of their ring, between the pins; nothing where they do.

    >>> profile = DiscProfile(pins=40, pin_circle_radius=114.5, pin_radius=5.0, eccentricity=2.2)
    >>> ring_bore_fault(profile, 113.0).words
    'expected more than 113.9000 mm, which the tips of the lobes reach, and less than 119.5000 mm, got 113 mm'
    """
    least, most = lobe_reach(profile), profile.pin_circle_radius + profile.pin_radius
    if least < bore_radius < most:
        return None
    words = f"expected more than {least:.4f} mm, which the tips of the lobes reach, and less than {most:.4f} mm"
    return Fault("bore_radius", f"{words}, got {bore_radius:g} mm")


def hole_faults(profile: DiscProfile, holes: DiscHoles) -> Iterator[Fault]:
    """Holes of a disc that meet, or leave no wall of LEAST_WALL between them or to the lobes' roots."""
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


def post_fault(profile: DiscProfile, window_diameter: float, post_diameter: float) -> Fault | None:
    """Why a post does not pass its windows, which go round it by the eccentricity; nothing where it does."""
    most = window_diameter - 2 * profile.eccentricity
    if post_diameter < most:
        return None
    return Fault(
        "post_diameter",
        f"expected less than {most:.4f} mm, the window of {window_diameter:g} mm less twice the eccentricity, "
        f"got {post_diameter:g} mm",
    )
