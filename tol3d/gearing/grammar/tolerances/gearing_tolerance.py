"""What every tolerance of gears, their shafts and their reducers has in common: it means an effect."""

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from tol3d.gearing.effects import Effect, Together
from tol3d.gearing.grammar.moves import MeshSpec
from tol3d.gearing.grammar.parts import GearSpec
from tol3d.scene.direction import At
from tol3d.scene.entry import Entry
from tol3d.scene.name import Name
from tol3d.scene.reference import Reference
from tol3d.scene.tolerance import ToleranceSpec

if TYPE_CHECKING:
    from tol3d.gearing.model.contributor import Unit


@dataclass(frozen=True)
class Meaning:
    """What a deviation does.

    Args:
        effect: on which parts and how; see effects.py.
        planar: whether the deviation is a length in a direction across an axis.
        azimuth: that direction [rad]; None for a random one.
        least: smallest physical deviation [mm, rad or K], such as 0 of a clearance, if there is one.
    """

    effect: Effect
    planar: bool = False
    azimuth: float | None = None
    least: float | None = None


class GearingToleranceSpec(ToleranceSpec):
    """A tolerance of gears, of what carries them, or of how they lie to each other."""

    @abstractmethod
    def meaning(self, nominal: Any) -> Meaning:
        """What a deviation does in a scene whose Nominal geometry is known."""

    @property
    def unit(self) -> "Unit":
        """Unit of its columns in results, by the dimension of its distribution."""
        dimensions = {quantity.dimension for quantity in self.distribution.quantities().values()}
        if dimensions == {"angle"}:
            return "mrad"
        return "K" if dimensions == {"temperature"} else "um"


def in_direction(effects: Sequence[Effect], direction: object) -> Meaning:
    """Effects of one deviation with a direction, of the grammar's words: `{at: angle}`, or random."""
    azimuth = direction.at.internal if isinstance(direction, At) else None
    return Meaning(together(effects), planar=True, azimuth=azimuth)


def together(effects: Sequence[Effect]) -> Effect:
    """Several effects of one deviation as one."""
    return effects[0] if len(effects) == 1 else Together(tuple(effects))


class GearToleranceSpec(GearingToleranceSpec):
    """A tolerance of one gear, or of what carries it."""

    applies_to: ClassVar[tuple[type[Entry], ...]] = (GearSpec,)

    of: Name = Field(description="the gear")

    def references(self) -> tuple[Reference, ...]:
        """The gear, or what carries it."""
        return (Reference(("of",), self.of, self.applies_to),)


class MeshToleranceSpec(GearingToleranceSpec):
    """A tolerance of how two axes lie to each other."""

    applies_to: ClassVar[tuple[type[Entry], ...]] = (MeshSpec,)

    of: Name = Field(description="the mesh move")

    def references(self) -> tuple[Reference, ...]:
        """The mesh."""
        return (Reference(("of",), self.of, self.applies_to),)
