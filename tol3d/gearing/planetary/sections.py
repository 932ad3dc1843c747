"""Planetary sets in summary.json: efficiencies by the friction of nominal teeth, static load; its spring."""

import math
from collections.abc import Mapping
from typing import Final

from tol3d.gearing.planetary.hysteresis import crossing, hysteresis
from tol3d.gearing.planetary.model.deviated import Deviated
from tol3d.gearing.planetary.model.efficiency import (
    Drive,
    Efficiencies,
    MeshEfficiencies,
    Sharing,
    efficiency,
    published_efficiencies,
    shared_sliding_factor,
    sliding_factor,
)
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.planetary.model.set_mesh import SetGear, SetMesh
from tol3d.gearing.planetary.model.tooth_set import CARRIER, ToothSet
from tol3d.gearing.planetary.spring_curve import LeafSpring, breakaway, displaced_ends
from tol3d.gearing.planetary.summary_types import EfficiencySummary, PlanetarySetSummary, SpringSummary
from tol3d.study.runs.summary.values import made
from tol3d.units import RAD_PER_ARCMIN


def contact_ratios(mesh: SetMesh) -> tuple[float, float]:
    """Parts of the path of contact to the tips of central gear and planet [base pitches]; see WorkingMesh."""
    at_pitch = math.tan(mesh.working_pressure_angle)

    def part(gear: SetGear) -> float:
        tip = math.tan(math.acos(min(1.0, gear.base_radius / gear.tip_radius)))
        return gear.teeth * (tip - at_pitch) / (2 * math.pi)

    return mesh.sense * part(mesh.central), part(mesh.planet)


def mesh_efficiencies(planetary_set: PlanetarySet, friction: float, sharing: Sharing) -> Mapping[str, float]:
    """1 - mu pi (1/z_p + s/z) E/cos beta_b of each mesh, by its central gear; see model.efficiency.

    Teeth slide in the transverse section; their normal force leans out of it (Niemann and Winter, Machine Elements II).
    """
    factor = sliding_factor if sharing == "formula" else shared_sliding_factor
    return {
        mesh.central.name: 1
        - friction
        * math.pi
        * (1 / mesh.planet.teeth + mesh.sense / mesh.central.teeth)
        * factor(*contact_ratios(mesh))
        / mesh.central.base_helix_cosine
        for mesh in planetary_set.meshes
    }


def set_efficiency(planetary_set: PlanetarySet, friction: float) -> Efficiencies:
    """Efficiencies by equilibrium of the torques; pairs of teeth in contact carry alike."""
    drive = Drive(
        *(
            CARRIER if shaft == planetary_set.carrier else shaft
            for shaft in (planetary_set.input, planetary_set.output, planetary_set.held)
        )
    )
    meshes = mesh_efficiencies(planetary_set, friction, "equal shares")
    return Efficiencies(
        efficiency(planetary_set.teeth, meshes, drive), efficiency(planetary_set.teeth, meshes, drive.reversed)
    )


def formula_efficiency(planetary_set: PlanetarySet, friction: float) -> Efficiencies | None:
    """Efficiencies by the published closed form of a 3K set, with the published E; None for any other set."""
    central = {mesh.central.name: mesh for mesh in planetary_set.meshes}
    if len(central) != 3 or planetary_set.carrier in (planetary_set.held, planetary_set.input, planetary_set.output):
        return None
    sun, ring_1, ring_2 = (central[shaft] for shaft in (planetary_set.input, planetary_set.held, planetary_set.output))
    if sun.central.is_ring or not (ring_1.central.is_ring and ring_2.central.is_ring) or sun.planet != ring_1.planet:
        return None
    meshes = mesh_efficiencies(planetary_set, friction, "formula")
    given = MeshEfficiencies(*(meshes[mesh.central.name] for mesh in (sun, ring_1, ring_2)))
    teeth = ToothSet(tuple(planetary_set.teeth.mesh(mesh.central.name) for mesh in (sun, ring_1, ring_2)))
    return published_efficiencies(teeth, given)


BEYOND: Final = 1.4  # times the torque at which the region of low stiffness is crossed
STEPS: Final = 60  # of the curve, from none to the peak


def set_sections(
    planetary_set: PlanetarySet, friction: float | None, spring: SpringSummary | None = None
) -> Mapping[str, PlanetarySetSummary]:
    """The set by its name; nothing where neither friction of the teeth nor a spring of the carrier is given.

    Args:
        friction: coefficient of friction of the teeth.
        spring: data of that of a flexible carrier.
    """
    if friction is None and spring is None:
        return {}
    formula = None if friction is None else formula_efficiency(planetary_set, friction)
    meshes = {} if friction is None else mesh_efficiencies(planetary_set, friction, "equal shares")
    found = made(
        PlanetarySetSummary,
        input=planetary_set.input,
        output=planetary_set.output,
        held=planetary_set.held,
        ratio=float(planetary_set.ratio),
        friction=friction,
        meshes_percent={name: 100 * each for name, each in meshes.items()} or None,
        efficiency=None if friction is None else _percents(set_efficiency(planetary_set, friction)),
        efficiency_by_formula=None if formula is None else _percents(formula),
        spring=spring,
    )
    return {planetary_set.name: found}


def spring_summary(planetary_set: PlanetarySet, mean: Deviated, spring: LeafSpring) -> SpringSummary:
    """Torques at both shafts, and the curve of the output; of one trial with all deviations at their means."""
    torques, stiffness = dict[str, float](), dict[str, float]()
    for shaft in (planetary_set.input, planetary_set.output):
        torques[shaft] = min(abs(torque) for torque in breakaway(planetary_set, mean, shaft, spring))
        per_force = torques[shaft] / (spring.force + spring.friction)  # mm/rad, of the planets' displacement
        stiffness[shaft] = spring.stiffness * per_force**2 * RAD_PER_ARCMIN
    peak = BEYOND * crossing(displaced_ends(planetary_set, mean, planetary_set.output), spring)
    curve = hysteresis(planetary_set, mean, planetary_set.output, spring, peak, STEPS).curve
    return made(
        SpringSummary,
        force_n=spring.force,
        stiffness_n_per_mm=spring.stiffness,
        friction_n=spring.friction,
        breakaway_n_mm=torques,
        low_stiffness_n_mm_per_arcmin=stiffness,
        curve=curve,
    )


def _percents(found: Efficiencies) -> EfficiencySummary:
    return made(EfficiencySummary, forward_percent=100 * found.forward, backward_percent=100 * found.backward)
