"""The exact engine on helical gears in rings: worked cases of a search of two screw surfaces, limits, mirrors."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from helical_places import Places, assert_mirrored_reads_the_same, assert_read_as_spur, least_lag, random_places, read
from oracles.screw_flanks import ScrewGear

from tol3d.errors import GeometryError
from tol3d.gears import LEFT, LEFT_HAND, RIGHT, RIGHT_HAND, Flank, Hand, InternalGear, InternalPair, SpurGear

ALPHA = math.radians(20.0)
CLOSED_FORM = 1e-9  # mm
SEARCH = 1e-6  # mm; what the search of the worked cases and the engine's last steps leave


def planet_in_ring(beta: float = 15.0, **more: Any) -> InternalPair:
    """27 teeth in 79 of a module of 1 mm."""
    helix: dict[str, Any] = {"helix_angle": math.radians(beta), "hand": RIGHT_HAND, **more}
    inner = SpurGear(27, 1.0, ALPHA, 12.0, profile_shift=0.2, tooth_thickness_deviation=-0.06, **helix)
    ring = InternalGear(79, 1.0, ALPHA, 10.0, profile_shift=-0.2, tooth_thickness_deviation=-0.08, **helix)
    return InternalPair(inner, ring, 26.917180691)


LARGE = InternalPair(
    SpurGear(
        22, 4.0, ALPHA, 45.0, profile_shift=0.3, addendum=0.9, tooth_thickness_deviation=-0.17,
        helix_angle=math.radians(25.0),
    ),
    InternalGear(
        61, 4.0, ALPHA, 40.0, profile_shift=-0.3, addendum=0.9, tooth_thickness_deviation=-0.25,
        helix_angle=math.radians(25.0),
    ),
    86.063477679,
)  # fmt: skip
CASES: dict[str, tuple[InternalPair, float, Places, float, float, float]] = {
    "R03 shifted along the axis": (
        planet_in_ring(), 0.3, Places(shifts=((0, 0, 0), (0, 0, 0.5))), 5.048342343, 131.556967, CLOSED_FORM,
    ),
    "R06 tilted": (
        LARGE, 0.1, Places(tilts=((0, 0), (0.3e-3, 0))), 1.560487409, 390.209800, SEARCH,
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_worked_cases_of_a_search_of_two_screw_surfaces(case: str) -> None:
    pair, angle, places, turn, gap, bound = CASES[case]
    found = read(pair, angle, RIGHT, places)
    assert found.status[0] == 0
    arm, nominal = pair.wheel.section_arm, float(pair.driven_angle(np.array(angle)))
    assert arm * (found.driven_angle[0] - nominal) == pytest.approx(arm * turn * 1e-3, abs=bound)
    assert found.gap[0] == pytest.approx(gap * 1e-3, abs=bound)


def random_pair(rng: np.random.Generator) -> tuple[InternalPair, tuple[ScrewGear, ScrewGear]]:
    """A pair that runs, of ours and of the oracle's gears, some hundredths of a module within its tight distance."""
    while True:
        module, beta = float(rng.uniform(1.0, 4.0)), math.radians(rng.uniform(8.0, 35.0))
        hand: Hand = RIGHT_HAND if rng.random() < 0.5 else LEFT_HAND
        z1 = int(rng.integers(17, 50))
        z2 = z1 + int(rng.integers(12, 70))
        x1, x2 = float(rng.uniform(-0.1, 0.4)), float(rng.uniform(-0.4, 0.1))
        faces, thin = (module * rng.uniform(6.0, 16.0, 2)).tolist(), (module * rng.uniform(0.02, 0.05, 2)).tolist()
        heights = rng.uniform(0.7, 0.9, 2).tolist()
        try:
            inner = SpurGear(z1, module, ALPHA, faces[0], x1, heights[0], helix_angle=beta, hand=hand)
            ring = InternalGear(z2, module, ALPHA, faces[1], x2, heights[1], helix_angle=beta, hand=hand)
            tight = InternalPair(inner, ring, 10 * ring.tip_radius).zero_backlash_centre_distance
            pair = InternalPair(
                replace(inner, tooth_thickness_deviation=-thin[0]),
                replace(ring, tooth_thickness_deviation=-thin[1]),
                tight - 0.01 * module,
            )
            pair.refuse_interference()
        except GeometryError:
            continue
        screws = [
            ScrewGear(z, module, ALPHA, beta, hand, face, x, off, height, inside)
            for z, face, x, off, height, inside in zip(
                (z1, z2), faces, (x1, x2), thin, heights, (False, True), strict=True
            )
        ]
        if rng.random() < 0.5:
            return pair, (screws[0], screws[1])
        return InternalPair(pair.wheel, pair.pinion, pair.centre_distance), (screws[1], screws[0])


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(16))
def test_seats_and_free_turns_are_those_of_a_search_of_the_surfaces(seed: int) -> None:
    """At rest a pair of the working flanks is 0 apart, and after the free turn a pair of the others is; either drives.

    A gear turned off its working flanks by the free turn touches the others: of its two senses that is the one.
    """
    rng = np.random.default_rng(3000 + seed)
    pair, screws = random_pair(rng)
    places, angle = random_places(rng), float(rng.uniform(-3.0, 3.0))
    flank: Flank = RIGHT if seed % 2 else LEFT
    other: Flank = LEFT if flank == RIGHT else RIGHT
    found = read(pair, angle, flank, places)
    assert found.status[0] == 0
    rest, free = float(found.driven_angle[0]), float(found.driven_turn[0])
    assert least_lag(pair, screws, places, (angle, rest), flank) == pytest.approx(0.0, abs=SEARCH)
    turned = rest + pair.mating_flank(flank) * free
    assert least_lag(pair, screws, places, (angle, turned), other) == pytest.approx(0.0, abs=SEARCH)
    driver = angle + flank * float(found.driver_turn[0])
    back = angle - flank * float(found.driver_turn[0])
    apart = [abs(least_lag(pair, screws, places, (own, rest), other)) for own in (driver, back)]
    assert min(apart) == pytest.approx(0.0, abs=SEARCH)


def test_a_helix_that_vanishes_reads_what_the_spur_kernel_reads() -> None:
    """Displaced and eccentric; the helix of 1e-9 rad is 1e-8 um over the face."""
    spur = planet_in_ring(0.0)
    spur = replace(spur, centre_distance=spur.zero_backlash_centre_distance - 0.03)
    rng = np.random.default_rng(3)
    for ring_drives in (False, True):
        first, second = (spur.wheel, spur.pinion) if ring_drives else (spur.pinion, spur.wheel)
        plain = InternalPair(first, second, spur.centre_distance)
        leaning = replace(plain, pinion=replace(first, helix_angle=1e-9), wheel=replace(second, helix_angle=1e-9))
        assert_read_as_spur(leaning, plain, rng)


@pytest.mark.parametrize("seed", range(8))
def test_a_mirrored_pair_reads_the_same(seed: int) -> None:
    """Both hands and the flanks exchanged, and every place mirrored in the plane of the axes."""
    rng = np.random.default_rng(50 + seed)
    assert_mirrored_reads_the_same(random_pair(rng)[0], rng)
