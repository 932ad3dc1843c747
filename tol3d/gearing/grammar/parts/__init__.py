"""Kinds of part, one file each."""

from tol3d.gearing.grammar.parts.arm import ArmSpec
from tol3d.gearing.grammar.parts.bearing import BearingSpec
from tol3d.gearing.grammar.parts.bevel_gear import BevelGearSpec
from tol3d.gearing.grammar.parts.gear import GearSpec
from tol3d.gearing.grammar.parts.housing import HousingSpec
from tol3d.gearing.grammar.parts.internal_gear import InternalGearSpec
from tol3d.gearing.grammar.parts.shaft import CarriedSpec, ShaftSpec, carried, gears_on
from tol3d.gearing.grammar.parts.spur_gear import SpurGearSpec
from tol3d.scene.part import PartSpec

__all__ = [
    "ArmSpec",
    "BearingSpec",
    "BevelGearSpec",
    "CarriedSpec",
    "GearSpec",
    "HousingSpec",
    "InternalGearSpec",
    "PartSpec",
    "ShaftSpec",
    "SpurGearSpec",
    "carried",
    "gears_on",
]
