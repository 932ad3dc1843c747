"""Smallest distance of two gears' flanks and the turn until they touch, by searching the surfaces.

Every flank near the mesh is searched over roll and face, edges included, by grids that zoom in on their
lowest point; no line of action, no candidate list.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from oracles.involute_gear import InvoluteGear
from oracles.poses import world_from_gears
from tol3d.gears.flank import Flank, opposite

TEETH_EACH_SIDE = 2  # teeth beyond the one nearest to the line of centres: 5 pitches, a path of contact has 2
ROLL_POINTS, ROLL_ZOOMS = 13, 8  # a zoom keeps two of twelve cells: 6^7 times finer than 20 mm/12 is 0.006 um
FACE_POINTS, FACE_ZOOMS = 7, 9  # 3^8 times finer than 100 mm/6 is 2.5 um, times 1 mrad 0.003 um
CONTACT_XTOL = 1e-8  # mm
CONTACT_STEPS = 40  # the distance falls by r_b times the turn up to a few per cent, so that six steps do


@dataclass(frozen=True)
class Mesh:
    """Two gears and their shafts at rest, for n builds.

    Args:
        driver, driven: the gears.
        driver_shaft, driven_shaft: (n, 4, 4) world_from_shaft.
        driver_centre, driven_centre: (n, 2) [mm], centres off the axes, in the gears' frames.
    """

    driver: InvoluteGear
    driven: InvoluteGear
    driver_shaft: np.ndarray
    driven_shaft: np.ndarray
    driver_centre: np.ndarray
    driven_centre: np.ndarray

    def driven_from_driver(self, driver_angle: np.ndarray, driven_angle: np.ndarray) -> np.ndarray:
        """Poses (n, 4, 4) that take the driver gear's frame into the driven gear's."""
        driver = world_from_gears(self.driver_shaft, driver_angle, self.driver_centre)
        driven = world_from_gears(self.driven_shaft, driven_angle, self.driven_centre)
        return np.linalg.inv(driven) @ driver


def smallest_distance(mesh: Mesh, driver_angle: np.ndarray, driven_angle: np.ndarray, flank: Flank) -> np.ndarray:
    """Shortest distance (n,) [mm] of the driver's flanks of one side to the driven gear's, negative in overlap."""
    return distances(mesh, driver_angle, driven_angle, flank)[1].min(axis=1)


def distances(
    mesh: Mesh, driver_angle: np.ndarray, driven_angle: np.ndarray, flank: Flank
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Driver teeth (n, pairs), their distances to the mating flanks and those flanks' teeth, each (n, pairs)."""
    around = np.arange(-TEETH_EACH_SIDE, TEETH_EACH_SIDE + 1)
    teeth = np.round(-driver_angle / mesh.driver.pitch)[:, None] + around
    # the driven tooth that fills the space beside that flank: on rolling circles, half a pitch further
    azimuth = driver_angle[:, None] + mesh.driver.pitch * (teeth - flank / 2)
    mates = np.round(
        (np.pi - azimuth * mesh.driver.teeth / mesh.driven.teeth - driven_angle[:, None]) / mesh.driven.pitch
    )
    pose = mesh.driven_from_driver(driver_angle, driven_angle)

    def distance(string: np.ndarray, z: np.ndarray) -> np.ndarray:
        points = mesh.driver.flank_points(string, z[..., None], teeth[..., None, None], flank)
        flat = points.reshape(len(points), -1, 3) @ np.swapaxes(pose[:, :3, :3], 1, 2) + pose[:, None, :3, 3]
        return mesh.driven.signed_distance(flat.reshape(points.shape), mates[..., None, None], flank)

    def along_the_face(z: np.ndarray) -> np.ndarray:
        string_end = np.full(z.shape, mesh.driver.tip_string)
        return zoomed_minimum(
            lambda string: distance(string, z), np.zeros(z.shape), string_end, (ROLL_POINTS, ROLL_ZOOMS)
        )

    half = np.full(teeth.shape, mesh.driver.face_width / 2)
    return teeth, zoomed_minimum(along_the_face, -half, half, (FACE_POINTS, FACE_ZOOMS)), mates


def zoomed_minimum(
    function: Callable[[np.ndarray], np.ndarray], low: np.ndarray, high: np.ndarray, grid: tuple[int, int]
) -> np.ndarray:
    """Minimum of `function` (...,) -> values over low ... high, each entry for itself; `grid` = points, zooms."""
    points, zooms = grid
    share = np.linspace(0.0, 1.0, points)
    for _ in range(zooms):
        at = low[..., None] + (high - low)[..., None] * share
        values = function(at)
        best = np.argmin(values, axis=-1)[..., None]
        low = np.take_along_axis(at, np.maximum(best - 1, 0), -1)[..., 0]
        high = np.take_along_axis(at, np.minimum(best + 1, points - 1), -1)[..., 0]
    return np.take_along_axis(values, best, -1)[..., 0]


def turn_until_contact(
    mesh: Mesh, driver_angle: np.ndarray, driven_angle: np.ndarray, flank: Flank, *, turn_driver: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Turn one gear until that flank side just touches; the angles (driver, driven), each (n,) [rad].

    Opening a right flank (sigma = +1) turns either gear counter-clockwise.
    """
    angles = [np.array(driver_angle, dtype=float), np.array(driven_angle, dtype=float)]
    mover = 0 if turn_driver else 1
    base_radius = (mesh.driver if turn_driver else mesh.driven).base_radius
    for _ in range(CONTACT_STEPS):
        distance = smallest_distance(mesh, angles[0], angles[1], flank)
        if np.abs(distance).max() < CONTACT_XTOL:
            return angles[0], angles[1]
        angles[mover] -= flank * distance / base_radius
    raise AssertionError(f"no contact: distances {distance}")


def normal_backlash(mesh: Mesh, driver_angle: np.ndarray, working_flank: Flank) -> np.ndarray:
    """Shortest distance [mm] of the non-working flanks while the driven gear is turned onto the working ones, (n,)."""
    driver, driven = turn_until_contact(mesh, driver_angle, tooth_in_space(mesh, driver_angle), working_flank)
    return smallest_distance(mesh, driver, driven, opposite(working_flank))


def free_turn(mesh: Mesh, driver_angle: np.ndarray, working_flank: Flank, *, turn_driver: bool) -> np.ndarray:
    """Turn [rad] of one gear from the working to the non-working contact, the other held, (n,)."""
    start = turn_until_contact(mesh, driver_angle, tooth_in_space(mesh, driver_angle), working_flank)
    end = turn_until_contact(mesh, start[0], start[1], opposite(working_flank), turn_driver=turn_driver)
    mover = 0 if turn_driver else 1
    return np.abs(end[mover] - start[mover])


def tooth_in_space(mesh: Mesh, driver_angle: np.ndarray) -> np.ndarray:
    """The driven gear's turn with a space opposite driver tooth 0 when the driver stands at 0, and rolling on."""
    return np.pi + mesh.driven.pitch / 2 - driver_angle * mesh.driver.teeth / mesh.driven.teeth
