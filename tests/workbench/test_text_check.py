"""A text that lies in no file is checked as the same file is: marks of errors and warnings, and no program runs."""

import json
from pathlib import Path

import pytest
from app_folders import BUILT
from fixtures import Command
from places import SCENES

from tol3d.apps.workbench.text_check import checked

TEXT = (SCENES / "spur_pair.yaml").read_text("utf-8")


def test_a_good_text_is_its_scene(tmp_path: Path) -> None:
    scene, errors, warnings = checked(TEXT, tmp_path / "scene.yaml")
    assert (errors, warnings) == ([], [])
    assert scene is not None
    assert scene.source == tmp_path / "scene.yaml"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("old", "new", "is_read"),
    [
        ("teeth: 28", "tooth: 28", False),
        ("driver: pinion", "driver: pinio", False),
        ("parts:", "parts: [", False),
        ("description:", "description: \ud800", False),
        ("lower: -20 um, upper: 20 um", "lower: -20 mm, upper: 20 mm", True),
        ("lower: -30 um, upper: -19 um", "lower: -9 mm, upper: -19 um", True),
        ("lower: -20 um, upper: 20 um", "lower: -2 mm, upper: 2 mm", True),
    ],
)
def test_marks_are_those_of_the_command(old: str, new: str, is_read: bool, tmp_path: Path, tol3d: Command) -> None:
    assert old in TEXT
    text, path = TEXT.replace(old, new, 1), tmp_path / "scene.yaml"
    scene, errors, warnings = checked(text, path)
    assert (scene is not None) == is_read
    assert errors or warnings
    path.write_bytes(text.encode("utf-8", "surrogatepass"))
    code, said, _ = tol3d("check", str(path), "--json")
    assert json.loads(said) == [*errors, *warnings]
    assert code == (2 if errors else 0)


def test_no_builder_runs(tmp_path: Path) -> None:
    (tmp_path / "ours.py").write_text("open('ran', 'w')\n", "utf-8")
    scene, errors, _ = checked(BUILT, tmp_path / "scene.yaml")
    assert scene is None
    assert "--run-builders" in str(errors)
    assert [own.name for own in tmp_path.iterdir()] == ["ours.py"]
