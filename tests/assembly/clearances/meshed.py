"""Closed meshes of simple solids, by their formulas: no CAD."""

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.clearances.faces import SolidMesh

Array = NDArray[np.float64]


def block(sizes: tuple[float, float, float]) -> SolidMesh:
    """A block about the origin."""
    x, y, z = (own / 2 for own in sizes)
    corners = np.array([[i * x, j * y, k * z] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    squares = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [each for a, b, c, d in squares for each in ((a, b, c), (a, c, d))]
    return SolidMesh(corners, np.array(triangles), 0.0)


def ball(radius: float, steps: int) -> SolidMesh:
    """A ball about the origin: `steps` a half turn, its vertices on the sphere."""
    latitudes = np.pi * (np.arange(1, steps) / steps - 0.5)
    azimuths = np.pi * np.arange(2 * steps) / steps
    rings = np.stack(
        [
            np.cos(latitudes)[:, None] * np.cos(azimuths),
            np.cos(latitudes)[:, None] * np.sin(azimuths),
            np.repeat(np.sin(latitudes)[:, None], 2 * steps, axis=1),
        ],
        axis=-1,
    ).reshape(-1, 3)
    vertices = radius * np.concatenate([rings, [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]])
    here = np.arange(2 * steps)
    there = (here + 1) % (2 * steps)
    triangles = [_band(here + k * 2 * steps, there + k * 2 * steps, 2 * steps) for k in range(steps - 2)]
    top = (steps - 2) * 2 * steps
    south, north = np.full(2 * steps, len(rings)), np.full(2 * steps, len(rings) + 1)
    triangles += [np.stack([there, here, south], -1), np.stack([here + top, there + top, north], -1)]
    # no farther than the middle of a square of two steps a side: sagittas of both add up
    return SolidMesh(vertices, np.concatenate(triangles), 2 * radius * (1 - np.cos(np.pi / (2 * steps))))


def tube(outer: float, inner: float, length: float, steps: int) -> SolidMesh:
    """A tube about z, or a cylinder where there is no inner radius; its middle at the origin, `steps` a turn."""
    azimuths = 2 * np.pi * np.arange(steps) / steps
    circle = np.stack([np.cos(azimuths), np.sin(azimuths)], axis=-1)
    here = np.arange(steps)
    there = (here + 1) % steps
    if inner == 0.0:
        vertices = np.concatenate(
            [np.column_stack([outer * circle, np.full(steps, z)]) for z in (-length / 2, length / 2)]
            + [np.array([[0.0, 0.0, -length / 2], [0.0, 0.0, length / 2]])]
        )
        ends = [
            np.stack([there, here, np.full(steps, 2 * steps)], -1),
            np.stack([here + steps, there + steps, np.full(steps, 2 * steps + 1)], -1),
        ]
        return SolidMesh(vertices, np.concatenate([_band(here, there, steps), *ends]), _sagitta(outer, steps))
    profile = [(outer, -length / 2), (outer, length / 2), (inner, length / 2), (inner, -length / 2)]
    vertices = np.concatenate([np.column_stack([radius * circle, np.full(steps, z)]) for radius, z in profile])
    bands = []
    for k in range(4):
        low, high = k * steps, (k + 1) % 4 * steps
        bands += [
            np.stack([here + low, there + low, there + high], -1),
            np.stack([here + low, there + high, here + high], -1),
        ]
    return SolidMesh(vertices, np.concatenate(bands), _sagitta(outer, steps))


def _band(here: NDArray[np.int64], there: NDArray[np.int64], up: int) -> NDArray[np.int64]:
    return np.concatenate([np.stack([here, there, there + up], -1), np.stack([here, there + up, here + up], -1)])


def _sagitta(radius: float, steps: int) -> float:
    return float(radius * (1 - np.cos(np.pi / steps)))
