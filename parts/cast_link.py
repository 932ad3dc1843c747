"""The solid of a cast link of an arm: drums about the axes of both of its joints, a tapered tube between them."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, TypeAlias

import cadquery as cq
import numpy as np
from numpy.typing import NDArray
from OCP.gp import gp_Ax3, gp_Dir, gp_Pnt, gp_Trsf

from tol3d.errors import GeometryError
from tol3d.parts.details import LEAST_WALL
from tol3d.parts.link_ends import RELIEF, Distal, Proximal
from tol3d.parts.named_boolean import cut, fused
from tol3d.parts.named_solid import NamedSolid
from tol3d.parts.turned import AXIS, Corner, section, turned

BODY_SHARE: Final = 0.85
"""Diameter of the tube at an end, as a share of the largest that its drum has room for."""
LEAST_LEFT: Final = 0.1
"""Share of a seat, a pilot and a bore that is left at least where drums lie in each other, as in a wrist."""
TOO_NEAR: Final = "the drums of the link are too large for how near its joints lie"

Array = NDArray[np.float64]
End: TypeAlias = Proximal | Distal


def cast_link(proximal: Proximal, distal: Distal, wall: float, body: float | None = None) -> NamedSolid:
    """A hollow link from the frame of the joint before it, the part's own, to that of the joint after it [mm].

    Faces: "seat" (-z), "pilot" and "pilot end", "hole"; "bore" and "mouth" round it, or "flange" where there is no
    bore; outside "proximal side", "proximal back", "distal side", "distal back", "body"; and what is inside. A face
    that the other end divides is "seat", "seat piece 2" and so on.

    Args:
        proximal, distal: both ends.
        wall: thickness of all walls.
        body: diameter of the tube; default: at either end 0.85 of what its drum has room for. Drums that
            lie in each other have none.

    Raises:
        GeometryError: walls that leave nothing inside, a tube that leaves through the seat or the mouth or does not fit
            the drums, or ends that leave nothing of each other's seat, pilot or bore.
    """
    if not LEAST_WALL <= wall < math.inf:
        raise GeometryError(f"a link needs a wall, got {wall:g} mm")
    ends: tuple[End, End] = proximal, distal
    for end in ends:
        end.refuse(wall)
    tube = _Tube.between(proximal, distal, wall, body)
    outside, inside = [_distal(distal)], [_inside_proximal(proximal, wall), _inside_distal(distal, wall)]
    if tube is not None:
        outside.append(tube.solid("body", 0.0))
        inside.append(tube.solid("inside body", wall))
    try:
        made = cut(fused(_proximal(proximal), outside, "the link"), inside, "the link")
    except GeometryError as error:
        if tube is not None:
            raise
        raise GeometryError(f"{TOO_NEAR}: they cut each other into pieces") from error
    for name, area in _areas(proximal, distal):
        left = sum(face.Area() for own, face in made.faces.items() if own == name or own.startswith(f"{name} piece "))
        if left < LEAST_LEFT * area:
            raise GeometryError(f"{TOO_NEAR}: {100 * left / area:.0f} % of its {name} is left")
    return made


@dataclass(frozen=True, eq=False)
class _Tube:
    """A tube between two places (3,) and its outer radii there [mm]."""

    begin: Array
    end: Array
    radii: tuple[float, float]

    @classmethod
    def between(cls, proximal: Proximal, distal: Distal, wall: float, diameter: float | None) -> "_Tube | None":
        """From the middle of the room in one drum to that in the other; None where the line leaves neither of them."""
        begin, end = _middle(proximal), _middle(distal)
        apart = float(np.linalg.norm(end - begin))
        if apart <= wall:
            return None
        along = (end - begin) / apart
        if _reach(proximal, along) + _reach(distal, -along) >= apart + wall:
            return None
        ends: tuple[tuple[End, Array], ...] = (proximal, along), (distal, -along)
        most = [_widest(own, out, apart) for own, out in ends]
        radii = [min(BODY_SHARE * own, *most) if diameter is None else diameter / 2 for own in most]
        for (own, out), largest in zip(ends, most, strict=True):
            if largest - wall < LEAST_WALL and float(out @ np.array(own.inwards)) < 0.0:
                word = "seat" if isinstance(own, Proximal) else "flange" if own.bore is None else "mouth of its bore"
                raise GeometryError(
                    f"the other joint lies before the {_word(own)} drum of the link: its body would leave the drum "
                    f"through the {word}"
                )
        for (own, _), radius, largest in zip(ends, radii, most, strict=True):
            if not wall + LEAST_WALL <= radius <= largest:
                raise GeometryError(
                    f"a body of {2 * radius:.4g} mm does not fit the {_word(own)} drum of the link, which has room for "
                    f"{2 * largest:.4g} mm, or a wall of {wall:g} mm leaves nothing inside it"
                )
        return cls(begin, end, (radii[0], radii[1]))

    def solid(self, name: str, off: float) -> NamedSolid:
        """The tube as a solid that is thinner all round."""
        first, last = (radius - off for radius in self.radii)
        span = self.end - self.begin
        long = float(np.linalg.norm(span))
        corners = [
            (f"{name} begin", 0.0, 0.0),
            (name, first, 0.0),
            (f"{name} end", last, long),
            (AXIS, 0.0, long),
        ]
        return _about(corners, self.begin, span / long)


def _word(end: End) -> str:
    return "proximal" if isinstance(end, Proximal) else "distal"


def _middle(end: End) -> Array:
    """The middle of the room for the body."""
    return np.asarray(np.array(end.centre) + sum(end.room) / 2 * np.array(end.inwards))


def _widest(end: End, along: Array, length: float) -> float:
    """Largest radius of a tube from that middle in a direction (3,) which the drum holds, clear of its seat or mouth.

    The tube begins with a disc square to it. One that comes down to the plane of the seat leaves the drum before, or
    ends before; below 0 if neither.
    """
    low, high = end.room
    rise = float(along @ np.array(end.inwards))
    level = math.sqrt(max(0.0, 1.0 - rise**2))
    most: float = min(end.diameter / 2, (high - low) / 2 / level if level > 0.0 else math.inf)
    if rise >= 0.0:
        return most
    middle = (low + high) / 2
    ends_before = (middle + length * rise) / level if level > 0.0 else -math.inf
    return min(most, float(max(middle * level + end.diameter / 2 * rise, ends_before)))


def _reach(end: End, along: Array) -> float:
    """Distance from that middle to the surface of the drum."""
    middle, rise = sum(end.room) / 2, float(along @ np.array(end.inwards))
    ahead = end.room[1] - middle if rise > 0.0 else middle
    level = math.sqrt(max(0.0, 1.0 - rise**2))
    return min(
        *(far / part if part > 0.0 else math.inf for far, part in ((end.diameter / 2, level), (ahead, abs(rise))))
    )


def _about(corners: list[Corner], origin: Array, axis: Array) -> NamedSolid:
    """A section turned about an axis through a place."""
    placed = gp_Trsf()
    placed.SetDisplacement(gp_Ax3(), gp_Ax3(gp_Pnt(*origin.tolist()), gp_Dir(*axis.tolist())))
    return turned(section(corners), "the link").moved(cq.Location(placed))


def _proximal(end: Proximal) -> NamedSolid:
    """Its drum with its pilot."""
    corners: list[Corner] = []
    if end.pilot is not None:
        wide, half = end.pilot.diameter / 2, end.pilot.length / 2
        corners = [
            ("pilot end", 0.0, -half),
            ("pilot", wide, -half),
            ("relief floor", wide, half),
            ("relief", wide + RELIEF, half),
            ("seat", wide + RELIEF, 0.0),
        ]
    else:
        corners = [("seat", 0.0, 0.0)]
    corners += [
        ("proximal side", end.diameter / 2, 0.0),
        ("proximal back", end.diameter / 2, end.height),
        (AXIS, 0.0, end.height),
    ]
    return _about(corners, np.array(end.centre), np.array(end.inwards))


def _inside_proximal(end: Proximal, wall: float) -> NamedSolid:
    """The hollow of its drum, with the hole."""
    low, high = end.room[0] + wall, end.height - wall
    wide = end.diameter / 2 - wall
    corners: list[Corner] = [("inside floor", 0.0, low)]
    if end.hole:
        outer = 0.0 if end.pilot is None else -end.pilot.length / 2
        corners = [("outside hole", 0.0, outer), ("hole", end.hole / 2, outer), ("inside floor", end.hole / 2, low)]
    corners += [("inside proximal", wide, low), ("inside back", wide, high), (AXIS, 0.0, high)]
    return _about(corners, np.array(end.centre), np.array(end.inwards))


def _distal(end: Distal) -> NamedSolid:
    """Its drum without its bore."""
    corners: list[Corner] = [
        ("distal back", 0.0, -end.depth),
        ("distal side", end.diameter / 2, -end.depth),
        ("flange" if end.bore is None else "mouth", end.diameter / 2, end.front),
        (AXIS, 0.0, end.front),
    ]
    return _about(corners, np.array(end.at), np.array(end.axis))


def _inside_distal(end: Distal, wall: float) -> NamedSolid:
    """The hollow of its drum, with the bore."""
    wide, back = end.diameter / 2 - wall, wall - end.depth
    corners: list[Corner] = [("inside distal back", 0.0, back), ("inside distal", wide, back)]
    if end.bore is None:
        corners += [("inside flange", wide, -wall), (AXIS, 0.0, -wall)]
    else:
        bore = end.bore.diameter / 2
        if wide - bore >= LEAST_WALL:
            corners.append(("inside mouth", wide, -end.front))
        corners += [("bore", bore, -end.front), ("outside bore", bore, end.front), (AXIS, 0.0, end.front)]
    return _about(corners, np.array(end.at), np.array(end.axis))


def _areas(proximal: Proximal, distal: Distal) -> Iterator[tuple[str, float]]:
    """Whole areas of the faces by which a link lies on its joints and holds them."""
    inner = proximal.hole
    if proximal.pilot is not None:
        inner = proximal.pilot.diameter + 2 * RELIEF
        yield "pilot", math.pi * proximal.pilot.diameter * proximal.pilot.length
    yield "seat", math.pi / 4 * (proximal.diameter**2 - inner**2)
    if distal.bore is not None:
        yield "bore", math.pi * distal.bore.diameter * distal.bore.length
    else:
        yield "flange", math.pi / 4 * distal.diameter**2
