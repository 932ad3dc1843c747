"""Placing plan of an assembly: its moves as decided by nominal geometry, once for all trials."""

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any, Protocol

import numpy as np

from tol3d.assembly.model import Assembly, BestFit, Engage, Fix, Locate, Mate, Move, Rest, StatedMove, Touch, Weld
from tol3d.assembly.model.statuses import OK
from tol3d.assembly.placing.actual_feature import ActualFeature
from tol3d.assembly.placing.best_fitting import BestFitting, best_fitting
from tol3d.assembly.placing.causes import Cause, Causes, causes_of
from tol3d.assembly.placing.datum_seats import DatumSeats, PartFeatures, datum_seats
from tol3d.assembly.placing.engaging import Engaging, engaging
from tol3d.assembly.placing.gauged_frames import with_gauges
from tol3d.assembly.placing.locating import Locating, locating
from tol3d.assembly.placing.mating import Mating, mating
from tol3d.assembly.placing.poses import Codes, Pose
from tol3d.assembly.placing.resting import Resting, resting
from tol3d.assembly.placing.touching import Touching, touching
from tol3d.assembly.placing.world import SolidReader, World
from tol3d.numerics.arrays import Array


class Placer(Protocol):
    """A move of another mechanism, planned by its nominal geometry; frozen, compared by identity."""

    def placed(self, world: World) -> tuple[World, Codes]:
        """The world after it, and what became of it: codes (n,) or (1,) of tol3d.assembly.model.statuses."""
        ...


Placing = Fix | Weld | Locating | Mating | BestFitting | Resting | Touching | Engaging | Placer

_MOVED: Codes = np.full(1, OK, dtype=np.int8)


@dataclass(frozen=True, eq=False)
class PlacingPlan:
    """An assembly with its plan of placing, made from nominal geometry once for all trials.

    Args:
        assembly: the model.
        datum_seats: of each part its datum frames.
        moves: in order.
        causes: possible failures before the first move and after each.
        solids: reads clearances.
        still: of each part its features that never deviate, as far as they were needed.
    """

    assembly: Assembly
    datum_seats: Mapping[str, Mapping[str, DatumSeats]]
    moves: tuple[Placing, ...]
    causes: tuple[Causes, ...]
    solids: SolidReader | None = None
    still: Mapping[str, dict[str, ActualFeature]] = field(default_factory=lambda: defaultdict(dict))

    @cached_property
    def of_measures(self) -> Mapping[str, tuple[Cause, ...]]:
        """Possible failures before each measure, in order."""
        return {name: causes_of(each, name, self.causes) for name, each in self.assembly.measures.items()}


@lru_cache(maxsize=8)
def planned(assembly: Assembly, solids: SolidReader | None = None) -> PlacingPlan:
    """Plan by nominal geometry.

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
    world = world_before(assembly, seats, np.zeros((assembly.width, 1)))
    world = World(assembly, world.columns, world.own, {p.name: Pose.of(p.pose) for p in assembly.parts}, bodies)
    moves: list[Placing] = []
    for move in assembly.moves:
        moves.append(_planned(move, world))
        world, _ = after(moves[-1], world)
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
        case StatedMove():
            return move.placing(nominal)
        case Fix() | Weld():
            return move


def world_before(
    assembly: Assembly,
    seats: Mapping[str, Mapping[str, DatumSeats]],
    columns: Array,
    still: Mapping[str, dict[str, ActualFeature]] | None = None,
    kept: dict[str, Any] | None = None,
) -> World:
    """Before the first move; with what is `kept` of these trials in other poses, see World."""
    kept = {} if kept is None else kept
    own = {}
    for part in assembly.parts:
        known = kept.get(key := f"features of {part.name}")
        if known is None or not known.are_of(part):
            known = PartFeatures(part, seats[part.name], columns, still[part.name] if still is not None else None)
        own[part.name] = kept[key] = known
    bodies = {part.name: frozenset([part.name]) for part in assembly.parts}
    return World(assembly, columns, own, {}, bodies, kept=kept)


def after(move: Placing, world: World) -> tuple[World, Codes]:
    """The world after a move, and status codes (n,) or (1,)."""
    match move:
        case Fix():
            return world.with_part_at(move.part, Pose.of(world.assembly.part[move.part].pose)), _MOVED
        case Weld():
            return world.with_welded((move.part, *move.others)), _MOVED
        case _:
            return move.placed(world)
