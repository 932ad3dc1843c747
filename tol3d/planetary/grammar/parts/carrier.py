"""What every kind of planet carrier has in common."""

from typing import ClassVar

from tol3d.gearing.grammar.parts.turning import TurningSpec


class CarrierSpec(TurningSpec):
    """A carrier: it turns about the common axis and holds the pins of the planets."""

    words: ClassVar[str] = "a planet carrier"
