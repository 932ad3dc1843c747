"""Kinds of move that place parts of an assembly."""

from tol3d.assembly.grammar.moves.fix import FixSpec, WeldSpec
from tol3d.assembly.grammar.moves.locating import LocatingSpec, RestSpec, SixPlaneSpec, ThreeTwoOneSpec
from tol3d.assembly.grammar.moves.mate import BestFitSpec, MateSpec, TouchSpec
from tol3d.assembly.grammar.moves.placing_move import PlacingSpec
from tol3d.assembly.grammar.moves.play import PatternSpec, PinAndHoleSpec, PlaySpec
from tol3d.assembly.grammar.moves.stated_move import StatedMoveSpec

__all__ = [
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
    "StatedMoveSpec",
    "ThreeTwoOneSpec",
    "TouchSpec",
    "WeldSpec",
]
