"""A scene without tolerances: every trial is the nominal build, and the run says so."""

from pathlib import Path

import pytest
from scene_texts import scene_of

from tol3d.analyses.rare_events import rare_event
from tol3d.analyses.response import response_of
from tol3d.analyses.tolerance_effects import effects
from tol3d.errors import InputError
from tol3d.simulate import Overrides, run_scene, simulation_of

SCENE = """
scene: bare
parts:
  base: {kind: solid, features: {top: {kind: plane, at: [0 mm, 0 mm, 5 mm], normal: [0, 0, 1], extent: [80 mm, 60 mm]}}}
  lid:
    kind: solid
    placed: {at: [7 mm, 0 mm, 7 mm], z: [0, 0.6, 0.8]}
    features:
      under: {kind: plane, at: [0 mm, 0 mm, -2 mm], normal: [0, 0, -1], extent: [80 mm, 60 mm]}
      over: {kind: point, at: [1.3 mm, 0.7 mm, 2.1 mm]}
moves:
  base fixed: {kind: fix, part: base}
  lid fixed: {kind: fix, part: lid}
measures:
  height: {kind: distance, from: base.top, to: lid.over}
"""


def test_a_run_without_contributors_has_the_nominal_value_in_every_trial(tmp_path: Path) -> None:
    """Oracle: the point in the world, 7 + R (1.3, 0.7, 2.1), x across z as near to the world's as may be."""
    (tmp_path / "scene.yaml").write_text(SCENE, encoding="utf-8")
    found = run_scene(tmp_path / "scene.yaml", overrides=Overrides(trials=32), out=tmp_path / "run").summary
    own = found["measures"]["height"]
    x, y, z = 7 + 1.3, 0.8 * 0.7 + 0.6 * 2.1, 7 - 0.6 * 0.7 + 0.8 * 2.1 - 5
    assert own["geometric"]["mean"] == pytest.approx(1000 * (x * x + y * y + z * z) ** 0.5, abs=1e-6)
    assert own["geometric"]["sigma"] == pytest.approx(0.0, abs=1e-9)
    assert own["contributors"] == []


def test_analyses_of_what_varies_refuse_a_scene_in_which_nothing_does(tmp_path: Path) -> None:
    response = response_of(simulation_of(scene_of(SCENE, tmp_path)))
    words = "expected a scene with tolerances, got none: all its builds are the nominal one"
    with pytest.raises(InputError, match=words):
        effects(response)
    with pytest.raises(InputError, match=words):
        rare_event(response, "low", 1.0)
