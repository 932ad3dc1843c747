"""Kinds of builder, which make solids of dimensions."""

from typing import Annotated

from pydantic import Field

from tol3d.assembly.grammar.builders.builder_spec import BuilderSpec, OwnFileSpec
from tol3d.assembly.grammar.builders.linkage_parts import (
    BallScrewSpec,
    BallSocketSpec,
    CastLinkSpec,
    NutSpec,
    RodSpec,
    SphericalGearSpec,
    ThrustRingSpec,
)
from tol3d.assembly.grammar.builders.machined import BlockSpec, BracketSpec, CoverSpec, HousingSpec, PlateSpec

BuilderUnion = Annotated[
    PlateSpec
    | BlockSpec
    | BracketSpec
    | HousingSpec
    | CoverSpec
    | CastLinkSpec
    | RodSpec
    | BallSocketSpec
    | NutSpec
    | BallScrewSpec
    | ThrustRingSpec
    | SphericalGearSpec
    | OwnFileSpec,
    Field(discriminator="kind"),
]

__all__ = [
    "BallScrewSpec",
    "BallSocketSpec",
    "BlockSpec",
    "BracketSpec",
    "BuilderSpec",
    "BuilderUnion",
    "CastLinkSpec",
    "CoverSpec",
    "HousingSpec",
    "NutSpec",
    "OwnFileSpec",
    "PlateSpec",
    "RodSpec",
    "SphericalGearSpec",
    "ThrustRingSpec",
]
