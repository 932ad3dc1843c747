"""Display meshes: whole solids of gears, shafts and arms as closed triangles, for pictures and files, not measuring."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.gears import Gear
from tol3d.numerics.arrays import Array
from tol3d.solids.bodies import Body
from tol3d.solids.built_shape import BuiltShape
from tol3d.solids.cache import cached
from tol3d.solids.lazy import cad


@dataclass(frozen=True, eq=False)
class DisplayMesh:
    """A closed triangle mesh in the frame of the gear or the shaft.

    Args:
        vertices: (n, 3) [mm].
        triangles: (m, 3) vertex numbers, turned outwards.
        side: (n,) which side of its tooth a vertex lies on (flank, radial line or fillet): RIGHT, LEFT
            or 0 for neither (tip, root, bore, ends, whatever has no teeth).
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


def display_mesh(shape: Gear | Body | BuiltShape, deflection: float) -> DisplayMesh:
    """Mesh whose faces follow the solid's within about `deflection` [mm]; see its chord_error for the truth."""
    arrays = cached("display", shape, {"deflection": deflection}, lambda: cad().tessellate(shape, deflection))
    return DisplayMesh(
        vertices=arrays["vertices"].astype(np.float64),
        triangles=arrays["triangles"].astype(np.int64),
        side=arrays["side"].astype(np.int8),
        chord_error=float(arrays["chord_error"]),
    )
