"""What every kind of part has in common."""

from typing import Annotated

from pydantic import Field

from tol3d.scene.entry import Entry
from tol3d.units import Of, Positive, Quantity

Length = Annotated[Quantity, Of("length"), Positive()]


class PartSpec(Entry):
    """A part as a scene writes it."""

    expansion: Annotated[Quantity, Of("expansion")] | None = Field(
        default=None, description="coefficient of linear thermal expansion"
    )
