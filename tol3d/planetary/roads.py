"""From deviations to what is read of a set: the same of both roads, which differ in how far they say shafts turn."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from tol3d.planetary.deviated import Deviated
from tol3d.planetary.free import Free
from tol3d.planetary.measure import PlanetaryMeasure
from tol3d.planetary.programme import NO_ROOM, STALLED
from tol3d.planetary.set_trials import SetTrials
from tol3d.system.measure import Measure
from tol3d.system.road import Answers
from tol3d.system.trials import Trials

Array = NDArray[np.float64]


class Turning(Protocol):
    """How far a shaft of a set turns, by one road."""

    def free(self, deviated: Deviated, turns: Array, shaft: str, stands: str) -> Free:
        """How far a shaft turns while another one and the held one stand, at turns (trials,) of the output."""
        ...


@dataclass(frozen=True)
class PlanetaryRoad:
    """Implements Road."""

    system: SetTrials
    turning: Turning

    chord_error: ClassVar[float] = 0.0

    def answers(self, trials: Trials, measures: Sequence[Measure]) -> Answers:
        """See Road."""
        deviated = self.system.deviated(trials)
        values: dict[str, Array] = {}
        status: dict[str, NDArray[np.int8]] = {}
        details: dict[str, NDArray[np.generic]] = {}
        for measure in measures:
            own = self.system.planetary_measures[measure.name]
            read = [self._at(own, deviated, turns) for turns in self._turns(own, trials)]
            values[own.name] = np.stack([value for value, _ in read], axis=1)
            if own.reading != "lost motion":
                values[own.name] -= values[own.name][:, :1].copy()
            status[own.name] = np.max([free.status for _, free in read], axis=0).astype(np.int8)
            values[own.name][status[own.name] == STALLED] = np.nan
            details |= self._details(own, [free for _, free in read])
        return Answers(values, details=details, status=status)

    def _turns(self, measure: PlanetaryMeasure, trials: Trials) -> list[Array]:
        """Turns of the output (trials,) at each position."""
        fixed = measure.positions.fixed
        if fixed is None:
            return [trials.positions[self.system.own.name]]
        return [np.full(len(trials), angle / (2 * np.pi)) for angle in fixed]

    def _at(self, measure: PlanetaryMeasure, deviated: Deviated, turns: Array) -> tuple[Array, Free]:
        """Values, and what they come from; a set that jams has what it lacks as a negative lost motion."""
        own = self.system.own
        free = self.turning.free(deviated, turns, measure.shaft, own.opposite(measure.shaft))
        jams = free.status == NO_ROOM
        if measure.reading == "lost motion":
            return np.where(jams, -2 * free.lacking / own.arm(measure.shaft), free.ends[:, 1] - free.ends[:, 0]), free
        sense = 1.0 if own.ratio > 0 else -1.0  # the output turns so while the input turns counter-clockwise
        behind = (measure.reading == "lag") == (sense > 0.0)
        return np.where(jams, 0.0, sense * free.ends[:, 0 if behind else 1]), free

    def _details(self, measure: PlanetaryMeasure, read: Sequence[Free]) -> Mapping[str, NDArray[np.generic]]:
        """Where a set that jams lacks room, and how much each contact of a closed loop would have to give way."""
        if not any(free.status.any() for free in read):
            return {}
        return {f"{measure.name}: overlap [um]": 1e3 * np.max([free.lacking for free in read], axis=0)}
