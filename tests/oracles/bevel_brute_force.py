"""Smallest distance of two bevel gears' flanks at any poses, by searching both surfaces.

Every flank near the mesh is searched over cone distance and roll, ends included, by grids that zoom in on their
lowest point; the nearest place of the other flank is searched too, by bisection. No plane of action, no candidate
list, no closed form of a distance. A flank is a line of a plane that has been turned about the cone's axis and
within itself.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from oracles.brute_force import zoomed_minimum
from oracles.poses import world_from_gears
from tol3d.gears.flank import Flank, opposite

TEETH_EACH_SIDE = 2  # teeth beyond the one nearest to the mesh: 5 pitches, a path of contact has 2
ROLL_POINTS, ROLL_ZOOMS = 11, 7  # a zoom keeps two of ten cells: 5^6 times finer than 20 mm/10 is 0.13 um
CONE_POINTS, CONE_ZOOMS = 7, 12  # 3^11 times finer than 10 mm/6 is 0.01 um; beside an edge d + s^2/(2 d) is stiff
HALVINGS = 3  # of the roll in which a foot is searched, to 0.2 rad, before
NEWTON_STEPS = 4  # finish it: 0.1, 5e-3, 2e-5, 1e-10 rad, the last quite lost in the rounding
BEYOND = 0.1  # rad of roll that a foot may lie beyond an end of its flank before it is put there
CONTACT_XTOL = 1e-9  # mm
CONTACT_STEPS = 15
EDGE_JUMP = 5e-5  # mm; outside a tip edge the distance to it is told, inside the flank that to the flank: it jumps
SIGN_HALVINGS = 14


@dataclass(frozen=True)
class BevelNumbers:
    """Plain numbers of one straight bevel gear; lengths in mm, angles in rad.

    Args:
        teeth, module (at the heel), pressure_angle, pitch_angle, profile_shift, addendum, dedendum: as usual.
        face: cone distances (toe, heel) [mm] between which the gear has flanks; any other two bound a search.
        turned: each flank stands that much further out about the axis [rad]: thickness, proportional along the face.
        offset: each flank stands that much further out along its normal [mm]: thickness, the same along the face.
    """

    teeth: int
    module: float
    pressure_angle: float
    pitch_angle: float
    face: tuple[float, float]
    profile_shift: float = 0.0
    addendum: float = 1.0
    dedendum: float = 1.25
    turned: float = 0.0
    offset: float = 0.0

    @property
    def pitch(self) -> float:
        """Angle from tooth to tooth [rad]."""
        return 2 * math.pi / self.teeth

    @property
    def outer(self) -> float:
        """Cone distance of the heel [mm]; `face` may be a part of it."""
        return self.module * self.teeth / 2 / math.sin(self.pitch_angle)

    @property
    def base_angle(self) -> float:
        """Angle of the cone on which the plane rolls: it leans from the pitch line's meridian by the pressure angle."""
        return math.asin(math.sin(self.pitch_angle) * math.cos(self.pressure_angle))

    @cached_property
    def start(self) -> float:
        """Azimuth [rad] of a flank on the base cone, off the middle of its tooth: by a search for the pitch cone."""
        x, y, _ = line(self.base_angle, self._roll_at(self.pitch_angle), 0.0, 1).direction
        half = math.pi / (2 * self.teeth) + 2 * self.profile_shift * math.tan(self.pressure_angle) / self.teeth
        return half + math.atan2(y, x) + self.turned

    @cached_property
    def rolls(self) -> tuple[float, float]:
        """Rolls [rad] where the flank begins (root or base cone) and ends (tip cone)."""
        root = self.pitch_angle - math.atan((self.dedendum - self.profile_shift) * self.module / self.outer)
        return (self._roll_at(root) if root > self.base_angle else 0.0), self._roll_at(self.tip_angle)

    @property
    def tip_angle(self) -> float:
        """Angle of the tip cone [rad]."""
        return self.pitch_angle + math.atan((self.addendum + self.profile_shift) * self.module / self.outer)

    def _roll_at(self, polar: float) -> float:
        def too_high(roll: float) -> float:
            x, y, z = line(self.base_angle, roll, 0.0, 1).direction
            return math.atan2(math.hypot(x, y), z) - polar

        return brentq(too_high, 0.0, math.pi / 2 / math.sin(self.base_angle), xtol=1e-15, rtol=1e-15)

    def lines(self, roll: np.ndarray | float, tooth: np.ndarray | int, flank: Flank) -> "Line":
        """The lines of a flank, in the gear's frame."""
        return line(self.base_angle, roll, np.asarray(tooth) * self.pitch - flank * self.start, flank)

    def flank_points(
        self, cone_distance: np.ndarray, roll: np.ndarray, tooth: np.ndarray | int, flank: Flank
    ) -> np.ndarray:
        """Points (..., 3) on a flank in the gear's frame; all arguments broadcast."""
        drawn = self.lines(roll, tooth, flank)
        return np.asarray(cone_distance)[..., None] * drawn.direction + self.offset * drawn.outwards

    def signed_distance(self, points: np.ndarray, tooth: np.ndarray | int, flank: Flank) -> np.ndarray:
        """Shortest distance [mm] of points (..., 3) in the gear's frame to one flank, negative inside the tooth.

        The flank ends at tip cone, root or base cone, toe and heel; a point beyond an end is measured to that edge.
        """
        roll = self._foot(points, tooth, flank)
        foot = self.lines(roll, tooth, flank)
        along, outside = dot(points, foot.direction), dot(points, foot.outwards) - self.offset
        kept_roll = np.clip(roll, *self.rolls)
        kept_along = np.clip(dot(points, self.lines(kept_roll, tooth, flank).direction), *self.face)
        to_edge = np.linalg.norm(points - self.flank_points(kept_along, kept_roll, tooth, flank), axis=-1)
        in_face = (along >= self.face[0]) & (along <= self.face[1])
        below_tip = points[..., 2] > math.cos(self.tip_angle) * np.linalg.norm(points, axis=-1)
        return np.where(in_face & ((kept_roll == roll) | ((outside < 0.0) & below_tip)), outside, to_edge)

    def _foot(self, points: np.ndarray, tooth: np.ndarray | int, flank: Flank) -> np.ndarray:
        """Roll [rad] of the line of the endless flank that is nearest to each point: nothing of it points upwards."""
        begin, end = self.rolls
        shape = np.broadcast_shapes(points.shape[:-1], np.shape(tooth))
        low, high = np.full(shape, begin - BEYOND), np.full(shape, end + BEYOND)
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            above = dot(points, self.lines(middle, tooth, flank).upwards) > 0.0
            low, high = np.where(above, middle, low), np.where(above, high, middle)
        roll = (low + high) / 2
        for _ in range(NEWTON_STEPS):
            at = self.lines(roll, tooth, flank)
            roll = np.clip(roll - dot(points, at.upwards) / dot(points, at.bend), low, high)
        return roll


@dataclass(frozen=True)
class Line:
    """A rolled line, (..., 3) each: its direction, the direction across it up the flank (of length cos(base)) and
    that one's derivative by the roll, and the unit normal out of the tooth."""

    direction: np.ndarray
    upwards: np.ndarray
    bend: np.ndarray
    outwards: np.ndarray


def line(base_angle: float, roll: np.ndarray | float, start: np.ndarray | float, flank: Flank) -> "Line":
    """The line of the plane that touches the cone at azimuth start + flank roll, turned back within it by roll sin."""
    sin, cos = math.sin(base_angle), math.cos(base_angle)
    about = np.asarray(start + flank * np.asarray(roll, dtype=float))
    flat = np.zeros_like(about)
    out = np.stack([np.cos(about), np.sin(about), flat], axis=-1)
    across = np.stack([-np.sin(about), np.cos(about), flat], axis=-1)
    touching = sin * out + np.array([0.0, 0.0, cos])
    c, s = np.cos(roll * sin)[..., None], np.sin(roll * sin)[..., None]
    return Line(
        direction=c * touching - flank * s * across,
        upwards=out - sin * touching,
        bend=flank * cos**2 * across,
        outwards=-s * touching - flank * c * across,
    )


def dot(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Dot product of vectors on the last axis."""
    return (first * second).sum(axis=-1)


@dataclass(frozen=True)
class BevelMesh:
    """Two gears and their shafts at rest, for n builds.

    Args:
        driver, driven: the gears.
        driver_shaft, driven_shaft: (n, 4, 4) world_from_shaft; nominally the apexes coincide, see nominal_shafts.
        driver_centre, driven_centre: (n, 2) [mm], centres off the axes, in the gears' frames.
    """

    driver: BevelNumbers
    driven: BevelNumbers
    driver_shaft: np.ndarray
    driven_shaft: np.ndarray
    driver_centre: np.ndarray
    driven_centre: np.ndarray

    def driven_from_driver(self, driver_angle: np.ndarray, driven_angle: np.ndarray) -> np.ndarray:
        """Poses (n, 4, 4) that take the driver gear's frame into the driven gear's."""
        driver = world_from_gears(self.driver_shaft, driver_angle, self.driver_centre)
        driven = world_from_gears(self.driven_shaft, driven_angle, self.driven_centre)
        return np.linalg.inv(driven) @ driver

    def between(self, near: float, far: float) -> "BevelMesh":
        """The same mesh with the driver's flanks cut to cone distances near ... far [mm]; a section if equal."""
        return replace(self, driver=replace(self.driver, face=(near, far)))


def nominal_shafts(shaft_angle: float, count: int) -> np.ndarray:
    """world_from_shaft of driver and driven, (2, count, 4, 4): apexes at the origin, the mesh at azimuth 0 of both."""
    driven = np.eye(4)
    driven[:3, :3] = Rotation.from_euler("y", shaft_angle).as_matrix() @ np.diag([-1.0, -1.0, 1.0])
    return np.stack([np.tile(np.eye(4), (count, 1, 1)), np.tile(driven, (count, 1, 1))])


def distances(
    mesh: "BevelMesh", driver_angle: np.ndarray, driven_angle: np.ndarray, flank: Flank
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Driver teeth (n, pairs), their distances to the mating flanks and those flanks' teeth, each (n, pairs)."""
    around = np.arange(-TEETH_EACH_SIDE, TEETH_EACH_SIDE + 1)
    teeth = np.round(-driver_angle / mesh.driver.pitch)[:, None] + around
    # the driven tooth that fills the space beside that flank: on rolling cones, half a pitch further
    azimuth = driver_angle[:, None] + mesh.driver.pitch * (teeth - flank / 2)
    mates = np.round((-azimuth * mesh.driver.teeth / mesh.driven.teeth - driven_angle[:, None]) / mesh.driven.pitch)
    pose = mesh.driven_from_driver(driver_angle, driven_angle)

    def distance(cone_distance: np.ndarray, roll: np.ndarray) -> np.ndarray:
        own, other = (numbers.reshape(*numbers.shape, *[1] * (roll.ndim - 2)) for numbers in (teeth, mates))
        points = mesh.driver.flank_points(cone_distance[..., None], roll, own, flank)
        flat = points.reshape(len(points), -1, 3) @ np.swapaxes(pose[:, :3, :3], 1, 2) + pose[:, None, :3, 3]
        return mesh.driven.signed_distance(flat.reshape(points.shape), other, flank)

    def along_the_face(cone_distance: np.ndarray) -> np.ndarray:
        begin, end = (np.full(cone_distance.shape, roll) for roll in mesh.driver.rolls)
        return zoomed_minimum(lambda roll: distance(cone_distance, roll), begin, end, (ROLL_POINTS, ROLL_ZOOMS))

    near, far = (np.full(teeth.shape, end) for end in mesh.driver.face)
    if mesh.driver.face[0] == mesh.driver.face[1]:
        return teeth, along_the_face(near), mates
    return teeth, zoomed_minimum(along_the_face, near, far, (CONE_POINTS, CONE_ZOOMS)), mates


def smallest_distance(
    mesh: "BevelMesh", driver_angle: np.ndarray, driven_angle: np.ndarray, flank: Flank
) -> np.ndarray:
    """Shortest distance (n,) [mm] of the driver's flanks of one side to the driven gear's, negative in overlap."""
    return distances(mesh, driver_angle, driven_angle, flank)[1].min(axis=1)


def turn_until_contact(
    mesh: "BevelMesh", driver_angle: np.ndarray, driven_angle: np.ndarray, flank: Flank
) -> np.ndarray:
    """Turn the driven gear until that flank side just touches; its angles (n,) [rad].

    Opening a right flank (sigma = +1) turns it counter-clockwise about its own axis. Secant steps after the first.
    """
    angle = np.array(driven_angle, dtype=float)
    rate = np.full(angle.shape, mesh.driver.face[1] * math.sin(mesh.driven.base_angle))
    last = None
    for _ in range(CONTACT_STEPS):
        distance = smallest_distance(mesh, driver_angle, angle, flank)
        if np.abs(distance).max() < CONTACT_XTOL:
            return angle
        if last is not None:
            turned = flank * (angle - last[0])
            secant = (distance - last[1]) / np.where(turned == 0.0, 1.0, turned)
            rate = np.where((secant > 0.5 * rate) & (secant < 2.0 * rate), secant, rate)
        last = angle, distance
        angle = angle - flank * distance / rate
    if np.abs(distance).max() < EDGE_JUMP:
        return _where_it_changes_sign(mesh, driver_angle, angle, flank)
    raise AssertionError(f"no contact: distances {distance}")


def _where_it_changes_sign(
    mesh: "BevelMesh", driver_angle: np.ndarray, driven_angle: np.ndarray, flank: Flank
) -> np.ndarray:
    """The turn (n,) at which the distance, which may jump at an edge there, stops being negative."""
    reach = EDGE_JUMP / (mesh.driver.face[0] * math.sin(mesh.driven.base_angle)) * flank
    closed, opened = driven_angle - 2 * reach, driven_angle + 2 * reach
    for _ in range(SIGN_HALVINGS):
        middle = (closed + opened) / 2
        free = smallest_distance(mesh, driver_angle, middle, flank) > 0.0
        closed, opened = np.where(free, closed, middle), np.where(free, middle, opened)
    return opened


def normal_backlash(
    mesh: "BevelMesh", driver_angle: np.ndarray, working_flank: Flank, gap_at: tuple[float, float] | None = None
) -> np.ndarray:
    """Distance [mm] of the non-working flanks while the driven gear is turned onto the working ones, (n,).

    Args:
        gap_at: cone distances (near, far) [mm] of the driver between which the gap is searched; None, all the face.
            Where the working flanks touch is decided by the face of `mesh`; for both at a section give
            mesh.between(R, R).
    """
    start = tooth_in_space(mesh, driver_angle)
    angle = turn_until_contact(mesh, driver_angle, start, working_flank)
    seen = mesh if gap_at is None else mesh.between(*gap_at)
    return smallest_distance(seen, driver_angle, angle, opposite(working_flank))


def tooth_in_space(mesh: "BevelMesh", driver_angle: np.ndarray) -> np.ndarray:
    """The driven gear's turn with a space at the mesh when the driver's tooth 0 is there, and rolling on."""
    return mesh.driven.pitch / 2 - driver_angle * mesh.driver.teeth / mesh.driven.teeth
