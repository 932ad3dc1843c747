"""Positions in a frame of gauges, to first order: the least over all positions of the gauges within their clearance.

The largest circle in several discs, as terms: alone, at the best turn of the discs, and as some of them grow.
"""

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
from tol3d.contact.openings import LEAST, least_in_rooms, least_over_turns, opening
from tol3d.contact.programme import SPARE, least_growth
from tol3d.numerics.arrays import Array, Places


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


@dataclass(frozen=True, eq=False)
class CommonOpening:
    """The diameter of the largest circle that lies in all discs.

    Args:
        forms: (discs * 3, columns): x, y and radius of each disc.
    """

    forms: Array
    form: Form = "largest inscribed circle"
    count: int = 1

    def values(self, read: Array) -> Array:
        """(1, trials) from (discs * 3, trials)."""
        return -2.0 * opening(read[::3], read[1::3], read[2::3]).outside[None]


@dataclass(frozen=True, eq=False)
class TurnedOpening:
    """The diameter of the largest circle in all discs, with the best common turn of their centres; concave in that.

    Args:
        forms: as of CommonOpening.
        arms: how the centres move with the turn (discs, 2) [mm].
    """

    forms: Array
    arms: Array
    form: Form = "largest inscribed circle"
    count: int = 1

    def values(self, read: Array) -> Array:
        """(1, trials) from (discs * 3, trials)."""
        x, y, radii = read[::3], read[1::3], read[2::3]
        by_x, by_y = -self.arms.T[..., None]

        def turned(trials: Places, turn: Array) -> Array:
            found = opening(x[:, trials] + by_x * turn, y[:, trials] + by_y * turn, radii[:, trials])
            return np.stack([turn, found.outside, found.slope(by_x + 0.0 * turn, by_y + 0.0 * turn)])

        off = np.maximum(np.abs(x), np.abs(y)).max(axis=0)
        reach = float(np.sqrt((self.arms**2).sum(axis=1)).max()) or 1.0
        return -2.0 * least_over_turns(turned, 0.25 * off / reach + LEAST)[None]


@dataclass(frozen=True, eq=False)
class LeastInRoom:
    """Twice the least by which discs about places grow until all discs have a point in common.

    Where the room is empty: what they need in its middle.

    Args:
        forms: (discs * 3, columns): x, y and radius, of the places, then of the room.
        places: how many of them are places.
    """

    forms: Array
    places: int
    form: Form = "least in a room"
    count: int = 1

    def values(self, read: Array) -> Array:
        """(1, trials) from (discs * 3, trials)."""
        x, y, radii = read[::3], read[1::3], read[2::3]
        least = least_in_rooms(x, y, radii, self.places)
        own = slice(0, self.places)
        far = np.hypot(x[own] - x[self.places :].mean(axis=0), y[own] - y[self.places :].mean(axis=0)) - radii[own]
        return 2.0 * np.where(np.isnan(least), far.max(axis=0), least)[None]
