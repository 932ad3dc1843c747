"""Eccentricity of a gear's teeth."""

from typing import Literal

from pydantic import Field

from tol3d.scene.direction import RandomOrFixed
from tol3d.scene.tolerances.tolerance import GearToleranceSpec


class EccentricitySpec(GearToleranceSpec):
    """e, a length: the teeth's centre lies off the rotation axis by e (cos phi, sin phi) and turns with the gear."""

    kind: Literal["eccentricity"]
    direction: RandomOrFixed = Field(
        default="random", description="phi, in the gear's frame (x through the middle of tooth 0)"
    )
