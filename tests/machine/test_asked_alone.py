"""A value depends on no other measure: joints that act together alone, and what a train's play is read by."""

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from machine.arm_by_hand import DRIVE, STAGE
from machine.housed import Array
from scene_texts import scene_of
from scipy.spatial.transform import Rotation

from tol3d import Overrides
from tol3d.study.system.stated import component_slices
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.overrides import simulation_of

METHODS = ("exact", "analytic")
COUNT = 60

# the wheels' reference radii are 28.5 mm; nominally there is no backlash at 38 mm
TWO_JOINTS = (
    """
scene: two joints
parts:
  base: {kind: solid, features: {bore: {kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 60 mm}}}
  link 1:
    kind: solid
    features:
      pilot: {kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 30 mm}
      bore: {kind: axis, at: [30 mm, 0 mm, 400 mm], axis: [0, 1, 0], length: 50 mm}
  link 2:
    kind: solid
    placed: {at: [30 mm, 0 mm, 400 mm], z: [0, 1, 0], x: [1, 0, 0]}
    features:
      pilot: {kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 30 mm}
      flange: {kind: plane, at: [400 mm, 0 mm, 0 mm], normal: [1, 0, 0], extent: [20 mm, 20 mm]}"""
    + STAGE.format(k=1)
    + STAGE.format(k=2)
    + """
tolerances:
  t1: {kind: tooth_thickness, of: wheel 1, distribution: {kind: uniform, lower: -200 um, upper: -150 um}}
  t2: {kind: tooth_thickness, of: wheel 2, distribution: {kind: uniform, lower: -120 um, upper: -90 um}}
moves:
  stand: {kind: fix, part: base}"""
    + DRIVE.format(k=1)
    + DRIVE.format(k=2)
    + """
  arm:
    kind: open_chain
    joints:
      j1: {between: [base.bore, link 1.pilot], train: drive 1}
      j2: {between: [link 1.bore, link 2.pilot], train: drive 2}
    poses:
      home: {j1: 0 deg, j2: 0 deg}
      hair: {j1: 0.001 deg, j2: 0 deg}
measures:
  roll: {kind: orientation_error, of: link 2.flange, from: base, component: x, at: home}
  roll at hair: {kind: orientation_error, of: link 2.flange, from: base, component: x, at: hair}
"""
)

ONE_JOINT = """
scene: what is asked beside
parts:
  base: {kind: solid, features: {bore: {kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 50 mm}}}
  arm:
    kind: solid
    features:
      pilot: {kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 50 mm}
      tip: {kind: point, at: [500 mm, 0 mm, 0 mm]}
  p: {kind: spur_gear, teeth: 17, module: 2 mm, face_width: 15 mm}
  w: {kind: spur_gear, teeth: 68, module: 2 mm, face_width: 15 mm}
tolerances:
  thin: {kind: tooth_thickness, of: w, distribution: {kind: constant, value: -100 um}}
  pitch: {kind: pitch_deviation, of: w, flanks: each, limits: {iso_class: 9}, law: {kind: random_walk, fill: [0.9, 1]}}
moves:
  stand: {kind: fix, part: base}
  g: {kind: mesh, driver: p, driven: w, centre_distance: 85 mm}
  d: {kind: train, driven: p, output: w}
  chain:
    kind: open_chain
    joints: {j: {between: [base.bore, arm.pilot], train: d}}
    poses: {home: {j: 0 deg}}
measures:
"""
Y = "  y: {kind: position_error, of: arm.tip, from: base, component: y, at: home}\n"
ONE_TOOTH = "  lm: {kind: lost_motion, of: d, tooth: driven}\n"
ALL_TEETH = "  all: {kind: lost_motion, of: d, over: {at: 0 deg}}\n"


def read(text: str, folder: Path, method: str) -> tuple[Mapping[str, Array], Mapping[str, Array]]:
    """Measures of the first trials (trials,) [mm or rad], and deviations by contributor (trials, components)."""
    simulation = simulation_of(scene_of(text, folder), Overrides())
    system, trials = simulation.system, drawn(simulation, 0, COUNT)
    found = system.method(method, system.materials(method)).answers(trials, system.measures)
    slices = component_slices(system)
    deviations = {name: trials.deviations[:, own] for name, own in slices.items()}
    return {name: own[:, 0] for name, own in found.values.items()}, deviations


def test_two_joints_turn_a_part_about_a_third_axis_by_the_product_of_their_plays(tmp_path: Path) -> None:
    """Joints about z, then y: rotations by a and b are one whose vector has -a b / 2 along x, of second order."""
    found, deviations = read(TWO_JOINTS, tmp_path, "exact")
    # both flanks of a wheel are thinner by half the arc each: play of the whole arc at the reference circle
    plays = [-deviations[name][:, 0] / 28.5 for name in ("t1", "t2")]
    for name in ("roll", "roll at hair"):
        stands = math.radians(0.001) if name == "roll at hair" else 0.0
        of_signs = []
        for signs in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
            a, b = (sign * play / 2.0 for sign, play in zip(signs, plays, strict=True))
            zero = np.zeros_like(a)
            about_z, about_y = (
                Rotation.from_rotvec(np.column_stack(own)) for own in ((zero, zero, a), (zero, b, zero))
            )
            there = Rotation.from_rotvec([0.0, 0.0, stands])
            of_signs.append((there * about_z * about_y * there.inv()).as_rotvec()[:, 0])
        away = np.abs(np.array(of_signs) - found[name])
        assert away.min(axis=0).max() < 1e-9  # rad; rolls are some 2e-6
        # each joint lies on either side by chance, so both signs of the product come as often
        assert abs(np.sum(found[name] > 0.0) - COUNT / 2) < 2.0 * math.sqrt(COUNT)
    sigma = 0.5 * math.prod(math.sqrt(np.mean((play / 2.0) ** 2)) for play in plays)
    assert found["roll"].std() == pytest.approx(sigma, rel=0.1)


@pytest.mark.parametrize("method", METHODS)
def test_rolls_are_the_same_with_a_pitch_beside_them(method: str, tmp_path: Path) -> None:
    alone, _ = read(TWO_JOINTS, tmp_path, method)
    pitch = "  pitch: {kind: orientation_error, of: link 2.flange, from: base, component: z, at: home}\n"
    beside, _ = read(TWO_JOINTS + pitch, tmp_path, method)
    for name in ("roll", "roll at hair"):
        np.testing.assert_allclose(beside[name], alone[name], rtol=0.0, atol=1e-15)


@pytest.mark.parametrize("method", METHODS)
def test_a_joint_lies_off_by_the_play_of_all_teeth_whatever_is_measured_of_its_train(
    method: str, tmp_path: Path
) -> None:
    alone, _ = read(ONE_JOINT + Y, tmp_path, method)
    others = [read(ONE_JOINT + text, tmp_path, method)[0] for text in (Y + ONE_TOOTH, ONE_TOOTH + Y, Y + ALL_TEETH)]
    for own in others:
        assert own["y"].tolist() == alone["y"].tolist()
    half = np.abs(500.0 * np.sin(others[-1]["all"] / 2.0))
    np.testing.assert_allclose(np.abs(alone["y"]), half, rtol=1e-5 if method == "analytic" else 1e-9)
    assert np.abs(others[0]["lm"] / others[-1]["all"] - 1.0).max() > 0.01
