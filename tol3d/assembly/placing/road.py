"""The exact road: where parts are and what measures read, by finite poses, block by block of trials."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Assembly, BestFit, Engage, Fix, Locate, Mate, Move, Rest, Touch, Weld
from tol3d.assembly.model.statuses import NO_BUILD, OK, SINGULAR
from tol3d.assembly.placing.actual_feature import ActualFeature
from tol3d.assembly.placing.best_fitting import BestFitting, best_fitting
from tol3d.assembly.placing.causes import Cause, Causes, causes_of, ordered
from tol3d.assembly.placing.datum_seats import DatumSeats, datum_seats
from tol3d.assembly.placing.decided import decided
from tol3d.assembly.placing.engaging import Engaging, engaging
from tol3d.assembly.placing.gauged_frames import with_gauges
from tol3d.assembly.placing.locating import Locating, locating
from tol3d.assembly.placing.mating import Mating, mating
from tol3d.assembly.placing.measuring import may_lack, reading
from tol3d.assembly.placing.part_features import PartFeatures
from tol3d.assembly.placing.poses import Codes, Pose
from tol3d.assembly.placing.resting import Resting, resting
from tol3d.assembly.placing.rocking import over_poses, slope_of, varying
from tol3d.assembly.placing.touching import Touching, touching
from tol3d.assembly.placing.world import SolidReader, World

Array = NDArray[np.float64]

BLOCK = 8192
"""Trials at a time: their arrays stay in a core's cache."""

NUDGE = 1e-3
"""Step [mm] from which it follows how a measure changes with a part's play."""
FLAT = 1e-9
"""Change of a measure with it that is none."""

_MOVED: Codes = np.full(1, OK, dtype=np.int8)

Placing = Fix | Weld | Locating | Mating | BestFitting | Resting | Touching | Engaging


def values(
    assembly: Assembly, deviations: Array, names: Sequence[str], solids: SolidReader | None = None
) -> dict[str, tuple[Array, Codes]]:
    """What measures read in each trial, and what became of it.

    Args:
        assembly: the model.
        deviations: (trials, width) [mm].
        names: of the measures.
        solids: reads clearances, if there are some among them.

    Returns:
        By name: values (trials,) [mm or rad], not a number where the code is not OK, and codes (trials,): of the first
        move that failed among those that placed what is read.

    Raises:
        InputError: a move leaves a freedom or takes one twice; a part is not placed.
        FloatingPointError: what nothing fails is not a number.
    """
    return answers(assembly, deviations, names, solids)[0]


def answers(
    assembly: Assembly, deviations: Array, names: Sequence[str], solids: SolidReader | None = None
) -> tuple[dict[str, tuple[Array, Codes]], dict[str, NDArray[np.str_]]]:
    """What measures read, as `values`; and columns of what decided in each trial (trials,), see `decided`."""
    plan = planned(assembly, solids)
    deviations = np.asarray(deviations, dtype=np.float64)
    found = {name: (np.empty(len(deviations)), np.empty(len(deviations), dtype=np.int8)) for name in names}
    words, on_the_way = dict[str, list[NDArray[np.str_]]](), {name: plan.of_measures[name] for name in names}
    for start in range(0, len(deviations), BLOCK):
        rows = slice(start, start + BLOCK)
        block = _placed(plan, deviations[rows])
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
        By part: poses in the world (trials, 4, 4), not a number where a move that placed it failed.

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
        after: index of the move after which they are asked; -1 for the end.

    Returns:
        By feature: frames in the world (trials, 4, 4), not a number where a move that placed its part failed.

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
class PlacingPlan:
    """An assembly as it is placed, and what its nominal geometry decides once for all trials.

    Args:
        assembly: the model.
        datum_seats: of each part its datum frames.
        moves: in order.
        causes: before the first move and after each, what may have failed.
        solids: reads clearances.
        still: of each part its features that never deviate, as far as they were asked for.
    """

    assembly: Assembly
    datum_seats: Mapping[str, Mapping[str, DatumSeats]]
    moves: tuple[Placing, ...]
    causes: tuple[Causes, ...]
    solids: SolidReader | None = None
    still: Mapping[str, dict[str, ActualFeature]] = field(default_factory=lambda: defaultdict(dict))

    @cached_property
    def of_measures(self) -> Mapping[str, tuple[Cause, ...]]:
        """What may fail on the way to each measure, in order."""
        return {name: causes_of(each, name, self.causes) for name, each in self.assembly.measures.items()}


@lru_cache(maxsize=8)
def planned(assembly: Assembly, solids: SolidReader | None = None) -> PlacingPlan:
    """What the nominal geometry decides.

    Args:
        assembly: the model.
        solids: reads clearances.

    Raises:
        InputError: see `values`.
    """
    seats = {part.name: with_gauges(datum_seats(part)) for part in assembly.parts}
    bodies = {part.name: frozenset([part.name]) for part in assembly.parts}
    causes = [Causes(assembly, {}, bodies)]
    for index, move in enumerate(assembly.moves):
        causes.append(causes[-1].after(index, move))
    # before it is placed, a part is at its nominal pose
    world = _world(assembly, seats, np.zeros((assembly.width, 1)))
    world = World(assembly, world.columns, world.own, {p.name: Pose.of(p.pose) for p in assembly.parts}, bodies)
    moves: list[Placing] = []
    for move in assembly.moves:
        moves.append(_planned(move, world))
        world, _ = _after(moves[-1], world)
    return PlacingPlan(assembly, seats, tuple(moves), tuple(causes), solids)


def _planned(move: Move, nominal: World) -> Placing:
    match move:
        case Locate():
            return locating(move, nominal)
        case Mate():
            return mating(move, nominal)
        case BestFit():
            return best_fitting(move, nominal)
        case Rest():
            return resting(move, nominal)
        case Touch():
            return touching(move, nominal)
        case Engage():
            return engaging(move, nominal)
        case _:
            return move


def _world(
    assembly: Assembly,
    seats: Mapping[str, Mapping[str, DatumSeats]],
    columns: Array,
    still: Mapping[str, dict[str, ActualFeature]] | None = None,
) -> World:
    """Before the first move."""
    own = {
        part.name: PartFeatures(part, seats[part.name], columns, still[part.name] if still is not None else None)
        for part in assembly.parts
    }
    return World(assembly, columns, own, {}, {part.name: frozenset([part.name]) for part in assembly.parts})


@dataclass(frozen=True, eq=False)
class _Block:
    """Trials that are placed: the worlds before the first move and after each, and what became of causes (n,)."""

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


def _placed(plan: PlacingPlan, deviations: Array, instead: Mapping[int, Resting | Engaging] | None = None) -> _Block:
    """Trials as moves place them; `instead` has other moves for some, by their places."""
    assembly = plan.assembly
    _refuse_lost("a deviation", ~np.isfinite(deviations.sum(axis=1)))
    worlds, codes = (
        [_world(assembly, plan.datum_seats, np.ascontiguousarray(deviations.T), plan.still)],
        dict[int, Codes](),
    )
    for index, move in enumerate(plan.moves):
        world, codes[index] = _after(instead.get(index, move) if instead else move, worlds[-1])
        worlds.append(world)
    block = _Block(tuple(worlds), codes)
    for part, causes in plan.causes[-1].placed.items():
        pose = worlds[-1].poses[part]
        lost = ~np.isfinite(pose.turn.sum(axis=(0, 1)) + pose.shift.sum(axis=0))
        _refuse_lost(f"the pose of {part}", lost & (block.first_of(ordered(causes)) == OK) if lost.any() else lost)
    return block


def _refuse_lost(what: str, lost: NDArray[np.bool_]) -> None:
    """Raise a fault, no status, where a number is lost in a trial (n,) that nothing fails."""
    if lost.any():
        raise FloatingPointError(f"{what} is not a number in {np.count_nonzero(lost)} trials that nothing fails")


def _after(move: Placing, world: World) -> tuple[World, Codes]:
    """The world after a move, and what became of it (n,) or (1,)."""
    match move:
        case Fix():
            return world.with_part_at(move.part, Pose.of(world.assembly.part[move.part].pose)), _MOVED
        case Weld():
            return world.with_welded((move.part, *move.others)), _MOVED
        case _:
            return move.placed(world)


def _read(plan: PlacingPlan, block: _Block, name: str, causes: Sequence[Cause]) -> tuple[Array, Codes]:
    """A measure's values and codes (n,)."""
    if plan.assembly.measures[name].kind == "clearance":
        return _apart(plan, block, name, block.first_of(causes))
    measured, first = plan.assembly.measures[name], block.first_of(causes)
    lost = (first == OK) & ~np.isfinite(numbers := reading(measured, block.worlds))
    if lost.any():
        _refuse_lost(f"measures.{name}", lost & ~may_lack(measured, block.codes))
    gauged = measured.room is not None or measured.over_gauges  # a datum does not take a gauge
    first = np.where(lost, np.int8(NO_BUILD if gauged else SINGULAR), first)
    return np.where(first == OK, numbers, np.nan), first


def _apart(plan: PlacingPlan, block: _Block, name: str, codes: Codes) -> tuple[Array, Codes]:
    """Values and codes (n,) of a clearance, from codes of what placed its parts."""
    if plan.solids is None:
        raise ValueError(f"{name}: nothing reads the distances of solids")
    measured = plan.assembly.measures[name]
    world = block.worlds[-1] if measured.after < 0 else block.worlds[measured.after + 1]
    poses = [world.poses[part].matrices(world.trials) for part in measured.parts]
    values, placed = np.full(len(codes), np.nan), codes == OK
    values[placed], codes[placed] = plan.solids.read(name, poses[0][placed], poses[1][placed])
    return values, codes


def _over_rests(plan: PlacingPlan, block: _Block, name: str, deviations: Array) -> tuple[Array, Codes]:
    """A measure's values and codes (n,); where parts may rock, over all poses that they may take."""
    if plan.assembly.measures[name].over_play is not None:
        block = _placed(plan, deviations, _over_play(plan, name))
    numbers, codes = _read(plan, block, name, plan.of_measures[name])
    leaning, varies = dict[int, Array](), np.zeros(len(numbers), dtype=bool)
    for index in plan.of_measures[name]:
        move = plan.moves[index] if isinstance(index, int) else None
        if isinstance(move, Resting) and isinstance(index, int):
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
        there = _placed(plan, deviations[varies], instead)
        ends.append(_read(plan, there, name, plan.of_measures[name])[0])
    numbers[varies], codes[varies] = over_poses(
        ends[0], ends[1], numbers[varies], codes[varies], plan.assembly.measures[name].rocking
    )
    return np.where(codes == OK, numbers, np.nan), codes


@lru_cache(maxsize=256)
def _over_play(plan: PlacingPlan, name: str) -> Mapping[int, Engaging]:
    """Moves with play as they take a measure to its least or largest value, by its change with each nominally."""
    sign = 1.0 if plan.assembly.measures[name].over_play == "largest" else -1.0
    found, rest = dict[int, Engaging](), np.zeros((1, plan.assembly.width))
    for index, move in enumerate(plan.moves):
        if isinstance(move, Engaging):
            read = []
            for side in (1.0, -1.0):
                nudged = [replace(move, nudge=side * own) for own in NUDGE * np.eye(move.freedoms.shape[1])]
                blocks = [_placed(plan, rest, {index: own}) for own in nudged]
                read.append([_read(plan, own, name, plan.of_measures[name])[0][0] for own in blocks])
            slope = np.subtract(*np.array(read)) / (2 * NUDGE)
            found[index] = move.pushed(sign * np.where(np.abs(slope) > FLAT, slope, 0.0))
    return found


@lru_cache(maxsize=256)
def _slope(plan: PlacingPlan, name: str, index: int) -> Array | None:
    """How a measure changes with a part at rest."""
    move = plan.moves[index]
    assert isinstance(move, Resting)

    def read(deviations: Array, instead: Mapping[int, Resting]) -> Array:
        return _read(plan, _placed(plan, deviations, instead), name, plan.of_measures[name])[0]

    return slope_of(plan.assembly.measures[name], index, move, read, plan.assembly.width)


@lru_cache(maxsize=256)
def _leaning(plan: PlacingPlan, index: int, along: bytes) -> Resting:
    """A rest that leans along some motion."""
    move = plan.moves[index]
    assert isinstance(move, Resting)
    return move.leaning(np.frombuffer(along))
