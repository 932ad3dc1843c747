"""Measures and trials of an RV reducer, and the method that reads them; the methods differ in the turns of it."""

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from tol3d.gearing.cycloid.reducer.deviated import RVDeviated
from tol3d.gearing.cycloid.reducer.rv_set import RVSet
from tol3d.gearing.cycloid.reducer.turning import Turned, Turning
from tol3d.gearing.reducers.trials import Read, ReducerMeasure, ReducerMethod, ReducerTrials
from tol3d.numerics.arrays import Array, Places
from tol3d.study.system.measure import Measure
from tol3d.study.system.outcome import Statuses
from tol3d.study.system.trials import Trials

NO_CONTACT: Final = 1
NO_FIT: Final = 2
NO_REST: Final = 3
STATUSES: Final = Statuses(
    texts=("ok", "no contact", "cranks do not fit", "no rest found"),
    words={
        "no contact": "have no pin that touches",
        "cranks do not fit": "have cranks that do not fit into discs and carrier",
        "no rest found": "do not come to rest",
    },
)
"""Builds whose pins press on both sides keep a value, a lost motion below 0: the discs give way."""


@dataclass(frozen=True)
class RVTrials(ReducerTrials):
    """Trial part of the System of an RV reducer."""

    made_of: ClassVar[type[RVDeviated]] = RVDeviated

    own: RVSet

    def gap_bound(self, measure: Measure, errors: float) -> float:
        """Bound on the effect of errors of all gaps [mm] on a measure, in its unit.

        A working pin has a lever of the window's share at least. Of a lost motion both ends may be off, of a curve the
        position and the first one.
        """
        own = self.read[measure.name]
        lever = self.own.window * self.own.profile.pitch_radius * (1 + self.own.rolling / self.own.profile.lobes)
        both = own.reading == "lost motion" or own.positions.over == "turn"
        return (2 if both else 1) * errors / lever * measure.per_internal

    @override
    def chord_bound(self, measure: Measure, chord_error: float) -> float:
        return self.gap_bound(measure, chord_error)


@dataclass(frozen=True)
class RVMethod(ReducerMethod):
    """Implements Method."""

    system: RVTrials
    turning: Turning

    @override
    def read(self, measure: ReducerMeasure, deviated: RVDeviated, trials: Trials, known: dict[Hashable, Any]) -> Read:
        forwards = self._turned(measure, deviated, trials, measure.load, known)
        values, codes = forwards.turns, _worst(forwards)
        if forwards.near is not None and measure.counts:
            values = np.where(np.isnan(forwards.turns), np.nan, forwards.near)
        elif measure.is_free_turn:
            back = self._turned(measure, deviated, trials, -1, known)
            values = forwards.turns - back.turns
            codes = np.maximum(codes, _worst(back))
        elif measure.positions.over == "turn":
            values = forwards.turns - forwards.turns[:, :1]
        lacking = np.asarray(np.isnan(values).any(axis=1))
        values = np.where(lacking[:, None], np.nan, values)
        status = np.where(lacking, np.maximum(codes, NO_CONTACT), 0).astype(np.int8)
        return Read(values, status, self._details(measure, forwards.places, values))

    def _turned(
        self, measure: ReducerMeasure, deviated: RVDeviated, trials: Trials, sense: int, known: dict[Hashable, Any]
    ) -> Turned:
        """Turn of the output at a measure's positions; measures with the same positions share it."""
        read = measure.positions, sense
        key = *read, measure.deflection
        if key not in known:
            turns = self.system.turns(measure.positions, trials)
            known[key] = self.turning.turned(deviated, turns, sense, measure.deflection)
            known.setdefault((*read, None), known[key])  # what is turned for a count serves others too
        found: Turned = known[key]
        return found

    def _details(self, measure: ReducerMeasure, places: Places, values: Array) -> dict[str, NDArray[np.generic]]:
        """Disc and pin that touch, counted from 1; over a turn where the measure is highest and lowest; 0 for none."""
        if measure.positions.over != "turn":
            return self._named(measure.name, "", places[:, 0])
        rows = np.arange(len(values))
        high, low = places[rows, values.argmax(axis=1)], places[rows, values.argmin(axis=1)]
        return self._named(measure.name, " at highest", high) | self._named(measure.name, " at lowest", low)

    def _named(self, measure: str, where: str, places: Places) -> dict[str, NDArray[np.generic]]:
        disc, pin = np.divmod(places, self.system.own.profile.pins)
        none = places < 0
        return {
            f"{measure}: disc{where}": np.where(none, 0, disc + 1),
            f"{measure}: pin{where}": np.where(none, 0, pin + 1),
        }


def _worst(found: Turned) -> NDArray[np.int8]:
    """Codes (trials,) of the worst positions."""
    if found.codes is None:
        return np.zeros(len(found.turns), dtype=np.int8)
    return np.asarray(found.codes.max(axis=1))
