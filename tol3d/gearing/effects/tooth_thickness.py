"""Teeth that are thicker or thinner."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from tol3d.gearing.effects.effect import Effect

if TYPE_CHECKING:
    from tol3d.gearing.model.mesh import Mesh


@dataclass(frozen=True)
class ToothThickness(Effect):
    """Deviation of the tooth thickness of a gear [mm], positive is thicker; half of it on each flank.

    Each flank turns out of its tooth by `turn` [rad/mm], and moves out along its normal by `offset` [mm/mm].
    """

    part: str
    turn: float
    offset: float = 0.0

    def acts_in(self, mesh: "Mesh") -> bool:
        """In every mesh of the gear."""
        return self.part in (mesh.driver, mesh.driven)
