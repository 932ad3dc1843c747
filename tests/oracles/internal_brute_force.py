"""Smallest distance of the flanks of an internal pair in any pose and the turn until they touch: surfaces searched.

As brute_force.py does for external gears: every flank of the driver near the mesh is searched over its profile and its
face, edges included, against the signed distance to the flank of the driven gear's tooth beside it. Either gear may be
the ring. By azimuth a flank of one gear meets the other flank of its mate, and a driven gear opens by turning away.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from oracles.brute_force import FACE_POINTS, FACE_ZOOMS, ROLL_POINTS, ROLL_ZOOMS, zoomed_minimum
from oracles.involute_gear import InvoluteGear
from oracles.poses import world_from_gears
from tol3d.gears.flank import Flank, opposite

TEETH_EACH_SIDE = 3  # 7 pitches: a path of contact has 2.5
CONTACT_XTOL = 1e-9  # mm
CONTACT_STEPS = 40


@dataclass(frozen=True)
class Ring:
    """Plain numbers of an internal gear; `thickness_deviation` [mm] of its tooth, an arc at the reference circle.

    `profile_shift` [modules] and `addendum` go inwards; `last_radius` [mm] is where the involute ends at the root.
    """

    teeth: int
    module: float
    pressure_angle: float
    face_width: float
    last_radius: float
    profile_shift: float = 0.0
    addendum: float = 1.0
    thickness_deviation: Any = 0.0

    @property
    def base_radius(self) -> float:
        return self.module * self.teeth / 2 * math.cos(self.pressure_angle)

    @property
    def tip_radius(self) -> float:
        return self.module * (self.teeth / 2 - self.addendum - self.profile_shift)

    @property
    def pitch(self) -> float:
        """Angle from tooth to tooth [rad]."""
        return 2 * math.pi / self.teeth

    @property
    def strings(self) -> tuple[float, float]:
        """Lengths [mm] of the string at the tip and where the involute ends."""
        first, last = (math.sqrt(radius**2 - self.base_radius**2) for radius in (self.tip_radius, self.last_radius))
        return first, last

    def half_angle(self, radius: np.ndarray) -> np.ndarray:
        """Half the angle [rad] of a tooth at radii: half a pitch less half a space.

        The space is the tooth of a cutter with as many teeth whose rack has its space shifted by -x m.
        """
        alpha = self.pressure_angle
        space = self.module * (math.pi / 2 - 2 * self.profile_shift * math.tan(alpha)) - self.thickness_deviation
        at = np.arccos(np.minimum(1.0, self.base_radius / radius))
        return math.pi / self.teeth - (
            space / (self.module * self.teeth) + (math.tan(alpha) - alpha) - (np.tan(at) - at)
        )

    def flank_points(self, string: np.ndarray, z: np.ndarray, tooth: np.ndarray, flank: Flank) -> np.ndarray:
        """Points (..., 3) on a flank; `string` [mm] = sqrt(r^2 - r_b^2), all arguments broadcast."""
        string, z, tooth = np.broadcast_arrays(string, z, tooth)
        radius = np.hypot(self.base_radius, string)
        azimuth = self.pitch * tooth - flank * self.half_angle(radius)
        return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=-1)

    def signed_distance(self, points: np.ndarray, tooth: np.ndarray, flank: Flank) -> np.ndarray:
        """Shortest distance [mm] of points (..., 3) in the gear's frame to one flank, negative inside the tooth.

        A point off the flank by the angle delta lies on the same involute turned by delta; along the common normal,
        tangent to the base circle, that is r_b delta, and the string is shorter by as much, for the flank is hollow.
        """
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        radius = np.maximum(np.hypot(x, y), self.base_radius)
        azimuth = np.arctan2(y, x) - self.pitch * tooth
        azimuth -= 2 * math.pi * np.round(azimuth / (2 * math.pi))
        outside = self.base_radius * (-flank * azimuth - self.half_angle(radius))
        string = np.sqrt(radius**2 - self.base_radius**2) + outside
        foot_string = np.clip(string, *self.strings)
        foot_z = np.clip(z, -self.face_width / 2, self.face_width / 2)
        on_flank = (foot_string == string) & (foot_z == z)
        within = (outside < 0.0) & (np.hypot(x, y) > self.tip_radius) & (foot_z == z)
        to_edge = np.linalg.norm(points - self.flank_points(foot_string, foot_z, tooth, flank), axis=-1)
        return np.where(on_flank | within, outside, to_edge)


@dataclass(frozen=True)
class InternalBuilds:
    """A ring and a gear in it, one of them the driver, and their shafts at rest, for n builds; as brute_force.Mesh."""

    driver: InvoluteGear | Ring
    driven: InvoluteGear | Ring
    driver_shaft: np.ndarray
    driven_shaft: np.ndarray
    driver_centre: np.ndarray
    driven_centre: np.ndarray

    def driven_from_driver(self, driver_angle: np.ndarray, driven_angle: np.ndarray) -> np.ndarray:
        """Poses (n, 4, 4) that take the driver gear's frame into the driven gear's."""
        driver = world_from_gears(self.driver_shaft, driver_angle, self.driver_centre)
        driven = world_from_gears(self.driven_shaft, driven_angle, self.driven_centre)
        return np.asarray(np.linalg.inv(driven) @ driver)


def distances(
    mesh: InternalBuilds, driver_angle: np.ndarray, driven_angle: np.ndarray, flank: Flank
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Driver teeth (n, pairs), their distances to the mating flanks and those flanks' teeth, each (n, pairs)."""
    around = np.arange(-TEETH_EACH_SIDE, TEETH_EACH_SIDE + 1)
    teeth = np.round(-driver_angle / mesh.driver.pitch)[:, None] + around
    azimuth = driver_angle[:, None] + mesh.driver.pitch * (teeth - flank / 2)
    mates = np.round((azimuth * mesh.driver.teeth / mesh.driven.teeth - driven_angle[:, None]) / mesh.driven.pitch)
    pose = mesh.driven_from_driver(driver_angle, driven_angle)
    strings = mesh.driver.strings if isinstance(mesh.driver, Ring) else (0.0, mesh.driver.tip_string)

    def distance(string: np.ndarray, z: np.ndarray) -> np.ndarray:
        points = mesh.driver.flank_points(string, z[..., None], teeth[..., None, None], flank)
        flat = points.reshape(len(points), -1, 3) @ np.swapaxes(pose[:, :3, :3], 1, 2) + pose[:, None, :3, 3]
        return mesh.driven.signed_distance(flat.reshape(points.shape), mates[..., None, None], opposite(flank))

    def along_the_face(z: np.ndarray) -> np.ndarray:
        first, last = (np.full(z.shape, end) for end in strings)
        return zoomed_minimum(lambda string: distance(string, z), first, last, (ROLL_POINTS, ROLL_ZOOMS))

    half = np.full(teeth.shape, mesh.driver.face_width / 2)
    return teeth, zoomed_minimum(along_the_face, -half, half, (FACE_POINTS, FACE_ZOOMS)), mates


def smallest_distance(
    mesh: InternalBuilds, driver_angle: np.ndarray, driven_angle: np.ndarray, flank: Flank
) -> np.ndarray:
    """Shortest distance (n,) [mm] of the driver's flanks of one side to the driven gear's, negative in overlap."""
    return np.asarray(distances(mesh, driver_angle, driven_angle, flank)[1].min(axis=1))


def turn_until_contact(
    mesh: InternalBuilds, driver_angle: np.ndarray, driven_angle: np.ndarray, flank: Flank, *, turn_driver: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Turn one gear until the driver's flanks of that side just touch; the angles (driver, driven), each (n,) [rad]."""
    angles = [np.array(driver_angle, dtype=float), np.array(driven_angle, dtype=float)]
    mover, sense = (0, flank) if turn_driver else (1, -flank)
    base_radius = (mesh.driver if turn_driver else mesh.driven).base_radius
    for _ in range(CONTACT_STEPS):
        distance = smallest_distance(mesh, angles[0], angles[1], flank)
        if np.abs(distance).max() < CONTACT_XTOL:
            return angles[0], angles[1]
        angles[mover] -= sense * distance / base_radius
    raise AssertionError(f"no contact: distances {distance}")


def tooth_in_space(mesh: InternalBuilds, driver_angle: np.ndarray) -> np.ndarray:
    """The driven gear's turn with a space at driver tooth 0 when the driver stands at 0, and rolling on."""
    return mesh.driven.pitch / 2 + driver_angle * mesh.driver.teeth / mesh.driven.teeth


def normal_backlash(mesh: InternalBuilds, driver_angle: np.ndarray, working_flank: Flank) -> np.ndarray:
    """Shortest distance [mm] of the non-working flanks while the driven gear is turned onto the working ones, (n,)."""
    driver, driven = turn_until_contact(mesh, driver_angle, tooth_in_space(mesh, driver_angle), working_flank)
    return smallest_distance(mesh, driver, driven, opposite(working_flank))


def free_turn(mesh: InternalBuilds, driver_angle: np.ndarray, working_flank: Flank, *, turn_driver: bool) -> np.ndarray:
    """Turn [rad] of one gear from the working to the non-working contact, the other held, (n,)."""
    start = turn_until_contact(mesh, driver_angle, tooth_in_space(mesh, driver_angle), working_flank)
    end = turn_until_contact(mesh, start[0], start[1], opposite(working_flank), turn_driver=turn_driver)
    mover = 0 if turn_driver else 1
    return np.asarray(np.abs(end[mover] - start[mover]))
