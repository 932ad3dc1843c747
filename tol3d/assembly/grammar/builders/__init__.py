"""Kinds of builder, which make solids of dimensions."""

from typing import Annotated

from pydantic import Field

from tol3d.assembly.grammar.builders.ball_screw import BallScrewSpec
from tol3d.assembly.grammar.builders.ball_socket import BallSocketSpec
from tol3d.assembly.grammar.builders.builder_spec import BuilderSpec, OwnFileSpec
from tol3d.assembly.grammar.builders.machined import BlockSpec, BracketSpec, CoverSpec, HousingSpec, PlateSpec
from tol3d.assembly.grammar.builders.nut import NutSpec
from tol3d.assembly.grammar.builders.rod import RodSpec
from tol3d.assembly.grammar.builders.spherical_gear import SphericalGearSpec
from tol3d.assembly.grammar.builders.thrust_ring import ThrustRingSpec

BuilderUnion = Annotated[
    PlateSpec
    | BlockSpec
    | BracketSpec
    | HousingSpec
    | CoverSpec
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
    "CoverSpec",
    "HousingSpec",
    "NutSpec",
    "OwnFileSpec",
    "PlateSpec",
    "RodSpec",
    "SphericalGearSpec",
    "ThrustRingSpec",
]
