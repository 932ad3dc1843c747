"""Reference of one entry of a scene to another: a name that must exist, and be of the right kind."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

from tol3d.scene.place import KeyPath

Spec = type[Any]
"""A class of Entry, which has words."""


def any_of(specs: Collection[Spec]) -> str:
    """Kinds that may stand there, in words: "a shaft or a housing"."""
    return " or ".join(dict.fromkeys(spec.words for spec in specs))


@dataclass(frozen=True)
class Unusable:
    """Why an entry of the right kind will not do.

    Args:
        why: text after its name in the message, such as "which 'shaft' carries".
        instead: the name that would do.
    """

    why: str
    instead: str


@dataclass(frozen=True)
class Reference:
    """A name that an entry uses.

    Args:
        path: the field that holds it, from the entry on.
        name: the name.
        specs: allowed kinds of the named entry, or common classes of several kinds.
    """

    path: KeyPath
    name: str
    specs: tuple[Spec, ...]

    @property
    def expected(self) -> str:
        """Expected kinds of the name, in words."""
        return any_of(self.specs)

    @classmethod
    def unusable(cls, parts: Mapping[str, Any]) -> Mapping[str, Unusable]:
        """PartSpecs that such a reference may not name though their kind would do."""
        return {}

    def advice(self, parts: Mapping[str, Any], moves: Mapping[str, Any]) -> str:
        """Remedy for a missing name, besides taking another; "" where nothing more is known.

        Args:
            parts, moves: the scene's; names that they use may be missing.
        """
        return ""


@dataclass(frozen=True)
class Contradiction:
    """Entries that exist and do not fit each other.

    Args:
        path: the field to mend, from the entry on.
        expected: allowed value.
        got: given value.
        known: words that would do, for the hint.
        leads: True if others may follow from it, which are reported once it is mended.
    """

    path: KeyPath
    expected: str
    got: str
    known: tuple[str, ...] = ()
    leads: bool = False
