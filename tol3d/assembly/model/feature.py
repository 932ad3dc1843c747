"""A feature of a part: its name on the drawing, its nominal place, and the contributions that move it."""

import math
from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar, Literal, Self

import numpy as np
from typing_extensions import override

from tol3d.numerics.arrays import Array
from tol3d.numerics.values import Valued

Surface = Literal["point", "axis", "cone", "plane"]
"""Surface that others touch or mate, apart from its size: of a sphere its centre, of a cylinder its axis."""

Held = Literal["along", "across", "all"]
"""Constraint of a point: its height along the target's direction, its place across it, or its place."""
Turning = Literal["none", "direction", "level"]
"""Constraint of a direction: none, the target's, or only perpendicular to it."""
Asks = tuple[Held, Turning]

Displaced = Callable[[Array], Array]
"""Displacement (3, ...) of a point (3,) of a feature, both in its frame [mm]."""


class Facts:
    """Facts that every shape tells of itself; as given here, those of one that has no size and no direction."""

    components: ClassVar[tuple[str, ...]]
    """Components of its deviation [mm]."""
    origin_by: ClassVar[Array]
    """(3, components): components -> displacement of its origin, in its frame."""
    surface: ClassVar[Surface]
    located: ClassVar[slice]
    """Axes of its frame along which its position counts at its ends."""
    asks: ClassVar[Asks]
    """Constraint by it as a datum."""
    facing: ClassVar[str] = ""
    """Word before the direction of its z."""
    together: ClassVar[Sequence[slice]] = ()
    """Coordinates x and y of a face, alone or together, whose length up to their reach is over it."""

    @property
    def held(self) -> slice:
        """Axes of its frame along which a datum holds its origin."""
        return {"along": slice(2, 3), "across": slice(0, 2), "all": slice(0, 3)}[self.asks[0]]

    @property
    def slope(self) -> float:
        """Tangent of the angle from its z to the lines of its surface; negative if it narrows along z."""
        return 0.0

    @property
    def slant(self) -> float:
        """Displacement of its axis or centre over that of its surface, square to it."""
        return 1.0

    @property
    def turn_by(self) -> Array:
        """(3, components): components -> rotation of its frame, in it [rad/mm]."""
        return np.zeros((3, len(self.components)))

    @property
    @abstractmethod
    def ends(self) -> Array:
        """Points at which its position is evaluated (ends, 3), in its frame [mm]."""

    @property
    def inner(self) -> bool:
        """True if its material is outside it."""
        return False

    @property
    def diameter(self) -> float | None:
        """Nominal [mm]; None of a shape without one."""
        return None

    @property
    def nominal_size(self) -> float | None:
        """Diameter or width [mm], of a cone at its middle; None of a shape without one."""
        return self.diameter

    @property
    def longest(self) -> float:
        """Longest line in it [mm]."""
        return 0.0

    @property
    def growth_centre(self) -> float:
        """Place along z of the point about which it grows into a similar shape, from its middle [mm]."""
        return 0.0

    @property
    def by_size(self) -> Array:
        """(components,): its components by a size 1 mm larger."""
        return np.zeros(len(self.components))

    @property
    def outward_by(self) -> tuple[float, float] | None:
        """Displacement of a round surface out of the material, square to it, by a shift along z and by its size."""
        return None if self.diameter is None else (0.0, -0.5 if self.inner else 0.5)

    @property
    def surface_by_axis(self) -> Array:
        """(ends, ends): offsets of the ends of its axis -> displacements of its surface there, square to it."""
        return np.eye(len(self.ends))

    @property
    def rim_radius(self) -> float | None:
        """Radius of its edge [mm]; None of one with corners or ends."""
        return None

    def edge(self, angles: Array) -> Array:
        """Places (places, 3) where a distance may be largest, in its frame [mm]: its ends, or at angles of a rim."""
        return self.ends

    def of_length(self, length: float) -> Self:
        """It with another length along z [mm]; itself if it has none."""
        return self


@dataclass(frozen=True)
class Point(Facts):
    """A point; z of its frame is the direction in which it touches, if it has one.

    Args:
        diameter: nominal size of the sphere of which it is the centre [mm]; None for a point alone.
        inner: whether that is a socket, not a ball.
    """

    diameter: float | None = None
    inner: bool = False

    components: ClassVar[tuple[str, ...]] = ("x", "y", "z")
    origin_by: ClassVar[Array] = np.eye(3)
    surface: ClassVar[Surface] = "point"
    located: ClassVar[slice] = slice(0, 3)
    asks: ClassVar[Asks] = ("all", "none")

    @property
    def words(self) -> str:
        """Its kind and sizes."""
        return "point" if self.diameter is None else f"{'socket' if self.inner else 'ball'} ⌀{self.diameter:g} mm"

    @property
    def reach(self) -> tuple[float, ...]:
        """From its middle to where its components are told, along each direction in which it extends: none."""
        return ()

    @cached_property
    def ends(self) -> Array:
        """Points at which its position is evaluated, one (1, 3), in its frame [mm]."""
        return np.zeros((1, 3))

    def moved(self, displaced: Displaced) -> Array:
        """Its components (components, ...) as its points are displaced."""
        return displaced(np.zeros(3))


class Flat(Facts):
    """Facts that flat faces of any outline have in common."""

    components: ClassVar[tuple[str, ...]] = ("offset", "rise x", "rise y")
    """Height at the middle along z; heights at the ends of +x and of +y less that at the middle [mm]."""
    origin_by: ClassVar[Array] = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    surface: ClassVar[Surface] = "plane"
    located: ClassVar[slice] = slice(2, 3)
    asks: ClassVar[Asks] = ("along", "direction")
    facing: ClassVar[str] = "facing"
    rim: ClassVar[Array]
    """(places, numbers, 2): rises at the ends of x and y -> numbers whose largest length is the rise of its rim."""

    @property
    @abstractmethod
    def reach(self) -> tuple[float, float]:
        """From the middle to where the rises are, along x and y [mm]."""

    @property
    def turn_by(self) -> Array:
        """See Facts: its height is w + alpha y - beta x."""
        (x, y), found = self.reach, np.zeros((3, 3))
        found[0, 2], found[1, 1] = 1.0 / y, -1.0 / x
        return found

    def moved(self, displaced: Displaced) -> Array:
        """See Point."""
        middle, (x, y) = displaced(np.zeros(3)), self.reach
        rises = [(displaced(end) - middle)[2] for end in (np.array([x, 0.0, 0.0]), np.array([0.0, y, 0.0]))]
        return np.stack([middle[2], *rises])


@dataclass(frozen=True)
class Plane(Flat):
    """A flat rectangle.

    Args:
        extent: along x and along y of its frame [mm].
    """

    extent: tuple[float, float]

    together: ClassVar[Sequence[slice]] = (slice(0, 1), slice(1, 2))
    rim: ClassVar[Array] = np.array([[[1.0, 1.0]], [[1.0, -1.0]]])

    @property
    def words(self) -> str:
        """See Point."""
        a, b = self.extent
        return f"plane {a:g} × {b:g} mm"

    @property
    def reach(self) -> tuple[float, float]:
        """From the middle to where the rises are, along x and y [mm]."""
        return self.extent[0] / 2, self.extent[1] / 2

    @property
    def longest(self) -> float:
        """Its diagonal [mm]."""
        return 2.0 * math.hypot(*self.reach)

    @cached_property
    def ends(self) -> Array:
        """Its corners (4, 3), in its frame [mm]."""
        a, b = self.reach
        return np.array([[a, b, 0.0], [-a, b, 0.0], [-a, -b, 0.0], [a, -b, 0.0]])


@dataclass(frozen=True)
class Slot(Plane):
    """A slot or a tab: the plane in the middle between its faces, z across its width.

    Args:
        extent: of that plane [mm].
        width: nominal size [mm].
        inner: whether it is a slot, not a tab.
    """

    width: float
    inner: bool = True

    facing: ClassVar[str] = "across"

    @property
    @override
    def words(self) -> str:
        a, b = self.extent
        return f"{'slot' if self.inner else 'tab'} {self.width:g} mm wide, {a:g} × {b:g} mm"

    @property
    def nominal_size(self) -> float:
        """Its width [mm]."""
        return self.width


@dataclass(frozen=True)
class RoundPlane(Flat):
    """A flat disc.

    Args:
        radius: [mm].
    """

    radius: float

    together: ClassVar[Sequence[slice]] = (slice(0, 2),)
    rim: ClassVar[Array] = np.eye(2)[None]

    @property
    def words(self) -> str:
        """See Point."""
        return f"plane, radius {self.radius:g} mm"

    @property
    def reach(self) -> tuple[float, float]:
        """From the middle to where the rises are, along x and y [mm]."""
        return self.radius, self.radius

    @property
    def rim_radius(self) -> float:
        return self.radius

    @property
    def longest(self) -> float:
        """Its diameter [mm]."""
        return 2.0 * self.radius

    @cached_property
    def ends(self) -> Array:
        """Ends of its rim along x and y (4, 3), in its frame [mm]."""
        return self.radius * np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])

    def edge(self, angles: Array) -> Array:
        return self.radius * np.stack([np.cos(angles), np.sin(angles), 0.0 * angles], axis=1)


@dataclass(frozen=True)
class Axis(Facts):
    """The axis of a cylinder, or of a pattern.

    Args:
        length: from end to end along z [mm].
        diameter: nominal size [mm]; None for an axis without one.
        inner: whether it is a hole.
    """

    length: float
    diameter: float | None = None
    inner: bool = False

    components: ClassVar[tuple[str, ...]] = ("start x", "start y", "end x", "end y")
    """Offsets of its ends at z = -length/2 and at z = +length/2 [mm]; the axis passes through both."""
    origin_by: ClassVar[Array] = 0.5 * np.array([[1.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 0.0, 0.0]])
    surface: ClassVar[Surface] = "axis"
    located: ClassVar[slice] = slice(0, 2)
    asks: ClassVar[Asks] = ("across", "direction")
    facing: ClassVar[str] = "along"

    @property
    def words(self) -> str:
        """See Point."""
        if self.diameter is None:
            return f"axis, {self.length:g} mm long"
        return f"{'hole' if self.inner else 'pin'} ⌀{self.diameter:g} mm, {self.length:g} mm long"

    @property
    def reach(self) -> tuple[float, ...]:
        """From its middle to its end along z [mm]."""
        return (self.length / 2,)

    @property
    def longest(self) -> float:
        """Its length [mm]."""
        return self.length

    @cached_property
    def ends(self) -> Array:
        """Its ends (2, 3), in its frame [mm]."""
        return np.array([[0.0, 0.0, -self.length / 2], [0.0, 0.0, self.length / 2]])

    @property
    def turn_by(self) -> Array:
        """See Facts: it passes both its ends."""
        found = np.zeros((3, len(self.components)))
        found[1, [0, 2]] = found[0, [3, 1]] = -1.0 / self.length, 1.0 / self.length
        return found

    def of_length(self, length: float) -> Self:
        return replace(self, length=length)

    def moved(self, displaced: Displaced) -> Array:
        """See Point."""
        return np.concatenate([displaced(end)[:2] for end in self.ends])


@dataclass(frozen=True)
class Cone(Axis):
    """An axis with a cone about it, which holds it along itself too.

    Args:
        length, inner: see Axis; its `diameter` is None, as it is no cylinder.
        diameters: nominal, at z = -length/2 and at z = +length/2 [mm].
    """

    diameters: tuple[float, float] = field(kw_only=True)

    components: ClassVar[tuple[str, ...]] = (*Axis.components, "along")
    """Those of its axis, and the shift of the cone along it [mm]."""
    origin_by: ClassVar[Array] = np.column_stack([Axis.origin_by, [0.0, 0.0, 1.0]])
    surface: ClassVar[Surface] = "cone"
    asks: ClassVar[Asks] = ("all", "direction")

    @property
    @override
    def words(self) -> str:
        (start, end), angle = self.diameters, math.degrees(abs(self.angle))
        word = "conical hole" if self.inner else "cone"
        return f"{word} ⌀{start:.6g} to ⌀{end:.6g} mm, half angle {angle:.4g} deg, {self.length:g} mm long"

    @property
    def nominal_size(self) -> float:
        """Its diameter at its middle [mm]."""
        return self.middle_diameter

    @property
    def growth_centre(self) -> float:
        """Place of its apex."""
        return self.apex

    @override
    def moved(self, displaced: Displaced) -> Array:
        return np.concatenate([super().moved(displaced), displaced(np.zeros(3))[2:]])

    @property
    def middle_diameter(self) -> float:
        """Diameter at the middle of its length [mm]."""
        return sum(self.diameters) / 2

    @property
    def slope(self) -> float:
        return (self.diameters[1] - self.diameters[0]) / (2 * self.length)

    @property
    def slant(self) -> float:
        return 1.0 / math.cos(self.angle)

    @property
    def by_size(self) -> Array:
        return np.array([0.0, 0.0, 0.0, 0.0, self.along_by_size])

    @property
    def outward_by(self) -> tuple[float, float]:
        return math.sin(self.angle if self.inner else -self.angle), 0.0  # its size is where it lies along its axis

    @property
    def along_by_size(self) -> float:
        """Shift along z by a diameter 1 mm larger in every section."""
        return -0.5 / self.slope

    @property
    def angle(self) -> float:
        """Half angle [rad], with the sign of its slope."""
        return math.atan(self.slope)

    @cached_property
    def surface_by_axis(self) -> Array:
        """(2, 2): offsets of both ends of its axis -> displacements of its surface at both ends, square to it.

        A point at the radius r and the height z moves along its normal by the part along r of e cos a + e' (z / cos a
        + R sin a): e is the offset of the axis' middle, e' its lean, which turns the point too, R the radius at the
        middle and a the half angle. What it moves by along the axis is added to that, times - sin a.
        """
        z = self.length / 2 * np.array([-1.0, 1.0])
        lean = (z / math.cos(self.angle) + self.middle_diameter / 2 * math.sin(self.angle)) / self.length
        return np.column_stack([math.cos(self.angle) / 2 - lean, math.cos(self.angle) / 2 + lean])

    @property
    def apex(self) -> float:
        """Place of its apex along z, from its middle [mm]."""
        return self.along_by_size * self.middle_diameter


Shape = Point | Plane | RoundPlane | Axis


@dataclass(frozen=True, eq=False)
class Contribution(Valued):
    """Effect of a contributor on its target, such as the components of a feature.

    Args:
        contributor: name.
        columns: which columns of the deviations are its components.
        matrix: (components of the feature, components of the contributor); lengths to lengths [mm].
    """

    contributor: str
    columns: slice
    matrix: Array


@dataclass(frozen=True, eq=False)
class Feature(Valued):
    """A feature of a part, and of no other. In a trial: T_feature = T_parent(trial) T_parent(nominal)^-1 frame delta.

    Args:
        name: with its part, such as "housing.bore 1".
        part: that part.
        shape: what may deviate on it.
        frame: nominally, in the part's frame (4, 4).
        parent: name of the datum frame to which its location is toleranced; "" for the part's frame.
        moved_by: contributions to its shape's components, which make delta; they add up.
        size_by: contributions to its size (1, components of the contributor); positive is a larger diameter or width.
        formed_by: contributions of its form to the size that a fit sees (1, components): larger pins, smaller holes.
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
    formed_by: tuple[Contribution, ...] = ()

    @property
    def mating_by(self) -> tuple[Contribution, ...]:
        """Contributions to the size that a fit sees, its form with it (1, components)."""
        return self.size_by + self.formed_by

    @property
    def is_still(self) -> bool:
        """True if it lies at its nominal place in the part in all trials."""
        return not (self.parent or self.moved_by or self.grown_by)
