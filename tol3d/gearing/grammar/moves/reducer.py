"""A reducer from a data sheet."""

from typing import Annotated, ClassVar, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from tol3d.gearing.grammar.moves.ratio import Ratio
from tol3d.gearing.grammar.parts.shaft_reference import ShaftReference
from tol3d.scene.move import MoveSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.scene.vector import Coordinate
from tol3d.strict import refused
from tol3d.units import Of, Quantity


def _not_negative(angle: Quantity) -> Quantity:
    if angle.number < 0.0:
        raise refused("", "an angle of zero or more", angle)
    return angle


class ReducerSpec(MoveSpec):
    """Two coaxial shafts with a bought reducer between them, of which ratio and backlash are known and nothing else."""

    words: ClassVar[str] = "a reducer"

    kind: Literal["reducer"]
    driver: Name = Field(description="the shaft, or the gear that is its own, towards the motor")
    driven: Name = Field(description="the shaft, or the gear that is its own, behind it")
    ratio: Ratio = Field(description="turns of the driver per turn of the driven; negative: they turn opposite ways")
    backlash: Annotated[Quantity, Of("angle"), AfterValidator(_not_negative)] | None = Field(
        default=None,
        description="the data sheet's maximum at the driven shaft, taken in every trial; a tolerance of kind "
        "reducer_backlash gives a distribution instead",
    )
    offset: Coordinate = Field(
        default=Quantity(0.0, "mm"),
        description="of the driven shaft's origin from the driver's, along z",
        json_schema_extra={"default": "0 mm"},
    )

    @model_validator(mode="after")
    def _refuse_one_shaft(self) -> Self:
        if self.driver == self.driven:
            raise refused("driven", "another shaft than the driver", repr(self.driven))
        return self

    def references(self) -> tuple[Reference, ...]:
        """Two shafts."""
        return ShaftReference(("driver",), self.driver), ShaftReference(("driven",), self.driven)
