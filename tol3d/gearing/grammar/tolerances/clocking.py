"""How a gear sits on its shaft."""

from typing import TYPE_CHECKING, ClassVar, Literal

from tol3d.gearing.effects import Clocking
from tol3d.gearing.grammar.tolerances.gear_tolerance import GearToleranceSpec
from tol3d.gearing.grammar.tolerances.gearing_tolerance import Meaning
from tol3d.units import Dimension

if TYPE_CHECKING:
    from tol3d.gearing.model.contributor import Unit
    from tol3d.gearing.model.nominal import Nominal


class ClockingSpec(GearToleranceSpec):
    """An angle: the gear is turned on its shaft, positive counter-clockwise about its own z.

    It takes nothing from one mesh's backlash. Where parallel load paths join, it shifts the play of one against that of
    the others.
    """

    dimensions: ClassVar[tuple[Dimension, ...]] = ("angle",)

    kind: Literal["clocking"]

    def meaning(self, nominal: "Nominal") -> Meaning:
        """The gear turns on its shaft."""
        return Meaning(Clocking(self.of))

    @property
    def unit(self) -> "Unit":
        """Arc minutes, as backlash at shafts is read."""
        return "arcmin"
