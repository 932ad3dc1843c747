"""A bar of square section as data; what builds it loads CadQuery, and this does not."""

from dataclasses import dataclass
from typing import ClassVar

from tol3d.cad.solids import BuiltShape


@dataclass(frozen=True)
class Bar(BuiltShape):
    """A square of a side [mm] in the first quadrant of x, y, from z = 0 to a length [mm]."""

    builder: ClassVar[str] = "toys.parabola.bar_solid:bar_solid"

    side: float
    length: float
