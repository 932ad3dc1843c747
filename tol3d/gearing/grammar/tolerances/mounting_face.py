"""Surface profile of a face that a gear's place along its axis rests on."""

from typing import TYPE_CHECKING, Literal

from tol3d.gearing.effects import AxisOffset
from tol3d.gearing.grammar.tolerances.gear_tolerance import GearToleranceSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Meaning

if TYPE_CHECKING:
    from tol3d.gearing.model.nominal import Nominal


class MountingFaceSpec(GearToleranceSpec):
    """Delta P, a length: the face lies off its true place, and the gear with it along its own +z.

    Each face of the stack (the gear's back, the housing's seat, an end cover) is a contributor of its own.
    """

    kind: Literal["mounting_face"]

    def meaning(self, nominal: "Nominal") -> Meaning:
        """The gear moves along its axis."""
        return Meaning(AxisOffset(self.of, (0.0, 0.0, 1.0)))
