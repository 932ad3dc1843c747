"""Run-out of the shaft under a gear."""

from typing import Literal

from pydantic import Field

from tol3d.scene.tolerances.tolerance import GearToleranceSpec, RandomOrFixed


class RunOutSpec(GearToleranceSpec):
    """S, a length: the shaft displaces the gear that it carries by S (cos phi, sin phi) and turns with it."""

    kind: Literal["run_out"]
    direction: RandomOrFixed = Field(
        default="random", description="phi, in the gear's frame (x through the middle of tooth 0)"
    )
