"""The exact method: poses of parts and values of measures, by finite poses, in blocks of trials."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Assembly
from tol3d.assembly.model.statuses import NO_BUILD, OK, SINGULAR
from tol3d.assembly.placing.causes import Cause, ordered
from tol3d.assembly.placing.measuring import may_lack, reading
from tol3d.assembly.placing.placer import Placer, RockingPlacer, RoomPlacer
from tol3d.assembly.placing.plan import PlacingPlan, planned, world_before
from tol3d.assembly.placing.poses import Codes
from tol3d.assembly.placing.rocking import decided, over_poses, slope_of, varying
from tol3d.assembly.placing.world import SolidReader, World
from tol3d.numerics.arrays import Array

BLOCK = 8192
"""Trials at a time: their arrays stay in a core's cache."""

NUDGE = 1e-3
"""Step [mm] for the slope of a measure with a part's play."""
FLAT = 1e-9
"""Change of a measure by it that counts as none."""


def values(
    assembly: Assembly, deviations: Array, names: Sequence[str], solids: SolidReader | None = None
) -> dict[str, tuple[Array, Codes]]:
    """Values of measures in each trial, with status codes.

    Args:
        assembly: the model.
        deviations: (trials, width) [mm].
        names: of the measures.
        solids: reads clearances, if any are among them.

    Returns:
        By name: values (trials,) [mm or rad], NaN where the code is not OK, and codes (trials,), of the first move that
        failed among those on which the measure depends.

    Raises:
        InputError: a move leaves a freedom or takes one twice; a part is not placed.
        FloatingPointError: a value is NaN though nothing failed.
    """
    return answers(assembly, deviations, names, solids)[0]


def answers(
    assembly: Assembly, deviations: Array, names: Sequence[str], solids: SolidReader | None = None
) -> tuple[dict[str, tuple[Array, Codes]], dict[str, NDArray[np.str_]]]:
    """Values of measures, as `values`; and columns of the deciding place in each trial (trials,), see `decided`."""
    return planned_answers(planned(assembly, solids), deviations, names)


def planned_answers(
    plan: PlacingPlan, deviations: Array, names: Sequence[str], kept: dict[int, dict[str, Any]] | None = None
) -> tuple[dict[str, tuple[Array, Codes]], dict[str, NDArray[np.str_]]]:
    """The same for a planned assembly.

    Args:
        plan, deviations, names: see `values`.
        kept: by block, of the same trials in other poses, or of fewer that all these repeat in one block; see World.
    """
    assembly = plan.assembly
    deviations = np.asarray(deviations, dtype=np.float64)
    found = {name: (np.empty(len(deviations)), np.empty(len(deviations), dtype=np.int8)) for name in names}
    words, on_the_way = dict[str, list[NDArray[np.str_]]](), {name: plan.of_measures[name] for name in names}
    for start in range(0, len(deviations), BLOCK):
        rows = slice(start, start + BLOCK)
        own = None if kept is None else kept.setdefault(start, {})
        block = _placed(plan, deviations[rows], kept=own, measure=names[0] if len(names) == 1 else "")
        for name, (numbers, codes) in found.items():
            numbers[rows], codes[rows] = _over_rests(plan, block, name, deviations[rows])
        codes_here = {name: codes[rows] for name, (_, codes) in found.items()}
        for name, column in decided(assembly, block.worlds[-1], on_the_way, codes_here):
            words.setdefault(name, []).append(column)
    return found, {name: np.concatenate(own) for name, own in words.items()}


def placed(assembly: Assembly, deviations: Array) -> dict[str, Array]:
    """Poses of all parts that are placed, after the last move.

    Args:
        assembly: the model.
        deviations: (trials, width) [mm].

    Returns:
        By part: poses in the world (trials, 4, 4), NaN where a move that placed it failed.

    Raises:
        InputError: a move leaves a freedom or takes one twice; a part is not placed.
    """
    plan = planned(assembly)
    deviations = np.asarray(deviations, dtype=np.float64)
    causes = plan.causes[-1].placed
    found = {name: np.empty((len(deviations), 4, 4)) for name in causes}
    for start in range(0, len(deviations), BLOCK):
        rows = slice(start, start + BLOCK)
        block = _placed(plan, deviations[rows])
        for name, poses in found.items():
            failed = block.first_of(ordered(causes[name])) != OK
            poses[rows] = block.worlds[-1].poses[name].matrices(len(failed))
            poses[rows][failed] = np.nan
    return found


def features_placed(assembly: Assembly, deviations: Array, after: int = -1) -> dict[str, Array]:
    """Frames of all features of placed parts as they lie in each trial.

    Args:
        assembly: the model.
        deviations: (trials, width) [mm].
        after: index of the move after which they are evaluated; -1 for the end.

    Returns:
        By feature: frames in the world (trials, 4, 4), NaN where a move that placed its part failed.

    Raises:
        InputError: a move leaves a freedom or takes one twice; a part is not placed.
    """
    plan = planned(assembly)
    block = _placed(plan, np.asarray(deviations, dtype=np.float64))
    found, moment = {}, -1 if after < 0 else after + 1
    for part, causes in plan.causes[moment].placed.items():
        failed = block.first_of(ordered(causes)) != OK
        for feature in assembly.part[part].features:
            frames = block.worlds[moment].placed(feature.name).pose.matrices(len(deviations))
            found[feature.name] = np.where(np.broadcast_to(failed, len(deviations))[:, None, None], np.nan, frames)
    return found


@dataclass(frozen=True, eq=False)
class _Block:
    """Placed trials: the worlds before the first move and after each, and codes of causes (n,)."""

    worlds: tuple[World, ...]
    codes: dict[int, Codes]

    failed: dict[Cause, Codes | None] = field(default_factory=dict)

    def first_of(self, causes: Sequence[Cause]) -> Codes:
        """The first code of some causes that is not OK (n,)."""
        first = np.full(self.worlds[-1].trials, OK, dtype=np.int8)
        for cause in causes:
            if (codes := self._failed(cause)) is not None:
                first = np.where(first == OK, codes, first).astype(np.int8)
        return first

    def _failed(self, cause: Cause) -> Codes | None:
        """Codes (n,) or (1,) of a cause; None where all are OK."""
        if cause not in self.failed:
            if isinstance(cause, str):
                world = self.worlds[-1]
                codes = world.own[world.assembly.datum_frames[cause].part].codes(cause)
            else:
                codes = self.codes[cause]
            self.failed[cause] = codes if codes.any() else None
        return self.failed[cause]


def _placed(
    plan: PlacingPlan,
    deviations: Array,
    instead: Mapping[int, Placer] | None = None,
    otherwise: _Block | None = None,
    kept: dict[str, Any] | None = None,
    measure: str = "",
) -> _Block:
    """Trials placed by moves.

    Args:
        plan: the plan.
        deviations: (n, width) [mm].
        instead: other moves for some, by their places.
        otherwise: the same trials without these; before the first of them nothing is placed anew.
        kept: see World.
        measure: the one that is read of them, so that what it does not depend on need not be placed; "" for any.
    """
    _refuse_lost("a deviation", ~np.isfinite(deviations.sum(axis=1)))
    if otherwise is not None and instead:
        first = min(instead)
        worlds = [*otherwise.worlds[: first + 1]]
        codes = {index: own for index, own in otherwise.codes.items() if index < first}
    else:
        columns, codes = np.ascontiguousarray(deviations.T), dict[int, Codes]()
        worlds = [world_before(plan.assembly, plan.datum_seats, columns, plan.still, kept)]
    needed = plan.needed[measure] if measure else range(len(plan.moves))
    for index, move in enumerate(plan.moves[len(worlds) - 1 :], len(worlds) - 1):
        world = worlds[-1]
        if index in needed:
            world, codes[index] = (instead.get(index, move) if instead else move).placed(world)
        worlds.append(world)
    block = _Block(tuple(worlds), codes)
    for part, causes in plan.causes[-1].placed.items():
        if any(cause not in needed for cause in causes if isinstance(cause, int)):
            continue
        pose = worlds[-1].poses[part]
        lost = ~np.isfinite(pose.turn.sum(axis=(0, 1)) + pose.shift.sum(axis=0))
        _refuse_lost(f"the pose of {part}", lost & (block.first_of(ordered(causes)) == OK) if lost.any() else lost)
    return block


def _refuse_lost(what: str, lost: NDArray[np.bool_]) -> None:
    """Raise an error, no status, if a value is NaN in a trial (n,) without a failure."""
    if lost.any():
        raise FloatingPointError(f"{what} is not a number in {np.count_nonzero(lost)} trials that nothing fails")


def _read(plan: PlacingPlan, block: _Block, name: str, causes: Sequence[Cause]) -> tuple[Array, Codes]:
    """A measure's values and codes (n,)."""
    if plan.assembly.measures[name].kind == "clearance":
        return _apart(plan, block, name, block.first_of(causes))
    measured, first = plan.assembly.measures[name], block.first_of(causes)
    lost = (first == OK) & ~np.isfinite(numbers := reading(measured, block.worlds))
    if lost.any():
        _refuse_lost(f"measures.{name}", lost & ~may_lack(measured, block.codes))
    gauged = measured.room is not None or measured.over_gauges  # a datum is not gauged
    first = np.where(lost, np.int8(NO_BUILD if gauged else SINGULAR), first)
    return np.where(first == OK, numbers, np.nan), first


def _apart(plan: PlacingPlan, block: _Block, name: str, codes: Codes) -> tuple[Array, Codes]:
    """Values and codes (n,) of a clearance, from the codes of its parts' moves."""
    if plan.solids is None:
        raise ValueError(f"{name}: nothing reads the distances of solids")
    measured = plan.assembly.measures[name]
    world = block.worlds[-1] if measured.after < 0 else block.worlds[measured.after + 1]
    poses = [world.poses[part].matrices(world.trials) for part in measured.parts]
    values, found, placed = np.full(len(codes), np.nan), codes.copy(), codes == OK
    values[placed], found[placed] = plan.solids.read(name, poses[0][placed], poses[1][placed])
    return values, found


def _over_rests(plan: PlacingPlan, block: _Block, name: str, deviations: Array) -> tuple[Array, Codes]:
    """A measure's values and codes (n,); where parts may rock, over all poses that they may take."""
    alone = block
    if plan.assembly.measures[name].over_play is not None and (pushed := _over_play(plan, name)):
        block = _placed(plan, deviations, pushed, block, measure=name)
    numbers, codes = _read(plan, block, name, plan.of_measures[name])
    leaning, varies = dict[int, Array](), np.zeros(len(numbers), dtype=bool)
    for index in plan.of_measures[name]:
        if isinstance(index, int) and (move := plan.rocking.get(index)) is not None:
            carried = block.worlds[-1].loads[move.move.name]
            if (np.count_nonzero(carried, axis=0) < len(move.pull)).any():
                slope = _slope(plan, name, index)
                if slope is not None:
                    leaning[index], varies = slope, varies | varying(slope, move, carried)
    varies &= codes == OK
    if not varies.any():
        return numbers, codes
    ends = []
    for sign in (-1.0, 1.0):
        instead = {index: _leaning(plan, index, (sign * own).tobytes()) for index, own in leaning.items()}
        there = _placed(plan, deviations[varies], instead, alone if varies.all() else None, measure=name)
        ends.append(_read(plan, there, name, plan.of_measures[name])[0])
    numbers[varies], codes[varies] = over_poses(
        ends[0], ends[1], numbers[varies], codes[varies], plan.assembly.measures[name].rocking
    )
    return np.where(codes == OK, numbers, np.nan), codes


@lru_cache(maxsize=256)
def _over_play(plan: PlacingPlan, name: str) -> Mapping[int, RoomPlacer]:
    """Moves with play, pushed to the least or largest value of a measure, by its nominal slopes."""
    sign = 1.0 if plan.assembly.measures[name].over_play == "largest" else -1.0
    found, rest = dict[int, RoomPlacer](), np.zeros((1, plan.assembly.width))
    for index, move in plan.rooms.items():
        if index not in plan.needed[name]:
            continue
        read = []
        for side in (1.0, -1.0):
            nudged = [move.nudged(side * own) for own in NUDGE * np.eye(move.motions)]
            blocks = [_placed(plan, rest, {index: own}, measure=name) for own in nudged]
            read.append([_read(plan, block, name, plan.of_measures[name])[0][0] for block in blocks])
        slope = np.subtract(*np.array(read)) / (2 * NUDGE)
        found[index] = move.at_support_point(sign * np.where(np.abs(slope) > FLAT, slope, 0.0))
    return found


@lru_cache(maxsize=256)
def _slope(plan: PlacingPlan, name: str, index: int) -> Array | None:
    """Change of a measure per motion of a part at rest."""

    def read(deviations: Array, instead: Mapping[int, Placer]) -> Array:
        return _read(plan, _placed(plan, deviations, instead, measure=name), name, plan.of_measures[name])[0]

    return slope_of(plan.assembly.measures[name], index, plan.rocking[index], read, plan.assembly.width)


@lru_cache(maxsize=256)
def _leaning(plan: PlacingPlan, index: int, along: bytes) -> RockingPlacer:
    """A rest that leans along some motion."""
    return plan.rocking[index].leaning(np.frombuffer(along))
