"""One block of trials, from draws to columns: what every worker and every replay runs.

Columns are in the user's units (um, mrad, K, deg, arcmin), trial on axis 0; a curve has positions on axis 1.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.build import Build, build
from tol3d.gearing.engines import INTERFERES, OK, OUT_OF_RANGE, STATUS_TEXT, Engine, MeshReading, ReadingEngine
from tol3d.gearing.measures import measure_backlash, moved, read_backlash, turning_gear
from tol3d.gearing.meshing import Meshing, MeshSeat
from tol3d.gearing.model import Backlash, LostMotion, Measure, Mesh, Model, Study
from tol3d.gearing.play import Play, Read, SeatKey, positions_count, seat_key, seat_keys
from tol3d.gearing.stack_up import analytic_backlash, first_order, per_normal_backlash
from tol3d.runs.outcome import status_column
from tol3d.study import draws
from tol3d.units import ARCMIN

Array = NDArray[np.float64]
Columns = Mapping[str, NDArray[Any]]
Status = NDArray[np.int8]

ROWS_AT_ONCE = 65_536  # trials x positions; keeps poses and gaps of a turn's curves in some tens of megabytes
BUILDS_AT_ONCE = 4096  # builds x positions: 2.5 MB of them
BLOCK_TRIALS = 65_536  # trials whose statistics are folded together, and that are written as one file
AUTO_BLOCK_TRIALS = 16_384  # of a study that may stop after any block
AUTO_FCL_BLOCK_TRIALS = 2048  # the same where a trial is slow: a second of them
BLOCK_VALUES = 2**22  # values of a curve, or of all draws, in one block: 32 MB


@dataclass(frozen=True)
class Block:
    """Deviations (trials, components) [internal units] of consecutive trials and where their meshes stand.

    Args:
        deviations: (trials, components), columns as in `model.component_slices`.
        random_angle: for each mesh, the driver's angle [rad] (trials,) of measures at a random position.
    """

    deviations: Array
    random_angle: Mapping[str, Array]

    def __len__(self) -> int:
        return len(self.deviations)

    def part(self, first: int, last: int) -> "Block":
        """Trials first ... last - 1 of the block."""
        angles = {mesh: angle[first:last] for mesh, angle in self.random_angle.items()}
        return Block(self.deviations[first:last], angles)


def drawn_block(model: Model, seed: int, first: int, count: int) -> Block:
    """Trials first ... first + count - 1 as the seed draws them."""
    return Block(draws.deviations(model, seed, first, count), draws.driver_angles(model, seed, first, count))


def stated_block(model: Model, deviations: Array) -> Block:
    """Trials of the deviations (trials, components) that are stated, the first shafts at 0."""
    at_rest = {name: turning.offset for name, turning in model.layout.mesh_turn.items()}
    return Block(deviations, {mesh: np.full(len(deviations), angle) for mesh, angle in at_rest.items()})


def mean_block(model: Model, measure: Measure) -> Block:
    """One trial with every contributor at its mean over the positions of a measure, the first shafts at 0."""
    return stated_block(model, draws.mean_deviations(model, measure.positions))


def nominal_block(model: Model) -> Block:
    """One trial without deviations, the first shafts at 0."""
    return stated_block(model, np.zeros((1, model.component_count)))


def driver_angles(key: SeatKey, block: Block) -> Array:
    """Driver angles [rad] at which a mesh is read, (trials, positions)."""
    mesh, angles, _ = key
    if angles is None:
        return block.random_angle[mesh][:, None]
    return np.broadcast_to(np.array(angles), (len(block), len(angles)))


@dataclass(frozen=True)
class Seats:
    """Builds of a block and its seated meshes, kept by the positions at which measures read them.

    Args:
        block: the trials.
        build: one row a trial.
        seats: by mesh name, positions and reading; rows are trials x positions, positions fastest.
        meshings: the builds that were seated there.
    """

    block: Block
    build: Build
    seats: Mapping[SeatKey, MeshSeat] = field(default_factory=dict)
    meshings: Mapping[SeatKey, Meshing] = field(default_factory=dict)


def seat_block(model: Model, engine: Engine, block: Block) -> Seats:
    """Build the trials and seat every mesh at every set of positions that some measure wants."""
    made = build(model, block.deviations)
    seats: dict[SeatKey, MeshSeat] = {}
    meshings: dict[SeatKey, Meshing] = {}
    for key in _all_keys(model):
        angles = driver_angles(key, block)
        meshings[key] = Meshing(engine, model, model.mesh(key[0]), made.repeated(angles.shape[1]), key[2])
        seats[key] = meshings[key].seat(angles.ravel())
    return Seats(block, made, seats, meshings)


def _all_keys(model: Model) -> tuple[SeatKey, ...]:
    return tuple(dict.fromkeys(key for measure in model.measures for key in seat_keys(model, measure)))


def geometric_values(model: Model, measure: Measure, seats: Seats) -> Array:
    """Values of a measure on the geometric road [mm or rad], (trials, positions)."""
    return moved(measure.kind, play_of(model, measure, seats).free())


def play_of(model: Model, measure: Measure, seats: Seats) -> Play:
    """The backlashes of a measure on the geometric road."""

    def read(backlash: Backlash, key: SeatKey) -> Array:
        values = measure_backlash(backlash, seats.meshings[key], seats.seats[key])
        return values.reshape(len(seats.block), -1)

    return Play(model, measure, seats.block.deviations, read)


def analytic_play(model: Model, measure: Measure, block: Block) -> Play:
    """The backlashes of a measure on the analytic road."""
    return Play(model, measure, block.deviations, _Stacks(model, block))


def analytic_values(model: Model, measure: Measure, block: Block) -> Array:
    """Values of a measure on the analytic road [mm or rad], (trials, positions)."""
    return first_order(measure.kind, analytic_play(model, measure, block).free())


def analytic_backlashes(model: Model, measure: Measure, block: Block) -> Iterator[tuple[Backlash, Array]]:
    """The backlashes that a measure adds up, each with its values on the analytic road [mm or rad]."""
    stacks = _Stacks(model, block)
    for _, backlash in measure.kind.backlashes:
        yield backlash, stacks(backlash, seat_key(model, measure, backlash))


class _Stacks:
    """Reads backlashes on the analytic road; those that are read alike share one stack-up."""

    def __init__(self, model: Model, block: Block) -> None:
        self._model, self._block = model, block
        self._known: dict[SeatKey, Array] = {}

    def __call__(self, backlash: Backlash, key: SeatKey) -> Array:
        """See Read."""
        angles = driver_angles(key, self._block)
        if key not in self._known:
            self._known[key] = self._asked(replace(backlash, quantity="normal_backlash"), angles)
        if backlash.quantity != "rest_angle":
            return self._known[key] * per_normal_backlash(self._model, backlash)
        play = self._known[key] * per_normal_backlash(self._model, backlash)
        return self._asked(backlash, angles) - self._model.mesh(backlash.mesh).working_flank * play / 2

    def _asked(self, backlash: Backlash, angles: Array) -> Array:
        rows, positions = self._block.deviations, angles.shape[1]
        repeated = rows if positions == 1 else np.repeat(rows, positions, axis=0)
        return analytic_backlash(self._model, backlash, repeated, angles.ravel()).reshape(angles.shape)


def block_trials(model: Model) -> int:
    """Trials of a canonical block: fewer where curves keep many positions of each trial, or a trial has many draws."""
    kept = max((positions_count(measure) for measure in model.measures if measure.take == "curve"), default=1)
    values = max(kept, model.component_count, 1)
    return max(min(_most_block_trials(model.study), 1 << int(math.log2(BLOCK_VALUES / values))), 1)


def _most_block_trials(study: Study) -> int:
    if not study.until:
        return BLOCK_TRIALS
    return AUTO_FCL_BLOCK_TRIALS if study.engine == "fcl" else AUTO_BLOCK_TRIALS


def positions_in_all(model: Model) -> int:
    """How many contacts one trial takes: positions of every different way of reading a mesh."""
    return sum(1 if key[1] is None else len(key[1]) for key in _all_keys(model))


def taken(measure: Measure, values: Array) -> Array:
    """What a measure takes of its values (trials, positions): (trials,), or all of them for a curve.

    Extremes are those of a parabola through the extreme sample and its neighbours, on a closed period those
    round its end too: 1.1e-4 of the once-per-turn part at 24 positions a turn, where the sample is 9e-3 off.
    """
    if measure.take == "curve":
        return values
    if measure.take == "value":
        return values[:, 0]
    closed = measure.positions.closed
    highest = _parabola_peak(values, closed=closed)
    lowest = -_parabola_peak(-values, closed=closed)
    return {"max": highest, "min": lowest, "range": highest - lowest}[measure.take]


def _parabola_peak(values: Array, *, closed: bool) -> Array:
    """Highest point of the parabola through the highest sample and its neighbours, within those three.

    At an end of an open span the parabola is the one through the three samples there.
    """
    count = values.shape[1]
    if count < 3:
        return np.asarray(values.max(axis=1))
    rows = np.arange(len(values))
    peak = np.argmax(values, axis=1)
    centre = peak if closed else np.clip(peak, 1, count - 2)
    at = values[rows, centre]
    before, after = values[rows, centre - 1], values[rows, (centre + 1) % count]
    bend, slope = 2 * at - before - after, (after - before) / 2
    offset = np.clip(slope / np.where(bend > 0.0, bend, 1.0), -1.0, 1.0)
    between = at + offset * slope - offset**2 * bend / 2
    return np.asarray(np.where(bend > 0.0, between, values[rows, peak]))


def simulate_block(model: Model, engine: Engine | None, block: Block) -> dict[str, NDArray[Any]]:
    """All columns of a block; without an engine only the analytic ones.

    Returns:
        deviations, `position:<mesh> [deg]`, `analytic:<measure>`, and with an engine
        `geometric:<measure>`, `status:<measure>`, `contact:<mesh>.x|y|z [mm]`, `contact:<mesh>.tooth` and `status`,
        the worst of them all; for each train also its stages, `analytic:<measure>:<link> [arcmin]`, and with an
        engine `geometric:...`. A geometric value below 0 whose status is "interferes" is an overlap.
    """
    rows = max(1, ROWS_AT_ONCE // max(positions_count(measure) for measure in model.measures))
    pieces = [_simulate_piece(model, engine, block.part(first, first + rows)) for first in range(0, len(block), rows)]
    if len(pieces) == 1:
        return pieces[0]
    return {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}


def _simulate_piece(model: Model, engine: Engine | None, block: Block) -> dict[str, NDArray[np.generic]]:
    columns: dict[str, NDArray[np.generic]] = {}
    for contributor in model.contributors:
        own = block.deviations[:, model.component_slices[contributor.name]]
        for k, name in enumerate(contributor.columns):
            columns[name] = own[:, k] / contributor.per_unit
    for mesh in model.meshes:
        columns[position_column(mesh)] = np.degrees(block.random_angle[mesh.name])
    stacks = _Stacks(model, block)
    for measure in model.measures:
        values = first_order(measure.kind, Play(model, measure, block.deviations, stacks).free())
        columns[f"analytic:{measure.name}"] = taken(measure, values) * measure.per_internal
    for measure in staged_measures(model):
        columns.update(_stage_columns("analytic", Play(model, measure, block.deviations, stacks)))
    if engine is None:
        return columns
    seen = (
        _read_in_pieces(model, engine, block) if isinstance(engine, ReadingEngine) else _measured(model, engine, block)
    )
    for measure in model.measures:
        columns[f"geometric:{measure.name}"] = taken(measure, seen.values[measure.name]) * measure.per_internal
    columns.update(seen.others)
    return columns | _status_columns(seen.status)


def staged_measures(model: Model) -> tuple[Measure, ...]:
    """The measure of each train whose stages are kept: its first of one value at random positions."""
    found: dict[str, Measure] = {}
    for measure in model.measures:
        if isinstance(measure.kind, LostMotion) and measure.positions.over == "random":
            found.setdefault(measure.kind.train, measure)
    return tuple(found.values())


def stage_column(road: str, measure: Measure, link: str) -> str:
    """Name of the column with a stage's own lost motion, at the shaft that it drives."""
    return f"{road}:{measure.name}:{link} [arcmin]"


def _stage_columns(road: str, play: Play) -> dict[str, Array]:
    """What the stages of a measure leave free, by column [arcmin]."""
    return {stage_column(road, play.measure, link): values[:, 0] * ARCMIN for link, _, values in play.parts()}


_STATUS_TEXTS = np.array([STATUS_TEXT[code] for code in range(len(STATUS_TEXT))])


def _status_columns(by_measure: Mapping[str, Status]) -> dict[str, NDArray[np.generic]]:
    """Texts of the codes (trials,) of each measure, and the worst of all; where that is OK they share one array."""
    worst = np.max([*by_measure.values()], axis=0)
    text = _STATUS_TEXTS[worst]
    all_ok = not worst.any()
    own = {status_column(name): text if all_ok else _STATUS_TEXTS[codes] for name, codes in by_measure.items()}
    return {**own, "status": text}


@dataclass(frozen=True)
class _Seen:
    """The geometric road of a block: values by measure (trials, positions), other columns, status by measure."""

    values: Mapping[str, Array]
    others: Mapping[str, NDArray[np.generic]]
    status: Mapping[str, Status]


def _seen(
    model: Model,
    block: Block,
    read: Read,
    contacts: dict[str, NDArray[np.generic]],
    seated: Mapping[SeatKey, Status],
) -> _Seen:
    """Measures of meshes that are read; `seated` tells the status of each, (trials x positions,), positions fastest."""
    values: dict[str, Array] = {}
    stages: dict[str, Array] = {}
    status: dict[str, Status] = {}
    staged = staged_measures(model)
    for measure in model.measures:
        play = Play(model, measure, block.deviations, read)
        codes = _codes(play, seated)
        free = _free_or_overlap(play, codes)
        codes[np.isnan(free) & (codes == OK)] = OUT_OF_RANGE  # a turn whose end cannot be told
        values[measure.name] = moved(measure.kind, free)
        status[measure.name] = codes.max(axis=1)
        if measure in staged:
            stages |= _stage_columns("geometric", play)
    return _Seen(values, contacts | stages, status)


def _codes(play: Play, seated: Mapping[SeatKey, Status]) -> Status:
    """What became of the meshes that a measure reads, the worst of them, (trials, positions)."""
    shape = (len(play.deviations), positions_count(play.measure))
    codes = np.zeros(shape, dtype=np.int8)
    for key in seat_keys(play.model, play.measure):
        codes = np.maximum(codes, seated[key].reshape(shape))
    if not play.measure.kind.adds_up:
        codes[play.bound() & (codes == OK)] = INTERFERES
    return codes


def _free_or_overlap(play: Play, codes: Status) -> Array:
    """What a measure's backlashes leave free; a train that is jammed at one stage is not free by the others' play."""
    free = play.free()
    jammed = codes == INTERFERES
    if isinstance(play.measure.kind, Backlash) or not jammed.any():
        return free
    return np.where(jammed, play.overlap(), free)


def _measured(model: Model, engine: Engine, block: Block) -> _Seen:
    """By seating every mesh on the gaps that an engine tells."""
    seats = seat_block(model, engine, block)
    contacts: dict[str, NDArray[np.generic]] = {}
    for mesh in model.meshes:
        seat = next((seat for key, seat in seats.seats.items() if key[0] == mesh.name), None)
        if seat is not None:
            contacts |= _contact_columns(mesh, *seat.contact, len(block))
    known: dict[tuple[Backlash, SeatKey], Array] = {}

    def read(backlash: Backlash, key: SeatKey) -> Array:
        if (backlash, key) not in known:
            values = measure_backlash(backlash, seats.meshings[key], seats.seats[key])
            known[backlash, key] = values.reshape(len(block), -1)
        return known[backlash, key]

    return _seen(model, block, read, contacts, {key: seat.status for key, seat in seats.seats.items()})


def _read_in_pieces(model: Model, engine: ReadingEngine, block: Block) -> _Seen:
    """By an engine that builds, seats and reads meshes itself, so many at once that builds stay in the cache."""
    rows = max(1, BUILDS_AT_ONCE // max(positions_count(measure) for measure in model.measures))
    each = [_read(model, engine, block.part(first, first + rows)) for first in range(0, len(block), rows)]
    if len(each) == 1:
        return each[0]
    return _Seen(
        {name: np.concatenate([seen.values[name] for seen in each]) for name in each[0].values},
        {name: np.concatenate([seen.others[name] for seen in each]) for name in each[0].others},
        {name: np.concatenate([seen.status[name] for seen in each]) for name in each[0].status},
    )


def _read(model: Model, engine: ReadingEngine, block: Block) -> _Seen:
    made = engine.build(block.deviations)
    readings: dict[SeatKey, MeshReading] = {}
    contacts: dict[str, NDArray[np.generic]] = {}
    for key, backlashes in _backlashes_by_key(model).items():
        mesh = model.mesh(key[0])
        angles = driver_angles(key, block)
        turning = frozenset(gear for backlash in backlashes if (gear := turning_gear(backlash, mesh)))
        readings[key] = engine.read(made.repeated(angles.shape[1]), mesh, key[2], angles.ravel(), turning)
        if f"contact:{mesh.name}.tooth" not in contacts:
            contacts |= _contact_columns(mesh, readings[key].contact, readings[key].tooth, len(block))

    def read(backlash: Backlash, key: SeatKey) -> Array:
        return read_backlash(backlash, model.mesh(backlash.mesh), readings[key]).reshape(len(block), -1)

    return _seen(model, block, read, contacts, {key: reading.status for key, reading in readings.items()})


def _backlashes_by_key(model: Model) -> dict[SeatKey, list[Backlash]]:
    """Every way of reading a mesh, with the backlashes that are wanted there."""
    found: dict[SeatKey, list[Backlash]] = {}
    for measure in model.measures:
        for _, backlash in measure.kind.backlashes:
            found.setdefault(seat_key(model, measure, backlash), []).append(backlash)
    return found


def position_column(mesh: Mesh) -> str:
    """Name of the column with a mesh's random driver position."""
    return f"position:{mesh.name} [deg]"


def _contact_columns(
    mesh: Mesh, point: Array, tooth: NDArray[np.int64], trials_count: int
) -> dict[str, NDArray[np.generic]]:
    """First contact of a mesh, at the first of its measures' positions."""
    first = slice(None, None, len(point) // trials_count)
    columns: dict[str, NDArray[np.generic]] = {
        f"contact:{mesh.name}.{axis} [mm]": point[first, k] for k, axis in enumerate("xyz")
    }
    columns[f"contact:{mesh.name}.tooth"] = tooth[first] % mesh.pair.pinion.teeth
    return columns
