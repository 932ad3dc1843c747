"""Placing plan of an assembly: its moves as decided by nominal geometry, once for all trials."""

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from tol3d.assembly.model import Assembly
from tol3d.assembly.placing.actual_feature import ActualFeature
from tol3d.assembly.placing.causes import Cause, Causes, causes_of
from tol3d.assembly.placing.datum_seats import DatumSeats, PartFeatures, datum_seats
from tol3d.assembly.placing.gauged_frames import with_gauges
from tol3d.assembly.placing.placer import Placer, RockingPlacer, RoomPlacer
from tol3d.assembly.placing.poses import Pose
from tol3d.assembly.placing.world import SolidReader, World
from tol3d.import_path import named
from tol3d.numerics.arrays import Array


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
    moves: tuple[Placer, ...]
    causes: tuple[Causes, ...]
    solids: SolidReader | None = None
    still: Mapping[str, dict[str, ActualFeature]] = field(default_factory=lambda: defaultdict(dict))

    @cached_property
    def rooms(self) -> Mapping[int, RoomPlacer]:
        """The moves that leave a part within clearances, by their places."""
        return {k: own for k, own in enumerate(self.moves) if isinstance(own, RoomPlacer)}

    @cached_property
    def rocking(self) -> Mapping[int, RockingPlacer]:
        """The moves on whose contacts a part may rock, by their places."""
        return {k: own for k, own in enumerate(self.moves) if isinstance(own, RockingPlacer)}

    @cached_property
    def of_measures(self) -> Mapping[str, tuple[Cause, ...]]:
        """Possible failures before each measure, in order."""
        return {name: causes_of(each, name, self.causes) for name, each in self.assembly.measures.items()}

    @cached_property
    def needed(self) -> Mapping[str, frozenset[int]]:
        """Moves without which each measure cannot be read, welds and what places their parts before them included."""
        welds = [k for k, move in enumerate(self.moves) if not move.move.parts]
        every = frozenset(welds).union(*(self._before_weld(k) for k in welds))
        return {
            name: every.union(
                (cause for cause in self.of_measures[name] if isinstance(cause, int)),
                (own.of_move for own in (each, each.minus) if own is not None and own.of_move >= 0),
            )
            for name, each in self.assembly.measures.items()
        }

    def _before_weld(self, index: int) -> frozenset[int]:
        """Moves on which the poses of parts depend that a weld makes one body."""
        before, after = self.causes[index : index + 2]
        parts = [part for part, body in after.bodies.items() if body != before.bodies[part]]
        return frozenset(cause for part in parts for cause in before.placed[part] if isinstance(cause, int))


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
    moves: list[Placer] = []
    for move in assembly.moves:
        moves.append(named(move.acts.placing)(move, world))
        world, _ = moves[-1].placed(world)
    return PlacingPlan(assembly, seats, tuple(moves), tuple(causes), solids)


def world_before(
    assembly: Assembly,
    seats: Mapping[str, Mapping[str, DatumSeats]],
    columns: Array,
    still: Mapping[str, dict[str, ActualFeature]] | None = None,
    kept: dict[str, Any] | None = None,
) -> World:
    """Before the first move; with what is `kept` of these trials, or of fewer that they repeat, see World."""
    kept = {} if kept is None else kept
    own = {}
    for part in assembly.parts:
        known = kept.get(key := f"features of {part.name}")
        if known is None or not known.are_of(part, columns.shape[1]):
            known = PartFeatures(part, seats[part.name], columns, still[part.name] if still is not None else None)
        kept[key] = known
        own[part.name] = known.repeated(columns.shape[1])
    bodies = {part.name: frozenset([part.name]) for part in assembly.parts}
    return World(assembly, columns, own, {}, bodies, kept=kept)
