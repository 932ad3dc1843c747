"""Interference of internal pairs: each condition against the overlap of both outlines over a whole pitch of turning."""

import math
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from gears.internal_pairs import outline, random_pair
from oracles.ring_overlap import overlap

from tol3d.errors import GeometryError
from tol3d.gears import LEFT, RIGHT, Displaced, Flank, InternalGear, InternalPair, SpurGear
from tol3d.gears.internal_mesh import InternalMesh

CLEAR = 1e-6  # mm; flanks in contact, interpolated between 1500 points: h^2/(8 rho) = (2 mm/1500)^2 / 16 = 1e-7
SEEN = 1e-5  # mm; an overlap that a sampled position does not miss


def most_overlap(pair: InternalPair, flank: Flank) -> float:
    """Over a pitch, with that flank in touch: tip corners at 600 positions, whole outlines at 15."""
    turn = np.linspace(0.0, pair.inner.angular_pitch, 600)
    origin = np.tile(np.stack([np.zeros(3), pair.wheel_origin]), (len(turn), 1, 1))
    displaced = Displaced(origin, np.zeros((len(turn), 2, 3)), np.zeros((len(turn), 2)))
    turns = np.stack([pair.touching_angle(turn, flank, displaced), turn], axis=1)
    gears = outline(pair.ring), outline(pair.inner), pair.centre_distance
    return max(overlap(*gears, turns, corners_only=True), overlap(*gears, turns[::40], corners_only=False))


def compare(seed: int, count: int) -> dict[str, int]:
    """Pairs refused and not, by the first two words of why."""
    rng, found = np.random.default_rng(seed), dict[str, int]()
    while sum(found.values()) < count:
        pair = random_pair(rng)
        if pair is None:
            continue
        why = pair.interference
        assert pair.interferes == bool(why)
        deepest = most_overlap(pair, RIGHT if rng.random() < 0.5 else LEFT)
        assert deepest > SEEN if why else deepest < CLEAR, (pair, why, deepest)
        kind = " ".join(why.split()[:2])
        found[kind] = found.get(kind, 0) + 1
    return found


def spur(teeth: int, alpha: float, **factors: Any) -> SpurGear:
    return SpurGear(teeth, 1.0, math.radians(alpha), 5.0, **factors)


def internal(teeth: int, alpha: float, **factors: Any) -> InternalGear:
    return InternalGear(teeth, 1.0, math.radians(alpha), 5.0, **factors)


CASES = (
    (spur(17, 20), internal(40, 20), 11.5, "involute interference: the internal gear's tip"),
    (spur(30, 20), internal(36, 20), 3.0, "trimming interference"),
    (
        spur(25, 22, addendum=1.15),
        internal(60, 22, dedendum=1.2, root_fillet=0.38),
        17.5,
        "involute interference: the inner gear's tip",
    ),
    (
        spur(25, 22, addendum=1.19),
        internal(60, 22, dedendum=1.2, root_fillet=0.2),
        17.5,
        "tip interference: the inner gear's tip corner overlaps the root fillet of the internal gear",
    ),
)


@pytest.mark.parametrize(("inner", "ring", "distance", "why"), CASES)
def test_teeth_overlap_where_they_are_refused_and_not_with_the_addenda_that_are_advised(
    inner: SpurGear, ring: InternalGear, distance: float, why: str
) -> None:
    pair = InternalPair(inner, ring, distance)
    assert pair.interference.startswith(why)
    assert most_overlap(pair, RIGHT) > SEEN
    with pytest.raises(GeometryError, match=why):
        pair.refuse_interference()
    most = float(re.findall(r"of at most ([\d.]+)", pair.interference)[0])
    for addendum, overlaps in ((most, False), (most + 0.02, True)):
        other = InternalPair(
            replace(inner, addendum=min(addendum, inner.addendum)),
            replace(ring, addendum=min(addendum, ring.addendum)),
            distance,
        )
        assert bool(other.interference) == other.interferes == overlaps
        assert (most_overlap(other, LEFT) > CLEAR) == overlaps


def test_trimming_is_judged_by_the_published_sum_at_the_crossing_of_the_tip_circles() -> None:
    """z1 (inv alpha_a1 + delta_1) + (z2 - z1) inv alpha_w - z2 (inv alpha_a2 + delta_2), of the ring's turn."""

    def inv(angle: float) -> float:
        return math.tan(angle) - angle

    for teeth, distance in ((34, 2.0), (36, 3.0), (40, 5.0), (79, 24.5)):
        inner, ring = spur(30, 20, addendum=0.8), internal(teeth, 20, addendum=0.8)
        tip, ring_tip = 15.8, teeth / 2 - 0.8
        first = math.acos((ring_tip**2 - tip**2 - distance**2) / (2 * distance * tip))
        second = math.acos((ring_tip**2 - tip**2 + distance**2) / (2 * distance * ring_tip))
        own = inv(math.acos(15 * math.cos(math.radians(20)) / tip)) + first
        mate = inv(math.acos(teeth / 2 * math.cos(math.radians(20)) / ring_tip)) + second
        total = 30 * own + (teeth - 30) * inv(math.radians(20)) - teeth * mate
        found = InternalMesh(ring, inner, distance).trimming_gap
        assert found == pytest.approx(total / teeth * ring_tip, abs=1e-12)


def test_undercut_that_reaches_the_flank_in_use_is_refused() -> None:
    inner, ring = spur(12, 20), internal(40, 20, addendum=0.6)
    pair = InternalPair(inner, ring, 14.0)
    assert not pair.interferes
    with pytest.raises(GeometryError, match=r"cuts the inner gear's .* at least 0.2981 \(it has 0\)"):
        pair.refuse_interference()


@pytest.mark.slow
def test_outlines_of_many_pairs_overlap_exactly_where_they_are_refused() -> None:
    found = compare(10, 60)
    kinds = ("", "involute interference:", "trimming interference:", "tip interference", "tip interference:")
    assert set(found) == set(kinds)
