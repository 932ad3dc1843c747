"""The solid of a bar, by CadQuery."""

import cadquery as cq

from tol3d.parts.named_solid import NamedSolid, numbered
from toys.parabola.bar import Bar


def bar_solid(shape: Bar) -> NamedSolid:
    return numbered(cq.Solid.makeBox(shape.side, shape.side, shape.length))
