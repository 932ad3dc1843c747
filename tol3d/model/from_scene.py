"""Scene to model: text becomes meaning, units become mm and rad, gears become geometry or are refused."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import singledispatchmethod

from tol3d.errors import GeometryError
from tol3d.gears import LEFT, RIGHT, SpurGear, SpurPair
from tol3d.model.contributor import (
    AxisOffset,
    AxisTilt,
    Contributor,
    Effect,
    Planar,
    Scalar,
    Temperature,
    ToothThickness,
    TurningOffset,
    Unit,
)
from tol3d.model.measure import Backlash, Measure, Positions
from tol3d.model.model import GearPart, Housing, Mesh, Model, Study
from tol3d.scene import Scene
from tol3d.scene.direction import At
from tol3d.scene.measures import MeasureSpec, MeasureUnion
from tol3d.scene.moves import MeshSpec
from tol3d.scene.parts import HousingSpec, SpurGearSpec
from tol3d.scene.tolerances import (
    AxialShiftSpec,
    AxisInPlaneSpec,
    AxisOutOfPlaneSpec,
    BearingClearanceSpec,
    CentreDistanceSpec,
    EccentricitySpec,
    RunOutSpec,
    TemperatureSpec,
    ToleranceSpec,
    ToothThicknessSpec,
)
from tol3d.units import Quantity

AROUND_X, AROUND_Y, ALONG_Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def model_from_scene(scene: Scene) -> Model:
    """What a scene means.

    Raises:
        SceneError: gears that cannot be made or run together, with their numbers and place.
    """
    gears = tuple(_gear(scene, name, part) for name, part in scene.parts.items() if isinstance(part, SpurGearSpec))
    housings = tuple(
        Housing(name, _internal(part.expansion)) for name, part in scene.parts.items() if isinstance(part, HousingSpec)
    )
    by_name = {part.name: part.gear for part in gears}
    _refuse_shared_gears(scene)
    meshes = tuple(_mesh(scene, name, move, by_name) for name, move in scene.moves.items())
    _refuse_idle_gears(scene)
    interpreter = _Tolerances(scene, {mesh.name: mesh for mesh in meshes})
    return Model(
        name=scene.scene,
        gears=gears,
        housings=housings,
        contributors=tuple(interpreter.contributor(name, spec) for name, spec in scene.tolerances.items()),
        meshes=meshes,
        measures=tuple(
            _measure(name, spec, next(mesh for mesh in meshes if mesh.name == spec.of))
            for name, spec in scene.measures.items()
        ),
        study=Study(**scene.study.model_dump()),
        published=_published(scene),
        warnings=tuple(_warnings(meshes)),
    )


def _internal(quantity: Quantity | None, otherwise: float = 0.0) -> float:
    return otherwise if quantity is None else quantity.internal


def _gear(scene: Scene, name: str, spec: SpurGearSpec) -> GearPart:
    try:
        gear = SpurGear(
            teeth=spec.teeth,
            module=spec.module.internal,
            pressure_angle=spec.pressure_angle.internal,
            face_width=spec.face_width.internal,
            profile_shift=spec.profile_shift,
            addendum=spec.addendum,
            dedendum=spec.dedendum,
            root_fillet=None if spec.root_fillet is None else spec.root_fillet.internal,
            bore=_internal(spec.bore),
        )
    except GeometryError as error:
        raise scene.refuse(("parts", name), str(error)) from None
    return GearPart(name, gear, _internal(spec.expansion))


def _refuse_shared_gears(scene: Scene) -> None:
    for name in scene.parts:
        meshes = scene.meshes_of(name)
        if len(meshes) > 1:
            raise scene.refuse(
                ("moves", meshes[1]),
                f"{name!r} is in {' and '.join(map(repr, meshes))}; a gear can be in one mesh only so far",
            )


def _refuse_idle_gears(scene: Scene) -> None:
    for name, part in scene.parts.items():
        if isinstance(part, SpurGearSpec) and not scene.meshes_of(name):
            raise scene.refuse(("parts", name), f"{name!r} takes part in no move; put it into a mesh or take it out")


def _mesh(scene: Scene, name: str, spec: MeshSpec, gears: dict[str, SpurGear]) -> Mesh:
    try:
        pair = SpurPair(gears[spec.driver], gears[spec.driven], spec.centre_distance.internal)
        pair.refuse_interference()
    except GeometryError as error:
        raise scene.refuse(("moves", name, "centre_distance"), str(error)) from None
    return Mesh(
        name=name,
        driver=spec.driver,
        driven=spec.driven,
        pair=pair,
        working_flank=RIGHT if spec.working_flank == "right" else LEFT,
        housing=spec.housing,
    )


def _warnings(meshes: tuple[Mesh, ...]) -> Iterator[str]:
    for mesh in meshes:
        for name, gear in ((mesh.driver, mesh.pair.pinion), (mesh.driven, mesh.pair.wheel)):
            if gear.undercut_radius > gear.base_radius:
                yield (
                    f"{name}: a rack of addendum 1 undercuts it below profile_shift {gear.undercut_limit_shift:.4f}; "
                    f"its flank is lost up to {2 * gear.undercut_radius:.4f} mm, below the flank in use"
                )


def _measure(name: str, spec: MeasureUnion, mesh: Mesh) -> Measure:
    gear = getattr(spec, "gear", None) or mesh.driven
    return Measure(
        name=name,
        kind=Backlash(spec.kind, mesh.name, gear),
        positions=_positions(spec, mesh),
        take=spec.take,
        lower_limit=None if spec.lower_limit is None else spec.lower_limit.internal,
        upper_limit=None if spec.upper_limit is None else spec.upper_limit.internal,
    )


def _positions(spec: MeasureSpec, mesh: Mesh) -> Positions:
    if isinstance(spec.over, At):
        return Positions("at", 1, 1, spec.over.at.internal)
    if spec.over == "random":
        return Positions("random", mesh.pair.long_period_turns, 1)
    turns = 1 if spec.over == "turn" else mesh.pair.long_period_turns
    return Positions(spec.over, turns, turns * spec.positions)


def _published(scene: Scene) -> dict[str, dict[str, dict[str, object]]]:
    return {
        column: {
            measure: {
                **{key: quantity.internal for key, quantity in values.quantities().items()},
                **({"contributors": dict(values.contributors)} if values.contributors else {}),
            }
            for measure, values in measures.items()
        }
        for column, measures in scene.published.items()
    }


@dataclass(frozen=True)
class _Tolerances:
    """Tolerances of a scene to contributors; one function a kind."""

    scene: Scene
    meshes: dict[str, Mesh]

    def contributor(self, name: str, spec: ToleranceSpec) -> Contributor:
        """A tolerance as the simulation sees it."""
        effect, direction = self._effect(spec)
        law = spec.distribution.resolve(self.scene.files)
        return Contributor(
            name=name,
            kind=spec.kind,
            effect=effect,
            draw=Scalar(law) if direction is None else Planar(law, direction[0]),
            unit=self._unit(spec),
            description=spec.description,
            least=0.0 if isinstance(spec, BearingClearanceSpec) and direction is None else None,
        )

    @staticmethod
    def _unit(spec: ToleranceSpec) -> Unit:
        dimensions = {quantity.dimension for quantity in spec.distribution.quantities().values()}
        if dimensions == {"angle"}:
            return "mrad"
        return "K" if dimensions == {"temperature"} else "um"

    def _mesh_of(self, gear: str, mesh: str | None = None) -> Mesh:
        return self.meshes[mesh or self.scene.meshes_of(gear)[0]]

    @singledispatchmethod
    def _effect(self, spec: ToleranceSpec) -> tuple[Effect, tuple[float | None] | None]:
        """The effect; and for a deviation with a direction a tuple of it: an angle [rad], or None for random."""
        raise TypeError(f"from_scene.py has no function for {type(spec).__name__}")

    @_effect.register
    def _(self, spec: ToothThicknessSpec) -> tuple[Effect, tuple[float | None] | None]:
        return ToothThickness(spec.of), None

    @_effect.register
    def _(self, spec: EccentricitySpec) -> tuple[Effect, tuple[float | None] | None]:
        return TurningOffset(spec.of), (_angle(spec.direction),)

    @_effect.register
    def _(self, spec: RunOutSpec) -> tuple[Effect, tuple[float | None] | None]:
        return TurningOffset(spec.of), (_angle(spec.direction),)

    @_effect.register
    def _(self, spec: CentreDistanceSpec) -> tuple[Effect, tuple[float | None] | None]:
        return AxisOffset(self.meshes[spec.of].driven, (1.0, 0.0, 0.0)), None

    @_effect.register
    def _(self, spec: BearingClearanceSpec) -> tuple[Effect, tuple[float | None] | None]:
        """Half the clearance, away from the mate, at an azimuth of the mesh's world, or along the tooth force."""
        mesh = self._mesh_of(spec.of, spec.mesh)
        driven = spec.of == mesh.driven
        if spec.direction == "random":
            return AxisOffset(spec.of, factor=0.5), (None,)
        if isinstance(spec.direction, At):
            azimuth = spec.direction.at.internal
        elif spec.direction == "apart":
            azimuth = 0.0 if driven else math.pi
        else:
            # the driver's working flank pushes the driven along its normal: (sin, -sigma cos) of alpha_w
            azimuth = -mesh.working_flank * (math.pi / 2 - mesh.pair.working_pressure_angle)
            azimuth += 0.0 if driven else math.pi
        direction = (_exact(math.cos(azimuth)), _exact(math.sin(azimuth)), 0.0)
        return AxisOffset(spec.of, direction, factor=0.5), None

    @_effect.register
    def _(self, spec: AxisInPlaneSpec) -> tuple[Effect, tuple[float | None] | None]:
        return self._tilt(spec, AROUND_Y), None

    @_effect.register
    def _(self, spec: AxisOutOfPlaneSpec) -> tuple[Effect, tuple[float | None] | None]:
        return self._tilt(spec, AROUND_X), None

    def _tilt(self, spec: AxisInPlaneSpec | AxisOutOfPlaneSpec, axis: tuple[float, float, float]) -> Effect:
        mesh = self.meshes[spec.of]
        width = min(mesh.pair.pinion.face_width, mesh.pair.wheel.face_width)
        return AxisTilt(mesh.driven, axis, per_length=1.0 if self._unit(spec) == "mrad" else 1.0 / width)

    @_effect.register
    def _(self, spec: AxialShiftSpec) -> tuple[Effect, tuple[float | None] | None]:
        return AxisOffset(spec.of, ALONG_Z), None

    @_effect.register
    def _(self, spec: TemperatureSpec) -> tuple[Effect, tuple[float | None] | None]:
        return Temperature(spec.of), None


def _angle(direction: object) -> float | None:
    return direction.at.internal if isinstance(direction, At) else None


def _exact(cosine: float) -> float:
    """A cosine or sine of a right angle as 0 or 1, not 6e-17 off."""
    return round(cosine) + 0.0 if abs(cosine - round(cosine)) < 1e-15 else cosine
