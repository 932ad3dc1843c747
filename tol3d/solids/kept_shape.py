"""Solids that a program of the user built: what it made is kept, and it is never run again."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

from tol3d.files import FileContent
from tol3d.solids.built_shape import BuiltShape
from tol3d.solids.lazy import cad


@dataclass(frozen=True)
class KeptShape(BuiltShape):
    """A solid as OCC writes it.

    Args:
        sha256: of what it writes, by which the shape is known.
        faces: names in the order of the solid's faces.
        brep: what it writes: data, which executes nothing when it is read.
    """

    builder: ClassVar[str] = "tol3d.solids.own_program:read"

    sha256: str
    faces: tuple[str, ...]
    brep: bytes = field(repr=False, compare=False)

    @classmethod
    def of(cls, brep: bytes, faces: Sequence[str]) -> "KeptShape":
        """A solid that was kept."""
        return cls(hashlib.sha256(brep).hexdigest(), tuple(faces), brep)


def run_program(file: FileContent, function: str, dimensions: Mapping[str, float]) -> KeptShape:
    """Run a builder of the user's and keep what it makes.

    Args:
        file: a Python module.
        function: of it, see tol3d.solids.own_program.
        dimensions: its keyword arguments [mm, rad].

    Raises:
        GeometryError: it fails, or makes no solid.
    """
    brep, faces = cad().run_program(file, function, dimensions)
    return KeptShape.of(brep, faces)
