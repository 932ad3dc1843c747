"""Systems whose parts stand as a user sets them: joints at other inputs, or parts further along a path."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, Protocol, runtime_checkable

from tol3d.study.system.system import System

AS_SET: Final = "as set"
"""The pose in which such a system stands."""


@dataclass(frozen=True)
class Coordinate:
    """A number by which parts stand.

    Args:
        name: of a joint, of a path, or of all poses together.
        low, high: ends to which it goes, in its unit.
        unit: such as "deg"; "" for steps along a path or through poses.
        poses: its values in the poses that are stated, the first one first; none of a path.
    """

    name: str
    low: float
    high: float
    unit: str
    poses: Mapping[str, float] = field(default_factory=dict)

    @property
    def is_path(self) -> bool:
        """True if it counts the steps of a path."""
        return not self.unit


@runtime_checkable
class Posable(Protocol):
    """A system with parts that stand in poses."""

    @property
    def coordinates(self) -> Sequence[Coordinate]:
        """Coordinates by which its parts stand; none if they stand in one way."""
        ...

    def shown_in(self, pose: str) -> System:
        """The same system, of which only the parts in a pose are shown."""
        ...

    def standing(self, values: Mapping[str, float], measures: Sequence[str]) -> System:
        """The same system in one pose, AS_SET, with measures read there in place of their own poses.

        Args:
            values: of coordinates, in their units; a joint that is not named stands as in the first pose, and of paths
                the first that is named counts.
            measures: names of those that are read, at least one.

        Raises:
            InputError: the parts cannot stand so.
        """
        ...
