"""Triangles of a part that can be nearest to another one while the relative motion is small.

At a pair of nearest points a, b the direction from a to b lies in the normal cone of a's surface at a: it is the normal
of a triangle, between the normals of both triangles at an edge, or between those at a vertex. So a triangle is needed
if some of the other part lies over it, an edge if some lies between the normals of its triangles, a vertex likewise; an
edge or a vertex is included with any of its triangles. Between flat faces that leaves the faces themselves, without the
walls beside them, which would keep a hierarchy of bounding volumes from seeing that they are flat.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.cad.solids import BuiltShape, DisplayMesh, display_mesh
from tol3d.errors import GeometryError
from tol3d.numerics.arrays import Array

Bools = NDArray[np.bool_]

PAIRS_AT_ONCE = 2_000_000
"""Boxes of triangles compared at once: some tens of megabytes."""
MOST_LISTED = 8
"""Faces that an error lists."""
THIN = 1e-12
"""mm or mm^2; length of a vector without a direction."""
OPPOSED = 1e-3
"""1 + cosine of the angle between the normals at an edge as sharp as a knife's."""


@dataclass(frozen=True, eq=False)
class Other:
    """Triangles of the other part, and the boxes about them.

    Args:
        corners: (m, 3, 3) [mm].
    """

    corners: Array

    @property
    def low(self) -> Array:
        """Least coordinates (m, 3) [mm]."""
        return np.asarray(self.corners.min(axis=1))

    @property
    def high(self) -> Array:
        """Largest coordinates (m, 3) [mm]."""
        return np.asarray(self.corners.max(axis=1))


def needed(vertices: Array, triangles: NDArray[np.int64], other: Array, height: float, slack: Array) -> Bools:
    """Flags of the needed triangles of a closed mesh (n,).

    Args:
        vertices, triangles: of the mesh; where an edge has not two triangles, both are needed.
        other: corners of the other part's triangles in the same frame (m, 3, 3) [mm].
        height: largest distance of the nearest points [mm].
        slack: largest motion of any point of the other part against this one, along x, y and z (3,) [mm].
    """
    corners = vertices[triangles]
    reach = height + slack
    near = _boxes_meet(corners.min(axis=1) - reach, corners.max(axis=1) + reach, other)
    wanted = np.zeros(len(triangles), dtype=bool)
    near_other = Other(other[_boxes_meet(other.min(axis=1) - reach, other.max(axis=1) + reach, corners)])
    if not near.any() or not len(near_other.corners):
        return wanted
    rows = np.flatnonzero(near)
    wanted[rows] = _below_something(corners[rows], near_other, height, slack)
    sides, of_triangle, single = _edges(triangles)
    wanted[of_triangle[single].ravel()] = True
    wanted = _with_edges(wanted, corners, vertices, sides[~single], of_triangle[~single], near_other, height, slack)
    return _with_vertices(wanted, vertices, triangles, near_other, height, slack)


def nearby(own: Array, other: Array, reach: Array) -> Bools:
    """Flags of triangles (n, 3, 3) that may have another part's within a reach along x, y and z (3,) [mm] (n,)."""
    low, high = own.min(axis=1) - reach, own.max(axis=1) + reach
    near = _boxes_meet(low, high, other)
    near_other = Other(other[_boxes_meet(other.min(axis=1) - reach, other.max(axis=1) + reach, own)])
    if near.any() and len(near_other.corners):
        rows = np.flatnonzero(near)
        none = np.zeros((len(rows), 0, 3)), np.zeros((len(rows), 0))
        near[rows] = _reached(low[rows], high[rows], *none, near_other)
    return near


def _boxes_meet(low: Array, high: Array, other: Array) -> Bools:
    """True where boxes (n, 3) meet the box about all of the other part (n,)."""
    ends = other.reshape(-1, 3)
    return np.asarray(((low <= ends.max(axis=0)) & (high >= ends.min(axis=0))).all(axis=1))


def _normals(corners: Array) -> Array:
    return _units(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))


def _units(vectors: Array) -> Array:
    """Unit vectors (n, 3); a vector without a length stays 0 and excludes nothing."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(np.where(length > THIN, vectors / np.where(length > THIN, length, 1.0), 0.0))


def _below_something(corners: Array, other: Other, height: float, slack: Array) -> Bools:
    """True where the other part lies over triangles (n, 3, 3), within a height along their normals."""
    normals = _normals(corners)
    across = np.cross(np.roll(corners, -1, axis=1) - corners, normals[:, None])
    across = _units(across.reshape(-1, 3)).reshape(corners.shape)
    axes = np.concatenate([-normals[:, None], normals[:, None], across], axis=1)
    limits = np.stack(
        [
            -np.einsum("nx,nx->n", normals, corners[:, 0]),
            height + np.einsum("nx,nx->n", normals, corners[:, 0]),
            *(np.einsum("nx,nx->n", across[:, k], corners[:, k]) for k in range(3)),
        ],
        axis=1,
    )
    limits += np.abs(axes) @ slack
    lifted = corners + height * normals[:, None]
    both = np.concatenate([corners, lifted], axis=1)
    return _reached(both.min(axis=1) - slack, both.max(axis=1) + slack, axes, limits, other)


def _reached(low: Array, high: Array, axes: Array, limits: Array, other: Other) -> Bools:
    """True where regions contain some of the other part (n,): boxes cut by half spaces axes . x <= limit.

    Args:
        low, high: of the boxes (n, 3) [mm].
        axes: (n, half spaces, 3); limits (n, half spaces) [mm].
        other: a triangle of it is outside if one half space contains none of its corners.
    """
    found = np.zeros(len(low), dtype=bool)
    other_low, other_high = other.low, other.high
    step = max(1, PAIRS_AT_ONCE // len(other_low))
    for start in range(0, len(low), step):
        rows = slice(start, start + step)
        meet = np.ones((len(low[rows]), len(other_low)), dtype=bool)
        for k in range(3):
            meet &= low[rows, k, None] <= other_high[:, k]
            meet &= high[rows, k, None] >= other_low[:, k]
        own, its = np.nonzero(meet)
        inside = np.ones(len(own), dtype=bool)
        for j in range(axes.shape[1]):
            heights = np.einsum("nx,ncx->nc", axes[rows][own, j], other.corners[its])
            inside &= heights.min(axis=1) <= limits[rows][own, j]
        found[start + own[inside]] = True
    return found


def _edges(triangles: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64], Bools]:
    """Edges (n, 2) with the two triangles of each (n, 2), and which ones have not two (n,)."""
    sides = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    owner = np.tile(np.arange(len(triangles)), 3)
    found, number, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(number.ravel(), kind="stable")
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    of_triangle = np.stack([owner[order[first]], owner[order[first + count - 1]]], axis=1)
    return found, of_triangle, np.asarray(count != 2)


def _with_edges(
    wanted: Bools,
    corners: Array,
    vertices: Array,
    sides: NDArray[np.int64],
    of_triangle: NDArray[np.int64],
    other: Other,
    height: float,
    slack: Array,
) -> Bools:
    """The triangles wanted, and one of each edge that is needed and has none among them."""
    open_edges = ~wanted[of_triangle].any(axis=1)
    sides, of_triangle = sides[open_edges], of_triangle[open_edges]
    start, end = vertices[sides[:, 0]], vertices[sides[:, 1]]
    reach = height + slack
    near = _boxes_meet(np.minimum(start, end) - reach, np.maximum(start, end) + reach, other.corners)
    start, end, of_triangle = start[near], end[near], of_triangle[near]
    if not len(start):
        return wanted
    along = _units(end - start)
    axes, ends = [along, -along], [end, start]
    for k in range(2):
        middle = corners[of_triangle[:, k]].mean(axis=1) - start
        axes.append(_units(middle - np.einsum("nx,nx->n", middle, along)[:, None] * along))
        ends.append(start)
    limits = [np.einsum("nx,nx->n", own, at) + np.abs(own) @ slack for own, at in zip(axes, ends, strict=True)]
    over = height * _between(_normals(corners[of_triangle[:, 0]]), _normals(corners[of_triangle[:, 1]]))
    low = np.minimum(start, end) + over.min(axis=1) - slack
    high = np.maximum(start, end) + over.max(axis=1) + slack
    found = _reached(low, high, np.stack(axes, axis=1), np.stack(limits, axis=1), other)
    more = wanted.copy()
    more[of_triangle[found, 0]] = True
    return more


def _between(first: Array, second: Array) -> Array:
    """Points (n, 4, 3) whose hull holds all directions between two of unit length (n, 3), and the origin.

    The arc between both lies below the point where its tangents at both meet.
    """
    spread = 1.0 + np.einsum("nx,nx->n", first, second)[:, None]
    opposed = spread < OPPOSED
    met = np.where(opposed, 0.0, (first + second) / np.where(opposed, 1.0, spread))
    points = np.stack([np.zeros_like(first), first, second, met], axis=1)
    everywhere = np.array([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    return np.where(opposed[:, :, None], everywhere, points)


def _with_vertices(
    wanted: Bools, vertices: Array, triangles: NDArray[np.int64], other: Other, height: float, slack: Array
) -> Bools:
    """The triangles wanted, and one of each vertex that is needed and has none among them."""
    covered = np.zeros(len(vertices), dtype=bool)
    covered[triangles[wanted].ravel()] = True
    reach = height + slack
    near = ~covered & _boxes_meet(vertices - reach, vertices + reach, other.corners)
    more = wanted.copy()
    for vertex in np.flatnonzero(near):
        around = np.flatnonzero((triangles == vertex).any(axis=1))
        ends = np.unique(triangles[around])
        edges = vertices[ends[ends != vertex]] - vertices[vertex]
        axes = _units(edges)
        limits = axes @ vertices[vertex] + np.abs(axes) @ slack
        at = vertices[vertex][None]
        if _reached(at - reach, at + reach, axes[None], limits[None], other)[0]:
            more[around[0]] = True
    return more


COARSE: Final = 0.1
"""mm; deflection of a mesh from which the number of triangles of a finer one is estimated."""
MOST_TRIANGLES: Final = 1_000_000
"""Triangles of one part at most: some 300 MB with its hierarchy of bounding volumes."""
TRIES: Final = 8
"""Deflections to try: OCC meets the given one within a factor of two."""


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
        """Corners of the triangles (m, 3, 3) [mm]."""
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
        within: largest chord error [mm].

    Raises:
        GeometryError: it would take too many triangles, or the solid has faces of which there are none.
    """
    if lacking := shape.open_faces():
        listed = ", ".join(lacking[:MOST_LISTED])
        raise GeometryError(f"a clearance would miss its faces that cannot be triangulated: {listed}")
    mesh = display_mesh(shape, COARSE)
    deflection = COARSE
    for _ in range(TRIES):
        if mesh.chord_error <= within:
            return SolidMesh(mesh.vertices, mesh.triangles, mesh.chord_error)
        finer = deflection * 0.8 * within / mesh.chord_error
        if len(mesh.triangles) * min(deflection / finer, 2.0) > MOST_TRIANGLES:
            break
        # small curved faces need many more triangles; the deflection is lowered step by step to stop in time
        deflection = max(finer, deflection / 8)
        mesh = display_mesh(shape, deflection)
    raise GeometryError(_too_fine(mesh, within))


def _too_fine(mesh: DisplayMesh, within: float) -> str:
    words = f"its mesh has {len(mesh.triangles)} triangles with a chord error of {1000 * mesh.chord_error:.2g} um"
    return f"{words}, and would take too many for {1000 * within:.2g} um; state a larger chord_error"
