"""The solid of a plate: flat along x and y, with holes and slots in it and pins on it."""

from collections.abc import Sequence

from tol3d.parts.box import TOP_IS_Z, Box
from tol3d.parts.details import Hole, Pin, Slot
from tol3d.parts.machining import machined
from tol3d.parts.named_solid import NamedSolid


def plate(
    length: float,
    width: float,
    thickness: float,
    holes: Sequence[Hole] = (),
    slots: Sequence[Slot] = (),
    pins: Sequence[Pin] = (),
) -> NamedSolid:
    """A plate about the middle of its bottom, z = 0, which is the origin [mm].

    Faces: "top" (z = thickness), "bottom", "left" (-x), "right" (+x), "front" (-y), "back" (+y), and those of its
    holes, slots and pins (see tol3d.parts.details). Holes and slots go in from the top.

    Args:
        length, width, thickness: along x, y and z.
        holes, slots, pins: each with a name of its own.

    Raises:
        GeometryError: a plate without volume, or a detail that leaves it or meets another.
    """
    box = Box((-length / 2, -width / 2, 0.0), (length / 2, width / 2, thickness), TOP_IS_Z)
    box.refuse_flat("a plate")
    return machined(box, "the plate", holes, slots, pins)
