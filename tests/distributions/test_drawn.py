"""Limits as a drawing writes them: what they mean, with which law, and what is refused."""

import math
import pickle
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from places import ROOT
from scene_texts import scene_of

import tol3d
from tol3d import Scene
from tol3d.errors import InputError, SceneError
from tol3d.report.check import drawn_limits
from tol3d.report.page import Table
from tol3d.scene.bases import ToleranceSpec
from tol3d.statistics.distributions import Normal
from tol3d.statistics.distributions.normal import NormalSpec

SMALL = """scene: small
parts:
  a: {kind: spur_gear, teeth: 24, module: 2 mm, face_width: 18 mm}
  b: {kind: spur_gear, teeth: 36, module: 2 mm, face_width: 18 mm}
moves: {mesh: {kind: mesh, driver: a, driven: b, centre_distance: 60.2 mm}}
measures: {play: {kind: normal_backlash, of: mesh}}
"""
NORMAL = "default_law: {kind: normal, sigmas: 3}\n"


def load(folder: Path, text: str) -> Scene:
    return scene_of(text, folder)


def refusal(read: Callable[[], object]) -> str:
    with pytest.raises(SceneError) as caught:
        read()
    return str(caught.value)


def scene_with(folder: Path, distribution: str, head: str = NORMAL, kind: str = "tooth_thickness, of: a") -> Scene:
    text = f"{head}{SMALL}tolerances: {{t: {{kind: {kind}, distribution: {distribution}}}}}\n"
    return load(folder, text)


def law_of(scene: Scene) -> Normal:
    entry = scene.tolerances["t"]
    assert isinstance(entry, ToleranceSpec)
    law = entry.distribution.resolve(scene.files)
    assert isinstance(law, Normal)
    return law


@pytest.mark.parametrize(
    ("written", "lower_um", "upper_um"),
    [
        ("±0.1 mm", -100, 100),
        ("+-0.1 mm", -100, 100),
        ("+/-0.1mm", -100, 100),
        ("40.1 mm ±0.05", -50, 50),
        ("40.1 mm +0.12/0", 0, 120),
        ("40.1 mm +0.12/-0.03", -30, 120),
        ("40.1 mm -20 um / -36 um", -36, -20),
        ("-20/−36 um", -36, -20),
        ("0/-25 µm", -25, 0),
        ("[-19 um, -30 um]", -30, -19),
        ("[-30 um, -19 um]", -30, -19),
        ("4.134 in ±0.005", -127, 127),
        ("[-0.001 in, 0.002 in]", -25.4, 50.8),
        ("{fit: H7, of: 32 mm}", 0, 25),
        ("{fit: k6, of: 1.26 in}", 2, 18),
        ("{fit: js7, of: 60 mm}", -15, 15),
        ("{fit: zc8, of: 32 mm}", 274, 313),
        ("{general: m, of: 60 mm}", -300, 300),
        ("{limits: 40.1 mm +0.12/0}", 0, 120),
    ],
)
def test_limits_are_those_that_the_drawing_says(tmp_path: Path, written: str, lower_um: float, upper_um: float) -> None:
    law = law_of(scene_with(tmp_path, written))
    assert (law.low, law.high) == pytest.approx((lower_um / 1e3, upper_um / 1e3), abs=1e-12)
    assert law.mean == pytest.approx((lower_um + upper_um) / 2e3, abs=1e-12)
    assert law.sigma == pytest.approx((upper_um - lower_um) / 6e3, rel=1e-12)


def test_angles_are_limits_too(tmp_path: Path) -> None:
    text = f"{NORMAL}{SMALL}tolerances: {{t: {{kind: axis_in_plane, of: mesh, distribution: ±0.1 mrad}}}}\n"
    assert law_of(load(tmp_path, text)).high == pytest.approx(1e-4)


@pytest.mark.parametrize(
    ("law", "sigma_um"),
    [
        ("{kind: normal}", 25 / 6),
        ("{kind: normal, sigmas: 4}", 25 / 8),
        ("{kind: uniform}", 25 / 12**0.5),
        ("{kind: triangular}", 25 / 24**0.5),
        ("{kind: truncated_normal, sigmas: 3}", 25 / 6 * 0.98658),  # of a normal cut at 3 sigma
    ],
)
def test_the_named_law_decides_sigma(tmp_path: Path, law: str, sigma_um: float) -> None:
    by_default = scene_with(tmp_path, "{fit: H7, of: 32 mm}", f"default_law: {law}\n")
    own = scene_with(tmp_path, f"{{fit: H7, of: 32 mm, law: {law}}}", "")
    for scene in (by_default, own):
        entry = scene.tolerances["t"]
        assert isinstance(entry, ToleranceSpec)
        found = entry.distribution.resolve({})
        assert found.mean == pytest.approx(0.0125)
        assert found.sigma == pytest.approx(sigma_um / 1e3, rel=1e-5)


def test_clearance_of_h7_k6_has_the_sigma_of_both(tmp_path: Path) -> None:
    """H7 of 32 mm is 0 to 25 um, k6 is 2 to 18 um: 12.5 - 10 = 2.5 um of clearance, sigma the root of both squares."""
    hole, shaft = (law_of(scene_with(tmp_path, f"{{fit: {own}, of: 32 mm}}")) for own in ("H7", "k6"))
    assert (hole.high - shaft.low, hole.low - shaft.high) == pytest.approx((0.023, -0.018))
    assert hole.mean - shaft.mean == pytest.approx(0.0025)
    assert np.hypot(hole.sigma, shaft.sigma) == pytest.approx(np.hypot(25 / 6, 16 / 6) / 1e3)


@pytest.mark.parametrize(
    "written", ["±0.1 mm", "40.1 mm +0.12/0", "[-19 um, -30 um]", "{fit: H7, of: 32 mm}", "{general: m, of: 60 mm}"]
)
def test_scenes_are_dumped_as_drawn_and_load_again(tmp_path: Path, written: str) -> None:
    scene = scene_with(tmp_path, written)
    assert pickle.loads(pickle.dumps(scene)) == scene
    made = scene.model_copy(update={"description": "made in Python"})
    assert made.text == ""
    text = made.dump()
    assert written.strip("{}[]").split(",")[0] in text
    assert load(tmp_path, text).tolerances == scene.tolerances


def test_another_default_law_reads_the_limits_anew(tmp_path: Path) -> None:
    scene = scene_with(tmp_path, "±0.1 mm")
    changed = scene.with_({"default_law": {"kind": "normal", "sigmas": 6}})
    assert law_of(changed).sigma == pytest.approx(law_of(scene).sigma / 2)
    with pytest.raises(InputError, match=r"changed by scene\.with_"):
        scene.model_copy(update={"default_law": None})


def test_changed_limits_are_written_as_limits(tmp_path: Path) -> None:
    scene = scene_with(tmp_path, "±0.1 mm")
    changed = scene.with_({"tolerances.t.distribution": {"fit": "g6", "of": "32 mm"}})
    assert (law_of(changed).low, law_of(changed).high) == pytest.approx((-0.025, -0.009))
    entry = scene.tolerances["t"]
    assert isinstance(entry, ToleranceSpec)
    wider = entry.scaled(2.0, "middle", {})
    assert wider.distribution.drawn == "±0.2 mm"
    assert isinstance(wider.distribution, NormalSpec)
    assert str(wider.distribution.upper) == "0.2 mm"


@pytest.mark.parametrize(
    ("written", "words"),
    [
        ("±0.1", "expected a unit in it, such as ±0.1 mm, got '±0.1'"),
        ("±0.1 furlong", "unknown unit 'furlong'"),
        ("cd25", "expected {din_3967: cd25}, got cd25"),
        ("{din_3964: 7}", "distribution.din_3964: expected js5 to js11, got '7'"),
        ("{din_3967: 25}", "distribution.din_3967: expected a, ab, b, bc, c, cd, d, e, f, g, h and 21 to 30"),
        ("{kind: fixed, value: 1 um}", "got 'fixed'; write fix, or constant of a distribution"),
        ("±0.1 K", "expected a length with its unit"),
        ("+0.1/+0.1 mm", "expected two different limits"),
        ("[1 um]", "expected a lower and an upper limit, such as [-30 um, -19 um], got 1 values"),
        ("[1 um, 2 mrad]", "expected limits of one dimension, got 1 um and 2 mrad"),
        ("±x mm", 'expected limits such as "±0.1 mm"'),
        ("{fit: i7, of: 32 mm}", "distribution.fit: expected letters of ISO 286"),
        ("{fit: H7/k6, of: 32 mm}", "write hole and shaft each by itself"),
        ("{fit: H7}", 'expected the key "of" here'),
        ("{fit: H7, off: 32 mm}", 'unknown key "off"'),
        ("{fit: H7, of: 900 mm}", "expected a size above 0 and up to 500 mm of H7, got 900 mm"),
        ("{general: mK, of: 32 mm}", "write 'm', for K is of part 2"),
        ("{fit: H7, of: 32 mm, law: {kind: rayleigh}}", "distribution.law.kind: expected one of normal"),
    ],
)
def test_nonsense_is_refused_in_one_line(tmp_path: Path, written: str, words: str) -> None:
    said = refusal(lambda: scene_with(tmp_path, written))
    assert words in said
    assert len(said.splitlines()) == 1


def test_limits_without_a_law_are_refused_with_the_remedy(tmp_path: Path) -> None:
    said = refusal(lambda: scene_with(tmp_path, "±0.1 mm", ""))
    assert 'expected the key "default_law" of the scene, such as "default_law: {kind: normal, sigmas: 3}"' in said


def test_included_limits_are_read_by_the_scenes_law(tmp_path: Path) -> None:
    part = f"{SMALL}tolerances: {{t: {{kind: tooth_thickness, of: a, distribution: ±0.1 mm}}}}\n"
    (tmp_path / "inner.yaml").write_text(part, encoding="utf-8")
    outer = "scene: outer\ninclude: {in: inner.yaml}\n"
    included = load(tmp_path, f"default_law: {{kind: uniform}}\n{outer}").tolerances["in t"]
    assert isinstance(included, ToleranceSpec)
    assert included.distribution.kind == "uniform"
    (tmp_path / "inner.yaml").write_text(NORMAL + part, encoding="utf-8")
    assert "state the same default_law in both" in refusal(lambda: load(tmp_path, outer))


def test_the_page_shows_a_scene_that_loads_and_what_check_lists_of_it(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "dimensions.md").read_text(encoding="utf-8")
    text, general = re.findall(r"```yaml\n(.*?)```", page, re.DOTALL)
    assert load(tmp_path, general).origin.general == ("size of plate bore",)
    scene = load(tmp_path, text)
    assert all(own.distribution.drawn is not None for own in scene.distributed.values())
    table = next(own for own in drawn_limits(scene) if isinstance(own, Table))
    assert {row.label: tuple(str(cell) for cell in row.cells) for row in table.rows} == {
        "pinion tooth thickness": ("-19 µm to -30 µm", "-30 µm", "-19 µm", "normal"),
        "wheel tooth thickness": ("-21/-32 µm", "-32 µm", "-21 µm", "uniform"),
        "centre distance": ("js7 of 60.2 mm", "-15 µm", "15 µm", "normal"),
        "wheel bearing clearance": ("+16/+4 µm", "4 µm", "16 µm", "normal"),
        "wheel axial shift": ("ISO 2768-m of 60 mm", "-0.3 mm", "0.3 mm", "normal"),
        "axis in plane": ("±0.0002 in", "-0.0002 in", "0.0002 in", "normal"),
    }


SEAT = """
scene: bearing seat
default_law: {kind: normal, sigmas: 3}
parts:
  housing:
    kind: solid
    features:
      A: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [100 mm, 60 mm]}
      bore: {kind: cylinder, at: [0 mm, 0 mm, 10 mm], axis: [0, 0, 1], length: 20 mm, diameter: 32 mm, hole: true}
      pin: {kind: cylinder, at: [40 mm, 0 mm, 10 mm], axis: [0, 0, 1], length: 20 mm, diameter: 32 mm}
tolerances:
  bore: {kind: size, of: housing.bore, distribution: {fit: H7, of: 32 mm}}
  pin: {kind: size, of: housing.pin, distribution: {fit: k6, of: 32 mm}}
moves:
  bench: {kind: fix, part: housing}
measures:
  bore size: {kind: inspected_size, of: housing.bore}
  pin size: {kind: inspected_size, of: housing.pin}
study: {trials: 20000, seed: 1}
"""


def test_sizes_of_an_assembly_may_be_classes_too(tmp_path: Path) -> None:
    """H7/k6 of 32 mm, +25/0 and +18/+2 um: a mean clearance of 2.5 um, sigma 4.95 um by ±3 sigma of each."""
    own = tol3d.response(load(tmp_path, SEAT))
    sizes = own.values(*own.drawn(4000, seed=2)).values
    clearance = sizes[:, 0] - sizes[:, 1]
    sigma = math.hypot(25 / 6, 16 / 6)
    assert clearance.mean() == pytest.approx(2.5, abs=4 * sigma / math.sqrt(4000))
    assert clearance.std() == pytest.approx(sigma, rel=4 / math.sqrt(8000))
