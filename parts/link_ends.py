"""Ends of a cast link, by numbers: drums about the axes of its two joints. Loads no CAD."""

import math
from dataclasses import dataclass
from typing import Final

from tol3d.errors import GeometryError
from tol3d.parts.details import LEAST_WALL

RELIEF: Final = 2.0
"""mm; width of the groove round a pilot, in which that part of it lies which is behind the seat."""

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Cylinder:
    """A round feature by its diameter and its length [mm], half of it on either side of the joint's frame."""

    diameter: float
    length: float


@dataclass(frozen=True)
class Proximal:
    """The end that lies on the joint before: a drum about z [mm].

    Args:
        diameter: of the drum and of its seat.
        height: of the drum, from the seat along z.
        level: z of the seat, which looks towards -z.
        pilot: that centres it, in the seat; None for none.
        hole: diameter of an opening through the seat or the pilot; 0 for none.
    """

    diameter: float
    height: float
    level: float = 0.0
    pilot: Cylinder | None = None
    hole: float = 0.0

    @property
    def centre(self) -> Point:
        """The place from which its drum is measured."""
        return 0.0, 0.0, self.level

    @property
    def inwards(self) -> Point:
        """Direction from its seat into its drum."""
        return 0.0, 0.0, 1.0

    @property
    def room(self) -> tuple[float, float]:
        """Begin and end of what the body may take of the drum, from the seat inwards."""
        return 0.0 if self.pilot is None else self.pilot.length / 2, self.height

    def refuse(self, wall: float) -> None:
        """Raise unless there is a wall everywhere."""
        if not all(LEAST_WALL <= size < math.inf for size in (self.diameter, self.height)):
            raise GeometryError(
                f"the proximal drum of a link, {self.diameter:g} mm wide and {self.height:g} mm high, has no volume"
            )
        begin, end = self.room
        if not end - begin > 2 * wall or not self.diameter > 2 * wall:
            raise GeometryError(
                f"a wall of {wall:g} mm leaves nothing inside a proximal drum {self.diameter:g} mm wide and "
                f"{end - begin:g} mm high behind its pilot"
            )
        round_it = self.diameter
        if self.pilot is not None:
            if not min(self.pilot.diameter, self.pilot.length) >= LEAST_WALL:
                raise GeometryError(
                    f"a pilot of {self.pilot.diameter:g} mm, {self.pilot.length:g} mm long, has no volume"
                )
            if not self.pilot.diameter + 2 * (RELIEF + LEAST_WALL) <= self.diameter:
                raise GeometryError(
                    f"a pilot of {self.pilot.diameter:g} mm and its groove {RELIEF:g} mm wide leave no seat of a drum "
                    f"of {self.diameter:g} mm"
                )
            round_it = self.pilot.diameter
        if not (self.hole == 0.0 or LEAST_WALL <= self.hole <= min(round_it, self.diameter - 2 * wall) - LEAST_WALL):
            raise GeometryError(f"a hole of {self.hole:g} mm leaves no wall of the proximal drum or its pilot")


@dataclass(frozen=True)
class Distal:
    """The end that holds the joint after: a drum about that joint's axis [mm].

    Args:
        at: the joint's frame.
        axis: its direction, out of the drum.
        diameter: of the drum.
        depth: of the drum, from the joint's frame against the axis.
        bore: of the joint; None for a flat flange at the joint's frame.
    """

    at: Point
    axis: Point
    diameter: float
    depth: float
    bore: Cylinder | None = None

    @property
    def front(self) -> float:
        """Place of its mouth or its flange along the axis."""
        return 0.0 if self.bore is None else self.bore.length / 2

    @property
    def unit(self) -> Point:
        """Its axis, of length 1."""
        long = math.hypot(*self.axis)
        x, y, z = self.axis
        return x / long, y / long, z / long

    @property
    def centre(self) -> Point:
        """The place from which its drum is measured: the middle of its mouth or its flange."""
        x, y, z = (at + self.front * along for at, along in zip(self.at, self.unit, strict=True))
        return x, y, z

    @property
    def inwards(self) -> Point:
        """Direction from its mouth or its flange into its drum."""
        x, y, z = self.unit
        return -x, -y, -z

    @property
    def room(self) -> tuple[float, float]:
        """Begin and end of what the body may take of the drum, from the mouth inwards: all that is behind the bore."""
        return 2 * self.front, self.front + self.depth

    def refuse(self, wall: float) -> None:
        """Raise unless there is a wall everywhere."""
        if not (math.isfinite(math.hypot(*self.at)) and 0.0 < math.hypot(*self.axis) < math.inf):
            raise GeometryError(f"the distal drum of a link needs a place and an axis, got {self.at} and {self.axis}")
        if not all(LEAST_WALL <= size < math.inf for size in (self.diameter, self.depth)):
            raise GeometryError(
                f"the distal drum of a link, {self.diameter:g} mm wide and {self.depth:g} mm deep, has no volume"
            )
        begin, end = self.room
        if not end - begin > 2 * wall or not self.diameter > 2 * wall:
            raise GeometryError(
                f"a wall of {wall:g} mm leaves nothing inside a distal drum {self.diameter:g} mm wide and "
                f"{end - begin:g} mm deep behind its bore"
            )
        if self.bore is not None:
            if not min(self.bore.diameter, self.bore.length) >= LEAST_WALL:
                raise GeometryError(f"a bore of {self.bore.diameter:g} mm, {self.bore.length:g} mm long, has no volume")
            if not self.bore.diameter + 2 * wall <= self.diameter:
                raise GeometryError(
                    f"a bore of {self.bore.diameter:g} mm leaves no wall of {wall:g} mm in a distal drum of "
                    f"{self.diameter:g} mm"
                )
