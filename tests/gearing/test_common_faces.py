"""Gears that means shift along their axes: no common face is refused, a narrower one is told."""

from pathlib import Path

import pytest
from gear_trials import model_of_scene

from tol3d.errors import SceneError

SCENE = """\
scene: shifted
parts:
  pinion: {kind: helical_gear, teeth: 23, module: 1 mm, helix_angle: 30 deg, hand: right, face_width: 16 mm}
  wheel: {kind: helical_gear, teeth: 67, module: 1 mm, helix_angle: 30 deg, hand: left, face_width: 11 mm}
  one: {kind: shaft, carries: {pinion: {facing: backward}}}
  two: {kind: shaft, carries: {wheel: {}}}
tolerances:
%s
moves:
  pair: {kind: mesh, driver: pinion, driven: wheel, centre_distance: 52.1 mm}
measures:
  j: {kind: normal_backlash, of: pair}
study: {trials: 2, seed: 1}
"""


def warnings(tolerances: str, folder: Path) -> list[str]:
    """Warnings about the faces of a pair with these tolerances."""
    lines = [f"  t{k}: {{{own}}}" for k, own in enumerate(tolerances.splitlines())]
    (path := folder / "shifted.yaml").write_text(SCENE % "\n".join(lines))
    return [line for line in model_of_scene(path).warnings if "face" in line]


def shift(of: str, mm: float, kind: str = "axial_shift") -> str:
    """An axial shift of a part, uniform about its mean."""
    return f"kind: {kind}, of: {of}, distribution: {{kind: uniform, lower: {mm - 0.1} mm, upper: {mm + 0.1} mm}}"


@pytest.mark.parametrize(
    ("tolerances", "off"),
    [
        (shift("wheel", 13.5), "'t0' put it 13.5 mm off"),
        (shift("pinion", -20.0), "'t0' put it 20 mm off"),
        (f"{shift('one', 7.0)}\n{shift('two', 7.0)}", "'t0', 't1' put it 14 mm off"),  # the pinion faces backward
        (shift("two", 14.0, "mounting_face"), "'t0' put it 14 mm off"),
        (shift("two", 15.0, "shim"), "'t0' put it 15 mm off"),
    ],
)
def test_faces_that_do_not_overlap_are_refused(tolerances: str, off: str, tmp_path: Path) -> None:
    words = "moves.pair: expected 'wheel' less than 13.5 mm off 'pinion' along the axis, half of both faces, "
    with pytest.raises(SceneError) as told:
        warnings(tolerances, tmp_path)
    assert f"{words}got no common face: {off}" in str(told.value)


@pytest.mark.parametrize(
    ("tolerances", "width"),
    [
        (shift("wheel", 13.4), "0.1"),
        (shift("pinion", 8.0), "5.5"),
        (f"{shift('one', 8.0)}\n{shift('two', -5.0)}", "10.5"),  # 3 mm apart, where the wider face has 2.5 mm
    ],
)
def test_a_narrower_common_face_is_told(tolerances: str, width: str, tmp_path: Path) -> None:
    (told,) = warnings(tolerances, tmp_path)
    assert told.startswith(f"pair: the common face is {width} mm of 11 mm, for 't0'")
    assert told.endswith("the analytic method takes all of it")


@pytest.mark.parametrize(
    "tolerances",
    [
        shift("wheel", 2.5),
        f"{shift('one', -20.0)}\n{shift('two', 20.0)}",
        "kind: eccentricity, of: wheel, direction: {at: 20 deg}, distribution: {kind: constant, value: 20 um}",
    ],
)
def test_gears_within_the_wider_face_are_not_warned_of(tolerances: str, tmp_path: Path) -> None:
    assert warnings(tolerances, tmp_path) == []


TWO = """\
scene: two meshes between two shafts
parts:
  a: {kind: helical_gear, teeth: 23, module: 1 mm, helix_angle: 20 deg, hand: right, face_width: 10 mm}
  b: {kind: helical_gear, teeth: 40, module: 1 mm, helix_angle: 20 deg, hand: left, face_width: 10 mm}
  c: {kind: helical_gear, teeth: 23, module: 1 mm, helix_angle: 20 deg, hand: left, face_width: 10 mm}
  d: {kind: helical_gear, teeth: 40, module: 1 mm, helix_angle: 20 deg, hand: right, face_width: 8 mm}
  one: {kind: shaft, carries: {a: {}, c: {at: 20 mm}}}
  two: {kind: shaft, carries: {b: {}, d: {at: %s mm}}}
tolerances:
  t: {kind: tooth_thickness, of: a, distribution: {kind: constant, value: -60 um}}
moves:
  first: {kind: mesh, driver: a, driven: b, centre_distance: 33.6 mm}
  second: {kind: mesh, driver: c, driven: d, centre_distance: 33.6 mm}
  train: {kind: train, driven: one, output: two}
measures: {l: {kind: lost_motion, of: train}}
study: {trials: 10, seed: 1}
"""


@pytest.mark.parametrize(("at", "told"), [(29.0, True), (11.0, True), (28.99, False)])
def test_places_on_shafts_that_leave_no_common_face_are_told(at: float, told: bool, tmp_path: Path) -> None:
    """Faces 10 and 8 mm wide that lie 9 mm apart."""
    (path := tmp_path / "two.yaml").write_text(TWO % at)
    with pytest.raises(SceneError) as refused:
        model_of_scene(path)
    words = f"from where 'first' puts it, and 'c' and 'd' have no common face, {abs(at - 20):g} mm apart along the axis"
    assert (words in str(refused.value)) == told
    assert "moves.second: the load paths to 'two' do not fit: here it lies" in str(refused.value)
