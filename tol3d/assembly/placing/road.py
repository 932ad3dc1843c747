"""The exact road: where parts are and what measures read, by finite poses, block by block of trials."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Assembly, BestFit, Fix, Locate, Mate, Move, Weld
from tol3d.assembly.model.statuses import OK, SINGULAR
from tol3d.assembly.placing.best_fitting import BestFitting, best_fitting
from tol3d.assembly.placing.causes import Cause, Causes, causes_of, ordered
from tol3d.assembly.placing.datum_seats import DatumSeats, datum_seats
from tol3d.assembly.placing.locating import Locating, locating
from tol3d.assembly.placing.mating import Mating, mating
from tol3d.assembly.placing.measuring import reading
from tol3d.assembly.placing.part_features import PartFeatures
from tol3d.assembly.placing.poses import Codes, Pose
from tol3d.assembly.placing.world import World

Array = NDArray[np.float64]

BLOCK = 8192
"""Trials at a time: their arrays stay in a core's cache."""

_MOVED: Codes = np.full(1, OK, dtype=np.int8)

Placing = Fix | Weld | Locating | Mating | BestFitting


def values(assembly: Assembly, deviations: Array, names: Sequence[str]) -> dict[str, tuple[Array, Codes]]:
    """What measures read in each trial, and what became of it.

    Args:
        assembly: the model.
        deviations: (trials, width) [mm].
        names: of the measures.

    Returns:
        By name: values (trials,) [mm or rad], not a number where the code is not OK, and codes (trials,): of the first
        move that failed among those that placed what is read.

    Raises:
        InputError: a move leaves a freedom or takes one twice; a part is not placed.
    """
    plan = planned(assembly)
    deviations = np.asarray(deviations, dtype=np.float64)
    causes = {name: plan.of_measures[name] for name in names}
    found = {name: (np.empty(len(deviations)), np.empty(len(deviations), dtype=np.int8)) for name in names}
    for start in range(0, len(deviations), BLOCK):
        rows = slice(start, start + BLOCK)
        block = _placed(plan, deviations[rows])
        for name, (numbers, codes) in found.items():
            numbers[rows], codes[rows] = _read(plan, block, name, causes[name])
    return found


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
        trials = len(deviations[rows])
        for name, poses in found.items():
            failed = block.first_of(ordered(causes[name])) != OK
            poses[rows] = block.worlds[-1].poses[name].matrices(trials)
            poses[rows][failed] = np.nan
    return found


def features_placed(assembly: Assembly, deviations: Array) -> dict[str, Array]:
    """Frames of all features of placed parts as they lie in each trial, after the last move.

    Args:
        assembly: the model.
        deviations: (trials, width) [mm].

    Returns:
        By feature: frames in the world (trials, 4, 4), not a number where a move that placed its part failed.

    Raises:
        InputError: a move leaves a freedom or takes one twice; a part is not placed.
    """
    plan = planned(assembly)
    block = _placed(plan, np.asarray(deviations, dtype=np.float64))
    found = {}
    for part, causes in plan.causes[-1].placed.items():
        failed = block.first_of(ordered(causes)) != OK
        for feature in assembly.part[part].features:
            frames = block.worlds[-1].placed(feature.name).pose.matrices(len(deviations))
            found[feature.name] = np.where(np.broadcast_to(failed, len(deviations))[:, None, None], np.nan, frames)
    return found


@dataclass(frozen=True, eq=False)
class Plan:
    """An assembly as it is placed, and what its nominal geometry decides once for all trials.

    Args:
        assembly: the model.
        datum_seats: of each part its datum frames.
        moves: in order.
        causes: before the first move and after each, what may have failed.
    """

    assembly: Assembly
    datum_seats: Mapping[str, Mapping[str, DatumSeats]]
    moves: tuple[Placing, ...]
    causes: tuple[Causes, ...]

    @cached_property
    def of_measures(self) -> Mapping[str, tuple[Cause, ...]]:
        """What may fail on the way to each measure, in order."""
        return {name: causes_of(each, name, self.causes) for name, each in self.assembly.measures.items()}


@lru_cache(maxsize=8)
def planned(assembly: Assembly) -> Plan:
    """What the nominal geometry decides.

    Raises:
        InputError: see `values`.
    """
    seats = {part.name: datum_seats(part) for part in assembly.parts}
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
    return Plan(assembly, seats, tuple(moves), tuple(causes))


def _planned(move: Move, nominal: World) -> Placing:
    match move:
        case Locate():
            return locating(move, nominal)
        case Mate():
            return mating(move, nominal)
        case BestFit():
            return best_fitting(move, nominal)
        case _:
            return move


def _world(assembly: Assembly, seats: Mapping[str, Mapping[str, DatumSeats]], columns: Array) -> World:
    """Before the first move."""
    own = {part.name: PartFeatures(part, seats[part.name], columns) for part in assembly.parts}
    return World(assembly, columns, own, {}, {part.name: frozenset([part.name]) for part in assembly.parts})


@dataclass(frozen=True, eq=False)
class _Block:
    """Trials that are placed: the worlds before the first move and after each, and what became of causes (n,)."""

    worlds: tuple[World, ...]
    codes: dict[int, Codes]

    def first_of(self, causes: Sequence[Cause]) -> Codes:
        """The first code of some causes that is not OK (n,)."""
        world = self.worlds[-1]
        first = np.full(world.trials, OK, dtype=np.int8)
        for cause in causes:
            if isinstance(cause, str):
                codes = world.own[world.assembly.datum_frames[cause].part].codes(cause)
            else:
                codes = self.codes[cause]
            first = np.where(first == OK, codes, first).astype(np.int8)
        return first


def _placed(plan: Plan, deviations: Array) -> _Block:
    assembly = plan.assembly
    worlds, codes = [_world(assembly, plan.datum_seats, np.ascontiguousarray(deviations.T))], dict[int, Codes]()
    with np.errstate(all="ignore"):  # what is not a number gets a code
        for index, move in enumerate(plan.moves):
            world, codes[index] = _after(move, worlds[-1])
            worlds.append(world)
    return _Block(tuple(worlds), codes)


def _after(move: Placing, world: World) -> tuple[World, Codes]:
    """The world after a move, and what became of it (n,) or (1,)."""
    match move:
        case Fix():
            return world.with_part_at(move.part, Pose.of(world.assembly.part[move.part].pose)), _MOVED
        case Weld():
            return world.with_welded((move.part, *move.others)), _MOVED
        case _:
            return move.placed(world)


def _read(plan: Plan, block: _Block, name: str, causes: Sequence[Cause]) -> tuple[Array, Codes]:
    """A measure's values and codes (n,)."""
    with np.errstate(all="ignore"):
        numbers = reading(plan.assembly.measures[name], block.worlds)
        first = block.first_of(causes)
    first = np.where((first == OK) & ~np.isfinite(numbers), np.int8(SINGULAR), first)
    return np.where(first == OK, numbers, np.nan), first
