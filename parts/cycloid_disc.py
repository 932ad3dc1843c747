"""The solid of a cycloid disc: lobes as splines over the profile's parameter, round holes through it."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import cadquery as cq
import numpy as np
from numpy.typing import NDArray
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeVertex
from OCP.Geom import Geom_Curve
from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf
from OCP.TopoDS import TopoDS_Vertex

from tol3d.parts.complete_spline import complete_spline
from tol3d.parts.named_solid import NamedEdge, NamedSolid, extruded
from tol3d.parts.round_hole import RoundHole

Array = NDArray[np.float64]
Side = Literal["right", "left"]


@dataclass(frozen=True, eq=False)
class LobeFlank:
    """One flank of lobe 0 between its root and its tip, as points of a spline.

    Args:
        parameter: (n,) of the profile, rising.
        points: (n, 2) [mm].
        slopes: (2, 2), dP/du at its ends [mm/rad].
    """

    parameter: Array
    points: Array
    slopes: Array


def cycloid_disc(
    right: LobeFlank, left: LobeFlank, lobes: int, width: float, holes: Sequence[RoundHole], turned: float
) -> NamedSolid:
    """A disc about z, its middle z = 0.

    Faces: "lobe k right flank" from the root before lobe k to its tip and "lobe k left flank" from there on, counted
    counter-clockwise; the holes by their names; "front" (+z) and "back". The u parameter of a flank's face is that of
    its points, on lobe 0.

    Args:
        right, left: flanks of lobe 0; the right one begins on the azimuth 0, where the left one of the last lobe ends.
        lobes: how many.
        width: along z [mm].
        holes: through the disc, apart from each other and from the lobes.
        turned: the lobes, counter-clockwise against the holes [rad].

    Raises:
        GeometryError: no valid solid comes of it.
    """
    level = -width / 2
    walls = [[hole.edge(level)] for hole in holes]
    return extruded(list(_outline(right, left, lobes, level, turned)), walls, width)


def _outline(right: LobeFlank, left: LobeFlank, lobes: int, level: float, turned: float) -> Iterator[NamedEdge]:
    """The flanks in order, counter-clockwise; neighbours share the vertex at a root or a tip."""
    sides: dict[Side, LobeFlank] = {"right": right, "left": left}
    curves: dict[Side, Geom_Curve] = {
        side: complete_spline(flank.parameter, flank.points, flank.slopes, level) for side, flank in sides.items()
    }
    ends = {side: flank.parameter[[0, -1]].tolist() for side, flank in sides.items()}
    turns = [_turn(turned + 2 * math.pi * lobe / lobes) for lobe in range(lobes)]
    roots = [_vertex(right.points[0], turn, level) for turn in turns]
    tips = [_vertex(right.points[-1], turn, level) for turn in turns]
    for lobe, turn in enumerate(turns):
        corners: dict[Side, tuple[TopoDS_Vertex, TopoDS_Vertex]] = {
            "right": (roots[lobe], tips[lobe]),
            "left": (tips[lobe], roots[(lobe + 1) % lobes]),
        }
        for side, curve in curves.items():
            made = BRepBuilderAPI_MakeEdge(curve.Transformed(turn), *corners[side], *ends[side])
            yield NamedEdge(flank_face(lobe, side), cq.Edge(made.Edge()))


def flank_face(lobe: int, side: Side) -> str:
    """Name of a flank's face: "lobe 0 right flank"."""
    return f"lobe {lobe} {side} flank"


def _turn(angle: float) -> gp_Trsf:
    turn = gp_Trsf()
    turn.SetRotation(gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0)), angle)
    return turn


def _vertex(point: Array, turn: gp_Trsf, level: float) -> TopoDS_Vertex:
    x, y = point.tolist()
    return BRepBuilderAPI_MakeVertex(gp_Pnt(x, y, level).Transformed(turn)).Vertex()
