"""Planetary stages of a REXS text: many meshes, which are those of one planet, again for each of the others."""

from collections.abc import Sequence
from typing import Final

from tol3d.apps.drafting.rexs.document import Component, Document, RexsError
from tol3d.apps.drafting.rexs.gearbox import Gear, PlanetarySet, Shaft, Stage

SAME_DISTANCE: Final = 1e-3  # mm; files print distances with 3 decimals and more


def planetary_set(
    document: Document, stage: Component, meshes: Sequence[Stage], shafts: Sequence[Shaft]
) -> PlanetarySet:
    """A planetary stage.

    Args:
        document: its text.
        stage: its component.
        meshes: of all of its planets.
        shafts: all that there are.

    Raises:
        RexsError: it has no planets, planets that differ, or none that is held.
    """
    planets = _of(document, stage, "planet_shaft") or _of(document, stage, "planet_pin")
    carriers = _of(document, stage, "planet_carrier_shaft")
    carrier = next((own for own in shafts if {*own.ids} & {*carriers}), None)
    if not planets or not meshes or carrier is None:
        raise RexsError(f"{stage}: expected planet_shaft, planet_carrier_shaft and cylindrical stages, got not all")
    turning = {gear.id: shaft for shaft in shafts for gear in shaft.gears if {*shaft.ids} & {*planets}}
    own: dict[int, list[tuple[Gear, Gear, Stage]]] = {}
    for mesh in meshes:
        on_planets = [gear for gear in mesh.gears if gear.id in turning]
        if len(on_planets) != 1:
            many = len(on_planets)
            raise RexsError(
                f"cylindrical_stage {mesh.id}: expected one gear of a planet, the other central, got {many}"
            )
        planet = on_planets[0]
        own.setdefault(turning[planet.id].ids[0], []).append((mesh.mate(planet), planet, mesh))
    if {*turning} != {planet.id for each in own.values() for _, planet, _ in each}:
        raise RexsError(f"{stage}: expected gears of planets that mesh in it alone, got others")
    first = next(iter(own.values()))
    wanted = sorted(map(_likeness, first))
    for planet_shaft, each in own.items():
        if sorted(map(_likeness, each)) != wanted:
            raise RexsError(
                f"{stage}: expected planets that are alike, got another on {document.components[planet_shaft]}"
            )
    if len(own) not in (1, len(planets)):
        raise RexsError(f"{stage}: expected the meshes of {len(planets)} planets, got those of {len(own)}")
    distances = [mesh.centre_distance for _, _, mesh in first]
    low, high = min(distances), max(distances)
    if high - low > SAME_DISTANCE:
        raise RexsError(f"{stage}: expected one center_distance of all meshes, got {low:g} and {high:g} mm")
    if len({central.id for central, _, _ in first}) < 2:
        raise RexsError(f"{stage}: expected a sun and a ring, or two rings, got one central gear")
    held, guessed = _held(stage, [central for central, _, _ in first], carrier, shafts)
    return PlanetarySet(
        id=stage.id,
        name=stage.name,
        planets=len(planets),
        meshes=[(central, planet) for central, planet, _ in first],
        stages=[mesh for _, _, mesh in first],
        carrier=carrier,
        planet_shafts=planets,
        held=held,
        guessed=guessed,
    )


def _of(document: Document, stage: Component, kind: str) -> list[int]:
    relations = document.of_type.get(kind, ())
    return list(dict.fromkeys(own.one("shaft") for own in relations if own.one("planetary_stage") == stage.id))


def _likeness(mesh: tuple[Gear, Gear, Stage]) -> tuple[object, ...]:
    """Numbers in which the meshes of every planet agree."""
    central, planet, stage = mesh
    allowances = tuple((own.measured, own.lower, own.upper) for own in planet.allowances)
    shift = round(planet.profile_shift or 0.0, 9)
    return (
        central.id, planet.teeth, planet.module, shift, planet.helix_angle, planet.face_width or 0.0, planet.series,
        allowances, stage.centre_distance, stage.field or 0, stage.allowance or (0.0, 0.0),
    )  # fmt: skip


def _held(stage: Component, centrals: Sequence[Gear], carrier: Shaft, shafts: Sequence[Shaft]) -> tuple[int, bool]:
    """The central gear that is held, 0 for the carrier; True if no coupling says it."""
    still = [gear.id for gear in centrals for shaft in shafts if shaft.held and gear in shaft.gears]
    still += [0] if carrier.held else []
    if len(still) > 1:
        raise RexsError(f"{stage}: expected one shaft coupled to the casing, got {len(still)}")
    if still:
        return still[0], False
    return next((gear.id for gear in centrals if gear.internal), 0), True
