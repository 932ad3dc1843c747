"""How far two parts are apart anywhere."""

from collections.abc import Sequence
from typing import ClassVar, Final, Literal, Self

from pydantic import Field, model_validator

from tol3d.assembly.grammar.measures.assembly_measure import TimedSpec
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.model.measures import Measured, Reading
from tol3d.scene.name import Name
from tol3d.scene.part import Length
from tol3d.scene.reference import Reference
from tol3d.strict import refused

CHORD_ERROR: Final = 2e-3
"""mm; of a clearance that states none: small against tolerances, and of the size of what parts' meshes cost little."""


class ClearanceSpec(TimedSpec):
    """How far two parts with solids are apart where they are nearest, within the `chord_error`.

    That is 2 um if not given.
    """

    requires: ClassVar[tuple[str, ...]] = ("python-fcl", "cadquery")
    reads: ClassVar[Reading] = Reading(
        "clearance",
        "tol3d.assembly.clearances.distances:SolidDistances",
        "tol3d.assembly.torsors.surfaces:clearance",
        by_solids=True,
    )

    kind: Literal["clearance"]
    from_: Name = Field(alias="from", description="a part with a solid")
    to: Name = Field(description="the other one")
    chord_error: Length | None = Field(
        default=None, description="how far its value may be off, by the meshes of both solids; 2 um if not given"
    )

    @property
    def error(self) -> float:
        """The chord error [mm]."""
        return CHORD_ERROR if self.chord_error is None else self.chord_error.internal

    @property
    def parts_read(self) -> Sequence[str]:
        """See TimedSpec."""
        return (self.from_, self.to)

    @property
    def of_what(self) -> Sequence[str]:
        """Both parts."""
        return self.parts_read

    def measured(self, moves: Sequence[str]) -> Measured:
        """Both parts."""
        return Measured(self.reads, (), parts=(self.from_, self.to), chord_error=self.error)

    def references(self) -> tuple[Reference, ...]:
        """Both parts, and the move after which it is read."""
        parts = (Reference(("from",), self.from_, (SolidSpec,)), Reference(("to",), self.to, (SolidSpec,)))
        return (*parts, *self.timing)

    @model_validator(mode="after")
    def _refuse_itself(self) -> Self:
        if self.from_ == self.to:
            raise refused("to", "another part", repr(self.to))
        return self
