"""Displacement of a gear along its axis."""

from typing import Literal

from tol3d.gearing.grammar.tolerances.gear_tolerance import GearToleranceSpec


class AxialShiftSpec(GearToleranceSpec):
    """A length along the gear's own +z. It moves no flank of a spur pair with parallel axes; tilted ones feel it."""

    kind: Literal["axial_shift"]
