"""Gears whose bores lie in a part that a loop places: what the loop does to it opens and closes their mesh."""

from pathlib import Path

import numpy as np
import pytest
from machine.housed import ALONG, APART, GEARS, SHAFTS, plain_scene
from scene_texts import edited, refusal, scene_of

from tol3d import Overrides, load_scene, run_scene

X, Y = (APART * own for own in ALONG)
ROD = 50.0
SCENE = f"""scene: gears on a slide
parts:
  housing:
    kind: solid
    features:
      bore 1: {{kind: cylinder, at: [0 mm, 0 mm, -30 mm], axis: [0, 0, 1], length: 9 mm, diameter: 9 mm, hole: true}}
      bore 1b: {{kind: cylinder, at: [0 mm, 0 mm, 30 mm], axis: [0, 0, 1], length: 9 mm, diameter: 9 mm, hole: true}}
      guide: {{kind: axis, at: [{X!r} mm, {Y!r} mm, 0 mm], axis: [{ALONG[0]!r}, {ALONG[1]!r}, 0], length: 40 mm}}
      eye: {{kind: point, at: [{X + ROD * ALONG[0]!r} mm, {Y + ROD * ALONG[1]!r} mm, 0 mm]}}
  slide:
    kind: solid
    placed: {{at: [{X!r} mm, {Y!r} mm, 0 mm]}}
    features:
      bore 2: {{kind: cylinder, at: [0 mm, 0 mm, -30 mm], axis: [0, 0, 1], length: 9 mm, diameter: 9 mm, hole: true}}
      bore 2b: {{kind: cylinder, at: [0 mm, 0 mm, 30 mm], axis: [0, 0, 1], length: 9 mm, diameter: 9 mm, hole: true}}
      way: {{kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [{ALONG[0]!r}, {ALONG[1]!r}, 0], length: 40 mm}}
      eye: {{kind: point, at: [0 mm, 0 mm, 0 mm]}}
  rod:
    kind: solid
    placed: {{at: [{X!r} mm, {Y!r} mm, 0 mm]}}
    features:
      near: {{kind: point, at: [0 mm, 0 mm, 0 mm]}}
      far: {{kind: point, at: [{ROD * ALONG[0]!r} mm, {ROD * ALONG[1]!r} mm, 0 mm]}}{SHAFTS}{GEARS}
tolerances:
  rod length:
    kind: plus_minus
    of: rod.far
    along: [{ALONG[0]!r}, {ALONG[1]!r}, 0]
    distribution: {{kind: uniform, lower: -60 um, upper: 20 um}}
  thick: {{kind: tooth_thickness, of: pinion, distribution: {{kind: constant, value: -100 um}}}}
moves:
  base: {{kind: fix, part: housing}}
  drive:
    kind: close_loop
    bodies: [slide, rod]
    joints:
      guide: {{kind: prismatic, between: [housing.guide, slide.way]}}
      near: {{kind: ball, between: [slide.eye, rod.near]}}
      far: {{kind: ball, between: [rod.far, housing.eye]}}
  first in bores: {{kind: shaft_in_bores, shaft: first shaft, in: [housing.bore 1, housing.bore 1b]}}
  last in bores: {{kind: shaft_in_bores, shaft: last shaft, in: [slide.bore 2, slide.bore 2b]}}
  stage: {{kind: mesh, driver: pinion, driven: wheel}}
measures:
  backlash: {{kind: normal_backlash, of: stage}}
study: {{trials: 500}}
"""


def test_a_longer_rod_pushes_the_wheel_towards_the_pinion(tmp_path: Path) -> None:
    """The rod hangs on a point beyond the wheel: what it is longer, the centre distance is less."""
    run = run_scene(scene_of(SCENE, tmp_path), overrides=Overrides(trials=500), out=tmp_path / "run")
    own = run.summary["measures"]["backlash"]
    assert own["agreement"]["explanation"]["faults"] == []
    assert own["status"]["does not close"] == 0
    opened = (
        "\n  opened: {kind: centre_distance, of: stage, distribution: {kind: uniform, lower: -20 um, upper: 60 um}}"
    )
    thick = "\n  thick: {kind: tooth_thickness, of: pinion, distribution: {kind: constant, value: -100 um}}"
    plain = tmp_path / "plain.yaml"
    plain.write_text(plain_scene(tolerances=thick + opened), "utf-8")
    beside = run_scene(load_scene(plain), overrides=Overrides(trials=500), out=tmp_path / "plain")
    other = beside.summary["measures"]["backlash"]
    sigma = other["geometric"]["sigma"]
    assert own["geometric"]["mean"] == pytest.approx(other["geometric"]["mean"], abs=4 * sigma / np.sqrt(500) * 1.5)
    assert own["geometric"]["sigma"] == pytest.approx(sigma, rel=4 * 0.5 * 1.5 / np.sqrt(500))  # kurtosis 1.8


def test_no_path_is_read_beside_gears(tmp_path: Path) -> None:
    read = "\n  along: {kind: gap, from: housing.eye, to: slide.eye, along: [1, 0, 0], over: there, take: max}\nstudy"
    said = refusal(edited(SCENE, ("\nstudy", read)), tmp_path)
    assert "measures.along.over: expected none, for no move has paths, got 'there'" in said
