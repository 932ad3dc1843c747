"""Face of a solid that is selected, and its properties."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from tol3d.errors import GeometryError

Triple = tuple[float, float, float]
FaceKind = Literal["plane", "cylinder", "cone", "sphere"]


@dataclass(frozen=True)
class Pick:
    """Selection of a face of a solid.

    Args:
        name: its name; "" for the nearest one.
        near: a point [mm] that no other face of these kinds is as near to; None of a pick by name.
        kinds: allowed kinds of face; empty for all.
        along: direction of x on a flat face, as near as may be; None for the part's x, or y where the normal is x.
    """

    name: str = ""
    near: Triple | None = None
    kinds: tuple[FaceKind, ...] = ()
    along: Triple | None = None


@dataclass(frozen=True)
class PickedFace:
    """A face of a solid in the frame of its part [mm].

    Args:
        name: of the face.
        kind: of the face.
        at: the middle: of a flat face of its bounding rectangle (or circle), of a round one of its axis, of a sphere
            its centre.
        direction: the normal out of the material of a flat face; the axis of a round one, towards +x, +y or +z,
            whichever it is nearest to.
        x: of a flat face, the direction of the first of its extents.
        extent: of a flat face, of the rectangle around it along x and across; lengths from end to end of other ones
            stand first.
        radius: of a round face, or of a flat one whose edge is a circle; 0 of others.
        hole: whether the material lies outside the radius.
        nearest: the point of it that is nearest to where the pick asked.
        normal: there, out of the material.
        radii: of a cone, at the start and at the end of its axis.
    """

    name: str
    kind: FaceKind
    at: Triple
    direction: Triple
    x: Triple
    extent: tuple[float, float]
    radius: float
    hole: bool
    nearest: Triple
    normal: Triple
    radii: tuple[float, float] = (0.0, 0.0)

    def axis(self, stated: Triple | None) -> Triple:
        """The direction of a round face, on the side of a stated one."""
        if stated is None or float(np.dot(self.direction, stated)) >= 0.0:
            return self.direction
        x, y, z = (0.0 - own for own in self.direction)
        return x, y, z


class PickError(GeometryError):
    """No face matches a pick, or several do.

    Args:
        sentence: expected and existing faces.
        number: which pick.
        by: whether its name or its place is at fault.
    """

    def __init__(self, sentence: str, number: int, by: Literal["name", "near"]) -> None:
        super().__init__(sentence)
        self.number, self.by = number, by
