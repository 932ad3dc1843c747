"""The witness: distances between measuring strips of the CAD flanks, by the Flexible Collision Library.

One BVH a tooth flank, as full-width strips. FCL tells no depth of overlap, so the strips are pulled
inward by SLACK along their normals and the gap is the distance less the slack of both: the flanks may
overlap by up to twice the slack and the distance stays away from zero. A tip edge is pulled in along its
own normal; where it touches a flank whose normal differs by delta, the gap reads SLACK (1 - cos delta)
too little: 0.03 um at 0.045 rad, as gears 700 ppm apart in pitch have it.
"""

from collections.abc import Mapping
from functools import lru_cache

import fcl
import numpy as np
from numpy.typing import NDArray

from tol3d import frames
from tol3d.build import Build
from tol3d.engines.gaps import Array, Gaps, Teeth
from tol3d.gears import Flank
from tol3d.model import Mesh, Model
from tol3d.solids import WHOLE_FACE, FlankStrips, Span, strip_mesh

SLACK = 0.030  # mm a flank; deep enough for any start of the turn, small against the curvature radius
MESHES_KEPT = 64  # grown strips kept for reuse; a constant temperature needs one a flank
SECTION_WIDTH = 2e-3  # mm along the face; a gap that grows with it by 1 um a mm is read 0.001 um off
LAST_STEP = 0.5e-3  # mm
OUT_OF_REACH = 1e-3  # mm; a distance below this has lost its normal: the overlap is as deep as the slack


class FclEngine:
    """Gaps from the measuring strips of every gear of a model.

    Args:
        model: gears and meshes.
        strips: measuring strips of each gear by name, sampled from its solid.

    FCL's objects do not pickle: make the engine in the worker.
    """

    def __init__(self, model: Model, strips: Mapping[str, FlankStrips]) -> None:
        self._model = model
        self._strips = strips
        self._request = fcl.DistanceRequest(enable_nearest_points=True)
        # apart: a gear between two others is held in one mesh and moved in the other, and an object keeps its place
        self._held = lru_cache(maxsize=MESHES_KEPT)(self._make_object)
        self._moved = lru_cache(maxsize=MESHES_KEPT)(self._make_object)

    @property
    def depth(self) -> float:
        """Overlap [mm] that can still be measured: the slack of both flanks."""
        return 2 * SLACK - OUT_OF_REACH

    @property
    def last_step(self) -> float:
        """0.5e-3 mm: the gap is linear in the turn to 1e-6 mm over it."""
        return LAST_STEP

    @property
    def chord_error(self) -> float:
        """Largest sagitta [mm] of a strip's steps; a pair's gap is at most the sum of two too large."""
        return max(strips.chord_error for strips in self._strips.values())

    def _make_object(self, gear: str, flank: Flank, scale: float, span: Span) -> fcl.CollisionObject:
        vertices, triangles = strip_mesh(self._strips[gear], flank, SLACK, scale, span)
        hierarchy = fcl.BVHModel()
        hierarchy.beginModel(len(vertices), len(triangles))
        hierarchy.addSubModel(vertices, triangles)
        hierarchy.endModel()
        return fcl.CollisionObject(hierarchy, fcl.Transform())

    def gaps(
        self,
        build: Build,
        mesh: Mesh,
        flank: Flank,
        angles: tuple[Array, Array],
        driver_teeth: Teeth,
        wanted: NDArray[np.bool_],
        *,
        section: bool = False,
    ) -> Gaps:
        """See Engine.gaps."""
        driver, driven = (self._model.seat_index[mesh.name, gear] for gear in (mesh.driver, mesh.driven))
        driven_teeth = mesh.pair.mating_teeth(driver_teeth, flank)
        driver_rotation, driver_origin = self._flank_poses(build, driver, angles[0], driver_teeth, flank)
        driven_rotation, driven_origin = self._flank_poses(build, driven, angles[1], driven_teeth, flank)
        world_to_driver = frames.transposed(driver_rotation)
        rotation = frames.matmul(world_to_driver, driven_rotation)
        translation = frames.apply(world_to_driver, (driven_origin - driver_origin)[:, None])

        distance = np.full(wanted.shape, np.nan)
        points = np.full((*wanted.shape, 2, 3), np.nan)
        request = self._request
        scales = build.scale
        span = self._section(mesh) if section else WHOLE_FACE
        for row, pair in zip(*np.nonzero(wanted), strict=True):
            fixed = self._held(mesh.driver, flank, scales[row, driver], span)
            moved = self._moved(mesh.driven, flank, scales[row, driven], WHOLE_FACE)
            moved.setTransform(fcl.Transform(rotation[row, pair], translation[row, pair]))
            result = fcl.DistanceResult()
            distance[row, pair] = fcl.distance(fixed, moved, request, result)
            points[row, pair] = result.nearest_points
        offsets = build.flank_offset[:, [driver, driven]]
        return self._gaps(distance, offsets, points, (driver_rotation, driver_origin), driver_teeth)

    def _section(self, mesh: Mesh) -> Span:
        """A strip of the driver's face, SECTION_WIDTH wide, in the middle of the common face."""
        half = SECTION_WIDTH / (2 * mesh.pair.pinion.face_width)
        return mesh.pair.pinion_section - half, mesh.pair.pinion_section + half

    def _flank_poses(self, build: Build, gear: int, angle: Array, teeth: Teeth, flank: Flank) -> tuple[Array, Array]:
        """Poses of the flanks of some teeth: the tooth's place, turned by the flank's own turn.

        For an involute that turn is a thickness deviation exactly: parallel involutes are one involute turned.
        """
        seat = self._model.seats[gear]
        pitch = self._model.gear(seat.gear).gear.angular_pitch
        return build.tooth_pose(gear, angle, pitch * teeth - flank * build.flank_turn[:, gear, None])

    @staticmethod
    def _gaps(
        distance: Array, offsets: Array, points: Array, driver_pose: tuple[Array, Array], driver_teeth: Teeth
    ) -> Gaps:
        """Signed gaps of distances; flanks offset along their normals are parallel, so that the gap is less by that."""
        deep = distance < OUT_OF_REACH
        safe = np.where(deep | np.isnan(distance), np.nan, distance)
        rotation, origin = driver_pose
        first = frames.apply(rotation, points[..., 0, :]) + origin[:, None]
        second = frames.apply(rotation, points[..., 1, :]) + origin[:, None]
        normal = (second - first) / safe[..., None]
        return Gaps(
            value=safe - 2 * SLACK - offsets.sum(axis=1)[:, None],
            deep=deep,
            driver_point=first + (SLACK + offsets[:, 0, None, None]) * normal,
            driven_point=second - (SLACK + offsets[:, 1, None, None]) * normal,
            normal=normal,
            driver_teeth=driver_teeth,
        )
