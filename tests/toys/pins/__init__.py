"""A disc between pins: several parts that are solved together. What is free between them is a minimum over contacts,
and where the disc may slide is what two load paths leave, which is a linear programme.

    grammar     what scenes say
    system      all that a study asks, both methods
    programme   the slow reference: each trial by scipy's linprog
"""

from typing import Final

from tol3d.study.system.mechanism import Mechanism
from toys.pins import grammar

PINS: Final = Mechanism(
    name="pins",
    parts=(grammar.DiscSpec, grammar.PlateSpec),
    tolerances=(grammar.RoomSpec, grammar.PinSpec, grammar.OffCentreSpec),
    moves=(grammar.DiscInPinsSpec,),
    measures=(grammar.LeastGapSpec, grammar.SlideSpec),
    system="toys.pins.system:pins_system",
)
