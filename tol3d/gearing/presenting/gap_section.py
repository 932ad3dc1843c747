"""A mesh cut across its gap, where and as wide as it was measured."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from tol3d.gearing.placed import SeatedMesh
from tol3d.gears import BevelPair

Array = NDArray[np.float64]

INSIDE: Final = 0.02  # of the common face; a cut at its very end would miss a tilted gear


@dataclass(frozen=True, eq=False)
class GapSection:
    """Both gears in the plane across which their gap lies.

    Args:
        towards: the plane's normal, a unit vector (3,) along the flanks at the gap, to where bevel gears grow.
        ends: the gap's ends on the driver and on the driven gear, (2, 3) [mm].
        outlines: where the plane cuts the gears, driver and driven, as lines.
    """

    towards: Array
    ends: Array
    outlines: tuple[pv.PolyData, pv.PolyData]

    @property
    def middle(self) -> Array:
        """Middle of the gap, (3,) [mm]."""
        return np.asarray(self.ends.mean(axis=0))


def gap_section(seated: SeatedMesh, meshes: Sequence[pv.PolyData]) -> GapSection:
    """Cut a mesh that stands upright (see `view_from_world`) where its gap was measured.

    The flanks of a bevel gear lead to its apex: a cut at any other place than the gap's shows another gap, and who
    looks along the common pitch line instead of along the flanks sees one of them in the gap.

    Args:
        seated: in the coordinates of the picture, z to the front.
        meshes: of driver and driven, closed, in the same coordinates.
    """
    middle = seated.gap.mean(axis=0)
    pair = seated.mesh.pair
    if isinstance(pair, BevelPair):
        along = float(np.linalg.norm(middle))
        towards = middle / along
        ends = seated.gap * (_inside(along, *pair.face) / along)
    else:
        towards = np.array([0.0, 0.0, 1.0])
        low, high = max(mesh.bounds[4] for mesh in meshes), min(mesh.bounds[5] for mesh in meshes)
        ends = seated.gap + (_inside(float(middle[2]), low, high) - middle[2]) * towards
    driver, driven = (mesh.slice(normal=tuple(towards), origin=tuple(ends.mean(axis=0))) for mesh in meshes)
    return GapSection(towards, ends, (driver, driven))


def _inside(place: float, low: float, high: float) -> float:
    margin = INSIDE * (high - low)
    return min(max(place, low + margin), high - margin)
