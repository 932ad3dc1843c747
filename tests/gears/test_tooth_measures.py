"""Spans and sizes over pins against the teeth's outlines, with no formula of either."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq, minimize_scalar

from tol3d.errors import GeometryError
from tol3d.gears import InternalGear, SpurGear
from tol3d.gears.cylindrical_gear import CylindricalGear
from tol3d.gears.tooth_measures import OverPins, PinScale, Span, pins_of, span_of, spans_of

GEARS = 1000
CLOSE = 1e-9  # mm


def random_gears(count: int) -> list[CylindricalGear]:
    """External and internal in turn, with profile shift and thinned teeth."""
    rng, found = np.random.default_rng(34), list[CylindricalGear]()
    while len(found) < count:
        kind = InternalGear if len(found) % 2 else SpurGear
        module = float(rng.uniform(0.3, 8.0))
        try:
            own = kind(
                int(rng.integers(25, 140)) if kind is InternalGear else int(rng.integers(9, 140)),
                module,
                math.radians(rng.uniform(15.0, 28.0)),
                10.0,
                profile_shift=float(rng.uniform(-0.5, 0.8)),
                addendum=float(rng.uniform(0.8, 1.0)),
                tooth_thickness_deviation=-float(rng.uniform(0.0, 0.08)) * module,
            )
        except GeometryError:
            continue
        if span_of(own) and pins_of(own):
            found.append(own)
    return found


def convex_half(gear: CylindricalGear) -> Callable[[float], float]:
    """Half angle [rad] at a radius of what bulges: a tooth, or the space of an internal gear."""
    r = gear.module * gear.teeth / 2
    nominal = gear.module * (math.pi / 2 + 2 * gear.profile_shift * math.tan(gear.pressure_angle))
    tooth = (nominal + gear.tooth_thickness_deviation) / (2 * r)
    at_reference = math.pi / gear.teeth - tooth if isinstance(gear, InternalGear) else tooth
    base = r * math.cos(gear.pressure_angle)

    def inv(radius: float) -> float:
        roll = math.sqrt(max((radius / base) ** 2 - 1.0, 0.0))
        return roll - math.atan(roll)

    return lambda radius: at_reference + inv(r) - inv(radius)


def support(gear: CylindricalGear, azimuth: float, direction: float) -> float:
    """Reach of the left flank of what bulges at an azimuth in a direction [mm]; inside the involute alone."""
    half, base = convex_half(gear), gear.base_radius

    def reach(radius: float) -> float:
        return -radius * math.cos(azimuth + half(radius) - direction)

    found = minimize_scalar(reach, bounds=(base * (1 + 1e-12), 1.6 * base), method="bounded", options={"xatol": 1e-9})
    return -float(found.fun)


def span_by_search(gear: CylindricalGear, teeth: int) -> float:
    """Distance of parallel tangents of the outer flanks of so many teeth, or spaces."""
    spread = math.pi * (teeth - 1) / gear.teeth
    return 2 * support(gear, spread, math.pi / 2)


def over_pins_by_search(gear: CylindricalGear, diameter: float) -> float:
    """Size over pins whose least distance to a flank of their space is half their diameter."""
    half, base, inside = convex_half(gear), gear.base_radius, isinstance(gear, InternalGear)
    azimuth = 0.0 if inside else math.pi / gear.teeth

    def nearest(centre: float) -> float:
        def distance(roll: float) -> float:  # of roll: a smooth parameter where the flank begins
            radius = base * math.hypot(1.0, roll)
            return math.hypot(
                radius * math.cos(half(radius)) - centre * math.cos(azimuth),
                radius * math.sin(half(radius)) - centre * math.sin(azimuth),
            )

        found = minimize_scalar(distance, bounds=(0.0, 1.5), method="bounded", options={"xatol": 1e-10})
        return float(found.fun) - diameter / 2

    near = OverPins(diameter).touches_at(gear)
    centre = brentq(nearest, *((near - diameter, near) if inside else (near, near + diameter)), xtol=1e-12)
    opposite = math.pi * (gear.teeth // 2) * 2 / gear.teeth
    between = math.dist((centre, 0.0), (centre * math.cos(opposite), centre * math.sin(opposite)))
    return between - diameter if inside else between + diameter


@pytest.mark.slow
def test_spans_and_sizes_over_pins_are_those_of_the_outlines_of_1000_gears() -> None:
    _against_outlines(GEARS)


def test_spans_and_sizes_over_pins_are_those_of_the_outlines() -> None:
    _against_outlines(40)


def _against_outlines(count: int) -> None:
    for gear in random_gears(count):
        span, pins = span_of(gear), pins_of(gear)
        assert span
        assert pins
        assert span.size(gear) == pytest.approx(span_by_search(gear, span.teeth), abs=CLOSE), gear
        assert pins.size(gear) == pytest.approx(over_pins_by_search(gear, pins.diameter), abs=CLOSE), gear
        assert span.thickness(gear, span.size(gear)) == pytest.approx(gear.tooth_thickness, abs=CLOSE)
        assert pins.thickness(gear, pins.size(gear)) == pytest.approx(gear.tooth_thickness, abs=CLOSE)
        scale, off = PinScale(gear, pins), gear.module * np.array([-0.03, 0.0, 0.02])
        arcs = [pins.thickness(gear, pins.size(gear) + own) - gear.tooth_thickness for own in off.tolist()]
        assert scale.deviation(off) == pytest.approx(arcs, abs=CLOSE)
        assert scale.measured(scale.deviation(off)) == pytest.approx(off, abs=CLOSE)


def test_a_span_by_hand() -> None:
    """m 2.5, 20 teeth, 20 degrees, over 3: W/m = 7.660443 (tables of base tangent lengths: 7.6604 for z = 20)."""
    gear = SpurGear(20, 2.5, math.radians(20), 10.0)
    assert Span(3).size(gear) == pytest.approx(
        2.5 * math.cos(math.radians(20)) * (2.5 * math.pi + 20 * 0.014904383867), abs=1e-8
    )
    assert Span(3).size(gear) / 2.5 == pytest.approx(7.6604, abs=5e-5)


@given(st.floats(0.0, 0.1), st.booleans())
def test_thinner_teeth_have_smaller_spans_outside_and_larger_ones_inside(thinner: float, inside: bool) -> None:
    kind, teeth = (InternalGear, 60) if inside else (SpurGear, 24)
    full = kind(teeth, 2.0, math.radians(20), 10.0)
    thin = kind(teeth, 2.0, math.radians(20), 10.0, tooth_thickness_deviation=-thinner)
    change = Span(4).size(thin) - Span(4).size(full)
    assert change == pytest.approx((1 if inside else -1) * thinner * math.cos(math.radians(20)), abs=1e-12)


def test_a_span_that_touches_no_involute_is_refused_with_those_that_do() -> None:
    gear = SpurGear(20, 2.5, math.radians(20), 10.0)
    possible = [own.teeth for own in spans_of(gear)]
    words = f"expected {possible[0]} to {possible[-1]} teeth" if len(possible) > 1 else f"expected {possible[0]} teeth"
    for teeth in (5, 6):
        with pytest.raises(GeometryError, match=rf"span over {teeth} teeth touch at .* outside the involute .*{words}"):
            Span(teeth).require_reach(gear)
    Span(3).require_reach(gear)


def test_pins_that_do_not_fit_are_refused_with_some_that_do() -> None:
    gear = SpurGear(20, 2.5, math.radians(20), 10.0)
    fits = pins_of(gear)
    assert fits
    fits.require_reach(gear)
    for diameter in (1.0, 3.2, 9.0):
        with pytest.raises(GeometryError, match=r"pins of .* mm .*cho"):
            OverPins(diameter).require_reach(gear)
