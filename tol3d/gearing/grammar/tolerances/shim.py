"""A shim under a gear."""

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from tol3d.gearing.effects import AxisOffset
from tol3d.gearing.grammar.tolerances.gear_tolerance import GearToleranceSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Meaning

if TYPE_CHECKING:
    from tol3d.gearing.model.nominal import Nominal


class ShimSpec(GearToleranceSpec):
    """The thickness of a shim, a length: constant, or with its own tolerance."""

    kind: Literal["shim"]
    side: Literal["behind", "in_front"] = Field(
        default="behind",
        description="behind the gear it moves it along its own -z, of a bevel gear towards the apex, which closes; "
        "in_front the other way",
    )

    def meaning(self, nominal: "Nominal") -> Meaning:
        """The gear moves along its axis; no shim is thinner than nothing."""
        factor = -1.0 if self.side == "behind" else 1.0
        return Meaning(AxisOffset(self.of, (0.0, 0.0, 1.0), factor=factor), least=0.0)
