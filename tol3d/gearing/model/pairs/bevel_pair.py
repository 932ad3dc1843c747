"""Bevel gears whose axes meet."""

import math

from tol3d.errors import GeometryError
from tol3d.gearing.grammar.moves import BevelMeshSpec
from tol3d.gearing.grammar.parts import BevelGearSpec, GearSpec
from tol3d.gearing.model.pairs.pair import internal, pair_of, undercut_warning
from tol3d.gears import BevelGear, BevelPair, GearPair, pitch_angles
from tol3d.scene import Scene

PITCH_ANGLE_AS_WRITTEN = math.radians(0.01)  # two decimals of a degree are enough to check a drawing's angle


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


@undercut_warning.register
def _(gear: BevelGear) -> str:
    if gear.undercut_angle > gear.base_angle:
        return (
            f"a crown rack of addendum 1 undercuts it below profile_shift {gear.undercut_limit_shift:.4f}; "
            "its flank is lost below the flank in use"
        )
    return ""
