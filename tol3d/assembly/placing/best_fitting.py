"""Parts that are fitted to points."""

from dataclasses import dataclass

from tol3d.assembly.model import BestFit
from tol3d.assembly.placing.poses import Codes
from tol3d.assembly.placing.world import World
from tol3d.errors import InputError


@dataclass(frozen=True, eq=False)
class BestFitting:
    """A best fit."""

    move: BestFit

    def placed(self, world: World) -> tuple[World, Codes]:
        """The world after the move, and what became of it (n,)."""
        raise InputError(f"moves.{self.move.name}: a best fit is not placed exactly yet")


def best_fitting(move: BestFit, nominal: World) -> BestFitting:
    """A best fit."""
    return BestFitting(move)
