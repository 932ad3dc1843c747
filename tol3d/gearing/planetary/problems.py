"""Reason why a set cannot be studied: its mean build jams."""

from collections.abc import Iterator

import numpy as np

from tol3d.gearing.planetary.first_order.stack_up import StackUp
from tol3d.gearing.planetary.model.deviated import Deviated
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet
from tol3d.gearing.planetary.model.set_mesh import SetMesh
from tol3d.study.system.system import KeyPath

ROUNDING = 1e-9  # mm; no clearance is legal, and rounds to 1e-14


def problems_at(planetary_set: PlanetarySet, deviated: Deviated, shaft: str) -> Iterator[tuple[KeyPath, str]]:
    """Meshes that overlap at the mean build, of one trial, then load paths of several planets that do."""
    jams = False
    lower, upper = StackUp(planetary_set).sides(deviated, np.zeros(1))
    room = (upper - lower).reshape(planetary_set.planets, -1).min(axis=0)
    for mesh, backlash in zip(planetary_set.meshes, room, strict=True):
        if backlash < -ROUNDING:
            jams = True
            yield ("moves", planetary_set.name, "meshes", mesh.central.name), _interfering(mesh, float(backlash))
    if not jams:
        yield from _bound(planetary_set, deviated, shaft)


def _interfering(mesh: SetMesh, backlash: float) -> str:
    side = "least" if mesh.sense > 0 else "largest"
    normal = 1e3 * backlash * mesh.central.base_helix_cosine
    return (
        f"the teeth interfere at the mean build: {mesh.name} has a normal backlash of {normal:.3f} um there "
        f"(nominal {1e3 * mesh.normal_backlash:.3f} um); the {side} centre distance of the nominal teeth is "
        f"{mesh.tight_centre_distance:.4f} mm, got {mesh.centre_distance:.4f} mm. Change it or the profile shifts, or "
        "thin the teeth"
    )


def _bound(planetary_set: PlanetarySet, deviated: Deviated, shaft: str) -> Iterator[tuple[KeyPath, str]]:
    free = StackUp(planetary_set).free(deviated, np.zeros(1), shaft, planetary_set.opposite(shaft))
    if free.status[0] == 1 and free.lacking[0] > ROUNDING:
        planet, place = divmod(int(free.row[0]), len(planetary_set.meshes))
        if any(not spring.pushes for spring in planetary_set.springs):
            words = f"each contact that stops them lacks {1e3 * free.lacking[0]:.3f} um. Lessen the adjustment"
            yield (
                ("parts", planetary_set.carrier, "adjustment"),
                f"the planets cannot be displaced that far at the mean build: {words}",
            )
            return
        yield (
            ("moves", planetary_set.name),
            f"the planets bind at the mean build: no turn of planet {planet + 1} fits "
            f"{planetary_set.meshes[place].name} and the meshes that close a loop with it; each of them lacks "
            f"{1e3 * free.lacking[0]:.3f} um along the line of action. "
            "Thin the teeth, or bring pins and clocking nearer their nominal places",
        )
