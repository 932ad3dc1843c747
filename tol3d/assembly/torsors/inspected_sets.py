"""A set of features against their nominal places to first order: in a datum frame, or at the best place of the set."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.assembly.model import Measured
from tol3d.assembly.torsors.columns import without_rounding
from tol3d.assembly.torsors.measures import clipped
from tol3d.assembly.torsors.room import Cones
from tol3d.assembly.torsors.terms import Form
from tol3d.assembly.torsors.torsor import cross_matrix, height_at, shift_at
from tol3d.assembly.torsors.world import World
from tol3d.numerics.arrays import Array

AROUND: Final = 24
"""Points of a disc's rim at which it is inspected."""
FELT: Final = 1e-6
"""Change of all offsets by a freedom of length 1 [mm], below which it is none."""


@dataclass(frozen=True, eq=False)
class LeastOverPlaces:
    """Twice the largest length of offsets, with an amount that each has beside it, where the freedoms make it least.

    Args:
        forms: offsets (places * size, columns), then what has the amounts (places, columns), then what is taken from
            each (places, columns).
        rows: change of the offsets by the freedoms (places, 2, freedoms); none where nothing is free.
        size: numbers of an offset.
    """

    forms: Array
    rows: Array
    size: int
    form: Form = "least in a room"
    count: int = 1

    def values(self, read: Array) -> Array:
        """(1, trials) [mm]."""
        places, trials = len(self.rows), read.shape[1]
        offsets = read[: -2 * places].reshape(places, self.size, trials)
        added = np.abs(read[-2 * places : -places]) - read[-places:]
        if not self.rows.shape[2]:
            lengths = np.sqrt(sum(offsets[:, k] ** 2 for k in range(self.size)))
            return np.asarray(2.0 * (lengths + added).max(axis=0)[None])
        return np.asarray(-2.0 * Cones(offsets, -added, self.rows).solved().slack[None])


def inspected_set(measured: Measured, world: World) -> Array:
    """As a row (columns,) [mm]."""
    part = world.part_of(measured.features[0])
    frame = world.own[part].datum_frame(measured.frame)
    free = measured.gauge == "oriented"
    size = 2 if free else 3
    ways: list[Array] = []
    offsets: list[Array] = []
    added: list[Array] = []
    taken: list[Array] = []
    places: list[Array] = []
    for k, name in enumerate(measured.features):
        bonus = 0.5 * clipped(measured.bonuses[k], name, world) if measured.bonuses else np.zeros(world.columns.count)
        feature = world.assembly.features[name]
        shape, turn, at = feature.shape, feature.frame[:3, :3], feature.frame[:3, 3]
        points, directions = shape.edge(np.linspace(0.0, 2.0 * np.pi, AROUND, endpoint=False)), turn[:, shape.located].T
        directions = np.concatenate([directions, np.zeros((size - len(directions), 3))])
        torsor = world.own[part].feature(name) - frame
        off = np.zeros((size, world.columns.count))
        if shape.surface == "plane":
            off[0, world.columns.constant] = measured.middle
        beside = np.zeros(world.columns.count)
        own_ways = [directions @ shift_at(turn @ point + at) for point in points]
        if measured.surfaces and (by := shape.outward_by) is not None:
            beside = by[0] * (height_at(at, turn[:, 2]) @ torsor)[0] + by[1] * world.size(name)
            beside[world.columns.constant] -= measured.middle
            own_ways = list(np.einsum("ij,jkl->ikl", shape.surface_by_axis, own_ways))
        for point, way in zip(points, own_ways, strict=True):
            ways.append(way)
            places.append(turn @ point + at)
            offsets.append(way @ torsor - off)
            added.append(beside)
            taken.append(bonus)
    freedoms = _freedoms(measured, world, np.array(places), np.array(ways)) if free else np.zeros((6, 0))
    forms = without_rounding(np.concatenate([*offsets, np.array(added), np.array(taken)]))
    term = LeastOverPlaces(forms, np.array(ways) @ freedoms, size)
    row: Array = world.columns.made_by(term)[0]
    return row


def _freedoms(measured: Measured, world: World, places: Array, ways: Array) -> Array:
    """Torsors of the set (6, freedoms): shifts, and turns that its datums leave, which some place sees."""
    middle = places.mean(axis=0)
    lever = max(1.0, float(np.linalg.norm(places - middle, axis=1).max()))
    part = world.part_of(measured.features[0])
    turns = world.own[part].left_by(measured.frame)
    free = np.zeros((6, 3 + turns.shape[1]))
    free[:3, :3], free[3:, 3:] = np.eye(3), turns / lever
    free[:3, 3:] = cross_matrix(middle) @ turns / lever
    _, strengths, right = np.linalg.svd((ways @ free).reshape(-1, free.shape[1]))
    return np.asarray(free @ right[: int(np.sum(strengths > FELT))].T)
