"""Gears and pairs against closed forms, published numbers, rolling racks and brute-force searches."""

import math
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from oracles import brute_force, outline
from oracles.involute_gear import InvoluteGear
from oracles.rack_envelope import Rack
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from sets import covering

from tol3d.errors import GeometryError
from tol3d.gears import LEFT, RIGHT, Displaced, SpurGear, SpurPair, inverse_involute, involute
from tol3d.gears.flank import Flank

ALPHA = math.radians(20.0)
EXACT = 1e-9  # mm; what the closed forms must keep of each other over all sizes here
BOTH_FLANKS = (pytest.param(RIGHT, id="right"), pytest.param(LEFT, id="left"))
FLANKS = pytest.mark.parametrize("flank", BOTH_FLANKS)


def plain(gear: SpurGear, face_width: float | None = None) -> InvoluteGear:
    """The plain numbers of a gear for the oracles."""
    width = gear.face_width if face_width is None else face_width
    return InvoluteGear(
        gear.teeth,
        gear.module,
        gear.pressure_angle,
        width,
        gear.profile_shift,
        gear.addendum,
        gear.tooth_thickness_deviation,
    )


@st.composite
def gears(draw: st.DrawFn, module: float | None = None, pressure_angle: float | None = None) -> SpurGear:
    """Any gear that can be made."""
    try:
        return SpurGear(
            teeth=draw(st.integers(8, 160)),
            module=module or draw(st.floats(0.3, 10.0)),
            pressure_angle=pressure_angle or math.radians(draw(st.floats(14.5, 28.0))),
            face_width=10.0,
            profile_shift=draw(st.floats(-0.5, 1.0)),
            addendum=draw(st.floats(0.7, 1.2)),
            tooth_thickness_deviation=draw(st.floats(-0.05, 0.02)),
        )
    except GeometryError:
        assume(False)
        raise AssertionError from None


@st.composite
def pairs(draw: st.DrawFn) -> SpurPair:
    """Any two gears that fit each other, from axes that press the teeth together to axes a module apart."""
    module, alpha = draw(st.floats(0.3, 10.0)), math.radians(draw(st.floats(14.5, 28.0)))
    pinion, wheel = draw(gears(module, alpha)), draw(gears(module, alpha))
    distance = pinion.reference_radius + wheel.reference_radius + module * draw(st.floats(-0.5, 2.0))
    assume(distance > (pinion.base_radius + wheel.base_radius) * 1.0001)
    return SpurPair(pinion, wheel, distance)


# the involute function -----------------------------------------------------------------------------------


@given(st.floats(1e-90, 1.5) | st.just(0.0))  # below, the cube of the angle underflows
def test_inverse_involute_undoes_the_involute(angle: float) -> None:
    # from 0.05 rad on the involute is a difference of tan(angle) and angle: its last bit, over tan^2, is eps/angle
    rounding = 2**-52 / angle if angle >= 0.05 else 0.0
    assert inverse_involute(involute(angle)) == pytest.approx(angle, rel=4e-15, abs=rounding)


@given(st.floats(0.0, 10.0))
def test_the_involute_undoes_its_inverse(value: float) -> None:
    angle = inverse_involute(value)
    # conditioning: an angle rounded in its last bit moves the value by tan^2(angle) of it
    assert involute(angle) == pytest.approx(value, rel=1e-14, abs=4e-16 * (1 + math.tan(angle) ** 2) * angle)


@given(st.floats(1e-9, 0.2))
@example(0.03)  # in the middle of the series
def test_small_involutes_keep_their_digits(angle: float) -> None:
    # partial fractions of tan: tan a = sum 8 a / ((2k - 1)^2 pi^2 - 4 a^2), the k-sum of a alone is 1
    k = np.arange(1, 200_001)
    odd = ((2 * k - 1) * math.pi) ** 2
    tail = 32 * angle**3 / (3 * math.pi**4 * (2 * 200_000) ** 3)
    expected = float((32 * angle**3 / (odd * (odd - 4 * angle**2)))[::-1].sum()) + tail
    # the first term that the series lacks, 1382/155925 a^9, is 1.04e-12 of a^3/3 at 0.05 rad
    assert involute(angle) == pytest.approx(expected, rel=2e-12, abs=0.0)


def test_a_negative_involute_is_refused() -> None:
    with pytest.raises(ValueError, match=r"-0\.1"):
        inverse_involute(-0.1)


# flanks --------------------------------------------------------------------------------------------------


@FLANKS
@given(gears())
def test_flank_points_lie_where_the_polar_involute_does(flank: Flank, gear: SpurGear) -> None:
    roll = np.linspace(0.0, gear.tip_roll, 7)
    points = plain(gear).flank_points(gear.base_radius * roll, np.array(0.0), np.array(0), flank)
    assert np.abs(gear.flank_points(roll, flank) - points[:, :2]).max() < EXACT
    assert np.hypot(*gear.flank_points(roll, flank)[-1]) == pytest.approx(gear.tip_radius, abs=EXACT)


@settings(max_examples=15, deadline=None)
@given(gears())
def test_the_left_flank_is_the_one_that_rolls_by_the_law_of_gearing(gear: SpurGear) -> None:
    """Willis: the normal passes the pitch point, so dphi/dr = -tan(alpha_y)/r with r cos(alpha_y) = r_b."""
    start, base = gear.reference_radius, gear.base_radius
    end = (gear.tip_radius + 3 * start) / 4 if gear.tip_radius > start else (start + base) / 2
    end = end if abs(end - start) > 1e-3 * start else (start + base) / 2
    rolled = solve_ivp(
        lambda r, phi: [-math.sqrt((r / base) ** 2 - 1) / r],
        (start, end),
        [gear.tooth_thickness / (2 * start)],
        rtol=1e-12,
        atol=1e-14,
    )
    point = gear.flank_points(np.array([gear.roll_at(end)]), LEFT)[0]
    assert math.atan2(point[1], point[0]) == pytest.approx(rolled.y[0, -1], abs=1e-10)


@settings(max_examples=15, deadline=None)
@given(gears())
def test_flanks_are_what_a_rolling_rack_leaves(gear: SpurGear) -> None:
    rack = Rack(gear.teeth, gear.module, gear.pressure_angle, gear.profile_shift)
    for share in (0.1, 0.5, 1.0):
        radius = gear.base_radius + share * (gear.tip_radius - gear.base_radius)
        azimuth = rack.flank_azimuth(radius) + gear.tooth_thickness_deviation / (2 * gear.reference_radius)
        point = gear.flank_points(np.array([gear.roll_at(radius)]), LEFT)[0]
        assert radius * math.atan2(point[1], point[0]) == pytest.approx(radius * azimuth, abs=EXACT)
        assert gear.thickness_at(radius) == pytest.approx(2 * radius * azimuth, abs=EXACT)


@FLANKS
@given(gears())
def test_normals_are_unit_vectors_out_of_the_tooth_across_the_flank(flank: Flank, gear: SpurGear) -> None:
    step = 1e-5
    roll = np.linspace(0.2, 1.0, 5) * gear.tip_roll
    along = gear.flank_points(roll + step, flank) - gear.flank_points(roll - step, flank)
    normals = gear.flank_normals(roll, flank)
    assert np.abs((along * normals).sum(axis=1) / np.linalg.norm(along, axis=1)).max() < 1e-9
    assert np.abs(np.linalg.norm(normals, axis=1) - 1).max() < 1e-15
    assert (normals[:, 1] * -flank > 0).all() or gear.base_half_angle > 0.5
    outside = gear.flank_points(roll, flank) + 1e-3 * normals
    # out of the tooth: off its middle further than the flank at the same radius
    radius, azimuth = np.hypot(*outside.T), np.arctan2(outside[:, 1], outside[:, 0])
    assert (-flank * azimuth > plain(gear).half_angle(radius)).all()


@given(gears())
def test_pointed_radius_is_where_the_thickness_vanishes(gear: SpurGear) -> None:
    def thickness(radius: float) -> float:
        return float(plain(gear).thickness(radius))

    high = gear.tip_radius
    while thickness(high) > 0:
        high *= 1.2
    assert gear.pointed_radius == pytest.approx(brentq(thickness, gear.base_radius, high, xtol=1e-13), abs=1e-7)


# undercut, fillet, area -------------------------------------------------------------------------------------


@pytest.mark.parametrize(("teeth", "shift"), [(8, 0.0), (10, 0.0), (10, 0.3), (12, -0.2), (14, 0.1), (16, 0.0)])
def test_undercut_begins_where_the_corner_of_a_rolling_rack_leaves_the_flank(teeth: int, shift: float) -> None:
    gear = SpurGear(teeth, 3.0, ALPHA, 10.0, profile_shift=shift)
    rack = Rack(teeth, 3.0, ALPHA, shift, addendum=1.0)
    found = rack.undercut_radius(gear.tip_radius)
    assert found > gear.base_radius
    # the corner crosses the flank at an angle, which turns 1e-10 rad into less than a tenth of a micrometre
    assert gear.undercut_radius == pytest.approx(found, abs=1e-4)


@pytest.mark.parametrize(("teeth", "shift"), [(18, 0.0), (10, 0.42), (30, -0.3)])
def test_without_undercut_the_rack_leaves_the_flank_down_to_the_base_circle(teeth: int, shift: float) -> None:
    gear = SpurGear(teeth, 3.0, ALPHA, 10.0, profile_shift=shift)
    assert gear.undercut_radius == gear.base_radius
    assert Rack(teeth, 3.0, ALPHA, shift, addendum=1.0).undercut_radius(gear.tip_radius) == pytest.approx(
        gear.base_radius, abs=1e-6
    )


def test_eighteen_teeth_are_the_fewest_without_any_undercut() -> None:
    """The textbook limit of 20 deg, z = 2/sin^2(alpha) = 17.0973: 17 teeth miss it by a hair."""
    assert SpurGear(17, 1.0, ALPHA, 10.0).undercut_limit_shift == pytest.approx(1 - 17 / 17.0973, abs=1e-5)
    assert SpurGear(18, 1.0, ALPHA, 10.0).undercut_limit_shift < 0


FILLETS = {
    "root below base, fillet on the radial line": SpurGear(12, 2.5, ALPHA, 20.0, dedendum=1.6, root_fillet=0.3),
    "root below base, fillet on the involute": SpurGear(40, 2.5, ALPHA, 20.0),
    "root above base": SpurGear(110, 2.5, ALPHA, 20.0),
    "root above base, full round": SpurGear(60, 2.5, ALPHA, 20.0, dedendum=1.45, profile_shift=0.2),
    "root below base, the paper's fillet on the radial line": SpurGear(28, 2.5, ALPHA, 20.0),
    "root below base, shifted, fillet on the involute": SpurGear(30, 3.0, ALPHA, 20.0, profile_shift=0.5, dedendum=1.6),
}


@FLANKS
@pytest.mark.parametrize("name", FILLETS)
def test_fillets_continue_flank_and_root_circle_in_point_and_direction(name: str, flank: Flank) -> None:
    gear = FILLETS[name]
    assert (gear.root_radius > gear.base_radius) == name.startswith("root above")
    centre, top, bottom = (np.array(p(flank)) for p in (gear.fillet_centre, gear.fillet_top, gear.fillet_bottom))
    assert np.linalg.norm(top - centre) == pytest.approx(gear.fillet_radius, abs=EXACT)
    assert np.linalg.norm(bottom - centre) == pytest.approx(gear.fillet_radius, abs=EXACT)
    assert np.linalg.norm(bottom) == pytest.approx(gear.root_radius, abs=EXACT)
    # directions: the arc's radius lies along the normal of the flank, and along that of the root circle
    towards = (centre - top) / gear.fillet_radius
    assert (gear.form_roll > 0) != name.endswith("on the radial line")
    if gear.form_roll > 0:
        at = np.array([gear.form_roll])
        assert np.abs(gear.flank_points(at, flank)[0] - top).max() < EXACT
        assert np.abs(gear.flank_normals(at, flank)[0] - towards).max() < EXACT
    else:
        azimuth = -flank * gear.base_half_angle
        assert math.atan2(top[1], top[0]) == pytest.approx(azimuth, abs=1e-12)
        assert np.abs(towards - [flank * math.sin(azimuth), -flank * math.cos(azimuth)]).max() < EXACT
    assert np.abs(centre / np.linalg.norm(centre) - bottom / gear.root_radius).max() < 1e-14
    found_centre, found_touch = outline.fillet(plain(gear), gear.root_radius, gear.fillet_radius)
    mirrored = np.array([1.0, -flank])
    # a search by distances finds the place of a minimum to the square root of its rounding
    assert np.abs(centre * mirrored - found_centre).max() < 1e-7
    assert np.abs(top * mirrored - found_touch).max() < 1e-6


@pytest.mark.parametrize("name", FILLETS)
def test_transverse_area_is_that_of_a_dense_polygon(name: str) -> None:
    gear = FILLETS[name]
    polygon = outline.area(plain(gear), gear.root_radius, gear.fillet_radius)
    assert gear.transverse_area == pytest.approx(polygon, rel=1e-8)


# a pair: backlash -------------------------------------------------------------------------------------------


def circumferential_of(pinion: InvoluteGear, wheel: InvoluteGear, distance: float) -> float:
    """Pitch minus both tooth thicknesses on the working circles, which roll at the ratio of the teeth."""
    radii = [distance * gear.teeth / (pinion.teeth + wheel.teeth) for gear in (pinion, wheel)]
    thick = sum(float(g.thickness(r)) for g, r in zip((pinion, wheel), radii, strict=True))
    return 2 * math.pi * radii[0] / pinion.teeth - thick


@settings(max_examples=300)
@given(pairs())
def test_backlash_is_what_the_teeth_leave_of_the_pitch(pair: SpurPair) -> None:
    pinion, wheel, distance = plain(pair.pinion), plain(pair.wheel), pair.centre_distance
    arc = circumferential_of(pinion, wheel, distance)
    cos = (pinion.base_radius + wheel.base_radius) / distance
    assert pair.circumferential_backlash == pytest.approx(arc, abs=EXACT)
    assert pair.normal_backlash == pytest.approx(arc * cos, abs=EXACT)
    turns = [arc / (distance * gear.teeth / (pinion.teeth + wheel.teeth)) for gear in (pinion, wheel)]
    for turn, expected, gear in zip(pair.angular_backlash, turns, (pinion, wheel), strict=True):
        assert turn * gear.tip_radius == pytest.approx(expected * gear.tip_radius, abs=EXACT)


@settings(max_examples=200)
@given(pairs())
def test_radial_backlash_is_how_far_the_axes_may_approach(pair: SpurPair) -> None:
    pinion, wheel = plain(pair.pinion), plain(pair.wheel)
    touching = (pinion.base_radius + wheel.base_radius) * (1 + 1e-12)
    assume(circumferential_of(pinion, wheel, touching) < -1e-6)
    zero = brentq(lambda a: circumferential_of(pinion, wheel, a), touching, 3 * touching, xtol=1e-13, rtol=1e-15)
    # at small pressure angles the arc hardly changes with the distance: 2 tan(alpha_w) mm/mm
    slope = 2 * math.sqrt((zero / touching) ** 2 - 1)
    allowed = EXACT + 1e-13 * zero / slope
    assert pair.zero_backlash_centre_distance == pytest.approx(zero, abs=allowed)
    assert pair.radial_backlash == pytest.approx(pair.centre_distance - zero, abs=allowed)


@given(pairs())
def test_at_the_zero_backlash_centre_distance_no_backlash_is_left(pair: SpurPair) -> None:
    zero = pair.zero_backlash_centre_distance
    assume(zero > pair.base_radii * 1.0001)  # also refuses nan
    tight = SpurPair(pair.pinion, pair.wheel, zero)
    assert tight.normal_backlash == pytest.approx(0.0, abs=EXACT)
    assert circumferential_of(plain(pair.pinion), plain(pair.wheel), zero) == pytest.approx(0.0, abs=EXACT)


def test_zero_backlash_centre_distance_of_khk_s_profile_shifted_pair() -> None:
    """KHK gear technical reference, profile shifted spur gear: alpha_w 26.0886 deg, a 56.4999 mm."""
    pinion = SpurGear(12, 3.0, ALPHA, 20.0, profile_shift=0.6, addendum=0.8)
    wheel = SpurGear(24, 3.0, ALPHA, 20.0, profile_shift=0.36, addendum=0.8)
    distance = SpurPair(pinion, wheel, 60.0).zero_backlash_centre_distance
    assert distance == pytest.approx(56.4999, abs=0.5e-4)
    assert math.degrees(SpurPair(pinion, wheel, distance).working_pressure_angle) == pytest.approx(26.0886, abs=0.5e-4)


def test_standard_gears_at_the_sum_of_their_reference_radii_have_no_backlash() -> None:
    pair = SpurPair(SpurGear(28, 2.5, ALPHA, 20.0), SpurGear(110, 2.5, ALPHA, 20.0), 172.5)
    assert pair.normal_backlash == pytest.approx(0.0, abs=1e-12)
    assert pair.working_pressure_angle == pytest.approx(ALPHA, abs=1e-15)


def test_circumferential_backlash_grows_by_two_tan_alpha_w_per_mm() -> None:
    pinion, wheel = SpurGear(20, 2.0, ALPHA, 10.0), SpurGear(31, 2.0, ALPHA, 10.0)
    step = 1e-4
    for distance in (51.0, 51.3):
        pairs_at = [SpurPair(pinion, wheel, distance + s).circumferential_backlash for s in (-step, step)]
        at = SpurPair(pinion, wheel, distance)
        # the arc is read on a working circle that grows too: j_wt/a more
        expected = 2 * math.tan(at.working_pressure_angle) + at.circumferential_backlash / distance
        assert (pairs_at[1] - pairs_at[0]) / (2 * step) == pytest.approx(expected, rel=1e-6)


@FLANKS
@pytest.mark.parametrize("shifts", [(0.0, 0.0), (0.4, -0.1)])
def test_backlash_is_the_distance_that_a_search_of_the_flanks_finds(flank: Flank, shifts: tuple[float, float]) -> None:
    pinion = SpurGear(17, 2.0, ALPHA, 10.0, profile_shift=shifts[0], tooth_thickness_deviation=-0.03)
    wheel = SpurGear(31, 2.0, ALPHA, 10.0, profile_shift=shifts[1], tooth_thickness_deviation=-0.04)
    pair = SpurPair(pinion, wheel, 48.0 + 2 * sum(shifts) + 0.03)
    angle = np.linspace(0.0, 2.0, 6)
    mesh = parallel_mesh(pair, len(angle))
    assert np.abs(brute_force.normal_backlash(mesh, angle, flank) - pair.normal_backlash).max() < 2e-8
    for k, turn_driver in enumerate((True, False)):
        turn = brute_force.free_turn(mesh, angle, flank, turn_driver=turn_driver)
        assert turn == pytest.approx(pair.angular_backlash[k], abs=2e-9)


@FLANKS
def test_touching_angle_is_where_a_search_turns_the_wheel_to(flank: Flank) -> None:
    pinion, wheel = SpurGear(17, 2.0, ALPHA, 10.0, profile_shift=0.4), SpurGear(31, 2.0, ALPHA, 10.0)
    pair = SpurPair(pinion, wheel, 48.9)
    angle, line = np.linspace(-3.0, 30.0, 5), np.array([48.93, -0.4])
    thickness = (-0.03, 0.01)
    thin, other = (replace(g, tooth_thickness_deviation=t) for g, t in zip((pinion, wheel), thickness, strict=True))
    mesh = parallel_mesh(SpurPair(thin, other, pair.centre_distance), len(angle))
    mesh.driven_shaft[:, :2, 3] = line
    origins = np.zeros((5, 2, 3))
    origins[:, 1, :2] = line
    half_turns = [t / g.reference_diameter for g, t in zip((pinion, wheel), thickness, strict=True)]
    displaced = Displaced(origins, np.zeros((5, 2, 3)), np.tile(half_turns, (5, 1)))
    found = brute_force.turn_until_contact(mesh, angle, brute_force.tooth_in_space(mesh, angle), flank)[1]
    told = pair.touching_angle(angle, flank, displaced)
    assert np.abs(told - found).max() * wheel.base_radius < 3e-8


def parallel_mesh(pair: SpurPair, count: int, distance: float | None = None) -> brute_force.Mesh:
    shafts = np.tile(np.eye(4), (2, count, 1, 1))
    shafts[1, :, 0, 3] = pair.centre_distance if distance is None else distance
    centred = np.zeros((count, 2))
    return brute_force.Mesh(plain(pair.pinion), plain(pair.wheel), shafts[0], shafts[1], centred, centred)


# path of contact ---------------------------------------------------------------------------------------------


def path_of_contact(pair: SpurPair) -> float:
    """Length [mm] that the tip circles cut out of the common tangent of the base circles, in coordinates."""
    first, second = plain(pair.pinion), plain(pair.wheel)
    lean = math.acos((first.base_radius + second.base_radius) / pair.centre_distance)
    start = first.base_radius * np.array([math.cos(lean), math.sin(lean)])
    end = np.array([pair.centre_distance, 0.0]) - second.base_radius * np.array([math.cos(lean), math.sin(lean)])
    along = (end - start) / np.linalg.norm(end - start)

    def reached(centre: np.ndarray, radius: float, sense: float) -> float:
        foot = (centre - start) @ along
        off = np.linalg.norm(centre - start - foot * along)
        return float(foot + sense * math.sqrt(radius**2 - off**2))

    wheel_axis = np.array([pair.centre_distance, 0.0])
    return reached(np.zeros(2), first.tip_radius, 1.0) - reached(wheel_axis, second.tip_radius, -1.0)


@given(pairs())
def test_contact_ratio_is_the_tangent_between_the_tip_circles_over_the_base_pitch(pair: SpurPair) -> None:
    pitch = math.pi * pair.pinion.module * math.cos(pair.pinion.pressure_angle)
    assert pair.contact_ratio == pytest.approx(path_of_contact(pair) / pitch, abs=1e-10)


def test_contact_ratio_of_endless_standard_gears_is_that_of_two_racks() -> None:
    """The textbook bound of 20 deg full-depth teeth, 2/(pi sin alpha cos alpha) = 1.981."""
    gear = SpurGear(1_000_000, 1.0, ALPHA, 10.0)
    assert SpurPair(gear, gear, 1_000_000.0).contact_ratio == pytest.approx(1.981, abs=5e-4)


def test_long_period_is_over_when_the_same_teeth_meet_again() -> None:
    for pinion, wheel in ((28, 110), (20, 40), (17, 31)):
        pair = SpurPair(SpurGear(pinion, 1.0, ALPHA, 5.0), SpurGear(wheel, 1.0, ALPHA, 5.0), (pinion + wheel) / 2)
        met = next(turns for turns in range(1, 1000) if (turns * pinion) % wheel == 0)
        assert pair.long_period_turns == met


# candidate teeth -----------------------------------------------------------------------------------------------

PAIRS = {
    "paper": SpurPair(SpurGear(28, 2.5, ALPHA, 20.0), SpurGear(110, 2.5, ALPHA, 20.0), 172.5),
    "few teeth": SpurPair(
        SpurGear(12, 1.0, ALPHA, 9.0, profile_shift=0.5), SpurGear(15, 1.0, ALPHA, 9.0, profile_shift=0.4), 14.3
    ),
    "more than two in contact": SpurPair(
        SpurGear(38, 1.0, math.radians(14.5), 9.0, addendum=1.11, dedendum=1.4),
        SpurGear(65, 1.0, math.radians(14.5), 9.0, addendum=1.11, dedendum=1.4),
        51.5,
    ),
    "barely one in contact": SpurPair(
        SpurGear(31, 1.0, math.radians(25.0), 9.0, addendum=0.8),
        SpurGear(24, 1.0, math.radians(25.0), 9.0, addendum=0.8),
        27.55,
    ),
    "wheel drives": SpurPair(SpurGear(60, 2.0, ALPHA, 9.0), SpurGear(18, 2.0, ALPHA, 9.0), 78.05),
}
TOUCHING = 1e-6  # mm


@covering(name=PAIRS, shifted=[-0.05, 0.0, 0.05], flank=BOTH_FLANKS)
def test_candidate_teeth_hold_every_pair_that_a_scan_finds_touching(name: str, shifted: float, flank: Flank) -> None:
    """At random positions, also with the axes nearer or further by a twentieth of a module than the pair's."""
    pair = PAIRS[name]
    pair.refuse_interference()
    module = pair.pinion.module
    thin, other = (replace(gear, tooth_thickness_deviation=-0.1 * module) for gear in (pair.pinion, pair.wheel))
    angle = np.random.default_rng(3).uniform(-50.0, 50.0, 8)
    mesh = parallel_mesh(
        SpurPair(thin, other, pair.centre_distance), len(angle), pair.centre_distance + shifted * module
    )
    turned = brute_force.turn_until_contact(mesh, angle, brute_force.tooth_in_space(mesh, angle), flank)
    teeth, distance, mates = brute_force.distances(mesh, *turned, flank)
    candidates, may_touch = pair.candidate_teeth(angle, flank)
    met = pair.mating_teeth(candidates, flank)
    assert may_touch.any(axis=1).all()
    for row in range(len(angle)):
        mate_of = dict(zip(candidates[row][may_touch[row]], met[row][may_touch[row]], strict=True))
        touching = distance[row] < TOUCHING
        assert touching.any()
        for tooth, mate, touches in zip(teeth[row], mates[row], touching, strict=True):
            assert tooth in mate_of or not touches
            assert tooth not in mate_of or (mate_of[tooth] - mate) % pair.wheel.teeth == 0


@FLANKS
def test_candidates_are_on_average_the_contact_ratio_and_its_margins(flank: Flank) -> None:
    for pair in PAIRS.values():
        _, may_touch = pair.candidate_teeth(np.arange(1000) / 1000 * pair.pinion.angular_pitch, flank)
        assert may_touch.sum(axis=1).mean() == pytest.approx(pair.contact_ratio + 2 * 0.15, abs=2e-3)


# refusals ------------------------------------------------------------------------------------------------------


def numbers(text: str) -> list[float]:
    return [float(number) for number in re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", text)]


def refusal(**changed: Any) -> str:
    with pytest.raises(GeometryError) as caught:
        replace(SpurGear(20, 2.0, ALPHA, 10.0), **changed)
    return str(caught.value)


@pytest.mark.parametrize("teeth", [0, -3, 2])
def test_too_few_teeth_are_refused(teeth: int) -> None:
    assert refusal(teeth=teeth) == f"teeth: expected at least 3, got {teeth}"


def test_pointed_teeth_are_refused_with_thickness_and_the_circle_where_flanks_meet() -> None:
    text = refusal(teeth=10, module=3.0, profile_shift=1.2)
    gear = InvoluteGear(10, 3.0, ALPHA, 10.0, 1.2)
    meet = brentq(lambda r: float(gear.thickness(r)), gear.base_radius, gear.tip_radius)
    assert "pointed teeth" in text
    tip, thickness, pointed = numbers(text)[:3]
    assert tip == pytest.approx(2 * gear.tip_radius, abs=1e-4)
    assert thickness == pytest.approx(float(gear.thickness(gear.tip_radius)), abs=1e-4)
    assert pointed == pytest.approx(2 * meet, abs=1e-4)


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"module": 0.0}, ["module", "0 mm"]),
        ({"module": math.nan}, ["module", "nan"]),
        ({"face_width": -1.0}, ["face_width", "-1 mm"]),
        ({"pressure_angle": 0.0}, ["pressure_angle", "0 deg"]),
        ({"pressure_angle": math.radians(50)}, ["pressure_angle", "50 deg"]),
        ({"dedendum": 12.0}, ["root circle (-8.0000 mm)"]),
        ({"addendum": -0.9}, ["tip circle (36.4000 mm)", "base circle (37.5877 mm)"]),
        ({"bore": 36.0}, ["bore", "36 mm", "35.0000 mm"]),
        ({"bore": -1.0}, ["bore", "-1 mm"]),
        ({"root_fillet": 0.0}, ["root_fillet", "0 mm"]),
        ({"root_fillet": 2.0}, ["root_fillet", "2 mm"]),
    ],
)
def test_gears_that_cannot_be_made_are_refused_with_their_numbers(changed: dict[str, float], told: list[str]) -> None:
    text = refusal(**changed)
    for words in told:
        assert words in text


@pytest.mark.parametrize("field", ["pressure_angle", "profile_shift", "addendum", "dedendum", "bore", "root_fillet"])
def test_numbers_that_are_none_are_refused(field: str) -> None:
    assert refusal(**{field: math.nan})


def pair_refusal(pinion: SpurGear, wheel: SpurGear, distance: float) -> str:
    with pytest.raises(GeometryError) as caught:
        SpurPair(pinion, wheel, distance).refuse_interference()
    return str(caught.value)


def test_gears_of_different_module_or_pressure_angle_are_refused() -> None:
    gear = SpurGear(20, 2.0, ALPHA, 10.0)
    text = pair_refusal(gear, SpurGear(20, 2.1, ALPHA, 10.0), 41.0)
    assert "module" in text
    assert numbers(text)[:2] == [2.0, 2.1]
    assert "pressure_angle" in pair_refusal(gear, SpurGear(20, 2.0, math.radians(25), 10.0), 40.0)


def test_axes_nearer_than_the_base_circles_are_refused() -> None:
    gear = SpurGear(20, 2.0, ALPHA, 10.0)
    text = pair_refusal(gear, gear, 37.5)
    assert "interfere" in text
    assert numbers(text)[:2] == [37.5, pytest.approx(40 * math.cos(ALPHA), abs=1e-4)]


def test_tips_in_roots_are_refused_with_the_depth() -> None:
    gear = SpurGear(30, 2.0, ALPHA, 10.0)
    text = pair_refusal(gear, gear, 59.0)
    # 32 mm tip radius, 27.5 mm root radius: half a millimetre too deep
    assert "interfere by 0.5000 mm" in text


@pytest.mark.parametrize("wheel", [12, 110])
def test_undercut_that_reaches_the_flank_in_use_is_refused_with_the_shift_that_mends_it(wheel: int) -> None:
    mate = SpurGear(wheel, 2.0, ALPHA, 10.0, profile_shift=0.3)
    text = pair_refusal(SpurGear(11, 2.0, ALPHA, 10.0), mate, 11.0 + wheel + 0.62)
    cut = Rack(11, 2.0, ALPHA, 0.0, addendum=1.0).undercut_radius(13.0)
    assert "undercut" in text
    assert f"up to {2 * cut:.4f} mm" in text
    assert f"at least {1 - 11 * math.sin(ALPHA) ** 2 / 2:.4f} (it has 0)" in text
    SpurPair(SpurGear(11, 2.0, ALPHA, 10.0, profile_shift=0.3567), mate, 11.0 + wheel + 1.3).refuse_interference()


def test_contact_below_where_the_involute_begins_is_refused_with_both_circles() -> None:
    pinion, wheel = SpurGear(18, 2.0, ALPHA, 10.0), SpurGear(80, 2.0, ALPHA, 10.0, addendum=1.2)
    text = pair_refusal(pinion, wheel, 98.0)
    assert "its involute begins at" in text
    assert f"{2 * pinion.form_radius:.4f} mm" in text


def test_a_contact_ratio_below_one_is_refused_with_its_value() -> None:
    gear = SpurGear(20, 2.0, ALPHA, 10.0)
    text = pair_refusal(gear, gear, 42.5)
    ratio = path_of_contact(SpurPair(gear, gear, 42.5)) / (2 * math.pi * math.cos(ALPHA))
    assert ratio < 1
    assert numbers(text)[0] == pytest.approx(ratio, abs=1e-4)
