"""Kinds of move that place parts of an assembly."""

from tol3d.assembly.grammar.moves.assembly_move import AssemblyMoveSpec, PlacingSpec
from tol3d.assembly.grammar.moves.locating import (
    FixSpec,
    LocatingSpec,
    RestSpec,
    SixPlaneSpec,
    ThreeTwoOneSpec,
    WeldSpec,
)
from tol3d.assembly.grammar.moves.mate import BestFitSpec, MateSpec, TouchSpec
from tol3d.assembly.grammar.moves.play import PatternSpec, PinAndHoleSpec, PlaySpec

__all__ = [
    "AssemblyMoveSpec",
    "BestFitSpec",
    "FixSpec",
    "LocatingSpec",
    "MateSpec",
    "PatternSpec",
    "PinAndHoleSpec",
    "PlacingSpec",
    "PlaySpec",
    "RestSpec",
    "SixPlaneSpec",
    "ThreeTwoOneSpec",
    "TouchSpec",
    "WeldSpec",
]
