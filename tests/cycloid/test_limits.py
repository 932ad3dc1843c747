"""Impossible discs are refused with the number that would do: that number does, and a little more does not."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from oracles.rolling_disc import Outline, distance

from tol3d.gearing.cycloid.model.limits import (
    faults,
    flank_gaps,
    largest_pin_radius,
    largest_window,
    least_gap,
    lobes_fault,
)
from tol3d.gearing.cycloid.model.profile import DiscProfile, Modification

RV_250 = DiscProfile(pins=40, pin_circle_radius=114.5, pin_radius=5.0, eccentricity=2.2)
USUAL = Modification(-0.02, -0.02 * math.sqrt(1 - (88 / 114.5) ** 2))


def only_fault(profile: DiscProfile, field: str) -> str:
    found = list(faults(profile))
    assert [fault.field for fault in found] == [field]
    return found[0].words


def number_in(words: str, before: str) -> float:
    found = re.search(rf"(-?\d+(?:\.\d+)?) {before}", words)
    assert found is not None
    return float(found[1])


def test_the_published_disc_with_its_usual_modification_has_no_fault() -> None:
    assert not list(faults(RV_250))
    assert not list(faults(replace(RV_250, modification=USUAL)))


def test_pins_that_touch_or_undercut_are_refused_with_the_largest_that_do_neither() -> None:
    """Neighbours are 2 rp sin(pi / 40) apart; the smallest convex radius is 9.0547 mm."""
    words = only_fault(replace(RV_250, pin_radius=9.06), "pin_radius")
    assert "neighbouring pins touch from 8.9836 mm" in words
    assert "the lobes are undercut from 9.0547 mm, got 9.06 mm" in words
    assert number_in(words, "mm") == pytest.approx(114.5 * math.sin(math.pi / 40), abs=1e-4)
    assert "undercut" not in only_fault(replace(RV_250, pin_radius=9.0), "pin_radius")
    assert not list(faults(replace(RV_250, pin_radius=number_in(words, "mm"))))


def test_few_large_pins_are_refused_by_undercut_alone() -> None:
    """K = 0.9: the smallest convex radius lies far below half a pitch."""
    profile = DiscProfile(pins=40, pin_circle_radius=114.5, pin_radius=7.0, eccentricity=0.9 * 114.5 / 40)
    words = only_fault(profile, "pin_radius")
    limit = 114.5 * math.sqrt(27 * 39 * (1 - 0.81) / 41**3)
    assert number_in(words, "mm") == pytest.approx(limit, abs=1e-4)
    assert "neighbouring" not in words
    assert largest_pin_radius(profile) == pytest.approx(limit)


def test_lobes_are_one_fewer_than_pins() -> None:
    assert lobes_fault(39, 40) is None
    fault = lobes_fault(40, 40)
    assert fault is not None
    assert fault.words == "expected 39 lobes, one fewer than the 40 pins, got 40; or take 41 pins"


def test_an_eccentricity_that_makes_cusps_is_refused_with_the_limit() -> None:
    words = only_fault(replace(RV_250, eccentricity=2.9), "eccentricity")
    assert number_in(words, "mm") == pytest.approx(114.5 / 40, abs=1e-4)


@pytest.mark.parametrize(
    ("profile", "field"),
    [
        (replace(RV_250, pin_radius=0.0), "pin_radius"),
        (replace(RV_250, eccentricity=-1.0), "eccentricity"),
        (replace(RV_250, pin_circle_radius=0.0), "pin_circle_radius"),
    ],
    ids=["pin radius", "eccentricity", "pin circle"],
)
def test_what_has_no_size_is_refused(profile: DiscProfile, field: str) -> None:
    assert "expected more than 0 mm" in only_fault(profile, field)


def test_too_few_pins_are_refused() -> None:
    assert only_fault(replace(RV_250, pins=3), "pins") == "expected 4 pins or more, got 3"


def test_a_disc_of_nothing_is_refused() -> None:
    """Pins that would fit beside each other, but reach the axis of so small a disc."""
    thin = DiscProfile(pins=4, pin_circle_radius=10.0, pin_radius=6.9, eccentricity=0.1)
    assert not list(faults(thin))
    assert number_in(only_fault(replace(thin, eccentricity=2.4, pin_radius=7.0), "pin_radius"), "mm") < 7.0


def test_an_offset_that_undercuts_is_refused_with_the_largest_that_does_not() -> None:
    words = only_fault(replace(RV_250, modification=Modification(offset=4.1)), "offset")
    limit = number_in(words, "um")
    assert limit == pytest.approx(4054.695, abs=0.002)
    assert not list(faults(replace(RV_250, modification=Modification(offset=limit / 1e3))))
    assert list(faults(replace(RV_250, modification=Modification(offset=limit / 1e3 + 1e-5))))


@pytest.mark.parametrize("turned", [math.radians(1667), -math.radians(1667), 1.0001 * math.pi / 39])
def test_a_flank_that_is_turned_past_its_lobe_is_refused(turned: float) -> None:
    """Half a pitch of 39 lobes is 180 / 39 = 4.61538 deg."""
    words = only_fault(replace(RV_250, modification=Modification(rotation=turned)), "rotation")
    assert "expected less than 4.6153 deg either way" in words
    assert f"got {math.degrees(turned):g} deg" in words


def test_a_shift_to_cusps_is_refused_with_the_limit() -> None:
    assert "-26.5000 mm" in only_fault(replace(RV_250, modification=Modification(shift=-27.0)), "shift")


@pytest.mark.parametrize(
    ("shift", "rotation", "offset"),
    [(0.0, 0.0, 0.0), (-0.02, 0.0, -0.012796), (0.02, 0.0, 0.02), (-0.02, 1e-4, -0.02), (0.0, -1e-4, 0.00858)],
)
def test_interference_is_refused_with_the_least_offset(shift: float, rotation: float, offset: float) -> None:
    """To first order the largest of shift cos(alpha) - rotation lever, over a flank."""
    t = np.linspace(0.0, math.pi, 20001)
    k = 88 / 114.5
    w = np.sqrt(1 + k**2 - 2 * k * np.cos(t))
    first_order = float((shift * (1 - k * np.cos(t)) / w - rotation * 85.8 * np.sin(t) / w).max())
    assert first_order == pytest.approx(offset, abs=1e-5)
    own = replace(RV_250, modification=Modification(shift, first_order - 0.005, rotation))
    words = only_fault(own, "offset")
    assert "interfere by" in words
    enough = number_in(words, "um with") / 1e3
    # of second order: rotated by 0.1 mrad, a flank's end lies 11 um off the middle of a root
    assert enough == pytest.approx(first_order, abs=2e-5 if rotation else 3e-6)
    assert not list(faults(replace(own, modification=Modification(shift, enough, rotation))))
    assert list(faults(replace(own, modification=Modification(shift, enough - 2e-5, rotation))))


def test_larger_pins_on_a_smaller_circle_take_up_the_gap() -> None:
    """A circle of 10 um less comes in by cos(alpha), 1 at the roots; pins grow along the normal."""
    own = replace(RV_250, modification=Modification(offset=0.03))
    assert least_gap(own) == pytest.approx(0.03, abs=1e-12)
    assert least_gap(own, pin_growth=0.01) == pytest.approx(0.02, abs=1e-12)
    assert least_gap(own, circle_growth=-0.01) == pytest.approx(0.02, abs=1e-9)


@pytest.mark.parametrize("modification", [USUAL, Modification(-0.3, 0.1, 2e-3), Modification(0.2, 0.5)], ids=str)
def test_gaps_are_those_found_by_search(modification: Modification) -> None:
    own = replace(RV_250, modification=modification)
    u = np.linspace(0.005, 0.075, 6)
    outline = Outline(lambda at: own.ground.points(np.clip(at, *own.flank_ends)), modification.rotation)
    pins = own.pin_centres(u)
    searched = [distance(outline, complex(x, y), at, 0.03) - 5.0 for (x, y), at in zip(pins, u, strict=True)]
    assert flank_gaps(own, u) == pytest.approx(searched, abs=1e-10)


@pytest.mark.parametrize(("pins", "circle", "eccentricity"), [(40, 114.5, 2.2), (12, 50.0, 3.0), (60, 100.0, 0.4)])
def test_the_largest_window_is_the_least_over_positions_of_the_longest_lever(
    pins: int, circle: float, eccentricity: float
) -> None:
    """Longest lever of one flank, by the moment of the normal through each pin; 2000 positions a pitch leave 1e-3."""
    profile = DiscProfile(pins, circle, 1.0, eccentricity)
    phases = np.arange(2000)[:, None] / 2000 * 2 * math.pi / pins + 2 * math.pi * np.arange(pins) / pins
    u = phases / (pins - 1)
    slope = 1j * circle * np.exp(1j * u) - 1j * pins * eccentricity * np.exp(1j * pins * u)
    centre = circle * np.exp(1j * u) - eccentricity * np.exp(1j * pins * u)
    levers = (np.conj(centre) * slope).real / abs(slope) / (eccentricity * (pins - 1))
    assert largest_window(profile) == pytest.approx(levers.max(axis=1).min(), abs=1e-3)
