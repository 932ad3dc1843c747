"""The CAD side of cycloid stages: builders of tol3d.parts, and the points that a disc's splines go through."""

import math
from typing import Final

import numpy as np
from scipy.interpolate import make_interp_spline

from tol3d.gearing.cycloid.model.profile import DiscProfile
from tol3d.gearing.cycloid.model.shapes import Carrier, Crankshaft, CycloidDisc, DiscHoles, PinRing, RingPin
from tol3d.numerics.arrays import Array
from tol3d.parts.carrier import carrier
from tol3d.parts.crankshaft import crankshaft
from tol3d.parts.cycloid_disc import LobeFlank, cycloid_disc
from tol3d.parts.named_solid import NamedSolid
from tol3d.parts.pin_ring import pin_ring
from tol3d.parts.round_hole import RoundHole
from tol3d.parts.shaft import shaft

FLANK_ERROR: Final = 1e-6  # mm; how far a spline may leave the profile, a tenth of the 0.01 um asked for
LOOKED_AT: Final = 4096  # steps of a flank over which knots are laid


def disc(shape: CycloidDisc) -> NamedSolid:
    """The solid of a cycloid disc, its lobes within FLANK_ERROR of the profile."""
    right, left = flanks(shape.profile)
    return cycloid_disc(right, left, shape.profile.lobes, shape.width, round_holes(shape.holes), shape.clocking)


def ring(shape: PinRing) -> NamedSolid:
    """The solid of a pin ring."""
    return pin_ring(
        shape.pins, shape.pin_circle_radius, shape.pin_radius, shape.bore_radius, shape.outer_radius, shape.width
    )


def pin(shape: RingPin) -> NamedSolid:
    """The solid of a pin."""
    return shaft(2 * shape.radius, -shape.length / 2, shape.length / 2)


def crank(shape: Crankshaft) -> NamedSolid:
    """The solid of a crankshaft."""
    return crankshaft([(part.diameter, part.length, part.at) for part in shape.sections], shape.start)


def carrier_of(shape: Carrier) -> NamedSolid:
    """The solid of a carrier."""
    return carrier(
        shape.flange_diameter,
        shape.flange_width,
        shape.between,
        shape.circle_radius,
        shape.cranks,
        shape.hole_diameter,
        shape.post_diameter,
        shape.bore_diameter,
    )


def round_holes(holes: DiscHoles) -> list[RoundHole]:
    """The holes of a disc: "crank hole 1", "window 1" and so on, "bore"."""
    radius, pitch = holes.circle_radius, 2 * math.pi / holes.cranks
    found = []
    for number in range(holes.cranks):
        for name, azimuth, diameter in (
            (f"crank hole {number + 1}", pitch * number, holes.crank_diameter),
            (f"window {number + 1}", pitch * (number + 0.5), holes.window_diameter),
        ):
            if diameter:
                found.append(RoundHole(name, (radius * math.cos(azimuth), radius * math.sin(azimuth)), diameter))
    return [*found, RoundHole("bore", (0.0, 0.0), holes.bore_diameter)] if holes.bore_diameter else found


# splines --------------------------------------------------------------------------------------------


def flanks(profile: DiscProfile) -> tuple[LobeFlank, LobeFlank]:
    """Right and left flank of lobe 0, the left one in the mirror."""
    u = knots(profile)
    turn = profile.modification.rotation
    points, slopes = (_turned(values, turn) for values in (profile.ground.points(u), profile.ground.slopes(u[[0, -1]])))
    right = LobeFlank(u, points, slopes)
    over = _turned(points[::-1] * [1.0, -1.0], profile.lobe_pitch)
    back = _turned(slopes[::-1] * [-1.0, 1.0], profile.lobe_pitch)  # mirrored, and against the parameter
    return right, LobeFlank(profile.lobe_pitch - u[::-1], over, back)


def knots(profile: DiscProfile) -> Array:
    """Parameters (n,) of the right flank through which its spline goes, so that it keeps to FLANK_ERROR.

    They lie as close as the profile bends: the derivatives of the normal grow as 1 / w, its distance from the cusp.
    The error falls with the fourth power of their number; it is taken with some of them, midway between.
    """
    count = 32
    measured = _spline_error(profile, _graded(profile, count))
    return _graded(profile, math.ceil(1.1 * count * (measured / FLANK_ERROR) ** 0.25))


def _graded(profile: DiscProfile, intervals: int) -> Array:
    """Steps from end to end of the flank, each with the same integral of du / w."""
    ground = profile.ground
    looked_at = np.linspace(*profile.flank_ends, LOOKED_AT + 1)
    density = 1.0 / ground.path_speed(looked_at)
    passed = np.concatenate([[0.0], np.cumsum((density[1:] + density[:-1]) / 2)])
    found = np.interp(np.linspace(0.0, passed[-1], intervals + 1), passed, looked_at)
    found[[0, -1]] = profile.flank_ends
    return np.asarray(found)


def _spline_error(profile: DiscProfile, u: Array) -> float:
    """Largest distance [mm] between the spline and the profile at one parameter, midway between knots."""
    ground = profile.ground
    first, last = ground.slopes(u[[0, -1]])
    spline = make_interp_spline(u, ground.points(u), k=3, bc_type=([(1, first)], [(1, last)]))
    between = (u[1:] + u[:-1]) / 2
    return float(np.linalg.norm(spline(between) - ground.points(between), axis=-1).max())


def _turned(points: Array, angle: float) -> Array:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.asarray(points @ np.array([[cos, sin], [-sin, cos]]))
