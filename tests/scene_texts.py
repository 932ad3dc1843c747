"""Scenes as texts: edits of them, and the messages by which they are refused."""

import re
from pathlib import Path

import pytest

from tol3d.errors import InputError
from tol3d.scene import Scene
from tol3d.simulate import Overrides, load, simulation_of

Edit = tuple[str, str]


def edited(text: str, *edits: Edit) -> str:
    """A text in which the first of each old is a new; every old must be there."""
    for old, new in edits:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text


def written(text: str, folder: Path) -> Path:
    """The file of a scene."""
    path = folder / "scene.yaml"
    path.write_text(text, "utf-8")
    return path


def scene_of(text: str, folder: Path) -> Scene:
    """A scene that is written as a text."""
    return load(written(text, folder))


def refusal_at(text: str, folder: Path) -> str:
    """Refusal of a scene, as it is read or made a simulation: `line: place: words`, a line for each fault."""
    path = written(text, folder)
    with pytest.raises(InputError) as caught:
        simulation_of(load(path), Overrides())
    return str(caught.value).replace(f"{path}:", "")


def refusal(text: str, folder: Path) -> str:
    """The same without the number of the line: `place: words`."""
    return re.sub(r"^\d+: ", "", refusal_at(text, folder), flags=re.MULTILINE)
