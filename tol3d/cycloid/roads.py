"""From deviations to what is read of an RV reducer: the same of both roads, which differ in how it turns."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.cycloid.measure import RVMeasure
from tol3d.cycloid.rv_deviated import RVDeviated
from tol3d.cycloid.rv_trials import RVTrials
from tol3d.cycloid.statuses import NO_CONTACT
from tol3d.cycloid.turning import Turned, Turning
from tol3d.system.measure import Measure
from tol3d.system.positions import Positions
from tol3d.system.road import Answers
from tol3d.system.trials import Trials

Array = NDArray[np.float64]
Read = tuple[Positions, int]
Curves = dict[tuple[Read, float | None], Turned]
Details = dict[str, NDArray[np.generic]]


@dataclass(frozen=True)
class RVRoad:
    """Implements Road."""

    system: RVTrials
    turning: Turning

    @property
    def chord_error(self) -> float:
        """See Road."""
        return 0.0

    def answers(self, trials: Trials, measures: Sequence[Measure]) -> Answers:
        """See Road."""
        deviated = self.system.deviated(trials)
        values: dict[str, Array] = {}
        status: dict[str, NDArray[np.int8]] = {}
        details: Details = {}
        known: Curves = {}
        read = [self.system.rv_measures[measure.name] for measure in measures]
        for own in (own for own in read if own.counts):  # what is turned for a count serves others too
            self._turned(own, deviated, trials, own.sense, known)
        for own in read:
            forwards = self._turned(own, deviated, trials, own.sense, known)
            values[own.name] = forwards.turns
            codes = _worst(forwards)
            if forwards.near is not None and own.counts:
                values[own.name] = np.where(np.isnan(forwards.turns), np.nan, forwards.near)
            elif own.reading == "lost motion":
                back = self._turned(own, deviated, trials, -1, known)
                values[own.name] = forwards.turns - back.turns
                codes = np.maximum(codes, _worst(back))
            elif own.positions.over == "turn":
                values[own.name] = forwards.turns - forwards.turns[:, :1]
            lacking = np.asarray(np.isnan(values[own.name]).any(axis=1))
            values[own.name] = np.where(lacking[:, None], np.nan, values[own.name])
            status[own.name] = np.where(lacking, np.maximum(codes, NO_CONTACT), 0).astype(np.int8)
            details |= self._details(own, forwards.places, values[own.name])
        return Answers(values, details=details, status=status)

    def _turned(self, measure: RVMeasure, deviated: RVDeviated, trials: Trials, sense: int, known: Curves) -> Turned:
        """How far the output turns at a measure's positions; measures of the same share it."""
        read = measure.positions, sense
        if not measure.counts and (shared := next((own for (key, _), own in known.items() if key == read), None)):
            return shared
        key = read, measure.deflection
        if key not in known:
            turns = self.system.turns(measure.positions, trials)
            known[key] = self.turning.turned(deviated, turns, sense, measure.deflection)
        return known[key]

    def _details(self, measure: RVMeasure, places: NDArray[np.int64], values: Array) -> Details:
        """Disc and pin that touch, counted from 1; over a turn where the measure is highest and lowest; 0 for none."""
        if measure.positions.over != "turn":
            return self._named(measure.name, "", places[:, 0])
        rows = np.arange(len(values))
        high, low = places[rows, values.argmax(axis=1)], places[rows, values.argmin(axis=1)]
        return self._named(measure.name, " at highest", high) | self._named(measure.name, " at lowest", low)

    def _named(self, measure: str, where: str, places: NDArray[np.int64]) -> Details:
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
