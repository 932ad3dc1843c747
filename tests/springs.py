"""A mechanism that tol3d has never heard of: springs between gears."""

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

from tol3d.gearing.grammar.parts import GearSpec
from tol3d.scene import Scene
from tol3d.scene.bases import MoveSpec, PartSpec, ToleranceSpec
from tol3d.scene.entry import Reference
from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath
from tol3d.study.system.mechanism import Mechanism
from tol3d.study.system.plain import LengthSpec
from tol3d.units import Dimension, Of, Quantity


class SpringSpec(PartSpec):
    """A spring, its characteristic in a file."""

    words: ClassVar[str] = "a spring"

    kind: Literal["spring"]
    length: Annotated[Quantity, Of("length")]
    characteristic: str | None = None

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        if self.characteristic is not None:
            yield ("characteristic",), self.characteristic


class CoilAngleSpec(ToleranceSpec):
    """A twist of a spring."""

    dimensions: ClassVar[tuple[Dimension, ...]] = ("angle",)

    kind: Literal["coil_angle"]
    of: Name

    def references(self) -> tuple[Reference, ...]:
        return (Reference(("of",), self.of, (SpringSpec,)),)


class PressSpec(MoveSpec):
    """A spring between two gears."""

    words: ClassVar[str] = "a press"

    kind: Literal["press"]
    spring: Name
    against: Name

    def references(self) -> tuple[Reference, ...]:
        return Reference(("spring",), self.spring, (SpringSpec,)), Reference(("against",), self.against, (GearSpec,))


class LonelyPressSpec(PressSpec):
    """A press against a spring."""

    kind: Literal["press"]

    def references(self) -> tuple[Reference, ...]:
        return (Reference(("spring",), self.spring, (SpringSpec,)),)


class TravelSpec(LengthSpec):
    """Give of a spring."""

    kind: Literal["travel"]

    def references(self) -> tuple[Reference, ...]:
        return (Reference(("of",), self.of, (PressSpec,)),)


def one_press(scene: Scene) -> Iterator[tuple[KeyPath, str]]:
    """A check across entries."""
    _, *more = scene.of(PressSpec) or [""]
    yield from ((("moves", name), "expected one press, got another") for name in more)


def lengths(scene: Scene) -> dict[str, float]:
    """The system of a scene: the lengths of its springs [mm]."""
    return {name: spring.length.internal for name, spring in scene.of(SpringSpec).items()}


SPRINGS = Mechanism(
    name="springs",
    parts=(SpringSpec,),
    tolerances=(CoilAngleSpec,),
    moves=(PressSpec,),
    measures=(TravelSpec,),
    checks=(one_press,),
    includes=("gearing",),
    system="springs:lengths",
    requires=("numpy",),
)
