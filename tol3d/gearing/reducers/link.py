"""Reducers between two shafts of a train, whose play is the lost motion at their output."""

import math
from abc import abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, partial
from typing import Any, ClassVar, Final, Self

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from tol3d.gearing.links import FreeTurn, LinkTrials, StatedLink, pin_name
from tol3d.gearing.model.brought import shaft_of
from tol3d.gearing.reducers.deviations import Acts, Along
from tol3d.gearing.reducers.trials import ReducerTrials
from tol3d.numerics.arrays import Array
from tol3d.numerics.plane import turned
from tol3d.scene import Scene
from tol3d.study.system.method import ANALYTIC_METHOD
from tol3d.study.system.taken import ROWS_AT_ONCE

UNFOLLOWED: Final = "whose error recurs with turns of its output, not of the motor ({} reads it, in a scene of its own)"
Actions = tuple[tuple[str, Acts], ...]
"""Effect of each contributor, by its name; one may have several."""
Lost = tuple[Array, Array, NDArray[np.bool_]]
"""Free turn and its middle [rad], and where the reducer jams, (trials,) each."""


@dataclass(frozen=True, kw_only=True)
class ReducerLink(StatedLink):
    """A reducer whose input and output turn with shafts of a train, its third shaft held in the world.

    It is modelled by itself, its output at 0 with the driver at 0, and read at the driver's nominal position: the small
    extra turn by the play of earlier stages has no effect.

    Args:
        own: its model: names, ratio, and period in turns of the output.
        height: of its middle along the driver's z [mm].
        actions: of its contributors.
    """

    has_middle: ClassVar[bool] = True
    compares: ClassVar[bool] = True
    housed: ClassVar[bool] = False

    alone: ClassVar[type[ReducerTrials]]
    """System of such a reducer alone, whose solvers and deviations of parts are also those of the link."""

    pins_act: ClassVar[Acts]
    """Effect of displacements of the carrier's pins, each outwards and counter-clockwise."""

    own: Any
    height: float
    actions: Actions

    @classmethod
    def between(cls, scene: Scene, own: Any, actions: Actions, heights: Mapping[str, float]) -> Self:
        """The link of the shafts that turn with the input and the output of a reducer.

        Args:
            scene, own, actions: see ReducerLink.
            heights: of its input and its output over its middle [mm].
        """
        (driver, first), (driven, last) = (shaft_of(scene, part) for part in (own.input, own.output))
        height = first - heights[own.input]
        return cls(
            name=own.name,
            driver=driver,
            driven=driven,
            rate=1 / own.ratio,
            offset=height - (last - heights[own.output]),
            own=own,
            height=height,
            actions=actions,
        )

    @property
    def turns(self) -> Fraction:
        """Turns of the input until all parts meet again as before."""
        return Fraction(self.own.period * abs(self.own.ratio))

    @cached_property
    def acts(self) -> Mapping[str, Acts]:
        """Effect of each contributor."""
        return dict(self.actions)

    def output_turns(self, seen: LinkTrials) -> Array:
        """Turns of the output (trials, positions) at the driver's nominal positions."""
        return np.ascontiguousarray(seen.angles / (2 * math.pi) * float(self.rate))

    @property
    @override
    def held(self) -> str:
        return str(self.own.held)

    @override
    def is_compiled(self) -> bool:
        return all(solver.is_kept(self.own) for solver in self.alone.solvers.values())

    # its play ---------------------------------------------------------------------------------------

    def exact(self, seen: LinkTrials) -> FreeTurn:
        """The free turn of the output, all parts placed."""
        return self.free_turn(self.alone.solvers["exact"].turning(self.own), seen)

    def analytic(self, seen: LinkTrials) -> FreeTurn:
        """The same to first order."""
        return self.free_turn(self.alone.solvers[ANALYTIC_METHOD].turning(self.own), seen)

    def free_turn(self, turning: Any, seen: LinkTrials) -> FreeTurn:
        """The free turn of the output by one method, position by position as a measure of the reducer reads it."""
        found = [self.lost(turning, self.deviated(seen, turns), turns) for turns in self.output_turns(seen).T]
        play, middle, jams = (np.stack(own, axis=1) for own in zip(*found, strict=True))
        return FreeTurn(play, np.where(jams, 0.0, middle), jams.astype(bool))

    @abstractmethod
    def lost(self, turning: Any, deviated: Any, turns: Array) -> Lost:
        """The free turn at turns of the output (trials,), by a method's turning."""

    def deviated(self, seen: LinkTrials, turns: Array) -> Any:
        """Deviations of its parts at turns of the output (trials,), by its own contributors and by bores."""
        drawn = ((contributor.name, seen.deviations[contributor.name]) for contributor in seen.contributors)
        found = self.alone.made_of.drawn(self.own, self.acts, drawn, len(seen))
        asides, none = self.asides(seen), np.zeros((len(seen), 2))
        for part, acts, components in self._movable(turns) if asides else ():
            carried = asides.get(self.own.carrier, none) if part in self.centrals else none
            found.add(self.own, acts, components(asides.get(part, none) - carried))
        return found

    @property
    @abstractmethod
    def centrals(self) -> Mapping[str, tuple[Acts, float]]:
        """Parts about the common axis but the carrier, whose offset equals that of all of them the other way.

        Of each the effect of its offset from the carrier's axis, and the turns of the frame in which this acts, a turn
        of the output.
        """

    def _movable(self, turns: Array) -> Iterator[tuple[str, Acts, Along]]:
        """Parts that bores may move, the effect of that, and its components by the offset (trials, 2) [mm]."""
        for part, (acts, rate) in self.centrals.items():
            yield part, acts, partial(turned, turns=-rate * turns)
        for k, pin in enumerate(np.eye(len(self.pins))):
            yield pin_name(k), self.pins_act, partial(np.kron, pin)  # type: ignore[misc]  # its stub is of bool first

    # what acts on it --------------------------------------------------------------------------------

    @abstractmethod
    def slopes_at(self, deviated: Any, turns: Array) -> Any:
        """Change of the play by each deviation, with the contacts at turns of the output (trials,)."""

    def slopes(self, seen: LinkTrials) -> Iterator[tuple[LinkTrials, Array, Any]]:
        """The same at the first position, piece by piece of the trials, with turns of the output (trials,)."""
        for first in range(0, len(seen), ROWS_AT_ONCE):
            piece = seen.part(first, first + ROWS_AT_ONCE)
            turns = self.output_turns(piece)[:, 0]
            yield piece, turns, self.slopes_at(self.deviated(piece, turns), turns)

    @override
    def aside_slopes(self, seen: LinkTrials) -> Mapping[str, Array]:
        pieces = []
        for piece, turns, slopes in self.slopes(seen):
            units = [np.tile(unit, (len(piece), 1)) for unit in np.eye(2)]
            by = {
                part: np.stack([slopes.term(self.own, acts, components(unit)) for unit in units], axis=-1)
                for part, acts, components in self._movable(turns)
            }
            by[self.own.carrier] = -np.sum([by[part] for part in self.centrals], axis=0)
            pieces.append(by)
        return {part: np.concatenate([by[part] for by in pieces]) for part in pieces[0]}

    def parts(self, seen: LinkTrials, means: Mapping[str, Array]) -> Mapping[str, Array]:
        """By the contacts of each trial, to first order; see StatedLink, and ReducerTrials.regress_slopes."""
        found = [
            {name: slopes.term(self.own, acts, piece.deviations[name] - means[name]) for name, acts in self.actions}
            for piece, _, slopes in self.slopes(seen)
        ]
        return {name: np.concatenate([each[name] for each in found]) for name in self.acts}

    @property
    @abstractmethod
    def offsets(self) -> Mapping[str, Acts]:
        """Parts that a shaft with run-out moves, and the effect of that."""

    @override
    def offset_by(self, contributor: str, part: str) -> Self | None:
        acts = self.offsets.get(part)
        return None if acts is None else replace(self, actions=(*self.actions, (contributor, acts)))
