"""Names of a gearbox's parts and stages in its scene."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from tol3d.apps.drafting.rexs.gearbox import Bearing, Gear, Gearbox, PlanetarySet, Shaft, Stage, base_name
from tol3d.apps.drafting.rexs.kinematics import CARRIER
from tol3d.apps.drafting.words import Names

NO_BRACKETS: Final = str.maketrans("", "", "[]")
"""Programs write numbers of components in them."""
LONGEST: Final = 40  # characters, with which a tolerance's name has room for its kind


@dataclass(frozen=True)
class Named:
    """Names of a gearbox in its scene; all differ.

    Args:
        shafts: those that are parts of the scene: with gears of meshes that are in no planetary stage.
        names: by the ids of components, of a shaft that of its first one.
        planets, carriers: by the ids of planetary stages.
        titles: further names of the scene, which differ from these.
    """

    shafts: Sequence[Shaft]
    names: Mapping[int, str]
    planets: Mapping[int, str]
    carriers: Mapping[int, str]
    titles: Names

    def of(self, own: Gear | Stage | PlanetarySet | int) -> str:
        """The name of a component."""
        return self.names[own if isinstance(own, int) else own.id]

    def part(self, part: int, member: int, cause: Stage | PlanetarySet) -> str:
        """The shaft of a link's end, or its gear or carrier where that is its own shaft."""
        if any(shaft.ids[0] == part for shaft in self.shafts):
            return self.names[part]
        return self.carriers[cause.id] if member == CARRIER else self.names[member]


def scene_shafts(gearbox: Gearbox) -> list[Shaft]:
    """Shafts that are parts of a scene."""
    meshing = {gear.id for stage in gearbox.stages for gear in stage.gears}
    return [shaft for shaft in gearbox.shafts if any(gear.id in meshing for gear in shaft.gears)]


def named(gearbox: Gearbox, shafts: Sequence[Shaft], bearings: Sequence[Bearing]) -> Named:
    """Names for shafts and bearings that are parts of the scene, and for gears, stages and sets, near the file's."""
    gears = [gear for stage in gearbox.stages for gear in stage.gears]
    gears += [gear for own in gearbox.sets for mesh in own.meshes for gear in mesh]
    wishes = [
        *((shaft.ids[0], shaft.name, "shaft") for shaft in shafts),
        *((own.id, own.name, "bearing") for own in bearings),
        *((gear.id, gear.name, "gear") for gear in gears),
        *((own.id, own.name, "stage") for own in gearbox.stages),
        *((own.id, own.name, "planetary stage") for own in gearbox.sets),
    ]
    names, found = Names(), dict[int, str]()
    for number, wish, fallback in wishes:
        if number not in found:
            near = base_name(wish).translate(NO_BRACKETS)[:LONGEST]
            found[number] = names.new(near, f"{fallback} {number}")
    planets = {own.id: names.new("planet", "planet") for own in gearbox.sets}
    carriers = {own.id: names.new("carrier", "carrier") for own in gearbox.sets}
    return Named(shafts, found, planets, carriers, names)
