"""Gears that sit turned on their shafts."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from tol3d.gearing.effects.effect import Effect

if TYPE_CHECKING:
    from tol3d.gearing.model.mesh import Mesh


@dataclass(frozen=True)
class Clocking(Effect):
    """Turn of a gear on its shaft [rad], about its own z."""

    part: str

    def acts_in(self, mesh: "Mesh") -> bool:
        """A mesh finds its rest for any turn of its gears; the shafts turn, see `clocking`."""
        return False

    def clocking(self, mesh: "Mesh") -> float:
        """A driver that sits ahead takes the driven gear with it; a driven gear ahead leaves its shaft behind."""
        return float(mesh.rate) * (self.part == mesh.driver) - (self.part == mesh.driven)
