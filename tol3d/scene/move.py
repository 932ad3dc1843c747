"""Common base of every kind of assembly move."""

from abc import abstractmethod

from tol3d.scene.entry import Entry
from tol3d.scene.reference import Reference


class MoveSpec(Entry):
    """An assembly step as a scene writes it."""

    @abstractmethod
    def references(self) -> tuple[Reference, ...]:
        """Every name that the move uses."""
