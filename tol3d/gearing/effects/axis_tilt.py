"""Axes that lean."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.effects.effect import Effect
from tol3d.gearing.effects.plane import AS_COUNTED, Plane, Vector

if TYPE_CHECKING:
    from tol3d.gearing.model.mesh import Mesh

Array = NDArray[np.float64]


@dataclass(frozen=True)
class AxisTilt(Effect):
    """Turn of a gear's axis: the deviation [rad] times `axis`, a unit vector of the gear's frame at rest.

    Planar (components x, y): the axis leans towards the vector as `plane` turns it, by the vector's length.
    `per_length` [1/mm] makes an angle of a deviation that is given as a length. The turn is about the point
    of the axis at z = `pivot` [mm] of that frame. It acts in all meshes of the gear, or in one only, in whose frame
    `axis` then is.
    """

    part: str
    axis: Vector = (0.0, 0.0, 0.0)
    per_length: float = 1.0
    pivot: float = 0.0
    mesh: str | None = None
    plane: Plane = AS_COUNTED

    def matrix(self, azimuth: float) -> Array:
        """Rotation vector per component where it is planar, (3, 2), in a frame whose x lies at an azimuth [rad]."""
        (xx, xy), (yx, yy) = self.plane.seen_from(azimuth).matrix
        return self.per_length * np.array([[-yx, -yy], [xx, xy], [0.0, 0.0]])

    def acts_in(self, mesh: "Mesh") -> bool:
        """In every mesh of the gear, or in the one that is named."""
        return self.mesh in (None, mesh.name) and self.part in (mesh.driver, mesh.driven)
