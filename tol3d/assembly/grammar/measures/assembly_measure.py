"""Common base of all measures of an assembly."""

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import ClassVar, Self

from pydantic import Field, model_validator
from typing_extensions import override

from tol3d.assembly.grammar.datums import Datums, DatumSpec
from tol3d.assembly.grammar.feature_name import FeatureName, Use, part_of
from tol3d.assembly.grammar.features.nominal_frame import unit
from tol3d.assembly.grammar.moves.assembly_move import AssemblyMoveSpec, MoveReference
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.assembly.model.measures import Measured, OverPlay, Reading, Rocking
from tol3d.scene.bases import AngleLimit, LengthLimit, MeasureEntry, Take
from tol3d.scene.entry import Reference
from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath
from tol3d.scene.vector import Direction
from tol3d.strict import refused
from tol3d.units import Dimension


class AssemblyMeasureSpec(MeasureEntry):
    """A measure of an assembly: one number a trial, of features as they lie in it.

    A kind declares all of its own here: its fields, `reads` (how both methods read it) and `measured` (its model).
    """

    words: ClassVar[str] = "a measure of an assembly"
    reads: ClassVar[Reading]
    dimension: ClassVar[Dimension] = "length"

    lower_limit: LengthLimit | AngleLimit | None = Field(default=None, description="less than this is out of limits")
    upper_limit: LengthLimit | AngleLimit | None = Field(default=None, description="more than this is out of limits")
    rocking: Rocking | None = Field(
        default=None,
        description="which value it has where a part may rock on its contacts; without one it then has no value",
    )

    @property
    @override
    def gives_curve(self) -> bool:
        return False

    @property
    @override
    def several_positions(self) -> bool:
        return False

    @classmethod
    def lacking(cls) -> Iterator[str]:
        if hasattr(cls, "reads"):
            yield from cls.reads.lacking()
        else:
            yield "`reads`, how both methods read it"

    @property
    @abstractmethod
    def of_what(self) -> Sequence[str]:
        """Names of its features or parts, as in summary.json."""

    @abstractmethod
    def measured(self, moves: Sequence[str]) -> Measured:
        """Model of the measure without datum frames, bonuses and moment.

        Args:
            moves: names of the scene's moves, in order.
        """


class TimedSpec(AssemblyMeasureSpec):
    """A measure of placed parts."""

    after: Name | None = Field(default=None, description="the move after which it is read; default: the end")
    at: Name | None = Field(
        default=None, description="the pose in which it is read, of a move that has poses; default: its first one"
    )
    over: Name | None = Field(default=None, description="instead, the path over which it is read")
    take: Take = Field(default="value", description="of a path: min, max, range or curve")

    @property
    @override
    def gives_curve(self) -> bool:
        return self.take == "curve"

    @property
    @override
    def several_positions(self) -> bool:
        return self.over is not None

    @property
    @abstractmethod
    def parts_read(self) -> Sequence[str]:
        """The parts that it is of, which moves have placed by then."""

    @model_validator(mode="after")
    def _refuse_take_without_over(self) -> Self:
        if self.over is not None and self.at is not None:
            raise refused("over", "`at` or `over`, one of both", "both")
        if self.over is not None and self.take not in ("min", "max", "range", "curve"):
            raise refused("take", f"min, max, range or curve beside over: {self.over}", self.take)
        if self.over is None and self.take != "value":
            raise refused("take", "`over` beside it, a path", f"take: {self.take} alone")
        return self

    @property
    def timing(self) -> tuple[Reference, ...]:
        """The move after which it is read."""
        if self.after is None:
            return ()
        return (MoveReference(("after",), self.after, (AssemblyMoveSpec,)),)


class FeatureMeasureSpec(TimedSpec):
    """A measure of features."""

    @property
    def along(self) -> Direction | None:
        """The direction in which it is read, in the frame of the first feature's part; None where there is none."""
        return None

    @property
    def named_datums(self) -> tuple[DatumSpec, ...]:
        """Datums of the first feature's part to which it is read."""
        return ()

    @abstractmethod
    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        """Its features with their fields, and the kinds that they may be; from, to."""

    @property
    def of_what(self) -> Sequence[str]:
        """Its features."""
        return tuple(name for _, name, _ in self.named())

    def measured(self, moves: Sequence[str]) -> Measured:
        """Its features, along its direction."""
        return Measured(self.reads, (*self.of_what,), None if self.along is None else unit(self.along))

    def references(self) -> tuple[Reference, ...]:
        """Parts, and the move after which it is read."""
        parts = tuple(Reference(path, part_of(name), (SolidSpec,)) for path, name, _ in self.named())
        return (*parts, *self.timing)

    @property
    def parts_read(self) -> Sequence[str]:
        return [part_of(name) for _, name, _ in self.named()]

    def uses(self) -> Iterator[Use]:
        """The features, and the datums."""
        for path, name, kinds in self.named():
            yield Use(path, name, kinds)
        for k, datum in enumerate(self.named_datums):
            for name in datum.features:
                yield Use(("datums", k), f"{part_of(self.named()[0][1])}.{name}", datum.kinds)


class BetweenSpec(FeatureMeasureSpec):
    """A measure from one feature to another."""

    from_: FeatureName = Field(alias="from", description="the feature where it starts")
    to: FeatureName = Field(description="the feature where it ends")
    datums: Datums | None = Field(
        default=None,
        description="of the part of `from`, in whose frame the direction is fixed; default: the part's",
    )

    @property
    def named_datums(self) -> tuple[DatumSpec, ...]:
        return self.datums or ()

    def named(self) -> Sequence[tuple[KeyPath, FeatureName, tuple[str, ...]]]:
        return ((("from",), self.from_, ()), (("to",), self.to, ()))


class OverPlaySpec(BetweenSpec):
    """A measure from one feature to another that may be read over all poses allowed by play."""

    over_play: OverPlay | None = Field(
        default=None,
        description="least or largest value over the play of parts in the trial; default: as `float` says",
    )

    def measured(self, moves: Sequence[str]) -> Measured:
        """With what is asked of play."""
        return replace(super().measured(moves), over_play=self.over_play)
