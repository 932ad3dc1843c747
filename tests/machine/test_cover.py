"""Shafts between a housing and a cover: what moves the cover leans them, whichever way gears face."""

from pathlib import Path

import numpy as np
import pytest
from machine.housed import gearbox_of, values

from tol3d import Overrides, run_scene
from tol3d.errors import SceneError

BORE = "axis: [0, 0, 1], length: 9 mm, diameter: 22 mm, hole: true"
APART = 61.0
SLIDE = (
    "  slip: {kind: locator, of: lid, pair: tertiary 1, distribution: {kind: uniform, lower: -50 um, upper: 50 um}}\n"
)
TURN = SLIDE.replace("tertiary 1", "secondary 1")


def scene(tolerances: str, facing: str = "forward", motor: bool = False, cover: str = "") -> str:
    points = {
        "p1": ((-50, -50, 30), (0, 0, -1)),
        "p2": ((120, -50, 30), (0, 0, -1)),
        "p3": ((40, 60, 30), (0, 0, -1)),
        "p4": ((-50, -60, 35), (0, -1, 0)),
        "p5": ((30.5, -60, 35), (0, -1, 0)),
        "p6": ((-60, 0, 35), (-1, 0, 0)),
    }
    features = "".join(
        f"      {name}: {{kind: point, at: [{', '.join(f'{x} mm' for x in at)}], normal: {list(normal)}}}\n"
        for name, (at, normal) in points.items()
    )
    return f"""scene: cover
parts:
  housing:
    kind: solid
    features:
      floor: {{kind: plane, at: [40 mm, 0 mm, 30 mm], normal: [0, 0, 1], extent: [200 mm, 140 mm]}}
      back: {{kind: plane, at: [40 mm, -60 mm, 35 mm], normal: [0, 1, 0], extent: [200 mm, 10 mm]}}
      left: {{kind: plane, at: [-60 mm, 0 mm, 35 mm], normal: [1, 0, 0], extent: [10 mm, 120 mm], along: [0, 0, 1]}}
      a: {{kind: cylinder, at: [0 mm, 0 mm, -30 mm], {BORE}}}
      b: {{kind: cylinder, at: [{APART} mm, 0 mm, -30 mm], {BORE}}}
  cover:
    kind: solid
    features:
{features}      a2: {{kind: cylinder, at: [0 mm, 0 mm, 40 mm], {BORE}}}
      b2: {{kind: cylinder, at: [{APART} mm, 0 mm, 40 mm], {BORE}}}
  in: {{kind: shaft, carries: {{g: {{}}}}}}
  out: {{kind: shaft, carries: {{w: {{facing: {facing}}}}}}}
  g: {{kind: spur_gear, teeth: 20, module: 2 mm, face_width: 16 mm}}
  w: {{kind: spur_gear, teeth: 40, module: 2 mm, face_width: 14 mm}}
{"  motor: {kind: shaft}" if motor else ""}
tolerances:
{tolerances}
moves:
  base: {{kind: fix, part: housing}}
  lid:
    kind: three_two_one
    part: cover
    primary:
      - {{from: cover.p1, to: housing.floor}}
      - {{from: cover.p2, to: housing.floor}}
      - {{from: cover.p3, to: housing.floor}}
    secondary: [{{from: cover.p4, to: housing.back}}, {{from: cover.p5, to: housing.back}}]
    tertiary: [{{from: cover.p6, to: housing.left}}]
{"  bought: {kind: reducer, driver: motor, driven: in, ratio: 5}" if motor else ""}
  la: {{kind: shaft_in_bores, shaft: in, in: [housing.a, cover.a2]}}
  lb: {{kind: shaft_in_bores, shaft: out, in: [housing.b, cover.b2]}}
  mesh: {{kind: mesh, driver: g, driven: w}}
measures:
  j: {{kind: normal_backlash, of: mesh}}
""".replace("\n\n", "\n")


@pytest.mark.parametrize("facing", ["forward", "backward"])
def test_a_cover_that_slides_leans_both_shafts_alike_and_a_turned_one_does_not(facing: str, tmp_path: Path) -> None:
    """A cover turned by a locator d, its other one 80.5 mm beside it: the far bores go apart across the line of
    centres by 61 d / 80.5, over 70 mm of shaft, which takes half a face times that lean times cos(alpha_w), both
    flanks."""
    d = np.array([0.0, 0.05, -0.05])
    turned, slid = (gearbox_of(scene(own, facing), tmp_path) for own in (TURN, SLIDE))
    still = values(slid, "analytic", {"slip": d}, np.full(3, 0.2))["j"]
    np.testing.assert_allclose(still, still[0], rtol=0, atol=1e-12)
    found = values(turned, "analytic", {"slip": d}, np.full(3, 0.2))["j"]
    pressure = np.arccos(60 * np.cos(np.radians(20)) / APART)
    lost = 14.0 * np.cos(pressure) * (APART / 80.5 * np.abs(d)) / 70.0
    np.testing.assert_allclose(found, still[0] - lost, rtol=0, atol=1e-12)
    assert values(turned, "exact", {"slip": d}, np.full(3, 0.2))["j"] == pytest.approx(found, abs=2e-5)


@pytest.mark.parametrize("facing", ["forward", "backward"])
def test_what_counts_twice_is_told_from_what_does_not(facing: str, tmp_path: Path) -> None:
    law = "distribution: {kind: uniform, lower: -10 um, upper: 10 um}"
    distance, lean = (f"  f: {{kind: {kind}, of: mesh, {law}}}\n" for kind in ("centre_distance", "axis_out_of_plane"))
    gearbox_of(scene(SLIDE + distance, facing), tmp_path)
    with pytest.raises(SceneError, match="expected no axis_out_of_plane of 'mesh', for 'slip' moves the bores"):
        gearbox_of(scene(TURN + lean, facing), tmp_path)


def test_a_motor_before_a_reducer_needs_no_bores(tmp_path: Path) -> None:
    plain, driven = (gearbox_of(scene(TURN, motor=motor), tmp_path) for motor in (False, True))
    d = np.linspace(-0.05, 0.05, 5)
    found, expected = (values(own, "exact", {"slip": d}, np.full(5, 0.2))["j"] for own in (driven, plain))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6)


def test_a_datum_that_touches_with_its_corner_has_its_share_and_no_closed_form(tmp_path: Path) -> None:
    """Both signs of the wall's lean push the bore the same way: most of the variance is its, by its square."""
    path = tmp_path / "scene.yaml"
    path.write_text(
        f"""scene: contact datum
parts:
  housing:
    kind: solid
    features:
      floor: {{kind: plane, at: [40 mm, 0 mm, -40 mm], normal: [0, 0, -1], extent: [200 mm, 140 mm]}}
      left: {{kind: plane, at: [-60 mm, 0 mm, 0 mm], normal: [-1, 0, 0], extent: [120 mm, 80 mm], along: [0, 1, 0]}}
      a: {{kind: cylinder, at: [0 mm, 0 mm, 0 mm], {BORE}}}
      b: {{kind: cylinder, at: [{APART} mm, 0 mm, 0 mm], {BORE}}}
  g: {{kind: spur_gear, teeth: 20, module: 2 mm, face_width: 16 mm}}
  w: {{kind: spur_gear, teeth: 40, module: 2 mm, face_width: 14 mm}}
tolerances:
  lean: {{kind: perpendicularity, of: housing.left, datums: [floor], zone: {{width: 0.1 mm}}, law: {{kind: uniform}}}}
  pos: {{kind: position, of: housing.b, datums: [floor, left], zone: {{diameter: 20 um}}, law: {{kind: uniform}}}}
moves:
  base: {{kind: fix, part: housing}}
  la: {{kind: shaft_in_bores, shaft: g, in: [housing.a]}}
  lb: {{kind: shaft_in_bores, shaft: w, in: [housing.b]}}
  mesh: {{kind: mesh, driver: g, driven: w}}
measures:
  c: {{kind: normal_backlash, of: mesh, read_at: mean_section}}
""",
        "utf-8",
    )
    run = run_scene(path, overrides=Overrides(trials=20_000, engine="analytic"), out=tmp_path / "run")
    own = run.summary["measures"]["c"]
    assert "analytic_closed_form" not in own
    shares = {each["name"]: each["analytic_percent"] for each in own["contributors"]}
    columns = run.columns()
    # by switching off: the position alone has t/4 at both ends, halved in the middle, times 2 sin(alpha_w)
    alone = (2 * np.sqrt(1 - (60 * np.cos(np.radians(20)) / APART) ** 2) * 20 / 4 / np.sqrt(2)) ** 2
    expected = 100 * alone / columns["analytic:c"].var()
    assert shares["pos"] == pytest.approx(expected, abs=1.5)
    assert shares["lean"] > 75
