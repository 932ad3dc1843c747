"""Spur gears on parallel axes, of which one may be internal."""

from tol3d.errors import GeometryError
from tol3d.gearing.grammar.moves import MeshSpec
from tol3d.gearing.grammar.parts import GearSpec, InternalGearSpec, SpurGearSpec
from tol3d.gearing.model.pairs.pair import internal, pair_of, undercut_warning
from tol3d.gears import GearPair, InternalGear, InternalPair, SpurGear, SpurPair
from tol3d.scene import Scene


@pair_of.register
def _(move: MeshSpec, name: str, scene: Scene) -> GearPair:
    _refuse_rings(move, name, scene)
    pinion, wheel = (cylindrical_gear(scene, gear) for gear in move.gears)
    if move.centre_distance is None:
        words = "expected the centre_distance of the axes, got none; it follows only where both shafts lie in bores"
        raise scene.refuse(("moves", name), words)
    try:
        pair = cylindrical_pair(pinion, wheel, move.centre_distance.internal)
        pair.refuse_interference()
    except GeometryError as error:
        raise scene.refuse(("moves", name, "centre_distance"), str(error)) from None
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
    """A spur gear or a ring of a scene.

    Raises:
        SceneError: it cannot be made.
    """
    spec = scene.parts[name]
    try:
        if isinstance(spec, SpurGearSpec):
            return _spur_gear(spec)
        if isinstance(spec, InternalGearSpec):
            return _internal_gear(spec)
    except GeometryError as error:
        raise scene.refuse(("parts", name), str(error)) from None
    raise TypeError(f"{name} is no spur gear")


def _spur_gear(spec: SpurGearSpec) -> SpurGear:
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


def _internal_gear(spec: InternalGearSpec) -> InternalGear:
    return InternalGear(
        teeth=spec.teeth,
        module=spec.module.internal,
        pressure_angle=spec.pressure_angle.internal,
        face_width=spec.face_width.internal,
        profile_shift=spec.profile_shift,
        addendum=spec.addendum,
        dedendum=spec.dedendum,
        root_fillet=None if spec.root_fillet is None else spec.root_fillet.internal,
        outer_diameter=None if spec.outer_diameter is None else spec.outer_diameter.internal,
    )


@undercut_warning.register
def _(gear: SpurGear) -> str:
    if gear.undercut_radius > gear.base_radius:
        return (
            f"a rack of addendum 1 undercuts it below profile_shift {gear.undercut_limit_shift:.4f}; "
            f"its flank is lost up to {2 * gear.undercut_radius:.4f} mm, below the flank in use"
        )
    return ""
