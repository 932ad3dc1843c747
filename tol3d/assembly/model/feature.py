"""A feature of a part: what a drawing names, where it is nominally, and what moves it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model.shape import Shape

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Contribution:
    """What a contributor does to what it belongs to, such as the components of a feature.

    Args:
        contributor: its name.
        columns: which columns of the deviations are its components.
        matrix: (components of the feature, components of the contributor); lengths to lengths [mm].
    """

    contributor: str
    columns: slice
    matrix: Array


@dataclass(frozen=True, eq=False)
class Feature:
    """A feature of a part, and of no other. In a trial: T_feature = T_parent(trial) T_parent(nominal)^-1 frame delta.

    Args:
        name: with its part, such as "housing.bore 1".
        part: that part.
        shape: what may deviate on it.
        frame: nominally, in the part's frame (4, 4).
        parent: name of the datum frame to which its location is toleranced; "" for the part's frame.
        moved_by: contributions to its shape's components, which make delta; they add up.
        size_by: contributions to its size (1, components of the contributor); positive is a larger diameter or width.
        grown_by: contributions to where its origin lies as its part grows (3, components), in its frame [mm].
        is_named: whether a drawing names it; a point that a move makes of one is not.
        plane: of a point where a plane of its part is touched, the name of that plane, which it follows; else "".
        face: name of the face of its part's solid that it is; "" of one by numbers.
    """

    name: str
    part: str
    shape: Shape
    frame: Array
    parent: str = ""
    moved_by: tuple[Contribution, ...] = ()
    size_by: tuple[Contribution, ...] = ()
    grown_by: tuple[Contribution, ...] = ()
    is_named: bool = True
    face: str = ""
    plane: str = ""

    @property
    def is_still(self) -> bool:
        """Whether it lies in its part as it does nominally, in all trials."""
        return not (self.parent or self.moved_by or self.grown_by)
