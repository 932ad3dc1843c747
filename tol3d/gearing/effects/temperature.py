"""Parts that are warmer or colder."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from tol3d.gearing.effects.effect import Effect

if TYPE_CHECKING:
    from tol3d.gearing.model.mesh import Mesh


@dataclass(frozen=True)
class Temperature(Effect):
    """Temperature of some parts above the reference 20 degC [K]; each grows by its own coefficient."""

    parts: tuple[str, ...]

    def acts_in(self, mesh: "Mesh") -> bool:
        """Where a gear of the mesh, or its housing, is one of them."""
        return not {mesh.driver, mesh.driven, mesh.housing}.isdisjoint(self.parts)
