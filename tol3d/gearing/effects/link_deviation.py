"""Deviations of links that are no gear meshes, such as the backlash of a reducer."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from tol3d.gearing.effects.effect import Effect

if TYPE_CHECKING:
    from tol3d.gearing.model.mesh import Mesh


@dataclass(frozen=True)
class LinkDeviation(Effect):
    """A deviation of a link: what it does to the play is the link's own, see links/."""

    link: str

    def acts_in(self, mesh: "Mesh") -> bool:
        """It moves no axis and no flank."""
        return False

    def acts_on(self, link: str) -> bool:
        """On that link."""
        return link == self.link
