"""Two gears on parallel axes, the driven one turned until the working flanks touch."""

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tol3d.scene.moves.move import MoveSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference, Sort
from tol3d.strict import refused
from tol3d.units import Of, Positive, Quantity


class MeshSpec(MoveSpec):
    """A mesh: its world has the driver's axis as z and the driven axis at +x, at the centre distance.

    The right flank lies on the low-azimuth side of its tooth; a driver that turns counter-clockwise
    pushes with its left one.
    """

    sort: ClassVar[Sort] = "mesh"

    kind: Literal["mesh"]
    driver: Name = Field(description="the gear that is held")
    driven: Name = Field(description="the gear that turns into contact")
    centre_distance: Annotated[Quantity, Of("length"), Positive()] = Field(description="nominal distance of the axes")
    working_flank: Literal["right", "left"] = Field(default="right", description="the driver's flank that touches")
    housing: Name | None = Field(default=None, description="the housing whose expansion changes the centre distance")

    @model_validator(mode="after")
    def _refuse_one_gear(self) -> Self:
        if self.driver == self.driven:
            raise refused("driven", "another gear than the driver", repr(self.driven))
        return self

    @property
    def gears(self) -> tuple[str, ...]:
        """Driver and driven."""
        return self.driver, self.driven

    def references(self) -> tuple[Reference, ...]:
        """Two gears, and the housing if there is one."""
        gears = (Reference(("driver",), self.driver, ("gear",)), Reference(("driven",), self.driven, ("gear",)))
        return gears if self.housing is None else (*gears, Reference(("housing",), self.housing, ("housing",)))
