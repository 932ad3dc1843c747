"""Eccentricity of a gear's teeth."""

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from tol3d.gearing.effects import TurningOffset
from tol3d.gearing.grammar.tolerances.gear_tolerance import GearToleranceSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Meaning, in_direction
from tol3d.scene.direction import RandomOrFixed

if TYPE_CHECKING:
    from tol3d.gearing.model.nominal import Nominal


class EccentricitySpec(GearToleranceSpec):
    """e, a length: the teeth's centre lies off the rotation axis by e (cos phi, sin phi) and turns with the gear."""

    kind: Literal["eccentricity"]
    direction: RandomOrFixed = Field(
        default="random", description="phi, in the gear's frame (x through the middle of tooth 0)"
    )

    def meaning(self, nominal: "Nominal") -> Meaning:
        """The gear's centre lies off its axis."""
        return in_direction([TurningOffset(self.of)], self.direction)
