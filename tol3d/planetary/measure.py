"""What is read of a planetary set."""

from dataclasses import dataclass
from typing import Literal

from tol3d.system.plain import PlainMeasure

Reading = Literal["lost motion", "lag", "lead"]


@dataclass(frozen=True, kw_only=True)
class PlanetaryMeasure(PlainMeasure):
    """A measure of one set.

    Args:
        reading: the whole free turn of a shaft, or where the output rests while its load resists (lag) or drives it.
        set_name: of the set.
        shaft: that turns.
    """

    reading: Reading
    set_name: str
    shaft: str
