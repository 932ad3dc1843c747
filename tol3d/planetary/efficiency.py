"""Efficiencies of a scene's set by the friction of its teeth: nominal gears at their centre distance, static load."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from tol3d.planetary.design.mesh_loss import Sharing, shared_sliding_factor, sliding_factor
from tol3d.planetary.design.published_efficiency import MeshEfficiencies, published_efficiencies
from tol3d.planetary.design.torque_balance import Drive, efficiency
from tol3d.planetary.planetary_set import PlanetarySet
from tol3d.planetary.set_mesh import SetGear, SetMesh
from tol3d.planetary.tooth_set import CARRIER, ToothSet

LOCKED: Final = 0.0
"""Of an efficiency: at most so much where the set cannot be driven in that sense."""


@dataclass(frozen=True)
class SetEfficiency:
    """Of a set, driven at its input and driven at its output; at most 0 where it locks itself."""

    forward: float
    backward: float


def contact_ratios(mesh: SetMesh) -> tuple[float, float]:
    """Parts of the path of contact to the tips of central gear and planet [base pitches]; see WorkingMesh."""
    at_pitch = math.tan(mesh.working_pressure_angle)

    def part(gear: SetGear) -> float:
        tip = math.tan(math.acos(min(1.0, gear.base_radius / gear.tip_radius)))
        return gear.teeth * (tip - at_pitch) / (2 * math.pi)

    return mesh.sense * part(mesh.central), part(mesh.planet)


def mesh_efficiencies(own: PlanetarySet, friction: float, sharing: Sharing) -> Mapping[str, float]:
    """1 - mu pi (1/z_p + s/z) E of each mesh, by its central gear; see design.mesh_loss."""
    factor = sliding_factor if sharing == "formula" else shared_sliding_factor
    return {
        mesh.central.name: 1
        - friction * math.pi * (1 / mesh.planet.teeth + mesh.sense / mesh.central.teeth) * factor(*contact_ratios(mesh))
        for mesh in own.meshes
    }


def set_efficiency(own: PlanetarySet, friction: float) -> SetEfficiency:
    """By equilibrium of the torques; pairs of teeth in contact carry alike."""
    drive = Drive(*(CARRIER if shaft == own.carrier else shaft for shaft in (own.input, own.output, own.held)))
    meshes = mesh_efficiencies(own, friction, "equal shares")
    return SetEfficiency(efficiency(own.teeth, meshes, drive), efficiency(own.teeth, meshes, drive.reversed))


def formula_efficiency(own: PlanetarySet, friction: float) -> SetEfficiency | None:
    """By the published closed form of a 3K set, with the published E; None of any other set."""
    central = {mesh.central.name: mesh for mesh in own.meshes}
    if len(central) != 3 or own.carrier in (own.held, own.input, own.output):
        return None
    sun, ring_1, ring_2 = (central[shaft] for shaft in (own.input, own.held, own.output))
    if sun.central.is_ring or not (ring_1.central.is_ring and ring_2.central.is_ring) or sun.planet != ring_1.planet:
        return None
    meshes = mesh_efficiencies(own, friction, "formula")
    given = MeshEfficiencies(*(meshes[mesh.central.name] for mesh in (sun, ring_1, ring_2)))
    teeth = ToothSet(tuple(own.teeth.mesh(mesh.central.name) for mesh in (sun, ring_1, ring_2)))
    found = published_efficiencies(teeth, given)
    return SetEfficiency(found.forward, found.backward)
