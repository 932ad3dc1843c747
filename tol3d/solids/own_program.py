"""Builders of the user: programs that make the solid of a part, and what they made read again."""

import io
import traceback
from collections.abc import Mapping
from typing import Any

import cadquery as cq

from tol3d.errors import GeometryError
from tol3d.files import FileContent
from tol3d.parts.named_solid import NamedSolid
from tol3d.solids.kept_shape import KeptShape


def run_program(file: FileContent, function: str, dimensions: Mapping[str, float]) -> tuple[bytes, tuple[str, ...]]:
    """What a function of a Python file makes: OCC's text of the solid, and names of its faces in their order.

    The function takes the dimensions as keyword arguments [mm, rad] and returns a `NamedSolid`, a `cadquery.Workplane`
    (faces are called by its tags) or a `cadquery.Solid`; faces without a name are "face 1" and so on.

    Raises:
        GeometryError: it cannot be read, fails, or makes no valid solid; with the line of the file.
    """
    names: dict[str, Any] = {"__name__": "tol3d_builder", "__file__": str(file.path)}
    try:
        exec(compile(file.content, str(file.path), "exec"), names)
        if not callable(names.get(function)):
            there = ", ".join(sorted(name for name, own in names.items() if callable(own) and name[0] != "_"))
            raise GeometryError(f"{file.path}: expected a function {function!r}, found: {there or 'none'}")
        made = names[function](**dimensions)
    except GeometryError:
        raise
    except Exception as error:
        raise GeometryError(f"{_line(error, file)}: {type(error).__name__}: {error}") from None
    solid, named = _solid_and_names(made, file)
    if not solid.isValid():
        raise GeometryError(f"{file.path}: {function} makes a solid that is not valid")
    faces = solid.Faces()
    called = tuple(
        next((name for name, own in named.items() if own.isSame(face)), f"face {number}")
        for number, face in enumerate(faces, 1)
    )
    if missing := [name for name in named if name not in called]:
        words = f"the face {missing[0]!r} is none of the solid that {function} returns"
        raise GeometryError(f"{file.path}: {words}; tag it after all cuts")
    stream = io.BytesIO()
    solid.exportBrep(stream)
    return stream.getvalue(), called


def read(shape: KeptShape) -> NamedSolid:
    """The solid that was kept.

    Raises:
        GeometryError: it is none.
    """
    solid = cq.Shape.importBrep(io.BytesIO(shape.brep))
    if not isinstance(solid, cq.Solid) or len(solid.Faces()) != len(shape.faces):
        raise GeometryError("the solid that was kept is damaged")
    return NamedSolid(solid, dict(zip(shape.faces, solid.Faces(), strict=True)))


def _solid_and_names(made: Any, file: FileContent) -> tuple[cq.Solid, Mapping[str, cq.Face]]:
    if isinstance(made, NamedSolid):
        return made.solid, made.faces
    named: dict[str, cq.Face] = {}
    if isinstance(made, cq.Workplane):
        for tag, plane in made.ctx.tags.items():
            if len(plane.objects) == 1 and isinstance(plane.objects[0], cq.Face):
                named[tag] = plane.objects[0]
        made = made.val()
    solids = made.Solids() if isinstance(made, cq.Shape) else []
    if len(solids) != 1:
        got = f"{len(solids)} solids" if isinstance(made, cq.Shape) else type(made).__name__
        raise GeometryError(f"{file.path}: expected one solid (NamedSolid, cadquery Workplane or Solid), got {got}")
    return solids[0], named


def _line(error: Exception, file: FileContent) -> str:
    """Where in the file an error came up."""
    if isinstance(error, SyntaxError):
        return f"{file.path}:{error.lineno}"
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(file.path)]
    return f"{file.path}:{lines[-1]}" if lines else str(file.path)
