"""Touch: round features in contact, without a formula for each mechanism."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model.shape import Axis, Plane, Point, RoundPlane, Shape

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Contact:
    """A feature of the part that is placed, and the one of placed parts that its surface touches.

    What it asks, c the origin of a sphere, a point or a cylinder, all with the sizes of the trial: a sphere's or a
    point's c lies at its radius over a plane, or at the contact's distance from the other's c or axis: the sum of the
    radii outside each other, their difference for one inside the other. A cylinder also lies along what it touches: on
    a plane its axis is square to the normal; beside or inside a cylinder that is nominally parallel its axis is square
    to the common normal, and c of the moving one counts. Cylinders that cross touch where their axes are nearest.

    Args:
        moving, target: names of the features.
    """

    moving: str
    target: str


@dataclass(frozen=True, eq=False)
class Touch:
    """A part is laid against placed ones at its contacts, all at once, near its nominal pose.

    Freedoms that no contact decides stay as nominal: the least turn, then the least shift of the middle of the part's
    features in contact.

    Args:
        name, part: of the move, and what it places.
        contacts: of which none asks what the others hold.
        pressed: direction (3,) of the force that presses the part on, through the mean of its moving features' origins,
            in the nominal frame of the first target's part; a contact that would have to pull is lost. None: not asked.
    """

    name: str
    part: str
    contacts: tuple[Contact, ...]
    pressed: Array | None = None


def is_inner(shape: Shape) -> bool:
    """Whether a shape is a bore or a socket."""
    return isinstance(shape, Axis | Point) and shape.inner


def unfit_surfaces(start: Shape, end: Shape) -> str:
    """Why two surfaces have no common normal, in words; "" where they have one."""
    if any(isinstance(own, Axis) and own.diameter is None for own in (start, end)):
        return "expected a cylinder, got an axis without a diameter"
    if [getattr(own, "diameter", None) for own in (start, end)] == [None, None]:
        return "expected a cylinder or a sphere on one side at least"
    if is_inner(start) and is_inner(end):
        return "expected one of them to lie inside the other, got two holes"
    if not is_inner(start) and not is_inner(end):
        return ""
    hole, other = (start, end) if is_inner(start) else (end, start)
    if isinstance(other, Plane | RoundPlane):
        return "expected what lies in the hole, got a plane"
    if isinstance(hole, Point) and isinstance(other, Axis):
        return "expected a sphere or a point in a socket, got a cylinder"
    return ""


def unfit_for_contact(moving: Shape, target: Shape) -> str:
    """Why two surfaces do not touch as a `Contact` asks, in words; "" where they do."""
    words = unfit_surfaces(moving, target)
    if words or is_inner(moving) == is_inner(target):
        return words
    hole, other = (moving, target) if is_inner(moving) else (target, moving)
    room, size = getattr(hole, "diameter", None) or 0.0, getattr(other, "diameter", None) or 0.0
    return "" if size < room else f"expected less than the {room:g} mm of the hole in which it lies, got {size:g} mm"
