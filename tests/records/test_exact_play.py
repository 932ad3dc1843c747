"""The exact play of eccentric gears, against flanks that touch by a root finder, and the paper's first order."""

import math
from dataclasses import replace

import numpy as np
import pytest
from records.rigged import PAIR, REFERENCE, arcsec
from scipy.optimize import brentq

from tol3d.apps.records.pair import Side, Specimen, angular_backlash, driven_angle, transmission_error


def first_order(specimen: Specimen, phi1: np.ndarray) -> np.ndarray:
    """j = 2 sin(alpha)/r_b2 [e2 cos(phi2 + theta2) - e1 cos(phi1 + theta1)] + j_n/r_b2; the paper's equation 5."""
    phi2 = phi1 * 27 / 48
    steep = 2 * math.sin(math.radians(20)) / (48 * math.cos(math.radians(20)))
    own = specimen.e2 * np.cos(phi2 + specimen.theta2) - specimen.e1 * np.cos(phi1 + specimen.theta1)
    return np.asarray(steep * own + specimen.normal_backlash / (48 * math.cos(math.radians(20))))


def long_period(positions: int) -> np.ndarray:
    return np.linspace(0.0, 32 * math.pi, positions, endpoint=False)


def test_the_reference_pair_has_the_digest_s_numbers() -> None:
    """To 0.01 arcsec: the digest gives extremes on a grid, up to 0.7 deg and so 0.006 arcsec beside the true ones."""
    phi1 = long_period(57_600)
    backlash = angular_backlash(REFERENCE, phi1)
    assert arcsec(float(backlash[0])) == pytest.approx(267.037, abs=0.001)
    assert arcsec(float(backlash.min())) == pytest.approx(133.919, abs=0.01)
    assert arcsec(float(backlash.max())) == pytest.approx(415.027, abs=0.01)
    assert math.degrees(phi1[backlash.argmin()]) == pytest.approx(4279.2, abs=1.0)
    assert math.degrees(phi1[backlash.argmax()]) == pytest.approx(2664.8, abs=1.0)
    sides: tuple[tuple[Side, float], ...] = (("drive", 410.136), ("back", 410.768))
    for side, ptp in sides:
        assert arcsec(float(np.ptp(transmission_error(REFERENCE, phi1, side)))) == pytest.approx(ptp, abs=0.01)


def test_first_order_is_the_paper_s() -> None:
    backlash = first_order(REFERENCE, long_period(57_600))
    assert arcsec(float(backlash[0])) == pytest.approx(266.939, abs=0.001)
    assert arcsec(float(backlash.min())) == pytest.approx(133.674, abs=0.01)
    assert arcsec(float(backlash.max())) == pytest.approx(414.475, abs=0.01)


def test_exact_and_first_order_part_by_the_square_of_e() -> None:
    """The play grows with e, for the driven gear turns through it and its eccentricity with it: a product too."""
    phi1 = long_period(2000)

    def apart(scale: float) -> float:
        lengths = {name: scale * getattr(REFERENCE, name) for name in ("e1", "e2", "normal_backlash")}
        own = replace(REFERENCE, **lengths)
        return float(np.abs(angular_backlash(own, phi1) - first_order(own, phi1)).max())

    assert apart(1.0) / apart(0.5) == pytest.approx(4.0, rel=0.02)
    assert apart(0.5) / apart(0.25) == pytest.approx(4.0, rel=0.01)


@pytest.mark.parametrize("side", ["drive", "back"])
def test_flanks_touch_at_the_driven_angle(side: Side) -> None:
    """By the tangent to both base circles: with the centres where they are, the strings' lengths close.

    The line of action touches circle 1 about C1 and circle 2 about C2. Along it a point of contact moves by r_b per
    radian of either gear about its own centre; the condition is that of ISO 21771 for gears of that distance, its
    constant that of the build without eccentricities. Here it is solved by bisection, not by iteration.
    """
    rb1, rb2, a = 27 * math.cos(math.radians(20)), 48 * math.cos(math.radians(20)), 75.0
    sense = -1.0 if side == "drive" else 1.0
    alpha = math.radians(20)

    def apart(phi2: float, phi1: float) -> float:
        x = a + REFERENCE.e2 * math.cos(phi2 + REFERENCE.theta2) - REFERENCE.e1 * math.cos(phi1 + REFERENCE.theta1)
        y = -REFERENCE.e2 * math.sin(phi2 + REFERENCE.theta2) - REFERENCE.e1 * math.sin(phi1 + REFERENCE.theta1)
        beta, working = math.atan2(y, x), math.acos((rb1 + rb2) / math.hypot(x, y))
        lean = math.tan(working) - working - (math.tan(alpha) - alpha)
        ahead = 0.060 if side == "back" else 0.0
        return rb2 * (phi2 + beta) - rb1 * (phi1 - beta) - sense * (rb1 + rb2) * lean - ahead

    for phi1 in (0.0, 1.3, 40.0, 99.0):
        middle = phi1 * 27 / 48
        expected = brentq(apart, middle - 0.1, middle + 0.1, args=(phi1,), xtol=1e-14)
        assert float(driven_angle(REFERENCE, np.array([phi1]), side)[0]) == pytest.approx(expected, abs=1e-12)


def test_the_identity_of_both_sides_and_the_backlash() -> None:
    """TE_d + j = TE_b + j_0."""
    phi1 = long_period(500)
    drive, back = (transmission_error(REFERENCE, phi1, side) for side in ("drive", "back"))
    backlash = angular_backlash(REFERENCE, phi1)
    np.testing.assert_allclose((drive - drive[0]) + backlash, (back - back[0]) + backlash[0], atol=1e-15)


def test_the_working_angle_is_not_the_nominal_one() -> None:
    """At 1 mm over the standard distance e acts with sin(alpha_w) of cos(alpha_w) = r_b/a: 32 arcsec at e = 50 um."""
    wide = replace(PAIR, centre_distance=76.0)
    phi1 = long_period(4000)

    def span(pair_angle: float) -> float:
        return 2 * 2 * math.sin(pair_angle) / wide.driven_base_radius * 0.100

    own = Specimen(wide, 0.050, 0.0, 0.050, math.pi, 0.8)
    exact = float(np.ptp(angular_backlash(own, phi1)))
    assert exact == pytest.approx(span(wide.working_angle), rel=0.01)
    assert arcsec(span(wide.working_angle) - span(math.radians(20))) > 30.0
