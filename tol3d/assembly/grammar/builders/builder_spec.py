"""Common base of all kinds of builder."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal

from pydantic import AfterValidator, Field

from tol3d.cad.solids import BuiltShape
from tol3d.parts.details import Hole, Pin, Slot
from tol3d.scene.bases import Length
from tol3d.scene.listed import listed
from tol3d.scene.place import KeyPath
from tol3d.scene.vector import Coordinate
from tol3d.strict import Strict, refused
from tol3d.units import Of, Quantity, shown

Place = Annotated[tuple[Coordinate, Coordinate], listed("lengths", 2, 2)]
"""Two coordinates on a flat face."""


class BuilderSpec(Strict, ABC):
    """A solid as a scene writes it by its dimensions, in the frame of its part."""

    words: ClassVar[str]

    kind: str

    @property
    @abstractmethod
    def shape(self) -> BuiltShape:
        """Shape from which the solid is built."""


def place(at: Place) -> tuple[float, float]:
    """Two coordinates [mm]."""
    return at[0].internal, at[1].internal


def place_of(builder: Strict, detail: str) -> KeyPath:
    """Key of a detail such as a hole or pin, relative to its builder; the builder itself if it has no such detail."""
    for field in type(builder).model_fields:
        named = getattr(builder, field)
        if isinstance(named, Mapping) and detail in named:
            return (field, detail)
    return ()


class HoleSpec(Strict):
    """A drilled hole."""

    at: Place = Field(description="its axis on the face: x, y and z of the part without the one square to the face")
    diameter: Length = Field(description="of the hole")
    depth: Length | None = Field(default=None, description="of a blind hole; default: it goes through")

    def named(self, name: str, face: str = "top") -> Hole:
        """The hole by its name, in a face."""
        depth = None if self.depth is None else self.depth.internal
        return Hole(name, place(self.at), self.diameter.internal, depth, face)


class SlotSpec(Strict):
    """A milled slot with round ends."""

    at: Place = Field(description="its middle on the face")
    length: Length = Field(description="from end to end")
    width: Length = Field(description="between its walls")
    turned: Annotated[Quantity, Of("angle")] | None = Field(
        default=None, description="from the face's first coordinate towards its second; default: along the first"
    )
    depth: Length | None = Field(default=None, description="of a blind slot; default: it goes through")

    def named(self, name: str, face: str = "top") -> Slot:
        """The slot by its name, in a face."""
        turned = 0.0 if self.turned is None else self.turned.internal
        depth = None if self.depth is None else self.depth.internal
        return Slot(name, place(self.at), self.length.internal, self.width.internal, turned, depth, face)


class PinSpec(Strict):
    """A round pin that stands on the top, or on a rim."""

    at: Place = Field(description="its axis")
    diameter: Length = Field(description="of the pin")
    height: Length = Field(description="above what it stands on")

    def named(self, name: str) -> Pin:
        """The pin by its name."""
        return Pin(name, place(self.at), self.diameter.internal, self.height.internal)


def _argument(name: str) -> str:
    if not name.isidentifier():
        raise refused("", "a name that Python takes as an argument, such as wall_thickness", shown(name))
    return name


Argument = Annotated[str, AfterValidator(_argument)]
Size = Annotated[Quantity, Of("length", "angle")]


class OwnFileSpec(Strict):
    """A program that makes the solid; it runs only with the user's permission, and never from a kept run."""

    words: ClassVar[str] = "a Python file"

    kind: Literal["file"]
    file: str = Field(description="the Python file, in the scene's folder")
    function: Argument = Field(default="build", description="of the file, which returns the solid")
    dimensions: Mapping[Argument, Size] = Field(
        default_factory=dict, description="its arguments that are lengths or angles; it gets them in mm and rad"
    )
    counts: Mapping[Argument, int] = Field(default_factory=dict, description="its arguments that are whole numbers")
