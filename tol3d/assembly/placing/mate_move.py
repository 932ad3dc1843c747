"""Mated parts: constraints by relations of two features, trial by trial."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from tol3d.assembly.model import Assembly, Feature, Mate, Relation, Rest
from tol3d.assembly.model.cone_seat import cone_seat, unfit_cones
from tol3d.assembly.model.feature import Asks
from tol3d.assembly.placing.actual_feature import ActualFeature, actual_size, total
from tol3d.assembly.placing.alignment import Alignment, Seat, Tie
from tol3d.assembly.placing.freedoms import aligned
from tol3d.assembly.placing.placer import Asked, Placer, frame_in_world, rows_of
from tol3d.assembly.placing.poses import Codes, Pose, column, dot, rotated
from tol3d.assembly.placing.world import World
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array

ASKED: Final[Mapping[tuple[str, str, str], Asks]] = {
    ("coincident", "plane", "plane"): ("along", "direction"),
    ("distance", "plane", "plane"): ("along", "direction"),
    ("coincident", "point", "plane"): ("along", "none"),
    ("distance", "point", "plane"): ("along", "none"),
    ("coincident", "point", "point"): ("all", "none"),
    ("coincident", "point", "axis"): ("across", "none"),
    ("coincident", "cone", "cone"): ("all", "direction"),
    ("coaxial", "axis", "axis"): ("across", "direction"),
    ("tangent", "axis", "plane"): ("along", "level"),
}
"""Constraints by relations, by their kind and the shapes of their two features."""


@dataclass(frozen=True, eq=False)
class Mating(Placer):
    """A mate with the steps of its alignment.

    Args:
        move: the move.
        alignment: of its relations, in order.
        signs: of each, 1 where both directions nominally point the same way, -1 where they are opposed.
    """

    move: Mate
    alignment: Alignment
    signs: tuple[float, ...]

    def placed(self, world: World) -> tuple[World, Codes]:
        """The world after the move, and status codes (n,) or (1,)."""
        pose, codes = self.poses(world, self.seats(world))
        return world.with_part_at(self.move.part, pose), codes

    def seats(self, world: World) -> list[Seat]:
        """Its relations in their trials."""
        return [
            _seat(self.move, relation, sign, world)
            for relation, sign in zip(self.move.relations, self.signs, strict=True)
        ]

    def poses(self, world: World, seats: Sequence[Seat], start: Pose | None = None) -> tuple[Pose, Codes]:
        """Poses of the part from its nominal or another pose, with status codes (n,) or (1,)."""
        return self.alignment.poses(seats, start or Pose.of(world.assembly.part[self.move.part].pose))

    def asked(self, assembly: Assembly, middle: Array) -> Iterator[Asked]:
        """Its relations, one by one."""
        for relation in self.move.relations:
            asked = asked_of(relation, assembly.features)
            assert asked is not None  # others were refused before
            moving, target = frame_in_world(assembly, relation.moving), frame_in_world(assembly, relation.target)
            z = target[:3, 2]
            rows = rows_of(asked, moving[:3, 3] - middle, z)
            if asked[1] == "level":
                rows = np.vstack([rows, [*np.zeros(3), *np.cross(moving[:3, 2], z)]])
            yield Asked(f"{relation.kind}: {relation.moving} on {relation.target}", rows)


def mating(move: Mate, nominal: World) -> Mating:
    """A mate.

    Args:
        move: the move.
        nominal: the world before it without deviations, the part at its nominal pose.

    Raises:
        InputError: a relation is none of its two features, takes no freedom, or cannot be met in its order.
    """
    ties = tuple(_tie(move, relation, nominal) for relation in move.relations)
    signs = tuple(_sign(move, relation, nominal) for relation in move.relations)
    seats = [_seat(move, relation, sign, nominal) for relation, sign in zip(move.relations, signs, strict=True)]
    alignment = aligned(ties, seats, nominal.poses[move.part])
    for tie in alignment.idle:
        words = "takes no freedom: earlier relations hold all that it constrains; leave it out"
        raise InputError(f"{ties[tie].name} {words}")
    return Mating(move, alignment, signs)


def asked_of(relation: Relation, features: Mapping[str, Feature]) -> Asks | None:
    """Constraint by a relation; None if it has none for its two features."""
    words = features[relation.moving].shape.surface, features[relation.target].shape.surface
    found = ASKED.get((relation.kind, *words))
    if found is not None or relation.kind == "tangent":  # of a cylinder: a cone has no one radius
        return found
    moving, target = ("axis" if word == "cone" else word for word in words)
    return ASKED.get((relation.kind, moving, target))


def _tie(move: Mate, relation: Relation, world: World) -> Tie:
    features = world.assembly.features
    moving, target = features[relation.moving].shape, features[relation.target].shape
    name = f"moves.{move.name}: {relation.kind} of {relation.moving} and {relation.target}"
    asked = asked_of(relation, features)
    if asked is None:
        expected = " or ".join(f"{moving} on {target}" for kind, moving, target in ASKED if kind == relation.kind)
        raise InputError(f"{name}: expected {expected}, got {moving.surface} on {target.surface}")
    if relation.kind == "tangent" and moving.diameter is None:
        raise InputError(f"{name}: expected a diameter of {relation.moving}, got an axis without one")
    if asked == ("all", "direction") and (words := unfit_cones(moving, target, _sign(move, relation, world))):
        raise InputError(f"{name}: {words}")
    return Tie(name, *asked)


def _sign(move: Mate, relation: Relation, nominal: World) -> float:
    moving = rotated(nominal.poses[move.part].turn, nominal.on_body(relation.moving, move.part).direction)
    return -1.0 if dot(moving, nominal.placed(relation.target).direction)[0] < 0 else 1.0


def _seat(move: Mate, relation: Relation, sign: float, world: World) -> Seat:
    moving, target = world.on_body(relation.moving, move.part), world.placed(relation.target)
    if target.feature.shape.surface == "point":
        return Seat(moving.origin, target.origin)
    if moving.feature.shape.surface == "point":
        return Seat(moving.origin, target.origin, None, target.direction, relation.distance)
    if relation.kind == "coincident" and target.feature.shape.surface == "cone":
        height = _seated(moving, target, sign, world)
        return Seat(moving.origin, target.origin + height * target.direction, sign * moving.direction, target.direction)
    if relation.kind == "tangent":
        radius = actual_size(moving.feature, world.columns) / 2
        return Seat(moving.origin, target.origin, moving.direction, target.direction, radius)
    return Seat(moving.origin, target.origin, sign * moving.direction, target.direction, relation.distance)


def _seated(moving: ActualFeature, target: ActualFeature, sign: float, world: World) -> Array:
    """Height of a cone over the one in which it lies, or that lies in it (n,) or (1,) [mm]."""
    seat = cone_seat(moving.feature.shape, target.feature.shape, sign)
    assert seat is not None, "refused before"
    own, its = (total(each.feature.moved_by, 5, world.columns)[4] for each in (moving, target))
    return np.asarray(seat.height + seat.by_moving * own + seat.by_target * its)


INDEPENDENT = 1e-6
"""Least part of a constraint that acts on the freedoms left, else earlier relations keep it."""


@dataclass(frozen=True, eq=False)
class Kept:
    """Quantities kept by relations, n . (R p + s t), t the place of the part's origin or of the `about` point.

    Args:
        vectors, normals: p and n (kept, 3, n), directions times a length [mm].
        shifts: s, 1 of points and 0 of directions (kept,).
        groups: their number per relation.
    """

    vectors: Array
    normals: Array
    shifts: Array
    groups: tuple[int, ...]

    def about(self, middle: Array) -> "Kept":
        """The same for poses that state the place of a middle of the part (3, 1) [mm], not of its origin."""
        return replace(self, vectors=np.ascontiguousarray(self.vectors - self.shifts[:, None, None] * middle))


NOTHING = Kept(np.zeros((0, 3, 1)), np.zeros((0, 3, 1)), np.zeros(0), ())


@dataclass(frozen=True, eq=False)
class KeptRelations:
    """Relations that a part keeps.

    Args:
        mating: that meets them.
        length: by which directions count [mm]. toward: the nominal directions of their targets (3,), of unit length; 0
            of points.
    """

    mating: Mating
    length: float
    toward: tuple[Array, ...]

    def met(self, world: World) -> tuple[Pose, Codes, Kept]:
        """Poses that meet them, status codes, and the quantities that they keep."""
        seats = self.mating.seats(world)
        pose, codes = self.mating.poses(world, seats)
        return pose, codes, self.kept_by(seats)

    def kept_by(self, seats: Sequence[Seat]) -> Kept:
        """Quantities that they keep, by trial."""
        rows: list[tuple[Array, Array, float]] = []
        groups = []
        for tie, seat, toward in zip(self.mating.alignment.ties, seats, self.toward, strict=True):
            before = len(rows)
            if tie.held == "all":
                rows += [(seat.point, column(axis), 1.0) for axis in np.eye(3)]
            elif tie.held == "along":
                rows.append((seat.point, seat.its_toward, 1.0))
            else:
                rows += [(seat.point, across, 1.0) for across in _across(toward, seat.its_toward)]
            if tie.turning == "level":
                rows.append((seat.its_direction, self.length * seat.its_toward, 0.0))
            elif tie.turning == "direction":
                rows += [(seat.its_direction, self.length * across, 0.0) for across in _across(toward, seat.its_toward)]
            groups.append(len(rows) - before)
        if not rows:
            return NOTHING
        return Kept(
            _stacked([vector for vector, _, _ in rows]),
            _stacked([normal for _, normal, _ in rows]),
            np.array([shift for _, _, shift in rows]),
            tuple(groups),
        )


def kept_relations(move: Rest, nominal: World, length: float) -> KeptRelations | None:
    """The relations of a rest, if it has any.

    Raises:
        InputError: see mating.
    """
    if not move.relations:
        return None
    return kept_of(mating(Mate(move.name, move.part, move.relations), nominal), nominal, length)


def kept_of(found: Mating, nominal: World, length: float) -> KeptRelations:
    """Quantities kept by relations that are met.

    Args:
        found: that meets them.
        nominal: the world before, without deviations.
        length: by which directions count [mm].
    """
    toward = tuple(np.zeros(3) if seat.toward is None else seat.toward[:, 0] for seat in found.seats(nominal))
    return KeptRelations(found, length, toward)


def _across(middle: Array, direction: Array) -> list[Array]:
    """Two directions perpendicular to others (3, n) near one (3,), nearly of unit length."""
    first = np.cross(middle, np.eye(3)[int(np.argmin(np.abs(middle)))])
    first /= np.linalg.norm(first)
    found = []
    for own in (first, np.cross(middle, first)):
        found.append(column(own) - dot(column(own), direction) * direction)
    return found


def _stacked(arrays: Sequence[Array]) -> Array:
    return np.ascontiguousarray(np.stack(np.broadcast_arrays(*arrays)))


def kept_rows(kept: Kept, turn: Array, reach: float) -> Array:
    """Nominal change of the kept quantities per turn by reach and shift (kept, 6)."""
    arms, normals = kept.vectors[:, :, 0] @ turn.T, kept.normals[:, :, 0]
    return np.hstack([np.cross(arms, normals) / reach, kept.shifts[:, None] * normals])


def kept_motions(kept: Kept, turn: Array, reach: float, steps: Array) -> tuple[Array, Array]:
    """Steps that keep the constraints nominally, and steps that undo a change of each.

    Args:
        kept: nominally.
        turn: nominal rotation of the part (3, 3).
        reach: [mm].
        steps: turn by reach and shift (6, steps).

    Returns:
        Steps that are free (6, free), and those that undo (6, kept).
    """
    rows = kept_rows(kept, turn, reach)
    free, chosen = steps, np.zeros((0, len(rows)))
    start = 0
    for count in kept.groups:
        group = slice(start, start + count)
        left, sizes, right = np.linalg.svd(rows[group] @ free)
        rank = int(np.sum(sizes > INDEPENDENT * max(float(np.linalg.norm(rows[group], axis=1).max()), 1e-300)))
        weights = np.zeros((rank, len(rows)))
        weights[:, group] = left[:, :rank].T
        chosen, free, start = np.vstack([chosen, weights]), free @ right[rank:].T, start + count
    undo = steps @ np.linalg.pinv(chosen @ rows @ steps) @ chosen if len(rows) else np.zeros((6, 0))
    return free, np.ascontiguousarray(undo)
