"""Deviation of a gear's tooth thickness."""

from typing import Literal

from pydantic import Field

from tol3d.gearing.grammar.tolerances.gear_tolerance import GearToleranceSpec


class ToothThicknessSpec(GearToleranceSpec):
    """E_s, a length: positive is thicker, half on each flank.

    `arc` counts it on the reference circle, of a bevel gear in the middle of the face; `normal` along the normals
    of the flanks, which is 1/cos(alpha) as much. A bevel tooth is thinned in proportion along its face (the flank
    is turned), or by the same normal offset everywhere; on a spur gear that is the same.
    """

    kind: Literal["tooth_thickness"]
    measured: Literal["arc", "normal"] = Field(default="arc", description="along the reference circle, or the normals")
    along_face: Literal["proportional", "constant"] = Field(
        default="proportional", description="how a bevel tooth's deviation goes along the face"
    )
