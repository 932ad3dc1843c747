"""Linkages, as a mechanism: closed loops among the parts of assemblies and machines."""

from typing import Final

from tol3d.linkage.grammar.close_loop import CloseLoopSpec
from tol3d.system.mechanism import Mechanism

LINKAGE: Final = Mechanism(
    name="linkage",
    moves=(CloseLoopSpec,),
    extends=("assembly", "machine"),
    starters="tol3d.linkage:starters",
)
