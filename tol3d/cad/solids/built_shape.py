"""Shapes that come with a builder of their own: shown and exported parts that are no gear, shaft or arm."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class BuiltShape(ABC):
    """Numbers that a solid is built of [mm]; a subclass adds them as fields and names its builder.

    `display_mesh`, `export_step` and the cache take one as they take a gear. The solid may depend on nothing but the
    fields, which are its cache key.
    """

    builder: ClassVar[str]
    """Import path `package.module:function` of the maker of a `tol3d.parts.named_solid.NamedSolid` of the shape.

    Its module may import CadQuery: it is loaded when a solid is built, and never by opening a scene.
    """

    def open_faces(self) -> Sequence[str]:
        """Names of faces of the solid that its mesh lacks, because they cannot be read or triangulated.

        Raises:
            InputError: the mesh cannot be made.
        """
        return ()


@dataclass(frozen=True)
class SweptShape(BuiltShape):
    """A shape whose solid is one section swept along z, from -width/2 to +width/2.

    Its display mesh is made of one end: of faces that are splines OCC makes hundreds of times as many triangles as
    are asked for, and slowly.
    """

    width: float


@dataclass(frozen=True)
class MeshedShape(BuiltShape):
    """A shape of a stranger's file: it comes as triangles, and its solid is built in a process of its own only."""

    @abstractmethod
    def mesh(self, deflection: float) -> Mapping[str, NDArray[np.generic]]:
        """Arrays of DisplayMesh, whose triangles lie within about `deflection` [mm] of the faces.

        Raises:
            InputError: they cannot be made.
        """

    @abstractmethod
    def colours(self, deflection: float) -> Sequence[str]:
        """The colour of each triangle of `mesh`, "#RRGGBB", empty for that of its part.

        Raises:
            InputError: the mesh cannot be made.
        """


@dataclass(frozen=True, eq=False)
class PosedShape:
    """A shape, the name of its part, and its pose: (4, 4), rotation and translation [mm]."""

    name: str
    shape: BuiltShape
    world_from_part: NDArray[np.float64]
