"""Run-out of the shaft under a gear."""

from typing import TYPE_CHECKING, ClassVar, Literal

from pydantic import Field

from tol3d.gearing.effects import Plane, TurningOffset
from tol3d.gearing.grammar.parts import GearSpec, ShaftSpec
from tol3d.gearing.grammar.tolerances.gear_tolerance import GearToleranceSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Meaning, in_direction
from tol3d.scene.direction import RandomOrFixed
from tol3d.scene.entry import Entry
from tol3d.scene.name import Name

if TYPE_CHECKING:
    from tol3d.gearing.model.nominal import Nominal


class RunOutSpec(GearToleranceSpec):
    """S, a length: the shaft displaces the gears that it carries by S (cos phi, sin phi) and turns with them."""

    applies_to: ClassVar[tuple[type[Entry], ...]] = (GearSpec, ShaftSpec)

    kind: Literal["run_out"]
    of: Name = Field(description="the gear on the shaft, or the shaft with every gear on it")
    direction: RandomOrFixed = Field(
        default="random",
        description="phi, in the gear's frame (x through the middle of tooth 0), or in the shaft's",
    )

    def meaning(self, nominal: "Nominal") -> Meaning:
        """Of a shaft: its direction is counted on the shaft, and every gear on it is displaced alike."""
        if not isinstance(nominal.scene.parts[self.of], ShaftSpec):
            return in_direction([TurningOffset(self.of)], self.direction)
        offsets = [TurningOffset(own.gear, Plane(-own.phase, own.backward)) for own in nominal.carried_by(self.of)]
        return in_direction(offsets, self.direction)
