"""What every mesh of two gears has in common."""

from collections.abc import Iterator, Mapping
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tol3d.gearing.grammar.parts import GearSpec
from tol3d.scene.move import MoveSpec
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.strict import refused
from tol3d.units import Of, Quantity


class GearMeshSpec(MoveSpec):
    """The driver is held, the driven gear turns until the working flanks touch.

    The right flank lies on the low-azimuth side of its tooth; a driver that turns counter-clockwise
    pushes with its left one.
    """

    words: ClassVar[str] = "a mesh move"
    gear_specs: ClassVar[tuple[type[GearSpec], ...]]

    driver: Name = Field(description="the gear that is held")
    driven: Name = Field(description="the gear that turns into contact")
    azimuth: Annotated[Quantity, Of("angle")] = Field(
        default=Quantity(0.0, "deg"),
        description="where the teeth meet about the driver's axis, in the frame of the driver's shaft",
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
            yield Reference((field,), getattr(self, field), self.gear_specs)


def meshes_of(gear: str, moves: Mapping[str, MoveSpec]) -> tuple[str, ...]:
    """Names of the meshes in which a gear takes part."""
    return tuple(name for name, move in moves.items() if isinstance(move, GearMeshSpec) and gear in move.gears)
