"""Vocabulary of a rod."""

from typing import ClassVar, Literal

from tol3d.scene.bases import Length, MoveSpec, PartSpec, ToleranceSpec
from tol3d.scene.entry import Reference
from tol3d.scene.name import Name
from tol3d.study.system.plain import LengthSpec


class RodSpec(PartSpec):
    """A rod."""

    words: ClassVar[str] = "a rod"

    kind: Literal["rod"]
    length: Length


class LengthToleranceSpec(ToleranceSpec):
    """Excess length of a rod."""

    kind: Literal["rod_length"]
    of: Name

    def references(self) -> tuple[Reference, ...]:
        return (Reference(("of",), self.of, (RodSpec,)),)


class TipSpec(LengthToleranceSpec):
    """Deviation of its tip: the draw, times 1 + ten times the deviation of the length [mm]."""

    kind: Literal["rod_tip"]  # type: ignore[assignment]  # a kind of its own
    length: Name

    def references(self) -> tuple[Reference, ...]:
        return (*super().references(), Reference(("length",), self.length, (LengthToleranceSpec,)))


class MarkSpec(LengthToleranceSpec):
    """Deviation of a mark: the draw [mm], as often as the tip strays by 10 um."""

    kind: Literal["rod_mark"]  # type: ignore[assignment]  # a kind of its own
    tip: Name

    def references(self) -> tuple[Reference, ...]:
        return (*super().references(), Reference(("tip",), self.tip, (TipSpec,)))


class StandSpec(MoveSpec):
    """A rod stands."""

    words: ClassVar[str] = "a standing rod"

    kind: Literal["stand"]
    rod: Name

    def references(self) -> tuple[Reference, ...]:
        return (Reference(("rod",), self.rod, (RodSpec,)),)


class ReachSpec(LengthSpec):
    """Reach of a rod: length, tip and mark together."""

    kind: Literal["rod_reach"]
    of: Name

    def references(self) -> tuple[Reference, ...]:
        return (Reference(("of",), self.of, (StandSpec,)),)
