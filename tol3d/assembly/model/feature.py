"""A feature of a part: its name on the drawing, its nominal place, and the contributions that move it."""

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.numerics.values import Valued


@dataclass(frozen=True)
class Point:
    """A point; z of its frame is the direction in which it touches, if it has one.

    Args:
        diameter: nominal size of the sphere of which it is the centre [mm]; None for a point alone.
        inner: whether that is a socket, not a ball.
    """

    diameter: float | None = None
    inner: bool = False

    components: ClassVar[tuple[str, ...]] = ("x", "y", "z")

    @cached_property
    def ends(self) -> Array:
        """Points at which its position is evaluated, one (1, 3), in its frame [mm]."""
        return np.zeros((1, 3))


@dataclass(frozen=True)
class Plane:
    """A flat rectangle.

    Args:
        extent: along x and along y of its frame [mm].
    """

    extent: tuple[float, float]

    components: ClassVar[tuple[str, ...]] = ("offset", "rise x", "rise y")
    """Height at the middle along z; heights at the ends of +x and of +y less that at the middle [mm]."""

    @property
    def reach(self) -> tuple[float, float]:
        """From the middle to where the rises are, along x and y [mm]."""
        return self.extent[0] / 2, self.extent[1] / 2

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


@dataclass(frozen=True)
class RoundPlane:
    """A flat disc.

    Args:
        radius: [mm].
    """

    radius: float

    components: ClassVar[tuple[str, ...]] = Plane.components

    @property
    def reach(self) -> tuple[float, float]:
        """From the middle to where the rises are, along x and y [mm]."""
        return self.radius, self.radius


@dataclass(frozen=True)
class Axis:
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

    @cached_property
    def ends(self) -> Array:
        """Its ends (2, 3), in its frame [mm]."""
        return np.array([[0.0, 0.0, -self.length / 2], [0.0, 0.0, self.length / 2]])


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

    @property
    def middle_diameter(self) -> float:
        """Diameter at the middle of its length [mm]."""
        return sum(self.diameters) / 2

    @property
    def slope(self) -> float:
        """Tangent of the angle from its axis to its lines; negative if it narrows along z."""
        return (self.diameters[1] - self.diameters[0]) / (2 * self.length)

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


def nominal_size(shape: Shape) -> float | None:
    """Diameter or width [mm], of a cone at its middle; None of a shape without one."""
    match shape:
        case Cone():
            return shape.middle_diameter
        case Axis() | Point():
            return shape.diameter
        case Slot():
            return shape.width
    return None


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
