"""A rod whose tip strays the further the longer the rod is, and a mark on the tip that strays as far as the tip does:
contributors that read others.

    grammar     what scenes say; a stray tip may be written before the length that it reads
    system      the draws, and one measure: length + tip + mark
"""

from typing import Final

from tol3d.study.system.mechanism import Mechanism
from toys.rods import grammar

RODS: Final = Mechanism(
    name="rods",
    parts=(grammar.RodSpec,),
    tolerances=(grammar.LengthToleranceSpec, grammar.TipSpec, grammar.MarkSpec),
    moves=(grammar.StandSpec,),
    measures=(grammar.ReachSpec,),
    system="toys.rods.system:rods_system",
)
