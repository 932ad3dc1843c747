"""Kinds of move, one file each."""

from tol3d.assembly.grammar.moves.best_fit import BestFitSpec
from tol3d.assembly.grammar.moves.fix import FixSpec
from tol3d.assembly.grammar.moves.locating import LocatingSpec, SixPlaneSpec, ThreeTwoOneSpec
from tol3d.assembly.grammar.moves.mate import MateSpec
from tol3d.assembly.grammar.moves.placing_move import PlacingSpec
from tol3d.assembly.grammar.moves.play import PatternSpec, PinAndHoleSpec, PlaySpec
from tol3d.assembly.grammar.moves.rest import RestSpec
from tol3d.assembly.grammar.moves.stated_move import StatedMoveSpec
from tol3d.assembly.grammar.moves.touch import TouchSpec
from tol3d.assembly.grammar.moves.weld import WeldSpec

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
