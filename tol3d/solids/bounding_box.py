"""The box around a solid, along the axes of its part; cached, as meshes are."""

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.solids.built_shape import BuiltShape
from tol3d.solids.cache import cached
from tol3d.solids.lazy import Arrays, cad


def bounding_box(shape: BuiltShape) -> tuple[Array, Array]:
    """Lowest and highest x, y, z (3,) [mm] of a solid, to about 1e-6 mm.

    Raises:
        GeometryError: the solid cannot be built.
    """

    def build() -> Arrays:
        return {"corners": np.array(cad().box_around(shape))}

    low, high = cached("box", shape, {}, build)["corners"].astype(np.float64)
    return low, high
