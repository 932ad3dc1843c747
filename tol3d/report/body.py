"""Parts as they are shown and exported: where they stand, their surfaces, solids and colours."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from tol3d.cad.solids import BuiltShape, PosedPart, PosedShape, paint_of, surface_of
from tol3d.numerics.arrays import Array

Surface = tuple[Array, NDArray[np.int64]]


@dataclass(frozen=True, eq=False)
class Body:
    """A part as it is shown and exported.

    Args:
        name: the part's.
        world_from_part: its pose (4, 4), rotation and translation [mm].
        surface: its closed triangle mesh in its own frame: vertices (n, 3) [mm], triangles (m, 3); made when asked for.
        posed: the same part for STEP, with its deviations and growth in its numbers; raises GeometryError where such
            a part cannot be made. None: it has no solid.
        colour: "#RRGGBB".
        scale: thermal growth, 1 at the reference temperature; `surface` is without it.
        smooth: whether its facets stand for one round surface, as a cylinder's do.
        opacity: of its surface in pictures, from 0 to 1; what is within it is seen where that is less.
        details: a closed triangle mesh in its own frame, shown in pictures on it or within it but not exported.
        painted: "#RRGGBB" of each triangle of its surface that has a colour of its own, empty of the others; made when
            asked for. None: none has.
        coarse: its surface with coarser facets, which pages have instead; None: they have that of files.
        features: names of the part's features with the number of triangles that each has; in their order these are the
            last of its surface and details together. Made when asked for. None: none are told apart.
    """

    name: str
    world_from_part: Array
    surface: Callable[[], Surface]
    posed: Callable[[], PosedPart] | None
    colour: str
    scale: float = 1.0
    smooth: bool = False
    opacity: float = 1.0
    details: Callable[[], Surface] | None = None
    painted: Callable[[], Sequence[str]] | None = None
    coarse: Callable[[], Surface] | None = None
    features: Callable[[], Mapping[str, int]] | None = None

    @cached_property
    def paint(self) -> Sequence[str]:
        """The colour of each of its triangles, "#RRGGBB"; empty where all have that of the body."""
        found = () if self.painted is None else self.painted()
        return [own or self.colour for own in found] if any(found) else ()

    @cached_property
    def pieces(self) -> tuple["Body", ...]:
        """Itself; where faces have colours of their own, without them, and a body of the faces of each such colour."""
        if not self.paint:
            return (self,)
        vertices, triangles = self.surface()
        paint = np.array(self.paint)
        found = []
        for colour in sorted(set(self.paint), key=lambda own: (own != self.colour, own)):
            used, corners = np.unique(triangles[paint == colour], return_inverse=True)
            surface = vertices[used], np.asarray(corners.reshape(-1, 3), dtype=np.int64)
            whole = colour == self.colour
            found.append(
                replace(
                    self,
                    name=self.name if whole else f"{self.name}, {colour} faces",
                    surface=partial(_as_made, surface),
                    posed=None,
                    colour=colour,
                    details=self.details if whole else None,
                    painted=None,
                    coarse=None,
                    features=self.features if whole else None,
                )
            )
        return tuple(found)

    @cached_property
    def mesh(self) -> Surface:
        """Its closed triangle mesh in the world: vertices (n, 3) [mm], triangles (m, 3)."""
        return self._in_world(self.surface())

    @cached_property
    def detail_mesh(self) -> Surface | None:
        """Its details in the world, as `mesh`."""
        return None if self.details is None else self._in_world(self.details())

    def _in_world(self, surface: Surface) -> Surface:
        vertices, triangles = surface
        rotation, translation = self.world_from_part[:3, :3], self.world_from_part[:3, 3]
        return self.scale * vertices @ rotation.T + translation, triangles


def _as_made(surface: Surface) -> Surface:
    return surface


@dataclass(frozen=True, eq=False)
class Arrow:
    """A direction that pictures show, such as that of gravity or of an error.

    Args:
        direction: unit vector (3,).
        place: where it acts, or from where it leads (3,) [mm].
        length: [mm]; None: as suits the picture.
    """

    direction: Array
    place: Array
    length: float | None = None


@dataclass(frozen=True, eq=False)
class Placed:
    """A feature of a part where it lies in a world.

    Args:
        part: its part's name.
        frame: (4, 4), rotation and translation [mm].
        reach: half sizes (3,) of the box about it, along the axes of its frame [mm].
    """

    part: str
    frame: Array
    reach: Array


@dataclass(frozen=True, eq=False)
class MeasuredLine:
    """A line along which a measure is read.

    Args:
        points: (points, 3) [mm], the first two apart by what is measured; one alone: where it is read.
        is_error: True if the line leads from the place where its end lies nominally.
    """

    points: Array
    is_error: bool = False


@dataclass(frozen=True, eq=False)
class World:
    """Bodies that stand in one world.

    Args:
        name: it distinguishes the files of several worlds.
        bodies: names differ.
        one_file: whether files of triangles hold all bodies, instead of one body each.
        points: what pictures name besides the bodies, (3,) [mm].
        arrows: what pictures show besides the bodies, by name.
        up: unit vector (3,) to the top of a picture.
        marks: contacts and gaps, which a page's 3D view names too, (3,) [mm].
        features: of its parts, by name.
        measured: lines of each measure that is read in this world, by the measure's name.
        magnify: factor of the deviations with which it is shown; None: the one that was asked for.
        enlarged: how many times as long as they lie in it lines of errors are drawn.
        within: bodies that pictures show within the others under a common name, and files leave out, by that name.
    """

    name: str
    bodies: tuple[Body, ...]
    one_file: bool = True
    points: Mapping[str, Array] = field(default_factory=dict)
    arrows: Mapping[str, Arrow] = field(default_factory=dict)
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    marks: Mapping[str, Array] = field(default_factory=dict)
    features: Mapping[str, Placed] = field(default_factory=dict)
    measured: Mapping[str, tuple[MeasuredLine, ...]] = field(default_factory=dict)
    magnify: float | None = None
    enlarged: float = 1.0
    within: Mapping[str, tuple[Body, ...]] = field(default_factory=dict)

    @property
    def drawn(self) -> tuple[Body, ...]:
        """Every body that pictures show."""
        return (*self.bodies, *(body for bodies in self.within.values() for body in bodies))


def built_body(
    name: str, shape: BuiltShape, world_from_part: NDArray[np.float64], colour: str, *, deflection: float
) -> Body:
    """A shape as it is shown, and exported to any format, where it stands.

    Args:
        name: the part's.
        shape: what is built.
        world_from_part: its pose (4, 4), rotation and translation [mm].
        colour: "#RRGGBB".
        deflection: how far its triangles may lie off its faces [mm].
    """
    posed = PosedShape(name, shape, world_from_part)
    painted = partial(paint_of, shape, deflection)
    return Body(name, world_from_part, lambda: surface_of(shape, deflection), lambda: posed, colour, painted=painted)
