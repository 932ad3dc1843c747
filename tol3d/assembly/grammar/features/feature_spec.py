"""What every kind of feature has in common."""

from abc import abstractmethod
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from tol3d.assembly.model import Shape
from tol3d.scene.vector import Vector
from tol3d.strict import Strict

Array = NDArray[np.float64]


class FeatureSpec(Strict):
    """A feature as a scene writes it by numbers, in the frame of its part."""

    words: ClassVar[str]

    kind: str
    at: Vector = Field(description="the middle of it")

    @property
    def origin(self) -> Array:
        """Its middle (3,) [mm]."""
        return np.array([coordinate.internal for coordinate in self.at])

    @property
    @abstractmethod
    def shape(self) -> Shape:
        """What may deviate on it."""

    @property
    @abstractmethod
    def frame(self) -> Array:
        """Nominally, in its part's frame (4, 4)."""
