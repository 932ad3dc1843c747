"""An assembly: parts with their features and datum frames, the moves in order, what is measured."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from tol3d.assembly.model.datum_frame import DatumFrame
from tol3d.assembly.model.feature import Feature
from tol3d.assembly.model.measures import Measured
from tol3d.assembly.model.move import Move
from tol3d.numerics.arrays import Array
from tol3d.numerics.values import Valued

if TYPE_CHECKING:
    from tol3d.cad.solids.built_shape import BuiltShape


@dataclass(frozen=True, eq=False)
class Part(Valued):
    """A rigid part.

    Args:
        name: as in the scene.
        pose: nominal, in the world (4, 4); moves find the pose near it.
        features: in an order in which each comes after the datum frame it belongs to.
        datum_frames: in an order in which each comes after its features.
        solid: its nominal solid, in its own frame; None without one.
    """

    name: str
    pose: Array
    features: tuple[Feature, ...]
    datum_frames: tuple[DatumFrame, ...]
    solid: "BuiltShape | None" = None


@dataclass(frozen=True, eq=False)
class Assembly(Valued):
    """An assembly.

    Args:
        parts: in the scene's order.
        moves: in the scene's order; what a move needs is placed before.
        measures: by the names of the scene's measures.
        width: columns of the deviations.
    """

    parts: tuple[Part, ...]
    moves: tuple[Move, ...]
    measures: Mapping[str, Measured]
    width: int

    @cached_property
    def features(self) -> Mapping[str, Feature]:
        """All features by their names."""
        return {feature.name: feature for part in self.parts for feature in part.features}

    @cached_property
    def datum_frames(self) -> Mapping[str, DatumFrame]:
        """All datum frames by their names."""
        return {frame.name: frame for part in self.parts for frame in part.datum_frames}

    @cached_property
    def part(self) -> Mapping[str, Part]:
        """All parts by their names."""
        return {part.name: part for part in self.parts}
