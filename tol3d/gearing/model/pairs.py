"""Moves to pairs of gears: the geometry of each kind of mesh, or why it cannot be made. One function a kind."""

import math
from functools import singledispatch

from tol3d.errors import GeometryError
from tol3d.gearing.grammar.moves import BevelMeshSpec, GearMeshSpec, MeshSpec
from tol3d.gearing.grammar.parts import BevelGearSpec, GearSpec, SpurGearSpec
from tol3d.gears import BevelGear, BevelPair, Gear, GearPair, SpurGear, SpurPair, pitch_angles
from tol3d.scene import Scene
from tol3d.units import Quantity

PITCH_ANGLE_AS_WRITTEN = math.radians(0.01)  # two decimals of a degree are enough to check a drawing's angle


@singledispatch
def pair_of(move: GearMeshSpec, name: str, scene: Scene) -> GearPair:
    """The pair of a move.

    Args:
        move: the move.
        name: its name.
        scene: the scene that it stands in.

    Raises:
        SceneError: gears that cannot be made or run together, with their numbers and place.
    """
    raise TypeError(f"pairs.py has no function for {type(move).__name__}")


def undercut_warning(gear: Gear) -> str:
    """What a generating rack would take off a flank, outside the flank in use; or nothing."""
    if isinstance(gear, SpurGear) and gear.undercut_radius > gear.base_radius:
        return (
            f"a rack of addendum 1 undercuts it below profile_shift {gear.undercut_limit_shift:.4f}; "
            f"its flank is lost up to {2 * gear.undercut_radius:.4f} mm, below the flank in use"
        )
    if isinstance(gear, BevelGear) and gear.undercut_angle > gear.base_angle:
        return (
            f"a crown rack of addendum 1 undercuts it below profile_shift {gear.undercut_limit_shift:.4f}; "
            "its flank is lost below the flank in use"
        )
    return ""


@pair_of.register
def _(move: MeshSpec, name: str, scene: Scene) -> GearPair:
    pinion, wheel = (_spur_gear(scene, gear) for gear in move.gears)
    try:
        pair = SpurPair(pinion, wheel, move.centre_distance.internal)
        pair.refuse_interference()
    except GeometryError as error:
        raise scene.refuse(("moves", name, "centre_distance"), str(error)) from None
    return pair


def _spur_gear(scene: Scene, name: str) -> SpurGear:
    spec = scene.parts[name]
    if not isinstance(spec, SpurGearSpec):
        raise TypeError(f"{name} is no spur gear")
    try:
        return SpurGear(
            teeth=spec.teeth,
            module=spec.module.internal,
            pressure_angle=spec.pressure_angle.internal,
            face_width=spec.face_width.internal,
            profile_shift=spec.profile_shift,
            addendum=spec.addendum,
            dedendum=spec.dedendum,
            root_fillet=None if spec.root_fillet is None else spec.root_fillet.internal,
            bore=internal(spec.bore),
        )
    except GeometryError as error:
        raise scene.refuse(("parts", name), str(error)) from None


@pair_of.register
def _(move: BevelMeshSpec, name: str, scene: Scene) -> GearPair:
    try:
        driver, driven = (_teeth(scene, gear) for gear in move.gears)
        angles = pitch_angles(driver, driven, move.shaft_angle.internal)
    except GeometryError as error:
        raise scene.refuse(("moves", name, "shaft_angle"), str(error)) from None
    pinion, wheel = (_bevel_gear(scene, gear, angle) for gear, angle in zip(move.gears, angles, strict=True))
    try:
        pair = BevelPair(pinion, wheel, move.shaft_angle.internal)
        pair.refuse_interference()
    except GeometryError as error:
        raise scene.refuse(("moves", name), str(error)) from None
    return pair


def _teeth(scene: Scene, name: str) -> int:
    spec = scene.parts[name]
    if not isinstance(spec, GearSpec):
        raise TypeError(f"{name} is no gear")
    return spec.teeth


def _bevel_gear(scene: Scene, name: str, pitch_angle: float) -> BevelGear:
    spec = scene.parts[name]
    if not isinstance(spec, BevelGearSpec):
        raise TypeError(f"{name} is no bevel gear")
    if abs(internal(spec.pitch_angle, pitch_angle) - pitch_angle) > PITCH_ANGLE_AS_WRITTEN:
        wanted = f"{math.degrees(pitch_angle):.4f} deg, which the teeth and the shaft angle ask for"
        raise scene.refuse(
            ("parts", name, "pitch_angle"), f"the pitch cones do not roll: expected {wanted}, got '{spec.pitch_angle}'"
        )
    try:
        return BevelGear(
            teeth=spec.teeth,
            module=spec.module.internal,
            pressure_angle=spec.pressure_angle.internal,
            face_width=spec.face_width.internal,
            pitch_angle=pitch_angle,
            profile_shift=spec.profile_shift,
            addendum=spec.addendum,
            dedendum=spec.dedendum,
            bore=internal(spec.bore),
        )
    except GeometryError as error:
        raise scene.refuse(("parts", name), str(error)) from None


def internal(quantity: Quantity | None, otherwise: float = 0.0) -> float:
    """A quantity in mm, rad, K or 1/K; `otherwise` where none was given."""
    return otherwise if quantity is None else quantity.internal
