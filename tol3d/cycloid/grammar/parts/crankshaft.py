"""A crankshaft."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.gearing.grammar.parts.turning import TurningSpec
from tol3d.scene.part import Length


class CrankshaftSpec(TurningSpec):
    """A crankshaft with an eccentric for each disc, evenly around; an RV reducer has several alike."""

    words: ClassVar[str] = "a crankshaft"

    kind: Literal["crankshaft"]
    eccentricity: Length = Field(description="of the eccentrics")
