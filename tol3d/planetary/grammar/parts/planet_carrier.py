"""What holds the pins of planets."""

from typing import ClassVar, Literal

from tol3d.scene.part import PartSpec


class PlanetCarrierSpec(PartSpec):
    """A rigid carrier: it turns about the common axis and holds the pins of the planets."""

    words: ClassVar[str] = "a planet carrier"

    kind: Literal["planet_carrier"]
