"""Axes that pass each other."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from tol3d.gearing.effects.effect import Effect

if TYPE_CHECKING:
    from tol3d.gearing.model.mesh import Mesh


@dataclass(frozen=True)
class AxesOffset(Effect):
    """Distance [mm] by which two axes that should meet pass each other: the driven one lies at +y of the mesh."""

    part: str
    mesh: str

    def acts_in(self, mesh: "Mesh") -> bool:
        """In that mesh."""
        return self.mesh == mesh.name
