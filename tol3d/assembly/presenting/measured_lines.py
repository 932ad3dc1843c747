"""Lines along which measures of an assembly are read, as its parts stand in a build."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Final

import numpy as np

from tol3d.assembly.model import Assembly, Measured
from tol3d.numerics.arrays import Array
from tol3d.report.body import MeasuredLine
from tol3d.report.ticks import even_step

Frames = Mapping[str, Array]
"""Poses in the world (4, 4), by name."""


ARROW: Final = 1 / 8
"""Fraction of the size of what is shown: least length of the arrow of its largest error."""
SHORTEST: Final = 1e-6
"""mm; an error that is shorter is rounding."""
LARGEST: Final = 1000.0
"""Factor by which an error is drawn at most: of nominal parts it would be the chords of teeth that one sees."""

LENGTHS: Final = ("gap", "distance", "virtual_clearance")
"""Readings of a length between features; of others the place of the last feature is shown."""


def measured_lines(assembly: Assembly, frames: Frames, poses: Frames) -> Mapping[str, tuple[MeasuredLine, ...]]:
    """Lines of each measure; none of one that names no features, such as the slack of a move.

    A direction is that of the part alone: deviations of a datum frame turn it by less than a picture shows. Parts stand
    as they do after the last move.

    Args:
        assembly: with its measures.
        frames: of its features.
        poses: of its parts.
    """
    found = {name: tuple(_lines(assembly, own, frames, poses)) for name, own in assembly.measures.items()}
    return {name: lines for name, lines in found.items() if lines}


def arrow_factor(worlds: Iterable[Mapping[str, tuple[MeasuredLine, ...]]], size: float) -> float:
    """An even factor by which lines of errors are drawn so long that the longest of them is seen, 1 at least.

    Args:
        worlds: lines of measures in each.
        size: of what is shown [mm].
    """
    every = (line.points for lines in worlds for own in lines.values() for line in own if line.is_error)
    longest = max((float(np.linalg.norm(points[-1] - points[0])) for points in every), default=0.0)
    if longest < SHORTEST or longest >= ARROW * size:
        return 1.0
    return min(even_step(ARROW * size / longest), LARGEST)


def _lines(assembly: Assembly, measured: Measured, frames: Frames, poses: Frames) -> Iterator[MeasuredLine]:
    if measured.facing is not None:
        yield MeasuredLine(_nearest(measured, poses))
    elif measured.features:
        places = np.array([frames[name][:3, 3] for name in measured.features])
        first = assembly.features[measured.features[0]]
        if measured.reads.name not in LENGTHS:
            places = places[-1:]
        elif measured.direction is not None:
            along = poses[first.part][:3, :3] @ measured.direction
            start, end = places
            places = np.array([start, start + along * (along @ (end - start)), end])
        yield MeasuredLine(places, is_error=not first.is_named and len(places) > 1)
    if measured.minus is not None:
        yield from _lines(assembly, measured.minus, frames, poses)


def _nearest(measured: Measured, poses: Frames) -> Array:
    """The two points (2, 3) of the parts of a clearance that are nearest to each other [mm]."""
    facing = measured.facing
    assert facing is not None
    one, other = (poses[name] for name in measured.parts)
    starts, ends = (
        points @ pose[:3, :3].T + pose[:3, 3] for points, pose in ((facing.starts, one), (facing.ends, other))
    )
    nearest = int(np.argmin(np.linalg.norm(ends - starts, axis=-1)))
    return np.array([starts[nearest], ends[nearest]])
