"""Mated parts: what relations ask of their two features, trial by trial."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Axis, Feature, Mate, Point, Relation
from tol3d.assembly.placing.actual_feature import ActualFeature, actual_size
from tol3d.assembly.placing.alignment import Alignment, Held, Seat, Tie, Turning
from tol3d.assembly.placing.freedoms import aligned
from tol3d.assembly.placing.poses import Codes, Pose, dot, rotated
from tol3d.assembly.placing.world import World
from tol3d.errors import InputError

Array = NDArray[np.float64]

ASKED: Final[Mapping[tuple[str, str, str], tuple[Held, Turning]]] = {
    ("coincident", "plane", "plane"): ("along", "direction"),
    ("distance", "plane", "plane"): ("along", "direction"),
    ("coincident", "point", "plane"): ("along", "none"),
    ("distance", "point", "plane"): ("along", "none"),
    ("coincident", "point", "point"): ("all", "none"),
    ("coincident", "point", "axis"): ("across", "none"),
    ("coaxial", "axis", "axis"): ("across", "direction"),
    ("tangent", "axis", "plane"): ("along", "level"),
}
"""What relations ask, by their kind and the shapes of their two features."""


@dataclass(frozen=True, eq=False)
class Mating:
    """A mate with the steps of its alignment.

    Args:
        move: which.
        alignment: of its relations, in order.
        signs: of each, 1 where both directions nominally point the same way, -1 where they are opposed.
    """

    move: Mate
    alignment: Alignment
    signs: tuple[float, ...]

    def placed(self, world: World) -> tuple[World, Codes]:
        """The world after the move, and what became of it (n,) or (1,)."""
        pose, codes = self.poses(world, self.seats(world))
        return world.with_part_at(self.move.part, pose), codes

    def seats(self, world: World) -> list[Seat]:
        """Its relations in their trials."""
        return [
            _seat(self.move, relation, sign, world)
            for relation, sign in zip(self.move.relations, self.signs, strict=True)
        ]

    def poses(self, world: World, seats: Sequence[Seat], start: Pose | None = None) -> tuple[Pose, Codes]:
        """Of the part, from its nominal pose or another one, and what became of it (n,) or (1,)."""
        return self.alignment.poses(seats, start or Pose.of(world.assembly.part[self.move.part].pose))


def mating(move: Mate, nominal: World) -> Mating:
    """A mate.

    Args:
        move: which.
        nominal: the world before it without deviations, the part at its nominal pose.

    Raises:
        InputError: a relation is none of its two features, takes no freedom, or cannot be met in its order.
    """
    ties = tuple(_tie(move, relation, nominal) for relation in move.relations)
    signs = tuple(_sign(move, relation, nominal) for relation in move.relations)
    seats = [_seat(move, relation, sign, nominal) for relation, sign in zip(move.relations, signs, strict=True)]
    alignment = aligned(ties, seats, nominal.poses[move.part])
    for tie in alignment.idle:
        raise InputError(f"{ties[tie].name} takes no freedom: relations before it hold all that it asks; leave it out")
    return Mating(move, alignment, signs)


def asked_of(relation: Relation, features: Mapping[str, Feature]) -> tuple[Held, Turning] | None:
    """What a relation asks; None where it is none of its two features."""
    return ASKED.get((relation.kind, _word(features[relation.moving]), _word(features[relation.target])))


def _tie(move: Mate, relation: Relation, world: World) -> Tie:
    features = world.assembly.features
    shapes = _word(features[relation.moving]), _word(features[relation.target])
    name = f"moves.{move.name}: {relation.kind} of {relation.moving} and {relation.target}"
    asked = asked_of(relation, features)
    if asked is None:
        expected = " or ".join(f"{moving} on {target}" for kind, moving, target in ASKED if kind == relation.kind)
        raise InputError(f"{name}: expected {expected}, got {shapes[0]} on {shapes[1]}")
    if relation.kind == "tangent" and getattr(features[relation.moving].shape, "diameter", None) is None:
        raise InputError(f"{name}: expected a diameter of {relation.moving}, got an axis without one")
    return Tie(name, *asked)


def _word(feature: Feature) -> str:
    if isinstance(feature.shape, Point):
        return "point"
    return "axis" if isinstance(feature.shape, Axis) else "plane"


def _sign(move: Mate, relation: Relation, nominal: World) -> float:
    moving = rotated(nominal.poses[move.part].turn, nominal.on_body(relation.moving, move.part).direction)
    return -1.0 if dot(moving, nominal.placed(relation.target).direction)[0] < 0 else 1.0


def _seat(move: Mate, relation: Relation, sign: float, world: World) -> Seat:
    moving, target = world.on_body(relation.moving, move.part), world.placed(relation.target)
    if _is_point(target):
        return Seat(moving.origin, target.origin)
    if _is_point(moving):
        return Seat(moving.origin, target.origin, None, target.direction, relation.distance)
    if relation.kind == "tangent":
        radius = actual_size(moving.feature, world.columns) / 2
        return Seat(moving.origin, target.origin, moving.direction, target.direction, radius)
    return Seat(moving.origin, target.origin, sign * moving.direction, target.direction, relation.distance)


def _is_point(actual: ActualFeature) -> bool:
    return isinstance(actual.feature.shape, Point)
