"""What one entry of a scene says about another: a name that must exist, and be of the right sort."""

from dataclasses import dataclass
from typing import Final, Literal

from tol3d.scene.place import KeyPath

Sort = Literal["gear", "housing", "mesh"]

SORT_WORDS: Final[dict[Sort, str]] = {"gear": "a gear", "housing": "a housing", "mesh": "a mesh move"}


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
