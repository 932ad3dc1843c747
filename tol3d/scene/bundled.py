"""The bundled scenes, found by their names."""

import os
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Final

from tol3d.errors import Problem, SceneError
from tol3d.scene.name import LONGEST_NAME
from tol3d.scene.nearest import nearest

PACKAGE: Final = "tol3d.scenes"
FOREIGN: Final = (".rexs",)


def bundled_scenes() -> Mapping[str, Path]:
    """The bundled scenes, by name."""
    brought = (Path(str(file)) for file in files(PACKAGE).iterdir())
    return {path.stem: path for path in sorted(brought) if path.suffix == ".yaml"}


def bundled_files() -> Mapping[str, Path]:
    """Bundled files of other systems that scenes are drafted from, such as gearboxes, by their whole names."""
    brought = (Path(str(file)) for file in files(PACKAGE).iterdir())
    return {path.name: path for path in sorted(brought) if path.suffix in FOREIGN}


def scene_path(scene: Path | str) -> Path:
    """A scene's file: the path itself, or the bundled scene of that name.

    Raises:
        SceneError: a bare name, and there is neither.
    """
    path, text = Path(scene), str(scene)
    if os.path.isfile(path) or path.suffix or len(path.parts) > 1:
        return path
    scenes = bundled_scenes()
    if text in scenes or os.path.exists(path):
        return scenes.get(text, path)
    listed = nearest(text, scenes) or f" (bundled scenes: {', '.join(scenes)})"
    raise SceneError(Problem.at(text[:LONGEST_NAME], f"no such file, and no scene of that name{listed}"))
