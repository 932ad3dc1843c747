"""Kinds of part, one file each."""

from typing import Annotated

from pydantic import Field

from tol3d.gearing.grammar.parts.arm import ArmSpec
from tol3d.gearing.grammar.parts.bearing import BearingSpec
from tol3d.gearing.grammar.parts.bevel_gear import BevelGearSpec
from tol3d.gearing.grammar.parts.gear import GEARS, GearSpec
from tol3d.gearing.grammar.parts.housing import HousingSpec
from tol3d.gearing.grammar.parts.shaft import CarriedSpec, ShaftSpec, gears_on
from tol3d.gearing.grammar.parts.spur_gear import SpurGearSpec
from tol3d.scene.part import PartSpec

PartUnion = Annotated[
    SpurGearSpec | BevelGearSpec | HousingSpec | ShaftSpec | BearingSpec | ArmSpec, Field(discriminator="kind")
]

__all__ = [
    "GEARS",
    "ArmSpec",
    "BearingSpec",
    "BevelGearSpec",
    "CarriedSpec",
    "GearSpec",
    "HousingSpec",
    "PartSpec",
    "PartUnion",
    "ShaftSpec",
    "SpurGearSpec",
    "gears_on",
]
