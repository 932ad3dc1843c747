"""The solid of a block: a box with holes and slots in any of its faces and pins on its top."""

from collections.abc import Sequence

from tol3d.parts.box import TOP_IS_Z, Box
from tol3d.parts.details import Hole, Pin, Slot
from tol3d.parts.machining import machined
from tol3d.parts.named_solid import NamedSolid


def block(
    length: float,
    width: float,
    height: float,
    holes: Sequence[Hole] = (),
    slots: Sequence[Slot] = (),
    pins: Sequence[Pin] = (),
) -> NamedSolid:
    """A box about the middle of its bottom, z = 0, which is the origin [mm].

    Faces: "top" (z = height), "bottom", "left" (-x), "right" (+x), "front" (-y), "back" (+y), and those of its holes,
    slots and pins (see tol3d.parts.details). Places on a face are coordinates of the block: on the top and the bottom
    x and y, on the front and the back x and z, on the left and the right y and z.

    Args:
        length, width, height: along x, y and z.
        holes, slots, pins: each with a name of its own.

    Raises:
        GeometryError: a block without volume, or a detail that leaves its face or meets another.
    """
    box = Box((-length / 2, -width / 2, 0.0), (length / 2, width / 2, height), TOP_IS_Z)
    box.refuse_flat("a block")
    return machined(box, "the block", holes, slots, pins)
