"""What the user wrote: a scene file, read strictly, with the place of everything in it."""

from tol3d.scene.grammar import Grammar, Vocabulary
from tol3d.scene.load import read_scene, scene_from_python
from tol3d.scene.schema import Scene

__all__ = ["Grammar", "Scene", "Vocabulary", "read_scene", "scene_from_python"]
