"""Round holes through what is swept along z."""

from dataclasses import dataclass

import cadquery as cq
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.Geom import Geom_Circle
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

from tol3d.parts.named_solid import NamedEdge


@dataclass(frozen=True)
class RoundHole:
    """A hole along z.

    Args:
        name: of its wall.
        at: x, y of its centre [mm].
        diameter: [mm].
    """

    name: str
    at: tuple[float, float]
    diameter: float

    def edge(self, level: float) -> NamedEdge:
        """Its edge in the plane z = level [mm], clockwise seen from +z."""
        return NamedEdge(self.name, circle_edge(self.at, self.diameter, level, -1.0))


def circle_edge(at: tuple[float, float], diameter: float, level: float, up: float = 1.0) -> cq.Edge:
    """A circle in the plane z = level [mm]; seen from +z it runs counter-clockwise, or clockwise for up = -1."""
    around = Geom_Circle(gp_Ax2(gp_Pnt(*at, level), gp_Dir(0.0, 0.0, up)), diameter / 2)
    return cq.Edge(BRepBuilderAPI_MakeEdge(around).Edge())
