"""Holes, slots and pins as a scene writes them."""

from typing import Annotated

from pydantic import Field

from tol3d.assembly.grammar.builders.builder_spec import Place, place
from tol3d.parts.details import Hole, Pin, Slot
from tol3d.scene.part import Length
from tol3d.strict import Strict
from tol3d.units import Of, Quantity


class HoleSpec(Strict):
    """A drilled hole."""

    at: Place = Field(description="its axis on the face: x, y and z of the part without the one square to the face")
    diameter: Length
    depth: Length | None = Field(default=None, description="of a blind hole; it goes through if not given")

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
        default=None, description="from the face's first coordinate towards its second; along the first if not given"
    )
    depth: Length | None = Field(default=None, description="of a blind slot; it goes through if not given")

    def named(self, name: str, face: str = "top") -> Slot:
        """The slot by its name, in a face."""
        turned = 0.0 if self.turned is None else self.turned.internal
        depth = None if self.depth is None else self.depth.internal
        return Slot(name, place(self.at), self.length.internal, self.width.internal, turned, depth, face)


class PinSpec(Strict):
    """A round pin that stands on the top, or on a rim."""

    at: Place = Field(description="its axis")
    diameter: Length
    height: Length = Field(description="above what it stands on")

    def named(self, name: str) -> Pin:
        """The pin by its name."""
        return Pin(name, place(self.at), self.diameter.internal, self.height.internal)
