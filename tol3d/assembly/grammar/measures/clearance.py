"""Clearances: of whole parts, of a bolt through holes, and the slack of a move."""

from collections.abc import Sequence
from typing import Annotated, ClassVar, Final, Literal, Self

from pydantic import Field, model_validator

from tol3d.assembly.grammar.datums import Datums, DatumSpec
from tol3d.assembly.grammar.feature_name import FeatureName
from tol3d.assembly.grammar.measures.assembly_measure import AssemblyMeasureSpec, FeatureMeasureSpec, TimedSpec
from tol3d.assembly.grammar.moves.assembly_move import MoveReference
from tol3d.assembly.grammar.moves.play import PlaySpec
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.model.measures import PLACING, TORSORS, Measured, Reading
from tol3d.scene.bases import Length
from tol3d.scene.entry import Reference
from tol3d.scene.listed import listed
from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath
from tol3d.strict import refused

CHORD_ERROR: Final = 2e-3
"""mm; default chord error of a clearance: small against tolerances, and cheap to mesh."""


class ClearanceSpec(TimedSpec):
    """Smallest distance of two parts with solids, within the `chord_error`.

    The default chord error is 2 um.
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
        default=None, description="how far its value may be off, by the meshes of both solids; default: 2 um"
    )

    @property
    def error(self) -> float:
        """The chord error [mm]."""
        return CHORD_ERROR if self.chord_error is None else self.chord_error.internal

    @property
    def parts_read(self) -> Sequence[str]:
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


MOST_HOLES = 8


class VirtualClearanceSpec(FeatureMeasureSpec):
    """Diameter of the largest straight bolt that passes all of 2 to 8 `holes`."""

    reads: ClassVar[Reading] = Reading(
        "virtual_clearance",
        "tol3d.assembly.placing.measuring:virtual_clearance",
        f"{TORSORS}:virtual_clearance",
    )

    kind: Literal["virtual_clearance"]
    holes: Annotated[tuple[FeatureName, ...], listed("holes", 2, MOST_HOLES)] = Field(
        description="in one line; the bolt stands along the nominal axis of the first, as its part carries it"
    )
    datums: Datums | None = Field(
        default=None, description="of the first hole's part, to which the bolt stands; default: its part's frame"
    )

    @property
    def named_datums(self) -> tuple[DatumSpec, ...]:
        return self.datums or ()

    @model_validator(mode="after")
    def _refuse_twice(self) -> Self:
        for k, name in enumerate(self.holes):
            if name in self.holes[:k]:
                raise refused("holes", "each hole once", repr(name))
        return self

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        return tuple((("holes", k), name, ("cylinder",)) for k, name in enumerate(self.holes))


class SlackSpec(AssemblyMeasureSpec):
    """The largest clearance that a pose leaves at all pairs of a `pin_and_hole` or `pattern` move together.

    Below 0 they do not go together.
    """

    words: ClassVar[str] = "a slack"
    reads: ClassVar[Reading] = Reading("slack", f"{PLACING}:slack", f"{TORSORS}:slack", is_linear=True)

    kind: Literal["slack"]
    of: Name = Field(description="the move, of kind pin_and_hole or pattern")

    def references(self) -> tuple[Reference, ...]:
        """The move."""
        return (MoveReference(("of",), self.of, (PlaySpec,)),)

    @property
    def of_what(self) -> Sequence[str]:
        """The move."""
        return (self.of,)

    def measured(self, moves: Sequence[str]) -> Measured:
        """The move."""
        return Measured(self.reads, (), of_move=moves.index(self.of))
