"""Deviations of links and gears that sit turned on their shafts displace no axis and no flank."""

from collections.abc import Iterator

from tol3d.gearing.displacements.displacement import Displacement, displacements
from tol3d.gearing.effects import Clocking, LinkDeviation
from tol3d.gearing.model import Model


@displacements.register(LinkDeviation)
@displacements.register(Clocking)
def _(effect: LinkDeviation | Clocking, model: Model, components: int) -> Iterator[Displacement]:
    """A mesh finds its rest for any turn of its gears; what the shafts turn by is in clocking.py."""
    return iter(())
