"""Deviation of a gear's tooth thickness."""

from typing import Literal

from tol3d.scene.tolerances.tolerance import GearToleranceSpec


class ToothThicknessSpec(GearToleranceSpec):
    """E_s, a length: an arc at the reference circle, positive is thicker, half on each flank."""

    kind: Literal["tooth_thickness"]
