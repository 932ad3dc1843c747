"""Meshes of some trials brought to contact, at every set of positions at which measures read them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from tol3d.gearing.builds.build import Build, build
from tol3d.gearing.engines import Engine
from tol3d.gearing.meshing.backlash import measure_backlash, moved
from tol3d.gearing.meshing.mesh import Meshing, MeshSeat
from tol3d.gearing.model import Backlash, Measure, Model
from tol3d.gearing.play.linked import as_built
from tol3d.gearing.play.play import Play, SeatKey, seat_keys
from tol3d.numerics.arrays import Array
from tol3d.system.trials import Trials


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
    """

    model: Model
    trials: Trials
    build: Build
    seats: Mapping[SeatKey, MeshSeat] = field(default_factory=dict)
    meshings: Mapping[SeatKey, Meshing] = field(default_factory=dict)


def seated(model: Model, engine: Engine, trials: Trials, measures: Sequence[Measure] | None = None) -> Seats:
    """Build the trials and seat every mesh at every set of positions that some measure reads; all of the model's."""
    made = build(model, trials.deviations)
    seats: dict[SeatKey, MeshSeat] = {}
    meshings: dict[SeatKey, Meshing] = {}
    for key in all_seat_keys(model, model.measures if measures is None else measures):
        angles = driver_angles(key, trials)
        meshings[key] = Meshing(engine, model, model.mesh(key[0]), made.repeated(angles.shape[1]), key[2])
        seats[key] = meshings[key].seat(angles.ravel())
    return Seats(model, trials, made, seats, meshings)


def play_of(measure: Measure, seats: Seats) -> Play:
    """The backlashes of a measure by the geometric method."""

    def read(backlash: Backlash, key: SeatKey) -> Array:
        values = measure_backlash(backlash, seats.meshings[key], seats.seats[key])
        return values.reshape(len(seats.trials), -1)

    return Play(seats.model, measure, seats.trials, read, as_built)


def geometric_values(measure: Measure, seats: Seats) -> Array:
    """Values of a measure by the geometric method [mm or rad], (trials, positions)."""
    return moved(measure.kind, play_of(measure, seats).free())
