"""Kinds of assembly move, one file each."""

from typing import Annotated

from pydantic import Field

from tol3d.gearing.grammar.moves.bevel_mesh import BevelMeshSpec
from tol3d.gearing.grammar.moves.gear_mesh import MESHES, GearMeshSpec
from tol3d.gearing.grammar.moves.mesh import MeshSpec
from tol3d.gearing.grammar.moves.reducer import ReducerSpec
from tol3d.gearing.grammar.moves.train import TrainSpec
from tol3d.scene.move import MoveSpec

MoveUnion = Annotated[MeshSpec | BevelMeshSpec | ReducerSpec | TrainSpec, Field(discriminator="kind")]

__all__ = [
    "MESHES",
    "BevelMeshSpec",
    "GearMeshSpec",
    "MeshSpec",
    "MoveSpec",
    "MoveUnion",
    "ReducerSpec",
    "TrainSpec",
]
