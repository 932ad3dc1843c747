"""Tolerances to contributors: what a deviation of each kind does to the parts. One function a kind."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import singledispatchmethod

from tol3d.gearing.effects import (
    NOTHING,
    AxesOffset,
    AxisOffset,
    AxisTilt,
    Clocking,
    Effect,
    Plane,
    ReducerBacklash,
    Temperature,
    Together,
    ToothThickness,
    TurningOffset,
)
from tol3d.gearing.grammar.moves import meshes_of
from tol3d.gearing.grammar.parts import BearingSpec, ShaftSpec
from tol3d.gearing.grammar.tolerances import (
    AxesOffsetSpec,
    AxialShiftSpec,
    AxisInPlaneSpec,
    AxisOutOfPlaneSpec,
    BearingClearanceSpec,
    CentreDistanceSpec,
    ClockingSpec,
    EccentricitySpec,
    MountingFaceSpec,
    ReducerBacklashSpec,
    RunOutSpec,
    ShaftAngleSpec,
    ShimSpec,
    TemperatureSpec,
    ToleranceSpec,
    ToothThicknessSpec,
)
from tol3d.gearing.model.contributor import Contributor, Planar, Scalar, Unit
from tol3d.gearing.model.layout import Layout
from tol3d.gearing.model.mesh import Mesh
from tol3d.gearing.model.shafts import Carried
from tol3d.gears import BevelPair
from tol3d.scene import Scene
from tol3d.scene.direction import At

Vector = tuple[float, float, float]

AROUND_X: Vector = (1.0, 0.0, 0.0)
AROUND_Y: Vector = (0.0, 1.0, 0.0)
AROUND_MINUS_Y: Vector = (0.0, -1.0, 0.0)
ALONG_Z: Vector = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class _Directed:
    """An effect of a deviation with a direction: an angle [rad], or None for a random one."""

    effect: Effect
    direction: float | None


@dataclass(frozen=True)
class Tolerances:
    """The tolerances of a scene, with the meshes in which they act."""

    scene: Scene
    meshes: Mapping[str, Mesh]
    layout: Layout

    def contributor(self, name: str, spec: ToleranceSpec) -> Contributor:
        """A tolerance as the simulation sees it.

        Raises:
            SceneError: of a shaft, or a bearing of one, on which no gear sits.
        """
        found = self._effect(spec)
        if (found.effect if isinstance(found, _Directed) else found) == NOTHING:
            shaft, *_ = spec.references()
            raise self.scene.refuse(
                ("tolerances", name, *shaft.path),
                f"expected a shaft with a gear on it, or a bearing of one, got {shaft.name!r}: nothing that meshes "
                "moves with it",
            )
        law = spec.distribution.resolve(self.scene.files)
        thickness = isinstance(spec, ShimSpec | ReducerBacklashSpec) or (
            isinstance(spec, BearingClearanceSpec) and not isinstance(found, _Directed)
        )
        return Contributor(
            name=name,
            kind=spec.kind,
            effect=found.effect if isinstance(found, _Directed) else found,
            draw=Planar(law, found.direction) if isinstance(found, _Directed) else Scalar(law),
            unit=_unit(spec),
            description=spec.description,
            least=0.0 if thickness else None,
        )

    def _mesh_of(self, gear: str, mesh: str | None = None) -> Mesh:
        return self.meshes[mesh or meshes_of(gear, self.scene.moves)[0]]

    @singledispatchmethod
    def _effect(self, spec: ToleranceSpec) -> Effect | _Directed:
        raise TypeError(f"tolerances.py has no function for {type(spec).__name__}")

    @_effect.register
    def _(self, spec: ToothThicknessSpec) -> Effect | _Directed:
        """Half the deviation on each flank: an arc s/2 is (s/2) cos(alpha) along the normal, or a turn of s/(2 r)."""
        mesh = self._mesh_of(spec.of)
        gear = mesh.gear(spec.of)
        cosine = gear.section_arm / gear.thickness_radius
        normal = 0.5 if spec.measured == "normal" else 0.5 * cosine
        if spec.along_face == "constant":
            return ToothThickness(spec.of, turn=0.0, offset=normal)
        turn = 0.5 / (gear.section_arm if spec.measured == "normal" else gear.thickness_radius)
        return ToothThickness(spec.of, turn=turn)

    @_effect.register
    def _(self, spec: EccentricitySpec) -> Effect | _Directed:
        return _Directed(TurningOffset(spec.of), _angle(spec.direction))

    @_effect.register
    def _(self, spec: RunOutSpec) -> Effect | _Directed:
        """Of a shaft: its direction is counted on the shaft, and every gear on it is displaced alike."""
        if not isinstance(self.scene.parts[spec.of], ShaftSpec):
            return _Directed(TurningOffset(spec.of), _angle(spec.direction))
        offsets = tuple(TurningOffset(own.gear, Plane(-own.phase, own.backward)) for own in self._carried(spec.of))
        return _Directed(_all_of(offsets), _angle(spec.direction))

    @_effect.register
    def _(self, spec: CentreDistanceSpec) -> Effect | _Directed:
        return AxisOffset(self.meshes[spec.of].driven, (1.0, 0.0, 0.0), mesh=spec.of)

    @_effect.register
    def _(self, spec: BearingClearanceSpec) -> Effect | _Directed:
        """Half the clearance, away from the mesh, at an azimuth of the frame at rest, or along the tooth force."""
        bearing = self.scene.parts[spec.of]
        if isinstance(bearing, BearingSpec):
            return self._of_bearing(bearing, spec)
        if spec.direction == "random":
            return _Directed(AxisOffset(spec.of, factor=0.5), None)
        azimuth = self._clearance_azimuth(spec, spec.of)
        return AxisOffset(spec.of, (_exact(math.cos(azimuth)), _exact(math.sin(azimuth)), 0.0), factor=0.5)

    def _clearance_azimuth(self, spec: BearingClearanceSpec, gear: str) -> float:
        """Which way the axis of a gear moves [rad], in its frame at rest on its shaft."""
        if isinstance(spec.direction, At):
            return spec.direction.at.internal
        mesh = self._mesh_of(gear, spec.mesh)
        towards = mesh.pair.mesh_azimuths[0 if gear == mesh.driver else 1]
        towards += mesh.azimuth if gear == mesh.driver else self.layout.seating(mesh.name).azimuth
        return towards + (math.pi if spec.direction == "apart" else _force_azimuth(mesh, gear))

    def _of_bearing(self, bearing: BearingSpec, spec: BearingClearanceSpec) -> Effect | _Directed:
        """The shaft's axis moves at the bearing by half the clearance, at its other bearings not at all.

        With one other bearing it turns about that one; alone a bearing moves the whole shaft.
        """
        at = bearing.at.internal
        parts = (part for part in self.scene.parts.values() if isinstance(part, BearingSpec))
        others = [part.at.internal for part in parts if part.shaft == bearing.shaft and part.at.internal != at]
        levers = [_Lever(own, at, others[0] if others else None) for own in self._carried(bearing.shaft)]
        if not levers:
            return NOTHING
        if spec.direction == "random":
            return _Directed(_all_of(tuple(effect for lever in levers for effect in lever.anywhere())), None)
        gear = next((lever.own for lever in levers if lever.own.gear in self._gears_of(spec)), levers[0].own)
        seen = self._clearance_azimuth(spec, gear.gear)
        azimuth = -seen if gear.backward and not isinstance(spec.direction, At) else seen
        return _all_of(tuple(effect for lever in levers for effect in lever.effects(azimuth)))

    def _gears_of(self, spec: BearingClearanceSpec) -> tuple[str, ...]:
        return (self.meshes[spec.mesh].driver, self.meshes[spec.mesh].driven) if spec.mesh else ()

    def _carried(self, shaft: str) -> list[Carried]:
        return [own for name, own in self.layout.carrying.values() if name == shaft]

    @_effect.register
    def _(self, spec: AxisInPlaneSpec) -> Effect | _Directed:
        return self._tilt(spec, AROUND_Y)

    @_effect.register
    def _(self, spec: AxisOutOfPlaneSpec) -> Effect | _Directed:
        return self._tilt(spec, AROUND_X)

    def _tilt(self, spec: AxisInPlaneSpec | AxisOutOfPlaneSpec, axis: Vector) -> Effect:
        mesh = self.meshes[spec.of]
        width = min(mesh.pair.pinion.face_width, mesh.pair.wheel.face_width)
        return AxisTilt(mesh.driven, axis, per_length=1.0 if _unit(spec) == "mrad" else 1.0 / width, mesh=spec.of)

    @_effect.register
    def _(self, spec: ShaftAngleSpec) -> Effect | _Directed:
        """Each gear sees the other one's axis on its +x side, so a turn about its -y opens the angle."""
        mesh = self.meshes[spec.of]
        if not isinstance(mesh.pair, BevelPair):
            raise TypeError(f"{spec.of} has no shaft angle")
        driver = spec.tilts == "driver"
        gear = mesh.pair.pinion if driver else mesh.pair.wheel
        return AxisTilt(
            mesh.driver if driver else mesh.driven,
            AROUND_MINUS_Y,
            per_length=1.0 if _unit(spec) == "mrad" else 1.0 / mesh.pair.mean_cone_distance,
            pivot=0.0 if spec.pivot == "apex" else gear.mean_cone_distance * math.cos(gear.pitch_angle),
            mesh=spec.of,
        )

    @_effect.register
    def _(self, spec: AxesOffsetSpec) -> Effect | _Directed:
        return AxesOffset(self.meshes[spec.of].driven, spec.of)

    @_effect.register
    def _(self, spec: AxialShiftSpec) -> Effect | _Directed:
        return AxisOffset(spec.of, ALONG_Z)

    @_effect.register
    def _(self, spec: MountingFaceSpec) -> Effect | _Directed:
        return AxisOffset(spec.of, ALONG_Z)

    @_effect.register
    def _(self, spec: ShimSpec) -> Effect | _Directed:
        return AxisOffset(spec.of, ALONG_Z, factor=-1.0 if spec.side == "behind" else 1.0)

    @_effect.register
    def _(self, spec: TemperatureSpec) -> Effect | _Directed:
        return Temperature(spec.of)

    @_effect.register
    def _(self, spec: ClockingSpec) -> Effect | _Directed:
        return Clocking(spec.of)

    @_effect.register
    def _(self, spec: ReducerBacklashSpec) -> Effect | _Directed:
        return ReducerBacklash(spec.of)


@dataclass(frozen=True)
class _Lever:
    """A gear on a shaft of which one point moves.

    Args:
        own: the gear on the shaft.
        moved: z of the point that moves [mm].
        fixed: z of one that does not; None where all of the shaft moves alike.
    """

    own: Carried
    moved: float
    fixed: float | None

    @property
    def share(self) -> float:
        """What the gear moves of what the point moves."""
        return 1.0 if self.fixed is None else (self.own.at - self.fixed) / (self.moved - self.fixed)

    def anywhere(self) -> Iterator[Effect]:
        """Shift and tilt of the gear's axis where the point moves by half a deviation with a direction on the shaft."""
        plane = Plane(mirrored=self.own.backward)
        yield AxisOffset(self.own.gear, factor=0.5 * self.share, plane=plane)
        if self.fixed is not None:
            per_length = 0.5 * self.own.sense / (self.moved - self.fixed)
            yield AxisTilt(self.own.gear, per_length=per_length, plane=plane)

    def effects(self, azimuth: float) -> Iterator[Effect]:
        """Shift and tilt of the gear's axis where the point moves by half a deviation, at an azimuth on the shaft."""
        sense = -1.0 if self.own.backward else 1.0
        x, y = _exact(math.cos(azimuth)), _exact(math.sin(azimuth))
        yield AxisOffset(self.own.gear, (x, sense * y, 0.0), factor=0.5 * self.share)
        if self.fixed is not None:
            # z of the shaft turns towards (x, y): about z cross (x, y) = (-y, x)
            per_length = 0.5 / (self.moved - self.fixed)
            yield AxisTilt(self.own.gear, (-y, sense * x, 0.0), per_length=per_length)


def _all_of(effects: tuple[Effect, ...]) -> Effect:
    return effects[0] if len(effects) == 1 else Together(effects)


def _unit(spec: ToleranceSpec) -> Unit:
    if isinstance(spec, ReducerBacklashSpec | ClockingSpec):
        return "arcmin"
    dimensions = {quantity.dimension for quantity in spec.distribution.quantities().values()}
    if dimensions == {"angle"}:
        return "mrad"
    return "K" if dimensions == {"temperature"} else "um"


def _angle(direction: object) -> float | None:
    return direction.at.internal if isinstance(direction, At) else None


def _force_azimuth(mesh: Mesh, gear: str) -> float:
    """Azimuth off the mesh [rad] of the radial part of the force on a gear by its mate's working flank.

    With the mesh at azimuth 0 the normal force is (-sin(alpha_w) cos(delta), sigma cos(alpha_w)) across the axis,
    sigma the driver's flank, for both gears: each sees the other push it away and around.
    """
    alpha, flank = mesh.pair.working_pressure_angle, float(mesh.working_flank)
    return math.atan2(flank * math.cos(alpha), -math.sin(alpha) * math.cos(mesh.gear(gear).pitch_angle))


def _exact(cosine: float) -> float:
    """A cosine or sine of a right angle as 0 or 1, not 6e-17 off."""
    return round(cosine) + 0.0 if abs(cosine - round(cosine)) < 1e-15 else cosine
