"""Measures of parts that may rock: a force carried by fewer contacts than freedoms leaves a part several poses.

The poses equally far along the force form a flat set. A measure that varies over it, to first order, is read at its two
ends that are farthest apart for the measure.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Assembly, Measured
from tol3d.assembly.model.datum_frame import GaugeRoom
from tol3d.assembly.model.measures import Rocking
from tol3d.assembly.model.statuses import NO_BUILD, NOT_UNIQUE, OK
from tol3d.assembly.placing.causes import Cause
from tol3d.assembly.placing.placer import Placer, RockingPlacer
from tol3d.assembly.placing.poses import Codes
from tol3d.assembly.placing.rest_move import generic
from tol3d.assembly.placing.world import World
from tol3d.numerics.arrays import Array
from tol3d.study.system.outcome import reason_column

NUDGE: Final = 1e-3
"""mm; displacement of parts for the slopes of measures."""
DEPENDS: Final = 1e-6
"""Slope [mm/mm] of a measure below which a motion has no effect."""
KINK: Final = 1e-2
"""Change of a slope over a small step from which a measure is not smooth: a distance that is nominally 0."""
NARROW: Final = 1e-9
"""mm or rad; what varies by less over all poses is unique."""

Read = Callable[[Array, Mapping[int, Placer]], Array]
"""Values (n,) of a measure in some trials (n, width), with other moves for some by their places."""


def slope_of(measured: Measured, index: int, move: RockingPlacer, read: Read, width: int) -> Array | None:
    """Nominal change of a measure per motion of a part at rest (motions,) [mm/mm]; None if it does not change.

    For a measure that is not smooth there, the slope is that of some motion.
    """
    motions = move.rows.shape[1]
    nudges = NUDGE * np.hstack([np.zeros((motions, 1)), np.eye(motions), -np.eye(motions)])
    values = read(np.zeros((1 + 2 * motions, width)), {index: move.nudged(nudges)})
    values = values * (move.reach if measured.kind == "angle" else 1.0) / NUDGE
    ahead, back = values[1 : 1 + motions], values[1 + motions :]
    if not np.abs(ahead + back - 2 * values[0]).max() < KINK:
        return generic(motions)
    slope = (ahead - back) / 2.0
    return slope if np.abs(slope).max() > DEPENDS else None


def varying(slope: Array, move: RockingPlacer, carried: Array) -> NDArray[np.bool_]:
    """Flags of trials in which a measure changes with a motion that no load-carrying contact prevents (n,).

    Contacts without load in the nominal pose may carry it by the tilt that balances the force: that is one pose.

    Args:
        slope: of the measure along the motions (motions,).
        move: the rest.
        carried: the part of the force that each contact carries (contacts, n).
    """
    sets, which = carrying(carried)
    varies = []
    for contacts in sets:
        rows = move.rows[contacts]
        left, unheld = (own - rows.T @ np.linalg.lstsq(rows.T, own, rcond=None)[0] for own in (slope, move.pull))
        rocks = contacts.sum() < len(slope) and np.abs(unheld).max() < DEPENDS
        varies.append(rocks and np.abs(left).max() > DEPENDS)
    return np.array(varies, dtype=bool)[which]


def carrying(carried: Array) -> tuple[NDArray[np.bool_], NDArray[np.intp]]:
    """The sets of contacts that carry load (sets, contacts), and the set of each trial (n,)."""
    keys = np.packbits(carried > 0.0, axis=0).T
    _, first, which = np.unique(
        np.ascontiguousarray(keys).view(np.dtype((np.void, keys.shape[1])))[:, 0],
        return_index=True,
        return_inverse=True,
    )
    return carried[:, first].T > 0.0, which


def over_poses(low: Array, high: Array, alone: Array, codes: Codes, rocking: Rocking | None) -> tuple[Array, Codes]:
    """Values and codes (n,) of a measure that varies between two ends.

    Args:
        low, high: its values there (n,).
        alone: at some pose between (n,).
        codes: so far (n,).
        rocking: the value to take.
    """
    wide = (codes == OK) & ~(np.abs(high - low) <= NARROW)
    if rocking is None:
        return alone, np.where(wide, np.int8(NOT_UNIQUE), codes)
    ends = np.minimum(low, high), np.maximum(low, high)
    asked = {"least": ends[0], "middle": (ends[0] + ends[1]) / 2.0, "largest": ends[1]}[rocking]
    return np.where(wide, asked, alone), codes


Words = NDArray[np.str_]


def decided(
    assembly: Assembly, world: World, on_the_way: Mapping[str, tuple[Cause, ...]], codes: Mapping[str, Codes]
) -> Iterator[tuple[str, Words]]:
    """Columns (n,) by their names.

    For a rest its load-carrying contacts, such as "1 3 4"; for a move with play the pair with the least slack; for a
    measure that could not be read for lack of clearance, the pair or the datums of the first clearance that is too
    small, else "".

    Args:
        assembly: the model.
        world: after the last move.
        on_the_way: possible failures before each measure, in order.
        codes: its status codes (n,).
    """
    for name, loads in world.loads.items():
        sets, which = carrying(loads)
        words = np.array([" ".join(map(str, np.flatnonzero(each) + 1)) for each in sets])
        yield f"carries:{name}", words[which]
    for name, pairs in world.tightest.items():
        yield f"tightest:{name}", pairs
    for name, causes in on_the_way.items():
        rooms = [cause for cause in causes if _is_room(assembly, cause)]
        gauges = _inspecting(assembly.measures[name], assembly)
        if rooms or gauges:
            found = _reasons(assembly, world, rooms, codes[name])
            yield reason_column(name), np.where((codes[name] == NO_BUILD) & (found == ""), _gauges(gauges), found)


def _inspecting(measured: Measured, assembly: Assembly) -> tuple[GaugeRoom, ...]:
    """The gauges whose positions a measure minimises over."""
    if measured.room is not None:
        return (measured.room,)
    frame = assembly.datum_frames[measured.frame] if measured.over_gauges else None
    return () if frame is None or frame.gauges is None else frame.gauges.rooms


def _gauges(rooms: Sequence[GaugeRoom]) -> str:
    return f"gauges of {', '.join(room.feature for room in rooms)}" if rooms else ""


def _is_room(assembly: Assembly, cause: Cause) -> bool:
    """True if a cause is a clearance into which something may not fit."""
    if isinstance(cause, int):
        return assembly.moves[cause].acts.has_room
    return assembly.datum_frames[cause].gauges is not None


def _reasons(assembly: Assembly, world: World, rooms: Sequence[Cause], codes: Codes) -> Words:
    """Failure reasons of a measure, in words (n,)."""
    found: Words = np.full(len(codes), "")
    for cause in rooms:
        if isinstance(cause, int):
            name = assembly.moves[cause].name
            failed, words = world.slacks[name] < 0.0, world.tightest[name]
        else:
            frame = assembly.datum_frames[cause]
            failed = world.own[frame.part].codes(cause) == NO_BUILD
            words = np.array(_gauges(frame.gauges.rooms if frame.gauges else ()))
        found = np.where((codes == NO_BUILD) & (found == "") & failed, words, found)
    return found
