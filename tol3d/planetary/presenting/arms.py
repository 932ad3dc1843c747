"""The carrier of a set as it is shown: an arm to each planet and a pin through it, in colours of what springs turn."""

import math
from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.presenting.whole_trains import plain_body
from tol3d.gears import SpurGear
from tol3d.planetary.planetary_set import PlanetarySet
from tol3d.planetary.shown import ShownSet
from tol3d.report.body import Body
from tol3d.solids import PosedBody
from tol3d.solids.bodies import ArmBody

Array = NDArray[np.float64]

PIN: Final = 0.7  # of the smallest bore of a planet
BELOW: Final = 0.75  # of a pin's diameter, from the lowest face to the axis of an arm
FORWARD, BACKWARD, RIGID = "#7FB2D9", "#8CC5A2", "#B0B8C0"


def arms_of(shown: ShownSet) -> Iterator[Body]:
    """One a planet; none where a gear of the planets has no bore, or lies where it is not known."""
    own = shown.own
    gears = [gear for gear in shown.gears[len(own.meshes) :] if isinstance(gear.gear, SpurGear)]
    bores = [gear.gear.bore for gear in gears if isinstance(gear.gear, SpurGear)]
    diameter = PIN * min(bores, default=0.0)
    if not diameter:
        return
    faces = [(gear.world_from_gear[2, 3], gear.gear.face_width / 2) for gear in gears]
    low, high = min(at - half for at, half in faces), max(at + half for at, half in faces)
    level = low - BELOW * diameter
    shape = ArmBody(((own.centre_distance, 0.0, 0.0), (own.centre_distance, 0.0, high - level)), diameter)
    for planet, pin in enumerate(shown.pins):
        senses = [spring.sense(planet) for spring in own.springs if spring.sense(planet)]
        colour = RIGID if not senses else FORWARD if senses[0] > 0 else BACKWARD
        yield plain_body(PosedBody(arm_name(own, planet), shape, arm_pose(pin, level)), colour)


def arm_name(own: PlanetarySet, planet: int) -> str:
    """Of the part of the carrier that holds a planet, counted from 0."""
    return f"{own.carrier} at planet {planet + 1}"


def arm_pose(pin: Array, level: float) -> Array:
    """Of an arm whose pin has its axis there (2,) [mm], as far as it turns about the common axis."""
    angle = math.atan2(pin[1], pin[0])
    pose = np.eye(4)
    pose[:2, :2] = [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    pose[2, 3] = level
    return pose
