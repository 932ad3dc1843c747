"""Positions in a frame of gauges, to first order: the least over all positions of the gauges within their clearance."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.assembly.model import Axis, Measured, RoundPlane
from tol3d.assembly.torsors.centring import Cones, largest_slack
from tol3d.assembly.torsors.columns import without_rounding
from tol3d.assembly.torsors.terms import Form
from tol3d.assembly.torsors.torsor import perpendicular, shift_at
from tol3d.assembly.torsors.world import World
from tol3d.numerics.arrays import Array

STEPS: Final = 40
"""Newton steps at most; in practice 2 to 8."""
SHORT: Final = 1e-12
"""Step [mm] at which they are done."""
FREE: Final = 1e-9
"""Share of the ends in the multipliers, below which the clearance alone decides."""


@dataclass(frozen=True, eq=False)
class LeastOnGauges:
    """Twice the least growth of cones about ends at which all cones have a common point.

    From below, for the largest common slack is concave in the growth. If the clearance is empty: twice the growth
    needed where the lack of clearance is least.

    Args:
        forms: offsets (ends * 2), radii (ends), offsets of the room (places * 2), its clearances (places).
        rows: change of all offsets by the freedoms (ends + places, 2, freedoms).
        ends: their number.
    """

    forms: Array
    rows: Array
    ends: int
    form: Form = "least in a room"
    count: int = 1

    def values(self, read: Array) -> Array:
        """(1, trials) [mm]."""
        ends, trials, places = self.ends, read.shape[1], len(self.rows) - self.ends
        own, radii, its, room = np.split(read, [2 * ends, 3 * ends, 3 * ends + 2 * places])
        offsets = np.concatenate([own, its]).reshape(-1, 2, trials)
        clearances = np.concatenate([np.zeros((ends, trials)), room])
        grown, steps, going = (-radii).max(axis=0), np.zeros((self.rows.shape[2], trials)), np.arange(trials)
        closed = np.zeros((len(steps), len(steps), trials))
        for _ in range(STEPS):
            clearances[:ends] = radii + grown
            now = Cones(offsets[:, :, going], clearances[:, going], self.rows)
            rows = self.rows[..., None] * np.ones(len(going))
            counts = np.ones(now.clearances.shape, dtype=bool)
            found, multipliers = largest_slack(now.offsets, now.clearances, rows, counts, closed[..., going])
            steps[:, going] = found
            share = multipliers[:ends].sum(axis=0)
            step = np.where(share > FREE, np.maximum(-now.slack(found), 0.0) / np.where(share > FREE, share, 1.0), 0.0)
            grown[going] += step
            going = going[step > SHORT]
            if not len(going):
                break
        at = Cones(offsets, clearances, self.rows).at(steps)[:ends]
        far = (np.sqrt(at[:, 0] ** 2 + at[:, 1] ** 2) - radii).max(axis=0)
        return np.asarray(2.0 * np.maximum(grown, far)[None])


def on_gauges(measured: Measured, world: World, bonuses: Sequence[Array]) -> Array:
    """Twice the least by which any end lies off, less what its feature has, as a row (columns,) [mm].

    Args:
        measured: features, in a frame of gauges.
        world: as it is read.
        bonuses: what each feature has, its zone too if that counts (columns,).
    """
    gauges = world.own[world.part_of(measured.features[0])].gauges(measured.frame)
    forms: list[Array] = []
    radii: list[Array] = []
    rows: list[Array] = []
    for name, bonus in zip(measured.features, bonuses, strict=True):
        feature = world.assembly.features[name]
        shape = feature.shape
        assert not isinstance(shape, RoundPlane)
        if measured.direction is not None:
            directions = perpendicular(measured.direction)
        else:
            directions = feature.frame[:3, :2].T if isinstance(shape, Axis) else feature.frame[:3, 2:3].T
        directions = np.concatenate([directions, np.zeros((2 - len(directions), 3))])
        torsor = world.own[feature.part].feature(name) - gauges.rest
        ways = [directions @ shift_at(feature.frame[:3, :3] @ end + feature.frame[:3, 3]) for end in shape.ends]
        forms += [way @ torsor for way in ways]
        radii += [0.5 * bonus[None]] * len(ways)
        rows += [way @ gauges.motions for way in ways]
    every = without_rounding(np.concatenate([*forms, *radii, gauges.offsets, gauges.clearances]))
    term = LeastOnGauges(every, np.concatenate([np.array(rows), gauges.rows]), len(rows))
    row: Array = world.columns.made_by(term)[0]
    return row
