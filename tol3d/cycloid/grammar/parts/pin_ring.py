"""A ring of pins."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.parts.turning import TurningSpec
from tol3d.scene.part import Length


class PinRingSpec(TurningSpec):
    """Pins, evenly spaced on a circle of the housing, among which cycloid discs run."""

    words: ClassVar[str] = "a pin ring"

    kind: Literal["pin_ring"]
    pins: int = Field(ge=4, le=401, description="number of pins")
    radius: Length = Field(description="of the circle of the pins' axes")
    pin_radius: Length = Field(description="of the pins")
