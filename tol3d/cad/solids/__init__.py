"""Measuring strips, display meshes and STEP files of CAD solids; cached, so that a later run loads no CAD."""

from tol3d.cad.solids.built_shape import BuiltShape, PosedShape, SweptShape
from tol3d.cad.solids.display_mesh import DisplayMesh, display_mesh, export_step, paint_of, surface_of
from tol3d.cad.solids.posed_gear import ArmBody, Collar, PosedBody, PosedGear, PosedPart, ShaftBody
from tol3d.cad.solids.strips import (
    WHOLE_FACE,
    FaceStrip,
    FlankStrips,
    PulledStrip,
    Span,
    face_strips,
    measuring_strips,
    strip_mesh,
)

__all__ = [
    "WHOLE_FACE",
    "ArmBody",
    "BuiltShape",
    "Collar",
    "DisplayMesh",
    "FaceStrip",
    "FlankStrips",
    "PosedBody",
    "PosedGear",
    "PosedPart",
    "PosedShape",
    "PulledStrip",
    "ShaftBody",
    "Span",
    "SweptShape",
    "display_mesh",
    "export_step",
    "face_strips",
    "measuring_strips",
    "paint_of",
    "strip_mesh",
    "surface_of",
]
