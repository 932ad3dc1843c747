"""Bodies of a mechanism's own shapes."""

import numpy as np
from numpy.typing import NDArray

from tol3d.report.body import Body
from tol3d.solids import BuiltShape, PosedShape, surface_of


def built_body(
    name: str, shape: BuiltShape, world_from_part: NDArray[np.float64], colour: str, *, deflection: float
) -> Body:
    """A shape as it is shown, and exported to any format, where it stands.

    Args:
        name: the part's.
        shape: what is built.
        world_from_part: its pose (4, 4), rotation and translation [mm].
        colour: "#RRGGBB".
        deflection: how far its triangles may lie off its faces [mm].
    """
    posed = PosedShape(name, shape, world_from_part)
    return Body(name, world_from_part, lambda: surface_of(shape, deflection), lambda: posed, colour)
