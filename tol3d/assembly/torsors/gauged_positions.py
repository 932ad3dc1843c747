"""Positions in a frame of gauges, to first order: the least over all positions of the gauges within their clearance."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tol3d.assembly.model import Measured
from tol3d.assembly.torsors.columns import without_rounding
from tol3d.assembly.torsors.gauges import counted
from tol3d.assembly.torsors.later_datums import LaterDatums
from tol3d.assembly.torsors.room import changes, least_slack
from tol3d.assembly.torsors.terms import Form
from tol3d.assembly.torsors.torsor import perpendicular, shift_at
from tol3d.assembly.torsors.world import World
from tol3d.contact.programme import SPARE, least_growth
from tol3d.numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class LeastOnGauges:
    """Twice the least growth of cones about ends at which all cones have a common point.

    If the clearance is empty: twice the growth needed where the lack of clearance is least.

    Args:
        forms: offsets (ends * 2), radii (ends), offsets of the room (places * 2), its clearances (places), and those of
            later datums.
        rows: change of all offsets by the freedoms (ends + places, 2, freedoms).
        ends: their number.
        later: datums of the frame that take their place in the room first.
    """

    forms: Array
    rows: Array
    ends: int
    later: LaterDatums | None = None
    form: Form = "least in a room"
    count: int = 1

    def values(self, read: Array) -> Array:
        """(1, trials) [mm]."""
        ends, places = self.ends, len(self.rows) - self.ends
        own, radii, its, room, asked = np.split(read, np.cumsum([2 * ends, ends, 2 * places, places]))
        offsets, rows = np.concatenate([own, its]).reshape(ends + places, 2, -1), self.rows
        if self.later is not None:
            steps = self.later.nearest(asked, offsets[ends:], room, rows[ends:])
            offsets, rows = offsets + changes(rows, steps), rows @ self.later.left
            room = room + len(self.later.asks) * SPARE
        least, steps, _ = least_growth(offsets, np.concatenate([radii, room]), rows, ends, rounds=1)
        return 2.0 * np.maximum(least, -least_slack((offsets + changes(rows, steps))[:ends], radii))[None]


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
        directions = counted(feature.frame, shape) if measured.direction is None else perpendicular(measured.direction)
        torsor = world.own[feature.part].feature(name) - gauges.rest
        ways = [directions @ shift_at(feature.frame[:3, :3] @ end + feature.frame[:3, 3]) for end in shape.ends]
        forms += [way @ torsor for way in ways]
        radii += [0.5 * bonus[None]] * len(ways)
        rows += [way @ gauges.motions for way in ways]
    asked = [] if gauges.later is None else [gauges.later.forms]
    every = without_rounding(np.concatenate([*forms, *radii, gauges.offsets, gauges.clearances, *asked]))
    term = LeastOnGauges(every, np.concatenate([np.array(rows), gauges.rows]), len(rows), gauges.later)
    row: Array = world.columns.made_by(term)[0]
    return row
