"""Sets of the tests: the published 3K one, random simple, compound and Wolfrom ones, and random deviations of them."""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.planetary import CentralMesh
from tol3d.gearing.planetary.model.deviated import Deviated
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet, Spring
from tol3d.gearing.planetary.model.set_mesh import SetGear, SetMesh

Array = NDArray[np.float64]
ALPHA = math.radians(20)
ARCMIN = math.radians(1 / 60)

ONE = (Spring((0, 2), (1, 3)),)
PAIRS = (Spring((0,), (1,)), Spring((2,), (3,)))
KAPPA, R_S, R_R2 = 24 / 27, 12.5, 38.0
CLEARANCE = 0.03  # mm, of each flank at the pitch circle


def external(name: str, teeth: int, module: float = 1.0, shift: float = 0.0) -> SetGear:
    return SetGear(name, teeth, module, ALPHA, shift)


def ring(name: str, teeth: int, module: float = 1.0, shift: float = 0.0) -> SetGear:
    return SetGear(name, teeth, module, ALPHA, shift, is_ring=True)


def set_of(
    meshes: list[tuple[SetGear, SetGear]], distance: float, planets: int, roles: tuple[str, str, str]
) -> PlanetarySet:
    """With the held, the driving and the driven shaft."""
    gears = tuple(dict.fromkeys(own for _, own in meshes))
    return PlanetarySet(
        "set", tuple(SetMesh(central, own, distance) for central, own in meshes), planets, gears, "carrier", *roles,
        tuple(2 * math.pi * k / planets for k in range(planets)),
    )  # fmt: skip


def reducer_3k(planets: int = 4) -> PlanetarySet:
    """The published one: 25, 27, 79, 24, 76."""
    first, second = external("P1", 27), external("P2", 24)
    meshes = [(external("sun", 25), first), (ring("ring 1", 79), first), (ring("ring 2", 76), second)]
    return set_of(meshes, 26.0, planets, ("ring 1", "sun", "ring 2"))


def random_set(rng: np.random.Generator) -> PlanetarySet:
    """Simple, compound or Wolfrom, any shaft held; tooth sums up to two apart, so that working angles differ."""
    kind = rng.integers(3)
    first, sun = (int(rng.integers(17, 40)) for _ in range(2))
    module, planets = float(rng.uniform(0.5, 4)), int(rng.integers(2, 6))
    half = (sun + first) * module / 2
    planet = external("P1", first, module)
    meshes = [(external("sun", sun, module), planet)]
    if kind == 0:
        meshes.append((ring("ring", sun + 2 * first, module), planet))
    if kind == 1:
        second = external("P2", first + int(rng.integers(2, 9)), module)
        meshes.append((ring("ring", sun + first + second.teeth + int(rng.integers(0, 3)), module), second))
    if kind == 2:
        second = external("P2", first - int(rng.integers(2, 6)), module)
        meshes.append((ring("ring 1", sun + 2 * first + int(rng.integers(0, 3)), module), planet))
        meshes.append((ring("ring 2", sun + first + second.teeth + int(rng.integers(0, 3)), module), second))
    shafts = [central.name for central, _ in meshes] + ["carrier"]
    held, driving, driven = (str(own) for own in rng.permutation(shafts)[:3])
    return set_of(meshes, half * 1.001, planets, (held, driving, driven))


def random_deviations(own: PlanetarySet, trials: int, rng: np.random.Generator, size: float = 1.0) -> Deviated:
    """Teeth thinned unequally by 25 to 45 um; offsets, pins and clocking of some um times `size`."""
    deviated = Deviated.nothing(own, trials)
    for array in (deviated.central_thickness, deviated.planet_thickness):
        array[...] = -rng.uniform(0.025, 0.045, array.shape)
    for array in (deviated.central_offset, deviated.planet_offset, deviated.pins):
        array[...] = size * rng.normal(0, 0.004, array.shape)
    for array in (deviated.central_clocking, deviated.planet_clocking):
        array[...] = size * rng.normal(0, 0.0003, array.shape)
    return deviated


@dataclass(frozen=True)
class PitchRows:
    """The same gaps worked out anew, as arcs at the working pitch circles and with turns in one fixed frame.

    Args:
        rows: (contacts, coordinates): turns of the central gears, the carrier, the planets.
        lower, upper: of each [mm].
    """

    rows: Array
    lower: Array
    upper: Array


def pitch_rows(own: PlanetarySet, deviated: Deviated, trial: int, turns: float) -> PitchRows:
    """A planet at its azimuth is pushed along and across the pitch circle by whatever lies off its place."""
    rows, lower, upper = [], [], []
    centrals = len(own.meshes)
    out, held, _ = (own.turn(name) for name in (own.output, own.held, own.input))
    planet_turns = float(turns / (out - held))  # of a planet against the carrier
    for k in range(own.planets):
        azimuth = own.azimuths[k]
        for m, mesh in enumerate(own.meshes):
            gear = [g.name for g in own.gears].index(mesh.planet.name)
            s = -1 if mesh.central.is_ring else 1
            one = mesh.centre_distance / (mesh.central.teeth + s * mesh.planet.teeth)
            r_c, r_p = one * mesh.central.teeth, one * mesh.planet.teeth
            cos = mesh.central.base_radius / r_c
            tan = math.sqrt(1 - cos * cos) / cos
            row = np.zeros(centrals + 1 + own.planets)
            row[m], row[centrals + 1 + k] = s * r_c, r_p
            row[centrals] = -s * mesh.centre_distance
            gear_angle = 2 * math.pi * planet_turns * (-s) * mesh.planet.teeth / mesh.central.teeth
            shift = deviated.pins[trial, k].copy()
            shift += _turned(deviated.planet_offset[trial, gear, k], 2 * math.pi * planet_turns + own.phase(k))
            shift -= _turned(deviated.central_offset[trial, m], gear_angle - azimuth)
            thick = deviated.central_thickness[trial, m] + deviated.planet_thickness[trial, gear, k]
            room = mesh.clearance / cos - thick * (math.cos(ALPHA) / cos) / 2 + s * tan * shift[0]
            middle = s * shift[1] - r_p * deviated.planet_clocking[trial, gear, k]
            middle -= s * r_c * deviated.central_clocking[trial, m]
            rows.append(row)
            lower.append(middle - room)
            upper.append(middle + room)
    return PitchRows(np.array(rows), np.array(lower), np.array(upper))


def _turned(vector: Array, angle: float) -> Array:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([cos * vector[0] - sin * vector[1], sin * vector[0] + cos * vector[1]])


def free_by_highs(own: PlanetarySet, found: PitchRows, shaft: str, stands: str) -> Any:
    """Smallest and largest turn of a shaft [rad] by scipy's HiGHS; None where there is no room."""
    from scipy.optimize import linprog

    still = [own.shafts.index(name) for name in (own.held, stands)]
    bounds = [(0.0, 0.0) if place in still else (None, None) for place in range(found.rows.shape[1])]
    turn = np.zeros(found.rows.shape[1])
    turn[own.shafts.index(shaft)] = 1.0
    both = np.vstack([found.rows, -found.rows]), np.concatenate([found.upper, -found.lower])
    ends = []
    for sense in (1.0, -1.0):
        solved = linprog(sense * turn, A_ub=both[0], b_ub=both[1], bounds=bounds, method="highs")
        if solved.status == 2:
            return None
        assert solved.status == 0
        ends.append(sense * solved.fun)
    return ends


def flexible(displacement: float | None = None, springs: tuple[Spring, ...] = ONE) -> PlanetarySet:
    """The published set with springs, or with planets displaced [mm]."""
    return replace(reducer_3k(), springs=tuple(replace(own, displacement=displacement) for own in springs))


def thinned(c_a: float, c_b: float, c_c: float, trials: int = 1) -> Deviated:
    """Teeth of the central gears thinned by so much a flank [mm]: gaps of each mesh alike in all planets."""
    deviated = Deviated.nothing(reducer_3k(), trials)
    deviated.central_thickness[:] = [-2 * c_a, -2 * c_b, -2 * c_c]
    return deviated


def working_radii(mesh: CentralMesh, centre_distance: float) -> tuple[float, float]:
    """Radii [mm] of the working pitch circles of central gear and planet at a centre distance [mm]."""
    one = centre_distance / mesh.tooth_sum
    return one * mesh.teeth, one * mesh.planet_teeth
