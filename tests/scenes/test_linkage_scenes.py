"""The scenes of linkages run, none of their trials fails, and they meet the numbers in the files beside them."""

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from expected import PRINTED, assert_all_met, assert_closed_forms_are_there, measures_of
from places import SCENES as FOLDER
from shipped import shipped

from tol3d import Overrides, Run, load_scene, run_scene

SCENES = shipped("linkage")
LONG = ("spherical_drive", "stewart")
EACH = [pytest.param(own, marks=pytest.mark.slow) if own in LONG else own for own in SCENES]
SEEN = 1e-5  # um or arcmin: another machine's bits, of lengths up to 300 mm
ARCMIN = math.pi / 10800
BALL = math.sqrt(0.2)  # sigma of a coordinate of what is uniform in a ball, of its radius


def test_they_are_these() -> None:
    assert set(SCENES) == {"slider_crank", "spherical_drive", "stewart"}


@pytest.mark.parametrize("scene", EACH)
def test_a_linkage_meets_its_expected_numbers(scene: str, run_of: Callable[[str], Run]) -> None:
    summary = run_of(scene).summary
    assert summary["engine"] == "exact"
    assert_all_met(run_of(scene), scene, PRINTED + SEEN, PRINTED + SEEN)
    assert_closed_forms_are_there(run_of(scene), scene)
    assert summary["warnings"] == []
    for own in summary["measures"].values():
        assert own["agreement"]["explanation"]["faults"] == []


# by hand -------------------------------------------------------------------------------------------------------------


def sigma_of_slider(angle: float) -> float:
    """Sigma of the slider's place [um], by derivatives of x = -e sin angle + sqrt(l^2 - y^2 - h^2), y = e cos angle."""
    throw, rod, offset = 40.0, 130.0, 30.0
    y = throw * math.cos(angle)
    ahead = math.sqrt(rod**2 - y**2 - offset**2)
    effects = {
        "throw": (-math.sin(angle) - y * math.cos(angle) / ahead) * 20 / 3,
        "rod length": rod / ahead * 30 / 3,
        "guide y": y / ahead * 30 / 3,
        "guide z": offset / ahead * 30 / 3,
        "encoder": (-y + y * throw * math.sin(angle) / ahead) * 2 * ARCMIN / 3 * 1e3,
        "float": rod / ahead * BALL * 5,
    }
    return math.hypot(*effects.values())


def test_the_slider_stands_and_scatters_as_by_hand() -> None:
    places = {"far end": -math.pi / 2, "halfway": 0.0, "near end": math.pi / 2}
    for name, angle in places.items():
        own = measures_of("slider_crank")[name]
        place = -40 * math.sin(angle) + math.sqrt(130**2 - (40 * math.cos(angle)) ** 2 - 30**2)
        assert own["nominal"] == pytest.approx({"analytic": place * 1e3, "geometric": place * 1e3}, abs=PRINTED)
        assert own["closed_form"]["mean"] == pytest.approx(place * 1e3, abs=PRINTED)
        assert own["closed_form"]["sigma"] == pytest.approx(sigma_of_slider(angle), abs=PRINTED)


def rotation(vector: Any) -> Any:
    """By Rodrigues' formula."""
    angle = float(np.linalg.norm(vector))
    x, y, z = np.array(vector) / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def test_the_platform_scatters_as_its_six_legs_say() -> None:
    """Each leg's length is (platform joint - foot) along the leg: six equations for shift and turn of the platform."""
    turned = rotation(np.radians([12.0, -8.0, 15.0]))
    at = np.array([30.0, -20.0, 260.0])
    feet = np.radians([-10.0, 10, 110, 130, 230, 250])
    joints = np.radians([-50.0, 50, 70, 170, 190, 290])
    foot = 200 * np.stack([np.cos(feet), np.sin(feet), 0 * feet], axis=-1)
    arm = 120 * np.stack([np.cos(joints), np.sin(joints), 0 * joints], axis=-1) @ turned.T
    leg = at + arm - foot
    along = leg / np.linalg.norm(leg, axis=1)[:, None]
    height = np.linalg.inv(np.hstack([along, np.cross(arm, along)]))[2]  # of the platform, by each leg's length
    per_leg = (
        (15 / 3) ** 2
        + (along[:, 0] * 20 / 3) ** 2
        + (along[:, 2] * 20 / 3) ** 2
        + (along @ turned[:, 2] * 20 / 3) ** 2
        + 2 * (BALL * 5) ** 2
    )
    own = measures_of("stewart")["height leaning"]
    assert own["closed_form"]["sigma"] == pytest.approx(math.sqrt(float(height**2 @ per_leg)), abs=PRINTED)


@pytest.mark.slow
def test_the_drive_points_as_far_aside_as_a_program_of_its_own_has_it(tmp_path: Path) -> None:
    """Figures of a program that solves both rods' lengths build by build; they have two or three digits."""
    count = 10_000
    run = run_scene(FOLDER / "spherical_drive.yaml", overrides=Overrides(trials=count), out=tmp_path / "run")
    measures: Mapping[str, Any] = run.summary["measures"]
    digits = {"rest": (0.01, 0.01), "middle": (0.01, 0.01), "wide": (0.01, 0.01), "far": (0.1, 0.1)}
    scene = load_scene(FOLDER / "spherical_drive.yaml")
    (column,) = scene.published.values()
    for pose, (of_mean, of_sigma) in digits.items():
        own = measures[f"pointing error at {pose}"]["geometric"]
        said = column[f"pointing error at {pose}"]
        assert said.mean is not None
        assert said.sigma is not None
        # both samples scatter, that of the figures like one of as many trials
        noise = 4 * math.sqrt(2 / count)
        assert own["mean"] == pytest.approx(said.mean.internal / ARCMIN, abs=noise * own["sigma"] + of_mean / 2)
        tail = math.sqrt((own["kurtosis"] + 2) / 4)  # of a sigma's scatter, over a normal's 1 / sqrt(2 n)
        assert own["sigma"] == pytest.approx(
            said.sigma.internal / ARCMIN, abs=noise * own["sigma"] * tail + of_sigma / 2
        )
    tilted = measures["along the tilt at far"]["geometric"], measures["across the tilt at far"]["geometric"]
    assert (
        tilted[0]["sigma"] > 15 * tilted[1]["sigma"]
    )  # the error grows in the tilt, where the drive nears its singular pose
