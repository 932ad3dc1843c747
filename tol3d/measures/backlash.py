"""Backlash of a seated mesh: normal, circumferential, angular."""

import numpy as np
from numpy.typing import NDArray

from tol3d.engines import OK, MeshReading
from tol3d.gears.flank import opposite
from tol3d.model import Backlash, Mesh
from tol3d.moves import Meshing, MeshSeat

Array = NDArray[np.float64]


def measure_backlash(kind: Backlash, meshing: Meshing, seat: MeshSeat) -> Array:
    """Value of a backlash measure in every row [mm, or rad for an angle]; nan where the mesh did not seat.

    normal: shortest distance of the non-working flanks while the working ones touch.
    angular: turn of one gear, the other held at rest, from the working to the non-working contact.
    circumferential: that turn of the driven gear times its nominal working radius, an arc.
    rest: the driven gear's turn at rest, less that with its space in the middle of the driver's tooth.
    """
    good = seat.status == OK
    if kind.quantity == "normal_backlash":
        return np.where(good, seat.non_working.smallest(), np.nan)
    mesh = meshing.mesh
    if kind.quantity == "rest_angle":
        return np.where(good, seat.driven_angle - mesh.pair.driven_angle(seat.driver_angle), np.nan)
    turn_driver = kind.quantity == "angular_backlash" and kind.gear == mesh.driver
    rows = np.flatnonzero(good)
    start = (seat.driver_angle[rows], seat.driven_angle[rows])
    angles, _, touched = meshing.rows(rows).turn_to_contact(
        opposite(mesh.working_flank), start, turn_driver=turn_driver, known=seat.non_working.rows(rows)
    )
    mover = 0 if turn_driver else 1
    turn = np.full(len(good), np.nan)
    turn[rows] = np.where(touched, np.abs(angles[mover] - start[mover]), np.nan)
    if kind.quantity == "circumferential_backlash":
        return turn * mesh.pair.working_radii[1]
    return turn


def turning_gear(kind: Backlash, mesh: Mesh) -> str | None:
    """Which gear's free turn the measure needs; None for the normal backlash and for the rest."""
    if kind.quantity in ("normal_backlash", "rest_angle"):
        return None
    return kind.gear if kind.quantity == "angular_backlash" else mesh.driven


def read_backlash(kind: Backlash, mesh: Mesh, reading: MeshReading) -> Array:
    """The same of a mesh that its engine has read."""
    good = reading.status == OK
    if kind.quantity == "rest_angle":
        return np.where(good, reading.driven_angle - mesh.pair.driven_angle(reading.driver_angle), np.nan)
    turning = turning_gear(kind, mesh)
    if turning is None:
        return np.where(good, reading.gap, np.nan)
    turn = np.where(good, reading.driver_turn if turning == mesh.driver else reading.driven_turn, np.nan)
    return turn * mesh.pair.working_radii[1] if kind.quantity == "circumferential_backlash" else turn
