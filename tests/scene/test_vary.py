"""Scenes varied in Python: what was asked for is changed, nothing else, and their text loads again."""

from pathlib import Path
from typing import Any

import pytest
from scene_texts import scene_of

from tol3d import InputError, SceneError, load_scene
from tol3d.scene import Scene
from tol3d.scene.bundled import bundled_scenes
from tol3d.scene.load import scene_of_text
from tol3d.simulate import load, run_scene, simulation_of
from tol3d.study.trials.overrides import Overrides

QUICK = ("spur_pair", "measured_teeth", "bolted_cover")

PAIR = """\
scene: a pair
parts:
  pinion: &gear {kind: spur_gear, teeth: 20, module: 2 mm, face_width: 15 mm}  # the small one
  wheel: {<<: *gear, teeth: 50}
tolerances:
  pinion thickness:
    kind: tooth_thickness
    of: pinion
    distribution: &thin {kind: normal, lower: -50 um, upper: -30 um}
  wheel thickness: {kind: tooth_thickness, of: wheel, distribution: *thin}
moves:
  pair: {kind: mesh, driver: pinion, driven: wheel, centre_distance: 70 mm}
measures:
  backlash: {kind: normal_backlash, of: pair}
"""


@pytest.fixture
def pair(tmp_path: Path) -> Scene:
    return scene_of(PAIR, tmp_path)


def content(scene: Scene) -> dict[str, Any]:
    return scene.model_dump(mode="json")


def _varied_and_dumped(name: str) -> None:
    scene = load(name)
    assert scene.dump() == scene.text
    other = scene.with_({"study.seed": 12345})
    assert content(other) == {**content(scene), "study": {**content(scene)["study"], "seed": 12345}}
    again = scene_of_text(other.source, other.dump().encode(), other.grammar, files=scene.files)
    assert content(again) == content(other)


@pytest.mark.parametrize("name", QUICK)
def test_a_bundled_scene_is_varied_and_dumped(name: str) -> None:
    """With its picks from solids and the files that it names; all but one field stays as it was."""
    _varied_and_dumped(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(set(bundled_scenes()) - set(QUICK)))
def test_every_bundled_scene_is_varied_and_dumped(name: str) -> None:
    _varied_and_dumped(name)


def test_a_field_is_changed_and_comments_stay(pair: Scene) -> None:
    other = pair.with_({"parts.pinion.teeth": 21, "moves.pair.centre_distance": "71 mm"})
    assert (content(other)["parts"]["pinion"]["teeth"], content(other)["moves"]["pair"]["centre_distance"]) == (
        21,
        "71 mm",
    )
    assert "# the small one" in other.text
    assert content(pair)["parts"]["pinion"]["teeth"] == 20


def test_what_an_alias_or_a_merge_shares_is_changed_in_one_place_alone(pair: Scene) -> None:
    other = pair.with_({"tolerances.wheel thickness.distribution.upper": "-20 um", "parts.wheel.module": "2.5 mm"})
    expected = content(pair)
    expected["tolerances"]["wheel thickness"]["distribution"]["upper"] = "-20 um"
    expected["parts"]["wheel"]["module"] = "2.5 mm"
    assert content(other) == expected


def test_what_others_are_aliases_of_is_changed_in_one_place_alone(pair: Scene) -> None:
    other = pair.with_({"tolerances.pinion thickness.distribution.upper": "-20 um"})
    expected = content(pair)
    expected["tolerances"]["pinion thickness"]["distribution"]["upper"] = "-20 um"
    assert content(other) == expected


def test_a_varied_scene_runs_as_its_file_would(pair: Scene, tmp_path: Path) -> None:
    other = pair.with_({"parts.pinion.teeth": 21, "moves.pair.centre_distance": "71 mm"})
    path = tmp_path / "other.yaml"
    path.write_text(other.dump(), encoding="utf-8")
    overrides = Overrides(trials=50, witness=0)
    runs = [
        run_scene(other, out=tmp_path / "own", overrides=overrides),
        run_scene(path, out=tmp_path / "file", overrides=overrides),
    ]
    own, from_file = (run.columns("geometric:backlash")["geometric:backlash"].tolist() for run in runs)
    assert own == from_file


def test_a_scene_made_in_python_is_varied_too(pair: Scene) -> None:
    made = type(pair).model_validate(pair.model_dump(mode="json", exclude_unset=True))
    assert made.text == ""
    assert content(made.with_({"study.trials": 7}))["study"]["trials"] == 7
    again = scene_of_text(made.source, made.dump().encode(), made.grammar)
    assert content(again) == content(made)


def test_an_entry_of_an_included_file_is_written_into_the_scene(tmp_path: Path) -> None:
    (tmp_path / "pair.yaml").write_text(PAIR, encoding="utf-8")
    scene = scene_of("scene: two\ninclude: {left: pair.yaml, right: pair.yaml}\n", tmp_path)
    field = "tolerances.left wheel thickness.distribution.upper"
    other = scene.with_({field: "-20 um"})
    expected = content(scene)
    expected["tolerances"]["left wheel thickness"]["distribution"]["upper"] = "-20 um"
    assert content(other) == expected
    assert other.files.keys() == scene.files.keys()
    twice = other.with_({field: "-25 um", "parts.right wheel.face_width": "16 mm"})
    expected["tolerances"]["left wheel thickness"]["distribution"]["upper"] = "-25 um"
    expected["parts"]["right wheel"]["face_width"] = "16 mm"
    assert content(twice) == expected
    simulation_of(twice)
    with pytest.raises(InputError, match="expected a move of the scene itself"):
        scene.with_({"moves.left pair.centre_distance": "71 mm"})


@pytest.mark.slow
def test_features_picked_from_a_solid_follow_its_size() -> None:
    """The plate of machined_parts is picked from its solid: a longer one has other numbers, built anew."""
    scene = load("machined_parts")
    name, part = next((name, own) for name, own in content(scene)["parts"].items() if "size" in (own["builder"] or {}))
    x, y, z = part["builder"]["size"]
    other = scene.with_({f"parts.{name}.builder.size[0]": f"{float(x.split()[0]) + 2:g} mm"})
    assert content(other)["parts"][name]["builder"]["size"][1:] == [y, z]
    assert content(other)["parts"][name]["features"] != part["features"]


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        (
            "tolerances.wheel thicknes.distribution.upper",
            "1 um",
            "got 'wheel thicknes'; did you mean \"wheel thickness\"",
        ),
        ("tolerances.wheel thickness.distribution.uper", "1 um", 'unknown key "uper"; did you mean "upper"'),
        ("tolerance.wheel thickness", 1, 'did you mean "tolerances"'),
        ("parts.wheel.teeth", "many", "parts.wheel.teeth: expected a whole number, got 'many'"),
        ("parts.wheel.teeth.x", 1, "expected no further key, for parts.wheel.teeth is 50"),
        ("parts.wheel[0]", 1, "expected"),
        ("", 1, "expected the name of a field"),
    ],
)
def test_a_wrong_field_or_value_is_refused_with_the_nearest_known(
    pair: Scene, field: str, value: Any, words: str
) -> None:
    with pytest.raises((InputError, SceneError)) as error:
        pair.with_({field: value})
    assert words in str(error.value)


def test_load_scene_gives_scenes_that_can_be_varied() -> None:
    assert load_scene("spur_pair").with_({"study.trials": 10}).study.trials == 10
