"""Linkages, as a mechanism: closed loops among the parts of assemblies and machines."""

from typing import Final

from tol3d.assembly.linkage.grammar.close_loop import CloseLoopSpec
from tol3d.study.system.mechanism import Mechanism

LOOPS: Final = ("linkage", "four_bar", "slider_crank", "parallel_robot", "hexapod", "closed_loop", "loop")

LINKAGE: Final = Mechanism(
    name="linkage",
    moves=(CloseLoopSpec,),
    extends=("assembly", "machine"),
    other_kinds=tuple((word, "write close_loop, with its joints") for word in LOOPS),
    starters="tol3d.assembly.linkage:starters",
)
