"""A move of another mechanism that places bodies of an assembly, with its own placing by both methods."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tol3d.assembly.placing.plan import Placer
    from tol3d.assembly.placing.world import World as PlacedWorld
    from tol3d.assembly.torsors.world import World as TorsorWorld


class StatedMove(ABC):
    """Places one body or several at once against bodies that are placed. Frozen; it pickles, and has no equals."""

    @property
    @abstractmethod
    def name(self) -> str:
        """The scene's."""

    @property
    @abstractmethod
    def parts(self) -> tuple[str, ...]:
        """Parts that it places, each with what is welded to it, in an order in which each lies on those before."""

    @property
    @abstractmethod
    def carriers(self) -> tuple[str, ...]:
        """The part that each of them lies on first."""

    @property
    @abstractmethod
    def pairs(self) -> Sequence[tuple[str, str]]:
        """Features by which it places them: of a part that it places, and of one that is placed or that it places."""

    @property
    def frames(self) -> Sequence[str]:
        """Names of the datum frames by which it takes the parts that it places; by default none."""
        return ()

    @property
    def closes_loops(self) -> bool:
        """True if it closes loops, which may stay open or close on another branch."""
        return False

    @property
    def tables(self) -> str:
        """Import path of what makes tables of it for `tol3d check`; "" for none."""
        return ""

    @property
    def workspace(self) -> str:
        """Import path of what draws its workspace, see `tol3d.report.presenter.Mapped`; "" for none."""
        return ""

    @property
    def words(self) -> str:
        """By what it places them, for tables."""
        return ", ".join(dict.fromkeys(target for _, target in self.pairs))

    @abstractmethod
    def placing(self, nominal: "PlacedWorld") -> "Placer":
        """Placer of its parts by finite poses.

        Args:
            nominal: the world before it without deviations, all parts at their nominal poses.

        Raises:
            InputError: it cannot place them even nominally; the text begins with `moves.` and its name.
        """

    @abstractmethod
    def displaced(self, world: "TorsorWorld") -> "TorsorWorld":
        """The world after it to first order, worked out without `placing`."""
