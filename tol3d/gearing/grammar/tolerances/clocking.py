"""How a gear sits on its shaft."""

from typing import ClassVar, Literal

from tol3d.gearing.grammar.tolerances.gear_tolerance import GearToleranceSpec
from tol3d.units import Dimension


class ClockingSpec(GearToleranceSpec):
    """An angle: the gear is turned on its shaft, positive counter-clockwise about its own z.

    It takes nothing from one mesh's backlash. Where parallel ways meet, it shifts what one way leaves free against the
    others.
    """

    dimensions: ClassVar[tuple[Dimension, ...]] = ("angle",)

    kind: Literal["clocking"]
