"""Kinds of builder, which make solids of dimensions, one file each."""

from typing import Annotated

from pydantic import Field

from tol3d.assembly.grammar.builders.builder_spec import BuilderSpec, OwnFileSpec
from tol3d.assembly.grammar.builders.machined import BlockSpec, BracketSpec, CoverSpec, HousingSpec, PlateSpec

BuilderUnion = Annotated[
    PlateSpec | BlockSpec | BracketSpec | HousingSpec | CoverSpec | OwnFileSpec, Field(discriminator="kind")
]

__all__ = [
    "BlockSpec",
    "BracketSpec",
    "BuilderSpec",
    "BuilderUnion",
    "CoverSpec",
    "HousingSpec",
    "OwnFileSpec",
    "PlateSpec",
]
