"""Internal pairs against outlines of ring and pinion in polar form."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from oracles import internal_brute_force as searched
from oracles.internal_brute_force import InternalBuilds, Ring
from oracles.involute_gear import InvoluteGear
from oracles.poses import pose
from oracles.ring_and_pinion import Toothed, free_turn

from tol3d.errors import GeometryError
from tol3d.gears import LEFT, RIGHT, Displaced, Flank, InternalGear, InternalPair, SpurGear

ALPHA = math.radians(20)
FLANKS: tuple[Flank, Flank] = (RIGHT, LEFT)


def toothed(gear: SpurGear | InternalGear) -> Toothed:
    inside = isinstance(gear, InternalGear)
    nominal = gear.module * (math.pi / 2 + 2 * gear.profile_shift * math.tan(gear.pressure_angle))
    return Toothed(
        teeth=gear.teeth,
        module=gear.module,
        alpha=gear.pressure_angle,
        thickness=nominal + gear.tooth_thickness_deviation,
        first=gear.tip_radius if inside else gear.form_radius,
        last=gear.form_radius if inside else gear.tip_radius,
        inside=inside,
    )


def random_pair(rng: np.random.Generator, ring_drives: bool) -> InternalPair:
    alpha = math.radians(rng.uniform(18, 26))
    module = rng.uniform(0.5, 3.0)
    pinion = SpurGear(
        int(rng.integers(18, 40)),
        module,
        alpha,
        10.0,
        profile_shift=rng.uniform(0.0, 0.3),
        addendum=0.9,
        tooth_thickness_deviation=-rng.uniform(0.0, 0.05) * module,
    )
    ring = InternalGear(
        pinion.teeth + int(rng.integers(20, 60)),
        module,
        alpha,
        10.0,
        profile_shift=rng.uniform(-0.3, 0.0),
        addendum=0.8,
        tooth_thickness_deviation=-rng.uniform(0.01, 0.05) * module,
    )
    touching = InternalPair(pinion, ring, module * (ring.teeth - pinion.teeth) / 2).zero_backlash_centre_distance
    distance = touching - rng.uniform(0.005, 0.05) * module
    return InternalPair(ring, pinion, distance) if ring_drives else InternalPair(pinion, ring, distance)


@pytest.mark.parametrize("ring_drives", [False, True])
def test_backlash_is_the_free_turn_of_the_ring_times_its_base_radius(ring_drives: bool) -> None:
    """1e-7 mm: dense points miss the touching one by (step/2)^2 (1/rho_1 - 1/rho_2)/2, step 1e-4 m, 1/rho < 1/(2 m)."""
    rng = np.random.default_rng(1)
    for _ in range(4):
        pair = random_pair(rng, ring_drives)
        sign = 1.0 if ring_drives else -1.0
        assert pair.wheel_origin.tolist() == [sign * pair.centre_distance, 0.0, 0.0]
        theta = np.array([rng.uniform(0, 2 * math.pi)])
        driven = float(pair.driven_angle(theta)[0])
        turns = (theta[0], driven) if ring_drives else (driven, theta[0])
        free = [
            free_turn(toothed(pair.ring), toothed(pair.inner), np.array([pair.centre_distance, 0.0]), turns, side)
            for side in FLANKS
        ]
        assert free[0] == pytest.approx(free[1], abs=1e-7 / pair.ring.base_radius)  # centred
        assert sum(free) * pair.ring.base_radius == pytest.approx(pair.normal_backlash, abs=1e-7)


@pytest.mark.parametrize("ring_drives", [False, True])
def test_backlash_is_what_both_teeth_leave_of_a_pitch_on_the_working_circles(ring_drives: bool) -> None:
    rng = np.random.default_rng(5)
    for _ in range(200):
        pair = random_pair(rng, ring_drives)
        ratio = pair.inner.teeth / pair.ring.teeth
        ring_radius = pair.centre_distance / (1 - ratio)  # circles that roll in one another, a apart
        inner_radius = ring_radius * ratio
        assert pair.working_radii == pytest.approx(
            (ring_radius, inner_radius) if ring_drives else (inner_radius, ring_radius), rel=1e-14
        )
        teeth = sum(
            2 * radius * float(toothed(gear).half_angle(np.array(radius)))
            for gear, radius in ((pair.ring, ring_radius), (pair.inner, inner_radius))
        )
        left = 2 * math.pi * ring_radius / pair.ring.teeth - teeth
        assert pair.circumferential_backlash == pytest.approx(left, abs=1e-10)
        assert pair.normal_backlash == pytest.approx(left * pair.ring.base_radius / ring_radius, abs=1e-10)
        turns = pair.normal_backlash / pair.pinion.base_radius, pair.normal_backlash / pair.wheel.base_radius
        assert pair.angular_backlash == pytest.approx(turns, rel=1e-14)
        nearest = replace(pair, centre_distance=pair.centre_distance + pair.radial_backlash)
        assert nearest.normal_backlash == pytest.approx(0.0, abs=1e-10)


def test_opening_the_centre_distance_closes_an_internal_pair_by_two_sin_alpha_per_mm() -> None:
    pair = random_pair(np.random.default_rng(6), ring_drives=False)
    slopes = []
    for step in (1e-3, 5e-4):
        more, less = (replace(pair, centre_distance=pair.centre_distance + sign * step) for sign in (1, -1))
        slopes.append((more.normal_backlash - less.normal_backlash) / (2 * step))
    expected = -2 * math.sin(pair.working_pressure_angle)
    assert (4 * slopes[1] - slopes[0]) / 3 == pytest.approx(expected, abs=1e-9)


def test_working_pressure_angle_without_backlash_is_that_of_the_profile_shifts() -> None:
    """inv alpha_w = inv alpha + 2 tan alpha (x_1 + x_2)/(z_1 - z_2), z_2 the ring's and x_2 > 0 inwards."""
    planet = SpurGear(24, 1.0, ALPHA, 10.0, profile_shift=0.31)
    ring = InternalGear(76, 1.0, ALPHA, 10.0, profile_shift=-0.12)
    pair = InternalPair(planet, ring, InternalPair(planet, ring, 25.9).zero_backlash_centre_distance)
    working = pair.working_pressure_angle
    shifts = 2 * math.tan(ALPHA) * (0.31 - 0.12) / (24 - 76)
    assert math.tan(working) - working == pytest.approx(math.tan(ALPHA) - ALPHA + shifts, abs=1e-14)


@pytest.mark.parametrize(
    ("pinion", "wheel", "distance", "why"),
    [
        (InternalGear(40, 1.0, ALPHA, 5.0), InternalGear(60, 1.0, ALPHA, 5.0), 10.0, "one internal gear.*got two"),
        (SpurGear(20, 1.0, ALPHA, 5.0), SpurGear(20, 1.0, ALPHA, 5.0), 20.0, "one internal gear.*got none"),
        (SpurGear(40, 1.0, ALPHA, 5.0), InternalGear(40, 1.0, ALPHA, 5.0), 1.0, "more teeth than the gear inside"),
        (
            SpurGear(20, 1.0, ALPHA, 5.0),
            InternalGear(60, 1.5, ALPHA, 5.0),
            20.0,
            "the same module, got 1 mm and 1.5 mm",
        ),
        (SpurGear(20, 1.0, ALPHA, 5.0), InternalGear(60, 1.0, ALPHA, 5.0), 18.0, "needs more than 18.7939 mm"),
    ],
)
def test_gears_that_are_no_internal_pair_are_refused(
    pinion: SpurGear | InternalGear, wheel: SpurGear | InternalGear, distance: float, why: str
) -> None:
    with pytest.raises(GeometryError, match=why):
        InternalPair(pinion, wheel, distance)


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"teeth": 30}, r"tip circle \(28.0000 mm\).*base circle \(28.1908 mm\).*addendum below 0.9046"),
        ({"outer_diameter": 80.0}, r"outer_diameter: expected more than the root circle \(81.5000 mm\), got 80 mm"),
        ({"root_fillet": 0.5}, "root_fillet: expected more than 0 and at most 0.4415 mm"),
        ({"addendum": -1.5}, "must lie inside the root circle"),
        ({"tooth_thickness_deviation": -0.95}, r"pointed teeth: .*lower addendum below 0\."),
        ({"tooth_thickness_deviation": 1.2}, "no tooth space is left"),
    ],
)
def test_rings_that_cannot_be_made_are_refused_with_their_numbers(change: dict[str, Any], why: str) -> None:
    with pytest.raises(GeometryError, match=why):
        replace(InternalGear(79, 1.0, ALPHA, 10.0), **change)


@pytest.mark.parametrize("ring_drives", [False, True])
def test_flanks_touch_at_the_touching_angle_wherever_the_centres_lie(ring_drives: bool) -> None:
    rng = np.random.default_rng(2)
    for _ in range(4):
        pair = random_pair(rng, ring_drives)
        theta = rng.uniform(0, 2 * math.pi)
        origin = np.stack([np.zeros(3), pair.wheel_origin])
        origin[:, :2] += rng.uniform(-0.01, 0.01, (2, 2)) * pair.ring.module
        flank_turn = rng.uniform(-1e-4, 1e-4, 2)
        displaced = Displaced(origin[None], np.zeros((1, 2, 3)), flank_turn[None])
        ring_index = 0 if ring_drives else 1
        ring = toothed(pair.ring.perturbed(flank_turn[ring_index], 1.0))
        inner = toothed(pair.inner.perturbed(flank_turn[1 - ring_index], 1.0))
        offset = (origin[1 - ring_index] - origin[ring_index])[:2]
        for flank in FLANKS:
            driven = float(pair.touching_angle(np.array([theta]), flank, displaced)[0])
            assert abs(driven - float(pair.driven_angle(np.array([theta]))[0])) < 0.2 * pair.wheel.angular_pitch
            turns = (theta, driven) if ring_drives else (driven, theta)
            side = pair.mating_flank(flank) if ring_drives else flank
            assert abs(free_turn(ring, inner, offset, turns, side)) * pair.ring.base_radius < 1e-7


def plain(gear: SpurGear | InternalGear) -> InvoluteGear | Ring:
    """The plain numbers of a gear for the search."""
    if isinstance(gear, SpurGear):
        return InvoluteGear(
            teeth=gear.teeth,
            module=gear.module,
            pressure_angle=gear.pressure_angle,
            face_width=gear.face_width,
            profile_shift=gear.profile_shift,
            addendum=gear.addendum,
            thickness_deviation=gear.tooth_thickness_deviation,
        )
    return Ring(
        teeth=gear.teeth,
        module=gear.module,
        pressure_angle=gear.pressure_angle,
        face_width=gear.face_width,
        last_radius=gear.form_radius,
        profile_shift=gear.profile_shift,
        addendum=gear.addendum,
        thickness_deviation=gear.tooth_thickness_deviation,
    )


@pytest.mark.parametrize("ring_drives", [False, True])
def test_the_search_of_surfaces_finds_the_closed_backlash_with_eccentric_centres(ring_drives: bool) -> None:
    """2 (r_b2 - r_b1)(inv alpha_w0 - inv alpha_w') at the distance of the centres, wherever they have turned to."""
    rng = np.random.default_rng(3)
    pair = random_pair(rng, ring_drives)
    rows, theta = 3, rng.uniform(0, 2 * math.pi, 3)
    centres = rng.uniform(-0.01, 0.01, (2, rows, 2)) * pair.ring.module
    shafts = [np.tile(pose(np.zeros(3), at), (rows, 1, 1)) for at in (np.zeros(3), pair.wheel_origin)]
    builds = InternalBuilds(plain(pair.pinion), plain(pair.wheel), *shafts, *centres)
    for flank in FLANKS:
        driven = searched.turn_until_contact(builds, theta, searched.tooth_in_space(builds, theta), flank)[1]
        found = searched.normal_backlash(builds, theta, flank)
        for row in range(rows):
            frames = [
                shafts[k][row] @ pose([0, 0, turn], np.zeros(3)) @ pose(np.zeros(3), [*centres[k][row], 0])
                for k, turn in enumerate((theta[row], driven[row]))
            ]
            apart = float(np.hypot(*(frames[1] - frames[0])[:2, 3]))
            closed = InternalPair(pair.pinion, pair.wheel, apart).normal_backlash
            assert found[row] == pytest.approx(closed, abs=3e-6)  # a zoom keeps 4 nm of profile, no more of its height


@pytest.mark.slow
def test_signed_distances_to_a_ring_are_those_to_its_dense_points() -> None:
    rng = np.random.default_rng(4)
    ring = Ring(60, 1.0, ALPHA, 4.0, 30.9)
    strings, heights = np.meshgrid(np.linspace(*ring.strings, 1201), np.linspace(-2.0, 2.0, 401), indexing="ij")
    for flank in FLANKS:
        surface = ring.flank_points(strings, heights, np.array(5.0), flank).reshape(-1, 3)
        radius, z = rng.uniform(28.8, 30.8, 10), rng.uniform(-2.2, 2.2, 10)
        middle = 5 * ring.pitch - flank * ring.pitch / 2
        azimuth = middle + flank * rng.uniform(0.0, 0.5, 10) * (ring.pitch / 2 - ring.half_angle(radius))
        points = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=1)
        dense = np.linalg.norm(points[:, None] - surface, axis=2).min(axis=1)
        found = ring.signed_distance(points, np.array(5.0), flank)
        # steps of 3 um and 10 um: the nearest point is off its foot by at most half of both, at 0.1 mm or more
        assert np.abs(found - dense).max() < (0.002**2 + 0.005**2) / (2 * found.min())
