"""One block of trials, from draws to columns: what every worker and every replay runs.

Columns are in the user's units (um, mrad, K, deg, arcmin), trial on axis 0; a curve has positions on axis 1.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from tol3d import trials
from tol3d.analytic import analytic_backlash, per_normal_backlash
from tol3d.build import Build, build
from tol3d.engines import OK, STATUS_TEXT, Engine, MeshReading, ReadingEngine
from tol3d.measures import measure_backlash, read_backlash, turning_gear
from tol3d.model import Measure, Mesh, Model, Positions, Reading, Study
from tol3d.moves import Meshing, MeshSeat

Array = NDArray[np.float64]
Columns = Mapping[str, NDArray[np.generic]]

ROWS_AT_ONCE = 65_536  # trials x positions; keeps poses and gaps of a turn's curves in some tens of megabytes
BUILDS_AT_ONCE = 4096  # builds x positions: 2.5 MB of them
BLOCK_TRIALS = 65_536  # trials whose statistics are folded together, and that are written as one file
AUTO_BLOCK_TRIALS = 16_384  # of a study that may stop after any block
AUTO_FCL_BLOCK_TRIALS = 2048  # the same where a trial is slow: a second of them
BLOCK_VALUES = 2**22  # values of a curve in one block: 32 MB


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
    return Block(trials.deviations(model, seed, first, count), trials.driver_angles(model, seed, first, count))


def stated_block(model: Model, deviations: Array) -> Block:
    """Trials of the deviations (trials, components) that are stated, drivers at 0."""
    return Block(deviations, {mesh.name: np.zeros(len(deviations)) for mesh in model.meshes})


def mean_block(model: Model, measure: Measure) -> Block:
    """One trial with every contributor at its mean over the positions of a measure, drivers at 0."""
    return stated_block(model, trials.mean_deviations(model, measure.positions))


def nominal_block(model: Model) -> Block:
    """One trial without deviations, drivers at 0."""
    return stated_block(model, np.zeros((1, model.component_count)))


def driver_angles(positions: Positions, random_angle: Array) -> Array:
    """Driver angles [rad] at which a measure is read, (trials, positions)."""
    if positions.fixed is None:
        return random_angle[:, None]
    return np.broadcast_to(np.array(positions.fixed), (len(random_angle), len(positions.fixed)))


SeatKey = tuple[str, Positions, Reading]


def seat_key(measure: Measure) -> SeatKey:
    """Mesh, positions and reading: measures that share them share their contacts."""
    return measure.kind.mesh, measure.positions, measure.kind.reading


@dataclass(frozen=True)
class Seats:
    """Builds of a block and its seated meshes, kept by the positions at which measures read them.

    Args:
        build: one row a trial.
        seats: by mesh name, positions and reading; rows are trials x positions, positions fastest.
        meshings: the builds that were seated there.
    """

    build: Build
    seats: Mapping[SeatKey, MeshSeat] = field(default_factory=dict)
    meshings: Mapping[SeatKey, Meshing] = field(default_factory=dict)


def seat_block(model: Model, engine: Engine, block: Block) -> Seats:
    """Build the trials and seat every mesh at every set of positions that some measure wants."""
    made = build(model, block.deviations)
    seats: dict[SeatKey, MeshSeat] = {}
    meshings: dict[SeatKey, Meshing] = {}
    for measure in model.measures:
        key = seat_key(measure)
        if key not in seats:
            mesh = model.mesh(measure.kind.mesh)
            angles = driver_angles(measure.positions, block.random_angle[mesh.name])
            meshings[key] = Meshing(engine, model, mesh, made.repeated(angles.shape[1]), measure.kind.reading)
            seats[key] = meshings[key].seat(angles.ravel())
    return Seats(made, seats, meshings)


def geometric_values(measure: Measure, seats: Seats) -> Array:
    """Values of a measure on the geometric road [mm or rad], (trials, positions)."""
    key = seat_key(measure)
    values = measure_backlash(measure.kind, seats.meshings[key], seats.seats[key])
    return values.reshape(-1, positions_count(measure))


def analytic_values(model: Model, measure: Measure, block: Block) -> Array:
    """Values of a measure on the analytic road [mm or rad], (trials, positions)."""
    angles = driver_angles(measure.positions, block.random_angle[measure.kind.mesh])
    positions = angles.shape[1]
    repeated = block.deviations if positions == 1 else np.repeat(block.deviations, positions, axis=0)
    return analytic_backlash(model, measure.kind, repeated, angles.ravel()).reshape(angles.shape)


def positions_count(measure: Measure) -> int:
    """At how many positions a measure is read in one trial."""
    return 1 if measure.positions.fixed is None else len(measure.positions.fixed)


def block_trials(model: Model) -> int:
    """Trials of a canonical block: fewer where curves keep many positions of each trial."""
    kept = max((positions_count(measure) for measure in model.measures if measure.take == "curve"), default=1)
    return min(_most_block_trials(model.study), 1 << int(math.log2(BLOCK_VALUES / kept)))


def _most_block_trials(study: Study) -> int:
    if not study.until:
        return BLOCK_TRIALS
    return AUTO_FCL_BLOCK_TRIALS if study.engine == "fcl" else AUTO_BLOCK_TRIALS


def positions_in_all(model: Model) -> int:
    """How many contacts one trial takes: positions of every different way of reading a mesh."""
    ways = {seat_key(measure): positions_count(measure) for measure in model.measures}
    return sum(ways.values())


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


def simulate_block(model: Model, engine: Engine | None, block: Block) -> dict[str, NDArray[np.generic]]:
    """All columns of a block; without an engine only the analytic ones.

    Returns:
        deviations, `position:<mesh> [deg]`, `analytic:<measure>`, and with an engine
        `geometric:<measure>`, `contact:<mesh>.x|y|z [mm]`, `contact:<mesh>.tooth` and `status`.
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
    for measure, values in _analytic(model, block):
        columns[f"analytic:{measure.name}"] = taken(measure, values) * measure.per_internal
    if engine is None:
        return columns
    seen = (
        _read_in_pieces(model, engine, block) if isinstance(engine, ReadingEngine) else _measured(model, engine, block)
    )
    for measure in model.measures:
        columns[f"geometric:{measure.name}"] = taken(measure, seen.values[measure.name]) * measure.per_internal
    columns.update(seen.contacts)
    columns["status"] = _STATUS_TEXTS[seen.status]
    return columns


def _analytic(model: Model, block: Block) -> Iterator[tuple[Measure, Array]]:
    """Analytic values of every measure (trials, positions); those that are read alike share one stack-up."""
    known: dict[SeatKey, Array] = {}
    for measure in model.measures:
        key = seat_key(measure)
        if key not in known:
            normal = replace(measure, kind=replace(measure.kind, quantity="normal_backlash"))
            known[key] = analytic_values(model, normal, block)
        yield measure, known[key] * per_normal_backlash(model, measure.kind)


_STATUS_TEXTS = np.array([STATUS_TEXT[code] for code in range(len(STATUS_TEXT))])


@dataclass(frozen=True)
class _Seen:
    """The geometric road of a block: values by measure (trials, positions), contact columns, status (trials,)."""

    values: Mapping[str, Array]
    contacts: Mapping[str, NDArray[np.generic]]
    status: NDArray[np.int8]


def _measured(model: Model, engine: Engine, block: Block) -> _Seen:
    """By seating every mesh on the gaps that an engine tells."""
    seats = seat_block(model, engine, block)
    contacts: dict[str, NDArray[np.generic]] = {}
    for mesh in model.meshes:
        seat = next((seat for key, seat in seats.seats.items() if key[0] == mesh.name), None)
        if seat is not None:
            contacts |= _contact_columns(mesh, *seat.contact, len(block))
    return _Seen(
        {measure.name: geometric_values(measure, seats) for measure in model.measures},
        contacts,
        _worst_status([seat.status for seat in seats.seats.values()], len(block)),
    )


def _read_in_pieces(model: Model, engine: ReadingEngine, block: Block) -> _Seen:
    """By an engine that builds, seats and reads meshes itself, so many at once that builds stay in the cache."""
    rows = max(1, BUILDS_AT_ONCE // max(positions_count(measure) for measure in model.measures))
    each = [_read(model, engine, block.part(first, first + rows)) for first in range(0, len(block), rows)]
    if len(each) == 1:
        return each[0]
    return _Seen(
        {name: np.concatenate([seen.values[name] for seen in each]) for name in each[0].values},
        {name: np.concatenate([seen.contacts[name] for seen in each]) for name in each[0].contacts},
        np.concatenate([seen.status for seen in each]),
    )


def _read(model: Model, engine: ReadingEngine, block: Block) -> _Seen:
    made = engine.build(block.deviations)
    readings: dict[SeatKey, MeshReading] = {}
    contacts: dict[str, NDArray[np.generic]] = {}
    for key in dict.fromkeys(seat_key(measure) for measure in model.measures):
        mesh = model.mesh(key[0])
        angles = driver_angles(key[1], block.random_angle[mesh.name])
        kinds = [measure.kind for measure in model.measures if seat_key(measure) == key]
        turning = frozenset(gear for kind in kinds if (gear := turning_gear(kind, mesh)))
        readings[key] = engine.read(made.repeated(angles.shape[1]), mesh, key[2], angles.ravel(), turning)
        if f"contact:{mesh.name}.tooth" not in contacts:
            contacts |= _contact_columns(mesh, readings[key].contact, readings[key].tooth, len(block))
    values = {
        measure.name: read_backlash(measure.kind, model.mesh(measure.kind.mesh), readings[seat_key(measure)]).reshape(
            -1, positions_count(measure)
        )
        for measure in model.measures
    }
    return _Seen(values, contacts, _worst_status([reading.status for reading in readings.values()], len(block)))


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


def _worst_status(each: Sequence[NDArray[np.int8]], trials_count: int) -> NDArray[np.int8]:
    worst = np.full(trials_count, OK, dtype=np.int8)
    for status in each:
        worst = np.maximum(worst, status.reshape(trials_count, -1).max(axis=1))
    return worst
