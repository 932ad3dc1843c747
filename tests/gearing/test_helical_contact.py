"""The exact engine on helical gears: worked cases of a search of two screw surfaces, limits, mirrors, the stack-up."""

import math
from dataclasses import replace

import numpy as np
import pytest
from helical_places import Places, assert_mirrored_reads_the_same, assert_read_as_spur, least_lag, random_places, read
from oracles.screw_flanks import ScrewGear

from tol3d.errors import GeometryError
from tol3d.gearing.stack_up.contact_lines import ContactLines
from tol3d.gears import LEFT, LEFT_HAND, RIGHT, RIGHT_HAND, Flank, Hand, SpurGear, SpurPair

ALPHA = math.radians(20.0)
CLOSED_FORM = 1e-9  # mm
SEARCH = 1e-6  # mm; what the search of the worked cases and the engine's last steps leave
UM = 1e-3  # mm
URAD = 1e-6


def base_pair(centre_distance: float = 53.0, shift: float = 0.5441135839) -> SpurPair:
    """The pair of most worked cases."""
    pinion = SpurGear(23, 1.0, ALPHA, 16.0, profile_shift=0.55, helix_angle=math.radians(30.0))
    wheel = SpurGear(67, 1.0, ALPHA, 11.0, profile_shift=shift, helix_angle=math.radians(30.0), hand=LEFT_HAND)
    thin = [replace(gear, tooth_thickness_deviation=-off) for gear, off in ((pinion, 0.06), (wheel, 0.08))]
    return SpurPair(thin[0], thin[1], centre_distance)


SECOND = SpurPair(
    SpurGear(24, 2.0, ALPHA, 20.0, helix_angle=math.radians(15.0), tooth_thickness_deviation=-0.06),
    SpurGear(47, 2.0, ALPHA, 20.0, helix_angle=math.radians(15.0), hand=LEFT_HAND, tooth_thickness_deviation=-0.08),
    73.504608809,
)
ALL_OFF = Places(
    shifts=(
        (-0.062531 * UM, -5.049702 * UM, -390.56478 * UM),
        (-6.151957 * UM, 3.840642 * UM, -239.514621 * UM),
    ),
    tilts=((-13.517590 * URAD, 166.867109 * URAD), (103.381004 * URAD, 11.294117 * URAD)),
    centres=((0.0142507921, 0.2636520478), (0.0040704084, 3.0893329216)),
)
CASES: dict[str, tuple[SpurPair, float, Flank, Places, float, float, float | None, float]] = {
    "N04 nominal": (base_pair(), 1.1, RIGHT, Places(), -2.089552239, 131.556967, 4.179104478, CLOSED_FORM),
    "X01 shifted along the axis": (
        SECOND, 0.2, RIGHT, Places(shifts=((0, 0, 0), (0, 0, 0.5))), -4.242755799, 131.556967, None, CLOSED_FORM,
    ),
    "X01 unshifted": (SECOND, 0.2, RIGHT, Places(), -1.489361702, 131.556967, None, CLOSED_FORM),
    "E03 eccentric": (
        base_pair(53.05, 0.5994492437), 2.7, RIGHT, Places(centres=((0.02, 1.0), (0.03, 2.0))),
        -2.550215670, 134.459809, 4.271293999, CLOSED_FORM,
    ),
    "T09 tilted": (
        base_pair(), 1.17, RIGHT, Places(tilts=((0, 0), (0, 0.4e-3))), -2.035847491, 127.953793, None, SEARCH,
    ),
    "C02 all of it": (
        base_pair(53.01), -1.7081478106, LEFT, ALL_OFF, 0.467738545, 134.204635, 4.264126566, SEARCH,
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_worked_cases_of_a_search_of_two_screw_surfaces(case: str) -> None:
    pair, angle, flank, places, turn, gap, free, bound = CASES[case]
    found = read(pair, angle, flank, places)
    arm = pair.wheel.section_arm
    assert found.status[0] == 0
    nominal = float(pair.driven_angle(np.array(angle)))
    assert arm * (found.driven_angle[0] - nominal) == pytest.approx(arm * turn * 1e-3, abs=bound)
    assert found.gap[0] == pytest.approx(gap * UM, abs=bound)
    if free is not None:
        assert arm * found.driven_turn[0] == pytest.approx(arm * free * 1e-3, abs=bound)


def test_a_tilted_axis_touches_at_the_end_of_the_face_on_the_tooth_of_the_worked_case() -> None:
    pair, angle, flank, places, *_ = CASES["T09 tilted"]
    found = read(pair, angle, flank, places)
    assert found.contact[0, 2] == pytest.approx(5.5, abs=1e-3)  # of the wheel's face, 0.4 mrad off that of the pinion
    assert found.tooth[0] == -5


def random_pair(rng: np.random.Generator) -> tuple[SpurPair, tuple[ScrewGear, ScrewGear]]:
    """A pair that runs, of ours and of the oracle's gears, some hundredths of a module beyond its tight distance."""
    while True:
        module, beta = float(rng.uniform(1.0, 4.0)), math.radians(rng.uniform(8.0, 35.0))
        hand: Hand = RIGHT_HAND if rng.random() < 0.5 else LEFT_HAND
        teeth, shifts = rng.integers(17, 70, 2).tolist(), rng.uniform(-0.1, 0.4, 2).tolist()
        faces, thin = (module * rng.uniform(6.0, 16.0, 2)).tolist(), (module * rng.uniform(0.02, 0.05, 2)).tolist()
        hands: tuple[Hand, Hand] = (hand, LEFT_HAND if hand == RIGHT_HAND else RIGHT_HAND)
        each = list(zip(teeth, shifts, faces, thin, hands, strict=True))
        try:
            gears = [
                SpurGear(
                    z, module, ALPHA, face, profile_shift=x, tooth_thickness_deviation=-off, helix_angle=beta, hand=own
                )
                for z, x, face, off, own in each
            ]
            plain = [replace(gear, tooth_thickness_deviation=0.0) for gear in gears]
            tight = SpurPair(plain[0], plain[1], 10 * (gears[0].tip_radius + gears[1].tip_radius))
            pair = SpurPair(gears[0], gears[1], tight.zero_backlash_centre_distance + 0.01 * module)
            pair.refuse_interference()
        except GeometryError:
            continue
        screws = [ScrewGear(z, module, ALPHA, beta, own, face, x, off) for z, x, face, off, own in each]
        return pair, (screws[0], screws[1])


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_seats_and_free_turns_are_those_of_a_search_of_the_surfaces(seed: int) -> None:
    """At rest a pair of the working flanks is 0 apart, and after the free turn a pair of the others is."""
    rng = np.random.default_rng(1000 + seed)
    pair, screws = random_pair(rng)
    places, angle = random_places(rng), float(rng.uniform(-3.0, 3.0))
    flank: Flank = RIGHT if seed % 2 else LEFT
    found = read(pair, angle, flank, places)
    assert found.status[0] == 0
    rest = float(found.driven_angle[0])
    assert least_lag(pair, screws, places, (angle, rest), flank) == pytest.approx(0.0, abs=SEARCH)
    turned = rest + flank * float(found.driven_turn[0]) * (-1.0)
    other = least_lag(pair, screws, places, (angle, turned), RIGHT if flank == LEFT else LEFT)
    back = least_lag(pair, screws, places, (angle, 2 * rest - turned), RIGHT if flank == LEFT else LEFT)
    assert min(abs(other), abs(back)) == pytest.approx(0.0, abs=SEARCH)


def test_a_helix_that_vanishes_reads_what_the_spur_kernel_reads() -> None:
    """Displaced and eccentric; the helix of 1e-9 rad is 1e-8 um over the face."""
    spur = SpurPair(
        SpurGear(23, 2.0, ALPHA, 16.0, tooth_thickness_deviation=-0.06),
        SpurGear(47, 2.0, ALPHA, 14.0, tooth_thickness_deviation=-0.08),
        70.03,
    )
    leaning = SpurPair(
        replace(spur.pinion, helix_angle=1e-9), replace(spur.wheel, helix_angle=1e-9, hand=LEFT_HAND), 70.03
    )
    assert_read_as_spur(leaning, spur, np.random.default_rng(3))


@pytest.mark.parametrize("seed", range(6))
def test_a_mirrored_pair_reads_the_same(seed: int) -> None:
    """Both hands and the flanks exchanged, and every place mirrored in the plane of the axes."""
    rng = np.random.default_rng(50 + seed)
    assert_mirrored_reads_the_same(random_pair(rng)[0], rng)


def test_the_mean_loss_of_a_tilt_is_its_closed_form() -> None:
    """Where contact lines cover the whole face: half a face cos beta_b, and a tip edge, less half a pitch's share."""
    pair = base_pair()
    lines, pinion = ContactLines(pair), pair.pinion
    angles = np.arange(4000) * pinion.angular_pitch / 4000
    half, cosine, sine = pair.common_face / 2, pinion.base_helix_cosine, math.sin(pinion.base_helix_angle)
    u1, u2 = lines.path
    for side in (RIGHT, LEFT):
        lowest, highest = (own.mean() * half * cosine for own in lines.ends(side, angles))
        for sense, found in ((1.0, -lowest), (-1.0, highest)):
            edge = u2 if side * pinion.hand * sense > 0.0 else u1
            mean = half * cosine + abs(edge) * sine - pinion.base_pitch * sine * cosine / 2
            assert found == pytest.approx(mean, abs=2e-3 * half)
