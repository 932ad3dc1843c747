"""The search for sets against every set there is, tooth by tooth; what wishes that cannot be met are told."""

import math
from collections.abc import Sequence
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from oracles.placed_planets import placed

from tol3d.apps.design.families import COMPOUND, SIMPLE, WOLFROM, Teeth
from tol3d.apps.design.search import Found, Wish, find, teeth_text
from tol3d.apps.design.shifted_set import Limits
from tol3d.errors import GeometryError
from tol3d.gearing.planetary import ToothSet, compound, simple, wolfrom

ALPHA = math.radians(20)
EVERY = 1000
LOOSE = Limits(shift=3.0)


def teeth_of(found: Found) -> set[str]:
    return {teeth_text(own.own.teeth) for own in found.candidates}


def tips_apart(planets: int, centre_distance: float, steps: Sequence[int], shifts: Sequence[float]) -> float:
    """Least distance of tip circles of different planets, laid out as circles [modules]."""
    places = [centre_distance * np.exp(2j * math.pi * k / planets) for k in range(planets)]
    tips = [count / 2 + 1 + x for count, x in zip(steps, shifts, strict=True)]
    return min(
        abs(p - q) - one - other for k, p in enumerate(places) for q in places[:k] for one in tips for other in tips
    )


def widest_apart(teeth: ToothSet, planets: int, most: float) -> float:
    """The largest such distance of a grid of centre distances and shifts that are allowed [modules]."""
    sums = [mesh.tooth_sum / 2 for mesh in teeth.meshes]
    cos, sin = math.cos(ALPHA), math.sin(ALPHA)
    found = -math.inf
    for a in np.linspace(
        max(sums) * cos / math.cos(math.radians(12)), min(sums) * cos / math.cos(math.radians(32)), 61
    ):
        working = math.acos(min(1.0, sums[0] * cos / a))
        more = math.tan(working) - working - (math.tan(ALPHA) - ALPHA)
        with_sun = sums[0] * more / math.tan(ALPHA)
        allowed = [
            [
                x
                for x in np.linspace(-most, most, 121)
                if x >= 1 - count * sin**2 / 2 and (step > 0 or abs(with_sun - x) <= most)
            ]
            for step, count in enumerate(teeth.steps)
        ]
        if all(allowed):
            found = max(found, tips_apart(planets, a, teeth.steps, [min(own) for own in allowed]))
    return found


def every_3k(ratio: float, tolerance: float, planets: int, teeth: Teeth) -> set[str]:
    """All sets with their teeth placed one by one, no condition of divisibility."""
    found = set()
    counts, d = range(teeth.least, teeth.largest + 1), teeth.sum_difference
    for sun, p1, p2 in product(counts, repeat=3):
        if sun + 2 * p1 - d > teeth.largest or sun + p1 + p2 - d > teeth.largest:
            continue
        for r1, r2 in product(
            range(sun + 2 * p1 - d, sun + 2 * p1 + d + 1), range(sun + p1 + p2 - d, sun + p1 + p2 + d + 1)
        ):
            sums = (sun + p1, r1 - p1, r2 - p2)
            if max(r1, r2) > teeth.largest or max(sums) - min(sums) > d or r1 * p2 == r2 * p1:
                continue
            own = (1 + Fraction(r1, sun)) / (1 - Fraction(r1 * p2, r2 * p1))
            if abs(own - Fraction(ratio)) > Fraction(tolerance) * Fraction(1 + 10**-9):
                continue
            teeth_set = wolfrom(sun, p1, r1, p2, r2)
            if placed(teeth_set, planets):
                found.add(teeth_text(teeth_set))
    return found


@pytest.mark.parametrize(("ratio", "planets"), [(60.0, 3), (-45.0, 4)])
def test_it_finds_every_set_there_is(ratio: float, planets: int) -> None:
    """Those without room and those whose teeth cannot run together are counted: found and left out are all."""
    teeth = Teeth(12, 66, 1)
    expected = every_3k(ratio, 1.0, planets, teeth)
    found = find(Wish(WOLFROM, ratio, 1.0, planets, teeth, limits=LOOSE), EVERY)
    assert teeth_of(found) <= expected
    assert len(expected) == found_whole(found)
    assert len(found.candidates) > 5


def test_the_ratio_of_the_paper_leaves_exactly_one_set() -> None:
    """Tooth sums within 2, four identical planets, adjacency: 25/27/79/24/76, all sums 52."""
    found = find(Wish(WOLFROM, 54.72, planets=4), EVERY)
    assert teeth_of(found) == {"25/27/79/24/76"}
    assert found.left == 0
    (own,) = found.candidates
    assert own.own.centre_distance == 26.0
    assert set(own.own.shifts.values()) == {0.0}
    assert (round(own.forward, 5), round(own.backward, 5)) == (0.85163, 0.82856)
    assert own.own.planet_gap(4) == pytest.approx(26 * math.sqrt(2) - 29, abs=1e-12)


def test_the_smallest_sets_come_first_and_the_rest_is_counted() -> None:
    wish = Wish(SIMPLE, 4.5, planets=3)
    every, few = find(wish, EVERY), find(wish, 4)
    assert [own.own.teeth for own in few.candidates] == [own.own.teeth for own in every.candidates[:4]]
    assert few.left + found_whole(few) == found_whole(every)
    rings = [own.own.teeth.mesh("ring").teeth for own in every.candidates]
    assert rings == sorted(rings)


def found_whole(found: Found) -> int:
    """Sets with the ratio that assemble, whether they have room and their teeth can run together or not."""
    return len(found.candidates) + sum(own.count for own in found.fallen if own.condition != "assembly")


def test_simple_and_compound_sets_are_all_there() -> None:
    simple_ones = {
        teeth_text(own)
        for sun, planet, ring in product(range(12, 61), repeat=3)
        if abs(sun + planet - (ring - planet)) <= 2 and ring > planet and abs(1 + ring / sun - 4.0) <= 0.01 + 1e-12
        for own in [simple(sun, planet, ring)]
        if placed(own, 3)
    }
    found = find(Wish(SIMPLE, 4.0, 0.01, 3, Teeth(12, 60, 2), limits=LOOSE), EVERY)
    assert teeth_of(found) <= simple_ones
    assert len(simple_ones) == found_whole(found)
    compound_ones = {
        teeth_text(own)
        for sun, p1, p2 in product(range(12, 60), repeat=3)
        for ring in range(sun + p1 + p2 - 1, min(sun + p1 + p2 + 1, 60) + 1)
        if abs(1 + ring * p1 / (sun * p2) - 9.0) <= 0.05 + 1e-12
        for own in [compound(sun, p1, p2, ring)]
        if placed(own, 3)
    }
    found = find(Wish(COMPOUND, 9.0, 0.05, 3, Teeth(12, 60, 1), limits=LOOSE), EVERY)
    assert teeth_of(found) <= compound_ones
    assert len(compound_ones) == found_whole(found)
    assert len(found.candidates) > 1


@pytest.mark.parametrize(
    ("wish", "expected"),
    [
        (
            Wish(WOLFROM, 54.72, planets=8),
            "no 3K set is left of 44 with that ratio:\n  assembly: 44 fail; 16/27/70/24/69: 8 identical planets at "
            "equal angles do not assemble between sun and ring 1: 86 is not divisible by 8",
        ),
        (Wish(SIMPLE, 12.0, planets=4), "adjacency: 6 fail; 12/59/132: gap between the tips of neighbouring planets: "),
        (
            Wish(WOLFROM, 54.72, tolerance=0.0, planets=4, limits=Limits(tip_clearance=0.26), centre_distance=26.0),
            "limits of the teeth: 1 fail; 25/27/79/24/76: no profile shifts were found that keep the limits; the "
            "nearest fail by clearance",
        ),
        (
            Wish(WOLFROM, 54.72, planets=4, centre_distance=40.0),
            "25/27/79/24/76: 40 mm does not suit tooth sums of 52, 52, 52: working pressure angles of 12 to 32 deg "
            "need at least 24.9778 mm and at most 28.8097 mm",
        ),
        (
            Wish(WOLFROM, 54.72, teeth=Teeth(12, 40, 2)),
            "ratio: no 3K set with sun and planets of at least 12 teeth, rings of at most 40 and tooth sums within 2 "
            "has a ratio within 0.005 of 54.72; the nearest, 12/13/39/12/39, has 55.25",
        ),
        (Wish(SIMPLE, 4.0, teeth=Teeth(40, 60, 2)), "ratio: there is no simple planetary set with sun and planets of"),
    ],
)
def test_wishes_that_cannot_be_met_say_which_condition_fails(wish: Wish, expected: str) -> None:
    with pytest.raises(GeometryError) as refused:
        find(wish)
    assert expected in str(refused.value)


NARROW = (
    (Wish(SIMPLE, 6.0, 0.0, 4, Teeth(20, 100, 2)), "20/40/100"),
    (Wish(COMPOUND, 9.0, 0.0, 4, Teeth(12, 60, 1)), "12/24/12/48"),
    (Wish(WOLFROM, -20.0, 0.05, 4, Teeth(12, 66, 1)), "18/18/54/24/60"),
)


@pytest.mark.parametrize(("wish", "known"), NARROW)
def test_planets_without_room_unshifted_are_taken_with_the_shifts_they_are_built_with(wish: Wish, known: str) -> None:
    """Tip circles of neighbours laid out with the shifts that are found: half a millimetre apart at least."""
    made_room = []
    for own in find(wish, EVERY).candidates:
        steps, distance = own.own.teeth.steps, own.own.centre_distance
        assert tips_apart(wish.planets, distance, steps, own.own.planet_shifts) >= 0.5 - 1e-6
        middle = sum(mesh.tooth_sum for mesh in own.own.teeth.meshes) / len(own.own.teeth.meshes) / 2
        if tips_apart(wish.planets, middle, steps, [0.0] * len(steps)) < 0.5:
            made_room.append(teeth_text(own.own.teeth))
    assert known in made_room


def test_no_set_is_refused_for_want_of_room_that_some_shifts_give() -> None:
    """The widest gap is that of a grid, as near as its steps of 1/60 module and of a sixtieth of the distances are."""
    sets = (simple(12, 59, 132), simple(20, 40, 100), compound(13, 30, 16, 60), wolfrom(26, 37, 99, 33, 96))
    for teeth, planets in product(sets, (3, 4, 5)):
        wish = Wish(SIMPLE, 6.0, planets=planets)
        widest, tried = wish.task(teeth).widest_gap.value, widest_apart(teeth, planets, wish.limits.shift)
        assert tried - 1e-9 <= widest <= tried + 0.2
