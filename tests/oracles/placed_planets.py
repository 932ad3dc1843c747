"""Planets put in mesh tooth by tooth: no condition of assembly, only where teeth stand."""

import math

from tol3d.gearing.planetary import CentralMesh, ToothSet

PHASE_XTOL = 1e-9  # pitches; doubles of angles of up to 20 turns leave 1e-13


def off_mesh(mesh: CentralMesh, central: float, planet: float, arm: float) -> float:
    """By how many pitches a planet's tooth misses the middle of the space that it should stand in.

    Orientations of central gear and planet, and the arm's angle, in the world [rad].
    """
    of_central = (arm - central) * mesh.teeth / (2 * math.pi)
    if mesh.internal:
        of_planet = (arm - planet) * mesh.planet_teeth / (2 * math.pi)
        return math.remainder(of_central - of_planet - 0.5, 1.0)
    of_planet = (arm + math.pi - planet) * mesh.planet_teeth / (2 * math.pi)
    return math.remainder(of_central + of_planet - 0.5, 1.0)


def placed(own: ToothSet, planets: int) -> bool:
    """True if each planet, the first one turned, finds an orientation in which it meshes everywhere."""
    central = {}
    for mesh in own.meshes:  # planet 0 stands at orientation 0 with its steps' tooth 0 alike
        central[mesh.central] = off_mesh(mesh, 0.0, 0.0, 0.0) * 2 * math.pi / mesh.teeth
        assert abs(off_mesh(mesh, central[mesh.central], 0.0, 0.0)) < PHASE_XTOL
    first = own.meshes[0]
    for k in range(1, planets):
        arm = 2 * math.pi * k / planets
        missing = off_mesh(first, central[first.central], 0.0, arm) * 2 * math.pi / first.planet_teeth
        sense = -1 if first.internal else 1
        tries = [sense * missing + 2 * math.pi * j / first.planet_teeth for j in range(first.planet_teeth)]
        assert abs(off_mesh(first, central[first.central], tries[0], arm)) < PHASE_XTOL
        fits = (
            all(abs(off_mesh(mesh, central[mesh.central], turned, arm)) < PHASE_XTOL for mesh in own.meshes)
            for turned in tries
        )
        if not any(fits):
            return False
    return True
