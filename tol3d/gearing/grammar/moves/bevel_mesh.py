"""Two bevel gears whose axes meet in one point."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.moves.gear_mesh import GearMeshSpec
from tol3d.gearing.grammar.parts import BevelGearSpec, GearSpec
from tol3d.units import Of, Positive, Quantity


class BevelMeshSpec(GearMeshSpec):
    """A bevel mesh: the common apex is the origin of its world, the driver's axis z, the driven's in the plane y = 0.

    Each gear's own z points from the apex to its heel; both see the mesh at azimuth 0.
    """

    words: ClassVar[str] = "a bevel mesh"
    gear_specs: ClassVar[tuple[type[GearSpec], ...]] = (BevelGearSpec,)

    kind: Literal["bevel_mesh"]
    shaft_angle: Annotated[Quantity, Of("angle"), Positive()] = Field(
        default=Quantity(90.0, "deg"),
        description="between the axes",
        json_schema_extra={"default": "90 deg"},
    )
