"""General tolerances of a scene: which dimensions take them, and which keep their own."""

from pathlib import Path

import pytest
from scene_texts import scene_of

from tol3d import SceneError
from tol3d.report.check import drawn_limits
from tol3d.report.page import Table
from tol3d.statistics.standards import iso_2768

PLATE = """scene: plate
default_law: {kind: uniform}
general: mK
parts:
  plate:
    kind: solid
    features:
      A: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [100 mm, 60 mm]}
      bore: {kind: cylinder, at: [0 mm, 0 mm, 5 mm], axis: [0, 0, 1], length: 10 mm, diameter: 8 mm, hole: true}
      fitted: {kind: cylinder, at: [30 mm, 0 mm, 5 mm], axis: [0, 0, 1], length: 10 mm, diameter: 12 mm, hole: true}
      ball: {kind: sphere, at: [-30 mm, 0 mm, 9 mm], diameter: 40 mm}
tolerances:
  fitted size: {kind: size, of: plate.fitted, distribution: {fit: H7, of: 12 mm}}
  ball: {kind: profile, of: plate.ball, zone: {width: 0.1 mm}, law: {kind: uniform}}
moves: {bench: {kind: fix, part: plate}}
measures: {bore: {kind: inspected_size, of: plate.bore}, fitted: {kind: inspected_size, of: plate.fitted}}
"""
GEARS = """scene: gears
default_law: {kind: uniform}
general: c
parts:
  a: {kind: spur_gear, teeth: 24, module: 2 mm, face_width: 18 mm}
  b: {kind: spur_gear, teeth: 36, module: 2 mm, face_width: 18 mm}
moves: {mesh: {kind: mesh, driver: a, driven: b, centre_distance: 61 mm}}
measures: {play: {kind: normal_backlash, of: mesh}}
"""


def test_sizes_without_a_tolerance_take_it_and_others_keep_theirs(tmp_path: Path) -> None:
    """Limits by ISO 2768-1, Table 1: 8 mm, class m: 0.2 mm."""
    scene = scene_of(PLATE, tmp_path)
    assert list(scene.tolerances) == ["fitted size", "ball", "size of plate bore"]
    assert scene.origin.general == ("size of plate bore",)
    law = scene.distributed["size of plate bore"].distribution.resolve(scene.files)
    assert law.limits == (-0.2, 0.2)
    page = drawn_limits(scene)
    (table,) = (own for own in page if isinstance(own, Table))
    assert [row.label for row in table.rows] == ["fitted size", "size of plate bore"]
    said = " ".join(str(own) for own in page)
    assert "taken by dimensions without one of their own: size of plate bore" in said
    assert "class K of ISO 2768-2" in said
    again = scene.with_({"study.seed": 3})
    assert again.origin.general == scene.origin.general
    assert list(scene.with_({"general": "f"}).tolerances) == list(scene.tolerances)


def test_a_centre_distance_takes_it(tmp_path: Path) -> None:
    """61 mm, class c: 0.8 mm."""
    scene = scene_of(GEARS, tmp_path)
    (name,) = scene.origin.general
    assert scene.distributed[name].distribution.resolve(scene.files).limits == (-0.8, 0.8)
    own = GEARS + "tolerances: {own: {kind: centre_distance, of: mesh, distribution: ±0.02 mm}}\n"
    assert list(scene_of(own, tmp_path).tolerances) == ["own"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("general: mK", "general: zK", "general: expected classes of ISO 2768 such as m or mK, got 'zK'"),
        ("general: mK", "general: ISO 22081", "got 'ISO 22081'; write a profile"),
        ("default_law: {kind: uniform}\n", "", "default_law"),
        ("{fit: H7, of: 12 mm}", "{general: m}", "either `of`, the nominal size, or `leg` of an angle, got neither"),
    ],
)
def test_what_makes_no_sense_is_refused_in_a_line(tmp_path: Path, old: str, new: str, words: str) -> None:
    with pytest.raises(SceneError, match=words):
        scene_of(PLATE.replace(old, new), tmp_path)


def test_angles_by_the_shorter_leg() -> None:
    """Table 3, in minutes: five ranges, f and m alike."""
    found = {own: [round(60 * iso_2768.angular(own, leg)) for leg in (10, 50, 120, 400, 401)] for own in "fmcv"}
    assert found["f"] == found["m"] == [60, 30, 20, 10, 5]
    assert found["c"] == [90, 60, 30, 15, 10]
    assert found["v"] == [180, 120, 60, 30, 20]
