"""A CAD solid whose faces bear the names of the edges that swept them."""

import errno
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import cadquery as cq
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
from OCP.gp import gp_Dir, gp_Pln, gp_Pnt, gp_Vec
from OCP.TopoDS import TopoDS_Wire

from tol3d.errors import GeometryError, unwritable

FRONT, BACK = "front", "back"
STEP_END = b"END-ISO-10303-21;"  # ISO 10303-21: the last token of every such file
MOST_BLANKS = 16  # bytes behind it


@dataclass(frozen=True)
class NamedEdge:
    """An edge of an outline, oriented along it, and the name of the face that it will sweep."""

    name: str
    edge: cq.Edge


@dataclass(frozen=True)
class NamedSolid:
    """One closed solid [mm] and its faces by name, oriented as in the solid (outwards)."""

    solid: cq.Solid
    faces: Mapping[str, cq.Face]

    def moved(self, location: cq.Location) -> "NamedSolid":
        """The same elsewhere."""
        return NamedSolid(self.solid.moved(location), {name: face.moved(location) for name, face in self.faces.items()})


def numbered(solid: cq.Solid) -> NamedSolid:
    """A solid whose faces nobody picks by name: "face 1" and so on, in its own order."""
    return NamedSolid(solid, {f"face {number}": face for number, face in enumerate(solid.Faces(), 1)})


def extruded(outline: Sequence[NamedEdge], holes: Sequence[Sequence[NamedEdge]], width: float) -> NamedSolid:
    """Sweep an outline along +z, from its plane z = -width/2 to +width/2 [mm].

    Names come from the sweep's own history, not from positions. The end at +z is the face "front"
    (seen from +z it lies in front), the other "back".

    Args:
        outline: edges in order, counter-clockwise seen from +z, sharing their vertices.
        holes: edges of each hole in order, clockwise, sharing their vertices.
        width: along z [mm].

    Raises:
        GeometryError: the outline makes no valid solid.
    """
    plane = gp_Pln(gp_Pnt(0.0, 0.0, -width / 2), gp_Dir(0.0, 0.0, 1.0))
    face = BRepBuilderAPI_MakeFace(plane, wire_of(outline), True)
    for hole in holes:
        face.Add(wire_of(hole))
    if not face.IsDone():
        raise GeometryError("the outline of the part does not close into one face")
    prism = BRepPrimAPI_MakePrism(face.Face(), gp_Vec(0.0, 0.0, width))
    solid = cq.Solid(prism.Shape())
    if not solid.isValid():
        raise GeometryError("the outline of the part crosses itself: its solid is not valid")
    swept = {
        named.name: cq.Face(next(iter(prism.Generated(named.edge.wrapped)))) for named in (*outline, *chain(*holes))
    }
    ends = {FRONT: cq.Face(prism.LastShape()), BACK: cq.Face(prism.FirstShape())}
    # history returns each face as it was made; the solid holds the same face turned outwards
    outward = {face: face for face in solid.Faces()}
    return NamedSolid(solid, {name: outward[face] for name, face in (swept | ends).items()})


def wire_of(edges: Sequence[NamedEdge]) -> TopoDS_Wire:
    """Edges in order, sharing their vertices, as one closed wire."""
    builder, wire = BRep_Builder(), TopoDS_Wire()
    builder.MakeWire(wire)
    for named in edges:
        builder.Add(wire, named.edge.wrapped)
    wire.Closed(True)
    return wire


def to_step(part: NamedSolid, path: Path) -> None:
    """Write the solid as STEP (AP214, mm); the file appears whole or not at all.

    Raises:
        RunError: the file cannot be written.
    """
    unfinished = path.with_name(f"{path.name}.{os.getpid()}.partial")
    try:
        part.solid.exportStep(str(unfinished))
        refuse_cut_step(unfinished)
        unfinished.replace(path)
    except OSError as error:
        raise unwritable(path, error, "choose another file") from error
    finally:
        unfinished.unlink(missing_ok=True)


def refuse_cut_step(path: Path) -> None:
    """Raise unless a STEP file has its end: OCC says nothing of a disk that is full.

    Raises:
        OSError: it was cut short.
    """
    with path.open("rb") as stream:
        stream.seek(max(0, stream.seek(0, os.SEEK_END) - len(STEP_END) - MOST_BLANKS))
        if STEP_END not in stream.read():
            raise OSError(errno.EIO, "the CAD kernel wrote a part of it only")
