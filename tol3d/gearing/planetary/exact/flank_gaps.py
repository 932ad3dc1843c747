"""Gaps between the flanks of placed gears, and their places: along the lines of action, from the poses alone.

Both involutes of a contact are normal to one line that is tangent to both base circles, so that their distance is
measured along it: the unwound length of each, by the azimuth at which it begins on its base circle. Flanks of
all teeth lie a base pitch apart, alike for both gears; the pair nearest to the pitch point is taken. Of helical gears
this is the section in the middle of the central gear's face, and the normals lean out of it by the base helix angle.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.shown.placed import PlacedGear
from tol3d.gears import LEFT, RIGHT, Flank, InternalGear, SpurGear
from tol3d.numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class FlankGap:
    """A flank of a planet's gear and the flank of the central gear before it.

    Args:
        planet: counted from 0.
        mesh: place of the mesh among those of the set.
        flank: of the planet's gear; LEFT stops it counter-clockwise.
        value: distance [mm], negative where they overlap.
        point: (3,) [mm] where the planet's flank meets the line of action, in the middle of its face.
        bodies: names of both gears.
    """

    planet: int
    mesh: int
    flank: Flank
    value: float
    point: Array
    bodies: tuple[str, str]


def flank_gaps(planetary_set: PlanetarySet, gears: Sequence[PlacedGear]) -> Iterator[FlankGap]:
    """Both gaps of each mesh of each planet.

    Args:
        gears: central gears, then those of each planet, as ShownSet has them.
    """
    count, steps = len(planetary_set.meshes), len(planetary_set.gears)
    for k in range(planetary_set.planets):
        for m, mesh in enumerate(planetary_set.meshes):
            central, planet = gears[m], gears[count + k * steps + planetary_set.gear_of(mesh)]
            for flank in (RIGHT, LEFT):
                value, point = _gap(central, planet, flank)
                yield FlankGap(k, m, flank, value, point, (central.name, planet.name))


def _gap(central: PlacedGear, planet: PlacedGear, flank: Flank) -> tuple[float, Array]:
    """Distance [mm] and the point on the planet's flank."""
    assert isinstance(planet.gear, SpurGear)
    ring = isinstance(central.gear, InternalGear)
    side = 1.0 if flank == LEFT else -1.0  # the way out of the planet's tooth, about its axis
    r_c, r_p = central.gear.base_radius, planet.gear.base_radius
    (x, y), height = planet.world_from_gear[:2, 3] - central.world_from_gear[:2, 3], planet.world_from_gear[2, 3]
    apart = math.hypot(x, y)
    base = r_c - r_p if ring else r_c + r_p
    working = math.acos(base / apart)
    azimuth = math.atan2(y, x)  # of the planet, seen from the central gear
    # where the line of action leaves the base circle of the planet, and its way from there to the contact
    touched = azimuth - side * working if ring else azimuth + math.pi - side * working
    along = side * np.array([-math.sin(touched), math.cos(touched)])
    begin = planet.world_from_gear[:2, 3] + r_p * np.array([math.cos(touched), math.sin(touched)])
    lower = central.world_from_gear[2, 3] - planet.world_from_gear[2, 3]
    turn = _turn(planet) + planet.gear.twist * lower  # in the section in the middle of the central gear's face
    own = r_p * (side * (turn - touched) + _half(planet))
    # of the ring's flank as unwound from its own base circle, which the line leaves earlier; of a sun from the far end
    if ring:
        its = r_c * (side * (_turn(central) - touched) - _half(central)) - apart * math.sin(working)
    else:
        far = touched + math.pi
        its = apart * math.sin(working) - r_c * (side * (_turn(central) - far) + _half(central))
    pitch = 2 * math.pi * r_p / planet.gear.teeth
    pitch_point = r_p * math.tan(working)
    own -= pitch * round((own - pitch_point) / pitch)
    its -= pitch * round((its - own) / pitch)
    return (its - own) * planet.gear.base_helix_cosine, np.array([*(begin + own * along), height])


def _turn(gear: PlacedGear) -> float:
    """Azimuth of the middle of tooth 0 [rad]."""
    return math.atan2(gear.world_from_gear[1, 0], gear.world_from_gear[0, 0])


def _half(gear: PlacedGear) -> float:
    """Half the angle of its tooth at the base circle [rad]."""
    assert isinstance(gear.gear, SpurGear | InternalGear)
    return gear.gear.base_half_angle + gear.flank_turn
