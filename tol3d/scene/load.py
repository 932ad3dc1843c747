"""From a scene's file to a checked Scene."""

from pathlib import Path

from pydantic import ValidationError

from tol3d.errors import SceneError
from tol3d.scene.problems import messages
from tol3d.scene.references import refuse_loose_ends
from tol3d.scene.schema import Scene
from tol3d.scene.text import read_scene_text


def load_scene(path: Path, *, trust_parts: bool = False) -> Scene:
    """Read a scene; this runs none of it and builds no geometry.

    Args:
        path: the YAML file.
        trust_parts: whether the scene may name files outside its own folder.

    Raises:
        SceneError: one or several messages `file:line: place: what was expected, what came`.
    """
    data, origin = read_scene_text(Path(path))
    try:
        scene = Scene.model_validate(data, context=origin)
    except ValidationError as error:
        raise SceneError(*messages(error, data, origin)) from None
    refuse_loose_ends(scene, trust_parts)
    return scene
