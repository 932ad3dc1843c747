"""A reducer of a data sheet before a stage with a ring: plays add up by the ratio of the ring, for either sense."""

import math
from pathlib import Path

import numpy as np
import pytest

from tol3d import run_scene

ARCMIN = 10800 / math.pi  # in a radian
SCENE = """
scene: a reducer before a ring
parts:
  motor: {kind: shaft}
  between: {kind: shaft, carries: {inner gear: {at: 10 mm}}}
  inner gear: {kind: spur_gear, teeth: 20, module: 1.25 mm, face_width: 14 mm}
  ring: {kind: internal_gear, teeth: 70, module: 1.25 mm, face_width: 13 mm, addendum: 0.85}
tolerances:
  backlash: {kind: reducer_backlash, of: gearbox, distribution: {kind: uniform, lower: 2 arcmin, upper: 9 arcmin}}
  inner thickness: {kind: tooth_thickness, of: inner gear, distribution: {kind: uniform, lower: -60 um, upper: -20 um}}
  ring thickness: {kind: tooth_thickness, of: ring, distribution: {kind: uniform, lower: -60 um, upper: -20 um}}
  inner eccentricity: {kind: eccentricity, of: inner gear, distribution: {kind: rayleigh, scale: 4 um}}
moves:
  gearbox: {kind: reducer, driver: motor, driven: between, ratio: RATIO, offset: 40 mm}
  ring stage: {kind: mesh, driver: inner gear, driven: ring, centre_distance: 31.25 mm, working_flank: either}
  train: {kind: train, driven: motor, output: ring, ratio: WHOLE}
measures:
  lost motion: {kind: lost_motion, of: train}
  ring backlash: {kind: angular_backlash, of: ring stage, gear: ring}
study: {trials: 200, seed: 3}
"""


@pytest.mark.parametrize("ratio", [5, -5])
def test_the_reducer_s_play_turns_the_ring_by_the_ratio_of_the_teeth(ratio: int, tmp_path: Path) -> None:
    """20 teeth in 70: 2/7 of the reducer's play, and the ring's own at the same position.

    At the standard centre distance thin teeth alone leave room; towards the ring an eccentric gear takes it.
    """
    text = SCENE.replace("RATIO", str(ratio)).replace("WHOLE", str(3.5 * ratio))
    (tmp_path / "scene.yaml").write_text(text, "utf-8")
    run = run_scene(tmp_path / "scene.yaml", out=tmp_path / "run")
    columns = run.columns()
    assert run.summary["status"]["ok"] == 200
    for method in ("analytic", "geometric"):
        own = columns[f"{method}:lost motion"] - columns[f"{method}:ring backlash"]
        np.testing.assert_allclose(own, columns["backlash [arcmin]"] * 2 / 7, rtol=0, atol=1e-9)
    alpha = math.radians(20)
    theta = np.radians(columns["position:ring stage [deg]"])
    x, y = columns["inner eccentricity.x [um]"], columns["inner eccentricity.y [um]"]
    towards = x * np.cos(theta) - y * np.sin(theta)
    thicker = columns["inner thickness [um]"] + columns["ring thickness [um]"]
    gap = (-thicker * math.cos(alpha) - 2 * math.sin(alpha) * towards) * 1e-3
    wanted = gap / (43.75 * math.cos(alpha)) * ARCMIN
    np.testing.assert_allclose(columns["analytic:ring backlash"], wanted, rtol=0, atol=1e-9)
