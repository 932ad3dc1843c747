"""Common base of tolerances of gears, their shafts and their reducers: each has an effect."""

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, Protocol

from pydantic import Field

from tol3d.files import Files
from tol3d.gearing.effects import CombinedEffect, Effect, LinkDeviation
from tol3d.gearing.grammar.moves import LinkSpec, MeshSpec, ReducerSpec
from tol3d.gearing.grammar.parts import GearSpec
from tol3d.gearing.shafts import Carried, Mesh
from tol3d.gears import BevelPair, Gear
from tol3d.scene import Scene
from tol3d.scene.bases import MoveSpec, PartSpec, ToleranceSpec
from tol3d.scene.direction import At
from tol3d.scene.entry import AboutOne, Contradiction, Entry, Reference
from tol3d.scene.name import Name
from tol3d.statistics.distributions import Distribution
from tol3d.statistics.distributions.derived import Derived, Scale
from tol3d.units import Dimension

Unit = Literal["um", "mrad", "K", "arcmin"]
"""Unit of the columns of a contributor."""


class Nominal(Protocol):
    """Nominal data for the meaning of a tolerance; model/nominal.py makes it of a scene."""

    @property
    def scene(self) -> Scene:
        """The scene."""
        ...

    @property
    def meshes(self) -> Mapping[str, Mesh]:
        """The meshes of its gears, by name."""
        ...

    def mesh_of(self, gear: str, mesh: str | None = None) -> Mesh:
        """The mesh of that name, or the first one of a gear."""
        ...

    def bevel_pair(self, mesh: str) -> BevelPair:
        """The pair of a bevel mesh."""
        ...

    def smaller_face_width(self, mesh: str) -> float:
        """Smaller face width of the gears of a mesh [mm]."""
        ...

    def carried_by(self, shaft: str) -> Sequence[Carried]:
        """The gears on a shaft."""
        ...

    def seat_azimuth(self, mesh: str) -> float:
        """Turn of the driven gear of a mesh that closes a load path, 0 of others [rad]."""
        ...


@dataclass(frozen=True)
class Meaning:
    """Meaning of a deviation.

    Args:
        effect: on the parts; see effects.py.
        planar: True if the deviation is a length in a direction across an axis.
        azimuth: that direction [rad]; None for a random one.
        least: smallest physical deviation [mm, rad or K], such as 0 of a clearance, if there is one.
        scale: from what the scene states to the deviation; None where that is the deviation.
    """

    effect: Effect
    planar: bool = False
    azimuth: float | None = None
    least: float | None = None
    scale: Scale | None = None


def by_scale(stated: Distribution, scale: Scale | None) -> Distribution:
    """The law of a deviation by that of what the scene states."""
    return stated if scale is None else Derived(stated, scale)


class GearingToleranceSpec(ToleranceSpec):
    """A tolerance of gears, of their shafts and bearings, or of their relative position."""

    displaces: ClassVar[bool] = False
    """It takes an axis off its place, as no scene means by more than half of a module."""

    @abstractmethod
    def meaning(self, nominal: Any) -> Meaning:
        """Meaning of a deviation in a scene with known Nominal geometry."""

    @property
    def unit(self) -> Unit:
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
    return effects[0] if len(effects) == 1 else CombinedEffect(tuple(effects))


class GearToleranceSpec(AboutOne, GearingToleranceSpec):
    """A tolerance of one gear, or of its shaft or bearing."""

    applies_to: ClassVar[tuple[type[Entry], ...]] = (GearSpec,)

    of: Name = Field(description="the gear")

    def scale_of(self, gear: Gear) -> Scale | None:
        """From what the scene states to the deviation of a gear; None where that is the deviation."""
        return None

    def law_on(self, gear: Gear, files: Files) -> Distribution:
        """The law of the deviation of a gear."""
        return by_scale(self.distribution.resolve(files), self.scale_of(gear))


class MeshToleranceSpec(AboutOne, GearingToleranceSpec):
    """A tolerance of the relative position of two axes."""

    applies_to: ClassVar[tuple[type[Entry], ...]] = (MeshSpec,)

    of: Name = Field(description="the mesh move")


class LinkToleranceSpec(GearingToleranceSpec):
    """A deviation of a link; the link finds it by the kind of the tolerance, and knows its effect on the play."""

    link_spec: ClassVar[type[Any]] = LinkSpec  # or a kind of it

    of: Name = Field(description="the link")

    def references(self) -> tuple[Reference, ...]:
        """The link."""
        return (Reference(("of",), self.of, (self.link_spec,)),)

    def meaning(self, nominal: Nominal) -> Meaning:
        """A deviation of one component, of the link alone."""
        return Meaning(LinkDeviation(self.of))


class ReducerBacklashSpec(LinkToleranceSpec):
    """An angle: the free turn of the reducer's driven shaft while its driver is held; draws below 0 are unphysical."""

    dimensions: ClassVar[tuple[Dimension, ...]] = ("angle",)
    link_spec: ClassVar[type[Any]] = ReducerSpec

    kind: Literal["reducer_backlash"]
    of: Name = Field(description="the reducer")

    nominal: ClassVar[str] = ""  # a reducer is bought

    def contradictions(self, parts: Mapping[str, PartSpec], moves: Mapping[str, MoveSpec]) -> Iterator[Contradiction]:
        """The reducer's own backlash would be a second one."""
        reducer = moves[self.of]
        if isinstance(reducer, ReducerSpec) and reducer.backlash is not None:
            got = f"{self.of!r}, which says backlash: {reducer.backlash}"
            yield Contradiction(("of",), "a reducer without a backlash of its own", got)

    def meaning(self, nominal: Nominal) -> Meaning:
        """The shaft that the reducer drives has this play."""
        return Meaning(LinkDeviation(self.of), least=0.0)

    @property
    def unit(self) -> Unit:
        """Arc minutes, as data sheets state it."""
        return "arcmin"
