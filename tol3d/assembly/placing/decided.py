"""What decided in each trial, in words: columns beside the values."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Assembly, Engage, Measured
from tol3d.assembly.model.datum_frame import GaugeRoom
from tol3d.assembly.model.statuses import NO_BUILD
from tol3d.assembly.placing.causes import Cause
from tol3d.assembly.placing.poses import Codes
from tol3d.assembly.placing.rocking import carrying
from tol3d.assembly.placing.world import World
from tol3d.system.outcome import reason_column

Words = NDArray[np.str_]


def decided(
    assembly: Assembly, world: World, on_the_way: Mapping[str, tuple[Cause, ...]], codes: Mapping[str, Codes]
) -> Iterator[tuple[str, Words]]:
    """Columns (n,) by their names.

    Of a rest which contacts carry, such as "1 3 4"; of a move with play the pair that has the least slack; of a measure
    that hangs on rooms, where it is not built, the pair or the datums of the first of them that is too small, else "".

    Args:
        assembly: the model.
        world: after the last move.
        on_the_way: of each measure that is read, what may fail on the way to it, in order.
        codes: what became of it (n,).
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
    """The gauges over whose places a measure is read."""
    if measured.room is not None:
        return (measured.room,)
    frame = assembly.datum_frames[measured.frame] if measured.over_gauges else None
    return () if frame is None or frame.gauges is None else frame.gauges.rooms


def _gauges(rooms: Sequence[GaugeRoom]) -> str:
    return f"gauges of {', '.join(own.feature for own in rooms)}" if rooms else ""


def _is_room(assembly: Assembly, cause: Cause) -> bool:
    """Whether a cause is a room in which something may not fit."""
    if isinstance(cause, int):
        return isinstance(assembly.moves[cause], Engage)
    return assembly.datum_frames[cause].gauges is not None


def _reasons(assembly: Assembly, world: World, rooms: Sequence[Cause], codes: Codes) -> Words:
    """Of a measure, in words (n,)."""
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
