"""Lazy import of CadQuery: it costs seconds, so it is loaded only when a solid must be built."""

import importlib
from collections.abc import Sequence
from pathlib import Path
from typing import Protocol, cast

import numpy as np
from numpy.typing import NDArray

from tol3d.cad.solids.built_shape import BuiltShape
from tol3d.cad.solids.pick import Pick, PickedFace
from tol3d.cad.solids.posed_gear import Body, PosedPart
from tol3d.gears import Gear

CAD = "tol3d.cad.solids.cad"

Arrays = dict[str, NDArray[np.generic]]


class Cad(Protocol):
    """Interface of tol3d.cad.solids.cad."""

    def sample_flanks(self, gear: Gear, steps: int) -> Arrays:
        """Arrays of FlankStrips."""
        ...

    def sample_faces(self, shape: BuiltShape, faces: Sequence[str], steps: int) -> Arrays:
        """Arrays of FaceStrips."""
        ...

    def tessellate(self, shape: Gear | Body | BuiltShape, deflection: float) -> Arrays:
        """Arrays of DisplayMesh."""
        ...

    def pick_faces(self, shape: BuiltShape, picks: Sequence[Pick]) -> Sequence[PickedFace]:
        """The faces that picks mean."""
        ...

    def box_around(self, shape: BuiltShape) -> tuple[list[float], list[float]]:
        """Lowest and highest x, y, z of a solid."""
        ...

    def write_step(self, parts: Sequence[PosedPart], path: Path, colours: Sequence[str]) -> None:
        """Write an assembly."""
        ...


def cad() -> Cad:
    """The module that talks to CadQuery, imported at the first call."""
    return cast(Cad, importlib.import_module(CAD))
