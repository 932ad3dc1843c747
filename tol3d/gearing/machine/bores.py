"""Offsets of the axes of shafts from their nominal places, trial by trial, by both methods of the assembly.

Each point of an axis has a twin where the point is nominally, on the part that carries the first bore of its train.
Gaps between the two along the shaft's x, y and z are measures of the assembly, which either method reads as any other.
So a housing that stands askew takes its shafts along, and nothing of that reaches the gears.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from tol3d.assembly.grammar.measures.gap import GapSpec
from tol3d.assembly.model import Assembly, Contribution, Feature, Measured, Point
from tol3d.gearing.machine.nominal import HousedShaft
from tol3d.numerics.arrays import Array

COMPONENTS: Final = ("x", "y")
"""Across the axis at each of its two points, in the frame of the shaft at rest."""


def reading_name(shaft: str, point: int, direction: str) -> str:
    """Name of the assembly's measure of the offset of a point of an axis; scenes cannot use such a name."""
    return f".{shaft}.{point}.{direction}"


def twin_name(housed_shaft: HousedShaft, point: int) -> str:
    """The point of the host where a point of an axis is nominally."""
    return f"{housed_shaft.host}..{housed_shaft.shaft} {point}"


@dataclass(frozen=True, eq=False)
class Bores:
    """The axes of shafts in bores, as an assembly reads them.

    Args:
        assembly: with the points of the axes and their twins.
        shafts: in the order of their columns: x, y at the first point, x, y at the second.
    """

    assembly: Assembly
    shafts: tuple[HousedShaft, ...]

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The measures of the assembly that say where the axes lie."""
        return tuple(
            reading_name(shaft.shaft, k, direction) for shaft in self.shafts for k in range(2) for direction in "xyz"
        )

    @cached_property
    def lateral_names(self) -> tuple[str, ...]:
        """Names of the displacements across the axes, in the order of the columns."""
        return tuple(
            reading_name(shaft.shaft, k, direction)
            for shaft in self.shafts
            for k in range(2)
            for direction in COMPONENTS
        )

    def exactly(self, read: Mapping[str, Array]) -> Array:
        """Columns (trials, shafts * 4) [mm]: where lines through displaced points pass the points' nominal heights.

        Args:
            read: by `names`, displacements (trials,) [mm].
        """
        found = []
        for shaft in self.shafts:
            first, last = (
                [np.asarray(read[reading_name(shaft.shaft, k, direction)]) for direction in "xyz"] for k in range(2)
            )
            low, high = (shaft.along(bore) for bore in shaft.bores)
            length = (high + last[2]) - (low + first[2])
            slopes = [(last[k] - first[k]) / length for k in range(2)]
            found += [first[k] - slopes[k] * first[2] for k in range(2)]
            found += [last[k] - slopes[k] * last[2] for k in range(2)]
        return np.stack(found, axis=1) if found else np.zeros((0, 0))

    def to_first_order(self, read: Mapping[str, Array]) -> Array:
        """The same columns to first order: displacements along the axes do not matter."""
        found = [np.asarray(read[name]) for name in self.lateral_names]
        return np.stack(found, axis=1) if found else np.zeros((0, 0))


def bores_of(assembly: Assembly, shafts: Sequence[HousedShaft]) -> Bores:
    """An assembly with the points of the axes of shafts."""
    added: dict[str, list[Feature]] = {part.name: [] for part in assembly.parts}
    measures: dict[str, Measured] = {}
    for shaft in shafts:
        host = assembly.part[shaft.host]
        into = np.linalg.inv(host.pose)
        for k, bore in enumerate(shaft.bores):
            frame = shaft.frame.copy()
            frame[:3, 3] = bore.place
            twin = Feature(twin_name(shaft, k), shaft.host, Point(), into @ frame, is_named=False)
            added[shaft.host].append(twin)
            actual = assembly.features[bore.feature]
            if bore.end is not None:
                actual = _end_of(actual, bore.end)
                added[actual.part].append(actual)
            for direction, column in zip("xyz", (into[:3, :3] @ shaft.frame[:3, :3]).T, strict=True):
                measures[reading_name(shaft.shaft, k, direction)] = Measured(
                    GapSpec.reads, (twin.name, actual.name), column
                )
    parts = tuple(replace(part, features=(*part.features, *added[part.name])) for part in assembly.parts)
    return Bores(replace(assembly, parts=parts, measures={**assembly.measures, **measures}), tuple(shafts))


def _end_of(bore: Feature, end: int) -> Feature:
    """The end of a bore as a point."""
    frame = bore.frame.copy()
    frame[:3, 3] += frame[:3, :3] @ bore.shape.ends[end]
    aside = np.zeros((3, 4))
    aside[0, 2 * end] = aside[1, 2 * end + 1] = 1.0
    moved_by = tuple(Contribution(own.contributor, own.columns, aside @ own.matrix) for own in bore.moved_by)
    return Feature(f"{bore.name} end {end}", bore.part, Point(), frame, bore.parent, moved_by, (), bore.grown_by, False)
