"""Kinds of assembly move, one file each."""

from tol3d.gearing.grammar.moves.bevel_mesh import BevelMeshSpec
from tol3d.gearing.grammar.moves.gear_mesh import GearMeshSpec, meshes_of
from tol3d.gearing.grammar.moves.link import LinkSpec
from tol3d.gearing.grammar.moves.mesh import MeshSpec
from tol3d.gearing.grammar.moves.reducer import ReducerSpec
from tol3d.gearing.grammar.moves.train import TrainSpec
from tol3d.scene.move import MoveSpec

__all__ = [
    "BevelMeshSpec",
    "GearMeshSpec",
    "LinkSpec",
    "MeshSpec",
    "MoveSpec",
    "ReducerSpec",
    "TrainSpec",
    "meshes_of",
]
