"""What is read of an RV reducer."""

from dataclasses import dataclass
from typing import Literal

from tol3d.system.plain import PlainMeasure

Reading = Literal["lost motion", "drive", "back"]


@dataclass(frozen=True, kw_only=True)
class RVMeasure(PlainMeasure):
    """A measure of one reducer.

    Args:
        reading: the whole free turn of the output, or where it rests while its load resists or drives it on.
        deflection: pins within it of contact are counted then [mm]; None where the turn itself is read.
    """

    reading: Reading
    deflection: float | None = None

    @property
    def counts(self) -> bool:
        """Whether pins near contact are counted."""
        return self.deflection is not None

    @property
    def sense(self) -> int:
        """Which way a load turns the output: back (-1) where it resists."""
        return -1 if self.reading == "drive" else 1
