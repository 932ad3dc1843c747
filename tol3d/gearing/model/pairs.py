"""Pairs of gears from moves: the geometry of each kind of mesh, or the reason why it cannot be made."""

import math
from functools import singledispatch
from typing import Final

from tol3d.errors import GeometryError
from tol3d.gearing.grammar.cylindrical import CylindricalSpec, cylindrical_gear_of
from tol3d.gearing.grammar.moves import BevelMeshSpec, GearMeshSpec, MeshSpec
from tol3d.gearing.grammar.parts import BevelGearSpec, GearSpec, InternalGearSpec
from tol3d.gears import (
    BevelGear,
    BevelPair,
    Gear,
    GearPair,
    InternalGear,
    InternalPair,
    SpurGear,
    SpurPair,
    pitch_angles,
)
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.cylindrical_pair import CylindricalPair, crossed_axes
from tol3d.gears.remedies import remedy
from tol3d.scene import Scene
from tol3d.scene.place import KeyPath
from tol3d.units import Quantity


@singledispatch
def pair_of(move: GearMeshSpec, name: str, scene: Scene) -> GearPair:
    """The pair of a move.

    Args:
        move: the move.
        name: its name.
        scene: its scene.

    Raises:
        SceneError: gears that cannot be made or run together, with their numbers and place.
    """
    raise TypeError(f"model/pairs.py has no function for {type(move).__name__}")


@singledispatch
def undercut_warning(gear: Gear) -> str:
    """Warning of undercut by a generating rack outside the flank in use; or ""."""
    return ""


@singledispatch
def assembly_warning(pair: GearPair) -> str:
    """Warning if the gears of a pair run together but cannot be assembled, or not as evenly as others; or ""."""
    return ""


def internal(quantity: Quantity | None, otherwise: float = 0.0) -> float:
    """A quantity in mm, rad, K or 1/K; `otherwise` where none was given."""
    return otherwise if quantity is None else quantity.internal


@pair_of.register
def _(move: MeshSpec, name: str, scene: Scene) -> GearPair:
    _refuse_rings(move, name, scene)
    pinion, wheel = (cylindrical_gear(scene, gear) for gear in move.gears)
    if move.centre_distance is None:
        words = "expected the centre_distance of the axes, got none; it follows only where both shafts lie in bores"
        raise scene.refuse(("moves", name), words)
    if crossed := crossed_axes(pinion, wheel):
        raise scene.refuse(("moves", name, "driven"), crossed)
    path: KeyPath = ("moves", name, "centre_distance")
    try:
        pair = cylindrical_pair(pinion, wheel, move.centre_distance.internal)
    except GeometryError as error:
        raise scene.refuse(path, str(error)) from None
    try:
        pair.refuse_interference()
    except GeometryError as error:
        raise scene.refuse(path, f"{error}{remedy(pair) if isinstance(pair, SpurPair) else ''}") from None
    return pair


def _refuse_rings(move: MeshSpec, name: str, scene: Scene) -> None:
    """Refuse two rings, and one that is no larger than its mate, before their teeth are found impossible."""
    driver, driven = move.gears
    specs = {gear: spec for gear in move.gears if isinstance(spec := scene.parts[gear], GearSpec)}
    rings = [gear for gear, spec in specs.items() if isinstance(spec, InternalGearSpec)]
    if len(rings) == 2:
        words = f"expected one internal gear at most, got {driver!r} and {driven!r}: rings do not mesh with each other"
        raise scene.refuse(("moves", name, "driven"), words)
    for ring in rings:
        inner = driven if ring == driver else driver
        if specs[ring].teeth <= specs[inner].teeth:
            words = f"expected more teeth than the {specs[inner].teeth} of {inner!r}, which is inside it"
            raise scene.refuse(("parts", ring, "teeth"), f"{words}, got {specs[ring].teeth}")


def cylindrical_pair(
    pinion: SpurGear | InternalGear, wheel: SpurGear | InternalGear, centre_distance: float
) -> SpurPair | InternalPair:
    """Two gears at a centre distance [mm], of which one may be a ring.

    Raises:
        GeometryError: they do not mesh.
    """
    if isinstance(pinion, SpurGear) and isinstance(wheel, SpurGear):
        return SpurPair(pinion, wheel, centre_distance)
    return InternalPair(pinion, wheel, centre_distance)


def cylindrical_gear(scene: Scene, name: str) -> SpurGear | InternalGear:
    """A spur or helical gear or a ring of a scene.

    Raises:
        SceneError: it cannot be made.
    """
    spec = scene.parts[name]
    try:
        if isinstance(spec, CylindricalSpec):
            return cylindrical_gear_of(spec)
    except GeometryError as error:
        raise scene.refuse(("parts", name), str(error)) from None
    raise TypeError(f"{name} is no spur gear")


SHARP_TIP: Final = 0.2  # normal modules; hardened teeth chip where their tips are thinner (ISO 6336-1 asks for as much)


@undercut_warning.register
def _(gear: InternalGear) -> str:
    """Warning of sharp tips of a helical ring."""
    return _sharp_tips(gear)


def _sharp_tips(gear: CylindricalGear) -> str:
    if not gear.helix_angle or gear.normal_tip_thickness >= SHARP_TIP * gear.module:
        return ""
    return (
        f"sharp tips: the teeth are {gear.normal_tip_thickness:.4f} mm thick at the tip in the normal section, "
        f"below {SHARP_TIP:g} normal modules; lower addendum or profile_shift"
    )


@undercut_warning.register
def _(gear: SpurGear) -> str:
    if sharp := _sharp_tips(gear):
        return sharp
    if gear.undercut_radius > gear.base_radius:
        return (
            f"undercut by a rack of addendum 1, because profile_shift is below {gear.undercut_limit_shift:.4f}; "
            f"the flank is lost up to diameter {2 * gear.undercut_radius:.4f} mm, which is below the flank in use"
        )
    return ""


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
            f"undercut by a crown rack of addendum 1, because profile_shift is below {gear.undercut_limit_shift:.4f}; "
            "the flank is lost only below the flank in use"
        )
    return ""


@assembly_warning.register
def _(pair: SpurPair) -> str:
    return _overlap_alone(pair)


def _overlap_alone(pair: CylindricalPair) -> str:
    """Warning of teeth that keep contact only because they lean, by the helix of the pair."""
    if pair.contact_ratio >= 1.0:
        return ""
    return (
        f"contact ratio {pair.contact_ratio:.4f} over the profile is below 1: contact is kept by the overlap "
        f"{pair.overlap_ratio:.4f} alone, and an end of the face is not touched at every position"
    )


@assembly_warning.register
def _(pair: InternalPair) -> str:
    if (alone := _overlap_alone(pair)) or pair.radially_assembled:
        return alone
    along = "on a screw along its axis" if pair.inner.helix_angle else "along its axis"
    return (
        f"the gear of {pair.inner.teeth} teeth goes into the ring of {pair.ring.teeth} {along} only: moved "
        "along the line of centres its teeth meet the ring's"
    )
