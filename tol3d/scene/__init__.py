"""What the user wrote: a scene file, read strictly, with the place of everything in it."""

from tol3d.scene.load import load_scene
from tol3d.scene.schema import Scene

__all__ = ["Scene", "load_scene"]
