"""Every shipped scene runs and meets the numbers in the file beside it, and those follow from the scene by hand.

`<scene>.expected.toml` holds what a run of few trials gives, in um and arcmin. Here the scenes' numbers stand once
more, as plain ones: from them come the nominal and mean builds and the closed forms (first order:
2 sin(alpha_w) for a shift of the axes, cos(alpha) for a thickness), and the exact pair of each trial.
"""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pytest
from expected import PRINTED, assert_met, expected, measures_of
from gear_trials import drawn_trials
from oracles import exact_eccentric
from oracles.involute_gear import InvoluteGear
from oracles.train import involute
from places import SCENES as FOLDER
from scipy.integrate import quad
from scipy.stats import halfnorm, kstest, norm, uniform
from shipped import shipped
from vectors import vector

from tol3d import Run, load_scene
from tol3d.gearing.model import model_from_scene
from tol3d.gears.flank import Flank

ELSEWHERE = re.compile(
    "bevel|robot|train|two_sided|tooth_deviations|measured_teeth|internal_pair"
)  # in files of their own, and test_compensation.py
SCENES = [name for name in shipped("gearing") if not ELSEWHERE.search(name)]
ALPHA = math.radians(20.0)
ARCMIN = 10800 / math.pi / 1000  # one um at a radius of one mm

Columns = Mapping[str, np.ndarray]

SEEN = 1e-5  # um; where the exact engine's steps end
TILT_NODES = 5e-4  # um; midpoint rule of tol3d for |tilt|, 3e-4 of a mean loss of 1.5 um


# the scenes by hand -------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Stack:
    """A scene's normal backlash worked out by hand [um].

    Args:
        nominal: without deviations.
        shift: change by the means of everything that does not turn, tilts left out.
        tilt: mean and variance of what tilts take off.
        turning: amplitude [um] and phase [rad] at driver angle 0 of what turns with the driven gear at a fixed
            direction; it turns by `slower` of the driver's angle, the other way.
        variance: by contributor, tilts left out, what turns at a random position.
        cos: of the working pressure angle.
        base_radius: of pinion and wheel [mm].
    """

    nominal: float
    shift: float
    tilt: tuple[float, float]
    turning: tuple[float, float, float]
    variance: Mapping[str, float]
    cos: float
    base_radius: tuple[float, float]

    @property
    def mean_build(self) -> float:
        """The mean build at a random position, where what turns has mean 0."""
        return self.nominal + self.shift

    def at(self, angle: float) -> float:
        """The mean build at a driver angle [rad]."""
        amplitude, phase, slower = self.turning
        return self.mean_build + amplitude * math.cos(phase - slower * angle)


def spur_pair() -> Stack:
    """Jiang et al. 2024, section 2.1 with Tables 1 and 2; limits lie 6 sigma apart, S/6 and F/6 are scales."""
    sin, cos = math.sin(ALPHA), math.cos(ALPHA)
    return Stack(
        nominal=0.0,
        shift=(19 + 30) / 2 * cos + (21 + 32) / 2 * cos + (2 + 30) / 2 * sin,
        tilt=(0.0, 0.0),
        turning=(0.0, 0.0, 28 / 110),
        variance={
            "pinion tooth thickness": (cos * 11 / 6) ** 2,
            "wheel tooth thickness": (cos * 11 / 6) ** 2,
            "centre distance": (2 * sin * 40 / 6) ** 2,
            "wheel eccentricity": (2 * sin * 31 / 6) ** 2,
            "bearing clearance": (sin * 28 / 6) ** 2,
            "pinion eccentricity": (2 * sin * 27 / 6) ** 2,
            "reducer run-out": (2 * sin * 8 / 6) ** 2,
        },
        cos=cos,
        base_radius=(35 * cos, 137.5 * cos),
    )


def every_field() -> Stack:
    """24 and 36 teeth of module 2 with x = 0.2 and 0.1 at 60.62 mm, in a housing of aluminium."""
    base = 60 * math.cos(ALPHA)
    working = math.acos(base / 60.62)
    sin, cos = math.sin(working), math.cos(working)
    thickness_mean, thickness_variance = measured_thickness()
    by_kelvin = 2 * sin * 60.62e3 * (23e-6 - 11.5e-6)  # housing less gears, whose working radii add up to 60.62 mm
    # normal cut at +-2 sigma: 1 - 4 phi(2)/(Phi(2) - Phi(-2)) of its variance is left
    cut = 1 - 4 * norm.pdf(2) / (norm.cdf(2) - norm.cdf(-2))
    return Stack(
        nominal=1e3 * (2 * base * (involute(working) - involute(ALPHA)) - 2 * 2 * 0.3 * math.sin(ALPHA)),
        # clearances: half of the uniform's 10 um straight apart, half of the triangle's 19/3 um along the tooth force
        shift=(28 - thickness_mean) * math.cos(ALPHA) + sin * 10 + sin**2 * 19 / 3 + by_kelvin * 15,
        tilt=tilt_loss(5 * sin, 0.1 * 16 * cos),
        # 40 deg in the wheel, which stands at 180 + 5 deg for driver angle 0
        turning=(2 * sin * 6, math.radians(40 + 180 + 5), 24 / 36),
        variance={
            "pinion tooth thickness": (math.cos(ALPHA) * 2) ** 2,  # 16 um between limits at +-4 sigma
            "wheel tooth thickness": math.cos(ALPHA) ** 2 * thickness_variance,
            "pinion eccentricity": (2 * sin * 3) ** 2,
            "wheel eccentricity": (2 * sin * 6) ** 2 / 2,
            "shaft run-out": (2 * sin * 1.5) ** 2,
            "centre distance": (2 * sin * 6) ** 2 * cut,
            "wheel bearing clearance": sin**2 * 12**2 / 12,
            # triangle a, b, c: (a^2 + b^2 + c^2 - ab - bc - ca)/18
            "pinion bearing clearance": sin**4 * (4 + 25 + 144 - 10 - 60 - 24) / 18,
            "wheel axial shift": 0.0,
            "temperature": by_kelvin**2 * 30**2 / 12,
        },
        cos=cos,
        base_radius=(24 * math.cos(ALPHA), 36 * math.cos(ALPHA)),
    )


@cache
def thickness_sample() -> np.ndarray:
    """The last column of the CSV file [um]."""
    return np.loadtxt(FOLDER / "wheel_thickness.csv", delimiter=",", skiprows=1, usecols=1)


def measured_thickness() -> tuple[float, float]:
    """Mean and variance of the file, the latter with n - 1."""
    sample = thickness_sample()
    return float(sample.mean()), float(sample.var(ddof=1))


def tilt_loss(in_plane: float, out_of_plane: float) -> tuple[float, float]:
    """Mean (a loss, so negative) and variance of max(|uniform over +-in_plane|, |normal of sigma out_of_plane|) [um].

    E of the n-th power of a positive quantity is the integral of n x^(n-1) (1 - F(x)).
    """

    def moment(power: int) -> float:
        def integrand(x: float) -> float:
            inside = uniform.cdf(x, 0.0, in_plane) * halfnorm.cdf(x, 0.0, out_of_plane)
            return float(power * x ** (power - 1) * (1 - inside))

        return float(quad(integrand, 0.0, in_plane)[0] + quad(integrand, in_plane, np.inf)[0])

    return -moment(1), moment(2) - moment(1) ** 2


BY_HAND: dict[str, Callable[[], Stack]] = {"spur_pair": spur_pair, "every_field": every_field}


@dataclass(frozen=True)
class Moments:
    """Nominal value, mean build, and by the closed form mean and variances, in the measure's unit."""

    nominal: float
    mean_build: float
    mean: float
    variance: Mapping[str, float]
    tilt_variance: float

    @property
    def sigma(self) -> float:
        return math.sqrt(sum(self.variance.values()) + self.tilt_variance)


def random_position(stack: Stack, per_um: float) -> Moments:
    """A measure of one random position; only the tilts' one-sided loss tells its mean from the mean build."""
    return Moments(
        stack.nominal * per_um,
        stack.mean_build * per_um,
        (stack.mean_build + stack.tilt[0]) * per_um,
        {name: own * per_um**2 for name, own in stack.variance.items()},
        stack.tilt[1] * per_um**2,
    )


def play_at_the_stop(stack: Stack) -> Moments:
    """The pinion's play at 30 deg: there the wheel's constant eccentricity shifts the mean and varies nothing."""
    per_um = ARCMIN / stack.base_radius[0]
    mean_build = stack.at(math.radians(30)) * per_um
    variance = {name: own * per_um**2 for name, own in (dict(stack.variance) | {"wheel eccentricity": 0.0}).items()}
    mean = mean_build + stack.tilt[0] * per_um
    return Moments(stack.nominal * per_um, mean_build, mean, variance, stack.tilt[1] * per_um**2)


MOMENTS: dict[tuple[str, str], Callable[[Stack], Moments]] = {
    ("spur_pair", "normal backlash"): lambda stack: random_position(stack, 1.0),
    ("spur_pair", "lost motion"): lambda stack: random_position(stack, ARCMIN / stack.base_radius[1]),
    ("every_field", "normal backlash"): lambda stack: random_position(stack, 1.0),
    ("every_field", "pinion play at the stop"): play_at_the_stop,
}
"""Measures of one position, which have a closed form."""


def parabola_error(step: float) -> float:
    """Largest error of the parabola of samples `step` [rad] of phase apart at a sine's peak, of its amplitude.

    Halfway between two samples, d = step/2: 1 - cos d - sin^2(d) (1 + cos step)/(4 cos d).
    """
    half = step / 2
    return 1 - math.cos(half) - math.sin(half) ** 2 * (1 + math.cos(step)) / (4 * math.cos(half))


def extremes_of_the_mean_build(stack: Stack) -> dict[str, tuple[float, float]]:
    """Extremes of every_field.yaml's mean build, and how far its positions may miss them.

    The wheel's constant eccentricity alone swings. Over the long period it passes both extremes; over one turn of the
    driver the wheel goes from 225 deg back to -15 deg, through 180 and 0 deg, which are both extremes too.
    """
    amplitude, _, slower = stack.turning
    highest, lowest = stack.mean_build + amplitude, stack.mean_build - amplitude
    six, eight = (amplitude * parabola_error(slower * 2 * math.pi / count) for count in (6, 8))
    arcmin = ARCMIN / stack.base_radius[1]
    return {
        "smallest normal backlash": (lowest, six),
        "circumferential backlash swing": ((highest - lowest) / stack.cos, 2 * eight / stack.cos),
        "lost motion": (highest * arcmin, eight * arcmin),
    }


# the files ------------------------------------------------------------------------------------------------------


def test_every_scene_has_its_expected_numbers_beside_it() -> None:
    files = sorted(path.name.removesuffix(".expected.toml") for path in FOLDER.glob("*.expected.toml"))
    assert files == sorted(path.stem for path in FOLDER.glob("*.yaml"))
    assert sorted(BY_HAND) == sorted(EXACT) == SCENES
    for scene in SCENES:
        assert list(measures_of(scene)) == list(load_scene(FOLDER / f"{scene}.yaml").measures)
    forms = {(scene, name) for scene in SCENES for name, own in measures_of(scene).items() if "closed_form" in own}
    assert forms == set(MOMENTS)


@pytest.mark.parametrize(("scene", "measure"), MOMENTS)
def test_the_expected_closed_forms_follow_by_hand(scene: str, measure: str) -> None:
    stack, own = BY_HAND[scene](), measures_of(scene)[measure]
    by_hand = MOMENTS[scene, measure](stack)
    assert own["nominal"]["analytic"] == pytest.approx(by_hand.nominal, abs=PRINTED)
    assert own["mean_build"]["analytic"] == pytest.approx(by_hand.mean_build, abs=PRINTED)
    tilted = TILT_NODES if by_hand.tilt_variance else PRINTED
    assert own["closed_form"]["mean"] == pytest.approx(by_hand.mean, abs=tilted)
    assert own["closed_form"]["sigma"] == pytest.approx(by_hand.sigma, abs=tilted)
    total = by_hand.sigma**2
    tilts = {name: percent for name, percent in own["shares"].items() if name not in by_hand.variance}
    assert sum(tilts.values()) == pytest.approx(100 * by_hand.tilt_variance / total, abs=0.01)
    for name, variance in by_hand.variance.items():
        assert own["shares"][name] == pytest.approx(100 * variance / total, abs=0.01)


def test_the_expected_extremes_and_curve_of_the_mean_build_follow_by_hand() -> None:
    stack, own = every_field(), measures_of("every_field")
    for name, (value, missed) in extremes_of_the_mean_build(stack).items():
        assert own[name]["mean_build"]["analytic"] == pytest.approx(value, abs=missed + PRINTED)
    curve = [stack.at(k * math.pi / 4) for k in range(9)]
    assert own["normal backlash curve"]["mean_build"]["analytic"] == pytest.approx(curve, abs=PRINTED)


# the runs -------------------------------------------------------------------------------------------------------


def in_unit(measure: Mapping[str, Any], scene: str, um: float) -> float:
    """A normal backlash [um] in a measure's unit; an angle is that of its gear."""
    if measure["unit"] == "um":
        return um
    return um * ARCMIN / BY_HAND[scene]().base_radius[0 if measure["gear"] == "pinion" else 1]


@pytest.mark.parametrize("scene", SCENES)
def test_a_scene_meets_its_expected_numbers(scene: str, run_of: Callable[[str], Run]) -> None:
    run = run_of(scene)
    assert run.summary["engine"] == "exact"
    assert run.summary["chord_error_um"] == 0.0
    assert run.summary["status"] == {
        "ok": expected(scene)["trials"],
        "interferes": 0,
        "no contact": 0,
        "out of range": 0,
    }
    for name, own in measures_of(scene).items():
        found = run.summary["measures"][name]
        assert_met(found, own, PRINTED + in_unit(found, scene, SEEN))
        assert ("analytic_closed_form" in found) == ("closed_form" in own)


@pytest.mark.parametrize(("scene", "measure"), MOMENTS)
def test_a_sample_lies_within_four_standard_errors_of_the_closed_form(
    scene: str, measure: str, run_of: Callable[[str], Run]
) -> None:
    found, form = run_of(scene).summary["measures"][measure], MOMENTS[scene, measure](BY_HAND[scene]())
    for method in ("analytic", "geometric"):
        count = found[method]["count"]
        assert count == expected(scene)["trials"]
        assert abs(found[method]["mean"] - form.mean) <= 4 * form.sigma / math.sqrt(count)
        # for a normal; flat parts such as temperature's only make it smaller
        assert abs(found[method]["sigma"] - form.sigma) <= 4 * form.sigma / math.sqrt(2 * count)


def test_shares_by_regression_are_within_four_standard_errors_of_the_closed_form(run_of: Callable[[str], Run]) -> None:
    measure = run_of("spur_pair").summary["measures"]["normal backlash"]
    shares = measures_of("spur_pair")["normal backlash"]["shares"]
    for row in measure["contributors"]:
        share = shares[row["name"]] / 100
        # of independent normals that act linearly: sqrt(S (1 - S)/n)
        error = math.sqrt(share * (1 - share) / expected("spur_pair")["trials"])
        assert abs(row["geometric_percent"] / 100 - share) <= 4 * error, row["name"]


# trial by trial --------------------------------------------------------------------------------------------------


def exact_spur_pair(columns: Columns, angle: np.ndarray) -> np.ndarray:
    """Normal backlash [um] of each trial by the exact eccentric pair, (n,) at driver angles (n,) [rad]."""
    return exact(
        (InvoluteGear(28, 2.5, ALPHA, 20.0), InvoluteGear(110, 2.5, ALPHA, 20.0)),
        columns["pinion tooth thickness [um]"] + columns["wheel tooth thickness [um]"],
        np.stack([172.5e3 + columns["centre distance [um]"] + columns["bearing clearance [um]"] / 2, 0 * angle], 1),
        (vector(columns, "pinion eccentricity", "reducer run-out"), vector(columns, "wheel eccentricity")),
        (angle, 1),
    )


def exact_every_field(columns: Columns, angle: np.ndarray) -> np.ndarray:
    """The same for every_field.yaml, whose gears and housing grow; the tilts' loss is taken off in first order."""
    warm = columns["temperature [K]"]
    grown = 1 + 11.5e-6 * warm  # the whole tooth, with what it deviates
    gears = (
        InvoluteGear(24, 2.0, ALPHA, 18.0, profile_shift=0.2).grown(grown),
        InvoluteGear(36, 2.0, ALPHA, 16.0, profile_shift=0.1).grown(grown),
    )
    cos = 60 * math.cos(ALPHA) / 60.62
    sin = math.sqrt(1 - cos**2)
    apart = 60.62e3 * (1 + 23e-6 * warm) + columns["centre distance [um]"] + columns["wheel bearing clearance [um]"] / 2
    # the pinion's left flank pushes the wheel up and away, and itself down and away: the wheel lies that much further
    pushed = columns["pinion bearing clearance [um]"] / 2
    straight = exact(
        gears,
        (columns["pinion tooth thickness [um]"] + columns["wheel tooth thickness [um]"]) * grown,
        np.stack([apart + sin * pushed, cos * pushed], axis=1),
        (vector(columns, "pinion eccentricity", "shaft run-out"), vector(columns, "wheel eccentricity")),
        (angle, -1),
    )
    in_plane, out_of_plane = columns["axis in plane [um]"], 16 * columns["axis out of plane [mrad]"]
    own = 60e3 * math.cos(ALPHA) * grown / apart  # cosine of this trial, but for its eccentricities
    return straight - np.maximum(np.abs(in_plane) * np.sqrt(1 - own**2), np.abs(out_of_plane) * own)


def exact(
    gears: tuple[InvoluteGear, InvoluteGear],
    thickness: np.ndarray,
    axis: np.ndarray,
    centres: tuple[np.ndarray, np.ndarray],
    driver: tuple[np.ndarray, Flank],
) -> np.ndarray:
    """`exact_eccentric.normal_backlash` with every deviation in um; driver: its angles and working flank."""
    in_mm = (centres[0] * 1e-3, centres[1] * 1e-3)
    angle, flank = driver
    return 1e3 * exact_eccentric.normal_backlash(gears[0], gears[1], thickness * 1e-3, axis * 1e-3, in_mm, angle, flank)


EXACT = {"spur_pair": exact_spur_pair, "every_field": exact_every_field}
# um; a tilt of 5 um in the plane of the axes, in first order, at the pressure angle of an eccentricity of 20 um too
# little: that is off by 20 um/(60.62 mm tan alpha_w)
TILTS = {"spur_pair": 0.0, "every_field": 0.004}
# of the backlash; a turn from flank to flank moves an eccentric centre by e/r_b of it, 15 um/22 mm
ECCENTRIC_TURN = 7e-4


@pytest.mark.parametrize(
    ("scene", "measure", "positions"),
    [
        ("spur_pair", "normal backlash", None),
        ("spur_pair", "lost motion", None),
        ("every_field", "normal backlash", None),
        ("every_field", "normal backlash curve", [45 * k for k in range(9)]),
        ("every_field", "pinion play at the stop", [30]),
    ],
)
def test_every_trial_is_the_exact_pair_of_its_own_deviations(
    scene: str, measure: str, positions: list[float] | None, run_of: Callable[[str], Run]
) -> None:
    run, columns = run_of(scene), run_of(scene).columns()
    found = columns[f"geometric:{measure}"] / in_unit(run.summary["measures"][measure], scene, 1.0)
    turned = columns["position:gear pair [deg]"][:, None] if positions is None else np.array(positions)
    angles = np.radians(np.broadcast_to(turned, (len(found), turned.shape[-1])))
    wanted = np.stack([EXACT[scene](columns, angle) for angle in angles.T], axis=1)
    error = found.reshape(wanted.shape) - wanted
    turn = 0.0 if run.summary["measures"][measure]["unit"] == "um" else ECCENTRIC_TURN * wanted.max()
    assert np.abs(error).max() <= turn + TILTS[scene] + SEEN


# measured values -------------------------------------------------------------------------------------------------


def test_draws_of_a_measured_thickness_follow_its_smoothed_file() -> None:
    """Uniform laws about its values, of which each reaches sqrt(3/n) s to both sides."""
    count = 20_000
    model = model_from_scene(load_scene(FOLDER / "every_field.yaml"))
    (column,) = drawn_trials(model, 7, 0, count).deviations[:, model.component_slices["wheel tooth thickness"]].T
    drawn, measured = 1e3 * column, thickness_sample()
    mean, variance = measured_thickness()
    width = math.sqrt(3 * variance / len(measured))
    assert measured.max() < 0.0  # of one sign, and far from 0
    assert measured.max() + width < 0.0
    assert abs(drawn.mean() - mean) <= 4 * math.sqrt(variance / count)
    # n draws differ from their law by less than 1.95/sqrt(n) but for one seed in a thousand (Kolmogorov)
    law = uniform(measured[:, None] - width, 2 * width)
    assert kstest(drawn, lambda x: law.cdf(x).mean(axis=0)).statistic < 1.95 / math.sqrt(count)
