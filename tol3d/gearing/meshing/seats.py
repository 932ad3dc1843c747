"""Meshes of some trials seated at the positions that measures read, and their backlashes: normal, at a circle, angular.

A backlash is below 0 where the teeth interfere.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from tol3d.gearing.builds.build import Build, build
from tol3d.gearing.engines import INTERFERES, Engine, MeshReading
from tol3d.gearing.meshing.mesh import Meshing, MeshSeat
from tol3d.gearing.model import Backlash, Kind, LostMotion, Measure, Mesh, Model, TransmissionError
from tol3d.gearing.play.linked import as_built
from tol3d.gearing.play.play import Play, SeatKey, seat_keys
from tol3d.gears.flank import opposite
from tol3d.numerics.arrays import Array
from tol3d.study.system.trials import Trials


def measure_backlash(kind: Backlash, meshing: Meshing, seat: MeshSeat) -> Array:
    """Value of a backlash measure in every row [mm, or rad for an angle].

    normal: shortest distance of the non-working flanks while the working ones touch.
    angular: turn of one gear, the other held at rest, from the working to the non-working contact; of a reversal that
        under the load on those flanks.
    circumferential: that turn of the driven gear times its nominal working radius, an arc.
    rest: the driven gear's turn at rest, less that with its space in the middle of the driver's tooth.

    Where the non-working flanks overlap it is negative: by how much they do, or the turn back until they touch. nan
    where the mesh found no contact, and where the overlap is deeper than the engine can measure.
    """
    known = seat.status <= INTERFERES
    if kind.quantity == "normal_backlash":
        return np.where(known, seat.non_working.smallest(), np.nan)
    mesh = meshing.mesh
    if kind.quantity == "rest_angle":
        return np.where(known, seat.driven_angle - mesh.pair.driven_angle(seat.driver_angle), np.nan)
    turn_driver = kind.quantity == "angular_backlash" and kind.gear == mesh.driver
    rows, flank = np.flatnonzero(known), opposite(mesh.working_flank)
    start = (seat.driver_angle[rows], seat.driven_angle[rows])
    end = meshing.reversed
    known_gaps = seat.non_working.rows(rows) if end is None else None
    angles, _, touched = (
        (end or meshing).rows(rows).turn_to_contact(flank, start, turn_driver=turn_driver, known=known_gaps)
    )
    mover = 0 if turn_driver else 1
    turn = np.full(len(known), np.nan)
    closing = -(flank if turn_driver else mesh.pair.mating_flank(flank)) * (angles[mover] - start[mover])
    turn[rows] = np.where(touched, closing, np.nan)
    if kind.quantity == "circumferential_backlash":
        return turn * mesh.pair.working_radii[1]
    return turn


def turning_gear(kind: Backlash, mesh: Mesh) -> str | None:
    """Gear whose free turn the measure needs; None for the normal backlash and for the rest."""
    if kind.quantity in ("normal_backlash", "rest_angle"):
        return None
    return kind.gear if kind.quantity == "angular_backlash" else mesh.driven


def read_backlash(kind: Backlash, mesh: Mesh, reading: MeshReading) -> Array:
    """The same for a mesh read by its engine."""
    known = reading.status <= INTERFERES
    if kind.quantity == "rest_angle":
        return np.where(known, reading.driven_angle - mesh.pair.driven_angle(reading.driver_angle), np.nan)
    turning = turning_gear(kind, mesh)
    if turning is None:
        return np.where(known, reading.gap, np.nan)
    turn = np.where(known, reading.driver_turn if turning == mesh.driver else reading.driven_turn, np.nan)
    return turn * mesh.pair.working_radii[1] if kind.quantity == "circumferential_backlash" else turn


def moved(kind: Kind, free: Array) -> Array:
    """A measure's values from its play.

    A tip goes round its shaft's axis: the chord 2 L sin(turn/2) [mm]. Over a swing it has an error where other flanks
    work than at the start, whose rest is the reference. A transmission error is counted from that at the first
    position.

    Args:
        kind: what is measured.
        free: backlash [mm], or turn of the shaft that is read [rad]; (trials, positions).
    """
    if isinstance(kind, TransmissionError):
        return free - free[:, :1]
    if not isinstance(kind, LostMotion) or kind.tip is None:
        return free
    displacement = 2 * kind.tip.lever * np.sin(free / 2)
    return displacement * np.array(kind.turned, dtype=float) if kind.turned else displacement


def moved_rates(kind: Kind, free: Array, rates: Array) -> Array:
    """Its derivatives (trials, positions, components) by those of what is free."""
    if isinstance(kind, TransmissionError):
        return np.asarray(rates - rates[:, :1])
    if not isinstance(kind, LostMotion) or kind.tip is None:
        return rates
    rate = kind.tip.lever * np.cos(free / 2)
    return np.asarray(rates * (rate * np.array(kind.turned, dtype=float) if kind.turned else rate)[..., None])


def driver_angles(key: SeatKey, trials: Trials) -> Array:
    """Driver angles [rad] at which a mesh is read, (trials, positions)."""
    mesh, angles, _ = key
    if angles is None:
        return trials.positions[mesh][:, None]
    return np.broadcast_to(np.array(angles), (len(trials), len(angles)))


def all_seat_keys(model: Model, measures: Sequence[Measure]) -> tuple[SeatKey, ...]:
    """Every different way of reading a mesh."""
    return tuple(dict.fromkeys(key for measure in measures for key in seat_keys(model, measure)))


@dataclass(frozen=True)
class Seats:
    """Builds of some trials and their seated meshes, kept by the positions at which measures read them.

    Args:
        model: what is built.
        trials: the trials.
        build: one row a trial.
        seats: by mesh name, positions and reading; rows are trials x positions, positions fastest.
        meshings: the builds that were seated there.
        reversed_build: the builds with the load on the other flanks, if a reading ends there.
    """

    model: Model
    trials: Trials
    build: Build
    seats: Mapping[SeatKey, MeshSeat] = field(default_factory=dict)
    meshings: Mapping[SeatKey, Meshing] = field(default_factory=dict)
    reversed_build: Build | None = None


def seated(model: Model, engine: Engine, trials: Trials, measures: Sequence[Measure] | None = None) -> Seats:
    """Build the trials and seat every mesh at every set of positions that some measure reads; all of the model's."""
    made, keys = build(model, trials.deviations), all_seat_keys(model, model.measures if measures is None else measures)
    loaded = build(model.reversed, trials.deviations) if any(key[2].reversing for key in keys) else None
    seats: dict[SeatKey, MeshSeat] = {}
    meshings: dict[SeatKey, Meshing] = {}
    for key in keys:
        angles = driver_angles(key, trials)
        other = loaded.repeated(angles.shape[1]) if loaded and key[2].reversing else None
        meshings[key] = Meshing(engine, model, model.mesh(key[0]), made.repeated(angles.shape[1]), key[2], other)
        seats[key] = meshings[key].seat(angles.ravel())
    return Seats(model, trials, made, seats, meshings, loaded)


def play_of(measure: Measure, seats: Seats) -> Play:
    """The backlashes of a measure by the geometric method."""

    def read(backlash: Backlash, key: SeatKey) -> Array:
        values = measure_backlash(backlash, seats.meshings[key], seats.seats[key])
        return values.reshape(len(seats.trials), -1)

    return Play(seats.model, measure, seats.trials, read, as_built)


def geometric_values(measure: Measure, seats: Seats) -> Array:
    """Values of a measure by the geometric method [mm or rad], (trials, positions)."""
    return moved(measure.kind, play_of(measure, seats).free())
