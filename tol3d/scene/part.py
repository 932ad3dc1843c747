"""Common base of every kind of part."""

from typing import Annotated, ClassVar

from pydantic import Field

from tol3d.scene.entry import Entry
from tol3d.scene.place import KeyPath
from tol3d.units import Of, Positive, Quantity

Length = Annotated[Quantity, Of("length"), Positive()]


class PartSpec(Entry):
    """A part as a scene writes it."""

    origin_field: ClassVar[KeyPath] = ()
    """The field that states the place of its origin in the world; () if there is none."""

    expansion: Annotated[Quantity, Of("expansion")] | None = Field(
        default=None, description="coefficient of linear thermal expansion"
    )

    @property
    def has_solid(self) -> bool:
        """True if a solid has to be built before all that the scene says of it is known."""
        return False


class GrowingSpec(PartSpec):
    """A part that grows with temperature; kinds of part with relevant sizes are subclasses."""

    words: ClassVar[str] = "a part that grows with temperature"
