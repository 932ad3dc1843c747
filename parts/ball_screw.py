"""The solid of the shaft of a ball screw."""

import math

from tol3d.errors import GeometryError
from tol3d.parts.details import LEAST_WALL
from tol3d.parts.named_solid import NamedSolid
from tol3d.parts.turned import AXIS, Corner, section, turned


def ball_screw(diameter: float, length: float, journal: tuple[float, float] | None = None) -> NamedSolid:
    """A shaft along z from the middle of its bottom, which is the origin [mm].

    The groove is left out: as one helical face, four turns of it already take half a minute to mesh. Faces: "bottom",
    "thread" (a cylinder), "top"; with journals also "lower journal", "lower shoulder", "upper shoulder", "upper
    journal".

    Args:
        diameter: of the thread.
        length: from end to end.
        journal: diameter and length of what is turned down at either end; None for none.

    Raises:
        GeometryError: a screw without volume, or journals that are not thinner or leave no thread.
    """
    if not all(LEAST_WALL <= size < math.inf for size in (diameter, length)):
        raise GeometryError(f"a screw of {diameter:g} mm, {length:g} mm long, has no volume")
    wide, long = journal or (diameter, 0.0)
    if journal is not None and not (LEAST_WALL <= wide <= diameter - LEAST_WALL and long >= LEAST_WALL):
        raise GeometryError(
            f"a journal of {wide:g} mm, {long:g} mm long, is not thinner than its screw of {diameter:g} mm"
        )
    if not length - 2 * long >= LEAST_WALL:
        raise GeometryError(f"two journals of {long:g} mm leave no thread of a screw {length:g} mm long")
    corners: list[Corner] = [("bottom", 0.0, 0.0)]
    if journal is not None:
        corners += [("lower journal", wide / 2, 0.0), ("lower shoulder", wide / 2, long)]
    corners.append(("thread", diameter / 2, long))
    if journal is not None:
        corners += [("upper shoulder", diameter / 2, length - long), ("upper journal", wide / 2, length - long)]
    corners += [("top", wide / 2, length), (AXIS, 0.0, length)]
    return turned(section(corners), "the screw")
