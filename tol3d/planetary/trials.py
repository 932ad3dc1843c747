"""Measures and trials of a planetary set, and the road that reads them; both roads differ in how far shafts turn."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.programme import NO_ROOM, STALLED
from tol3d.planetary.first_order.levers import play_bound
from tol3d.planetary.model.deviated import Acts, Deviated, Followed, Free
from tol3d.planetary.model.planetary_set import PlanetarySet
from tol3d.system.contributor import Contributor
from tol3d.system.measure import Measure
from tol3d.system.output_system import OutputSystem
from tol3d.system.plain import PlainMeasure
from tol3d.system.positions import Positions
from tol3d.system.road import Answers
from tol3d.system.stated import component_slices
from tol3d.system.statuses import Statuses
from tol3d.system.trials import Trials

Array = NDArray[np.float64]

Reading = Literal["lost motion", "low stiffness", "lag", "lead"]


@dataclass(frozen=True, kw_only=True)
class PlanetaryMeasure(PlainMeasure):
    """A measure of one set.

    Args:
        reading: the whole free turn of a shaft, what it turns against springs alone, or where the output rests while
            its load resists (lag) or drives it.
        set_name: of the set.
        shaft: that turns.
    """

    reading: Reading
    set_name: str
    shaft: str

    @property
    def is_free_turn(self) -> bool:
        """Whether it is a free turn of a shaft at one position, or a part of it."""
        return self.reading in ("lost motion", "low stiffness")

    @property
    def curve_key(self) -> Hashable:
        """Measures of one key are read from the same curve."""
        return self.reading, self.shaft, self.positions

    def sense(self, own: PlanetarySet) -> float:
        """1 where the output turns counter-clockwise while the input does, else -1."""
        return 1.0 if own.ratio > 0 else -1.0

    def turns_of(self, at_random: Array) -> Array:
        """Turns of the output (trials,) where a lost motion is read: those of the trials, or a fixed one."""
        if self.positions.over == "random":
            return at_random
        return np.full(len(at_random), self.positions.angle / (2 * np.pi))

    def weights(self, curves: Array) -> Array:
        """What is taken of curves (trials, positions) is the sum of their values times these, near these curves.

        Curves are read from their first position on. A harmonic is read along its own phase.
        """
        found, rows = np.zeros_like(curves), np.arange(len(curves))
        if self.take == "harmonic":
            assert self.spectrum is not None
            count = self.positions.count
            cycles = float(self.spectrum.orders[0]) * np.arange(count) / count
            waves = np.exp(-2j * np.pi * cycles)
            sums = curves[:, :count] @ waves
            sizes = np.abs(sums)
            phases = np.conj(sums) / np.where(sizes > 0.0, sizes, 1.0)
            found[:, :count] = 4 / count * (phases[:, None] * waves).real
            return found
        if self.take in ("max", "range"):
            found[rows, curves.argmax(axis=1)] += 1.0
        if self.take in ("min", "range"):
            found[rows, curves.argmin(axis=1)] += -1.0 if self.take == "range" else 1.0
        if self.take != "range":
            found[:, 0] -= 1.0
        return found

    def end(self, own: PlanetarySet) -> int:
        """Which end of its free turn the output rests at: the lower (0) or the upper one (1)."""
        return 0 if (self.reading == "lag") == (self.sense(own) > 0.0) else 1


STATUSES: Final = Statuses(
    texts=("ok", "interferes", "singular"),
    lacking=frozenset(("interferes",)),
    words={"interferes": "jam", "singular": "cannot be solved"},
    states={"interferes": "jammed"},
)
"""By the codes of tol3d.numerics.programme; a set interferes where contacts of a closed loop lack room."""


@dataclass(frozen=True)
class SetTrials(OutputSystem):
    """What a System of a planetary set says of trials.

    Args:
        own: the set.
        acts: what each contributor acts on, by its name.
        planetary_measures: the measures by their names.
    """

    own: PlanetarySet
    acts: Mapping[str, Acts]
    planetary_measures: Mapping[str, PlanetaryMeasure]

    @cached_property
    def overcome(self) -> PlanetarySet:
        """The set under torques that its springs give way to."""
        return replace(self.own, overcome=True)

    def turns_at_random(self, contributor: Contributor, positions: Positions) -> bool:
        """Offsets of gears from their axes do, at random positions; see System."""
        return positions.over == "random" and self.acts[contributor.name].effect == "offset"

    def deviated(self, trials: Trials) -> Deviated:
        """What trials deviate by, by gear and planet."""
        found = Deviated.nothing(self.own, len(trials))
        for name, own in component_slices(self).items():
            found.add(self.own, self.acts[name], trials.deviations[:, own])
        return found

    def gap_bound(self, measure: Measure, errors: Sequence[float]) -> float:
        """What errors of the gaps of each mesh [mm] may make of a measure, in its unit.

        Of a lost motion both ends may be off, of a transmission error the position and the first one; of a region of
        low stiffness both ends twice.
        """
        own = self.planetary_measures[measure.name]
        ends = 4 if own.reading == "low stiffness" else 2
        return ends * play_bound(self.own, own.shaft, errors) * measure.per_internal

    def chord_bound(self, measure: Measure, chord_error: float) -> float:
        """See System: a gap lies between two flanks."""
        return self.gap_bound(measure, [2 * chord_error] * len(self.own.meshes))


class Turning(Protocol):
    """How far a shaft of a set turns, by one road."""

    def free(self, deviated: Deviated, turns: Array, shaft: str, stands: str) -> Free:
        """How far a shaft turns while another one and the held one stand, at turns (trials,) of the output."""
        ...

    def followed(self, deviated: Deviated, turns: Array, shaft: str, stands: str, end: int) -> Followed:
        """The lower (0) or upper (1) end of that at turns (positions,) of the output that all trials share."""
        ...


@dataclass(frozen=True)
class PlanetaryRoad:
    """Implements Road.

    Args:
        system: whose trials these are.
        turning: how far shafts turn.
        overcome: the same under torques that springs give way to.
    """

    system: SetTrials
    turning: Turning
    overcome: Turning

    @property
    def chord_error(self) -> float:
        """See Road."""
        return 0.0

    def answers(self, trials: Trials, measures: Sequence[Measure]) -> Answers:
        """See Road."""
        deviated = self.system.deviated(trials)
        values: dict[str, Array] = {}
        status: dict[str, NDArray[np.int8]] = {}
        details: dict[str, NDArray[np.generic]] = {}
        curves: dict[Hashable, tuple[Array, Followed]] = {}
        for measure in measures:
            own = self.system.planetary_measures[measure.name]
            found: Free | Followed
            if own.is_free_turn:
                turns = own.turns_of(trials.positions[self.system.own.name])
                values[own.name], found = self._lost(own, deviated, turns)
            else:
                if own.curve_key not in curves:
                    curves[own.curve_key] = self._error(own, deviated)
                values[own.name], found = curves[own.curve_key]
            status[own.name] = found.status
            details |= self._details(own, found)
        return Answers(values, details=details, status=status)

    def _lost(self, measure: PlanetaryMeasure, deviated: Deviated, turns: Array) -> tuple[Array, Free]:
        """Free turn (trials, 1), and what it comes from; a set that jams has what it lacks as a negative one.

        Of the region of low stiffness what contacts alone leave, less the lost motion.
        """
        own = self.system.own
        free = self.turning.free(deviated, turns, measure.shaft, own.opposite(measure.shaft))
        jams = -2 * free.lacking / own.arm(measure.shaft)
        lost = np.where(free.status == NO_ROOM, jams, free.ends[:, 1] - free.ends[:, 0])
        lost[free.status == STALLED] = np.nan
        if measure.reading == "lost motion":
            return lost[:, None], free
        beyond = self.overcome.free(deviated, turns, measure.shaft, own.opposite(measure.shaft))
        width = np.where(free.status == NO_ROOM, lost, beyond.ends[:, 1] - beyond.ends[:, 0] - lost)
        status = np.maximum(free.status, beyond.status)
        width[status == STALLED] = np.nan
        return width[:, None], replace(free, status=status)

    def _error(self, measure: PlanetaryMeasure, deviated: Deviated) -> tuple[Array, Followed]:
        """Transmission error (trials, positions), 0 at the first, and what it comes from."""
        own = self.system.own
        turns = np.array(measure.positions.fixed) / (2 * np.pi)
        found = self.turning.followed(deviated, turns, measure.shaft, own.opposite(measure.shaft), measure.end(own))
        error = measure.sense(own) * (found.ends - found.ends[:, :1])
        error[found.status == STALLED] = np.nan
        return error, found

    def _details(self, measure: PlanetaryMeasure, found: Free | Followed) -> Mapping[str, NDArray[np.generic]]:
        """Where a set that jams lacks room, and how much each contact of a closed loop would have to give way."""
        if not found.status.any():
            return {}
        return {f"{measure.name}: overlap [um]": 1e3 * found.lacking}
