"""Kinds of part, one file each."""

from typing import Annotated

from pydantic import Field

from tol3d.scene.parts.arm import ArmSpec
from tol3d.scene.parts.bearing import BearingSpec
from tol3d.scene.parts.bevel_gear import BevelGearSpec
from tol3d.scene.parts.gear import GEARS, GearSpec
from tol3d.scene.parts.housing import HousingSpec
from tol3d.scene.parts.part import PartSpec
from tol3d.scene.parts.shaft import CarriedSpec, ShaftSpec, gears_on
from tol3d.scene.parts.spur_gear import SpurGearSpec

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
