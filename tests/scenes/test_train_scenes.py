"""The scenes of trains run and meet the numbers in the files beside them, which follow from the scenes by hand.

The table's shaft leans between its two bearings, never so far that another end of a face is the tighter one.
"""

import math
from collections.abc import Callable

import numpy as np
import pytest
from expected import PRINTED, assert_met, expected, measures_of
from of_kind import known, of_kind
from oracles.train import (
    at_height,
    involute,
    lean,
    moments,
    robot_lost_motion,
    robot_pairs,
    seen_backward,
    table_lost_motion,
    turned,
)
from places import SCENES as FOLDER

from tol3d import Run, load_scene
from tol3d.gearing.grammar.parts import ArmSpec

SCENES = ("robot_shoulder", "robot_shoulder_swing", "three_stage_train")
ALPHA = math.radians(20.0)
SIN, COS = math.sin(ALPHA), math.cos(ALPHA)
ARCMIN = 10800 / math.pi  # in a radian
SEEN = {
    "um": 2e-5,
    "arcmin": 1e-5,
    "mm": 1e-6,
}  # where the exact engine's steps end, 1e-8 mm, and another machine's bits


# by hand --------------------------------------------------------------------------------------------------------


def robot() -> dict[str, tuple[float, float]]:
    """Mean build and sigma of the robot's measures; only what turns has a mean of 0 and none leans."""
    found = {}
    for name, (terms, _) in zip(("spur", "bevel"), robot_pairs(), strict=True):
        mean, variances = moments(terms)
        sigma, arm = (
            math.sqrt(sum(variances.values())),
            {"spur": 137.5, "bevel": (3.5 * 31 - 9 * math.sqrt(0.5)) / 2}[name] * COS,
        )
        found[f"{name} normal backlash"] = (mean, sigma)
        found[f"{name} lost motion"] = (mean * ARCMIN * 1e-3 / arm, sigma * ARCMIN * 1e-3 / arm)
    mean, variances = robot_lost_motion()
    sigma = math.sqrt(sum(variances.values()))
    found["lost motion"] = (mean * ARCMIN, sigma * ARCMIN)
    found["tip displacement"] = (mean * 763, sigma * 763)
    return found


WORKING = math.acos(25.5 * COS / 25.75)  # of the first mesh of the table
OPENED = math.sin(WORKING)


def table_first() -> tuple[float, float, float]:
    """Nominal, mean build and sigma [um] of the first mesh's normal backlash."""
    nominal = 1e3 * (2 * 25.5 * COS * (involute(WORKING) - involute(ALPHA)) - 2 * 0.25 * SIN)
    mean = nominal + (30 + 30) * COS + OPENED * 9
    squares = 2 * (COS * 16 / 6) ** 2 + (2 * OPENED) ** 2 * (3**2 + 5**2 + 5**2) + OPENED**2 * 12**2 / 12
    return nominal, mean, math.sqrt(squares)


def table_idler() -> tuple[float, float, float]:
    """The same of the idler's lost motion [arcmin]: a triangular play of the gearbox, then the first mesh."""
    per_um = ARCMIN * 1e-3 / (15.5 * COS)
    nominal, mean, sigma = (per_um * own for own in table_first())
    play = (4 + 16 + 81 - 8 - 36 - 18) / 18
    return nominal, mean + 5 * 20 / 31, math.hypot(sigma, 20 / 31 * math.sqrt(play))


def table_leaning(turn: float | None, clearances: tuple[float, float] = (8.0, 8.0)) -> tuple[float, float]:
    """Mean builds [um] of the second and third mesh at a turn of the table [rad]; at a random one what turns is 0.

    Clearances of 8 um: the shaft's lower end goes 4 um away from the idler, its upper one 4 um to 200 deg. Where it
    leans by t, the tighter end of a face of width b loses b/2 on each flank: b sin(alpha) t in the plane of the axes,
    b cos(alpha) t across it, of which the larger counts.
    """
    heights = (-20.0, 20.0)
    lower, upper = np.array([[clearances[0] / 2, 0.0]]), turned(np.array([[clearances[1] / 2, 0.0]]), 200)
    leaning = lean(lower, upper, heights)
    below, above = (at_height(lower, upper, heights, z) for z in (0.0, 40.0))
    second = (30 + 40) * COS + 2 * SIN * (below[0, 0] - 4.5 * math.cos(math.radians(60)))
    second -= closing(leaning, 8)
    # the encoder's driver looks down and sees its mate at -75 deg: there its axis comes nearer
    towards = turned(seen_backward(above), 75)[0, 0]
    third = (32 + 28) * COS - 2 * SIN * towards - closing(turned(seen_backward(leaning), 75), 5)
    if turn is not None:
        second += 2 * SIN * 12 * math.cos(turn + math.radians(7))
    return second, third


def closing(leaning: np.ndarray, width: float) -> float:
    ((x, y),) = np.abs(leaning)
    return width * max(SIN * y, COS * x)


def table_mean_builds() -> dict[str, float]:
    """Mean builds of the measures that the leaning shaft is in."""
    _, first, _ = table_first()
    per_um = {name: ARCMIN * 1e-3 / (radius * COS) for name, radius in (("1", 15.5), ("2", 30.0), ("3", 12.8))}
    second, third = table_leaning(None)
    encoder = 5 / 2 + first * per_um["1"] * 31 / 40 + second * per_um["2"] * 3 / 2 + third * per_um["3"]
    # at the stop: 20 deg of the motor are 20/5.2 of the pinion, back; each gear has its space where its mate's tooth is
    pinion = -math.radians(20) / 5.2
    idler = math.pi + math.pi / 31 - pinion * 20 / 31 - math.radians(60)
    table = math.pi + math.pi / 60 - idler * 31 / 60
    stopped, _ = table_leaning(table - math.radians(7))
    return {
        "second normal backlash": second,
        "lost motion": encoder,
        "lost motion of the table at the stop": 5 / 3 + first * per_um["1"] * 31 / 60 + stopped * per_um["2"],
    }


def table_sigmas() -> dict[str, float]:
    """Sigmas of two of them: with an upright shaft, and with its bearings.

    Both meshes go straight with both clearances, uniform over 4 to 12 um: two points of Gauss and Legendre each are
    exact.
    """
    upright = 1e-6 * (2 * SIN) ** 2 * (5**2 + (12**2 + 1) / 2 + 2**2 + 6**2 + math.cos(math.radians(60)) ** 2 * 12 / 4)
    upright += 1e-6 * COS**2 * (16**2 + 20**2) / 36
    _, _, variances = table_lost_motion()
    ends = [8 - 4 / math.sqrt(3), 8 + 4 / math.sqrt(3)]
    second, third = np.array([table_leaning(None, (low, high)) for low in ends for high in ends]).T * 1e-3
    at_encoder = (second * 3 / 2 / 30.0 + third / 12.8) / COS
    return {
        "second normal backlash": 1e3 * math.sqrt(upright + second.var()),
        "lost motion": ARCMIN * math.sqrt(sum(variances.values()) + at_encoder.var()),
    }


def test_the_robots_expected_closed_forms_follow_by_hand() -> None:
    by_hand, own = robot(), measures_of("robot_shoulder")
    assert {name for name, values in own.items() if "closed_form" in values} == set(by_hand)
    for name, (mean, sigma) in by_hand.items():
        assert own[name]["closed_form"]["mean"] == pytest.approx(mean, abs=PRINTED), name
        assert own[name]["mean_build"]["analytic"] == pytest.approx(mean, abs=PRINTED), name
        assert own[name]["closed_form"]["sigma"] == pytest.approx(sigma, abs=PRINTED), name
    reducer = 28 / 110  # of its arcmin; the pairs have no backlash but by their deviations
    assert own["lost motion"]["nominal"] == pytest.approx({"analytic": reducer, "geometric": reducer}, abs=PRINTED)


def test_the_tables_expected_closed_forms_and_mean_builds_follow_by_hand() -> None:
    own = measures_of("three_stage_train")
    for name, by_hand in (("first normal backlash", table_first()), ("lost motion of the idler", table_idler())):
        nominal, mean, sigma = by_hand
        assert own[name]["nominal"]["analytic"] == pytest.approx(nominal, abs=PRINTED)
        assert own[name]["nominal"]["geometric"] == pytest.approx(nominal, abs=PRINTED)
        assert own[name]["mean_build"]["analytic"] == pytest.approx(mean, abs=PRINTED)
        assert own[name]["closed_form"] == pytest.approx({"mean": mean, "sigma": sigma}, abs=PRINTED)
    for name, mean in table_mean_builds().items():
        assert own[name]["closed_form"]["mean"] == pytest.approx(mean, abs=PRINTED), name
        assert own[name]["mean_build"]["analytic"] == pytest.approx(mean, abs=PRINTED), name
    for name, sigma in table_sigmas().items():
        assert own[name]["closed_form"]["sigma"] == pytest.approx(sigma, abs=PRINTED), name


def test_the_arm_passes_its_balance_where_its_centre_of_mass_stands_above_the_shaft() -> None:
    """Two bars of one weight per length: 637 mm up, then 420 mm across."""
    x, y = 420 * 420 / 2 / (637 + 420), (637 * 637 / 2 + 420 * 637) / (637 + 420)
    spec = of_kind(ArmSpec, load_scene(FOLDER / "robot_shoulder.yaml").parts["arm"])
    assert [length.internal for length in known(spec.centre_of_mass)][:2] == pytest.approx([x, y], abs=0.05)
    balance = 90 - math.degrees(math.atan2(y, x))
    own = expected("robot_shoulder_swing")["tip error over the swing"]
    for position, mean in zip(own["positions"], own["analytic"]["mean"], strict=True):
        assert (mean > 1.5) == (-60 + 5 * position > balance)


# the runs -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scene", SCENES)
def test_a_train_meets_its_expected_numbers(scene: str, run_of: Callable[[str], Run]) -> None:
    summary = run_of(scene).summary
    trials = expected(scene)["trials"]
    assert summary["engine"] == "exact"
    assert summary["status"] == {"ok": trials, "interferes": 0, "no contact": 0, "out of range": 0}
    assert list(measures_of(scene)) == list(summary["measures"])
    for name, own in measures_of(scene).items():
        found = summary["measures"][name]
        seen = PRINTED + SEEN[found["unit"]]
        assert_met(found, own, seen, seen, at=own.get("positions", slice(None)))
        assert ("analytic_closed_form" in found) == ("closed_form" in own), name
        if "closed_form" in own:
            form = found["analytic_closed_form"]
            error = form["sigma"] / math.sqrt(trials)
            for method in ("analytic", "geometric"):
                assert abs(found[method]["mean"] - form["mean"]) < 4 * error
                # of a normal; flat parts only make it smaller
                assert abs(found[method]["sigma"] - form["sigma"]) < 4 * error / math.sqrt(2)


@pytest.mark.parametrize(("scene", "train"), [("robot_shoulder", "shoulder swing"), ("three_stage_train", "indexing")])
def test_stages_of_a_train_meet_their_expected_numbers(scene: str, train: str, run_of: Callable[[str], Run]) -> None:
    stages = run_of(scene).summary["trains"][train]["stages"]
    own = expected(scene)["stages"]
    assert [stage["link"] for stage in stages] == list(own)
    for stage in stages:
        wanted = own[stage["link"]]
        assert stage["factor"] == pytest.approx(wanted["factor"], abs=PRINTED)
        found = {name: stage["methods"]["geometric"][name] for name in wanted["geometric"]}
        assert found == pytest.approx(wanted["geometric"], abs=2 * PRINTED)
    assert sum(stage["methods"]["geometric"]["share_percent"] for stage in stages) == pytest.approx(100.0)


@pytest.mark.parametrize("scene", SCENES)
def test_the_witness_of_a_train_agrees_within_what_it_explains(scene: str, run_of: Callable[[str], Run]) -> None:
    summary = run_of(scene).summary
    assert summary["warnings"] == []
    witness = summary["witness"]
    assert witness["status_differences"] == 0
    for name, own in witness["measures"].items():
        assert own["compared"] == witness["trials"] == load_scene(FOLDER / f"{scene}.yaml").study.witness
        assert own["max_abs_difference"] <= own["expected_at_most"] + own["allowance"], name
        assert own["mean_difference"] > 0, name  # chords lie inside of teeth
