"""Measures and trials of a planetary set, and the method that reads them; the methods differ in the turns of shafts."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Final, Protocol

import numpy as np
from typing_extensions import override

from tol3d.gearing.planetary.exact.contact import Contact
from tol3d.gearing.planetary.exact.contact_kernel import seated_ranges
from tol3d.gearing.planetary.first_order.stack_up import StackUp, play_bound
from tol3d.gearing.planetary.model.deviated import Deviated, Free
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.reducers.trials import Read, ReducerMeasure, ReducerMethod, ReducerTrials, Solver
from tol3d.numerics.arrays import Array
from tol3d.numerics.programme import NO_ROOM, STALLED, ranges
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import ANALYTIC_METHOD
from tol3d.study.system.outcome import Statuses
from tol3d.study.system.positions import Positions
from tol3d.study.system.trials import Trials

STATUSES: Final = Statuses(
    texts=("ok", "interferes", "singular"),
    lacking=frozenset(("interferes",)),
    words={"interferes": "jam", "singular": "cannot be solved"},
    states={"interferes": "jammed"},
)
"""Statuses by the codes of tol3d.numerics.programme; a set interferes if contacts of a closed loop lack room."""


SOLVERS: Final[Mapping[str, Solver]] = {
    "exact": Solver(Contact, lambda _: seated_ranges.kept),
    ANALYTIC_METHOD: Solver(StackUp, lambda _: ranges.kept),
}


@dataclass(frozen=True)
class SetTrials(ReducerTrials):
    """Trial part of the System of a planetary set."""

    made_of: ClassVar[type[Deviated]] = Deviated
    solvers: ClassVar[Mapping[str, Solver]] = SOLVERS

    own: PlanetarySet

    @cached_property
    def overcome(self) -> PlanetarySet:
        """The set under torques that its springs give way to."""
        return replace(self.own, overcome=True)

    def turns_at_random(self, contributor: Contributor, positions: Positions) -> bool:
        """Offsets of gears from their axes do, at random positions; see System."""
        return positions.over == "random" and self.acts[contributor.name].effect == "offset"

    @override
    def describe(self, measure: Measure) -> Mapping[str, Any]:
        return {**super().describe(measure), "shaft": self.read[measure.name].shaft}

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
class PlanetaryMethod(ReducerMethod):
    """Implements Method.

    Args:
        overcome: the same under torques that springs give way to.
    """

    system: SetTrials
    turning: Turning
    overcome: Turning

    @override
    def read(self, measure: ReducerMeasure, deviated: Deviated, trials: Trials, known: dict[Hashable, Any]) -> Read:
        if measure.is_free_turn:
            turns = self.system.turns_at(measure, trials)
            values, found = self._lost(measure, deviated, turns)
        else:
            if measure.curve_key not in known:
                known[measure.curve_key] = self._error(measure, deviated)
            values, found = known[measure.curve_key]
        if not found.status.any():
            return Read(values, found.status)
        # how much each contact of a closed loop would have to give way
        return Read(values, found.status, {f"{measure.name}: overlap [um]": 1e3 * found.lacking})

    def _lost(self, measure: ReducerMeasure, deviated: Deviated, turns: Array) -> tuple[Array, Free]:
        """Free turn (trials, 1), and its sources; a set that jams has its shortfall as a negative one.

        For the region of low stiffness: the free turn by contacts alone, less the lost motion.
        """
        own = self.system.own
        free = self.turning.free(deviated, turns, measure.shaft, own.opposite(measure.shaft))
        lost = free.play(own, deviated, measure.shaft)
        lost[free.status == STALLED] = np.nan
        if measure.reading == "lost motion":
            return lost[:, None], free
        beyond = self.overcome.free(deviated, turns, measure.shaft, own.opposite(measure.shaft))
        turns_more = np.diff(beyond.ends)[:, 0] - np.diff(free.ends)[:, 0]  # shafts slide as far in both
        width = np.where(free.status == NO_ROOM, lost, turns_more)
        status = np.maximum(free.status, beyond.status)
        width[status == STALLED] = np.nan
        return width[:, None], replace(free, status=status)

    def _error(self, measure: ReducerMeasure, deviated: Deviated) -> tuple[Array, Free]:
        """Transmission error (trials, positions), 0 at the first, and its sources."""
        own = self.system.own
        turns = np.array(measure.positions.fixed) / (2 * np.pi)
        end = own.end(measure.load)
        found = self.turning.followed(deviated, turns, measure.shaft, own.opposite(measure.shaft), end)
        error = own.sense * (found.ends - found.ends[:, :1])
        error[found.status == STALLED] = np.nan
        return error, found
