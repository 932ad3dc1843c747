"""What every kind of assembly move has in common."""

from abc import ABC, abstractmethod
from typing import ClassVar

from tol3d.scene.reference import Reference, Sort
from tol3d.strict import Strict


class MoveSpec(Strict, ABC):
    """An assembly step as a scene writes it."""

    sort: ClassVar[Sort]

    kind: str

    @property
    @abstractmethod
    def gears(self) -> tuple[str, ...]:
        """Names of the gears that take part, the driver first."""

    @abstractmethod
    def references(self) -> tuple[Reference, ...]:
        """Every name that the move uses."""
