"""Eccentricity of a gear's teeth."""

from typing import Literal

from pydantic import Field

from tol3d.gearing.grammar.tolerances.gear_tolerance import GearToleranceSpec
from tol3d.scene.direction import RandomOrFixed


class EccentricitySpec(GearToleranceSpec):
    """e, a length: the teeth's centre lies off the rotation axis by e (cos phi, sin phi) and turns with the gear."""

    kind: Literal["eccentricity"]
    direction: RandomOrFixed = Field(
        default="random", description="phi, in the gear's frame (x through the middle of tooth 0)"
    )
