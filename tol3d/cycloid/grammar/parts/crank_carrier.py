"""A carrier of crankshafts."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.parts.turning import TurningSpec
from tol3d.scene.part import Length


class CrankCarrierSpec(TurningSpec):
    """A carrier: it turns about the common axis in its main bearing and holds the crankshafts; it is the output."""

    words: ClassVar[str] = "a carrier of crankshafts"

    kind: Literal["crank_carrier"]
    radius: Length = Field(description="of the circle of the crankshafts' axes")
