"""Losses of meshes and of sets: the published closed forms, equilibrium of torques, friction summed along the path."""

import math
import random
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from planetary_sets import working_radii

from tol3d.apps.design.shifted_set import tip_gap
from tol3d.apps.design.working_mesh import BasicRack, WorkingMesh, mesh_efficiency, shift_sum
from tol3d.errors import GeometryError
from tol3d.gearing.planetary import CARRIER, ToothSet, compound, simple, wolfrom
from tol3d.gearing.planetary.model.efficiency import (
    Drive,
    MeshEfficiencies,
    balances,
    efficiency,
    inner_ratios,
    published_efficiencies,
    shared_sliding_factor,
    sliding_factor,
)

BUILT = wolfrom(25, 27, 79, 24, 76)
REDUCER = Drive("sun", "ring 2", "ring 1")
FRICTION = 0.08
PARTS = st.floats(0.0, 1.0)


def meshes(teeth: ToothSet = BUILT, rack: BasicRack = BasicRack()) -> list[WorkingMesh]:  # noqa: B008
    return [WorkingMesh(mesh, rack, mesh.tooth_sum * rack.module / 2, 0.0, 0.0) for mesh in teeth.meshes]


def by_name(teeth: ToothSet, efficiencies: MeshEfficiencies) -> dict[str, float]:
    return dict(zip((mesh.central for mesh in teeth.meshes), efficiencies, strict=True))


# meshes ------------------------------------------------------------------------------------------------


def test_the_sliding_factors_of_the_paper_s_set() -> None:
    assert [round(sliding_factor(*own.contact_ratios), 5) for own in meshes()] == [0.69265, 0.97524, 0.97470]


def test_sliding_factors_by_where_tip_circles_cut_the_line_of_action() -> None:
    """Lengths in the plane instead of tangents of tip angles; nothing is shifted, pitch circles are reference ones."""
    alpha = math.radians(20)
    line = np.array([math.sin(alpha), math.cos(alpha)])
    for own in meshes():
        r, r_p = own.mesh.teeth / 2, own.mesh.planet_teeth / 2
        centre = (
            np.array([-r, 0.0]) if own.mesh.internal else np.array([r, 0.0])
        )  # of the central gear, off the pitch point
        parts = []
        for middle, tip in ((centre, r - 1 if own.mesh.internal else r + 1), (np.array([-r_p, 0.0]), r_p + 1)):
            half = float(line @ middle)
            root = math.sqrt(half**2 - float(middle @ middle) + tip**2)
            parts.append(min(abs(half + root), abs(half - root)) / (math.pi * math.cos(alpha)))
        first, second = parts
        expected = first**2 + second**2 - first - second + 1
        assert sliding_factor(*own.contact_ratios) == pytest.approx(expected, abs=1e-12)


def friction_power(own: WorkingMesh, friction: float, pairs: int = 20_000) -> float:
    """Friction over power, both summed along a base pitch from places of contact and speeds of the flanks there.

    The planet turns by 1 about the origin, the central gear about the point at a; load is shared alike.
    """
    (base, planet_base), a = own.base_radii, own.centre_distance
    speed = planet_base / base * (1 if own.mesh.internal else -1)
    centre = np.array([-a if own.mesh.internal else a, 0.0])
    angle = own.working_angle
    along = np.array([math.sin(angle), math.cos(angle)])  # line of action through the pitch point, away from the planet
    pitch = np.array([working_radii(own.mesh, a)[1], 0.0])
    reach = math.sqrt(own.tip_radii[1] ** 2 - planet_base**2) - planet_base * math.tan(angle)
    mate = base * math.tan(angle) - math.sqrt(own.tip_radii[0] ** 2 - base**2)
    back = mate if own.mesh.internal else -mate
    step = 2 * math.pi * planet_base / own.mesh.planet_teeth
    lost = 0.0
    for phase in (np.arange(pairs) + 0.5) / pairs:
        places = [q for k in range(-4, 5) if -back <= (q := (phase + k) * step) <= reach]
        points = [pitch + q * along for q in places]
        planet_speeds = [np.array([-p[1], p[0]]) for p in points]
        central_speeds = [speed * np.array([-(p - centre)[1], (p - centre)[0]]) for p in points]
        slides = [np.linalg.norm(u - v) for u, v in zip(planet_speeds, central_speeds, strict=True)]
        lost += friction * float(sum(slides)) / len(places)
    return lost / pairs / planet_base


@pytest.mark.parametrize("which", range(3))
def test_a_mesh_loses_what_friction_takes_along_its_path(which: int) -> None:
    """With equal shares by speeds of flanks in the plane; the midpoint rule errs by the ends of the path, 1/pairs."""
    own = meshes()[which]
    expected = 1 - friction_power(own, FRICTION, 4000)
    assert mesh_efficiency(own, FRICTION, "equal shares") == pytest.approx(expected, abs=2e-3 * (1 - expected))


@given(PARTS, PARTS)
def test_the_published_factor_is_that_of_equal_shares_where_the_pitch_point_is_in_single_contact(
    a: float, b: float
) -> None:
    if a + b >= 1.0:
        assert shared_sliding_factor(a, b) == pytest.approx(sliding_factor(a, b), abs=1e-12)


@given(st.floats(-0.8, 2.2), st.floats(-0.8, 2.2))
def test_beyond_that_the_published_factor_is_too_large(a: float, b: float) -> None:
    """So it never promises too much."""
    if a + b >= 1.0:
        assert shared_sliding_factor(a, b) <= sliding_factor(a, b) + 1e-12


def test_both_rings_of_the_paper_s_set_are_beyond_it() -> None:
    """Their paths reach over a base pitch beyond the pitch point: equal shares give 0.9624, not 0.9752."""
    sun, *rings = meshes()
    assert max(sun.contact_ratios) < 1
    assert [round(max(own.contact_ratios), 3) for own in rings] == [1.113, 1.120]
    assert [round(shared_sliding_factor(*own.contact_ratios), 4) for own in rings] == [0.9624, 0.9604]


# shifts and planets ------------------------------------------------------------------------------------


@given(st.sampled_from([0, 1, 2]), st.floats(-0.03, 0.06))
def test_shift_sums_leave_no_backlash(which: int, more: float) -> None:
    """Teeth and spaces on the working circle, from the base circle up: thicknesses add up to the pitch there."""
    rack, mesh = BasicRack(), BUILT.meshes[which]
    a = mesh.tooth_sum / 2 * (1 + more)
    total = shift_sum(mesh, rack, a)
    alpha, angle = rack.pressure_angle, math.acos(mesh.tooth_sum / 2 * math.cos(rack.pressure_angle) / a)
    grown = math.tan(alpha) - alpha - math.tan(angle) + angle
    for shift in (0.0, 0.3):
        s = -1 if mesh.internal else 1
        central = (math.pi / 2 + 2 * (total - shift) * math.tan(alpha)) / mesh.teeth + s * grown
        planet = (math.pi / 2 + 2 * shift * math.tan(alpha)) / mesh.planet_teeth + grown
        radii = working_radii(mesh, a)
        pitch = 2 * math.pi * radii[1] / mesh.planet_teeth
        assert 2 * radii[0] * central + 2 * radii[1] * planet == pytest.approx(pitch, abs=1e-11)


def test_a_centre_distance_that_no_mesh_reaches_is_refused() -> None:
    with pytest.raises(GeometryError, match=r"centre distance 24 mm: the mesh of sun needs more than 24\.4320 mm"):
        shift_sum(BUILT.meshes[0], BasicRack(), 24.0)


def test_tips_of_neighbours_by_their_places() -> None:
    places = [26.0 * np.array([math.cos(t), math.sin(t)]) for t in (0.3, 0.3 + 2 * math.pi / 5)]
    assert tip_gap(26.0, 5, 14.5) == pytest.approx(np.linalg.norm(places[0] - places[1]) - 29.0, abs=1e-12)
    assert tip_gap(26.0, 1, 14.5) == math.inf


# sets --------------------------------------------------------------------------------------------------


def test_the_published_efficiencies_of_the_paper_s_set() -> None:
    own = published_efficiencies(BUILT, MeshEfficiencies(*(mesh_efficiency(each, FRICTION) for each in meshes())))
    assert (round(own.forward, 5), round(own.backward, 5)) == (0.85163, 0.82856)
    stated = published_efficiencies(BUILT, MeshEfficiencies(0.99, 0.995, 0.993))
    assert (round(stated.forward, 7), round(stated.backward, 7)) == (0.8631271, 0.8430985)


def random_set(rng: random.Random) -> ToothSet:
    sun, p1, p2 = (rng.randint(12, 60) for _ in range(3))
    return wolfrom(sun, p1, sun + 2 * p1 + rng.randint(-2, 2), p2, sun + p1 + p2 + rng.randint(-2, 2))


def test_published_efficiencies_are_those_of_equilibrium_on_1000_random_sets() -> None:
    """Both kinds, I2 below and above 1, driven at either end; relative to 1e-12.

    Sets that lock themselves backwards are counted apart: there both say so, and only forward is compared.
    """
    rng, kinds, locked = random.Random(3), [0, 0], 0
    while sum(kinds) < 1000:
        own = random_set(rng)
        i2 = Fraction(
            own.meshes[1].teeth * own.meshes[2].planet_teeth, own.meshes[2].teeth * own.meshes[1].planet_teeth
        )
        if i2 == 1:
            continue
        each = MeshEfficiencies(*(rng.uniform(0.97, 1.0) for _ in range(3)))
        expected = published_efficiencies(own, each)
        assert efficiency(own, by_name(own, each), REDUCER) == pytest.approx(expected.forward, rel=1e-12)
        back = efficiency(own, by_name(own, each), REDUCER.reversed)
        if expected.backward <= 0.0:
            assert back <= 0.0
            locked += 1
            continue
        assert back == pytest.approx(expected.backward, rel=1e-12)
        kinds[i2 > 1] += 1
    assert min(kinds) > 300
    assert locked > 10


def test_torques_of_the_paper_s_set_without_losses() -> None:
    """F_R1 = F_S (1 + kappa)/(1 - kappa) = 17 F_S and F_R2 = 18 F_S at the working circles."""
    (own, *_) = balances(BUILT, dict.fromkeys(("sun", "ring 1", "ring 2"), 1.0), REDUCER)
    radii = {mesh.central: working_radii(mesh, 26.0)[0] for mesh in BUILT.meshes}
    forces = {name: own.torques[name] / radii[name] for name in radii}
    assert forces["ring 1"] / forces["sun"] == pytest.approx(17.0, rel=1e-12)
    assert forces["ring 2"] / forces["sun"] == pytest.approx(-18.0, rel=1e-12)
    assert own.efficiency == pytest.approx(1.0, abs=1e-13)


def test_torques_balance_with_losses_and_the_carrier_carries_none() -> None:
    (own, *_) = balances(BUILT, {"sun": 0.99, "ring 1": 0.995, "ring 2": 0.993}, REDUCER)
    assert sum(own.torques.values()) == pytest.approx(0.0, abs=1e-12)
    assert CARRIER not in own.torques
    assert own.efficiency == pytest.approx(-own.torques["ring 2"] / 54.72, rel=1e-12)
    assert own.driven_by_centre == {"sun": True, "ring 1": False, "ring 2": True}


@given(st.integers(12, 40), st.integers(12, 40), st.floats(0.9, 1.0), st.floats(0.9, 1.0))
def test_simple_sets_lose_in_proportion_to_their_rolling_power(sun: int, planet: int, a: float, b: float) -> None:
    """Textbook: (1 + i0 eta_0)/(1 + i0) from sun to carrier, (1 + i0)/(1 + i0/eta_0) back; standing carrier eta_0."""
    own, ring = simple(sun, planet, sun + 2 * planet), sun + 2 * planet
    each, i0 = {"sun": a, "ring": b}, ring / sun
    to_carrier = Drive("sun", CARRIER, "ring")
    assert efficiency(own, each, to_carrier) == pytest.approx((1 + i0 * a * b) / (1 + i0), rel=1e-12)
    assert efficiency(own, each, to_carrier.reversed) == pytest.approx((1 + i0) / (1 + i0 / (a * b)), rel=1e-12)
    assert efficiency(own, each, Drive("sun", "ring", CARRIER)) == pytest.approx(a * b, rel=1e-12)


def test_compound_sets_too() -> None:
    own = compound(20, 40, 20, 80)
    expected = (1 + 8 * 0.98 * 0.99) / 9
    assert efficiency(own, {"sun": 0.98, "ring": 0.99}, Drive("sun", CARRIER, "ring")) == pytest.approx(expected)


def test_a_set_of_a_large_ratio_locks_itself_and_still_drives_forward() -> None:
    """Jammed it stands in equilibrium forward too: the efficient equilibrium comes first."""
    own = wolfrom(20, 40, 100, 39, 99)
    each = MeshEfficiencies(0.98, 0.98, 0.98)
    assert inner_ratios(own)[1] > 0.98**2
    assert efficiency(own, by_name(own, each), REDUCER.reversed) < 0
    forward, jammed = balances(own, by_name(own, each), REDUCER)
    assert forward.efficiency == pytest.approx(published_efficiencies(own, each).forward, rel=1e-12)
    assert jammed.efficiency < 0


def test_at_most_one_equilibrium_of_any_drive_delivers_power() -> None:
    """1000 sets with any three members as input, output and held: a second one is jammed, by self-locking."""
    rng, jammed = random.Random(7), 0
    for _ in range(1000):
        sun, p1, p2 = (rng.randint(12, 50) for _ in range(3))
        own = rng.choice((random_set(rng), simple(sun, p1, sun + 2 * p1), compound(sun, p1, p2, sun + p1 + p2)))
        each = {mesh.central: rng.uniform(0.7, 1.0) for mesh in own.meshes}
        drive = Drive(*rng.sample((*(mesh.central for mesh in own.meshes), CARRIER), 3))
        if own.turn(drive.held) in (own.turn(drive.input), own.turn(drive.output)):
            continue
        found = balances(own, each, drive)
        assert [balance.efficiency > 0 for balance in found] in ([True], [False], [True, False])
        assert all(
            abs(sum(balance.torques.values())) < 1e-9 * max(map(abs, balance.torques.values())) for balance in found
        )
        if len(found) == 2:
            jammed += 1
            assert efficiency(own, each, drive.reversed) <= 0
    assert jammed > 10


# what was published --------------------------------------------------------------------------------------


def test_85_6_and_81_7_percent_cannot_both_come_from_these_formulas() -> None:
    """Forward 85.6 % as printed leaves backward 82.87 % or more, whatever the three meshes lose; not 81.7 %.

    With meshes of 0.96 or better it leaves 84.2 % at most. Of the efficiencies two are tried in steps, the third solved
    for: its share of the forward one is 1/(1 - b c I2).
    """
    i1, i2 = inner_ratios(BUILT)
    for floor, highest in ((0.80, None), (0.96, 84.2)):
        found = []
        for a, b in product(np.linspace(floor, 1.0, 81), repeat=2):
            for forward in (0.8555, 0.856, 0.8565):
                c = (1 - (1 + a * b * i1) * (1 - i2) / ((1 + i1) * forward)) / (b * i2)
                if floor <= c <= 1.0:
                    own = published_efficiencies(BUILT, MeshEfficiencies(a, b, c))
                    assert own.forward == pytest.approx(forward, rel=1e-12)
                    found.append(100 * own.backward)
        assert round(min(found), 2) == 82.87
        assert highest is None or round(max(found), 1) == highest
