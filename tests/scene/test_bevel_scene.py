"""Scenes with bevel gears: what is refused, with place, numbers and what to do; and which way tolerances point."""

from pathlib import Path

import numpy as np
import pytest
from gear_trials import model_of_scene
from scene_texts import Edit, edited, refusal_at, scene_of

from tol3d import Overrides, run_scene
from tol3d.gearing.builds.build import build
from tol3d.gearing.model import Model, model_from_scene

SCENE = """
scene: bevel
parts:
  driver: {kind: bevel_gear, teeth: 17, module: 2 mm, face_width: 9 mm}
  driven: {kind: bevel_gear, teeth: 26, module: 2 mm, face_width: 9 mm}
tolerances:
  thin teeth: {kind: tooth_thickness, of: driven, distribution: {kind: constant, value: -0.1 mm}}
  other: {kind: axial_shift, of: driver, distribution: {kind: constant, value: 0 um}}
moves:
  pair: {kind: bevel_mesh, driver: driver, driven: driven, shaft_angle: 75 deg}
measures:
  play: {kind: normal_backlash, of: pair}
"""
OTHER = "kind: axial_shift, of: driver, distribution: {kind: constant, value: 0 um}"


def model_of(folder: Path, text: str) -> Model:
    (folder / "scene.yaml").write_text(text, "utf-8")
    return model_of_scene(folder / "scene.yaml")


WRONG = {
    "cones that do not close": (
        ("teeth: 26, module", "teeth: 26, pitch_angle: 45 deg, module"),
        "5: parts.driven.pitch_angle: the pitch cones do not roll: expected 46.6240 deg",
    ),
    "face beyond the apex": (
        ("teeth: 17, module: 2 mm, face_width: 9 mm", "teeth: 17, module: 2 mm, face_width: 36 mm"),
        "4: parts.driver: face_width: expected at most 32.1932 mm, 0.9 of the outer cone distance",
    ),
    "unequal modules": (
        ("teeth: 26, module: 2 mm", "teeth: 26, module: 2.25 mm"),
        "10: moves.pair: the gears of a pair need the same module, got 2 mm and 2.25 mm",
    ),
    "a mounting distance that interferes": (
        (OTHER, "kind: shim, of: driver, distribution: {kind: constant, value: 0.5 mm}"),
        "10: moves.pair: the teeth interfere at the mean build: play is -68.578 um there (nominal 0.000 um); nominal "
        "teeth with a common apex have no play: thin the teeth, or move the gears away from the apex",
    ),
    "profile shifts that do not cancel": (
        ("teeth: 17, module", "teeth: 17, profile_shift: 0.2, module"),
        "10: moves.pair: the profile shifts of a bevel pair must cancel",
    ),
    "a flat pitch cone": (("shaft_angle: 75 deg", "shaft_angle: 150 deg"), "10: moves.pair.shaft_angle: "),
    "no shaft angle at all": (
        ("shaft_angle: 75 deg", "shaft_angle: 0 deg"),
        "10: moves.pair.shaft_angle: expected a angle of more than zero",
    ),
    "a spur gear in a bevel mesh": (
        ("driven: {kind: bevel_gear", "driven: {kind: spur_gear"),
        "10: moves.pair.driven: expected the name of a bevel gear, got 'driven', which is a spur gear",
    ),
    "a centre distance": (("kind: bevel_mesh", "kind: mesh"), '10: moves.pair.shaft_angle: unknown key "shaft_angle"'),
    "a centre distance's tolerance": (
        (OTHER, "kind: centre_distance, of: pair, distribution: {kind: constant, value: 0 um}"),
        "8: tolerances.other.of: expected the name of a mesh of spur or "
        "helical gears, got 'pair', which is a bevel mesh",
    ),
    "warm bevel gears": (
        (OTHER, "kind: temperature, of: driver, distribution: {kind: constant, value: 20 K}"),
        "8: tolerances.other.of[0]: expected the name of a part that grows with temperature, got 'driver', which is a "
        "bevel gear",
    ),
    "a reading that is none": (
        ("normal_backlash, of: pair", "normal_backlash, of: pair, read_at: heel"),
        "12: measures.play.read_at: expected one of mean_section, face_contact, face, got 'heel'",
    ),
}


@pytest.mark.parametrize(("change", "words"), WRONG.values(), ids=WRONG.keys())
def test_one_wrong_thing_is_said_with_its_line_and_place(tmp_path: Path, change: Edit, words: str) -> None:
    assert words in refusal_at(edited(SCENE, change), tmp_path)


# where tolerances point ---------------------------------------------------------------------------------------

SIN, COS = np.sin(np.radians(75)), np.cos(np.radians(75))
REST = np.array([[-COS, 0.0, SIN], [0.0, -1.0, 0.0], [SIN, 0.0, COS]])  # x to the mesh, z from the apex to the heel
TOWARDS_MESH, UP, ALONG = REST.T
MEAN = 17 * 2 / 2 / np.sin(np.arctan2(SIN, 26 / 17 + COS)) - 4.5  # mean cone distance
DELTA1 = np.arctan2(SIN, 26 / 17 + COS)

# kind and fields, value [um or mrad]: shift [um] of driver and driven, turn [mrad] of both, in the world
MOVES = {
    "axial shift of the driven": ("axial_shift, of: driven", "40 um", (0 * UP, 40 * ALONG), (0 * UP, 0 * UP)),
    "face of the driver": ("mounting_face, of: driver", "40 um", (np.array([0, 0, 40.0]), 0 * UP), (0 * UP, 0 * UP)),
    "shim behind the driven": ("shim, of: driven", "40 um", (0 * UP, -40 * ALONG), (0 * UP, 0 * UP)),
    "shim in front of the driver": (
        "shim, of: driver, side: in_front",
        "40 um",
        (np.array([0, 0, 40.0]), 0 * UP),
        (0 * UP, 0 * UP),
    ),
    "clearance of the driven": (
        "bearing_clearance, of: driven",
        "40 um",
        (0 * UP, -20 * TOWARDS_MESH),
        (0 * UP, 0 * UP),
    ),
    "clearance of the driver": (
        "bearing_clearance, of: driver",
        "40 um",
        (np.array([-20.0, 0, 0]), 0 * UP),
        (0 * UP, 0 * UP),
    ),
    "axes offset": ("axes_offset, of: pair", "40 um", (0 * UP, np.array([0, 40.0, 0])), (0 * UP, 0 * UP)),
    "a larger shaft angle": ("shaft_angle, of: pair", "0.3 mrad", (0 * UP, 0 * UP), (0 * UP, np.array([0, 0.3, 0]))),
    "a larger shaft angle by the driver": (
        "shaft_angle, of: pair, tilts: driver",
        "0.3 mrad",
        (0 * UP, 0 * UP),
        (np.array([0, -0.3, 0]), 0 * UP),
    ),
    "a larger shaft angle by an arc": (
        "shaft_angle, of: pair",
        f"{0.3 * MEAN:.9f} um",
        (0 * UP, 0 * UP),
        (0 * UP, np.array([0, 0.3, 0])),
    ),
    "about the middle of the driver's face": (
        "shaft_angle, of: pair, tilts: driver, pivot: mean_plane",
        "0.3 mrad",
        (np.array([0.3 * MEAN * np.cos(DELTA1), 0, 0]), 0 * UP),
        (np.array([0, -0.3, 0]), 0 * UP),
    ),
}


@pytest.mark.parametrize("name", MOVES)
def test_a_tolerance_moves_what_it_says(name: str, tmp_path: Path) -> None:
    kind, value, shifts, turns = MOVES[name]
    text = SCENE.replace(OTHER, f"kind: {kind}, distribution: {{kind: constant, value: {value}}}")
    model = model_from_scene(scene_of(text, tmp_path))
    row = np.array([[contributor.distribution.mean for contributor in model.contributors]])
    made = build(model, row)
    for k, rest in enumerate((np.eye(3), REST)):
        # a turn about a point of the axis leaves 0.3e-3^2 times its distance to the second order: 2e-6 mm
        assert made.world_from_shaft[0, k, :3, 3] == pytest.approx(1e-3 * shifts[k], abs=4e-6)
        wx, wy, wz = 1e-3 * turns[k]
        turned = (np.eye(3) + np.array([[0, -wz, wy], [wz, 0, -wx], [-wy, wx, 0]])) @ rest
        assert np.abs(made.world_from_shaft[0, k, :3, :3] - turned).max() < 1e-7
        assert made.axis_turn[0, k] == pytest.approx(1e-3 * turns[k], abs=1e-12)


def test_the_tooth_force_pushes_the_gears_apart_and_around(tmp_path: Path) -> None:
    """Published for the mitre pair: 75.6 deg off the radial direction, 0.968 around and 0.249 apart."""
    mitre = SCENE.replace("teeth: 17", "teeth: 26").replace("75 deg", "90 deg")
    text = mitre.replace(
        OTHER,
        "kind: bearing_clearance, of: driven, direction: tooth_force, distribution: {kind: constant, value: 2 um}",
    )
    for flank, around in (("left", -1.0), ("right", 1.0)):
        model = model_of(tmp_path, text.replace("shaft_angle:", f"working_flank: {flank}, shaft_angle:"))
        made = build(model, np.array([[c.distribution.mean for c in model.contributors]]))
        shift = 1e3 * made.world_from_shaft[0, 1, :3, 3]
        # the driven gear's own x is the world's z, its y the world's -y; a left driver flank faces +y and pushes there
        assert shift == pytest.approx([0.0, -around * 0.968, -0.249], abs=5e-4)


def test_a_bevel_scene_runs_from_text_to_replay(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE, "utf-8")
    run = run_scene(tmp_path / "scene.yaml", overrides=Overrides(trials=3), out=tmp_path / "run")
    (value, *_), *_ = run.columns("geometric:play").values()
    # 0.1 mm of arc in the middle of the face leave cos(20 deg) of it, and chord errors
    assert value == pytest.approx(93.969, abs=0.1)
    assert run.summary["measures"]["play"]["reading"] == {"contact": "section", "gap": "section", "teeth": "all"}
