"""Placed sets against the exact engine's gaps of each pair of flanks: nothing overlaps, nothing can turn further."""

import math
from dataclasses import replace

import numpy as np
import pytest
from gearing.engine_gaps import GearRows, flank_gap
from numpy.typing import NDArray
from planetary_sets import random_deviations, reducer_3k
from scipy.optimize import linprog

from tol3d.gearing.planetary.exact.contact import Contact
from tol3d.gearing.planetary.model.deviated import Deviated
from tol3d.gearing.planetary.model.planetary_set import PlanetarySet, Spring
from tol3d.gearing.planetary.model.set_mesh import SetMesh
from tol3d.gears import LEFT, RIGHT, InternalGear, InternalPair, SpurGear, SpurPair

Array = NDArray[np.float64]

ALPHA = math.radians(20)
UPPER_OF_SUN = 1  # left flanks of a sun stop it counter-clockwise


def turned(vectors: Array, angles: Array) -> Array:
    """Each of vectors (n, 2) by its own angle."""
    cos, sin = np.cos(angles), np.sin(angles)
    return np.stack([cos * vectors[:, 0] - sin * vectors[:, 1], sin * vectors[:, 0] + cos * vectors[:, 1]], axis=-1)


def pair_of(mesh: SetMesh) -> SpurPair | InternalPair:
    """The central gear drives."""
    planet = SpurGear(mesh.planet.teeth, mesh.planet.module, ALPHA, 10.0)
    if mesh.central.is_ring:
        return InternalPair(InternalGear(mesh.central.teeth, 1.0, ALPHA, 10.0, addendum=0.9), planet, 26.0)
    return SpurPair(SpurGear(mesh.central.teeth, 1.0, ALPHA, 10.0), planet, 26.0)


def engine_gaps(own: PlanetarySet, deviated: Deviated, turns: Array, at: Array) -> Array:
    """(trials, planets, meshes, 2) [mm] of right and left flanks of central gears, seen along lines to nominal pins."""
    trials, count = len(turns), len(own.meshes)
    found = np.empty((trials, own.planets, count, 2))
    for k in range(own.planets):
        displaced = sum(
            (at[:, count + 1 + own.planets + j] * spring.sense(k) for j, spring in enumerate(own.springs)),
            np.zeros(trials),
        )
        drift = at[:, count] + displaced / own.centre_distance
        pin = deviated.pins[:, k] + np.array([own.centre_distance, 0.0])
        world_from_planet = np.tile(np.eye(4), (trials, 1, 1))
        world_from_planet[:, :2, 3] = turned(pin, drift)
        planet_from_world = np.asarray(np.linalg.inv(world_from_planet), dtype=np.float64)
        for m, mesh in enumerate(own.meshes):
            gear, pair = own.gear_of(mesh), pair_of(mesh)
            rate = float(own.turn(mesh.central.name) * own.planet_turns)
            central = 2 * math.pi * rate * turns + at[:, m] - own.azimuths[k] + deviated.central_clocking[:, m]
            planet = 2 * math.pi * float(own.planet_turns) * turns + at[:, count + 1 + k] + own.phase(k)
            planet = planet + deviated.planet_clocking[:, gear, k]
            # where nothing has turned a space of the planet stands at azimuth 0 of tooth 0 of the central gear; which
            # tooth is there now decides nothing but where the eccentric centre lies
            driver = wrapped(central, np.zeros(trials), mesh.central.teeth)
            driven = wrapped(planet + pair.driven_angle(np.zeros(trials)), pair.driven_angle(driver), mesh.planet.teeth)
            thick = deviated.central_thickness[:, m], deviated.planet_thickness[:, gear, k]
            centres = deviated.central_offset[:, m], deviated.planet_offset[:, gear, k]
            gears = tuple(
                GearRows(turned(centre, angle - teeth), arc / whose.teeth, np.zeros(trials), np.ones(trials))
                for centre, angle, teeth, arc, whose in zip(
                    centres, (central, planet), (driver, driven), thick, (mesh.central, mesh.planet), strict=True
                )
            )
            for side, flank in enumerate((RIGHT, LEFT)):
                gap = flank_gap(pair, flank, planet_from_world, (driver, driven), (gears[0], gears[1]))
                found[:, k, m, side] = gap.value
    return found


def wrapped(angle: Array, near: Array, teeth: int) -> Array:
    """The angle, whole pitches taken off, nearest to another."""
    pitch = 2 * math.pi / teeth
    return angle - pitch * np.round((angle - near) / pitch)


def farther_by_highs(own: PlanetarySet, gaps: Array, end: int) -> Array:
    """Further turn of the output [rad] where flanks have these gaps; springs stay."""
    rows, turn = own.rows("sun"), own.objective("sun", "ring 2")
    found = []
    for trial in gaps:
        pairs = trial.reshape(-1, 2)
        sense = np.array([mesh.sense for mesh in own.meshes] * own.planets)
        # a right flank of a sun holds n from one side, that of a ring from the other
        upper = np.where(sense > 0, pairs[:, UPPER_OF_SUN], pairs[:, 1 - UPPER_OF_SUN])
        lower = np.where(sense > 0, pairs[:, 1 - UPPER_OF_SUN], pairs[:, UPPER_OF_SUN])
        still = np.zeros(len(own.springs))
        both = np.vstack([rows, -rows]), np.concatenate([upper, still, lower, still]) + 1e-10
        way = 1.0 if end == 1 else -1.0
        found.append(linprog(-way * turn, A_ub=both[0], b_ub=both[1], bounds=(None, None)).fun)
    return np.array(found)


@pytest.mark.slow
@pytest.mark.parametrize("springs", [(), (Spring((0, 2), (1, 3)),)], ids=["rigid", "flexible"])
def test_at_the_ends_nothing_overlaps_and_nothing_turns_further(springs: tuple[Spring, ...]) -> None:
    own, rng = replace(reducer_3k(), springs=springs), np.random.default_rng(12)
    deviated, turns = random_deviations(own, 6, rng), rng.uniform(0, 3, 6)
    free, reached = Contact(own).seated(deviated, turns, "ring 2", "sun")
    assert (free.status == 0).all()
    for end in (0, 1):
        gaps = engine_gaps(own, deviated, turns, reached[:, end]).reshape(6, -1)
        assert gaps.min() > -1e-9
        touching = np.sort(gaps, axis=1)[:, : own.rows("sun").shape[1]]
        assert touching.max() < 1e-9  # as many flanks touch as there are unknowns: a corner
        # the rows of first order say that no motion from there goes further by more than their own error
        further = farther_by_highs(own, engine_gaps(own, deviated, turns, reached[:, end]), end)
        assert np.abs(further).max() < 1e-9
