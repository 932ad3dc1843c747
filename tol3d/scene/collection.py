"""The bundled scenes, a line each, and copied for their user to edit."""

from pathlib import Path

from tol3d.errors import InputError, unwritable
from tol3d.files import FileContent
from tol3d.scene.bundled import bundled_files, bundled_scenes
from tol3d.scene.grammar import Grammar
from tol3d.scene.load import read_scene
from tol3d.scene.nearest import hint


def scene_lines(grammar: Grammar) -> tuple[str, ...]:
    """A line for each bundled scene: the name to run it by, its own name, its description."""
    scenes = {name: read_scene(path, grammar, settle=False) for name, path in bundled_scenes().items()}
    width = max(map(len, scenes))
    lines = {
        name: ": ".join(part for part in (scene.scene, scene.description) if part) for name, scene in scenes.items()
    }
    return tuple(f"{name:<{width}}  {text}" for name, text in lines.items())


def copy_scene(name: str, folder: Path, grammar: Grammar) -> tuple[Path, ...]:
    """Copy a bundled scene and the files that it names into a folder, or a bundled file; nothing is overwritten.

    Args:
        name: of a scene, or of a file with its ending, such as planetary_stage.rexs.
        folder: to copy into.
        grammar: of scenes.

    Returns:
        the scene's file, and those that it names.

    Raises:
        InputError: no such scene, a file of that name is there, or the folder cannot be written.
    """
    scenes, others = bundled_scenes(), bundled_files()
    if name not in {*scenes, *others}:
        known = [*scenes, *others]
        raise InputError(f"expected the name of a bundled scene, got {name!r}{hint(name, known)}")
    if name in others:
        copies = {folder / name: FileContent(others[name], others[name].read_bytes())}
    else:
        scene = read_scene(scenes[name], grammar, settle=False)
        text = FileContent(scene.source, scene.source.read_bytes())
        copies = {folder / scenes[name].name: text} | {folder / own: file for own, file in scene.files.items()}
    there = next((path for path in copies if path.exists()), None)
    if there is not None:
        raise InputError(f"{there}: is there already; choose another folder, or move it away")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for path, file in copies.items():
            with path.open("xb") as stream:
                stream.write(file.content)
    except OSError as error:
        raise unwritable(folder, error, "choose another folder") from None
    return tuple(copies)
