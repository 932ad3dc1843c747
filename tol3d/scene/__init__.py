"""What the user wrote: a scene file, read strictly, with the place of everything in it."""

from tol3d.scene.load import load_scene, scene_from_python
from tol3d.scene.schema import Scene

__all__ = ["Scene", "load_scene", "scene_from_python"]
