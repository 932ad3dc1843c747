"""Kinds of assembly move, one file each."""

from typing import Annotated

from pydantic import Field

from tol3d.scene.moves.bevel_mesh import BevelMeshSpec
from tol3d.scene.moves.gear_mesh import MESHES, GearMeshSpec
from tol3d.scene.moves.mesh import MeshSpec
from tol3d.scene.moves.move import MoveSpec
from tol3d.scene.moves.reducer import ReducerSpec
from tol3d.scene.moves.train import TrainSpec

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
