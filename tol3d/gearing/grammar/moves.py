"""Kinds of assembly move: meshes, other links of two shafts, trains."""

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import Annotated, ClassVar, Final, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from tol3d.gearing.grammar.parts import (
    BevelGearSpec,
    GearSpec,
    HelicalGearSpec,
    HousingSpec,
    InternalGearSpec,
    ShaftReference,
    SpurGearSpec,
)
from tol3d.gearing.links import Reducer, StatedLink
from tol3d.scene import Scene
from tol3d.scene.bases import MoveSpec
from tol3d.scene.entry import Reference
from tol3d.scene.name import Name
from tol3d.scene.vector import Coordinate, Direction
from tol3d.strict import refused
from tol3d.units import Of, Positive, Quantity


def _turning(ratio: float) -> float:
    if ratio == 0.0:
        raise refused("", "a ratio other than 0", ratio)
    return ratio


Ratio = Annotated[float, AfterValidator(_turning), Field(json_schema_extra={"not": {"const": 0}})]
"""Turns of the first shaft for one turn of the other; negative where they turn opposite ways."""


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


class HelicalMoveSpec(MoveSpec):
    """A move whose gears may be helical; what other moves would compute of them was never derived."""


def meshes_of(gear: str, moves: Mapping[str, MoveSpec]) -> tuple[str, ...]:
    """Names of the meshes in which a gear takes part."""
    return tuple(name for name, move in moves.items() if isinstance(move, GearMeshSpec) and gear in move.gears)


class MeshSpec(GearMeshSpec, HelicalMoveSpec):
    """A mesh: its world has the driver's axis as z, and the teeth meet at +x.

    The driven axis lies at the centre distance, at +x; that of a driven internal gear at -x, for it is around its mate.
    """

    words: ClassVar[str] = "a mesh of spur or helical gears"
    gear_specs: ClassVar[tuple[type[GearSpec], ...]] = (SpurGearSpec, HelicalGearSpec, InternalGearSpec)

    kind: Literal["mesh"]
    centre_distance: Annotated[Quantity, Of("length"), Positive()] | None = Field(
        default=None,
        description="nominal distance of the axes; left out only where both shafts lie in bores, from which it follows",
    )
    housing: Name | None = Field(default=None, description="the housing whose expansion changes the centre distance")

    def references(self) -> tuple[Reference, ...]:
        """Two gears, and the housing if there is one."""
        gears = super().references()
        return gears if self.housing is None else (*gears, Reference(("housing",), self.housing, (HousingSpec,)))


class BevelMeshSpec(GearMeshSpec):
    """A bevel mesh: the common apex is the origin of its world, the driver's axis z, the driven's in the plane y = 0.

    Each gear's own z points from the apex to its heel; both see the mesh at azimuth 0.
    """

    words: ClassVar[str] = "a bevel mesh"
    gear_specs: ClassVar[tuple[type[GearSpec], ...]] = (BevelGearSpec,)

    kind: Literal["bevel_mesh"]
    shaft_angle: Annotated[Quantity, Of("angle"), Positive()] = Field(
        default=Quantity(90.0, "deg"), description="between the axes", json_schema_extra={"default": "90 deg"}
    )


class LinkSpec(MoveSpec):
    """Two shafts that turn with each other; a kind of link of any mechanism is a subclass that defines its link."""

    words: ClassVar[str] = "a link of two shafts"

    driver: Name = Field(description="the shaft, or the gear that is its own, towards the motor")
    driven: Name = Field(description="the shaft, or the gear that is its own, behind it")

    @model_validator(mode="after")
    def _refuse_one_shaft(self) -> Self:
        if self.driver == self.driven:
            raise refused("driven", "another shaft than the driver", repr(self.driven))
        return self

    def references(self) -> tuple[Reference, ...]:
        """Two shafts."""
        return ShaftReference(("driver",), self.driver), ShaftReference(("driven",), self.driven)

    @abstractmethod
    def link(self, name: str, scene: Scene) -> StatedLink:
        """Link of the move in a scene.

        Raises:
            SceneError: the link cannot be built; with the key in the scene.
        """


MOST_RATIO: Final = 1e6  # beyond it: a typing error


def _not_negative(angle: Quantity) -> Quantity:
    if angle.number < 0.0:
        raise refused("", "an angle of zero or more", angle)
    return angle


class ReducerSpec(LinkSpec):
    """Two coaxial shafts with a bought reducer between them, of which only ratio and backlash are known."""

    words: ClassVar[str] = "a reducer"

    kind: Literal["reducer"]
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

    def link(self, name: str, scene: Scene) -> Reducer:
        """Reducer from the data sheet.

        Raises:
            SceneError: an impossible ratio.
        """
        if not 1 / MOST_RATIO <= abs(self.ratio) <= MOST_RATIO:
            raise scene.refuse(
                ("moves", name, "ratio"),
                f"expected a ratio of 1/{MOST_RATIO:g} to {MOST_RATIO:g}, either sign, got {self.ratio:g}",
            )
        return Reducer(
            name=name,
            driver=self.driver,
            driven=self.driven,
            rate=1 / Fraction(str(self.ratio)),
            offset=self.offset.internal,
            backlash=0.0 if self.backlash is None else self.backlash.internal,
        )


class TrainSpec(MoveSpec):
    """A train from the shaft that the motor turns to its output, over the meshes and other links of the scene."""

    words: ClassVar[str] = "a train"

    kind: Literal["train"]
    driven: Name = Field(description="the shaft, or the gear that is its own, that the motor turns")
    output: Name = Field(description="the shaft, or the gear that is its own, at the end")
    held: Name | None = Field(
        default=None, description="the shaft that is held while lost motion is read; default: the driven one"
    )
    ratio: Ratio | None = Field(
        default=None,
        description="turns of driven per turn of output, checked if given; below zero: they turn opposite ways",
    )
    gravity: Direction | None = Field(
        default=None,
        description="its direction [x, y, z] in the world, the frame of the driven shaft at 0; it loads the arms on "
        "the output",
    )
    turns: Literal["counter_clockwise", "clockwise"] = Field(
        default="counter_clockwise",
        description="the motor's sense about its z, which decides the working flanks where there is no gravity",
    )

    @model_validator(mode="after")
    def _refuse_one_shaft(self) -> Self:
        if self.driven == self.output:
            raise refused("output", "another shaft than the driven one", repr(self.output))
        return self

    def references(self) -> tuple[Reference, ...]:
        """Its shafts."""
        return tuple(self._shafts())

    def _shafts(self) -> Iterator[Reference]:
        for field in ("driven", "output", "held"):
            if (shaft := getattr(self, field)) is not None:
                yield ShaftReference((field,), shaft)
