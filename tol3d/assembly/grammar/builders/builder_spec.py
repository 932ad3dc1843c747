"""What every kind of builder has in common."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Annotated, ClassVar

from tol3d.scene.listed import listed
from tol3d.scene.place import KeyPath
from tol3d.scene.vector import Coordinate
from tol3d.solids import BuiltShape
from tol3d.strict import Strict

Place = Annotated[tuple[Coordinate, Coordinate], listed("lengths", 2, 2)]
"""Two coordinates on a flat face."""


class BuilderSpec(Strict, ABC):
    """A solid as a scene writes it by its dimensions, in the frame of its part."""

    words: ClassVar[str]

    kind: str

    @property
    @abstractmethod
    def shape(self) -> BuiltShape:
        """What its solid is built of."""


def place(at: Place) -> tuple[float, float]:
    """Two coordinates [mm]."""
    return at[0].internal, at[1].internal


def place_of(builder: Strict, detail: str) -> KeyPath:
    """Where a hole, a pin or the like stands, from its builder on; the builder if it names no such detail."""
    for field in type(builder).model_fields:
        named = getattr(builder, field)
        if isinstance(named, Mapping) and detail in named:
            return (field, detail)
    return ()
