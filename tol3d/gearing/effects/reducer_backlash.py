"""Backlash of reducers that are known by their data sheets."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from tol3d.gearing.effects.effect import Effect

if TYPE_CHECKING:
    from tol3d.gearing.model.mesh import Mesh


@dataclass(frozen=True)
class ReducerBacklash(Effect):
    """Angular backlash of a data-sheet reducer, at the shaft that it drives [rad]."""

    reducer: str

    def acts_in(self, mesh: "Mesh") -> bool:
        """A data sheet moves no axis and no flank."""
        return False

    def play_of(self, reducer: str) -> float:
        """All of it, of that reducer."""
        return 1.0 if reducer == self.reducer else 0.0
