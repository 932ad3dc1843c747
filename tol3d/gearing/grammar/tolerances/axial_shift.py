"""Displacement of a gear along its axis."""

from typing import TYPE_CHECKING, Literal

from tol3d.gearing.effects import AxisOffset
from tol3d.gearing.grammar.tolerances.gear_tolerance import GearToleranceSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Meaning

if TYPE_CHECKING:
    from tol3d.gearing.model.nominal import Nominal


class AxialShiftSpec(GearToleranceSpec):
    """A length along the gear's own +z. It moves no flank of a spur pair with parallel axes; tilted ones feel it."""

    kind: Literal["axial_shift"]

    def meaning(self, nominal: "Nominal") -> Meaning:
        """The gear moves along its axis."""
        return Meaning(AxisOffset(self.of, (0.0, 0.0, 1.0)))
