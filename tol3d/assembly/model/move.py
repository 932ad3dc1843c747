"""A move, and the import paths by which both methods carry it out."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from tol3d.import_path import is_named, named
from tol3d.numerics.values import Valued


@dataclass(frozen=True)
class Acts:
    """A kind of move: its two methods, each by an import path `package.module:function`, and its words in tables.

    Args:
        words: its kind, such as "touch".
        lies: its words before the parts on which it lays a part, such as "touch on".
        placing: of a Move and the World before it, with all parts at their nominal poses, to a Placer.
        torsors: of a Move and the World of torsors before it to the World after it. With `has_room` or `rocks` also of
            a direction along its freedoms in which the part is pushed to the limit, None for the move's own.
        presents: of its Placer and the Assembly to further tables of `tol3d check`; "" for none.
        workspace: draws its workspace, see `tol3d.report.presenter.Mapped`; "" for none.
        has_room: True if it leaves a part within clearances, into which it may not fit; its Placer is a RoomPlacer.
        rocks: True if a part may rock on its contacts; its Placer is a RockingPlacer.
        closes_loops: True if it closes loops, which may stay open or close on another branch.
    """

    words: str
    lies: str
    placing: str
    torsors: str
    presents: str = ""
    workspace: str = ""
    has_room: bool = False
    rocks: bool = False
    closes_loops: bool = False

    def lacking(self) -> Iterator[str]:
        """Import paths that cannot be imported, as error texts."""
        paths = {"its placing": self.placing, "its torsors": self.torsors}
        paths |= {f"its {name}": own for name in ("presents", "workspace") if (own := getattr(self, name))}
        for name, path in paths.items():
            if not is_named(path):
                yield f"{name}: expected `package.module:function`, got {path!r}, where nothing is"


@dataclass(frozen=True, eq=False)
class Move(Valued, ABC):
    """A step that places one body or several at once against bodies that are placed, or joins some. It pickles.

    A body is a part and what is welded to it.

    Args:
        name: the scene's.
    """

    acts: ClassVar[Acts]

    name: str

    @cached_property
    def methods(self) -> tuple[object, ...]:
        """Both methods that carry it out, as they are defined now: a move by others is another one."""
        return named(self.acts.placing), named(self.acts.torsors)

    @property
    def beside(self) -> bytes:
        """See Valued: its methods, which it holds so that no other takes the place of one."""
        return repr([id(method) for method in self.methods]).encode()

    def __getstate__(self) -> dict[str, object]:
        return {name: own for name, own in super().__getstate__().items() if name != "methods"}

    @property
    @abstractmethod
    def parts(self) -> tuple[str, ...]:
        """Parts that it places, each with what is welded to it, in an order in which each lies on those before."""

    @property
    @abstractmethod
    def feature_pairs(self) -> Sequence[tuple[str, str]]:
        """Features by which it places them, of two bodies each: moving and target, or inner and outer."""

    @property
    def joined(self) -> tuple[str, ...]:
        """Placed parts that become one body, which is moved again by the name of the first; by default none."""
        return ()

    @property
    def carriers(self) -> tuple[str, ...]:
        """Part that each of `parts` lies on first; () where `feature_pairs` tell."""
        return ()

    @property
    def frames(self) -> Sequence[str]:
        """Names of the datum frames by which it takes the parts that it places; by default none."""
        return ()

    @property
    def terms(self) -> int:
        """Largest number of columns of nonlinear terms that it adds to the first order."""
        return 0

    @property
    def is_pushed(self) -> bool:
        """True if it pushes a part in a direction of a part; its Placer is a RoomPlacer."""
        return False

    @property
    def words(self) -> str:
        """By what it places them, for tables."""
        return ", ".join(dict.fromkeys(target for _, target in self.feature_pairs))

    @property
    def holds(self) -> Sequence[tuple[str, str]]:
        """Freedoms that it holds and by what, for tables, where its Placer does not list them."""
        return [(f"all six of {part}", self.words) for part in self.parts]


@dataclass(frozen=True, eq=False)
class PartMove(Move):
    """A move that places one body.

    Args:
        part: by whose name.
    """

    part: str

    @property
    def parts(self) -> tuple[str, ...]:
        return (self.part,)
