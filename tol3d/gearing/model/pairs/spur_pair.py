"""Spur gears on parallel axes."""

from tol3d.errors import GeometryError
from tol3d.gearing.grammar.moves import MeshSpec
from tol3d.gearing.grammar.parts import SpurGearSpec
from tol3d.gearing.model.pairs.pair import internal, pair_of, undercut_warning
from tol3d.gears import GearPair, SpurGear, SpurPair
from tol3d.scene import Scene


@pair_of.register
def _(move: MeshSpec, name: str, scene: Scene) -> GearPair:
    pinion, wheel = (_spur_gear(scene, gear) for gear in move.gears)
    if move.centre_distance is None:
        words = "expected the centre_distance of the axes, got none; it follows only where both shafts lie in bores"
        raise scene.refuse(("moves", name), words)
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


@undercut_warning.register
def _(gear: SpurGear) -> str:
    if gear.undercut_radius > gear.base_radius:
        return (
            f"a rack of addendum 1 undercuts it below profile_shift {gear.undercut_limit_shift:.4f}; "
            f"its flank is lost up to {2 * gear.undercut_radius:.4f} mm, below the flank in use"
        )
    return ""
