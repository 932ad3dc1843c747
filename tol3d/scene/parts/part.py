"""What every kind of part has in common."""

from typing import Annotated, ClassVar

from pydantic import Field

from tol3d.scene.reference import Sort
from tol3d.strict import Strict
from tol3d.units import Of, Quantity


class PartSpec(Strict):
    """A part as a scene writes it."""

    sort: ClassVar[Sort]

    kind: str
    expansion: Annotated[Quantity, Of("expansion")] | None = Field(
        default=None, description="coefficient of linear thermal expansion"
    )
