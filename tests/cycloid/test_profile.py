"""The profile of a cycloid disc against pins that are placed step by step, and against the published numbers."""

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from oracles.rolling_disc import Outline, distance, pin_in_disc, swept
from scipy.optimize import brentq

from tol3d.gearing.cycloid.model.profile import DiscProfile, Modification

RV_250 = DiscProfile(pins=40, pin_circle_radius=114.5, pin_radius=5.0, eccentricity=2.2)
SMALL = DiscProfile(pins=12, pin_circle_radius=30.0, pin_radius=2.0, eccentricity=1.0)
FLAT = DiscProfile(pins=20, pin_circle_radius=60.0, pin_radius=4.0, eccentricity=1.0)  # K = 1/3: tightest at its tips
PROFILES = {"rv 250": RV_250, "small": SMALL, "flat": FLAT}
ARC_SECONDS = math.degrees(1) * 3600

each_profile = pytest.mark.parametrize("profile", PROFILES.values(), ids=PROFILES.keys())


def complex_of(points: NDArray[np.float64]) -> NDArray[np.complex128]:
    return points[..., 0] + 1j * points[..., 1]


def pitch_points(profile: DiscProfile, u: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Points where normals cross the pitch circle [mm], for a disc that is not modified."""
    return np.asarray(profile.pitch_radius * np.exp(1j * profile.pins * np.asarray(u)))


def turn_until_touch(profile: DiscProfile, u: float, pin: complex, centre: complex = 0j) -> float:
    """Turn [rad] of a disc about its displaced centre until its profile touches a pin near parameter u."""
    outline = Outline(profile.points)

    def gap(turn: float) -> float:
        return distance(outline, (pin - centre) * cmath.exp(-1j * turn), u, 0.01) - profile.pin_radius

    return float(brentq(gap, -3e-4, 3e-4, xtol=1e-12))


@each_profile
def test_pins_touch_the_profile_and_never_enter_it_at_any_crank_angle(profile: DiscProfile) -> None:
    """The lobes are looked at in 20000 places, between which a circle of radius r comes in by step^2 / (8 r)."""
    outline = complex_of(profile.points(np.linspace(0.0, 2 * math.pi, 20001)))
    sagitta = np.abs(np.diff(outline)).max() ** 2 / (8 * profile.pin_radius)
    for centre in swept(profile.pins, profile.pin_circle_radius, profile.eccentricity, 17)[::5].ravel():
        least = float(np.abs(outline - centre).min())
        assert profile.pin_radius - 1e-12 <= least <= profile.pin_radius + 2 * sagitta


@each_profile
def test_parameter_and_phase_of_a_pin_follow_from_its_place_and_the_crank(profile: DiscProfile) -> None:
    for pin, crank in ((0, 0.3), (3, 1.7), (profile.pins - 1, -2.0)):
        placed = pin_in_disc(profile.pins, profile.pin_circle_radius, profile.eccentricity, pin, crank)
        u = 2 * math.pi * pin / profile.pins + crank / profile.lobes
        assert complex_of(profile.pin_centres(u)) == pytest.approx(placed, abs=1e-12)
        # the angle from the radius to the pin to the crank, in the world
        assert math.cos(profile.phase(u)) == pytest.approx(math.cos(crank - 2 * math.pi * pin / profile.pins))


@each_profile
def test_normals_are_square_to_the_curve_point_outwards_and_pass_the_pitch_point(profile: DiscProfile) -> None:
    u, h = np.linspace(0.0, profile.lobe_pitch, 41), 1e-6
    ahead = complex_of(profile.points(u + h)) - complex_of(profile.points(u - h))
    normal = complex_of(profile.normals(u))
    assert np.abs(normal) == pytest.approx(1.0)
    # a counter-clockwise outline has its outside on the right
    assert np.angle(ahead / normal) == pytest.approx(math.pi / 2, abs=1e-8)
    towards = pitch_points(profile, u) - complex_of(profile.points(u))
    assert (towards * normal.conj()).imag == pytest.approx(0.0, abs=1e-10)
    # the pitch point is where the pins' pitch circle, a Zp about the ring, rolls on the disc's, a Zc about its centre
    assert np.abs(pitch_points(profile, u)) == pytest.approx(profile.eccentricity * (profile.pins - 1))


@each_profile
def test_slopes_and_curvature_are_those_of_neighbouring_points(profile: DiscProfile) -> None:
    modified = replace(profile, modification=Modification(-0.03, 0.01, 2e-4))
    u, h = np.linspace(0.002, math.pi / profile.lobes - 0.002, 41), 1e-5
    before, here, after = (complex_of(modified.points(u + k * h)) for k in (-1, 0, 1))
    second = (after - 2 * here + before) / h**2
    first = (after - before) / (2 * h)
    # differences are of order two: h^2 P''' / 6, and P''' is under 4e7 mm for all three
    assert complex_of(modified.slopes(u)) == pytest.approx(first, abs=7e-4)
    bent = (first.conj() * second).imag / np.abs(first) ** 3
    path = modified.path_curvature(u)
    assert path / (1 - modified.ground.pin_radius * path) == pytest.approx(bent, rel=1e-4, abs=1e-5)


@each_profile
def test_tip_and_root_circle_are_the_ends_of_the_radius(profile: DiscProfile) -> None:
    modified = replace(profile, modification=Modification(-0.03, 0.01))
    for own in (profile, modified):
        radius = np.abs(complex_of(own.points(np.linspace(0.0, own.lobe_pitch, 1001))))
        assert (radius.min(), radius.max()) == pytest.approx((own.root_radius, own.tip_radius), abs=1e-12)
    assert modified.tip_radius == pytest.approx(profile.tip_radius - 0.04)


# levers ---------------------------------------------------------------------------------------------


@each_profile
def test_the_lever_is_that_of_the_pins_push_about_the_discs_axis(profile: DiscProfile) -> None:
    u = np.linspace(0.0, profile.lobe_pitch, 41)
    moment = (complex_of(profile.points(u)).conj() * -complex_of(profile.normals(u))).imag
    assert profile.lever(u) == pytest.approx(moment, abs=1e-12)


def test_the_lever_is_largest_where_cos_t_is_the_shortening() -> None:
    assert RV_250.shortening == pytest.approx(0.768559, abs=5e-7)
    assert RV_250.pitch_radius == pytest.approx(85.8)
    # half a million steps: of 0.00036 degrees
    u = np.linspace(0.0, math.pi / 39, 500001)
    lever = RV_250.lever(u)
    assert lever.max() == pytest.approx(85.8, abs=1e-6)
    best = math.degrees(39 * u[lever.argmax()])
    assert best == pytest.approx(39.78, abs=0.005)
    assert math.degrees(RV_250.best_phase) == pytest.approx(best, abs=4e-4)


@pytest.mark.parametrize(
    ("moved", "published"),
    # the digest prints 1.5381 for sqrt(1 - K^2)/rc' = 1.53804 arc seconds
    [("disc", 2.4040), ("pin outwards", -1.53804), ("pin clockwise", -1.8476)],
)
def test_a_micrometre_at_the_best_pin_turns_the_disc_by_the_published_angles(moved: str, published: float) -> None:
    """At a pin that stops the disc clockwise: what opens its gap lets the disc turn on, by a negative angle."""
    u = RV_250.best_phase / 39
    pin, outwards = complex(complex_of(RV_250.pin_centres(u))), cmath.exp(1j * u)
    crank = cmath.exp(1j * RV_250.pins * u)
    centre = 0j
    if moved == "disc":  # square to the crank, towards the pin
        centre = -1e-3j * crank if (outwards / crank).imag < 0 else 1e-3j * crank
    elif moved == "pin outwards":
        pin += 1e-3 * outwards
    else:
        pin -= 1e-3j * outwards
    turn = turn_until_touch(RV_250, u, pin, centre) * ARC_SECONDS
    # second order: 1 um over a radius of curvature of 70 mm
    assert turn == pytest.approx(published, rel=5e-5)


def test_the_output_turns_by_0_96296_of_the_disc_where_the_sun_is_held() -> None:
    """Unknowns: turn of disc and carrier, turn of the cranks; planets of twice the sun's teeth roll about the sun."""
    turns = np.linalg.solve([[1, 1 / 39], [-(1 + 1 / 2), 1]], [1.0, 0.0])
    assert turns[0] == pytest.approx(0.96296, abs=5e-6)
    assert turns[0] == pytest.approx((80 / 81) * (39 / 40))


# curvature ------------------------------------------------------------------------------------------


def circumradius(a: complex, b: complex, c: complex) -> float:
    """Radius of the circle through three points; negative where they turn right."""
    area = ((b - a).conjugate() * (c - a)).imag
    return abs(b - a) * abs(c - b) * abs(c - a) / (2 * area) if area else math.inf


@each_profile
def test_smallest_convex_radius_is_that_of_circles_through_neighbouring_pin_centres(profile: DiscProfile) -> None:
    step = 2e-4
    places = complex_of(profile.pin_centres(np.arange(0.0, profile.lobe_pitch, step)))
    radii = [circumradius(*places[k : k + 3].tolist()) for k in range(len(places) - 2)]
    least = min(radius for radius in radii if radius > 0)
    # both the sampling and the circles are off by order two
    assert profile.smallest_convex_radius == pytest.approx(least, rel=1e-4)


def test_smallest_convex_radius_of_the_published_disc_is_9_0547_mm() -> None:
    assert RV_250.smallest_convex_radius == pytest.approx(9.0547, abs=5e-5)


def test_the_closed_form_changes_over_at_its_bound_without_a_step() -> None:
    bound = (40 - 2) / (2 * 40 - 1)
    radii = [
        replace(RV_250, eccentricity=(bound + off) * 114.5 / 40).smallest_convex_radius for off in (-1e-9, 0.0, 1e-9)
    ]
    assert radii == pytest.approx([radii[1]] * 3, rel=1e-7)


# modification ---------------------------------------------------------------------------------------


def exact_gap(profile: DiscProfile, u: float) -> float:
    """Gap between a nominal pin and the right flank, by search."""
    pin = complex(complex_of(profile.pin_centres(u)))
    outline = Outline(profile.ground.points, profile.modification.rotation)
    return distance(outline, pin, u, 0.01) - profile.pin_radius


@pytest.mark.parametrize("modification", [(-1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, -0.5, 1)], ids=str)
def test_clearance_is_the_gap_to_first_order(modification: tuple[float, float, float]) -> None:
    """Halved, a modification leaves a quarter of the difference."""
    u = np.linspace(0.01, 0.07, 7)

    def differences(size: float) -> NDArray[np.float64]:
        shift, offset, rotation = modification
        own = replace(RV_250, modification=Modification(size * shift, size * offset, size * rotation / 100))
        return own.clearance(u) - np.array([exact_gap(own, place) for place in u])

    full, half = differences(0.04), differences(0.02)
    assert np.abs(full).max() < 4e-4
    assert half == pytest.approx(full / 4, abs=0.03 * np.abs(full).max() + 1e-10)


def test_clearance_is_shift_times_cosine_offset_and_rotation_times_lever() -> None:
    t = np.linspace(0.1, 3.0, 9)
    k = 40 * 2.2 / 114.5
    w = np.sqrt(1 + k**2 - 2 * k * np.cos(t))
    shifted, grown, rotated = (
        replace(RV_250, modification=Modification(**{name: value})).clearance(t / 39)
        for name, value in (("shift", -0.02), ("offset", 0.01), ("rotation", 1e-4))
    )
    assert shifted == pytest.approx(0.02 * (1 - k * np.cos(t)) / w)
    assert grown == pytest.approx(0.01)
    assert rotated == pytest.approx(1e-4 * 85.8 * np.sin(t) / w)


def test_the_usual_shift_and_offset_leave_nothing_at_the_best_lobe_and_some_at_all_others() -> None:
    k = 40 * 2.2 / 114.5
    own = replace(RV_250, modification=Modification(-0.02, -0.02 * math.sqrt(1 - k**2)))
    best = RV_250.best_phase / 39
    assert own.clearance(best) == pytest.approx(0.0, abs=1e-15)
    others = own.clearance(np.linspace(0.0, math.pi / 39, 1001))
    assert others.min() >= 0.0
    assert own.clearance([0.0, math.pi / 39]) == pytest.approx(0.02 * (1 - math.sqrt(1 - k**2)))


@pytest.mark.parametrize("rotation", [3e-4, -1e-4])
def test_rotated_flanks_meet_in_the_middle_of_root_and_tip(rotation: float) -> None:
    own = replace(RV_250, modification=Modification(-0.02, -0.01, rotation))
    ends = Outline(own.ground.points, rotation)(np.array(own.flank_ends))
    assert np.angle(ends) == pytest.approx([0.0, math.pi / 39], abs=1e-14)


@settings(max_examples=50, deadline=None)
@given(st.floats(0.0, 6.28), st.floats(-0.03, 0.03), st.floats(-0.03, 0.03), st.floats(0.0, 1e-3))
def test_left_flanks_are_right_flanks_in_the_mirror(u: float, shift: float, offset: float, rotation: float) -> None:
    own = replace(RV_250, modification=Modification(shift, offset, rotation))
    if abs(math.sin(own.phase(u))) > 1e-9:
        assert own.points(-u) == pytest.approx(own.points(u) * [1, -1], abs=1e-10)
        assert own.normals(-u) == pytest.approx(own.normals(u) * [1, -1], abs=1e-10)
        assert own.lever(-u) == pytest.approx(-own.lever(u), abs=1e-9)
        assert own.clearance(-u) == pytest.approx(own.clearance(u), abs=1e-12)
