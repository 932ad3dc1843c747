"""A gear in a ring, alone and in a train: numbers beside the scenes, worked out by hand, and every trial by vectors."""

import math
from collections.abc import Callable, Mapping

import numpy as np
import pytest
from expected import PRINTED, assert_all_met, assert_closed_forms_are_there, expected
from numpy.typing import NDArray
from oracles.ring_pairs import RingPair
from scipy.integrate import quad
from scipy.stats import halfnorm, uniform
from vectors import vector

from tol3d import Run

Array = NDArray[np.float64]
Columns = Mapping[str, Array]

SCENES = ("internal_pair", "ring_train")
SEEN = 1e-5  # um; where the exact engine's steps end
TILT_NODES = 5e-4  # um; midpoint rule of tol3d for |tilt|
TILT = 0.004  # um; a tilt of 4 um at a pressure angle that an eccentricity of 20 um changes by 20 um/(33 mm tan)
ALPHA = math.radians(20.0)
ARCMIN = 10800 / math.pi / 1000  # one um at a radius of one mm

# internal_pair: 22 in 66 teeth of module 1.5, x = 0.3 and -0.25, at 32.9 mm
BASES = 33 * math.cos(ALPHA)  # of the ring less the pinion's [mm]
COS = BASES / 32.9
SIN = math.sqrt(1 - COS**2)
PER_KELVIN = -2 * SIN * 32.9e3 * (23e-6 - 11.5e-6)  # housing closes, ring less pinion opens by 32.9 mm of steel [um]


@pytest.mark.parametrize("scene", SCENES)
def test_the_scene_meets_its_expected_numbers(scene: str, run_of: Callable[[str], Run]) -> None:
    assert_all_met(run_of(scene), scene, PRINTED + SEEN)
    assert_closed_forms_are_there(run_of(scene), scene)


# the pair by hand -----------------------------------------------------------------------------------------------------


def involute(cosine: float) -> float:
    angle = math.acos(cosine)
    return math.tan(angle) - angle


NOMINAL = 1e3 * (2 * BASES * (involute(math.cos(ALPHA)) - involute(COS)) - 2 * 1.5 * 0.05 * math.sin(ALPHA))
SHIFT = (35 + 45) * math.cos(ALPHA) + 10 * SIN + 12 * SIN**2 + 15 * PER_KELVIN
VARIANCE = {
    "pinion tooth thickness": (math.cos(ALPHA) * 20 / 6) ** 2,
    "ring tooth thickness": (math.cos(ALPHA) * 30 / 6) ** 2,
    "pinion eccentricity": (2 * SIN * 3) ** 2,
    "ring run-out": (2 * SIN * 8) ** 2 / 2,  # at a random position
    "centre distance": (2 * SIN * 5) ** 2,
    "pinion bearing clearance": SIN**2 * 12**2 / 12,
    "ring bearing clearance": SIN**4 * 12**2 / 12,  # along the tooth force: SIN of it along the line of centres
    "temperature": PER_KELVIN**2 * 30**2 / 12,
}


def tilt_loss(power: int) -> float:
    """Mean of a power of max(|uniform over +-4 sin|, |normal of 1.5 cos|) [um]: the integral of n x^(n-1) (1 - F)."""

    def integrand(x: float) -> float:
        inside = uniform.cdf(x, 0.0, 4 * SIN) * halfnorm.cdf(x, 0.0, 1.5 * COS)
        return float(power * x ** (power - 1) * (1 - inside))

    return float(quad(integrand, 0.0, 4 * SIN)[0] + quad(integrand, 4 * SIN, np.inf)[0])


def test_the_expected_closed_form_of_the_pair_follows_by_hand() -> None:
    own = expected("internal_pair")["normal backlash"]
    assert own["nominal"]["analytic"] == pytest.approx(NOMINAL, abs=PRINTED)
    assert own["mean_build"]["analytic"] == pytest.approx(NOMINAL + SHIFT, abs=PRINTED)
    assert own["closed_form"]["mean"] == pytest.approx(NOMINAL + SHIFT - tilt_loss(1), abs=TILT_NODES)
    variance = sum(VARIANCE.values()) + tilt_loss(2) - tilt_loss(1) ** 2
    assert own["closed_form"]["sigma"] == pytest.approx(math.sqrt(variance), abs=TILT_NODES)
    for name, part in VARIANCE.items():
        assert own["shares"][name] == pytest.approx(100 * part / variance, abs=0.01)


def exact_pair(columns: Columns, angle: Array) -> Array:
    """Normal backlash of every trial of internal_pair at driver angles [um]; the loss by tilts in first order."""
    warm = columns["temperature [K]"]
    grown = 1 + 11.5e-6 * warm
    thickness = [
        grown * (1.5 * (math.pi / 2 + 2 * shift * math.tan(ALPHA)) + 1e-3 * columns[f"{name} tooth thickness [um]"])
        for name, shift in (("pinion", 0.3), ("ring", -0.25))
    ]
    none = np.zeros_like(warm)
    apart = 32.9 * (1 + 23e-6 * warm) + 1e-3 * columns["centre distance [um]"]
    # the pinion's left flank pushes the ring on and outwards: at the mesh, in +x of the pinion, along (sin, cos)
    pushed = 1e-3 * columns["ring bearing clearance [um]"] / 2
    pair = RingPair(
        (22, 66),
        1.5 * grown,
        ALPHA,
        (thickness[0], thickness[1]),
        (
            np.stack([-1e-3 * columns["pinion bearing clearance [um]"] / 2, none], axis=1),
            np.stack([-apart + SIN * pushed, COS * pushed], axis=1),
        ),
        (1e-3 * vector(columns, "pinion eccentricity"), 1e-3 * vector(columns, "ring run-out")),
    )
    straight = backlash(pair, angle, -1, math.pi / 66 + angle / 3)
    cosine = BASES * grown / apart
    lost = np.maximum(
        np.abs(columns["axis in plane [um]"]) * np.sqrt(1 - cosine**2),
        np.abs(columns["axis out of plane [um]"]) * cosine,
    )
    return straight - lost


def backlash(pair: RingPair, driver: Array, side: int, start: Array) -> Array:
    """Gap [um] on the other side where that one of the inner gear touches, the ring driven."""
    ring = pair.seated(side, driver, start, ring_drives=False)
    return 1e3 * pair.gap(-side, driver, ring)


def test_every_trial_of_the_pair_is_the_exact_pair_of_its_own_deviations(run_of: Callable[[str], Run]) -> None:
    columns = run_of("internal_pair").columns()
    wanted = exact_pair(columns, np.radians(columns["position:gear pair [deg]"]))
    assert np.abs(columns["geometric:normal backlash"] - wanted).max() <= TILT + SEEN
    # a turn from flank to flank moves an eccentric centre by e/r_b of it, 11 um/15.5 mm; a warm arm is 0.035 % longer
    stop = exact_pair(columns, np.full(len(wanted), math.radians(30))) * ARCMIN / (16.5 * math.cos(ALPHA))
    assert np.abs(columns["geometric:play of the pinion at the stop"] - stop).max() <= 1.1e-3 * stop.max()


# the train ------------------------------------------------------------------------------------------------------------

RING_BASES = 31.25 * math.cos(ALPHA)  # 20 in 70 of module 1.25
RING_SIN = math.sqrt(1 - (RING_BASES / 30.97) ** 2)
SPUR_SIN = math.sqrt(1 - (36 * math.cos(ALPHA) / 36.3) ** 2)


def test_the_expected_lost_motion_of_the_train_follows_by_hand() -> None:
    own, ring = expected("ring_train")["lost motion"], 43.75 * math.cos(ALPHA)
    wheel = 27 * math.cos(ALPHA)
    spur = 2 * 36 * math.cos(ALPHA) * (involute(36 * math.cos(ALPHA) / 36.3) - involute(math.cos(ALPHA)))
    spur -= 2 * 0.3 * math.sin(ALPHA)
    inner = 2 * RING_BASES * (involute(math.cos(ALPHA)) - involute(RING_BASES / 30.97)) - 2.5 * 0.2 * math.sin(ALPHA)
    assert own["nominal"]["analytic"] == pytest.approx(1e3 * ARCMIN * (spur / wheel / 3.5 + inner / ring), abs=PRINTED)
    mean = (66 / wheel / 3.5 + 80 / ring) * math.cos(ALPHA) * ARCMIN
    assert own["closed_form"]["mean"] - own["nominal"]["analytic"] == pytest.approx(mean, abs=2 * PRINTED)
    at_spur, at_ring = ARCMIN / wheel / 3.5, ARCMIN / ring
    cos = math.cos(ALPHA)
    variance = {
        "pinion tooth thickness": (at_spur * cos * 16 / 6) ** 2,
        "wheel tooth thickness": (at_spur * cos * 20 / 6) ** 2,
        "inner gear tooth thickness": (at_ring * cos * 16 / 6) ** 2,
        "ring tooth thickness": (at_ring * cos * 24 / 6) ** 2,
        "wheel eccentricity": (at_spur * 2 * SPUR_SIN * 4) ** 2,
        "ring eccentricity": (at_ring * 2 * RING_SIN * 6) ** 2,
        "first centre distance": (at_spur * 2 * SPUR_SIN * 4) ** 2,
        "second centre distance": (at_ring * 2 * RING_SIN * 5) ** 2,
    }
    # one run-out in both meshes: the wheel sees its mate at 180 deg, the inner gear at 90 deg, each opens opposite
    both = (at_spur * SPUR_SIN) ** 2 + (at_ring * RING_SIN) ** 2
    variance["countershaft run-out"] = 4 * 2**2 * both
    total = sum(variance.values())
    assert own["closed_form"]["sigma"] == pytest.approx(math.sqrt(total), abs=PRINTED)
    for name, part in variance.items():
        assert own["shares"][name] == pytest.approx(100 * part / total, abs=0.01), name


def test_every_trial_of_the_ring_stage_is_the_exact_pair_of_its_own_deviations(run_of: Callable[[str], Run]) -> None:
    columns = run_of("ring_train").columns()
    angle = np.radians(columns["position:ring stage [deg]"])
    none = np.zeros_like(angle)
    nominal = 1.25 * math.pi / 2
    pair = RingPair(
        (20, 70),
        1.25,
        ALPHA,
        (
            nominal + 2.5 * 0.2 * math.tan(ALPHA) + 1e-3 * columns["inner gear tooth thickness [um]"],
            nominal + 1e-3 * columns["ring tooth thickness [um]"],
        ),
        (np.stack([none, none], axis=1), np.stack([-30.97 - 1e-3 * columns["second centre distance [um]"], none], 1)),
        (1e-3 * vector(columns, "countershaft run-out"), 1e-3 * vector(columns, "ring eccentricity")),
    )
    wanted = backlash(pair, angle, -1, math.pi / 70 + angle / 3.5)
    assert np.abs(columns["geometric:ring backlash"] - wanted).max() <= SEEN
