"""An arm without gears: its links are read in every pose of one scene."""

from pathlib import Path

import pytest
from scene_texts import scene_of

from tol3d import Overrides, run_scene
from tol3d.report.presenter import presenter_of

SCENE = """scene: chain alone
parts:
  base: {kind: solid, features: {bore: {kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 20 mm}}}
  link:
    kind: solid
    features:
      pilot: {kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 20 mm}
      tip: {kind: point, at: [100 mm, 0 mm, 0 mm]}
tolerances:
  tip y: {kind: plus_minus, of: link.tip, along: [0, 1, 0], distribution: {kind: normal, lower: -20 um, upper: 20 um}}
moves:
  stand: {kind: fix, part: base}
  arm:
    kind: open_chain
    joints: {one: {between: [base.bore, link.pilot]}}
    poses: {home: {one: 0 deg}, up: {one: 90 deg}}
measures:
  x at home: {kind: position_error, of: link.tip, from: base, component: x, at: home}
  x up: {kind: position_error, of: link.tip, from: base, component: x, at: up}
"""


def test_a_link_is_read_in_every_pose(tmp_path: Path) -> None:
    """The y direction of the link is -x of the base once it has turned by a quarter."""
    run = run_scene(scene_of(SCENE, tmp_path), overrides=Overrides(trials=400), out=tmp_path / "run")
    home, up = (run.summary["measures"][name] for name in ("x at home", "x up"))
    assert home["geometric"]["sigma"] == pytest.approx(0.0, abs=1e-9)
    assert up["geometric"]["sigma"] == pytest.approx(20.0 / 3, rel=4 / (2 * 400) ** 0.5)
    assert up["pose"] == "up"
    assert [own["name"] for own in up["contributors"]] == ["tip y"]
    display = presenter_of(run.found).display(run, "nominal", magnify=1.0)
    assert [world.name for world in display.worlds] == ["home", "up"]
