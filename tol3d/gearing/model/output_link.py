"""Links of a train that are mechanisms with their own output: common base of reducers and planetary sets."""

import math
from abc import abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from tol3d.gearing.links import LinkTrials, StatedLink
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.scene.part import PartSpec
from tol3d.system.taken import ROWS_AT_ONCE


@dataclass(frozen=True, kw_only=True)
class OutputLink(StatedLink):
    """A mechanism whose input and output turn with shafts of a train, its third shaft held in the world.

    It is modelled by itself, its output at 0 with the driver at 0, and read at the driver's nominal position: the small
    extra turn by the play of earlier stages has no effect.

    Args:
        own: the mechanism: its ratio, and its period in turns of the output.
        height: of its middle along the driver's z [mm].
        actions: what each contributor acts on, by its name.
    """

    has_middle: ClassVar[bool] = True
    compares: ClassVar[bool] = True
    housed: ClassVar[bool] = False

    own: Any
    height: float
    actions: tuple[tuple[str, Any], ...]

    @property
    def turns(self) -> Fraction:
        """Turns of the input until all parts meet again as before."""
        return Fraction(self.own.period * abs(self.own.ratio))

    @cached_property
    def acts(self) -> Mapping[str, Any]:
        """Action of each contributor."""
        return dict(self.actions)

    def output_turns(self, seen: LinkTrials) -> Array:
        """Turns of the output (trials, positions) at the driver's nominal positions."""
        return np.ascontiguousarray(seen.angles / (2 * math.pi) * float(self.rate))

    def parts(self, seen: LinkTrials, means: Mapping[str, Array]) -> Mapping[str, Array]:
        """By the contacts of each trial, to first order; see StatedLink, and regressors.py of the mechanism."""
        found = [
            {name: self.part_of(slopes, acts, piece.deviations[name] - means[name]) for name, acts in self.actions}
            for piece, _, slopes in self.slopes(seen)
        ]
        return {name: np.concatenate([each[name] for each in found]) for name in self.acts}

    @abstractmethod
    def part_of(self, slopes: Any, acts: Any, off: Array) -> Array:
        """Play added by a contributor off its mean (trials, components) (trials,) [rad]."""

    @abstractmethod
    def slopes_at(self, piece: LinkTrials, turns: Array) -> Any:
        """Slopes of the play at the first position for each deviation; turns (trials, 1) of the output."""

    def slopes(self, seen: LinkTrials) -> Iterator[tuple[LinkTrials, Array, Any]]:
        """The same piece by piece of the trials, with turns of the output (trials,)."""
        for first in range(0, len(seen), ROWS_AT_ONCE):
            piece = seen.part(first, first + ROWS_AT_ONCE)
            turns = self.output_turns(piece)[:, :1]
            yield piece, turns[:, 0], self.slopes_at(piece, turns)


def refuse_alone(scene: Scene, kind: type, ends: Mapping[str, tuple[str, str]], words: str) -> None:
    """Refuse measures of a mechanism alone, which trains read; by its name, the parts of its input and its output."""
    for name, measure in scene.measures.items():
        if isinstance(measure, kind):
            spec: Any = measure
            driver, output = ends[spec.of]
            raise scene.refuse(
                ("measures", name, "kind"),
                f"expected a measure of trains, for {spec.of!r} is a stage of one, got {spec.kind}; take lost_motion "
                f"of a train whose output turns with {output!r}, and of the {words} alone one whose held shaft turns "
                f"with {driver!r}",
            )


def refuse_unused(scene: Scene, kinds: tuple[type[PartSpec], ...], used: Mapping[str, Any], words: str) -> None:
    """Refuse parts of mechanisms that no move names."""
    for name, part in scene.parts.items():
        if isinstance(part, kinds) and name not in used:
            raise scene.refuse(("parts", name), f"{name!r} is used by no move; name it in {words} or take it out")
