"""The outline of a gear tooth as a polygon, its fillet found by searching for the circle that touches.

Half a tooth on the high-azimuth side: tip arc, involute, radial line below the base circle, fillet, root arc.
"""

import math

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from oracles.involute_gear import InvoluteGear

POINTS = 20_000  # a curve: a chord's area error is the sagitta's 2/3, together 1e-9 of the area


def flank_point(gear: InvoluteGear, radius: float) -> np.ndarray:
    """Flank point at a radius: on the involute, or on the radial line below the base circle."""
    azimuth = float(gear.half_angle(max(radius, gear.base_radius)))
    return radius * np.array([math.cos(azimuth), math.sin(azimuth)])


def fillet(gear: InvoluteGear, root_radius: float, fillet_radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Centre (2,) [mm] of the arc that touches root circle and flank, and the point (2,) where it touches the flank."""
    out = root_radius + fillet_radius

    def nearest(azimuth: float) -> tuple[float, float]:
        centre = out * np.array([math.cos(azimuth), math.sin(azimuth)])
        found = minimize_scalar(
            lambda radius: float(np.linalg.norm(flank_point(gear, radius) - centre)),
            bounds=(root_radius, min(gear.tip_radius, out + fillet_radius)),
            method="bounded",
            options={"xatol": 1e-13},
        )
        return found.fun, found.x

    on_flank = float(gear.half_angle(max(out, gear.base_radius)))
    azimuth = brentq(
        lambda at: nearest(at)[0] - fillet_radius, on_flank, on_flank + 3 * fillet_radius / out, xtol=1e-14
    )
    return out * np.array([math.cos(azimuth), math.sin(azimuth)]), flank_point(gear, nearest(azimuth)[1])


def area(gear: InvoluteGear, root_radius: float, fillet_radius: float) -> float:
    """Area [mm^2] inside the outline of all teeth, by the shoelace formula."""
    centre, touch = fillet(gear, root_radius, fillet_radius)
    start = math.atan2(*(touch - centre)[::-1])
    turn = math.remainder(math.atan2(-centre[1], -centre[0]) - start, 2 * math.pi)
    tip = float(gear.half_angle(gear.tip_radius))
    bottom = math.atan2(centre[1], centre[0])
    radii = np.linspace(gear.tip_radius, np.linalg.norm(touch), POINTS)
    azimuth = gear.half_angle(np.maximum(radii, gear.base_radius))
    curves = [
        arc(np.zeros(2), gear.tip_radius, 0.0, tip),
        np.stack([radii * np.cos(azimuth), radii * np.sin(azimuth)], axis=1),
        arc(centre, fillet_radius, start, start + turn),
        arc(np.zeros(2), root_radius, bottom, math.pi / gear.teeth),
    ]
    x, y = np.concatenate([*curves, np.zeros((1, 2))]).T
    half = (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2
    return 2 * gear.teeth * float(half)


def arc(centre: np.ndarray, radius: float, start: float, end: float) -> np.ndarray:
    """Points (POINTS, 2) along an arc."""
    at = np.linspace(start, end, POINTS)
    return centre + radius * np.stack([np.cos(at), np.sin(at)], axis=1)
