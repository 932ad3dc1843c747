"""Axes that lie beside their place."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from tol3d.gearing.effects.effect import Effect
from tol3d.gearing.effects.plane import AS_COUNTED, Plane, Vector

if TYPE_CHECKING:
    from tol3d.gearing.model.mesh import Mesh


@dataclass(frozen=True)
class AxisOffset(Effect):
    """Shift of a gear's rotation axis [mm], in the gear's frame at rest.

    Scalar: `direction` (unit vector) times `factor` times the deviation. Planar (components x, y): `factor`
    times the vector as `plane` turns it. It acts in all meshes of the gear, or in one only, in whose frame
    `direction` then is.
    """

    part: str
    direction: Vector = (1.0, 0.0, 0.0)
    factor: float = 1.0
    mesh: str | None = None
    plane: Plane = AS_COUNTED

    def acts_in(self, mesh: "Mesh") -> bool:
        """In every mesh of the gear, or in the one that is named."""
        return self.mesh in (None, mesh.name) and self.part in (mesh.driver, mesh.driven)
