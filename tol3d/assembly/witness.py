"""The witness of assemblies: gaps of round surfaces and clearances of parts by FCL, at the poses of the exact method.

A round surface is a ball or a cylinder of FCL's, smaller than it is by a known amount that is taken off again: so
surfaces that overlap by less than that have a gap below 0 as they should. Clearances are read of meshes of half the
step.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from tol3d.assembly.clearances.distances import SolidDistances
from tol3d.assembly.clearances.pair import SolidPair
from tol3d.assembly.model import Assembly, Feature, Measured
from tol3d.assembly.placing import method as placing
from tol3d.assembly.placing.actual_feature import actual_size
from tol3d.assembly.placing.surfaces import over
from tol3d.assembly.witnessed import reads
from tol3d.cad.solids.distance import NearestPoints, Surface, cylinder, mesh_surface, put, sphere
from tol3d.numerics.arrays import Array
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import Answers
from tol3d.study.system.trials import Trials

CORE: Final = 0.5
"""Fraction of its nominal radius of which a surface is made; so much may overlap."""
POINT: Final = 1e-3
"""mm; radius of the ball that stands for a point."""
FAR: Final = 1e4
"""mm; length of a cylinder beside a ball and size of a plane, which have no ends."""
ALLOWANCE: Final = 1e-5
"""mm; where FCL's iterations between bodies without triangles end, with room."""
FEW: Final = 1e-9
"""mm; rounding of distances of triangles."""


@dataclass(frozen=True)
class FclWitness:
    """Implements WitnessMethod.

    Args:
        assembly: the model.
        given: pairs of solids of the method that is witnessed, by measure.
        finer: the same with meshes of half the step.
    """

    assembly: Assembly
    given: Mapping[str, SolidPair]
    finer: Mapping[str, SolidPair]

    @property
    def chord_error(self) -> float:
        """See Method: that of the finer meshes."""
        return max((pair.chord_error for pair in self.finer.values()), default=0.0)

    def reads(self, measure: Measure) -> bool:
        """See WitnessMethod."""
        return reads(self.assembly, measure.name)

    def bounds(self, measure: Measure) -> tuple[float, float]:
        """See WitnessMethod: of a clearance the chord errors of both meshes, one of each method."""
        if measure.name in self.finer:
            chords = self.given[measure.name].chord_error + self.finer[measure.name].chord_error
            return chords * measure.per_internal, FEW * measure.per_internal
        return 0.0, ALLOWANCE * measure.per_internal

    def answers(self, trials: Trials, measures: Sequence[Measure]) -> Answers:
        """See Method; statuses of gaps are those of the moves."""
        names = [measure.name for measure in measures]
        read = placing.values(self.assembly, trials.deviations, names, SolidDistances(self.finer))
        values, status = {}, {}
        for name, (own, codes) in read.items():
            measured = self.assembly.measures[name]
            found = own if measured.reads.by_solids else self._gaps(measured, trials.deviations)
            values[name], status[name] = np.where(codes == 0, found, np.nan)[:, None], codes
        return Answers(values, status=status)

    def _gaps(self, measured: Measured, deviations: Array) -> Array:
        """Gaps between two surfaces (trials,) [mm]; NaN where their parts are not placed."""
        start, end = (self.assembly.features[name] for name in measured.features)
        frames = placing.features_placed(self.assembly, deviations, measured.after)
        bodies = _bodies(start, end)
        radii = [_radius(own, deviations) for own in (start, end)]
        if bodies[0].on_plane or bodies[1].on_plane:
            own, other = (np.asarray(frames[feature.name])[:, :3, 2] for feature in (start, end))
            sines = np.linalg.norm(np.cross(own, other), axis=1)  # a leaning cylinder stands on its rim
            radii = [radius * sines for radius in radii]
        taken = np.zeros(len(deviations)) + sum(radii) - sum(body.radius for body in bodies)
        nearest, found = NearestPoints(), np.full(len(deviations), np.nan)
        for k, (first, second) in enumerate(zip(frames[start.name], frames[end.name], strict=True)):
            if np.isfinite(first).all() and np.isfinite(second).all():
                surfaces = [
                    body.surface if body.on_plane is None else _over(body.on_plane, placed, plane)
                    for body, placed, plane in zip(bodies, (first, second), (second, first), strict=True)
                ]
                put(surfaces[0], first[:3, :3], first[:3, 3])
                put(surfaces[1], second[:3, :3], second[:3, 3])
                distance = nearest.of(*surfaces).distance
                found[k] = distance - taken[k] if distance > 0.0 else np.nan
        return found


def _bodies(start: Feature, end: Feature) -> tuple["_Body", "_Body"]:
    """Bodies that represent two surfaces.

    Cylinders beside each other and over planes are represented by their axes, from end to end or over the plane:
    between cylinders FCL converges to some micrometres only.
    """
    match start.shape.surface, end.shape.surface:
        case "plane", "axis":
            return _plane(), replace(_line(end), on_plane=(end, start))
        case "axis", "plane":
            return replace(_line(start), on_plane=(start, end)), _plane()
        case "plane", _:
            return _plane(), _ball(end)
        case _, "plane":
            return _ball(start), _plane()
        case "axis", "axis":
            return _line(start), _line(end)
        case "axis", _:
            return _cylinder(start), _ball(end)
        case _, "axis":
            return _ball(start), _cylinder(end)
    return _ball(start), _ball(end)


def _over(pair: tuple[Feature, Feature], line: Array, plane: Array) -> Surface:
    """The part of a cylinder's axis that is over a plane, from the frames of both (4, 4)."""
    shape, flat = (own.shape for own in pair)
    (half,) = shape.reach
    places = (own @ plane[:3, :2] for own in (line[:3, 3] - plane[:3, 3], half * line[:3, 2]))
    low, high = over(flat, *(place[:, None] for place in places))
    return _segment(half * float(low[0]), half * float(high[0]))


def _radius(feature: Feature, deviations: Array) -> Array:
    """In its trials (trials,) or (1,) [mm]; 0 of a plane and of a point."""
    return np.asarray(actual_size(feature, deviations.T) / 2)


@dataclass(frozen=True, eq=False)
class _Body:
    """Body that represents a surface, and its radius [mm].

    Args:
        on_plane: of a cylinder over a plane, both features; its axis is cut to the plane's extent in each trial.
    """

    surface: Surface
    radius: float
    on_plane: tuple[Feature, Feature] | None = None


def _plane() -> _Body:
    corners = FAR * np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
    return _Body(mesh_surface(corners, np.array([[0, 1, 2], [0, 2, 3]])), 0.0)


def _line(feature: Feature) -> _Body:
    """Its axis."""
    (half,) = feature.shape.reach
    return _Body(_segment(-half, half), 0.0)


def _segment(low: float, high: float) -> Surface:
    """Part of a z axis, as a triangle without an area."""
    points = np.array([[0.0, 0.0, low], [0.0, 0.0, high], [0.0, 0.0, low + 0.6 * (high - low)]])
    return mesh_surface(points, np.array([[0, 1, 2]]))


def _core(feature: Feature) -> float:
    return max(CORE * (feature.shape.nominal_size or 0.0) / 2, POINT)


def _ball(feature: Feature) -> _Body:
    return _Body(sphere(_core(feature)), _core(feature))


def _cylinder(feature: Feature) -> _Body:
    return _Body(cylinder(_core(feature), FAR), _core(feature))
