"""What every kind of part has in common."""

from typing import Annotated, ClassVar

from pydantic import Field

from tol3d.scene.reference import Reference, Sort
from tol3d.strict import Strict
from tol3d.units import Of, Positive, Quantity

Length = Annotated[Quantity, Of("length"), Positive()]


class PartSpec(Strict):
    """A part as a scene writes it."""

    sort: ClassVar[Sort]

    kind: str
    expansion: Annotated[Quantity, Of("expansion")] | None = Field(
        default=None, description="coefficient of linear thermal expansion"
    )

    def references(self) -> tuple[Reference, ...]:
        """Every name that the part uses; most use none."""
        return ()
