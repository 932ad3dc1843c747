"""Gears in motion: the driven turns by the ratio, and swings by the backlash that was measured."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from tol3d import Overrides, Run, run_scene
from tol3d.gearing.presenting import PRESENTER
from tol3d.report.motion import Motion, motion_of
from tol3d.simulate import replay

TRIAL = 3
TEETH = 28, 110  # of scenes/spur_pair.yaml
SHAFTS = """
scene: two stages
parts:
  input: {kind: shaft, carries: {pinion: {}}}
  middle: {kind: shaft, carries: {wheel: {}, second pinion: {at: 30 mm}}}
  output: {kind: shaft, carries: {second wheel: {}}}
  pinion: {kind: spur_gear, teeth: 28, module: 2.5 mm, face_width: 20 mm, bore: 25 mm}
  wheel: {kind: spur_gear, teeth: 110, module: 2.5 mm, face_width: 20 mm, bore: 60 mm}
  second pinion: {kind: spur_gear, teeth: 28, module: 2.5 mm, face_width: 20 mm, bore: 25 mm}
  second wheel: {kind: spur_gear, teeth: 110, module: 2.5 mm, face_width: 20 mm, bore: 60 mm}
moves:
  first: {kind: mesh, driver: pinion, driven: wheel, centre_distance: 172.6 mm, working_flank: right}
  second: {kind: mesh, driver: second pinion, driven: second wheel, centre_distance: 172.6 mm, working_flank: left}
  whole: {kind: train, driven: input, output: output}
tolerances:
  thickness: {kind: tooth_thickness, of: pinion, distribution: {kind: uniform, lower: -60 um, upper: -40 um}}
measures:
  lost motion: {kind: lost_motion, of: whole}
study: {trials: 4, seed: 1}
"""


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Run:
    overrides = Overrides(trials=4, engine="exact", witness=0)
    return run_scene("spur_pair", overrides=overrides, out=tmp_path_factory.mktemp("moved") / "pair")


@pytest.fixture(scope="module")
def train(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("moved")
    (folder / "train.yaml").write_text(SHAFTS)
    return run_scene(folder / "train.yaml", out=folder / "run")


def moved(run: Run, which: int | str, name: str, frames: int) -> Motion:
    return motion_of(PRESENTER.display(run, which, magnify=1.0), name, frames)


def azimuths(motion: Motion, name: str) -> NDArray[np.float64]:
    """Azimuths of a gear's x in each frame [rad], without jumps."""
    poses = (frame.poses[name] for frame in motion.frames)
    return np.unwrap([math.atan2(pose[1, 0], pose[0, 0]) for pose in poses])


def test_the_driver_turns_by_a_pitch_and_the_driven_by_the_ratio(pair: Run) -> None:
    found = moved(pair, "nominal", "turn", 8)
    assert len(found.frames) == 8
    assert not found.back
    driver, driven = azimuths(found, "pinion"), azimuths(found, "wheel")
    assert driver - driver[0] == pytest.approx(2 * math.pi / TEETH[0] * np.arange(8) / 8, abs=1e-12)
    assert driven - driven[0] == pytest.approx(-(driver - driver[0]) * TEETH[0] / TEETH[1], abs=1e-9)


def test_the_swing_of_a_pair_is_the_backlash_that_was_measured(pair: Run) -> None:
    found = moved(pair, TRIAL, "swing", 5)
    assert found.back
    swing = abs(np.diff(azimuths(found, "wheel")[[0, -1]])[0])
    # its arcs are those at the shared position: mm of backlash at 129 mm of base radius, to 1e-6 mm
    assert math.degrees(swing) * 60 == pytest.approx(replay(pair, TRIAL).geometric["lost motion"], abs=5e-5)
    assert np.diff(azimuths(found, "pinion")) == pytest.approx(0.0, abs=1e-12)
    assert np.diff(azimuths(found, "wheel")) == pytest.approx(np.diff(azimuths(found, "wheel"))[0], abs=1e-12)


def test_contacts_are_marked_on_the_line_of_action_while_flanks_touch(pair: Run) -> None:
    found = moved(pair, "nominal", "turn", 6)
    alpha, pitch_radius = math.radians(20), TEETH[0] * 2.5 / 2
    for frame in found.frames:
        (mark,) = frame.marks
        assert mark.of == ("pinion", "wheel")
        x, y, _ = mark.point  # on a line through the pitch point, at the pressure angle to the common tangent
        off = [(x - pitch_radius) * math.cos(alpha) + sense * y * math.sin(alpha) for sense in (1.0, -1.0)]
        assert min(map(abs, off)) < 1e-6
    swings = moved(pair, "nominal", "swing", 4).frames
    assert [len(frame.marks) for frame in swings] == [1, 0, 0, 1]


@pytest.mark.slow
def test_shafts_of_a_train_turn_by_their_ratios_and_swing_by_the_lost_motion(train: Run) -> None:
    turning = moved(train, "nominal", "turn", 9)
    first, last = azimuths(turning, "pinion"), azimuths(turning, "second wheel")
    assert first - first[0] == pytest.approx(2 * math.pi * np.arange(9) / 9, abs=1e-12)
    assert last - last[0] == pytest.approx((first - first[0]) * (TEETH[0] / TEETH[1]) ** 2, abs=1e-9)
    swing = azimuths(moved(train, TRIAL, "swing", 3), "second wheel")
    measured = replay(train, TRIAL).geometric["lost motion"]
    assert math.degrees(abs(swing[-1] - swing[0])) * 60 == pytest.approx(measured, abs=1e-3)
