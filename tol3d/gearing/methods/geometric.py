"""The geometric method: builds whose meshes an engine brings to contact and reads."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.cad.solids import FlankStrips
from tol3d.gearing.builds.build import Build
from tol3d.gearing.engines import INTERFERES, NO_CONTACT, OK, OUT_OF_RANGE, Engine, MeshReading, ReadingEngine
from tol3d.gearing.meshing.reversals import to_reversal
from tol3d.gearing.meshing.seats import driver_angles, measure_backlash, moved, read_backlash, seated, turning_gear
from tol3d.gearing.model import Backlash, Measure, Mesh, Model, TransmissionError
from tol3d.gearing.model.measure import gear_measure, gear_measures
from tol3d.gearing.play.linked import Remembered, as_built
from tol3d.gearing.play.play import Play, Read, SeatKey, seat_key, seat_keys, staged_measures
from tol3d.gearing.stack_up import first_order, per_normal_backlash
from tol3d.numerics.arrays import Array
from tol3d.study.system import measure as system_measure
from tol3d.study.system.method import Answers, Codes, joined_answers
from tol3d.study.system.trials import Trials

Details = dict[str, NDArray[np.generic]]

BUILDS_AT_ONCE = 4096  # builds x positions: 2.5 MB of them


@dataclass(frozen=True, eq=False)
class GeometricMethod:
    """The meshes of a model by an engine."""

    model: Model
    engine: Engine

    @property
    def chord_error(self) -> float:
        """See Method."""
        return self.engine.chord_error

    def answers(self, trials: Trials, measures: Sequence[system_measure.Measure]) -> Answers:
        """See Method: with an engine that reads meshes itself, as many builds at once as fit the cache."""
        own = gear_measures(measures)
        if not isinstance(self.engine, ReadingEngine):
            return self._by_gaps(trials, own)
        rows = max(1, BUILDS_AT_ONCE // max(measure.positions.in_a_trial for measure in own))
        pieces = [trials.part(first, first + rows) for first in range(0, len(trials), rows)]
        return joined_answers([self._by_readings(self.engine, piece, own) for piece in pieces])

    def _by_gaps(self, trials: Trials, measures: Sequence[Measure]) -> Answers:
        """By seating every mesh on the engine's gaps."""
        seats = seated(self.model, self.engine, trials, measures)
        contacts: Details = {}
        for mesh in self.model.meshes:
            key = min((key for key in seats.seats if key[0] == mesh.name), key=_side, default=None)
            if key is not None:
                contacts |= _contact_columns(mesh, *seats.seats[key].contact, len(trials))
        known: dict[tuple[Backlash, SeatKey], Array] = {}

        def read(backlash: Backlash, key: SeatKey) -> Array:
            if (backlash, key) not in known:
                values = measure_backlash(backlash, seats.meshings[key], seats.seats[key])
                known[backlash, key] = values.reshape(len(trials), -1)
            return known[backlash, key]

        status = {key: seat.status for key, seat in seats.seats.items()}
        return self._answers(trials, measures, read, contacts, status)

    def _by_readings(self, engine: ReadingEngine, trials: Trials, measures: Sequence[Measure]) -> Answers:
        wanted = self._backlashes_by_key(measures)
        made = engine.build(trials.deviations)
        reverses = any(key[2].reversing for key in wanted)
        builds = (made, engine.reversed_build(trials.deviations) if reverses else made)
        readings: dict[SeatKey, MeshReading] = {}
        for key in filter(partial(_only_rests, wanted), wanted):
            if key not in readings:
                both = engine.rests(made, self.model.mesh(key[0]), key[2], np.array(key[1]))
                sides = (replace(key[2], flank="drive"), replace(key[2], flank="back"))
                readings |= {(*key[:2], side): own for side, own in zip(sides, both, strict=True)}
        for key, backlashes in wanted.items():
            if not _only_rests(wanted, key):
                readings[key] = self._read(engine, builds, trials, key, backlashes)
        contacts: Details = {}
        for key in sorted(wanted, key=_side):
            mesh, own = self.model.mesh(key[0]), readings[key]
            if f"contact:{mesh.name}.tooth" not in contacts:
                contacts |= _contact_columns(mesh, own.contact, own.tooth, len(trials))

        def read(backlash: Backlash, key: SeatKey) -> Array:
            mesh = self.model.mesh(backlash.mesh)
            return read_backlash(backlash, mesh, readings[key]).reshape(len(trials), -1)

        status = {key: reading.status for key, reading in readings.items()}
        return self._answers(trials, measures, read, contacts, status)

    def _read(
        self,
        engine: ReadingEngine,
        builds: tuple[Build, Build],
        trials: Trials,
        key: SeatKey,
        backlashes: Sequence[Backlash],
    ) -> MeshReading:
        """A mesh where some backlashes are read; the second builds have the load on the other flanks."""
        mesh, angles = self.model.mesh(key[0]), driver_angles(key, trials)
        made = builds[0].repeated(angles.shape[1])
        turning = frozenset(gear for backlash in backlashes if (gear := turning_gear(backlash, mesh)))
        if not key[2].reversing:
            return engine.read(made, mesh, key[2], angles.ravel(), turning)
        drive, loaded = engine.read(made, mesh, key[2], angles.ravel()), builds[1].repeated(angles.shape[1])
        return to_reversal(engine, loaded, mesh, key[2], drive, turning)

    def _backlashes_by_key(self, measures: Sequence[Measure]) -> dict[SeatKey, list[Backlash]]:
        """Every way of reading a mesh, with the backlashes that are wanted there."""
        found: dict[SeatKey, list[Backlash]] = {}
        for measure in measures:
            for _, backlash in measure.kind.backlashes:
                found.setdefault(seat_key(self.model, measure, backlash), []).append(backlash)
        return found

    def _answers(
        self,
        trials: Trials,
        measures: Sequence[Measure],
        read: Read,
        contacts: Details,
        seated_as: Mapping[SeatKey, Codes],
    ) -> Answers:
        """Measures of meshes that are read; `seated_as` are the codes of each, (trials x positions,)."""
        values: dict[str, Array] = {}
        terms: dict[tuple[str, str], Array] = {}
        status: dict[str, Codes] = {}
        staged, law = staged_measures(self.model), Remembered(as_built)
        for measure in measures:
            play = Play(self.model, measure, trials, read, law)
            codes = _codes(play, seated_as)
            free = _free_or_overlap(play, codes)
            codes[np.isnan(free) & (codes == OK)] = OUT_OF_RANGE  # a turn whose end is not known
            values[measure.name] = moved(measure.kind, free)
            status[measure.name] = codes.max(axis=1)
            if measure in staged:
                terms |= {(measure.name, link): of_link[:, 0] for link, _, of_link in play.parts()}
        return Answers(values, terms, contacts, status)


def _only_rests(wanted: Mapping[SeatKey, Sequence[Backlash]], key: SeatKey) -> bool:
    """True if a mesh needs only its rest positions, at positions shared by all trials."""
    return key[1] is not None and all(backlash.quantity == "rest_angle" for backlash in wanted[key])


def _side(key: SeatKey) -> bool:
    """Orders ways of reading a mesh: by the drive side before those by the back side."""
    return key[2].flank != "drive"


def _codes(play: Play, seated_as: Mapping[SeatKey, Codes]) -> Codes:
    """Worst status of the meshes that a measure reads, (trials, positions)."""
    shape = (len(play.trials), play.measure.positions.in_a_trial)
    codes = np.zeros(shape, dtype=np.int8)
    for key in seat_keys(play.model, play.measure):
        codes = np.maximum(codes, seated_as[key].reshape(shape))
    if not play.measure.kind.adds_up:
        codes[play.bound() & (codes == OK)] = INTERFERES
    if play.measure.kind.links:
        codes[play.jammed() & (codes == OK)] = INTERFERES
        codes[play.untouched() & (codes == OK)] = NO_CONTACT
    return codes


def _free_or_overlap(play: Play, codes: Codes) -> Array:
    """Play of a measure; a train that is jammed at one stage is not freed by the others' play.

    A jammed mesh has no transmission error.
    """
    free = play.free()
    jammed = codes == INTERFERES
    if isinstance(play.measure.kind, Backlash) or not jammed.any():
        return free
    if isinstance(play.measure.kind, TransmissionError):
        return np.where(jammed, np.nan, free)
    return np.where(jammed, play.overlap(), free)


def _contact_columns(mesh: Mesh, point: Array, tooth: NDArray[np.int64], trials_count: int) -> Details:
    """First contact of a mesh, at the first of its measures' positions."""
    first = slice(None, None, len(point) // trials_count)
    columns: Details = {f"contact:{mesh.name}.{axis} [mm]": point[first, k] for k, axis in enumerate("xyz")}
    columns[f"contact:{mesh.name}.tooth"] = tooth[first] % mesh.pair.pinion.teeth
    return columns


FLANKS_OF_A_BACKLASH: Final = 4  # two that touch, two that are measured
ALLOWANCE: Final = 0.02e-3
"""Error of FCL besides chord errors, in modules: an edge whose normal lies far off the contact's (0.0073 um per
millimetre of module at 0.46 rad, as a tip reaches a flank a fifth of a pitch beyond the path of contact), its own
rounding (0.002 um per millimetre), and squares of tilts within a section's width. 0.05 um at module 2.5."""


@dataclass(frozen=True, eq=False)
class FclMethod(GeometricMethod):
    """The geometric method by FCL, the witness of the exact one, with its error bound. Implements WitnessMethod.

    A strip's chords lie inside the tooth, by the chord error at most: FCL finds up to four chord errors too much
    backlash, as two flanks touch and two are measured.

    Args:
        strips: of every gear, by name.
    """

    strips: Mapping[str, FlankStrips]

    def reads(self, measure: system_measure.Measure) -> bool:
        """See WitnessMethod: every one."""
        return True

    def bounds(self, measure: system_measure.Measure) -> tuple[float, float]:
        """See WitnessMethod: by chords, and by all else."""
        chords = {
            mesh.name: FLANKS_OF_A_BACKLASH * max(self.strips[gear].chord_error for gear in (mesh.driver, mesh.driven))
            for mesh in self.model.meshes
        }
        others = {mesh.name: ALLOWANCE * mesh.pair.pinion.module for mesh in self.model.meshes}
        own = gear_measure(measure)
        return self._of_gaps(own, chords), self._of_gaps(own, others)

    def _of_gaps(self, measure: Measure, normal_backlash: Mapping[str, float]) -> float:
        """Value of a measure for normal backlashes [mm], one per mesh, in its unit.

        A transmission error depends on the two flanks that touch, each with another offset than at the first position.
        """
        free = sum(
            abs(factor) * normal_backlash[backlash.mesh] * per_normal_backlash(self.model, backlash)
            for factor, backlash in measure.kind.backlashes
        )
        if isinstance(measure.kind, TransmissionError):
            return free / 2 * measure.per_internal
        positions = np.full((1, max(1, len(measure.positions.fixed or ()))), free)
        return float(first_order(measure.kind, positions).max()) * measure.per_internal
