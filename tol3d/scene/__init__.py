"""What the user wrote: a scene file, read strictly, with the place of everything in it."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tol3d.scene.load import load_scene, scene_from_python
    from tol3d.scene.schema import Scene

_HOMES = {
    "Scene": "tol3d.scene.schema",
    "load_scene": "tol3d.scene.load",
    "scene_from_python": "tol3d.scene.load",
}
"""Where each name lives: loaded when first used, for a mechanism's grammar imports its bases from here."""

__all__ = ["Scene", "load_scene", "scene_from_python"]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'tol3d.scene' has no attribute {name!r}")
