"""STEP files of others for tests: NIST's models, and small solids that CadQuery writes, whose numbers are known."""

import gzip
import math
from pathlib import Path
from typing import Final

import cadquery as cq
from OCP.Interface import Interface_Static
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
from places import TESTS

from tol3d.files import FileContent, read_file

NIST: Final = TESTS / "step" / "nist"
TURNED: Final = ((40.0, -7.0, 12.5), (1.0, 2.0, 3.0), 37.0)
"""Pose of a part that is not at its origin: place [mm], axis, angle [deg]."""


def nist_file(model: str) -> FileContent:
    """A model of NIST's, such as ftc_10."""
    (path,) = NIST.glob(f"nist_{model}_*.stp.gz")
    return FileContent(path.with_suffix(""), gzip.decompress(path.read_bytes()))


def solid(made: cq.Workplane) -> cq.Shape:
    """Solid that a workplane has made."""
    shape = made.val()
    assert isinstance(shape, cq.Shape)
    return shape


def halved_plate() -> cq.Shape:
    """A plate 60 × 40 × 10 mm of two halves that share the wall x = 0, each with half of a ⌀12 hole on z."""
    left = cq.Workplane().box(30, 40, 10).translate((-15, 0, 0))
    right = cq.Workplane().box(30, 40, 10).translate((15, 0, 0))
    hole = cq.Workplane().circle(6).extrude(30).translate((0, 3, -15))
    return solid(left.cut(hole)).fuse(solid(right.cut(hole)))


def slotted_block() -> cq.Shape:
    """A block 40 × 30 × 20 mm whose top a slot along y interrupts, with a ⌀5 pin on its left half and a blind ⌀8 hole.

    The pin stands at (-12, 0), 9 mm high; the hole is drilled at (13, 0) to 15 mm and ends flat. Edges along z have R4.
    """
    block = cq.Workplane().box(40, 30, 20).edges("|Z").fillet(4)
    block = block.cut(cq.Workplane().box(6, 40, 8).translate((0, 0, 8)))
    block = block.union(cq.Workplane().circle(2.5).extrude(9).translate((-12, 0, 10)))
    return solid(block.cut(cq.Workplane().circle(4).extrude(15).translate((13, 0, -5))))


def socket() -> cq.Shape:
    """A block 30 mm wide with a spherical seat S⌀20 about (0, 0, 15), and a cone below."""
    block = cq.Workplane().box(30, 30, 30)
    block = block.cut(cq.Workplane().sphere(10).translate((0, 0, 15)))
    cone = cq.Solid.makeCone(6, 3, 8, cq.Vector(0, 0, -15), cq.Vector(0, 0, 1))
    return solid(block.cut(cq.Workplane(cone)))


def turned(shape: cq.Shape) -> cq.Shape:
    """A shape that stands elsewhere, as TURNED says."""
    place, axis, angle = TURNED
    return shape.rotate(cq.Vector(0, 0, 0), cq.Vector(*axis), angle).translate(cq.Vector(*place))


def moved(point: tuple[float, float, float]) -> tuple[float, ...]:
    """A point of a shape that is turned (3,), by Rodrigues' formula."""
    place, axis, angle = TURNED
    return tuple(own + off for own, off in zip(rotated(point, axis, math.radians(angle)), place, strict=True))


def rotated(vector: tuple[float, float, float], axis: tuple[float, float, float], angle: float) -> tuple[float, ...]:
    """A vector turned about an axis [rad]."""
    size = math.hypot(*axis)
    k = tuple(own / size for own in axis)
    cross = (
        k[1] * vector[2] - k[2] * vector[1],
        k[2] * vector[0] - k[0] * vector[2],
        k[0] * vector[1] - k[1] * vector[0],
    )
    dot = sum(own * other for own, other in zip(k, vector, strict=True))
    c, s = math.cos(angle), math.sin(angle)
    return tuple(v * c + x * s + w * dot * (1 - c) for v, x, w in zip(vector, cross, k, strict=True))


def inch_file(shape: cq.Shape, path: Path) -> FileContent:
    """A file whose lengths are inches, with one product."""
    writer = STEPControl_Writer()  # the parameter is there only after a first one was made
    Interface_Static.SetCVal_s("write.step.unit", "INCH")
    try:
        writer.Transfer(shape.wrapped, STEPControl_AsIs)
        writer.Write(str(path))
    finally:
        Interface_Static.SetCVal_s("write.step.unit", "MM")
    return read_file(path)


def step_file(shapes: dict[str, cq.Shape], path: Path) -> FileContent:
    """A file with products of these shapes."""
    assembly = cq.Assembly(name="all")
    for name, shape in shapes.items():
        assembly.add(shape, name=name)
    assembly.export(str(path), exportType="STEP")
    return read_file(path)
