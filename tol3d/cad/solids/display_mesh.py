"""Display meshes: whole solids of gears, shafts and arms as closed triangles, for pictures and files, not measuring."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.cad.solids.built_shape import BuiltShape, MeshedShape
from tol3d.cad.solids.cache import cached
from tol3d.cad.solids.lazy import Arrays, cad
from tol3d.cad.solids.posed_gear import Body, PosedPart
from tol3d.cad.solids.written_apart import write_apart
from tol3d.gears import Gear
from tol3d.numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class DisplayMesh:
    """A closed triangle mesh in the frame of the gear or the shaft.

    Args:
        vertices: (n, 3) [mm].
        triangles: (m, 3) vertex numbers, turned outwards.
        side: (n,) which side of its tooth a vertex lies on (flank, radial line or fillet): RIGHT, LEFT
            or 0 for neither (tip, root, bore, ends, anything without teeth).
        chord_error: largest distance [mm] between the mesh and the solid's faces.
    """

    vertices: Array
    triangles: NDArray[np.int64]
    side: NDArray[np.int8]
    chord_error: float

    def thickened(self, half_angle: float) -> Array:
        """Vertices (n, 3) with each side of the teeth turned outwards by an angle [rad] about the axis.

        With half_angle = tooth thickness deviation / (2 r) this is the gear of that deviation: an
        involute turned is its own parallel, fillets turn along, and tip and root stay on their circles.
        """
        azimuth = -half_angle * self.side
        cos, sin = np.cos(azimuth), np.sin(azimuth)
        x, y, z = self.vertices.T
        return np.stack([cos * x - sin * y, sin * x + cos * y, z], axis=-1)


def surface_of(shape: BuiltShape, deflection: float) -> tuple[Array, NDArray[np.int64]]:
    """Vertices (n, 3) [mm] and triangles (m, 3) of a shape's display mesh."""
    mesh = display_mesh(shape, deflection)
    return mesh.vertices, mesh.triangles


def paint_of(shape: BuiltShape, deflection: float) -> Sequence[str]:
    """The colour of each triangle of a shape's display mesh, "#RRGGBB", empty if it has none; () if none has one."""
    return shape.colours(deflection) if isinstance(shape, MeshedShape) else ()


def display_mesh(shape: Gear | Body | BuiltShape, deflection: float) -> DisplayMesh:
    """Mesh whose faces follow the solid's within about `deflection` [mm]; see its chord_error for the truth."""
    if isinstance(shape, MeshedShape):
        arrays = shape.mesh(deflection)
    else:
        arrays = cached("display", shape, {"deflection": deflection}, lambda: cad().tessellate(shape, deflection))
    return DisplayMesh(
        vertices=arrays["vertices"].astype(np.float64),
        triangles=arrays["triangles"].astype(np.int64),
        side=arrays["side"].astype(np.int8),
        chord_error=float(arrays["chord_error"]),
    )


def bounding_box(shape: BuiltShape) -> tuple[Array, Array]:
    """Lowest and highest x, y, z (3,) [mm] of a solid, to about 1e-6 mm; of a stranger's file those of its triangles.

    Raises:
        GeometryError: the solid cannot be built.
    """
    if isinstance(shape, MeshedShape):
        vertices = display_mesh(shape, BOX_DEFLECTION).vertices
        return vertices.min(axis=0), vertices.max(axis=0)

    def build() -> Arrays:
        return {"corners": np.array(cad().box_around(shape))}

    low, high = cached("box", shape, {}, build)["corners"].astype(np.float64)
    return low, high


BOX_DEFLECTION: Final = 0.05
"""mm; that of pictures, whose triangles are made already."""

COLOURS: Final = ("steelblue", "darkorange", "seagreen", "goldenrod", "slategray", "indianred")


def export_step(parts: Sequence[PosedPart], path: Path, colours: Sequence[str] = COLOURS) -> None:
    """Write the parts as a STEP assembly [mm] with their names and colours.

    Solids are built from each gear as it is, its tooth thickness deviation included. The file
    appears whole or not at all.

    Args:
        parts: names differ and hold no colon at their beginnings.
        path: the file.
        colours: of the parts in order, names or "#RRGGBB"; begun again when there are more parts.

    Raises:
        RunError: the file cannot be written.
    """
    if any(isinstance(part.shape, MeshedShape) for part in parts):
        write_apart(parts, path, colours)
    else:
        cad().write_step(parts, path, colours)
