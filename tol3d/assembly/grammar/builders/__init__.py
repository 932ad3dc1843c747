"""Kinds of builder, which make solids of dimensions, one file each."""

from typing import Annotated

from pydantic import Field

from tol3d.assembly.grammar.builders.builder_spec import BuilderSpec
from tol3d.assembly.grammar.builders.own_file import OwnFileSpec
from tol3d.assembly.grammar.builders.plate import PlateSpec

BuilderUnion = Annotated[PlateSpec | OwnFileSpec, Field(discriminator="kind")]

__all__ = ["BuilderSpec", "BuilderUnion", "OwnFileSpec", "PlateSpec"]
