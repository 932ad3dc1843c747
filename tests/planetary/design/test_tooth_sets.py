"""Ratios and assembly of planetary sets, against gears that are turned and placed tooth by tooth."""

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.placed_planets import off_mesh, placed
from planetary_sets import working_radii

from tol3d.errors import GeometryError
from tol3d.gearing.planetary import CARRIER, CentralMesh, ToothSet, compound, simple, wolfrom

TEETH = st.integers(5, 40)


def test_the_3k_of_the_paper_has_its_ratio() -> None:
    built = wolfrom(25, 27, 79, 24, 76)
    i1, i2 = 79 / 25, 79 * 24 / (76 * 27)
    assert float(built.ratio("sun", "ring 2", "ring 1")) == pytest.approx((1 + i1) / (1 - i2), rel=1e-14)
    assert built.ratio("sun", "ring 2", "ring 1") * 25 == 1368
    assert [mesh.tooth_sum for mesh in built.meshes] == [52, 52, 52]
    assert working_radii(built.mesh("ring 2"), 26.0) == (38.0, 12.0)


def test_usual_ratios_of_simple_and_compound_sets() -> None:
    assert simple(20, 25, 70).ratio("sun", CARRIER, "ring") == 1 + 70 / 20
    assert simple(20, 25, 70).ratio("sun", "ring", CARRIER) == -70 / 20
    assert simple(20, 25, 70).ratio("ring", CARRIER, "sun") * 70 == 90
    assert compound(20, 40, 20, 80).ratio("sun", CARRIER, "ring") == 1 + 80 * 40 / (20 * 20)


def test_a_3k_whose_second_ring_is_the_larger_step_s_turns_backwards() -> None:
    assert wolfrom(25, 24, 76, 27, 79).ratio("sun", "ring 2", "ring 1") < 0


def test_a_ring_that_cannot_turn_is_refused() -> None:
    with pytest.raises(GeometryError, match="ring 2 does not turn while ring 1 is held"):
        wolfrom(20, 20, 60, 20, 60).ratio("sun", "ring 2", "ring 1")


@given(TEETH, TEETH, TEETH, st.integers(1, 30), st.integers(1, 30))
def test_speeds_roll_without_slip_in_every_mesh(sun: int, p1: int, p2: int, more_1: int, more_2: int) -> None:
    """Pitch point velocities of both gears in the world, of speeds found by least squares: no Willis."""
    rings = (p1 + more_1, p2 + more_2)
    own = wolfrom(sun, p1, rings[0], p2, rings[1])
    # unknown: sun, ring 1, ring 2, carrier, planet; z omega of the gear = z omega_H +- z_p (omega_p - omega_H)
    rolls = np.array(
        [
            [sun, 0, 0, -sun - p1, p1],
            [0, rings[0], 0, -rings[0] + p1, -p1],
            [0, 0, rings[1], -rings[1] + p2, -p2],
            [0, 1, 0, 0, 0],
            [1, 0, 0, 0, 0],
        ]
    )
    speeds = np.linalg.solve(rolls.astype(float), [0, 0, 0, 0, 1])
    if abs(speeds[2]) > 1e-9:
        assert float(own.ratio("sun", "ring 2", "ring 1")) == pytest.approx(1 / speeds[2], rel=1e-9)
    assert float(own.ratio("sun", CARRIER, "ring 1")) == pytest.approx(1 / speeds[3], rel=1e-9)


# assembly ----------------------------------------------------------------------------------------------


def test_sets_assemble_exactly_where_placed_teeth_mesh() -> None:
    """3240 Wolfrom sets with 2 to 6 planets: the condition and the placing agree on each, and both answers occur."""
    found = {True: 0, False: 0}
    for sun, p1, p2, d1, d2 in product((12, 15, 20), (8, 9, 12), (6, 8, 9, 10), (-1, 0, 1), (0, 2)):
        own = wolfrom(sun, p1, sun + 2 * p1 + d1, p2, sun + p1 + p2 + d2)
        for planets in (2, 3, 4, 5, 6):
            assert own.assembles(planets) == placed(own, planets), (own, planets)
            found[own.assembles(planets)] += 1
    assert min(found.values()) > 50


@pytest.mark.slow
@given(TEETH, TEETH, TEETH, st.integers(1, 40), st.integers(1, 40), st.integers(2, 7))
def test_any_set_assembles_where_placed_teeth_mesh(a: int, b: int, c: int, d: int, e: int, planets: int) -> None:
    for own in (wolfrom(a, b, b + d, c, c + e), compound(a, b, c, c + d), simple(a, b, b + e)):
        assert own.assembles(planets) == placed(own, planets)


def test_the_set_of_the_paper_assembles_with_two_and_four_planets() -> None:
    built = wolfrom(25, 27, 79, 24, 76)
    assert [planets for planets in range(1, 13) if built.assembles(planets)] == [1, 2, 4]


def test_common_rules_for_compound_planets_are_neither_enough_nor_needed() -> None:
    """Too loose: n | z_S + z_R1 and n | z_R2 - z_R1, or n | z_S z_P2 + z_R2 z_P1 alone."""
    own = wolfrom(22, 28, 78, 24, 74)
    product = 22 * 24 + 74 * 28
    assert (22 + 78) % 4 == (74 - 78) % 4 == product % 4 == 0
    assert not own.assembles(4)
    assert not placed(own, 4)
    (fault, _) = own.assembly_faults(4)
    assert (fault.meshes, fault.product, fault.divisor) == (("sun", "ring 2"), product, 4 * 4)
    assert f"{product} is not divisible by 16" in fault.words
    needless = wolfrom(15, 18, 51, 16, 49)
    assert (49 - 51) % 3 != 0
    assert needless.assembles(3)
    assert placed(needless, 3)


def test_a_simple_set_that_does_not_assemble_says_its_sum() -> None:
    (fault,) = simple(20, 25, 70).assembly_faults(4)
    assert fault.words == "4 identical planets at equal angles do not assemble between sun and ring: 90 is not " + (
        "divisible by 4"
    )


@given(TEETH, TEETH, TEETH, st.integers(1, 12), st.integers(2, 6))
def test_planets_turned_by_their_clocking_mesh(sun: int, p1: int, p2: int, more: int, planets: int) -> None:
    ring_1 = planets * math.ceil((sun + p1) / planets) + planets * more - sun % planets
    own = wolfrom(sun, p1, ring_1, p2, p2 + 17)
    clockings = own.clocking(planets)
    assert (set(clockings) == {0}) == own.assembles(planets)
    assert all(2 * abs(turn) * math.lcm(p1, p2) <= 1 for turn in clockings)
    sun_mesh, _, last = own.meshes
    stood = {mesh.central: off_mesh(mesh, 0.0, 0.0, 0.0) * 2 * math.pi / mesh.teeth for mesh in own.meshes}
    for k, clocking in enumerate(clockings):
        arm = 2 * math.pi * k / planets
        first = off_mesh(sun_mesh, stood["sun"], 0.0, arm) * 2 * math.pi / p1
        turned = [first + 2 * math.pi * (j / p1 + float(clocking)) for j in range(p1)]
        assert min(abs(off_mesh(last, stood["ring 2"], own_turn, arm)) for own_turn in turned) < 1e-8


def test_sets_that_are_none_are_refused() -> None:
    with pytest.raises(GeometryError, match="ring 1: a ring needs more teeth than its planets, got 27 and 27"):
        wolfrom(25, 27, 27, 24, 76)
    with pytest.raises(GeometryError, match="sun: expected at least 3 teeth, got 2"):
        simple(2, 27, 60)
    with pytest.raises(GeometryError, match="step 1 of the planets has 21 teeth in another mesh, got 20"):
        ToothSet((CentralMesh("sun", 20, 20, False), CentralMesh("ring", 60, 21, True)))
    with pytest.raises(GeometryError, match="3 identical planets at equal angles do not assemble between sun and"):
        wolfrom(25, 27, 79, 24, 76).clocking(3)
