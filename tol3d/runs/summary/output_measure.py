"""A measure of where the output of a reducer or a planetary set stands, as summary.json has it."""

from typing import Annotated, Final

from pydantic import Field

from tol3d.runs.summary.measure import MeasureSummary
from tol3d.runs.summary.values import LEFT_OUT, Label, Maybe

MOST_ORDER: Final = 16_000


class OutputMeasureSummary(MeasureSummary):
    """A measure of an output; its kind is the mechanism's word, then the quantity's."""

    of: Label
    order: Maybe[Annotated[int, Field(ge=1, le=MOST_ORDER)]] = Field(
        default=LEFT_OUT, description="of a harmonic: cycles a turn of the output"
    )

    @property
    def quantity(self) -> str:
        """Quantity in words: `largest transmission error`."""
        taken = {
            "min": "least ",
            "max": "largest ",
            "range": "range of the ",
            "harmonic": f"order {self.order}, peak to peak, of the ",
        }
        return taken.get(self.take, "") + self.kind.partition("_")[2].replace("_", " ")

    @property
    def position_word(self) -> str:
        return "output"

    @property
    def identity(self) -> tuple[str | None, ...]:
        return self.kind, self.of, None if self.order is None else str(self.order)
