"""Margin beyond the path of contact within which flank pairs are evaluated, if single flanks stand out."""

import math
from typing import Final

import numpy as np

from tol3d.gearing.effects import SHAPES, FlankDeviation
from tol3d.gearing.model import Mesh, Model
from tol3d.gears import GearPair, InternalPair
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.flank import RIGHT

MARGINS: Final = (0.35, 0.6, 0.85)
"""Pitches beyond CONTACT_MARGIN to try: the first sufficient one is taken."""

SAMPLE: Final = 200
"""Builds by which it is chosen."""

LARGEST: Final = np.array([1.0, 1 / 2, 2 / 3, 1 / 2])
"""Size of each shape over the whole flank; of all shapes together no build has that much more than its neighbours."""


def standing_out(pair: GearPair, margin: float) -> float:
    """Excess of a flank over its neighbours [mm] up to which it touches nowhere beyond a margin [pitches].

    Where the path of contact ends, a tip edge leaves its mate by s^2 rho T/(2 r_b^2 rho_m), s the arc on the base
    circle by which the gears have turned on, rho and rho_m the radii of curvature of tip and mate, T = rho + rho_m,
    in the transverse section; in a ring T is the difference of both.
    """
    tangent = sum(pair.working_radii) * math.sin(pair.working_pressure_angle)
    if isinstance(pair, InternalPair):
        tangent = pair.centre_distance * math.sin(pair.working_pressure_angle)
    found = math.inf
    for gear in (pair.pinion, pair.wheel):
        if not isinstance(gear, CylindricalGear):
            raise TypeError("single flanks deviate of cylindrical gears only")
        tip, turned = gear.base_radius * gear.tip_roll, margin * gear.transverse_base_pitch
        mating = tip + gear.iso_sign * tangent if isinstance(pair, InternalPair) else tangent - tip
        found = min(found, turned**2 * tip * tangent / (2 * gear.base_radius**2 * mating))
    return found * pair.base_helix_cosine


def margin_of(model: Model, mesh: Mesh) -> float:
    """Margin of a mesh beyond CONTACT_MARGIN [pitches], from builds drawn by its tolerances."""
    most = sum(_steps(model, mesh, name) for name in (mesh.driver, mesh.driven))
    return next((own for own in MARGINS if standing_out(mesh.pair, own) >= most), MARGINS[-1])


def _steps(model: Model, mesh: Mesh, name: str) -> float:
    """Largest excess of a gear's flank over its neighbours in some builds [mm]."""
    gear, generator = mesh.gear(name), np.random.Generator(np.random.Philox(key=1))
    flanks = np.zeros((gear.teeth, 2, SHAPES, SAMPLE))
    for contributor in model.contributors:
        for effect in contributor.effect.singles:
            if isinstance(effect, FlankDeviation) and effect.part == name:
                drawn = contributor.draw.deviations(*(1.0 - generator.random((contributor.draw.uniforms, SAMPLE))))
                for component, place, shape, factor in effect.terms:
                    flanks[place.tooth, int(place.flank != RIGHT), shape] += factor * drawn[component]
    size = np.einsum("tfsn,s->tfn", np.abs(flanks[:, :, 1:]), LARGEST[1:])
    most, least = flanks[:, :, 0] + size, flanks[:, :, 0] - size
    return float(max((most - np.roll(least, by, axis=0)).max() for by in (1, -1)))
