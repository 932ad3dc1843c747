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


def circle_fault(profile: DiscProfile, cranks: int, radius: float) -> Fault | None:
    """Why crankshafts do not go through the discs on a circle of this radius [mm]; nothing where they do.

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
