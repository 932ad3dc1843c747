"""The solid of a round shaft: a cylinder along z with chamfered ends, thicker where it has collars."""

from collections.abc import Iterator, Sequence
from itertools import groupby, pairwise
from typing import Final

from tol3d.errors import GeometryError
from tol3d.parts.named_solid import BACK, FRONT, NamedSolid
from tol3d.parts.tooth_edges import SHORTEST_EDGE
from tol3d.parts.turned import AXIS, Corner, section, turned

CHAMFER_SHARE: Final = 1 / 20  # of the diameter; a turned shaft's usual edge
CHAMFER_OF_LENGTH: Final = 1 / 4  # at most, of the length of that diameter: two chamfers leave half of it

Cylinder = tuple[float, float, float]
"""Diameter, start and end along z [mm]."""


def shaft(diameter: float, start: float, end: float, collars: Sequence[Cylinder] = ()) -> NamedSolid:
    """A cylinder about z from z = start to z = end [mm], chamfered at both ends by `chamfer`.

    Collars are (diameter, start, end) within it; the largest diameter counts. Faces: "front" (+z) and "back", "front
    chamfer" and "back chamfer", "side"; with collars "side 1", "shoulder 1", "side 2" and so on from the back.

    Raises:
        GeometryError: a diameter or a length that is not above 0, or a collar that leaves the shaft.
    """
    for wide, low, high in ((diameter, start, end), *collars):
        if min(wide, high - low) < 4 * SHORTEST_EDGE / CHAMFER_SHARE:
            raise GeometryError(f"a shaft of diameter {wide:g} mm from {low:g} mm to {high:g} mm has no volume")
        if low < start or high > end:
            raise GeometryError(f"a collar from {low:g} mm to {high:g} mm leaves the shaft, {start:g} mm to {end:g} mm")
    return turned(section(list(_corners(_steps([(diameter, start, end), *collars])))), "the shaft")


def chamfer(diameter: float, length: float) -> float:
    """Width of the chamfers at 45 degrees [mm] of an end of that diameter and length."""
    return min(CHAMFER_SHARE * diameter, CHAMFER_OF_LENGTH * length)


def _steps(cylinders: Sequence[Cylinder]) -> list[Cylinder]:
    """The largest diameter all along z, from the back; neighbours differ."""
    places = sorted({place for _, *ends in cylinders for place in ends})
    widest = [
        (max(wide for wide, low, high in cylinders if low <= begin and end <= high), begin, end)
        for begin, end in pairwise(places)
    ]
    alike = [list(group) for _, group in groupby(widest, key=lambda step: step[0])]
    return [(group[0][0], group[0][1], group[-1][2]) for group in alike]


def _corners(steps: Sequence[Cylinder]) -> Iterator[Corner]:
    """Corners of the section (x, z) [mm] from the axis at the back on, and what begins there."""
    (first, start, behind), (last, before, end) = steps[0], steps[-1]
    edges = chamfer(first, behind - start), chamfer(last, end - before)
    yield BACK, 0.0, start
    yield "back chamfer", first / 2 - edges[0], start
    for number, (wide, low, high) in enumerate(steps, start=1):
        side = f"side {number}" if len(steps) > 1 else "side"
        yield side, wide / 2, start + edges[0] if number == 1 else low
        if number < len(steps):
            yield f"shoulder {number}", wide / 2, high
    yield "front chamfer", last / 2, end - edges[1]
    yield FRONT, last / 2 - edges[1], end
    yield AXIS, 0.0, end
