"""Radial assembly of internal pairs against the overlap of outlines on the way to their place."""

import math

import numpy as np
import pytest
from gears.internal_pairs import outline, random_pair
from oracles.ring_overlap import overlap

from tol3d.gears import InternalGear, InternalPair, SpurGear

FREE = 2e-3  # mm at a module of 1 mm: what the check counts as free, and chords
PHASES = np.arange(5) / 8  # pitches: from a tooth to a space on the line of centres


def least_overlap(pair: InternalPair, steps: int) -> float:
    """On the way from the ring's middle to the centre distance, at the best phase [mm]."""
    start = pair.ring.tip_radius - pair.inner.tip_radius
    if start <= 0.0:
        return math.inf
    ring, inner = outline(pair.ring), outline(pair.inner)
    way = np.linspace(min(start, pair.centre_distance), pair.centre_distance, steps)

    def most(phase: float) -> float:
        turns = np.array([[(phase + 0.5) * pair.ring.angular_pitch, phase * pair.inner.angular_pitch]])
        return max(overlap(ring, inner, float(distance), turns, corners_only=False) for distance in way)

    return min(most(float(phase)) for phase in PHASES)


@pytest.mark.slow
def test_many_teeth_of_difference_go_in_radially_and_few_do_not() -> None:
    for ring_teeth, addendum, goes in ((52, 1.0, True), (34, 0.8, False)):
        inner = SpurGear(27, 1.0, math.radians(25), 5.0, addendum=addendum, tooth_thickness_deviation=-0.02)
        ring = InternalGear(ring_teeth, 1.0, math.radians(25), 5.0, addendum=addendum)
        pair = InternalPair(inner, ring, (ring_teeth - 27) / 2)
        pair.refuse_interference()
        assert pair.radially_assembled == goes
        assert (least_overlap(pair, 8) < FREE) == goes


@pytest.mark.slow
def test_outlines_meet_on_the_way_exactly_where_radial_assembly_is_denied() -> None:
    rng, found = np.random.default_rng(1), list[bool]()
    while len(found) < 10:
        pair = random_pair(rng)
        if pair is not None and not pair.interferes and pair.ring.teeth - pair.inner.teeth < 12:
            found.append(pair.radially_assembled)
            assert (least_overlap(pair, 16) < FREE) == found[-1]
    assert 2 <= sum(found) <= 8
