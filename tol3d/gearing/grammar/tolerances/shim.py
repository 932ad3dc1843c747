"""A shim under a gear."""

from typing import Literal

from pydantic import Field

from tol3d.gearing.grammar.tolerances.gear_tolerance import GearToleranceSpec


class ShimSpec(GearToleranceSpec):
    """The thickness of a shim, a length: constant, or with its own tolerance."""

    kind: Literal["shim"]
    side: Literal["behind", "in_front"] = Field(
        default="behind",
        description="behind the gear it moves it along its own -z, of a bevel gear towards the apex, which closes; "
        "in_front the other way",
    )
