"""Error of an arm's point over a swing."""

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from tol3d.gearing.grammar.measures.tip_measure import TipMeasureSpec
from tol3d.scene.measure import MOST_POSITIONS, Take
from tol3d.strict import refused
from tol3d.units import Of, Quantity

FEWEST_POSITIONS = 2  # start and end


class TipErrorSpec(TipMeasureSpec):
    """A curve of lengths: the error of the point at positions of the train's output, from start to end."""

    take: ClassVar[Take] = "curve"

    kind: Literal["tip_error"]
    start: Annotated[Quantity, Of("angle")] = Field(description="of the train's output, the first position")
    end: Annotated[Quantity, Of("angle")] = Field(description="of the train's output, the last position")
    positions: int = Field(
        default=25, ge=FEWEST_POSITIONS, le=MOST_POSITIONS, description="from start to end, both counted"
    )

    @model_validator(mode="after")
    def _refuse_reversed_swing(self) -> Self:
        if not self.start.internal < self.end.internal:
            raise refused("start", f"less than the end ({self.end})", self.start)
        return self
