"""Flags of tolerances and datums in 3D: in the words of drawings, at the features and parts that a scene names."""

import re
import shutil
from pathlib import Path

import pytest
from places import SCENES

from tol3d.apps.workbench.flags import flags
from tol3d.apps.workbench.session import Session


def _flags(scene: str, folder: Path) -> dict[str, tuple[list[str], str]]:
    """Words by tolerance, with what they are of; of datums by the feature."""
    shutil.copy(SCENES / f"{scene}.yaml", folder)
    for file in re.findall(r"file: (\w+\.\w+)", (folder / f"{scene}.yaml").read_text("utf-8")):
        shutil.copy(SCENES / file, folder)
    session = Session.opened(folder / f"{scene}.yaml", trust_parts=False, run_builders=False)
    found = flags(session)
    assert {own["name"] for own in found} - {""} == {*session.scene.tolerances}
    return {own["name"] or own["of"][0]: (own["of"], own["words"]) for own in found}


def test_frames_of_a_drawing_have_signs_zones_and_datums(tmp_path: Path) -> None:
    found = _flags("bracket_in_box", tmp_path)
    assert found["box.A"] == (["box.A"], "datum")
    assert found["box C position"] == (["box.C"], "⌖ | ⌀0.508 mm | A | B")
    assert found["floor profile"] == (["box.D"], "⌓ | 1.016 mm | A | B | C")
    assert found["left hole position"] == (["box.left hole"], "⌖ | ⌀1.016 mm Ⓜ | A | B | C")
    assert found["left hole size"] == (["box.left hole"], "size -50.8 µm..304.8 µm")


def test_dimensions_have_their_direction_and_their_limits(tmp_path: Path) -> None:
    found = _flags("door", tmp_path)
    assert found["body upper hinge x"] == (["body.upper hinge"], "x ±450 µm")
    assert found["roof edge z"] == (["body.roof edge"], "z ±900 µm")


def test_tolerances_of_parts_and_moves_are_of_parts(tmp_path: Path) -> None:
    found = _flags("spur_pair", tmp_path)
    assert found["pinion tooth thickness"] == (["pinion"], "tooth thickness -30 µm..-19 µm")
    assert found["centre distance"] == (["pinion", "wheel"], "centre distance ±20 µm")
    assert found["pinion eccentricity"] == (["pinion"], "eccentricity σ 4.5 µm")


@pytest.mark.parametrize("scene", ["every_assembly_field", "every_field"])
def test_every_kind_of_tolerance_has_words_and_a_place(scene: str, tmp_path: Path) -> None:
    for name, (of, words) in _flags(scene, tmp_path).items():
        assert words, name
        assert of, name
