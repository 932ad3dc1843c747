"""Measuring strips of single flanks: those of the solid, moved along their normals by what the flank deviates.

Strips are cut anew for each flank that deviates in its own way, trial by trial; both ends of a generator are moved, so
that a flank that is turned about its profile stays ruled.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.build import Build
from tol3d.gearing.effects import FORM, HELIX, SHAPES, SLOPE, UNIFORM
from tol3d.gearing.flank_offsets import FlankPlaces, flank_slot
from tol3d.gearing.model import Model
from tol3d.gears import Flank
from tol3d.solids import FlankStrips

Array = NDArray[np.float64]
Numbers = tuple[float, ...]
"""Coefficients of one flank [mm], SHAPES of them; empty for a flank like all others of its gear."""


@dataclass(frozen=True, eq=False)
class DeviatedStrips:
    """The strips of a model's gears.

    Args:
        model: gears and meshes.
        strips: of every gear, by name, as its solid has them.
        places: where the coefficients of flanks lie.
    """

    model: Model
    strips: Mapping[str, FlankStrips]
    places: FlankPlaces

    def numbers(self, build: Build, seat: int, row: int, tooth: int, flank: Flank) -> Numbers:
        """Coefficients of a flank in a row of builds, its tooth counted as the mesh does."""
        own = self.model.seats[seat]
        if build.flanks is None or own.gear not in self.places.starts:
            return ()
        gear = self.model.gear(own.gear).gear
        ahead = round(own.ahead / gear.angular_pitch)
        slot = self.places.starts[own.gear] + int(flank_slot(gear.teeth, tooth - ahead, flank))
        return tuple(build.flanks.values[build.flanks.row[row], slot : slot + SHAPES].tolist())

    def of(self, gear: str, flank: Flank, numbers: Numbers) -> FlankStrips:
        """The strips of a gear, one flank of it deviated."""
        strips = self.strips[gear]
        if not any(numbers):
            return strips
        roll = strips.parameter
        begin, end = self.places.spans[gear]
        u = (roll - (begin + end) / 2) / (end - begin)
        waves = self.places.waves[gear]
        form = np.cos(2 * math.pi * waves * u) / 2 if waves else 1 / 3 - 4 * u * u
        level = numbers[UNIFORM] + numbers[SLOPE] * u + numbers[FORM] * form
        normals = strips.normals[flank]
        inner, outer = (
            {**ends, flank: ends[flank] + (level + sense * numbers[HELIX] / 2)[:, None] * normals}
            for ends, sense in ((strips.inner, -1.0), (strips.outer, 1.0))
        )
        return replace(strips, inner=inner, outer=outer)
