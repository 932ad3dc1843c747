"""The witness: distances between measuring strips of the CAD flanks, by the Flexible Collision Library (FCL).

Each tooth flank is one bounding volume hierarchy of full-width strips. FCL gives no depth of overlap, so the strips are
pulled inward by a slack along their normals, and both nearest points are moved back afterwards by the same amounts: the
gap is their distance along the line on which FCL found them. The flanks may overlap by up to both slacks before the
distance reaches zero. Between flanks that line is the normal of both, and the shift back is the slack. A touching edge
(a tip, an end of the face) was pulled along a normal of its own, delta off that line, and comes back beside it by slack
sin delta, where the other flank has curved away by (slack sin delta)^2/(2 r): that is added. The remaining error is
0.0073 um per millimetre of module at delta = 0.46 rad.

All lengths here scale with the module, so that geometrically similar gears have similar gaps.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from tol3d.cad.solids import WHOLE_FACE, FlankStrips, PulledStrip, Span
from tol3d.cad.solids.distance import NearestPoints, Surface, mesh_surface, put
from tol3d.gearing.builds.build import Build
from tol3d.gearing.builds.flank_offsets import FlankPlaces, flank_slot
from tol3d.gearing.effects import FORM, HELIX, SHAPES, SLOPE, UNIFORM
from tol3d.gearing.engines.gaps import Gaps, Teeth
from tol3d.gearing.model import Mesh, Model
from tol3d.gears import Flank
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.numerics import frames
from tol3d.numerics.arrays import Array

Numbers = tuple[float, ...]
"""Coefficients of one flank [mm], SHAPES of them; empty for a flank like all others of its gear."""


@dataclass(frozen=True, eq=False)
class DeviatedStrips:
    """The strips of a model's gears, moved along their normals by each flank's deviation.

    Strips are rebuilt for each flank with its own deviations, trial by trial. Both ends of a generator are moved, so
    that a flank with a helix deviation stays ruled.

    Args:
        model: gears and meshes.
        strips: nominal ones of every gear by name, sampled from its solid.
        places: indices of the coefficients of flanks.
    """

    model: Model
    strips: Mapping[str, FlankStrips]
    places: FlankPlaces

    def numbers(self, build: Build, seat: int, row: int, tooth: int, flank: Flank) -> Numbers:
        """Coefficients [mm] of a flank in a row of builds; `tooth` is counted as in the mesh."""
        gear_seat = self.model.seats[seat]
        if build.flanks is None or gear_seat.gear not in self.places.starts:
            return ()
        gear = self.model.gear(gear_seat.gear).gear
        ahead = round(gear_seat.ahead / gear.angular_pitch)
        slot = self.places.starts[gear_seat.gear] + int(flank_slot(gear.teeth, tooth - ahead, flank))
        return tuple(build.flanks.values[build.flanks.row[row], slot : slot + SHAPES].tolist())

    def of(self, gear: str, flank: Flank, numbers: Numbers) -> FlankStrips:
        """The strips of a gear, one flank deviated by its coefficients [mm]."""
        strips = self.strips[gear]
        if not any(numbers):
            return strips
        begin, end = self.places.spans[gear]
        own, normals = self.model.gear(gear).gear, strips.normals[flank]
        if isinstance(own, CylindricalGear) and own.helix_angle:
            # along a generator roll and height change: each end is moved by what it is there, a straight change
            moved = []
            for ends in (strips.inner, strips.outer):
                points = ends[flank]
                rolls = np.sqrt(np.maximum((points[:, 0] ** 2 + points[:, 1] ** 2) / own.base_radius**2 - 1, 0.0))
                out = numbers[UNIFORM] + numbers[SLOPE] * (rolls - (begin + end) / 2) / (end - begin)
                out = out + numbers[HELIX] * points[:, 2] / own.face_width
                moved.append({**ends, flank: points + out[:, None] * normals})
            return replace(strips, inner=moved[0], outer=moved[1])
        roll = strips.parameter
        u = (roll - (begin + end) / 2) / (end - begin)
        waves = self.places.waves[gear]
        form = np.cos(2 * math.pi * waves * u) / 2 if waves else 1 / 3 - 4 * u * u
        level = numbers[UNIFORM] + numbers[SLOPE] * u + numbers[FORM] * form
        inner, outer = (
            {**ends, flank: ends[flank] + (level + sense * numbers[HELIX] / 2)[:, None] * normals}
            for ends, sense in ((strips.inner, -1.0), (strips.outer, 1.0))
        )
        return replace(strips, inner=inner, outer=outer)


SLACK = 0.012  # modules a flank; deep enough for any start of the turn, small against the curvature radius
MESHES_KEPT = 64  # strips kept for reuse; one per flank at constant temperature, more with single-flank deviations
SECTION_WIDTH = 0.8e-3  # modules along the face; at module 2.5 a gap that grows by 1 um per mm is 0.001 um off
LAST_STEP = 0.2e-3  # modules; the gap is linear in the turn to 0.4e-6 modules over it
OUT_OF_REACH = 0.4e-3  # modules; below this distance the normal is lost: the overlap is as deep as both slacks


class FclEngine:
    """Gaps from the measuring strips of every gear of a model.

    FCL's objects do not pickle: the engine is made in the worker.

    Args:
        model: gears and meshes.
        strips: measuring strips of each gear by name, sampled from its solid.
    """

    def __init__(self, model: Model, strips: Mapping[str, FlankStrips]) -> None:
        self._model = model
        self._strips = strips
        self._deviated = DeviatedStrips(model, strips, FlankPlaces.of(model))
        self._nearest = NearestPoints()
        # two caches: a gear between two others is held in one mesh and moved in the other, and an object has one pose
        self._held = lru_cache(maxsize=MESHES_KEPT)(self._make_object)
        self._moved = lru_cache(maxsize=MESHES_KEPT)(self._make_object)

    def depth(self, mesh: Mesh) -> float:
        """Overlap [mm] that can still be measured: the slack of both flanks less OUT_OF_REACH."""
        return (2 * SLACK - OUT_OF_REACH) * _module(mesh)

    def last_step(self, mesh: Mesh) -> float:
        """See LAST_STEP [mm]."""
        return LAST_STEP * _module(mesh)

    @property
    def chord_error(self) -> float:
        """Largest sagitta [mm] of a strip's steps; a pair's gap is too large by at most the sum of two."""
        return max(strips.chord_error for strips in self._strips.values())

    def _make_object(self, gear: str, flank: Flank, scale: float, span: Span, numbers: Numbers = ()) -> Surface:
        return mesh_surface(*self._strip(gear, flank, span, numbers).mesh(scale))

    def _strip(self, gear: str, flank: Flank, span: Span, numbers: Numbers = ()) -> PulledStrip:
        slack = SLACK * self._model.gear(gear).gear.module
        return PulledStrip(self._deviated.of(gear, flank, numbers), flank, slack, span)

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
        driven_teeth, mating = mesh.pair.mating_teeth(driver_teeth, flank), mesh.pair.mating_flank(flank)
        driver_rotation, driver_origin = self._flank_poses(build, driver, angles[0], driver_teeth, flank)
        driven_rotation, driven_origin = self._flank_poses(build, driven, angles[1], driven_teeth, mating)
        world_to_driver = frames.transposed(driver_rotation)
        rotation = frames.matmul(world_to_driver, driven_rotation)
        translation = frames.apply(world_to_driver, (driven_origin - driver_origin)[:, None])

        distance = np.full(wanted.shape, np.nan)
        points = np.full((*wanted.shape, 2, 3), np.nan)
        triangles = np.zeros((*wanted.shape, 2), dtype=np.int64)
        nearest = self._nearest.of
        scales = build.scale
        span = self._section(mesh) if section else WHOLE_FACE
        at = np.nonzero(wanted)
        shapes = (
            self._shapes(build, driver, at[0], driver_teeth[at], flank),
            self._shapes(build, driven, at[0], driven_teeth[at], mating),
        )
        for row, pair, driver_shape, driven_shape in zip(*at, *shapes, strict=True):
            fixed = self._held(mesh.driver, flank, scales[row, driver], span, driver_shape)
            moved = self._moved(mesh.driven, mating, scales[row, driven], WHOLE_FACE, driven_shape)
            put(moved, rotation[row, pair], translation[row, pair])
            distance[row, pair], points[row, pair], triangles[row, pair] = nearest(fixed, moved)
        back, curvature = np.full(points.shape, np.nan), np.full((*wanted.shape, 2), np.nan)
        at_end = np.zeros(wanted.shape, dtype=bool)
        poses = ((np.eye(3), np.zeros(3)), (rotation[at], translation[at]))
        gears = ((mesh.driver, driver, span, flank), (mesh.driven, driven, WHOLE_FACE, mating))
        for side, ((gear, seat, width, side_flank), (turn, shift), side_shapes) in enumerate(
            zip(gears, poses, shapes, strict=True)
        ):
            scale, triangle = scales[at[0], seat], triangles[..., side][at]
            in_gear = frames.apply(frames.transposed(turn), points[..., side, :][at] - shift)
            strips = [(self._strip(gear, side_flank, width, shape), rows) for shape, rows in _alike(side_shapes)]
            put_back, bent, ends = read_strips(strips, scale, triangle, in_gear)
            back[..., side, :][at] = frames.apply(turn, put_back)
            curvature[..., side][at] = bent
            at_end[at] |= ends
        result = Found(distance, points, back, curvature, distance < OUT_OF_REACH * _module(mesh), at_end)
        return result.gaps(build.flank_offset[:, [driver, driven]], (driver_rotation, driver_origin), driver_teeth)

    def _shapes(self, build: Build, seat: int, rows: Teeth, teeth: Teeth, flank: Flank) -> list[Numbers]:
        """Single-flank coefficients of a gear for the requested pairs (pairs,)."""
        pairs = zip(rows.tolist(), teeth.tolist(), strict=True)
        return [self._deviated.numbers(build, seat, row, tooth, flank) for row, tooth in pairs]

    def _section(self, mesh: Mesh) -> Span:
        """Part of the driver's face, SECTION_WIDTH modules wide, in the middle of the common face."""
        half = SECTION_WIDTH * _module(mesh) / (2 * mesh.pair.pinion.face_width)
        return mesh.pair.pinion_section - half, mesh.pair.pinion_section + half

    def _flank_poses(self, build: Build, gear: int, angle: Array, teeth: Teeth, flank: Flank) -> tuple[Array, Array]:
        """Poses of the flanks of some teeth: the tooth's pose, turned by the flank's own turn.

        For an involute a thickness deviation is exactly such a turn: parallel involutes are one involute turned.
        """
        seat = self._model.seats[gear]
        pitch = self._model.gear(seat.gear).gear.angular_pitch
        return build.tooth_pose(gear, angle, pitch * teeth - flank * build.flank_turn[:, gear, None])


@dataclass(frozen=True)
class Found:
    """FCL's result between pulled strips, in the frames of the driver's flanks.

    Args:
        distance: (trials, pairs) [mm].
        points: (trials, pairs, 2, 3) [mm], nearest points on driver and driven.
        back: (trials, pairs, 2, 3) [mm], shift of each point back onto its flank.
        curvature: (trials, pairs, 2), of the flanks there [1/mm].
        deep: (trials, pairs), True where the overlap is too deep for the distance to mean anything.
        at_end: (trials, pairs), True where either point is at an end of its flank.
    """

    distance: Array
    points: Array
    back: Array
    curvature: Array
    deep: NDArray[np.bool_]
    at_end: NDArray[np.bool_]

    def gaps(self, offsets: Array, driver_pose: tuple[Array, Array], driver_teeth: Teeth) -> Gaps:
        """Signed gaps; flanks offset along their normals stay parallel, so that the gap is less by the offsets.

        Args:
            offsets: of the flanks of driver and driven along their normals (trials, 2) [mm].
            driver_pose: rotations and origins of the driver's flanks in the world.
            driver_teeth: the driver's teeth (trials, pairs).
        """
        safe = np.where(self.deep | np.isnan(self.distance), np.nan, self.distance)
        normal = (self.points[..., 1, :] - self.points[..., 0, :]) / safe[..., None]
        along = (self.back * normal[..., None, :]).sum(axis=-1)
        beside = (self.back**2).sum(axis=-1) - along**2
        # each flank curves away where the other's edge was moved back beside the line: the driver's against the normal
        away = np.array([-0.5, 0.5]) * beside[..., ::-1] * self.curvature
        moved = self.back + away[..., None] * normal[..., None, :]
        opened = along + away
        rotation, origin = driver_pose
        in_world = frames.apply(rotation, normal)
        first, second = (
            frames.apply(rotation, self.points[..., side, :] + moved[..., side, :]) + origin[:, None] for side in (0, 1)
        )
        return Gaps(
            value=safe + opened[..., 1] - opened[..., 0] - offsets.sum(axis=1)[:, None],
            deep=self.deep,
            at_end=self.at_end,
            driver_point=first + offsets[:, 0, None, None] * in_world,
            driven_point=second - offsets[:, 1, None, None] * in_world,
            normal=in_world,
            driver_teeth=driver_teeth,
        )


def _alike(shapes: Sequence[Numbers]) -> Iterator[tuple[Numbers, NDArray[np.intp]]]:
    """Each distinct shape of flanks, with the indices at which it occurs."""
    places: dict[Numbers, list[int]] = {}
    for place, shape in enumerate(shapes):
        places.setdefault(shape, []).append(place)
    for shape, indices in places.items():
        yield shape, np.array(indices, dtype=np.intp)


def read_strips(
    strips: Sequence[tuple[PulledStrip, NDArray[np.intp]]], scale: Array, triangle: Teeth, point: Array
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Shifts of points (n, 3) back onto their flanks, curvatures there (n,), and flags of flank ends (n,).

    Args:
        strips: with the indices of the points on each.
        scale, triangle, point: as in PulledStrip.
    """
    back, curvature, at_end = np.empty_like(point), np.empty_like(scale), np.empty(scale.shape, dtype=bool)
    for strip, rows in strips:
        back[rows] = strip.put_back(scale[rows], triangle[rows], point[rows])
        curvature[rows] = strip.curvature(scale[rows], triangle[rows])
        at_end[rows] = strip.at_end(scale[rows], point[rows])
    return back, curvature, at_end


def _module(mesh: Mesh) -> float:
    return mesh.pair.pinion.module
