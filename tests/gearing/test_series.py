"""Tooth thickness by DIN 3967 and centre distance by DIN 3964 in a scene."""

import itertools
import math
from dataclasses import replace
from pathlib import Path

import pytest
from scene_texts import edited, refusal_at, scene_of, written
from scipy.optimize import brentq

from tol3d import check_scene
from tol3d.analyses.kept_changes import scene_with
from tol3d.analyses.response import response_of
from tol3d.analyses.stated_changes import Change
from tol3d.gearing.summary.backlash_stages import backlash_stages
from tol3d.gearing.system import GearSystem
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


def test_the_table_of_backlash_has_the_words_of_drawings(tmp_path: Path) -> None:
    """By hand: cos alpha_w = 57.321 mm/61.8 mm; j_r from the involute; sigma of three uniform laws by their slopes."""
    model = check_scene(written(edited(PAIR, ("js7}", "js7, law: {kind: normal}}")), tmp_path)).model
    rows = {own.symbol: own for own in backlash_stages(model, GearSystem, "exact")}
    alpha, a = math.radians(20.0), 61.8
    base = 61.0 * math.cos(alpha)
    working = math.acos(base / a)
    normal, arc, reference = (rows[symbol] for symbol in ("j_bn", "j_wt", "j_t"))
    near = math.acos(base / (a - 0.015))
    for row, ends in (
        (normal, (1.0, 1.0)),
        (arc, (1 / math.cos(working), 1 / math.cos(working))),
        (reference, (1 / math.cos(alpha), 1 / math.cos(alpha))),
    ):
        found = (row.least_um, row.largest_um)
        assert found == pytest.approx((131.244 * ends[0], 219.448 * ends[1]), abs=PRINTED * 2)
    tight = brentq(lambda own: math.tan(own) - own - (math.tan(near) - near - 0.131244 / (2 * base)), 0.1, 0.6)
    assert rows["j_r"].least_um == pytest.approx(1e3 * (a - 0.015 - base / math.cos(tight)), abs=PRINTED * 4)
    nominal = 25.927  # um, without thinning
    mean = nominal + (69 + 90) * math.cos(alpha)
    slope = 2 * math.sin(working)
    sigma = math.sqrt(((15 * math.cos(alpha)) ** 2 + (20 * math.cos(alpha)) ** 2) / 3 + (slope * 5.0) ** 2)
    ends = (mean - 3 * sigma, mean + 3 * sigma)
    assert (normal.least_3sigma_um, normal.largest_3sigma_um) == pytest.approx(
        (max(ends[0], 131.244), min(ends[1], 219.448)), abs=0.03
    )


def test_the_table_of_a_helical_pair(tmp_path: Path) -> None:
    """A published stage, 23/67, m_n 1, beta 30 deg, c25 and js7: its calculator prints these limits.

    Its arcs are on the working circles of the least and the largest centre distance.
    """
    helix = "helix_angle: 30 deg, hand: "
    text = edited(
        PAIR,
        ("{kind: spur_gear, teeth: 20, module: 2 mm, face_width: 20 mm, profile_shift: 0.3",
         f"{{kind: helical_gear, {helix}right, teeth: 23, module: 1 mm, face_width: 16 mm, profile_shift: 0.55"),
        ("{kind: spur_gear, teeth: 41, module: 2 mm, face_width: 20 mm, profile_shift: 0.1",
         f"{{kind: helical_gear, {helix}left, teeth: 67, module: 1 mm, face_width: 11 mm, profile_shift: 0.5441135839"),
        ("din_3967: cd25", "din_3967: c25"), ("25 cd", "c25"), ("61.8 mm", "53 mm"),
    )  # fmt: skip
    rows = {own.symbol: own for own in backlash_stages(check_scene(written(text, tmp_path)).model, GearSystem, "exact")}
    assert (rows["j_bn"].least_um, rows["j_bn"].largest_um) == pytest.approx((129.629, 218.071), abs=PRINTED * 2)
    arcs = [own * 53 / (53 + off) for own, off in ((162.427, -0.015), (273.400, 0.015))]
    assert (rows["j_wt"].least_um, rows["j_wt"].largest_um) == pytest.approx(arcs, abs=PRINTED * 2)


def test_stages_add_what_is_stated_of_the_pair() -> None:
    """Each stage has the tolerances of those before it: the worst can only go further out."""
    rows = backlash_stages(check_scene("internal_pair").model, GearSystem, "analytic")
    own = [row for row in rows if row.symbol == "j_bn"]
    assert [row.stage for row in own] == ["theoretical", "acceptance", "operating"]
    for inner, outer in itertools.pairwise(own):
        assert outer.least_um is not None
        assert inner.least_um is not None
        assert inner.largest_um is not None
        assert outer.largest_um is not None
        assert outer.least_um < inner.least_um
        assert outer.largest_um >= inner.largest_um


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
