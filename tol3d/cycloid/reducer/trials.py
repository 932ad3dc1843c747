"""Measures and trials of an RV reducer, and the method that reads them; the methods differ in the turns of it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.cycloid.reducer.deviated import Acts, RVDeviated
from tol3d.cycloid.reducer.rv_set import RVSet
from tol3d.cycloid.reducer.turning import Turned, Turning
from tol3d.numerics.arrays import Array, Places
from tol3d.system.measure import Measure
from tol3d.system.method import Answers
from tol3d.system.output_system import OutputSystem
from tol3d.system.plain import PlainMeasure
from tol3d.system.positions import Positions
from tol3d.system.stated import component_slices
from tol3d.system.statuses import Statuses
from tol3d.system.system import Columns
from tol3d.system.trials import Trials

Reading = Literal["lost motion", "drive", "back"]


@dataclass(frozen=True, kw_only=True)
class RVMeasure(PlainMeasure):
    """A measure of one reducer.

    Args:
        reading: the whole free turn of the output, or where it rests while its load resists or drives it on.
        deflection: pins within it of contact are counted then [mm]; None where the turn itself is read.
    """

    reading: Reading
    deflection: float | None = None

    @property
    def counts(self) -> bool:
        """True if pins near contact are counted."""
        return self.deflection is not None

    @property
    def sense(self) -> int:
        """Sense in which a load turns the output: back (-1) where it resists."""
        return -1 if self.reading == "drive" else 1


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
class RVTrials(OutputSystem):
    """Trial part of the System of an RV reducer.

    Args:
        acts: effect of each contributor, by its name.
    """

    own: RVSet
    acts: Mapping[str, Acts]

    def deviated(self, trials: Trials) -> RVDeviated:
        """Deviations of the parts in trials."""
        found = RVDeviated.nothing(self.own, len(trials))
        for name, own in component_slices(self).items():
            found.add(self.acts[name], trials.deviations[:, own])
        return found

    def gap_bound(self, measure: Measure, error: float) -> float:
        """Bound on the effect of errors of all gaps [mm] on a measure, in its unit.

        A working pin has a lever of the window's share at least. Of a lost motion both ends may be off, of a curve the
        position and the first one.
        """
        own = self.read[measure.name]
        lever = self.own.window * self.own.profile.pitch_radius * (1 + self.own.rolling / self.own.profile.lobes)
        both = own.reading == "lost motion" or own.positions.over == "turn"
        return (2 if both else 1) * error / lever * measure.per_internal

    def chord_bound(self, measure: Measure, chord_error: float) -> float:
        """See System."""
        return self.gap_bound(measure, chord_error)

    def deviated_again(self, columns: Columns) -> RVDeviated:
        """The same from columns of results."""
        read = [columns[name] * own.per_unit for own in self.contributors for name in own.columns]
        count = len(np.asarray(columns[self.position_column]))
        return self.deviated(Trials(np.array(read).reshape(-1, count).T, {}))


Read = tuple[Positions, int]
Curves = dict[tuple[Read, float | None], Turned]
Details = dict[str, NDArray[np.generic]]


@dataclass(frozen=True)
class RVMethod:
    """Implements Method."""

    system: RVTrials
    turning: Turning

    @property
    def chord_error(self) -> float:
        """See Method."""
        return 0.0

    def answers(self, trials: Trials, measures: Sequence[Measure]) -> Answers:
        """See Method."""
        deviated = self.system.deviated(trials)
        values: dict[str, Array] = {}
        status: dict[str, NDArray[np.int8]] = {}
        details: Details = {}
        known: Curves = {}
        read: list[RVMeasure] = [self.system.read[measure.name] for measure in measures]
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
        """Turn of the output at a measure's positions; measures with the same positions share it."""
        read = measure.positions, sense
        if not measure.counts and (shared := next((own for (key, _), own in known.items() if key == read), None)):
            return shared
        key = read, measure.deflection
        if key not in known:
            turns = self.system.turns(measure.positions, trials)
            known[key] = self.turning.turned(deviated, turns, sense, measure.deflection)
        return known[key]

    def _details(self, measure: RVMeasure, places: Places, values: Array) -> Details:
        """Disc and pin that touch, counted from 1; over a turn where the measure is highest and lowest; 0 for none."""
        if measure.positions.over != "turn":
            return self._named(measure.name, "", places[:, 0])
        rows = np.arange(len(values))
        high, low = places[rows, values.argmax(axis=1)], places[rows, values.argmin(axis=1)]
        return self._named(measure.name, " at highest", high) | self._named(measure.name, " at lowest", low)

    def _named(self, measure: str, where: str, places: Places) -> Details:
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
