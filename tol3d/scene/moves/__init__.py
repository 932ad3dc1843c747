"""Kinds of assembly move, one file each."""

from tol3d.scene.moves.mesh import MeshSpec
from tol3d.scene.moves.move import MoveSpec

MoveUnion = MeshSpec  # pydantic takes a discriminator from the second kind on

__all__ = ["MeshSpec", "MoveSpec", "MoveUnion"]
