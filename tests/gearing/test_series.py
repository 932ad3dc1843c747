"""Tooth thickness by DIN 3967 and centre distance by DIN 3964 in a scene."""

from dataclasses import replace
from pathlib import Path

import pytest
from scene_texts import edited, refusal_at, scene_of, written

from tol3d import check_scene
from tol3d.analyses.kept_changes import scene_with
from tol3d.analyses.response import response_of
from tol3d.analyses.stated_changes import Change
from tol3d.gears import SpurGear, SpurPair
from tol3d.simulate import simulation_of

PAIR = """
scene: spur stage of cd25
default_law: {kind: uniform}
parts:
  pinion: {kind: spur_gear, teeth: 20, module: 2 mm, face_width: 20 mm, profile_shift: 0.3}
  wheel: {kind: spur_gear, teeth: 41, module: 2 mm, face_width: 20 mm, profile_shift: 0.1}
tolerances:
  pinion thickness: {kind: tooth_thickness, of: pinion, distribution: {din_3967: cd25}}
  wheel thickness: {kind: tooth_thickness, of: wheel, distribution: {din_3967: 25 cd}}
  distance: {kind: centre_distance, of: pair, distribution: {din_3964: js7}}
moves:
  pair: {kind: mesh, driver: pinion, driven: wheel, centre_distance: 61.8 mm}
measures:
  backlash: {kind: normal_backlash, of: pair}
study: {trials: 100, seed: 1}
"""
PRINTED = 5e-4  # um


def test_a_public_stage_has_its_limits_and_its_backlash(tmp_path: Path) -> None:
    """m 2, 20/41, x 0.3/0.1: d 40 and 82 mm, so -54/-84 and -70/-110 um, and 131.244 to 219.448 um at 61.8 mm js7."""
    model = check_scene(written(PAIR, tmp_path)).model
    limits = {own.name: (own.distribution.low, own.distribution.high) for own in model.contributors}
    expected = {"pinion thickness": (-84, -54), "wheel thickness": (-110, -70), "distance": (-15, 15)}
    for name, ends in expected.items():
        assert limits[name] == pytest.approx([1e-3 * end for end in ends], abs=1e-12)
    pinion, wheel = (part.gear for part in model.gears)
    assert isinstance(pinion, SpurGear)
    assert isinstance(wheel, SpurGear)
    for end, said in ((1, 131.244), (0, 219.448)):
        thin_pinion = replace(pinion, tooth_thickness_deviation=1e-3 * expected["pinion thickness"][end])
        thin_wheel = replace(wheel, tooth_thickness_deviation=1e-3 * expected["wheel thickness"][end])
        distance = 61.8 + 1e-3 * expected["distance"][1 - end]
        assert 1e3 * SpurPair(thin_pinion, thin_wheel, distance).normal_backlash == pytest.approx(said, abs=PRINTED)


def test_a_moved_class_becomes_numbers(tmp_path: Path) -> None:
    scene = scene_of(PAIR, tmp_path)
    kept = scene_with(response_of(simulation_of(scene)), scene, [Change("wheel thickness", factor=0.5)])
    assert "of: wheel, distribution: -80/-100 um}" in kept.text
    assert kept.text.count("din_3967") == 1


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("of: wheel, dist", "of: wheel, measured: {span: 5}, dist", "a cylindrical gear, measured: arc, got another"),
        ("cd25}", "ce25}", "expected a, ab, b, bc, c, cd, d, e, f, g, h and 21 to 30, as in cd25, got 'ce25'"),
        ("js7}", '"7"}', "expected js5 to js11, got '7'"),
        ("{din_3964: js7}", "{din_3967: cd25}", "a cylindrical gear, measured: arc, got another"),
        ("teeth: 41, module: 2 mm", "teeth: 41, module: 300 mm", "at most 10000 mm, got 12300 mm"),
    ],
)  # fmt: skip
def test_what_has_no_limits_by_a_class_is_refused(tmp_path: Path, old: str, new: str, words: str) -> None:
    assert words in refusal_at(edited(PAIR, (old, new)), tmp_path)
