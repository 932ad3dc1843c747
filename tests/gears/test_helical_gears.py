"""Helical gears and pairs: worked cases, limits, spans, balls and pins against searches of sampled flanks."""

import math
import re
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
import pytest
from oracles.screw_flanks import ScrewGear, ball_distance, caliper, pin_distance

from tol3d.errors import GeometryError
from tol3d.gears import LEFT_HAND, RIGHT_HAND, Hand, InternalGear, InternalPair, SpurGear, SpurPair
from tol3d.gears.tooth_measures import OverBalls, OverPins, PinScale, Span, pins_of, span_of

ALPHA = math.radians(20.0)
CLOSED_FORM = 1e-9  # mm
AnyGear = TypeVar("AnyGear", SpurGear, InternalGear)
ROUNDED = 5e-10  # mm and rad; what worked cases are printed to, in um and mrad


def helical(teeth: int, module: float, beta: float, hand: Hand, face: float, **more: Any) -> SpurGear:
    """A gear of the worked cases, its helix angle in degrees."""
    return SpurGear(teeth, module, ALPHA, face, helix_angle=math.radians(beta), hand=hand, **more)


def base_pair(
    centre_distance: float = 53.0, shift: float = 0.5441135839, thinner: tuple[float, float] = (0.06, 0.08)
) -> SpurPair:
    """The pair of most worked cases: 23 right-hand, 67 left-hand teeth, 30 deg."""
    pinion = helical(23, 1.0, 30.0, RIGHT_HAND, 16.0, profile_shift=0.55, tooth_thickness_deviation=-thinner[0])
    wheel = helical(67, 1.0, 30.0, LEFT_HAND, 11.0, profile_shift=shift, tooth_thickness_deviation=-thinner[1])
    return SpurPair(pinion, wheel, centre_distance)


def test_backlash_of_the_worked_pair_is_its_closed_form() -> None:
    pair = base_pair()
    assert pair.normal_backlash == pytest.approx(131.556967e-3, abs=ROUNDED)
    assert pair.normal_backlash == pytest.approx(0.14 * math.cos(ALPHA), abs=1e-6)  # thinning alone: E_sn cos alpha_n
    assert math.degrees(pair.working_pressure_angle) == pytest.approx(25.334158, abs=5e-7)
    assert pair.angular_backlash[1] == pytest.approx(4.179104478e-3, abs=5e-13)
    assert float(pair.driven_angle(np.array(1.1))) == pytest.approx(2.810870156, abs=ROUNDED)
    assert pair.circumferential_backlash == pytest.approx(
        pair.angular_backlash[1] * pair.working_radii[1], abs=CLOSED_FORM
    )


def test_twist_and_backlash_of_the_second_worked_pair() -> None:
    pinion = helical(24, 2.0, 15.0, RIGHT_HAND, 20.0, tooth_thickness_deviation=-0.06)
    wheel = helical(47, 2.0, 15.0, LEFT_HAND, 20.0, tooth_thickness_deviation=-0.08)
    pair = SpurPair(pinion, wheel, 73.504608809)
    assert wheel.twist == pytest.approx(-0.005506788, abs=ROUNDED)
    assert wheel.twist == pytest.approx(-2 * math.pi / wheel.lead, rel=1e-14)
    assert pair.normal_backlash == pytest.approx(131.556967e-3, abs=ROUNDED)


@pytest.mark.parametrize(
    ("opened", "normal", "arc"), [(0.015, 218.071e-3, 273.400e-3), (-0.015, 129.629e-3, 162.427e-3)]
)
def test_arcs_of_a_catalogue_pair_are_the_printed_ones(opened: float, normal: float, arc: float) -> None:
    """23/67 at 30 deg, c25 and js7: teeth as thin as give the normal backlash have the arc on the working circle."""
    thinner = (normal - base_pair(53.0 + opened, thinner=(0.0, 0.0)).normal_backlash) / math.cos(ALPHA)
    made = base_pair(53.0 + opened, thinner=(thinner, 0.0))
    assert made.normal_backlash == pytest.approx(normal, abs=CLOSED_FORM)
    assert made.circumferential_backlash == pytest.approx(arc, abs=1e-6)  # printed in um with three decimals


@pytest.mark.parametrize(
    ("teeth", "module", "beta", "shifts"), [((27, 51), 4.5, 21.0, 0.462830), ((23, 34), 6.5, 10.0, 0.301479)]
)
def test_a_public_gearbox_is_free_of_backlash_by_its_shifts(
    teeth: tuple[int, int], module: float, beta: float, shifts: float
) -> None:
    pinion = helical(teeth[0], module, beta, RIGHT_HAND, 50.0, profile_shift=0.6 * shifts)
    wheel = helical(teeth[1], module, beta, LEFT_HAND, 50.0, profile_shift=0.4 * shifts)
    pair = SpurPair(pinion, wheel, 190.0)
    assert abs(pair.normal_backlash) < 5e-6
    pair.refuse_interference()


PROPERTIES = (
    "base_radius", "tip_radius", "root_radius", "base_half_angle", "form_roll", "tip_roll", "tooth_thickness",
    "tip_thickness", "normal_tip_thickness", "section_arm", "thickness_radius", "section_tip", "undercut_limit_shift",
    "undercut_radius", "outline_area", "fillet_radius",
)  # fmt: skip


def test_a_helix_that_vanishes_gives_the_spur_gear() -> None:
    spur = SpurGear(17, 2.5, ALPHA, 20.0, profile_shift=0.1, tooth_thickness_deviation=-0.05)
    mate = SpurGear(40, 2.5, ALPHA, 18.0, tooth_thickness_deviation=-0.02)
    leaning = replace(spur, helix_angle=1e-8), replace(mate, helix_angle=1e-8, hand=LEFT_HAND)
    for name in PROPERTIES:
        assert getattr(leaning[0], name) == pytest.approx(getattr(spur, name), rel=1e-12, abs=1e-12), name
    ours, theirs = SpurPair(*leaning, 71.6), SpurPair(spur, mate, 71.6)
    assert ours.normal_backlash == pytest.approx(theirs.normal_backlash, abs=1e-12)
    assert Span(3).size(leaning[0]) == pytest.approx(Span(3).size(spur), abs=1e-12)
    assert OverBalls(4.5).size(leaning[0]) == pytest.approx(OverPins(4.5).size(spur), abs=1e-12)


def test_a_spur_gear_of_either_hand_is_the_same_to_the_last_bit() -> None:
    spur = SpurGear(17, 2.5, ALPHA, 20.0, profile_shift=0.1)
    for name in PROPERTIES:
        assert getattr(replace(spur, hand=LEFT_HAND), name) == getattr(spur, name)
    assert spur.section_arm == spur.base_radius == 2.5 * 17 / 2 * math.cos(ALPHA)


def ring_pair() -> InternalPair:
    """27 teeth in 79, right-hand, 15 deg, thinned by 60 and 80 um."""
    inner = helical(27, 1.0, 15.0, RIGHT_HAND, 12.0, profile_shift=0.2, tooth_thickness_deviation=-0.06)
    return InternalPair(
        inner,
        InternalGear(
            79, 1.0, ALPHA, 10.0, profile_shift=-0.2, tooth_thickness_deviation=-0.08, helix_angle=math.radians(15.0)
        ),
        26.917180691,
    )


def test_backlash_and_twist_of_the_worked_pair_in_a_ring() -> None:
    pair = ring_pair()
    assert pair.normal_backlash == pytest.approx(131.556967e-3, abs=ROUNDED)
    assert float(pair.driven_angle(np.array(0.3))) == pytest.approx(0.142298641, abs=ROUNDED)
    assert pair.ring.twist == pytest.approx(0.006552381, abs=ROUNDED)
    assert pair.inner.base_radius * pair.inner.twist == pytest.approx(
        pair.ring.base_radius * pair.ring.twist, rel=1e-14
    )
    pair.refuse_interference()
    turned = InternalPair(pair.ring, pair.inner, pair.centre_distance)
    assert turned.normal_backlash == pytest.approx(pair.normal_backlash, abs=1e-15)
    assert turned.total_contact_ratio == pytest.approx(pair.contact_ratio + pair.overlap_ratio, rel=1e-12)


def test_a_ring_whose_helix_vanishes_is_the_spur_ring() -> None:
    spur = InternalGear(79, 1.0, ALPHA, 10.0, profile_shift=-0.2, tooth_thickness_deviation=-0.05)
    leaning = replace(spur, helix_angle=1e-8)
    for name in (own for own in PROPERTIES if not own.startswith("undercut")):
        assert getattr(leaning, name) == pytest.approx(getattr(spur, name), rel=1e-12, abs=1e-12), name
        assert getattr(replace(spur, hand=LEFT_HAND), name) == getattr(spur, name)
    inner = SpurGear(27, 1.0, ALPHA, 12.0, profile_shift=0.2)
    ours = InternalPair(replace(inner, helix_angle=1e-8), leaning, 25.98)
    theirs = InternalPair(inner, spur, 25.98)
    assert ours.normal_backlash == pytest.approx(theirs.normal_backlash, abs=1e-12)
    assert OverBalls(1.7).size(leaning) == pytest.approx(OverPins(1.7).size(spur), abs=1e-12)


def test_size_between_balls_of_the_worked_ring() -> None:
    """As 2 r_K - D by a search of the flanks; its slope by E_sn is the printed one."""
    ring = InternalGear(
        60, 2.0, ALPHA, 20.0, helix_angle=math.radians(20.0), hand=LEFT_HAND, tooth_thickness_deviation=-0.1
    )
    balls, step = OverBalls(3.5), 1e-5
    assert balls.size(ring) == pytest.approx(122.822790668, abs=ROUNDED)
    ends = [balls.size(_as_thick(ring, ring.tooth_thickness + off)) for off in (-step, step)]
    assert (ends[1] - ends[0]) / (2 * step) == pytest.approx(-2.973550, abs=5e-7)


@pytest.mark.parametrize("measure", [Span(5), OverPins(3.5)])
def test_helical_rings_are_measured_between_balls_alone(measure: Span | OverPins) -> None:
    ring = InternalGear(60, 2.0, ALPHA, 20.0, helix_angle=math.radians(20.0))
    with pytest.raises(GeometryError, match=r"measure between balls, such as \{balls: 3\.3 mm\}"):
        measure.require_reach(ring)
    measure.require_reach(replace(ring, helix_angle=0.0))
    OverBalls(3.5).require_reach(ring)
    assert span_of(ring) is None
    assert isinstance(pins_of(ring), OverBalls)


def test_balls_that_touch_the_middle_of_a_ring_s_flank_are_proposed() -> None:
    for beta, shift in ((10.0, -0.2), (25.0, 0.0), (35.0, 0.1)):
        ring = InternalGear(70, 2.0, ALPHA, 20.0, profile_shift=shift, helix_angle=math.radians(beta), addendum=0.9)
        balls = pins_of(ring)
        assert balls is not None
        wanted = ring.reference_radius - shift * ring.module
        assert balls.touches_at(ring) == pytest.approx(wanted, abs=0.05)


def random_rings(count: int) -> list[tuple[InternalGear, ScrewGear]]:
    """Rings of ours and the oracle's, odd and even teeth, both hands."""
    rng, found = np.random.default_rng(53), list[tuple[InternalGear, ScrewGear]]()
    while len(found) < count:
        teeth, module, beta = int(rng.integers(40, 120)), float(rng.uniform(0.8, 6.0)), math.radians(rng.uniform(5, 40))
        hand: Hand = RIGHT_HAND if rng.random() < 0.5 else LEFT_HAND
        shift, thinner = float(rng.uniform(-0.3, 0.2)), float(rng.uniform(0, 0.05)) * module
        own: dict[str, Any] = {"helix_angle": beta, "hand": hand, "profile_shift": shift, "addendum": 0.9}
        try:
            ring = InternalGear(teeth, module, ALPHA, 10 * module, tooth_thickness_deviation=-thinner, **own)
        except GeometryError:
            continue
        screw = ScrewGear(teeth, module, ALPHA, beta, hand, 10 * module, shift, thinner, 0.9, True)
        found.append((ring, screw))
    return found


@pytest.mark.slow
@pytest.mark.parametrize(("ring", "screw"), random_rings(8))
def test_balls_in_rings_are_those_of_sampled_flanks(ring: InternalGear, screw: ScrewGear) -> None:
    balls = pins_of(ring)
    assert balls is not None
    radius = (balls.size(ring) + balls.diameter) / 2 / (math.cos(math.pi / 2 / ring.teeth) if ring.teeth % 2 else 1.0)
    assert ball_distance(screw, radius) == pytest.approx(balls.diameter / 2, abs=CLOSED_FORM)
    low, high = ring.tooth_thickness - 0.02 * ring.module, ring.tooth_thickness
    again = [balls.thickness(ring, balls.size(_as_thick(ring, own))) for own in (low, high)]
    assert again == pytest.approx([low, high], abs=1e-10)
    off, scale = ring.module * np.array([-0.03, 0.0, 0.02]), PinScale(ring, balls)
    assert np.abs(scale.deviation(scale.measured(off)) - off).max() < 1e-10
    lean = math.atan(ring.twist * radius)  # a straight pin along the space cuts the flanks that a ball touches
    assert pin_distance(screw, radius, lean) < balls.diameter / 2 - 1e-6


def test_a_thin_helical_gear_goes_into_its_ring_sideways_a_wide_one_along_its_helix_alone() -> None:
    """Over a wide face all phases of a pitch meet; a thin gear passes where it is turned to one at which it does."""
    beta = math.radians(20.0)
    leaning = InternalPair(
        helical(20, 1.0, 20.0, RIGHT_HAND, 30.0, addendum=0.9),
        InternalGear(32, 1.0, ALPHA, 30.0, addendum=0.9, helix_angle=beta),
        6.0 / math.cos(beta) - 0.03,
    )
    narrow = InternalPair(
        replace(leaning.inner, face_width=0.01), replace(leaning.ring, face_width=0.01), leaning.centre_distance
    )
    assert leaning.overlap_ratio > 1.0
    assert (leaning.radially_assembled, narrow.radially_assembled) == (False, True)


def test_span_of_the_worked_gear_and_the_face_it_needs() -> None:
    gear = helical(23, 1.0, 30.0, RIGHT_HAND, 16.0, profile_shift=0.55)
    assert Span(5).size(gear) == pytest.approx(14.145235271, abs=ROUNDED)
    assert Span(5).least_face_width(gear) == pytest.approx(6.646087, abs=5e-7)
    Span(5).require_reach(gear)
    with pytest.raises(GeometryError, match=r"6\.6461 mm apart along the axis, on a face only 6 mm wide"):
        Span(5).require_reach(replace(gear, face_width=6.0))


def random_gears(count: int) -> list[tuple[SpurGear, ScrewGear]]:
    """Gears of ours and the oracle's, odd and even teeth, both hands."""
    rng, found = np.random.default_rng(52), list[tuple[SpurGear, ScrewGear]]()
    while len(found) < count:
        teeth, module = int(rng.integers(12, 90)), float(rng.uniform(0.8, 6.0))
        alpha, beta = (math.radians(rng.uniform(*ends)) for ends in ((15.0, 25.0), (5.0, 40.0)))
        hand, shift, thinner = (
            int(rng.choice([-1, 1])),
            float(rng.uniform(-0.2, 0.5)),
            float(rng.uniform(0, 0.05)) * module,
        )
        try:
            gear = SpurGear(
                teeth, module, alpha, 30 * module, profile_shift=shift, tooth_thickness_deviation=-thinner,
                helix_angle=beta, hand=RIGHT_HAND if hand > 0 else LEFT_HAND,
            )  # fmt: skip
        except GeometryError:
            continue
        if span_of(gear) and pins_of(gear):
            found.append((gear, ScrewGear(teeth, module, alpha, beta, hand, 30 * module, shift, thinner)))
    return found


@pytest.mark.slow
@pytest.mark.parametrize(("gear", "screw"), random_gears(20))
def test_span_balls_and_pins_are_those_of_sampled_flanks(gear: SpurGear, screw: ScrewGear) -> None:
    span, balls = span_of(gear), pins_of(gear, OverBalls)
    assert span is not None
    assert balls is not None
    assert caliper(screw, span.teeth, 1.0 * span.least_face_width(gear)) == pytest.approx(
        span.size(gear), abs=CLOSED_FORM
    )
    odd = gear.teeth % 2 == 1
    radius = (balls.size(gear) - balls.diameter) / 2 / (math.cos(math.pi / 2 / gear.teeth) if odd else 1.0)
    assert ball_distance(screw, radius) == pytest.approx(balls.diameter / 2, abs=CLOSED_FORM)
    pins = OverPins(balls.diameter)
    centre = (pins.size(gear) - pins.diameter) / 2
    lean = math.atan(gear.twist * centre)
    assert pin_distance(screw, centre, lean) == pytest.approx(pins.diameter / 2, abs=CLOSED_FORM)
    assert (pins.size(gear) > balls.size(gear) + 1e-4) == odd  # 2 r_K (1 - cos(pi/2z)), 30 um at the least here
    for measure in (span, balls, pins):
        low, high = gear.tooth_thickness - 0.02 * gear.module, gear.tooth_thickness
        sizes = [measure.size(_as_thick(gear, own)) for own in (low, high)]
        again = [measure.thickness(gear, size) for size in sizes]
        assert again == pytest.approx([low, high], abs=1e-10)
    off = gear.module * np.array([-0.03, 0.0, 0.02])
    for kind in (balls, pins):
        scale = PinScale(gear, kind)
        assert np.abs(scale.deviation(scale.measured(off)) - off).max() < 1e-10


@pytest.mark.parametrize("teeth", [23, 24, 67])
def test_pins_and_balls_need_a_face_as_wide_as_their_contacts_lie_apart(teeth: int) -> None:
    """By the sampled flanks: heights of both contacts of a ball, and of the space opposite a pin."""
    gear = helical(teeth, 2.0, 25.0, LEFT_HAND, 30.0, profile_shift=0.1)
    screw = ScrewGear(teeth, 2.0, ALPHA, math.radians(25.0), -1, 30.0, 0.1)
    balls = pins_of(gear, OverBalls)
    assert balls is not None
    radius = gear.base_radius / math.cos(balls._angle(gear))

    def height(side: int) -> float:
        """That of the point of a flank of the space about +x that is nearest to the ball, on grids that shrink."""
        tooth = 0 if side < 0 else 1
        space = math.pi / teeth
        first, last = np.array([screw.ends[0], -2.0]), np.array([screw.tip + 1.0, 2.0])
        for _ in range(14):
            one, z = (np.linspace(low, high, 41) for low, high in zip(first, last, strict=True))
            apart = screw.points(one[:, None], z[None, :] + 0 * one[:, None], side, tooth, 0.0)
            apart = apart - radius * np.array([math.cos(space), math.sin(space), 0.0])
            i, j = np.unravel_index(np.argmin((apart**2).sum(axis=-1)), (41, 41))
            reach = (last - first) * 0.2
            first, last = np.array([one[i], z[j]]) - reach, np.array([one[i], z[j]]) + reach
        return float(z[j])

    spread = abs(height(1) - height(-1))
    assert balls.least_face_width(gear) == pytest.approx(spread, abs=1e-4)  # a minimum is flat: 1e-9 mm of distance
    pins = OverPins(balls.diameter)
    # spaces stand at (k + 1/2) pitches and go round with the height: the first height of one opposite that at +x
    pitch, ahead = 2 * math.pi / teeth, math.pi % (2 * math.pi / teeth)
    heights = [abs(own / screw.twist) for own in (ahead, pitch - ahead)]
    lowest = min(heights) if min(heights) > 1e-9 else 0.0
    assert pins.least_face_width(gear) == pytest.approx(spread + lowest, abs=1e-4)
    for measure in (balls, pins):
        least = measure.least_face_width(gear)
        measure.require_reach(replace(gear, face_width=least + 1e-9))
        words = rf"{measure.bodies} of .* mm touch up to {least:.4f} mm apart along the axis, on a face only"
        with pytest.raises(GeometryError, match=words):
            measure.require_reach(replace(gear, face_width=least - 1e-9))
        again = pins_of(replace(gear, face_width=0.99 * least), type(measure))
        assert again is None or again.least_face_width(gear) <= 0.99 * least


def test_thousand_thicknesses_come_back_from_each_measure() -> None:
    """A thousand gears, by span, balls and pins; to 1e-10 mm.

    A span and a tooth along its normals change by cos(alpha_n) of the arc in the normal section, the arc in the
    transverse section by 1/cos(beta) of it.
    """
    rng = np.random.default_rng(54)
    for gear, _ in random_gears(1000):
        span, balls = span_of(gear), pins_of(gear, OverBalls)
        assert span is not None
        assert balls is not None
        off = gear.module * rng.uniform(-0.04, 0.03, 1)
        made = [replace(gear, tooth_thickness_deviation=gear.tooth_thickness_deviation + own) for own in off.tolist()]
        thick = gear.tooth_thickness + off
        for measure in (span, balls, OverPins(balls.diameter)):
            sizes = np.array([measure.size(own) for own in made])
            again = np.array([measure.thickness(gear, own) for own in sizes.tolist()])
            assert np.abs(again - thick).max() < 1e-10
            changed = sizes - measure.size(gear)
            if isinstance(measure, Span):
                assert np.abs(changed / math.cos(gear.pressure_angle) - off).max() < 1e-10
            else:
                scale = PinScale(gear, measure)
                assert np.abs(scale.deviation(changed) - off).max() < 1e-10
                assert np.abs(scale.measured(off) - changed).max() < 1e-10
        transverse = np.array([2 * own.reference_radius * own.base_half_angle for own in made])
        transverse -= 2 * gear.reference_radius * gear.base_half_angle
        assert np.abs(transverse * math.cos(gear.helix_angle) - off).max() < 1e-10
        normal = 2 * gear.section_arm * np.array([own.base_half_angle - gear.base_half_angle for own in made])
        assert np.abs(normal / math.cos(gear.pressure_angle) - off).max() < 1e-10


def test_thousand_thicknesses_of_rings_come_back_from_balls() -> None:
    """To 1e-10 mm."""
    rng = np.random.default_rng(55)
    for ring, _ in random_rings(1000):
        balls = pins_of(ring)
        assert balls is not None
        off = float(ring.module * rng.uniform(-0.04, 0.03))
        made = replace(ring, tooth_thickness_deviation=ring.tooth_thickness_deviation + off)
        assert balls.thickness(ring, balls.size(made)) == pytest.approx(ring.tooth_thickness + off, abs=1e-10)
        scale = PinScale(ring, balls)
        measured = np.array([balls.size(made) - balls.size(ring)])
        assert scale.deviation(measured) == pytest.approx([off], abs=1e-10)


def _as_thick(gear: AnyGear, thickness: float) -> AnyGear:
    return replace(gear, tooth_thickness_deviation=gear.tooth_thickness_deviation + thickness - gear.tooth_thickness)


def test_a_ball_s_size_grows_with_the_thickness_as_derived() -> None:
    """cos(alpha_t)/(sin(alpha_Kt) cos(beta)) per E_sn, times cos(pi/2z) over an odd number of teeth."""
    gear, balls = helical(23, 1.0, 30.0, RIGHT_HAND, 16.0, profile_shift=0.2), OverBalls(2.0)
    step = 1e-5
    slope = (balls.size(_as_thick(gear, gear.tooth_thickness + step)) - balls.size(gear)) / step
    centre = (balls.size(gear) - 2.0) / 2 / math.cos(math.pi / 46)
    angle = math.acos(gear.base_radius / centre)
    derived = math.cos(gear.transverse_pressure_angle) / (math.sin(angle) * math.cos(gear.helix_angle))
    assert slope == pytest.approx(derived * math.cos(math.pi / 46), rel=1e-4)


def test_a_gear_cut_at_the_limit_shift_has_its_fillet_at_the_base_circle() -> None:
    """x_min = 1 - z sin^2 alpha_t/(2 cos beta): the rack's corner then passes the base circle's tangent point."""
    gear = helical(15, 2.0, 25.0, RIGHT_HAND, 20.0)
    limit = gear.undercut_limit_shift
    corner = gear.reference_radius - gear.module * (1.0 - limit)  # the rack's corner on the line of centres
    tangent_point = gear.base_radius * math.cos(gear.transverse_pressure_angle)
    assert corner == pytest.approx(tangent_point, abs=1e-12)
    assert replace(gear, profile_shift=limit + 1e-6).undercut_radius == gear.base_radius
    below = replace(gear, profile_shift=limit - 0.3)
    assert below.undercut_radius > below.base_radius


def test_overlap_carries_a_pair_that_its_profile_alone_would_not() -> None:
    steep = SpurPair(
        helical(14, 1.0, 40.0, RIGHT_HAND, 8.0, addendum=0.75),
        helical(15, 1.0, 40.0, LEFT_HAND, 8.0, addendum=0.75),
        19.3,
    )
    assert steep.contact_ratio < 1.0 < steep.total_contact_ratio
    assert steep.overlap_ratio == pytest.approx(
        8 * math.tan(steep.pinion.base_helix_angle) / steep.pinion.transverse_base_pitch
    )
    steep.refuse_interference()
    narrow = SpurPair(replace(steep.pinion, face_width=0.5), replace(steep.wheel, face_width=0.5), 19.3)
    words = r"total contact ratio 0\.\d+ \(0\.\d+ over the profile\) is below 1 .* face narrower than ([\d.]+) mm"
    with pytest.raises(GeometryError, match=words) as caught:
        narrow.refuse_interference()
    stated = re.search(words, str(caught.value))
    assert stated is not None
    least = math.pi * steep.pinion.module / math.sin(steep.pinion.helix_angle) * (1.0 - steep.contact_ratio)
    assert float(stated[1]) == pytest.approx(least, abs=1e-4)


def test_gears_whose_axes_would_cross_are_refused() -> None:
    pair = base_pair()
    with pytest.raises(GeometryError, match="opposite hands, got right and right"):
        SpurPair(pair.pinion, replace(pair.wheel, hand=RIGHT_HAND), 53.0)
    with pytest.raises(GeometryError, match="same helix_angle, got 30 deg and 29 deg"):
        SpurPair(pair.pinion, replace(pair.wheel, helix_angle=math.radians(29.0)), 53.0)
    with pytest.raises(GeometryError, match="same helix_angle, got 30 deg and 0 deg"):
        SpurPair(pair.pinion, replace(pair.wheel, helix_angle=0.0), 53.0)
    inner, outer = ring_pair().inner, ring_pair().ring
    with pytest.raises(GeometryError, match="a helical gear and its ring need the same hand, got right and left"):
        InternalPair(inner, replace(outer, hand=LEFT_HAND), 26.9)
    with pytest.raises(GeometryError, match="same helix_angle, got 15 deg and 0 deg"):
        InternalPair(inner, replace(outer, helix_angle=0.0), 26.9)
    with pytest.raises(GeometryError, match="helix_angle: expected 0 to 60 deg, got 63"):
        replace(outer, helix_angle=1.1)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"helix_angle": -0.1}, "helix_angle: expected 0 to 60 deg, got -5.7"),
        ({"helix_angle": 1.1}, "helix_angle: expected 0 to 60 deg, got 63.0"),
        ({"hand": 0}, "hand: expected 1 for a right-hand helix"),
        ({"face_width": 100.0}, r"face_width: expected at most half of the helix's lead, 72\.\d+ mm, got 100 mm"),
    ],
)
def test_impossible_helices_are_refused(changed: dict[str, Any], words: str) -> None:
    with pytest.raises(GeometryError, match=words):
        replace(base_pair().pinion, **changed)


def test_pins_that_touch_the_middle_of_the_flank_are_proposed() -> None:
    """The touching radius is missed by half a step of the diameters, times some 0.5 to 2 of radius per diameter."""
    for gear, _ in random_gears(12):
        pins = pins_of(gear)
        assert pins is not None
        wanted = min(max(gear.reference_radius + gear.profile_shift * gear.module, gear.form_radius), gear.tip_radius)
        if pins.touches_at(gear) < gear.tip_radius - 0.1 * gear.module:
            assert pins.touches_at(gear) == pytest.approx(wanted, abs=0.05)
