"""Measures and trials of a planetary set, and the method that reads them; the methods differ in the turns of shafts."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.numerics.programme import NO_ROOM, STALLED
from tol3d.planetary.first_order.levers import play_bound
from tol3d.planetary.model.deviated import Acts, Deviated, Free
from tol3d.planetary.model.planetary_set import PlanetarySet
from tol3d.system.contributor import Contributor
from tol3d.system.measure import Measure
from tol3d.system.method import Answers
from tol3d.system.output_system import OutputSystem
from tol3d.system.plain import PlainMeasure
from tol3d.system.positions import Positions
from tol3d.system.stated import component_slices
from tol3d.system.statuses import Statuses
from tol3d.system.trials import Trials

Reading = Literal["lost motion", "low stiffness", "lag", "lead"]


@dataclass(frozen=True, kw_only=True)
class PlanetaryMeasure(PlainMeasure):
    """A measure of one set.

    Args:
        reading: the whole free turn of a shaft, its turn against springs alone, or the output's rest position while
            its load resists (lag) or drives it.
        shaft: that turns.
    """

    reading: Reading
    shaft: str

    @property
    def is_free_turn(self) -> bool:
        """True if it is a free turn of a shaft at one position, or a part of it."""
        return self.reading in ("lost motion", "low stiffness")

    @property
    def curve_key(self) -> Hashable:
        """Measures of one key are read from the same curve."""
        return self.reading, self.shaft, self.positions

    def sense(self, own: PlanetarySet) -> float:
        """1 where the output turns counter-clockwise while the input does, else -1."""
        return 1.0 if own.ratio > 0 else -1.0

    def end(self, own: PlanetarySet) -> int:
        """End of its free turn at which the output rests: the lower (0) or the upper one (1)."""
        return 0 if (self.reading == "lag") == (self.sense(own) > 0.0) else 1


STATUSES: Final = Statuses(
    texts=("ok", "interferes", "singular"),
    lacking=frozenset(("interferes",)),
    words={"interferes": "jam", "singular": "cannot be solved"},
    states={"interferes": "jammed"},
)
"""Statuses by the codes of tol3d.numerics.programme; a set interferes if contacts of a closed loop lack room."""


@dataclass(frozen=True)
class SetTrials(OutputSystem):
    """Trial part of the System of a planetary set.

    Args:
        acts: effect of each contributor, by its name.
    """

    own: PlanetarySet
    acts: Mapping[str, Acts]

    @cached_property
    def overcome(self) -> PlanetarySet:
        """The set under torques that its springs give way to."""
        return replace(self.own, overcome=True)

    def turns_at_random(self, contributor: Contributor, positions: Positions) -> bool:
        """Offsets of gears from their axes do, at random positions; see System."""
        return positions.over == "random" and self.acts[contributor.name].effect == "offset"

    def deviated(self, trials: Trials) -> Deviated:
        """Deviations of trials, by gear and planet."""
        found = Deviated.nothing(self.own, len(trials))
        for name, own in component_slices(self).items():
            found.add(self.own, self.acts[name], trials.deviations[:, own])
        return found

    def gap_bound(self, measure: Measure, errors: Sequence[float]) -> float:
        """Bound on the effect of errors of the gaps of each mesh [mm] on a measure, in its unit.

        Of a lost motion both ends may be off, of a transmission error the position and the first one; of a region of
        low stiffness both ends twice.
        """
        own = self.read[measure.name]
        ends = 4 if own.reading == "low stiffness" else 2
        return ends * play_bound(self.own, own.shaft, errors) * measure.per_internal

    def chord_bound(self, measure: Measure, chord_error: float) -> float:
        """See System: a gap lies between two flanks."""
        return self.gap_bound(measure, [2 * chord_error] * len(self.own.meshes))


class Turning(Protocol):
    """Turn of a shaft of a set, by one method."""

    def free(self, deviated: Deviated, turns: Array, shaft: str, stands: str) -> Free:
        """Free turn of a shaft while another one and the held one stand, at turns (trials,) of the output."""
        ...

    def followed(self, deviated: Deviated, turns: Array, shaft: str, stands: str, end: int) -> Free:
        """The lower (0) or upper (1) end of that at turns (positions,) of the output that all trials share."""
        ...


@dataclass(frozen=True)
class PlanetaryMethod:
    """Implements Method.

    Args:
        overcome: the same under torques that springs give way to.
    """

    system: SetTrials
    turning: Turning
    overcome: Turning

    @property
    def chord_error(self) -> float:
        """See Method."""
        return 0.0

    def answers(self, trials: Trials, measures: Sequence[Measure]) -> Answers:
        """See Method."""
        deviated = self.system.deviated(trials)
        values: dict[str, Array] = {}
        status: dict[str, NDArray[np.int8]] = {}
        details: dict[str, NDArray[np.generic]] = {}
        curves: dict[Hashable, tuple[Array, Free]] = {}
        for measure in measures:
            own: PlanetaryMeasure = self.system.read[measure.name]
            if own.is_free_turn:
                turns = np.broadcast_to(self.system.turns(own.positions, trials), (len(trials), 1))[:, 0]
                values[own.name], found = self._lost(own, deviated, turns)
            else:
                if own.curve_key not in curves:
                    curves[own.curve_key] = self._error(own, deviated)
                values[own.name], found = curves[own.curve_key]
            status[own.name] = found.status
            if found.status.any():  # how much each contact of a closed loop would have to give way
                details[f"{own.name}: overlap [um]"] = 1e3 * found.lacking
        return Answers(values, details=details, status=status)

    def _lost(self, measure: PlanetaryMeasure, deviated: Deviated, turns: Array) -> tuple[Array, Free]:
        """Free turn (trials, 1), and its sources; a set that jams has its shortfall as a negative one.

        For the region of low stiffness: the free turn by contacts alone, less the lost motion.
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

    def _error(self, measure: PlanetaryMeasure, deviated: Deviated) -> tuple[Array, Free]:
        """Transmission error (trials, positions), 0 at the first, and its sources."""
        own = self.system.own
        turns = np.array(measure.positions.fixed) / (2 * np.pi)
        found = self.turning.followed(deviated, turns, measure.shaft, own.opposite(measure.shaft), measure.end(own))
        error = measure.sense(own) * (found.ends - found.ends[:, :1])
        error[found.status == STALLED] = np.nan
        return error, found
