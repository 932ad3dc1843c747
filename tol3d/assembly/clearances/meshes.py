"""Meshes of solids that meet a chord error."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import GeometryError
from tol3d.solids import BuiltShape, DisplayMesh, display_mesh

Array = NDArray[np.float64]

COARSE: Final = 0.1
"""mm; a mesh from which it is seen how many triangles a finer one has."""
MOST_TRIANGLES: Final = 1_000_000
"""Of one part: some 300 MB with its hierarchy of bounding volumes."""
TRIES: Final = 8
"""Deflections that are tried: OCC meets what it is given within a factor of two."""


@dataclass(frozen=True, eq=False)
class SolidMesh:
    """A closed mesh of a solid, in the frame of its part.

    Args:
        vertices: (n, 3) [mm].
        triangles: (m, 3) vertex numbers, turned outwards.
        chord_error: largest distance between the mesh and the faces of the solid [mm].
    """

    vertices: Array
    triangles: NDArray[np.int64]
    chord_error: float

    @property
    def corners(self) -> Array:
        """Of the triangles (m, 3, 3) [mm]."""
        return np.asarray(self.vertices[self.triangles])

    @property
    def box(self) -> Array:
        """Corners of the smallest box about it along its axes (8, 3) [mm]."""
        ends = np.array([self.vertices.min(axis=0), self.vertices.max(axis=0)])
        return np.array([[ends[i, 0], ends[j, 1], ends[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])


@lru_cache(maxsize=16)
def solid_mesh(shape: BuiltShape, within: float) -> SolidMesh:
    """A mesh of a solid, cached on disk.

    Args:
        shape: what is built.
        within: what its chord error is to be at most [mm].

    Raises:
        GeometryError: it would take too many triangles.
    """
    mesh = display_mesh(shape, COARSE)
    deflection = COARSE
    for _ in range(TRIES):
        if mesh.chord_error <= within:
            return SolidMesh(mesh.vertices, mesh.triangles, mesh.chord_error)
        finer = deflection * 0.8 * within / mesh.chord_error
        if len(mesh.triangles) * min(deflection / finer, 2.0) > MOST_TRIANGLES:
            break
        # a part of small curved faces takes many triangles more; it is approached, so that it is seen in time
        deflection = max(finer, deflection / 8)
        mesh = display_mesh(shape, deflection)
    raise GeometryError(_too_fine(mesh, within))


def _too_fine(mesh: DisplayMesh, within: float) -> str:
    words = f"its mesh has {len(mesh.triangles)} triangles with a chord error of {1000 * mesh.chord_error:.2g} um"
    return f"{words}, and would take too many for {1000 * within:.2g} um; state a larger chord_error"
