"""Deviation of a gear's tooth thickness."""

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from tol3d.gearing.effects import ToothThickness
from tol3d.gearing.grammar.tolerances.gear_tolerance import GearToleranceSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Meaning

if TYPE_CHECKING:
    from tol3d.gearing.model.nominal import Nominal


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

    def meaning(self, nominal: "Nominal") -> Meaning:
        """Half the deviation on each flank: an arc s/2 is (s/2) cos(alpha) along the normal, or a turn of s/(2 r)."""
        gear = nominal.mesh_of(self.of).gear(self.of)
        cosine = gear.section_arm / gear.thickness_radius
        normal = 0.5 if self.measured == "normal" else 0.5 * cosine
        if self.along_face == "constant":
            return Meaning(ToothThickness(self.of, turn=0.0, offset=normal))
        turn = 0.5 / (gear.section_arm if self.measured == "normal" else gear.thickness_radius)
        return Meaning(ToothThickness(self.of, turn=turn))
