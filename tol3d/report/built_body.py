"""Bodies of a mechanism's own shapes."""

import numpy as np
from numpy.typing import NDArray

from tol3d.report.body import Body, Surface
from tol3d.solids import BuiltShape, PosedShape, display_mesh


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

    def surface() -> Surface:
        mesh = display_mesh(shape, deflection)
        return mesh.vertices, mesh.triangles

    return Body(name, world_from_part, surface, lambda: PosedShape(name, shape, world_from_part), colour)
