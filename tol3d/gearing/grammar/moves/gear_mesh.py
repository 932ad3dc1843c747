"""What every mesh of two gears has in common."""

from collections.abc import Iterator
from typing import Annotated, ClassVar, Final, Literal, Self

from pydantic import Field, model_validator

from tol3d.scene.move import MoveSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference, Sort
from tol3d.strict import refused
from tol3d.units import Of, Quantity

MESHES: Final[tuple[Sort, ...]] = ("mesh", "bevel_mesh")


class GearMeshSpec(MoveSpec):
    """The driver is held, the driven gear turns until the working flanks touch.

    The right flank lies on the low-azimuth side of its tooth; a driver that turns counter-clockwise
    pushes with its left one.
    """

    gear_sort: ClassVar[Sort]

    driver: Name = Field(description="the gear that is held")
    driven: Name = Field(description="the gear that turns into contact")
    azimuth: Annotated[Quantity, Of("angle")] = Field(
        default=Quantity(0.0, "deg"),
        description="where the driven gear lies about the driver's axis, in the frame of the driver's shaft",
        json_schema_extra={"default": "0 deg"},
    )
    ratio: float | None = Field(
        default=None, gt=0.0, description="teeth of the driven gear by those of the driver; checked where it is given"
    )
    working_flank: Literal["right", "left", "either"] = Field(
        default="right", description="the driver's flank that touches; either: the load on the train decides"
    )

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
        """Two gears."""
        return tuple(self._gears())

    def _gears(self) -> Iterator[Reference]:
        for field in ("driver", "driven"):
            yield Reference((field,), getattr(self, field), (self.gear_sort,))
