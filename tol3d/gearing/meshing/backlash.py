"""Backlash of a seated mesh: normal, circumferential, angular; below 0 where the teeth interfere."""

import numpy as np

from tol3d.gearing.engines import INTERFERES, MeshReading
from tol3d.gearing.meshing.mesh import Meshing, MeshSeat
from tol3d.gearing.model import Backlash, Kind, LostMotion, Mesh, TransmissionError
from tol3d.gears.flank import opposite
from tol3d.numerics.arrays import Array


def measure_backlash(kind: Backlash, meshing: Meshing, seat: MeshSeat) -> Array:
    """Value of a backlash measure in every row [mm, or rad for an angle].

    normal: shortest distance of the non-working flanks while the working ones touch.
    angular: turn of one gear, the other held at rest, from the working to the non-working contact.
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
    angles, _, touched = meshing.rows(rows).turn_to_contact(
        flank, start, turn_driver=turn_driver, known=seat.non_working.rows(rows)
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
