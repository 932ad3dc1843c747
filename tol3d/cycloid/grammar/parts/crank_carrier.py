"""A carrier of crankshafts."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.scene.part import Length, PartSpec


class CrankCarrierSpec(PartSpec):
    """A carrier: it turns about the common axis in its main bearing and holds the crankshafts; it is the output."""

    words: ClassVar[str] = "a carrier of crankshafts"

    kind: Literal["crank_carrier"]
    radius: Length = Field(description="of the circle of the crankshafts' axes")
