"""Centres of gears that lie off the axis on which they turn."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from tol3d.gearing.effects.effect import Effect
from tol3d.gearing.effects.plane import AS_COUNTED, Plane

if TYPE_CHECKING:
    from tol3d.gearing.model.mesh import Mesh


@dataclass(frozen=True)
class TurningOffset(Effect):
    """Offset (x, y) [mm] of a gear's centre from its rotation axis, in the gear's frame; it turns with the gear."""

    part: str
    plane: Plane = AS_COUNTED

    def acts_in(self, mesh: "Mesh") -> bool:
        """In every mesh of the gear."""
        return self.part in (mesh.driver, mesh.driven)

    @property
    def turns_with(self) -> str:
        """The gear."""
        return self.part

    @property
    def mirrored(self) -> bool:
        """As its plane is."""
        return self.plane.mirrored
