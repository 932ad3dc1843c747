"""The solid of a carrier: two round flanges with holes, joined by round posts."""

import math

import cadquery as cq

from tol3d.errors import GeometryError
from tol3d.parts.machining import cylinder
from tol3d.parts.named_boolean import fused
from tol3d.parts.named_solid import NamedEdge, NamedSolid, extruded
from tol3d.parts.round_hole import RoundHole, circle_edge


def carrier(
    flange_diameter: float,
    flange_width: float,
    between: float,
    circle_radius: float,
    holes: int,
    hole_diameter: float,
    post_diameter: float,
    bore_diameter: float,
) -> NamedSolid:
    """Two flanges about z on either side of z = 0, so far apart, their first hole on +x and posts midway between holes.

    Faces, of the flange at -z as of that at +z: "lower rim", "lower hole 1" and so on, "lower bore", "lower outside"
    and "lower inside"; of the posts "post 1" and so on.

    Args:
        flange_diameter, flange_width: [mm].
        between: the flanges' inner faces [mm].
        circle_radius: of the axes of holes and posts [mm].
        holes: how many, and as many posts.
        hole_diameter, post_diameter, bore_diameter: [mm]; a bore of 0 is none; without posts, of 0, the lower flange
            alone is made.

    Raises:
        GeometryError: holes or posts that leave the flange or meet.
    """
    reach = circle_radius + max(hole_diameter, post_diameter) / 2
    beside = 2 * circle_radius * math.sin(math.pi / (2 * holes))
    if reach >= flange_diameter / 2 or (hole_diameter + post_diameter) / 2 >= beside:
        raise GeometryError(
            f"holes of {hole_diameter:g} mm and posts of {post_diameter:g} mm at {circle_radius:g} mm do not fit a "
            f"flange of {flange_diameter:g} mm"
        )
    if 2 * circle_radius - max(hole_diameter, post_diameter) <= bore_diameter:
        raise GeometryError(f"a bore of {bore_diameter:g} mm meets the holes or the posts of its flange")
    flanges = [
        _flange(side, sign, flange_diameter, flange_width, between, circle_radius, holes, hole_diameter, bore_diameter)
        for side, sign in (("lower", -1), ("upper", 1))
    ]
    if not post_diameter:
        return flanges[0]
    posts = []
    for number in range(holes):
        azimuth = math.pi * (2 * number + 1) / holes
        foot = circle_radius * math.cos(azimuth), circle_radius * math.sin(azimuth), -between / 2
        name = f"post {number + 1}"
        posts.append(cylinder(foot, (0.0, 0.0, 1.0), post_diameter, between, name, f"{name} foot"))
    return fused(flanges[0], [flanges[1], *posts], "the carrier")


def _flange(
    side: str,
    sign: int,
    diameter: float,
    width: float,
    between: float,
    circle_radius: float,
    count: int,
    hole_diameter: float,
    bore_diameter: float,
) -> NamedSolid:
    level = -width / 2
    azimuths = [2 * math.pi * number / count for number in range(count)]
    holes = [
        RoundHole(f"hole {number}", (circle_radius * math.cos(at), circle_radius * math.sin(at)), hole_diameter)
        for number, at in enumerate(azimuths, start=1)
    ]
    if bore_diameter:
        holes.append(RoundHole("bore", (0.0, 0.0), bore_diameter))
    rim = NamedEdge("rim", circle_edge((0.0, 0.0), diameter, level))
    made = extruded([rim], [[hole.edge(level)] for hole in holes], width)
    ends = {"front": "outside" if sign > 0 else "inside", "back": "inside" if sign > 0 else "outside"}
    faces = {f"{side} {ends.get(name, name)}": face for name, face in made.faces.items()}
    return NamedSolid(made.solid, faces).moved(cq.Location((0.0, 0.0, sign * (between + width) / 2)))
