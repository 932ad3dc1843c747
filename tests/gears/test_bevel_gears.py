"""Bevel gears and pairs against rolled planes, crown gears, published numbers and brute-force searches."""

import math
import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from oracles import bevel_brute_force as brute_force
from oracles import rolling_plane
from oracles.bevel_brute_force import BevelMesh, nominal_shafts
from oracles.brute_force import zoomed_minimum
from oracles.plain import plain_bevel
from oracles.poses import pose
from oracles.spherical_foot import nearest_on_flank
from scipy.integrate import quad
from scipy.optimize import brentq, minimize

from tol3d.errors import GeometryError
from tol3d.gears import (
    LEFT,
    RIGHT,
    BevelGear,
    BevelPair,
    SpurGear,
    SpurPair,
    inverse_spherical_involute,
    involute,
    pitch_angles,
    spherical_involute,
)
from tol3d.gears.flank import Flank
from tol3d.gears.spherical_involute import (
    flank_directions,
    flank_normals,
    in_plane_angle,
    involute_azimuth,
    polar_angle,
)

DEG = math.pi / 180
ALPHA = 20 * DEG
RIGHT_ANGLE = 90 * DEG
UM = 1e3
EXACT = 1e-9  # mm; what the closed forms must keep of each other over all sizes here
FLANKS = pytest.mark.parametrize("flank", [RIGHT, LEFT], ids=["right", "left"])

PAPER_GEAR = BevelGear(31, 3.5, ALPHA, 9.0, 45 * DEG)
PAPER = BevelPair(PAPER_GEAR, PAPER_GEAR, RIGHT_ANGLE)
"""Jiang et al. 2024, Table 5: z 31/31, m 3.5, alpha 20 deg, shaft angle 90 deg, face width 9."""


def mesh_of(pair: BevelPair, count: int, *, turned: float = 0.0) -> BevelMesh:
    """The pair at rest for that many rows, the flanks of both gears turned by as much [rad]."""
    shafts, centred = nominal_shafts(pair.shaft_angle, count), np.zeros((count, 2))
    driver, driven = (replace(plain_bevel(gear), turned=turned) for gear in (pair.pinion, pair.wheel))
    return BevelMesh(driver, driven, shafts[0], shafts[1], centred, centred)


def bevel_pair(teeth: tuple[int, int], degrees: float, *, shift: float = 0.0, face: float = 6.0) -> BevelPair:
    """A pair of module 2.5 as the teeth and the shaft angle want it; the wheel gets the opposite profile shift."""
    angles = pitch_angles(teeth[0], teeth[1], degrees * DEG)
    first, second = (
        BevelGear(z, 2.5, ALPHA, face, delta, profile_shift=x)
        for z, delta, x in zip(teeth, angles, (shift, -shift), strict=True)
    )
    return BevelPair(first, second, degrees * DEG)


PAIRS = {
    "paper": PAPER,
    "17/43 at 90 deg": bevel_pair((17, 43), 90, shift=0.3),
    "wheel drives": bevel_pair((43, 17), 90),
    "20/30 at 60 deg": bevel_pair((20, 30), 60),
    "31/23 at 75 deg": bevel_pair((31, 23), 75, shift=-0.1),
    "29/31 at 120 deg": bevel_pair((29, 31), 120),
}


@st.composite
def gears(draw: st.DrawFn) -> BevelGear:
    """Any gear that can be made."""
    try:
        return BevelGear(
            teeth=draw(st.integers(6, 90)),
            module=draw(st.floats(0.5, 8.0)),
            pressure_angle=draw(st.floats(14.5, 28.0)) * DEG,
            face_width=draw(st.floats(0.5, 4.0)),
            pitch_angle=draw(st.floats(5.0, 85.0)) * DEG,
            profile_shift=draw(st.floats(-0.5, 0.8)),
            addendum=draw(st.floats(0.7, 1.1)),
        )
    except GeometryError:
        assume(False)
        raise AssertionError from None


@st.composite
def pairs(draw: st.DrawFn) -> BevelPair:
    """Any two gears that roll on each other and whose teeth do not interfere."""
    teeth = draw(st.integers(13, 60)), draw(st.integers(13, 60))
    shaft_angle, module = draw(st.floats(20.0, 140.0)) * DEG, draw(st.floats(0.5, 8.0))
    alpha, shift = draw(st.floats(17.0, 28.0)) * DEG, draw(st.floats(-0.3, 0.3))
    try:
        angles = pitch_angles(*teeth, shaft_angle)
        first, second = (
            BevelGear(z, module, alpha, 3 * module, delta, profile_shift=x)
            for z, delta, x in zip(teeth, angles, (shift, -shift), strict=True)
        )
        pair = BevelPair(first, second, shaft_angle)
        pair.refuse_interference()
    except GeometryError:
        assume(False)
        raise AssertionError from None
    return pair


base_angles = st.floats(1.0, 85.0).map(lambda degrees: degrees * DEG)


# the spherical involute ------------------------------------------------------------------------------------


@FLANKS
@pytest.mark.parametrize("degrees", [3.0, 20.0, 41.641143, 65.0, 84.0])
def test_flanks_are_what_a_line_of_a_rolling_plane_draws(degrees: float, flank: Flank) -> None:
    base = degrees * DEG
    rolls = np.linspace(0.0, 1.2, 25)
    found = flank_directions(rolls * math.sin(base), base, 0.0, flank)
    # a direction times 100 mm; the ODE's own tolerance is 1e-13 a step
    assert np.abs(found - rolling_plane.drawn_directions(base, rolls, flank)).max() * 100.0 < 1e-8


@given(base_angles, st.floats(-4.0, 0.0))
def test_small_involutes_keep_their_digits(base: float, power: float) -> None:
    # the derivative has no difference in it, so its integral keeps relative precision
    q = 10**power * math.sin(base)

    def rate(at: float) -> float:
        return math.sin(at) ** 2 * math.cos(base) ** 2 / math.sin(base) / math.sin(float(polar_angle(at, base))) ** 2

    expected = quad(rate, 0.0, q, epsabs=0.0, epsrel=1e-13)[0]
    # the closed form takes over at tan q = 0.1 sin(base), a difference of two 0.1s that is 3e-4 cos^2(base)
    allowed = 1e-12 + 1e-13 / math.cos(base) ** 2
    assert float(involute_azimuth(q, base)) == pytest.approx(expected, rel=allowed, abs=0.0)


@given(base_angles, st.floats(1e-6, 1.0))
def test_in_plane_angle_and_polar_angle_undo_each_other(base: float, share: float) -> None:
    q = share * math.pi / 2
    # rounding of the polar angle, some 2e-16, over d(polar)/dq = sin q cos(base)/sin(polar)
    rate = math.sin(q) * math.cos(base) / math.sin(float(polar_angle(q, base)))
    assert float(in_plane_angle(polar_angle(q, base), base)) == pytest.approx(q, rel=1e-14, abs=5e-16 / rate)
    polar = base + share * (math.pi / 2 - base)
    assert float(polar_angle(in_plane_angle(polar, base), base)) == pytest.approx(polar, rel=4e-15)


@given(base_angles, st.floats(0.0, 1.0))
def test_inverse_undoes_the_spherical_involute(base: float, share: float) -> None:
    polar = base + share * (math.pi / 2 - base)
    azimuth = float(spherical_involute(polar, base))
    # where the flank leaves the cone radially its azimuth says nothing: d azimuth/d polar = tan(pressure angle)/sin
    lean = math.sqrt(max(0.0, (math.sin(polar) / math.sin(base)) ** 2 - 1.0))
    found = inverse_spherical_involute(azimuth, base)
    assert found == pytest.approx(polar, abs=1e-14 + 1e-15 / max(lean, 1e-7))
    assert float(spherical_involute(found, base)) == pytest.approx(azimuth, rel=1e-13, abs=2e-15 * (1 + lean))


@pytest.mark.parametrize("azimuth", [-0.01, 5.0, math.nan])
def test_azimuths_that_no_flank_reaches_are_refused_with_the_largest(azimuth: float) -> None:
    with pytest.raises(ValueError, match=rf"expected 0 to .* got {azimuth:g} rad"):
        inverse_spherical_involute(azimuth, 40 * DEG)


def test_on_small_cones_the_spherical_involute_is_the_plane_one() -> None:
    # error of order base^2: a fourth for half the cone
    errors = [
        float(spherical_involute(math.asin(math.sin(base) / math.cos(ALPHA)), base)) - involute(ALPHA)
        for base in (0.02, 0.01, 0.005)
    ]
    assert abs(errors[2]) < 1e-6
    assert errors[0] / errors[1] == pytest.approx(4, rel=1e-2)
    assert errors[1] / errors[2] == pytest.approx(4, rel=1e-2)


@FLANKS
@given(base_angles, st.floats(0.01, 1.0), st.floats(-3.0, 3.0))
def test_normals_stand_on_the_flank_and_point_out_of_the_tooth(
    flank: Flank, base: float, share: float, start: float
) -> None:
    q, step = np.array([share * math.sin(base)]), 1e-5 * math.sin(base)
    along = flank_directions(q + step, base, start, flank) - flank_directions(q - step, base, start, flank)
    direction, normal = flank_directions(q, base, start, flank), flank_normals(q, base, start, flank)
    assert np.linalg.norm(normal) == pytest.approx(1, abs=1e-15)
    assert abs(normal @ direction.T) < 1e-15
    # a difference of unit vectors is known to 2e-16, and is itself the step times sin q/tan(base)
    assert abs(normal @ along.T) / np.linalg.norm(along) < 1e-8 + 1e-15 / np.linalg.norm(along)
    # the right flank is on the low-azimuth side: out of the tooth is towards lower azimuths
    x, y, _ = direction[0]
    nx, ny, _ = normal[0]
    assert flank * (x * ny - y * nx) < 0


@FLANKS
@settings(deadline=None)
@given(gears(), st.floats(0.02, 0.98), st.floats(-0.5, 0.5))
def test_distance_to_a_flank_is_what_a_search_of_it_finds(
    flank: Flank, gear: BevelGear, share: float, off: float
) -> None:
    q = np.array([gear.form_q + share * (gear.tip_q - gear.form_q)])
    reach = gear.outer_cone_distance
    # off by up to half a module, but less than the radius of curvature R tan q inwards
    away = max(off * gear.module, -0.5 * reach * math.tan(q[0]))
    point = reach * gear.flank_directions(q, flank) + away * gear.flank_normals(q, flank)
    foot = nearest_on_flank(point, gear.base_angle, gear.flank_start(flank), flank)

    def distance(at: np.ndarray) -> np.ndarray:
        direction = gear.flank_directions(at, flank)
        return np.linalg.norm(point - (point * direction).sum(axis=-1, keepdims=True) * direction, axis=-1)

    searched = zoomed_minimum(lambda at: distance(at[0])[None], np.maximum(q - 0.2, 0.0), q + 0.2, (101, 6))
    assert abs(foot.distance[0]) == pytest.approx(float(searched[0]), abs=1e-9 * reach)
    assert foot.distance[0] == pytest.approx(away, abs=1e-13 * reach)
    assert foot.q[0] == pytest.approx(q[0], abs=1e-12)
    assert foot.cone_distance[0] == pytest.approx(reach, rel=1e-13)
    assert np.abs(foot.normal - gear.flank_normals(q, flank)).max() < 1e-11


@FLANKS
@given(base_angles, st.floats(0.05, 1.0), st.floats(-0.3, 0.3), st.floats(-6.0, 6.0))
def test_the_flank_turned_by_the_distance_s_angle_passes_the_point(
    flank: Flank, base: float, share: float, turn: float, start: float
) -> None:
    """g = R sin(q - q_f): a flank turned about its axis stays at one normal distance, R sin(sin(base) turn)."""
    q, reach = np.array([share * math.sin(base)]), 70.0
    point = reach * flank_directions(q, base, start + turn, flank)
    foot = nearest_on_flank(point, base, start, flank)
    assert foot.distance[0] == pytest.approx(-flank * reach * math.sin(math.sin(base) * turn), abs=1e-11)
    assert foot.q[0] - q[0] == pytest.approx(flank * math.sin(base) * turn, abs=1e-12)


def test_the_normal_is_the_gradient_of_the_distance() -> None:
    point, step = np.array([50.0, 3.0, 49.0]), 1e-4
    for flank in (RIGHT, LEFT):
        ends = point + step * np.concatenate([np.eye(3), -np.eye(3)])
        g = nearest_on_flank(ends, PAPER_GEAR.base_angle, PAPER_GEAR.flank_start(flank), flank).distance
        foot = nearest_on_flank(point, PAPER_GEAR.base_angle, PAPER_GEAR.flank_start(flank), flank)
        assert (g[:3] - g[3:]) / (2 * step) == pytest.approx(foot.normal, abs=1e-9)


# one gear ---------------------------------------------------------------------------------------------------


def test_the_published_pair_has_its_mean_diameter_and_the_cones_worked_by_hand() -> None:
    gear = PAPER_GEAR
    assert 2 * gear.mean_radius == pytest.approx(102.1, abs=0.05)  # printed in the paper
    # to all digits by hand: R_e = 3.5 x 31/sqrt(2), sin(beta) = cos(20 deg)/sqrt(2)
    assert gear.outer_cone_distance == pytest.approx(76.721086, abs=5e-7)
    assert gear.inner_cone_distance == pytest.approx(67.721086, abs=5e-7)
    assert gear.mean_cone_distance == pytest.approx(72.221086, abs=5e-7)
    assert math.degrees(gear.base_angle) == pytest.approx(41.641143, abs=5e-7)
    assert math.degrees(gear.root_angle) == pytest.approx(41.736, abs=5e-4)
    assert gear.base_radius == pytest.approx(54.25 * math.cos(ALPHA), rel=1e-14)
    assert gear.base_pitch_angle == pytest.approx(0.13468, abs=5e-6)
    assert PAPER.contact_ratio == pytest.approx(1.7326, abs=5e-5)


def test_diameters_and_cones_of_a_20_to_40_pair_at_right_angles() -> None:
    """Module 3: d_ae = d_e + 2 h cos(delta), the angles of addendum and dedendum atan(h/R_e), worked by hand."""
    angles = pitch_angles(20, 40, RIGHT_ANGLE)
    pinion, wheel = (BevelGear(z, 3.0, ALPHA, 22.0, delta) for z, delta in zip((20, 40), angles, strict=True))
    assert pinion.outer_cone_distance == pytest.approx(30 * math.sqrt(5), rel=1e-14)
    assert (pinion.tip_diameter, wheel.tip_diameter) == pytest.approx((65.3666, 122.6833), abs=5e-5)
    assert math.degrees(pinion.tip_angle) == pytest.approx(29.12569, abs=5e-6)
    assert math.degrees(wheel.root_angle) == pytest.approx(60.23535, abs=5e-6)
    assert pinion.root_diameter == pytest.approx(60 - 2 * 3.75 * 2 / math.sqrt(5), rel=1e-14)
    assert pinion.inner_root_diameter == pytest.approx(pinion.root_diameter * (1 - 22 / (30 * math.sqrt(5))), rel=1e-14)


@FLANKS
@given(gears())
def test_teeth_take_their_share_of_the_pitch_cone(flank: Flank, gear: BevelGear) -> None:
    """The arc s = m (pi/2 + 2 x tan alpha) of the heel lies between the flanks, half on each side of the x axis."""
    direction = gear.flank_directions(np.array([gear.pitch_q]), flank)[0]
    assert math.acos(direction[2]) == pytest.approx(gear.pitch_angle, abs=1e-12)
    azimuth = math.atan2(direction[1], direction[0])
    thickness = gear.module * (math.pi / 2 + 2 * gear.profile_shift * math.tan(gear.pressure_angle))
    assert -flank * azimuth * gear.module * gear.teeth == pytest.approx(thickness, abs=EXACT)


@FLANKS
@given(gears())
def test_flanks_reach_from_the_root_or_base_cone_to_the_tip_cone(flank: Flank, gear: BevelGear) -> None:
    oracle = plain_bevel(gear)
    directions = gear.flank_directions(np.array([gear.form_q, gear.tip_q]), flank)
    points = oracle.flank_points(np.array(1.0), np.array(oracle.rolls), 0, flank)
    assert np.abs(directions - points).max() * gear.outer_cone_distance < EXACT
    # the tip circle at the heel, on the back cone that stands upright on the pitch line
    radius = math.sin(gear.tip_angle) * gear.outer_cone_distance / math.cos(gear.tip_angle - gear.pitch_angle)
    assert gear.tip_radius == pytest.approx(radius, rel=1e-13)
    azimuth = math.atan2(points[1, 1], points[1, 0])
    assert gear.tip_thickness == pytest.approx(-flank * 2 * radius * azimuth, abs=EXACT)


@settings(max_examples=10, deadline=None)
@given(gears())
def test_flanks_are_what_a_crown_gear_leaves(gear: BevelGear) -> None:
    assume(gear.pitch_angle < 75 * DEG)  # beyond, contact comes to the end of the crown gear's own flank
    crown = rolling_plane.CrownRack(gear.pitch_angle, gear.pressure_angle)
    for share in (0.1, 0.5, 1.0):
        polar = gear.base_angle + share * (gear.tip_angle - gear.base_angle)
        x, y, _ = gear.flank_directions(np.array([gear.q_at(polar)]), LEFT)[0]
        expected = gear.pitch_half_angle + crown.flank_azimuth(polar)
        assert gear.outer_cone_distance * (math.atan2(y, x) - expected) == pytest.approx(0.0, abs=EXACT)


@given(gears())
def test_pointed_angle_is_where_the_teeth_end(gear: BevelGear) -> None:
    base, start = gear.base_angle, plain_bevel(gear).start

    def azimuth(roll: np.ndarray | float) -> np.ndarray:
        direction = brute_force.line(base, np.asarray(roll), start, LEFT).direction
        return np.arctan2(direction[..., 1], direction[..., 0])

    # the first change of sign: on a narrow cone the flank winds on round the axis
    rolls = np.linspace(1e-9, math.pi / 2 / math.sin(base), 2001)
    meets = np.flatnonzero(azimuth(rolls) < 0.0)
    assume(len(meets))
    roll = brentq(azimuth, rolls[meets[0] - 1], rolls[meets[0]], xtol=1e-14)
    z = brute_force.line(base, roll, start, LEFT).direction[2]
    assert gear.pointed_angle == pytest.approx(math.acos(z), abs=1e-12)


def test_teeth_that_nowhere_meet_are_said_to_meet_at_the_equator() -> None:
    assert BevelGear(40, 3.0, 5 * DEG, 3.0, 80 * DEG).pointed_angle == math.pi / 2


# undercut ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("teeth", "mate", "degrees", "shift"),
    [(10, 40, 90, 0.0), (8, 8, 90, 0.0), (12, 30, 60, -0.2), (13, 40, 90, 0.1), (6, 6, 90, 0.2), (9, 11, 120, -0.1)],
)
def test_undercut_begins_where_the_corner_of_a_crown_gear_leaves_the_flank(
    teeth: int, mate: int, degrees: float, shift: float
) -> None:
    delta = pitch_angles(teeth, mate, degrees * DEG)[0]
    gear = BevelGear(teeth, 3.0, ALPHA, 5.0, delta, profile_shift=shift)
    depth = math.atan(gear.module * (1 - shift) / gear.outer_cone_distance)
    found = rolling_plane.CrownRack(delta, ALPHA, depth).undercut_angle(gear.tip_angle)
    assert found > gear.base_angle
    # the corner crosses the flank at an angle, which turns the oracle's 1e-10 rad into a few times as much
    assert gear.undercut_angle == pytest.approx(found, abs=2e-9)


@pytest.mark.parametrize(("teeth", "mate", "shift"), [(20, 40, 0.0), (13, 13, 0.0), (10, 40, 0.41)])
def test_without_undercut_the_crown_gear_leaves_the_flank_down_to_the_base_cone(
    teeth: int, mate: int, shift: float
) -> None:
    delta = pitch_angles(teeth, mate, RIGHT_ANGLE)[0]
    gear = BevelGear(teeth, 3.0, ALPHA, 5.0, delta, profile_shift=shift)
    depth = math.atan(gear.module * (1 - shift) / gear.outer_cone_distance)
    assert gear.undercut_angle == gear.base_angle
    found = rolling_plane.CrownRack(delta, ALPHA, depth).undercut_angle(gear.tip_angle)
    assert found == pytest.approx(gear.base_angle, abs=1e-9)


@given(gears())
def test_at_the_undercut_limit_the_crown_gear_s_tip_ends_where_the_plane_of_action_touches_the_base_cone(
    gear: BevelGear,
) -> None:
    delta, alpha = gear.pitch_angle, gear.pressure_angle
    pitch_line, down = np.array([math.sin(delta), 0, math.cos(delta)]), np.array([-math.cos(delta), 0, math.sin(delta)])
    # the plane of action holds the pitch line and leans by alpha from the crown gear's pitch plane
    into = math.cos(alpha) * np.array([0.0, 1.0, 0.0]) + math.sin(alpha) * down
    # it touches the base cone along its line nearest to the gear's axis
    turn = math.atan2(into[2], pitch_line[2])
    touching = math.cos(turn) * pitch_line + math.sin(turn) * into
    depth = math.tan(math.asin(touching @ down)) * gear.module * gear.teeth / 2 / math.sin(delta)
    assert gear.undercut_limit_shift == pytest.approx(1 - depth / gear.module, abs=1e-12 * gear.teeth)


def test_thirteen_teeth_are_the_fewest_of_a_mitre_gear_without_any_undercut() -> None:
    """Also by the equivalent spur gear of Tredgold: z = 17.0973 cos(45 deg) = 12.09."""

    def limit(teeth: int) -> float:
        return BevelGear(teeth, 1.0, ALPHA, 1.0, 45 * DEG).undercut_limit_shift

    assert limit(13) < 0.0 < limit(12)
    tredgold = [1 - z / math.cos(45 * DEG) * math.sin(ALPHA) ** 2 / 2 for z in (12, 13)]
    assert (limit(12), limit(13)) == pytest.approx(tredgold, abs=0.06)


# a pair --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("teeth", "degrees", "expected"),
    [((31, 31), 90, (45, 45)), ((20, 40), 90, (26.56505, 63.43495)), ((25, 25), 120, (60, 60)), ((20, 40), 60, None)],
)
def test_pitch_cones_touch_along_a_line_and_roll(
    teeth: tuple[int, int], degrees: float, expected: tuple[float, float] | None
) -> None:
    first, second = pitch_angles(teeth[0], teeth[1], degrees * DEG)
    assert first + second == pytest.approx(degrees * DEG, abs=1e-15)
    assert teeth[0] * math.sin(second) == pytest.approx(teeth[1] * math.sin(first), rel=1e-15)
    if expected:
        assert (first / DEG, second / DEG) == pytest.approx(expected, abs=5e-6)


@given(pairs())
def test_the_wheel_at_rest_sees_the_same_pitch_line_at_azimuth_zero(pair: BevelPair) -> None:
    rest = pair.world_from_wheel
    assert np.abs(rest @ rest.T - np.eye(3)).max() < 1e-15
    assert np.linalg.det(rest) == pytest.approx(1.0)
    assert np.abs(rest - nominal_shafts(pair.shaft_angle, 1)[1, 0, :3, :3]).max() < 1e-15
    lines = [np.array([math.sin(g.pitch_angle), 0.0, math.cos(g.pitch_angle)]) for g in (pair.pinion, pair.wheel)]
    assert np.abs(rest @ lines[1] - lines[0]).max() < 1e-9  # the angles may differ by that


@given(pairs())
def test_contact_ratio_is_what_the_tip_cones_cut_out_of_the_plane_of_action(pair: BevelPair) -> None:
    alpha, first = pair.pinion.pressure_angle, pair.pinion.pitch_angle
    # the plane of action holds the pitch line and leans by alpha from the common tangent plane of the pitch cones
    pitch_line, across = np.array([math.sin(first), 0.0, math.cos(first)]), np.array([0.0, 1.0, 0.0])
    up = np.cross(pitch_line, across)
    into = math.cos(alpha) * across - math.sin(alpha) * up
    axes = np.array([0.0, 0.0, 1.0]), np.array([math.sin(pair.shaft_angle), 0.0, math.cos(pair.shaft_angle)])

    def reached(axis: np.ndarray, tip: float, sense: float) -> float:
        def outside(angle: float) -> float:
            line = math.cos(angle) * pitch_line + sense * math.sin(angle) * into
            return math.acos(line @ axis) - tip

        return brentq(outside, 0.0, 0.6, xtol=1e-14)

    # each tip is met on the side that leads away from its own axis
    senses = [math.copysign(1.0, -(into @ axis)) for axis in axes]
    assert senses[0] == -senses[1]
    tips = [gear.tip_angle for gear in (pair.pinion, pair.wheel)]
    path = sum(reached(axis, tip, sense) for axis, tip, sense in zip(axes, tips, senses, strict=True))
    base_pitch = 2 * math.pi * math.sin(first) * math.cos(alpha) / pair.pinion.teeth
    assert pair.contact_ratio == pytest.approx(path / base_pitch, abs=1e-10)


def gaps_on_a_slice(pair: BevelPair, driver: float, driven: float, flank: Flank, slice_at: float) -> np.ndarray:
    """Distances [mm] of the pairs in contact by the product's own list, by a search along the profile, on one slice."""
    teeth, near = pair.candidate_teeth(np.array([driver]), flank)
    mates = pair.mating_teeth(teeth, flank)
    mesh = mesh_of(pair, 1)
    turned = mesh.driven_from_driver(np.array([driver]), np.array([driven]))[0, :3, :3]

    def distance(roll: np.ndarray) -> np.ndarray:
        points = mesh.driver.flank_points(np.array(slice_at), roll, teeth[..., None], flank)
        return mesh.driven.signed_distance(points @ turned.T, mates[..., None], flank)

    begin, end = (np.full(teeth.shape, roll) for roll in mesh.driver.rolls)
    return zoomed_minimum(distance, begin, end, (101, 5))[near]


@FLANKS
@settings(max_examples=40, deadline=None)
@given(pair=pairs(), driver=st.floats(-20.0, 20.0), along=st.floats(0.0, 1.0))
def test_nominal_teeth_touch_on_both_flanks_at_any_ratio_and_shaft_angle(
    flank: Flank, pair: BevelPair, driver: float, along: float
) -> None:
    driven = pair.driven_angle(np.array([driver]))
    told = pair.start_angle(np.array([driver]), flank, np.zeros((1, 2)))
    assert told == pytest.approx(driven, abs=1e-13)
    near, far = pair.face
    gaps = gaps_on_a_slice(pair, driver, float(driven[0]), flank, near + along * (far - near))
    assert abs(gaps.min()) < 1e-8  # mm; what the search along the profile leaves


@pytest.mark.parametrize("name", PAIRS)
def test_transmission_error_of_nominal_teeth_is_below_1e_5_um(name: str) -> None:
    pair = PAIRS[name]
    pair.refuse_interference()
    angle = np.linspace(0.0, 3 * pair.pinion.angular_pitch, 7)
    mesh = mesh_of(pair, len(angle)).between(*[pair.mean_cone_distance] * 2)
    nominal = pair.driven_angle(angle)
    for flank in (RIGHT, LEFT):
        # begun 10 um away, lest a search find what it was given
        begun = nominal + flank * 0.01 / pair.working_radii[1]
        found = brute_force.turn_until_contact(mesh, angle, begun, flank)
        assert np.abs(found - nominal).max() * pair.working_radii[1] * UM < 1e-5
    assert pair.normal_backlash == pytest.approx(0.0, abs=1e-13)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("share", "expected"), [(0.0, 74.8970), (0.5, 79.8739), (1.0, 84.8507)], ids=["toe", "middle", "heel"]
)
def test_proportional_thinning_of_42_5_um_each_leaves_a_gap_that_grows_from_the_apex(
    share: float, expected: float
) -> None:
    """j_n(R) = R sin(cos(alpha) (E1 + E2)/R_m): thinner teeth are the same flanks turned."""
    thickness, at = -0.0425, PAPER_GEAR.inner_cone_distance + 9.0 * share
    closed = at * math.sin(math.cos(ALPHA) * -2 * thickness / PAPER_GEAR.mean_cone_distance) * UM
    assert closed == pytest.approx(expected, abs=5e-5)
    angle = np.array([0.0, 0.05, 1.7])
    mesh = mesh_of(PAPER, len(angle), turned=thickness / (2 * PAPER_GEAR.mean_radius))
    # the foot of a point at the toe lies a little nearer to the apex: give the driven gear some more face
    mesh = replace(mesh, driven=replace(mesh.driven, face=(60.0, 80.0)))
    assert brute_force.normal_backlash(mesh, angle, LEFT, (at, at)) * UM == pytest.approx(closed, abs=1e-5)
    # the same by the closed distance, with the wheel turned where start_angle says
    driven = PAPER.start_angle(angle, LEFT, np.full((3, 2), thickness))
    back = PAPER.start_angle(angle, RIGHT, np.full((3, 2), thickness))
    play = at * np.sin(math.sin(PAPER_GEAR.base_angle) * (driven - back))
    assert play * UM == pytest.approx(closed, abs=1e-9)


@pytest.mark.parametrize(("arc", "expected"), [(0.01, 100.8114), (-0.01, 87.1306)])
def test_ten_um_of_shaft_angle_change_the_gap_as_the_pressure_angles_do(arc: float, expected: float) -> None:
    """With the apexes in one point the pitch cones of delta + error/2 are the working ones, and inv(delta) changes."""
    mean, beta, thinned = PAPER_GEAR.mean_cone_distance, PAPER_GEAR.base_angle, 0.05
    error = arc / mean
    grown = float(spherical_involute(45 * DEG + error / 2, beta) - spherical_involute(45 * DEG, beta))
    closed = mean * math.sin(4 * math.sin(beta) * grown + math.cos(ALPHA) * 2 * thinned / mean) * UM
    assert closed == pytest.approx(expected, abs=5e-5)
    angle = np.array([0.0, 0.08])
    mesh = mesh_of(PAPER, len(angle), turned=-thinned / (2 * PAPER_GEAR.mean_radius))
    shafts = nominal_shafts(RIGHT_ANGLE + error, len(angle))
    mesh = replace(mesh, driven_shaft=shafts[1])
    assert brute_force.normal_backlash(mesh, angle, LEFT, (mean, mean)) * UM == pytest.approx(closed, abs=1e-5)


@FLANKS
@settings(max_examples=20, deadline=None)
@given(pair=pairs(), driver=st.floats(-20.0, 20.0), thickness=st.tuples(st.floats(-0.05, 0.05), st.floats(-0.05, 0.0)))
def test_start_angle_is_where_teeth_of_other_thickness_touch(
    flank: Flank, pair: BevelPair, driver: float, thickness: tuple[float, float]
) -> None:
    driven = pair.start_angle(np.array([driver]), flank, np.array([thickness]))
    mesh = mesh_of(pair, 1)
    turned = [t / (2 * g.mean_radius) for t, g in zip(thickness, (pair.pinion, pair.wheel), strict=True)]
    mesh = replace(
        mesh, driver=replace(mesh.driver, turned=turned[0]), driven=replace(mesh.driven, turned=turned[1])
    ).between(pair.face[1], pair.face[1])
    assert abs(brute_force.smallest_distance(mesh, np.array([driver]), driven, flank)[0]) < 1e-8


@FLANKS
@given(pair=pairs(), driver=st.floats(-20.0, 20.0), opened=st.floats(0.0, 0.02))
def test_turning_either_gear_in_the_opening_sense_opens_that_flank_side(
    flank: Flank, pair: BevelPair, driver: float, opened: float
) -> None:
    """By as much as its own base cone's arm says: R sin(sin(beta) turn)."""
    heel = pair.face[1]
    sense = flank
    angles = [np.array([driver]), pair.driven_angle(np.array([driver]))]
    teeth, near = pair.candidate_teeth(angles[0], flank)
    mate = pair.mating_teeth(teeth, flank)
    tooth = np.flatnonzero(near[0])[len(np.flatnonzero(near[0])) // 2]
    azimuth = driver + teeth[0, tooth] * pair.pinion.angular_pitch
    q = pair.pinion.pitch_q + math.sin(pair.pinion.base_angle) * (pair.pinion.pitch_half_angle - flank * azimuth)
    for gear in (0, 1):
        turned = [angles[0][0], angles[1][0]]
        turned[gear] += sense * opened / (heel * math.sin((pair.pinion, pair.wheel)[gear].base_angle))
        point = heel * pair.pinion.flank_directions(np.array([q]), flank)
        first = turned_about_z(turned[0] + teeth[0, tooth] * pair.pinion.angular_pitch)
        second = turned_about_z(turned[1] + mate[0, tooth] * pair.wheel.angular_pitch)
        seen = point @ (second.T @ pair.world_from_wheel.T @ first).T
        wheel = pair.wheel
        foot = nearest_on_flank(seen, wheel.base_angle, wheel.flank_start(flank), flank)
        # the driver's point has moved along the flank too; a flank bends by (opened)^2/R tan q
        assert foot.distance[0] == pytest.approx(opened, abs=1e-10 + 2 * opened**2 / (heel * 0.01))


def turned_about_z(angle: float) -> np.ndarray:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


@pytest.mark.parametrize("widths", [(6.0, 10.0), (10.0, 6.0)])
def test_gears_of_different_face_width_share_the_face_at_the_heel(widths: tuple[float, float]) -> None:
    pair = bevel_pair((20, 30), 60)
    pinion, wheel = (replace(g, face_width=b) for g, b in zip((pair.pinion, pair.wheel), widths, strict=True))
    pair = BevelPair(pinion, wheel, 60 * DEG)
    # sin(delta_1) = sin(60) / |(30/20 + cos(60), sin(60))|, so R_e = m z / (2 sin(delta_1))
    outer = 2.5 * 10 * math.hypot(2.0, math.sin(60 * DEG)) / math.sin(60 * DEG)
    assert pair.face == pytest.approx((outer - 6.0, outer), rel=1e-14)
    assert pair.mean_cone_distance == pytest.approx(outer - 3.0, rel=1e-14)
    assert pair.working_radii == pytest.approx([(outer - 3.0) / outer * r for r in (25.0, 37.5)], rel=1e-14)


def test_long_period_is_over_when_the_same_teeth_meet_again() -> None:
    for pinion, wheel in ((17, 43), (20, 30), (31, 31)):
        pair = bevel_pair((pinion, wheel), 90)
        met = next(turns for turns in range(1, 1000) if (turns * pinion) % wheel == 0)
        assert pair.long_period_turns == met
        assert pair.ratio == wheel / pinion


# candidate teeth ------------------------------------------------------------------------------------------------

TOUCHING = 1e-6  # mm


@pytest.mark.slow
@FLANKS
@pytest.mark.parametrize("shifted", [-0.05, 0.0, 0.05])
@pytest.mark.parametrize("name", PAIRS)
def test_candidate_teeth_hold_every_pair_that_a_scan_finds_touching(name: str, shifted: float, flank: Flank) -> None:
    """At random positions, also with the wheel's apex off by a twentieth of a module along both axes and across."""
    pair = PAIRS[name]
    pair.refuse_interference()
    off, angle = shifted * pair.pinion.module, np.random.default_rng(3).uniform(-50.0, 50.0, 4)
    thin = -0.1 * pair.pinion.module / (2 * pair.pinion.mean_radius)
    mesh = mesh_of(pair, len(angle), turned=thin).between(pair.mean_cone_distance, pair.mean_cone_distance)
    mesh.driven_shaft[:, :3, 3] += [off, -off, off]
    driven = brute_force.turn_until_contact(mesh, angle, brute_force.tooth_in_space(mesh, angle), flank)
    teeth, distance, mates = brute_force.distances(mesh, angle, driven, flank)
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
        assert may_touch.sum(axis=1).mean() == pytest.approx(pair.contact_ratio + 2 * 0.30, abs=2e-3)


# large cones: spur gears ------------------------------------------------------------------------------------------


def nearly_spur(shaft_angle: float) -> BevelPair:
    angles = pitch_angles(28, 40, shaft_angle)
    first, second = (
        BevelGear(z, 2.5, ALPHA, 20.0, delta, profile_shift=x)
        for z, delta, x in zip((28, 40), angles, (0.2, -0.2), strict=True)
    )
    return BevelPair(first, second, shaft_angle)


def test_on_nearly_parallel_axes_a_bevel_pair_is_a_spur_pair() -> None:
    """Everything differs by the square of the shaft angle: a fourth for half of it."""
    spur = SpurPair(
        SpurGear(28, 2.5, ALPHA, 20.0, profile_shift=0.2), SpurGear(40, 2.5, ALPHA, 20.0, profile_shift=-0.2), 85.0
    )
    figures: dict[str, tuple[Callable[[BevelPair], float], float]] = {
        "contact ratio": (lambda pair: pair.contact_ratio, spur.contact_ratio),
        "undercut limit": (lambda pair: pair.pinion.undercut_limit_shift, spur.pinion.undercut_limit_shift),
        "tip thickness": (lambda pair: pair.wheel.tip_thickness, spur.wheel.tip_thickness),
        "base half angle": (lambda pair: pair.wheel.base_half_angle, spur.wheel.base_half_angle),
        "tip roll": (lambda pair: pair.pinion.tip_q / math.sin(pair.pinion.base_angle), spur.pinion.tip_roll),
    }
    for name, (figure, expected) in figures.items():
        errors = [abs(figure(nearly_spur(angle)) - expected) for angle in (0.08, 0.04, 0.02)]
        assert errors[0] / errors[1] == pytest.approx(4, rel=0.03), name
        assert errors[1] / errors[2] == pytest.approx(4, rel=0.03), name
        assert errors[2] < 1e-3, name


@FLANKS
def test_flanks_on_nearly_parallel_axes_are_involutes(flank: Flank) -> None:
    spur = SpurGear(28, 2.5, ALPHA, 20.0, profile_shift=0.2)
    rolls = np.linspace(0.0, spur.tip_roll, 9)
    errors = []
    for angle in (0.08, 0.04, 0.02):
        gear = nearly_spur(angle).pinion
        points = gear.outer_cone_distance * gear.flank_directions(rolls * math.sin(gear.base_angle), flank)
        errors.append(np.abs(points[:, :2] - spur.flank_points(rolls, flank)).max())
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.03)
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.03)


def test_undercut_on_nearly_parallel_axes_is_a_rack_s() -> None:
    spur = SpurGear(11, 2.5, ALPHA, 20.0)
    errors = []
    for angle in (0.08, 0.04, 0.02):
        gear = BevelGear(11, 2.5, ALPHA, 20.0, angle)
        height = gear.outer_cone_distance * math.tan(gear.undercut_angle - angle)
        errors.append(abs(height - (spur.undercut_radius - spur.reference_radius)))
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.05)
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.05)


# the search itself -------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_search_finds_what_a_minimisation_over_four_parameters_finds() -> None:
    """scipy's L-BFGS-B over cone distance and roll of both flanks, from several starts, at a crooked pose."""
    mesh = mesh_of(PAPER, 1, turned=-0.0425 / (2 * PAPER_GEAR.mean_radius))
    mesh.driven_shaft[0] = pose([0.002, -0.001, 0.0], [0.02, -0.01, 0.03]) @ mesh.driven_shaft[0]
    angle = np.array([0.3])
    driven = PAPER.driven_angle(angle) + 0.003
    teeth, found, mates = brute_force.distances(mesh, angle, driven, RIGHT)
    best = int(np.argmin(found[0]))
    driven_from_driver = mesh.driven_from_driver(angle, driven)[0]
    (near, far), (begin, end) = mesh.driver.face, mesh.driver.rolls

    def squared(at: np.ndarray) -> float:
        first, roll, second, mate_roll = near + (far - near) * at[0], at[1], near + (far - near) * at[2], at[3]
        one = (
            mesh.driver.flank_points(first, roll, teeth[0, best], RIGHT) @ driven_from_driver[:3, :3].T
            + driven_from_driver[:3, 3]
        )
        other = mesh.driven.flank_points(second, mate_roll, mates[0, best], RIGHT)
        return float(((one - other) ** 2).sum()) * 1e4

    starts = [
        [s, begin + a * (end - begin), s, begin + b * (end - begin)]
        for s in (0.1, 0.9)
        for a, b in ((0.3, 0.6), (0.5, 0.4), (0.7, 0.2))
    ]
    bounds = [(0.0, 1.0), (begin, end), (0.0, 1.0), (begin, end)]
    options = {"ftol": 1e-16, "gtol": 1e-10, "maxiter": 5000}
    results = [minimize(squared, start, method="L-BFGS-B", bounds=bounds, options=options).fun for start in starts]
    # a minimiser without second derivatives stops some nanometres above the bottom of the valley
    assert math.sqrt(min(results)) / 100 == pytest.approx(found[0, best], abs=1e-5)
    assert math.sqrt(min(results)) / 100 >= found[0, best] - 1e-9


# refusals ------------------------------------------------------------------------------------------------------------


def numbers(text: str) -> list[float]:
    return [float(number) for number in re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", text)]


def refusal(**changed: Any) -> str:
    with pytest.raises(GeometryError) as caught:
        replace(PAPER_GEAR, **changed)
    return str(caught.value)


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"teeth": 2}, ["teeth", "at least 3", "got 2"]),
        ({"module": 0.0}, ["module", "0 mm"]),
        ({"module": math.nan}, ["module", "nan"]),
        ({"face_width": -1.0}, ["face_width", "-1 mm"]),
        ({"face_width": 70.0}, ["face_width", "69.0490 mm", "76.7211 mm", "70 mm"]),
        ({"pressure_angle": 50 * DEG}, ["pressure_angle", "50 deg"]),
        ({"pitch_angle": 90 * DEG}, ["pitch_angle", "90 deg"]),
        ({"pitch_angle": 0.0}, ["pitch_angle", "0 deg"]),
        ({"pitch_angle": 88 * DEG}, ["tip cone (91.6", "root cone", "90 deg"]),
        ({"addendum": -1.3, "dedendum": 2.0}, ["no involute", "base cone (41.6411 deg)"]),
        ({"dedendum": 40.0}, ["root cone (-"]),
        ({"dedendum": -1.1}, ["tip cone", "root cone"]),
        ({"bore": 91.0}, ["bore", "91 mm", f"{PAPER_GEAR.inner_root_diameter:.4f} mm"]),
        ({"bore": -1.0}, ["bore", "-1 mm"]),
    ],
)
def test_gears_that_cannot_be_made_are_refused_with_their_numbers(changed: dict[str, Any], told: list[str]) -> None:
    text = refusal(**changed)
    for words in told:
        assert words in text


def test_pointed_teeth_are_refused_with_the_cone_where_flanks_meet() -> None:
    text = refusal(teeth=10, profile_shift=1.4)
    gear = replace(plain_bevel(PAPER_GEAR), teeth=10, profile_shift=1.4)
    x, y, _ = brute_force.line(gear.base_angle, gear.rolls[1], gear.start, LEFT).direction
    assert "pointed teeth" in text
    radius = 3.5 * (5 + 2.4 * math.cos(45 * DEG))
    assert numbers(text)[0] == pytest.approx(2 * radius, abs=1e-4)
    assert numbers(text)[1] == pytest.approx(2 * radius * math.atan2(y, x), abs=1e-4)


def test_a_tooth_space_that_closes_at_the_root_is_refused() -> None:
    assert "no tooth space is left at the root" in refusal(pressure_angle=35 * DEG, dedendum=2.5, addendum=0.5)


@pytest.mark.parametrize("field", ["pressure_angle", "pitch_angle", "profile_shift", "addendum", "dedendum", "bore"])
def test_numbers_that_are_none_are_refused(field: str) -> None:
    assert refusal(**{field: math.nan})


@pytest.mark.parametrize(("teeth", "degrees"), [((17, 43), 120), ((10, 60), 100), ((20, 20), 0), ((20, 20), 180)])
def test_shaft_angles_that_flatten_a_pitch_cone_are_refused(teeth: tuple[int, int], degrees: float) -> None:
    with pytest.raises(GeometryError, match=f"shaft_angle.*{degrees}.* deg"):
        pitch_angles(teeth[0], teeth[1], degrees * DEG)


def pair_refusal(pinion: BevelGear, wheel: BevelGear, shaft_angle: float = RIGHT_ANGLE) -> str:
    with pytest.raises(GeometryError) as caught:
        BevelPair(pinion, wheel, shaft_angle).refuse_interference()
    return str(caught.value)


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"module": 3.6}, ["same module", "3.5 mm", "3.6 mm"]),
        ({"pressure_angle": 25 * DEG}, ["same pressure_angle", "0.349066", "0.436332"]),
        ({"pitch_angle": 46 * DEG}, ["91.000000 deg", "90.000000 deg"]),
        ({"teeth": 32}, ["31 and 32 teeth", "44.0906", "45.9093", "76.7211", "79.1960"]),
        ({"profile_shift": 0.1}, ["cancel", "0 and 0.1"]),
    ],
)
def test_gears_that_do_not_belong_together_are_refused(changed: dict[str, Any], told: list[str]) -> None:
    text = pair_refusal(PAPER_GEAR, replace(PAPER_GEAR, **changed))
    for words in told:
        assert words in text


def test_tips_in_roots_are_refused_with_the_depth() -> None:
    text = pair_refusal(replace(PAPER_GEAR, dedendum=0.9), PAPER_GEAR)
    depth = 76.721086 * math.sin(math.atan(3.5 / 76.721086) - math.atan(0.9 * 3.5 / 76.721086))
    assert f"the tip of the driven gear and the root of the driver gear interfere by {depth:.4f} mm" in text


def test_undercut_that_reaches_the_flank_in_use_is_refused_with_the_shift_that_mends_it() -> None:
    text = pair_refusal(*((pair := bevel_pair((9, 40), 90)).pinion, pair.wheel))
    assert "undercut" in text
    assert f"{math.degrees(pair.pinion.undercut_angle):.4f} deg" in text
    assert "(it has 0)" in text
    limit = pair.pinion.undercut_limit_shift
    assert f"at least {limit:.4f}" in text
    bevel_pair((9, 40), 90, shift=limit + 1e-4).refuse_interference()


def test_contact_below_where_the_involute_begins_is_refused_with_both_cones() -> None:
    pair = bevel_pair((19, 60), 90)
    text = pair_refusal(replace(pair.pinion, dedendum=1.5), replace(pair.wheel, addendum=1.24))
    assert "its involute begins at" in text
    assert f"{math.degrees(pair.pinion.base_angle):.4f} deg" in text


def test_a_contact_ratio_below_one_is_refused_with_its_value() -> None:
    short = replace(PAPER_GEAR, addendum=0.5)
    text = pair_refusal(short, short)
    ratio = 2 * (short.tip_q - short.pitch_q) / short.base_pitch_angle
    assert numbers(text)[0] == pytest.approx(ratio, abs=1e-4)
    assert ratio < 1
