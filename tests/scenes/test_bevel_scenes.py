"""Every bevel scene runs and meets the numbers in the file beside it; closed forms follow from the scenes by hand.

The coefficients of the imaginary spur pair, Jiang et al., section 3.1, for any cones: 2 sin(alpha) times cos(delta)
across an axis, sin(delta) along it; cos(alpha) for an arc of a tooth, 2 sin(alpha) for an arc of the shaft angle.
"""

import math
from collections.abc import Callable

import pytest
from expected import PRINTED, assert_met, expected, measures_of
from places import SCENES as FOLDER

from tol3d import Run, load_scene

SCENES = sorted(path.stem for path in FOLDER.glob("*bevel*.yaml"))
ALPHA = math.radians(20.0)
SIN, COS = math.sin(ALPHA), math.cos(ALPHA)
SQUARE = math.sqrt(0.5)  # sine and cosine of 45 deg
DELTA1 = math.atan(math.sin(math.radians(75)) / (26 / 17 + math.cos(math.radians(75))))
DELTA2 = math.radians(75) - DELTA1
SEEN = {"exact": 2e-5, "fcl": 0.005}
"""um; printed digits and where the exact engine's steps end; FCL's rounding and another machine's CAD kernel."""

Terms = dict[str, tuple[float, float, float]]  # contributor: coefficient, mean [um], sigma [um]


def published(measured: float = COS, apex: bool = True, bearings: int = 2, shims: float = 0.0) -> Terms:
    """The published pair: limits at +-3 sigma."""
    circular = 20 * math.sqrt(2) / 6 if apex else 14 / 3 / math.sqrt(2)  # a normal length has half its square each way
    terms: Terms = {f"{gear} tooth thickness": (-measured, -42.5, 3.5) for gear in ("driver", "driven")}
    terms |= {f"{gear} eccentricity": (2 * SIN * SQUARE, 0.0, circular) for gear in ("driver", "driven")}
    pivot = 0.0 if apex else SQUARE * SQUARE  # h cos(delta)/R_m, h = R_m cos(delta)
    terms["shaft angle"] = (2 * SIN * (1 - pivot), 0.0, 10 / 3)
    if apex:
        terms["axes offset"] = (2 * SIN * SQUARE, 0.0, 3.0)
    faces = ("driver back face", "driven back face", "housing face", "end cover")
    terms |= dict.fromkeys(faces, (2 * SIN * SQUARE, 0.0, 2.0))
    names = ("driver bearing clearance", "driven bearing clearance")[:bearings]
    terms |= dict.fromkeys(names, (SIN * SQUARE, 20.0, 10 / 3))
    if shims:
        terms |= {f"{gear} shim": (-2 * SIN * SQUARE, shims, 0.0) for gear in ("driver", "driven")}
    return terms


def every_bevel_field() -> Terms:
    """17 to 26 teeth at 75 deg."""
    mean_plane = 1 - math.cos(DELTA1) ** 2
    return {
        "pinion tooth thickness": (-1.0, -50.0, 10 / 3),
        "wheel tooth thickness": (-COS, -50.0, 10 / 3),
        "pinion mounting face": (2 * SIN * math.sin(DELTA1), 0.0, 2.0),
        "pinion shim": (-2 * SIN * math.sin(DELTA1), 20.0, 4 / math.sqrt(12)),
        "wheel shim": (2 * SIN * math.sin(DELTA2), 10.0, 0.0),
        "shaft angle": (2 * SIN * mean_plane, 0.0, 8 / 3),
        "axes offset": (2 * SIN * math.sin(DELTA2), 0.0, 3.0),
        "wheel bearing clearance": (SIN * math.cos(DELTA2), 10.0, 2.0),
    }


BY_HAND: dict[str, Callable[[], Terms]] = {
    "bevel_pair": published,
    "bevel_pair_3dcs": lambda: published(measured=1.0, apex=False, bearings=1),
    "bevel_pair_shimmed": lambda: published(shims=48.0),
    "every_bevel_field": every_bevel_field,
}


def test_every_bevel_scene_is_worked_out_by_hand() -> None:
    assert sorted(BY_HAND) == SCENES
    for scene in SCENES:
        assert list(BY_HAND[scene]()) == list(load_scene(FOLDER / f"{scene}.yaml").tolerances)


@pytest.mark.slow
@pytest.mark.parametrize("scene", SCENES)
def test_closed_forms_follow_by_hand(scene: str, run_of: Callable[[str], Run]) -> None:
    terms, found = BY_HAND[scene](), run_of(scene).summary["measures"]["normal backlash"]
    mean = sum(coefficient * mean for coefficient, mean, _ in terms.values())
    variances = {name: (coefficient * sigma) ** 2 for name, (coefficient, _, sigma) in terms.items()}
    total = sum(variances.values())
    assert found["nominal"]["analytic"] == pytest.approx(0.0, abs=1e-9)
    assert found["mean_build"]["analytic"] == pytest.approx(mean, abs=1e-5)
    form = found["analytic_closed_form"]
    assert (form["mean"], form["sigma"]) == pytest.approx((mean, math.sqrt(total)), abs=2e-6)
    shares = {row["name"]: row["analytic_percent"] for row in found["contributors"]}
    assert shares == pytest.approx({name: 100 * own / total for name, own in variances.items()}, abs=1e-4)


def test_the_published_pair_has_the_published_closed_form(run_of: Callable[[str], Run]) -> None:
    form = run_of("bevel_pair").summary["measures"]["normal backlash"]["analytic_closed_form"]
    assert (form["mean"], form["sigma"]) == pytest.approx((89.548, 6.662), abs=5e-4)
    motion = run_of("bevel_pair").summary["measures"]["lost motion"]["analytic_closed_form"]
    # the paper's 0.12195 j_n/d_m in degrees, d_m = 102.136 mm, with five digits of its factor
    assert motion["mean"] == pytest.approx(60 * 0.12195 * 89.548 / 102.136, rel=1e-4)


@pytest.mark.parametrize("scene", SCENES)
def test_a_bevel_scene_meets_its_expected_numbers(scene: str, run_of: Callable[[str], Run]) -> None:
    run = run_of(scene)
    assert run.summary["engine"] == ("fcl" if scene == "every_bevel_field" else "exact")
    assert run.summary["status"] == {
        "ok": expected(scene)["trials"],
        "interferes": 0,
        "no contact": 0,
        "out of range": 0,
    }
    assert measures_of(scene).keys() == run.summary["measures"].keys()
    for name, own in measures_of(scene).items():
        found = run.summary["measures"][name]
        seen = SEEN[run.summary["engine"]]
        assert_met(found, own, seen if found["unit"] == "um" else PRINTED + seen / 10)  # arcmin: a um is 0.07


@pytest.mark.parametrize(
    ("name", "percent"),
    [
        ("driver tooth thickness", 30.3),
        ("driven tooth thickness", 30.3),
        ("driver eccentricity", 14.8),
        ("driven eccentricity", 9.9),
        ("shaft angle", 4.1),
        ("driver bearing clearance", 1.8),
    ],
)
def test_high_low_mean_shares_of_what_3dcs_may_have_been_told(
    name: str, percent: float, run_of: Callable[[str], Run]
) -> None:
    """Worked out beforehand with an exact solver, to a point."""
    rows = run_of("bevel_pair_3dcs").summary["measures"]["normal backlash"]["contributors"]
    shares = {row["name"]: row["high_low_mean_percent"] for row in rows}
    assert shares[name] == pytest.approx(percent, abs=1.0)
    faces = sum(shares[face] for face in ("driver back face", "driven back face", "housing face", "end cover"))
    assert faces == pytest.approx(8.8, abs=1.0)
