"""Kinds of builder, which make solids of dimensions, one file each."""

from typing import Annotated

from pydantic import Field

from tol3d.assembly.grammar.builders.block import BlockSpec
from tol3d.assembly.grammar.builders.bracket import BracketSpec
from tol3d.assembly.grammar.builders.builder_spec import BuilderSpec
from tol3d.assembly.grammar.builders.cover import CoverSpec
from tol3d.assembly.grammar.builders.housing import HousingSpec
from tol3d.assembly.grammar.builders.own_file import OwnFileSpec
from tol3d.assembly.grammar.builders.plate import PlateSpec

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
