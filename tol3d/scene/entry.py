"""Common base of the entries of a scene's sections: a kind, the names and files that it uses."""

from abc import ABC
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, get_args

from tol3d.scene.name import Name
from tol3d.scene.place import KeyPath
from tol3d.scene.reference import Contradiction, Reference
from tol3d.strict import Strict


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
