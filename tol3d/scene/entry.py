"""Common base of the entries of a scene's sections: a kind, the names and files that it uses.

Reference of one entry of a scene to another: a name that must exist, and be of the right kind.
"""

from abc import ABC
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, get_args

from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath
from tol3d.strict import Strict

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


class Entry(Strict, ABC):
    """A part, tolerance, move or measure as a scene writes it.

    A class whose `kind` is a literal is a kind, which a vocabulary registers; one without is what several kinds have
    in common. `words` says in messages what an entry is, and of a common class what its kinds are together.
    `shared` lets several vocabularies have the kind, each with a meaning of its own. `requires` names distributions
    whose versions decide the results of scenes with such an entry, beside those of its mechanism.
    """

    words: ClassVar[str] = ""
    shared: ClassVar[bool] = False
    requires: ClassVar[tuple[str, ...]] = ()

    kind: str

    @classmethod
    def lacking(cls) -> Iterator[str]:
        """Missing requirements of the kind besides its words, such as code, in words; by default none."""
        return iter(())

    def references(self) -> tuple[Reference, ...]:
        """Every name that the entry uses; many use none."""
        return ()

    def file_names(self) -> Iterator[tuple[KeyPath, str]]:
        """Every file that the entry reads, with the field that names it; most read none."""
        return iter(())

    def contradictions(self, parts: Mapping[str, Any], moves: Mapping[str, Any]) -> Iterator[Contradiction]:
        """Conflicts with the PartSpecs and MoveSpecs that it names; called only when every name exists."""
        return iter(())


class AboutOne(Entry):
    """An entry about one other, which it names; `applies_to` says of which kinds that may be."""

    applies_to: ClassVar[tuple[type[Entry], ...]]

    of: Name

    def references(self) -> tuple[Reference, ...]:
        """The entry that it is about."""
        return (Reference(("of",), self.of, self.applies_to),)


def kind_of(spec: type[Entry]) -> str | None:
    """The word of a kind in scenes; None for a class that several kinds have in common."""
    words = get_args(spec.model_fields["kind"].annotation)
    return words[0] if words else None
