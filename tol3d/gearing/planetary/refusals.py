"""The set that a scene means, or the reasons why it cannot be built: conditions with their numbers."""

import math
from dataclasses import replace
from typing import Any, Final

from tol3d.errors import GeometryError
from tol3d.gearing.grammar.parts import GearSpec, InternalGearSpec, helix_of
from tol3d.gearing.model.pairs import cylindrical_gear, cylindrical_pair
from tol3d.gearing.planetary.grammar.moves import PlanetarySpec
from tol3d.gearing.planetary.grammar.parts import FlexibleCarrierSpec, PlanetSpec
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet, Spring
from tol3d.gearing.planetary.model.set_mesh import SetGear, SetMesh
from tol3d.gearing.reducers.from_scene import unlike
from tol3d.gears.cylindrical_pair import crossed_axes
from tol3d.scene import Scene

CENTRALS: Final = ("spur_gear", "helical_gear", "internal_gear")
"""Kinds of gear that planets mesh with."""


def set_of(scene: Scene, name: str, spec: PlanetarySpec) -> PlanetarySet:
    """The set that a move of a scene stands for, whatever else is in the scene.

    Raises:
        SceneError: it cannot be put together.
    """
    own = _set(scene, name, spec)
    _refuse_roles(scene, own)
    _refuse_unbuildable(scene, own)
    _refuse_interference(scene, own)
    return own


def _refuse_interference(scene: Scene, planetary_set: PlanetarySet) -> None:
    """Refuse gears that cannot be made, and meshes whose tips, involutes or fillets interfere."""
    for mesh in planetary_set.meshes:
        central, planet = (cylindrical_gear(scene, gear.name) for gear in (mesh.central, mesh.planet))
        try:
            cylindrical_pair(central, planet, mesh.centre_distance).refuse_interference()
        except GeometryError as error:
            raise scene.refuse(("moves", planetary_set.name, "meshes", mesh.central.name), str(error)) from None


def _gear(scene: Scene, name: str) -> SetGear:
    spec: Any = scene.parts[name]
    assert isinstance(spec, GearSpec)
    return SetGear(
        name, spec.teeth, spec.module.internal, spec.pressure_angle.internal, spec.profile_shift, spec.addendum,
        isinstance(spec, InternalGearSpec), *helix_of(spec),
    )  # fmt: skip


def _set(scene: Scene, name: str, spec: PlanetarySpec) -> PlanetarySet:
    planet = scene.parts[spec.planet]
    assert isinstance(planet, PlanetSpec)
    for k, gear in enumerate(planet.gears):
        if scene.parts[gear].kind not in ("spur_gear", "helical_gear"):
            raise scene.refuse(("parts", spec.planet, "gears", k), f"expected spur or helical gears, got {gear!r}")
    _refuse_misnamed(scene, name, spec, planet)
    pairs = [(_gear(scene, central), _gear(scene, gear)) for central, gear in spec.meshes.items()]
    for central, own in pairs:
        _refuse_unlike(scene, name, central, own)
    if spec.centre_distance is not None:
        distance = spec.centre_distance.internal
    else:
        central, own = pairs[0]
        distance = central.module * (central.teeth + (-1 if central.is_ring else 1) * own.teeth) / 2
        distance /= math.cos(central.helix_angle)
    for central, own in pairs:
        _refuse_no_mesh(scene, name, SetMesh(central, own, distance))
    return PlanetarySet(
        name=name,
        meshes=tuple(SetMesh(central, own, distance) for central, own in pairs),
        planets=spec.planets,
        gears=tuple(_gear(scene, gear) for gear in planet.gears),
        carrier=spec.carrier,
        held=spec.held,
        input=spec.input,
        output=spec.output,
        azimuths=tuple(2 * math.pi * k / spec.planets for k in range(spec.planets)),
        springs=_springs(scene, spec),
    )


def _refuse_misnamed(scene: Scene, name: str, spec: PlanetarySpec, planet: PlanetSpec) -> None:
    """Refuse meshes that name gears of other parts, or none of a gear."""
    for central, gear in spec.meshes.items():
        if gear not in planet.gears:
            words = f"expected a gear of {spec.planet!r}: {', '.join(planet.gears)}, got {gear!r}"
            raise scene.refuse(("moves", name, "meshes", central), words)
        if central in planet.gears or scene.parts[central].kind not in CENTRALS:
            words = f"expected a spur, helical or internal gear outside the planet, got {central!r}"
            raise scene.refuse(("moves", name, "meshes", central), words)
    for gear in planet.gears:
        if gear not in spec.meshes.values():
            raise scene.refuse(("moves", name, "meshes"), f"expected a mesh of {gear!r}, a gear of {spec.planet!r}")


def _refuse_unlike(scene: Scene, name: str, central: SetGear, set_gear: SetGear) -> None:
    """Refuse a mesh of gears that do not roll on each other."""
    if (found := unlike(scene, central.name, set_gear.name)) is not None:
        words = "expected gears of the same {}, got {} and {}".format(*found)
        raise scene.refuse(("moves", name, "meshes", central.name), words)
    if central.helix_angle or set_gear.helix_angle:
        crossed = crossed_axes(*(cylindrical_gear(scene, gear.name) for gear in (central, set_gear)))
        if crossed:
            raise scene.refuse(("moves", name, "meshes", central.name), crossed)


def _springs(scene: Scene, spec: PlanetarySpec) -> tuple[Spring, ...]:
    """Springs of a flexible carrier."""
    carrier = scene.parts[spec.carrier]
    if not isinstance(carrier, FlexibleCarrierSpec):
        return ()
    for k, pair in enumerate(carrier.pairs):
        for planet in pair:
            if not 1 <= planet <= spec.planets:
                words = f"expected planets 1 to {spec.planets}, got {planet}"
                raise scene.refuse(("parts", spec.carrier, "pairs", k), words)
    set_at = None if carrier.adjustment is None else carrier.adjustment.internal * carrier.displacement
    groups = [carrier.pairs] if carrier.springs == "one" else [(pair,) for pair in carrier.pairs]
    return tuple(
        Spring(tuple(one - 1 for one, _ in group), tuple(two - 1 for _, two in group), set_at) for group in groups
    )


def _refuse_no_mesh(scene: Scene, name: str, mesh: SetMesh) -> None:
    """Refuse a ring that is not larger than its planets, and base circles that leave no room."""
    path = ("moves", name, "meshes", mesh.central.name)
    if mesh.base_radii <= 0.0:
        teeth = f"{mesh.central.teeth} and {mesh.planet.teeth}"
        words = f"expected a ring with more teeth than its planets, got {teeth}; a sun is a spur_gear"
        raise scene.refuse(path, words)
    as_ring = SetMesh(replace(mesh.central, is_ring=True), mesh.planet, mesh.centre_distance)
    if not mesh.central.is_ring and 0.0 < as_ring.base_radii < mesh.centre_distance <= mesh.base_radii:
        raise scene.refuse(
            path,
            f"expected an internal_gear, got the spur gear {mesh.central.name!r}: beside its planets it would need a "
            f"centre distance of more than {mesh.base_radii:.4f} mm, got {mesh.centre_distance:.4f} mm; a ring with "
            f"{mesh.central.teeth} teeth round them needs {as_ring.base_radii:.4f} mm",
        )
    if mesh.base_radii >= mesh.centre_distance:
        raise scene.refuse(
            path,
            f"expected a centre distance of more than {mesh.base_radii:.4f} mm, which the base circles of {mesh.name} "
            f"need, got {mesh.centre_distance:.4f} mm; the tooth numbers are not coaxial, or state another one",
        )


def _refuse_roles(scene: Scene, planetary_set: PlanetarySet) -> None:
    """Refuse shafts that are none of the set's, or have two roles, and sets whose output is not driven."""
    roles = {"held": planetary_set.held, "input": planetary_set.input, "output": planetary_set.output}
    for role, shaft in roles.items():
        if shaft not in planetary_set.shafts:
            words = f"expected one of {', '.join(planetary_set.shafts)}, got {shaft!r}"
            raise scene.refuse(("moves", planetary_set.name, role), words)
    for role, other in (("input", "held"), ("output", "held"), ("output", "input")):
        if roles[role] == roles[other]:
            words = f"expected another shaft than the one that is {other}, got {roles[role]!r} twice"
            raise scene.refuse(("moves", planetary_set.name, role), words)
    at_rest = planetary_set.turn(planetary_set.held)
    for role in ("output", "input"):
        if planetary_set.turn(roles[role]) == at_rest:
            words = f"{roles[role]!r} does not turn while {planetary_set.held!r} is held"
            raise scene.refuse(
                ("moves", planetary_set.name, role),
                f"expected a shaft that turns: {words}: their teeth over their planets' are alike",
            )


def _refuse_unbuildable(scene: Scene, planetary_set: PlanetarySet) -> None:
    """Refuse planets that cannot be put in at equal angles, or touch each other."""
    try:
        faults = planetary_set.teeth.assembly_faults(planetary_set.planets)
    except GeometryError as error:
        raise scene.refuse(("moves", planetary_set.name, "meshes"), str(error)) from None
    for fault in faults:
        raise scene.refuse(("moves", planetary_set.name, "planets"), fault.words)
    if planetary_set.planets > 1:
        apart = 2 * planetary_set.centre_distance * math.sin(math.pi / planetary_set.planets)
        gear = max(planetary_set.gears, key=lambda gear: gear.tip_radius)
        if apart <= 2 * gear.tip_radius:
            raise scene.refuse(
                ("moves", planetary_set.name, "planets"),
                f"neighbouring planets touch: expected pins further apart than the tip circle of {gear.name!r}, "
                f"{2 * gear.tip_radius:.4f} mm, got {apart:.4f} mm; take fewer planets",
            )
