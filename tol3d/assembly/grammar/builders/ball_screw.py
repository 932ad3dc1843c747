"""The shaft of a ball screw."""

from typing import ClassVar, Literal

from pydantic import Field

from tol3d.assembly.grammar.builders.builder_spec import BuilderSpec
from tol3d.scene.part import Length
from tol3d.solids.linkage_parts import BallScrew
from tol3d.strict import Strict


class JournalSpec(Strict):
    """An end that is turned down."""

    diameter: Length = Field(description="of the journal")
    length: Length = Field(description="along z")


class BallScrewSpec(BuilderSpec):
    """A shaft along z without its groove; its part's origin is the middle of its bottom."""

    words: ClassVar[str] = "a ball screw"

    kind: Literal["ball_screw"]
    diameter: Length = Field(description="of the thread")
    length: Length = Field(description="from end to end, along z")
    journal: JournalSpec | None = Field(default=None, description="at either end; default: none")

    @property
    def shape(self) -> BallScrew:
        """See BuilderSpec."""
        journal = None if self.journal is None else (self.journal.diameter.internal, self.journal.length.internal)
        return BallScrew(self.diameter.internal, self.length.internal, journal)
