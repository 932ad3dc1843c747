"""What one entry of a scene says about another: a name that must exist, and be of the right sort."""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Final, Literal

from tol3d.scene.place import KeyPath

Sort = Literal[
    "spur_gear", "bevel_gear", "housing", "shaft", "bearing", "arm", "mesh", "bevel_mesh", "reducer", "train"
]

SORT_WORDS: Final[dict[Sort, str]] = {
    "spur_gear": "a spur gear",
    "bevel_gear": "a bevel gear",
    "housing": "a housing",
    "shaft": "a shaft",
    "bearing": "a bearing",
    "arm": "an arm",
    "mesh": "a mesh of spur gears",
    "bevel_mesh": "a bevel mesh",
    "reducer": "a reducer",
    "train": "a train",
}

SHAFTS: Final[tuple[Sort, ...]] = ("shaft", "spur_gear", "bevel_gear")


TOGETHER: Final[dict[frozenset[Sort], str]] = {
    frozenset(("spur_gear", "bevel_gear")): "a gear",
    frozenset(("mesh", "bevel_mesh")): "a mesh move",
}


def sorts_text(sorts: Collection[Sort]) -> str:
    """What may stand there, in words.

    >>> sorts_text(("spur_gear", "bevel_gear", "housing"))
    'a gear or a housing'
    """
    left, words = set(sorts), []
    for several, word in TOGETHER.items():
        if several <= left:
            words.append(word)
            left -= several
    return " or ".join([*words, *(SORT_WORDS[sort] for sort in sorts if sort in left)])


@dataclass(frozen=True)
class Reference:
    """A name that an entry uses.

    Args:
        path: the field that holds it, from the entry on.
        name: the name.
        sorts: what it may be the name of.
    """

    path: KeyPath
    name: str
    sorts: tuple[Sort, ...]

    @property
    def expected(self) -> str:
        """What it may be the name of, in words."""
        return sorts_text(self.sorts)


@dataclass(frozen=True)
class ShaftReference(Reference):
    """The name of what turns as one: a shaft, or a gear that is its own because none carries it."""

    sorts: tuple[Sort, ...] = SHAFTS

    @property
    def expected(self) -> str:
        """As of any reference."""
        return "a shaft, or of a gear that none carries"


@dataclass(frozen=True)
class Contradiction:
    """Entries that exist and do not fit each other.

    Args:
        path: the field to mend, from the entry on.
        expected: what would do.
        got: what came.
        known: words that would do, for the hint.
    """

    path: KeyPath
    expected: str
    got: str
    known: tuple[str, ...] = ()
