"""What every kind of planet carrier has in common."""

from typing import ClassVar

from tol3d.scene.part import PartSpec


class CarrierSpec(PartSpec):
    """A carrier: it turns about the common axis and holds the pins of the planets."""

    words: ClassVar[str] = "a planet carrier"
