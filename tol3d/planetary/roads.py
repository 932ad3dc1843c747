"""From deviations to what is read of a set: the same of both roads, which differ in how far they say shafts turn."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.programme import NO_ROOM, STALLED
from tol3d.planetary.deviated import Deviated
from tol3d.planetary.free import Followed, Free
from tol3d.planetary.measure import PlanetaryMeasure
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
