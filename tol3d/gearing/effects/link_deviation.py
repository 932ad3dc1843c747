"""Deviations of links that are no gear meshes, such as the backlash of a reducer."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from tol3d.gearing.effects.effect import Effect

if TYPE_CHECKING:
    from tol3d.gearing.model.mesh import Mesh


@dataclass(frozen=True)
class LinkDeviation(Effect):
    """A deviation of a link: what it does to the play is the link's own, see links/.

    Args:
        link: its name.
        turning: the part in the link with which the deviation turns; None where it rests.
    """

    link: str
    turning: str | None = None

    def acts_in(self, mesh: "Mesh") -> bool:
        """It moves no axis and no flank."""
        return False

    def acts_on(self, link: str) -> bool:
        """On that link."""
        return link == self.link

    @property
    def turns_with(self) -> str | None:
        """The part in the link."""
        return self.turning
