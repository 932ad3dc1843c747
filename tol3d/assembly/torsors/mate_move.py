"""Mates: relations of two features, in order, each taking freedoms left by earlier ones."""

import numpy as np

from tol3d.assembly.model import Locate, Mate, Pair, Relation, Rest
from tol3d.assembly.model.cone_seat import cone_seat
from tol3d.assembly.torsors.features import summed
from tol3d.assembly.torsors.freedoms import Freedoms, freedom_in_words
from tol3d.assembly.torsors.torsor import height_at, perpendicular, shift_at, turn_about
from tol3d.assembly.torsors.world import World
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array


def mated(move: Mate, world: World) -> World:
    """The world with a part by its relations.

    Raises:
        InputError: a relation takes nothing, or is not one of its two features.
    """
    return world.with_part_at(move.part, freedoms_after(move, world).rest())


def freedoms_after(move: Mate, world: World) -> Freedoms:
    """Freedoms after the relations: those decided and those left; as `mated`."""
    part = world.assembly.part[move.part]
    points = [world.origin(name) for relation in move.relations for name in (relation.moving, relation.target)]
    freedoms = Freedoms(part.pose[:3, 3], points, world.columns.count)
    take_relations(freedoms, move, world)
    return freedoms


def take_relations(freedoms: Freedoms, move: Mate | Rest, world: World) -> None:
    """Let the relations of a move take freedoms, in order.

    Raises:
        InputError: as mated.
    """
    for relation in move.relations:
        if not _take(freedoms, relation, move, world):
            raise InputError(
                f"moves.{move.name}: {relation.kind} of {relation.moving} and {relation.target} takes no freedom: "
                "earlier relations hold all that it constrains; leave it out"
            )
        freedoms.settle(world.origin(relation.moving))


def _take(freedoms: Freedoms, relation: Relation, move: Mate | Rest, world: World) -> int:
    """Take the freedoms of a relation; returns their number."""
    pairing = _Pairing(freedoms, relation, move, world)
    shapes = [world.assembly.features[name].shape for name in (relation.moving, relation.target)]
    match relation.kind, *(shape.surface for shape in shapes):
        case "coincident" | "distance", "plane", "plane":
            return pairing.parallel() + pairing.height(relation.distance)
        case "coincident" | "distance", "point", "plane":
            return pairing.height(relation.distance)
        case "coincident", "point", "point":
            return pairing.position(np.eye(3))
        case "coincident", "cone", "cone":
            return pairing.seated() + pairing.parallel()
        case "coincident", "point", "axis" | "cone":
            return pairing.position(perpendicular(pairing.target_axis))
        case "coaxial", "axis" | "cone", "axis" | "cone":
            return pairing.position(perpendicular(pairing.target_axis)) + pairing.parallel()
        case "tangent", "axis", "plane":
            return pairing.lying() + pairing.height(*pairing.radius(relation.moving))
        case "tangent", "plane", "axis":
            return pairing.lying() + pairing.height_of_target(*pairing.radius(relation.target))
    raise InputError(
        f"moves.{move.name}: {relation.kind} of {relation.moving} and {relation.target}: "
        f"not of {_ARTICLES[shapes[0].surface]} and {_ARTICLES[shapes[1].surface]}"
    )


_ARTICLES = {"point": "a point", "axis": "an axis", "cone": "a cone", "plane": "a plane"}


class _Pairing:
    """The two features of a relation, and the equations that it may be made of."""

    def __init__(self, freedoms: Freedoms, relation: Relation, move: Mate | Rest, world: World) -> None:
        self._freedoms = freedoms
        self._relation = relation
        self._move = move
        self._world = world
        self._from = world.origin(relation.target)
        self._point = world.origin(relation.moving)
        self._axis = world.axis(relation.moving)
        self.target_axis = world.axis(relation.target)
        self._own = world.on_body(relation.moving, move.part)
        self._target = world.placed(relation.target)

    def _take(self, equations: Array, missing: Array) -> int:
        """Equations (equations, 6) of the moving feature less the target, `missing` nominally (equations,)."""
        values = equations @ (self._target - self._own) + self._world.columns.constants(missing)
        return self._freedoms.take(equations, values)

    def parallel(self) -> int:
        """Both z in one line, of either sense."""
        nominal = self._axis * np.sign(self._axis @ self.target_axis)
        across = perpendicular(self.target_axis)
        return self._take(turn_about(across), across @ np.cross(nominal, self.target_axis))

    def lying(self) -> int:
        """The one's z perpendicular to the other's."""
        hinge = np.cross(self._axis, self.target_axis)
        return self._take(turn_about(hinge[None]), np.array([-self._axis @ self.target_axis]))

    def position(self, directions: Array) -> int:
        """The moving origin where the target is, along directions (directions, 3)."""
        return self._take(directions @ shift_at(self._point), directions @ (self._from - self._point))

    def seated(self) -> int:
        """The moving cone in the target's, or about it: on its axis, at the height at which their surfaces meet."""
        features = self._world.assembly.features
        own, its = (features[name] for name in (self._relation.moving, self._relation.target))
        seat = cone_seat(own.shape, its.shape, float(np.sign(self._axis @ self.target_axis)))
        assert seat is not None, "refused before"
        directions = np.vstack([perpendicular(self.target_axis), self.target_axis])
        rows, columns = directions @ shift_at(self._point), self._world.columns
        missing = directions @ (self._from - self._point) + np.array([0.0, 0.0, seat.height])
        values = rows @ (self._target - self._own) + columns.constants(missing)
        values[2] += seat.by_moving * summed(own.moved_by, 5, columns)[4]
        values[2] += seat.by_target * summed(its.moved_by, 5, columns)[4]
        return self._freedoms.take(rows, values)

    def height(self, nominal: float, varying: Array | None = None) -> int:
        """The moving origin at a height over the target's plane, as it tilts."""
        row = height_at(self._point, self.target_axis)
        missing = nominal - float(self.target_axis @ (self._point - self._from))
        return self._take_height(row, missing, varying)

    def height_of_target(self, nominal: float, varying: Array | None = None) -> int:
        """The target's origin at a height over the moving plane, as it tilts."""
        row = height_at(self._from, self._axis)
        missing = float(self._axis @ (self._from - self._point)) - nominal
        return self._take_height(row, missing, None if varying is None else -varying)

    def _take_height(self, row: Array, missing: float, varying: Array | None) -> int:
        values = row @ (self._target - self._own) + self._world.columns.constants(np.array([missing]))
        return self._freedoms.take(row, values if varying is None else values + varying)

    def radius(self, name: str) -> tuple[float, Array]:
        """Radius of a cylinder, nominally [mm] and as it varies (columns,)."""
        shape = self._world.assembly.features[name].shape
        if shape.diameter is None:
            raise InputError(f"moves.{self._move.name}: {name} has no diameter; expected one, for it is tangent")
        return shape.diameter / 2.0, self._world.size(name) / 2.0


def located(move: Locate, world: World) -> World:
    """The world with a part on six locators: rows (n, p x n) of each contact, solved together.

    Raises:
        InputError: the contacts leave a freedom.
    """
    contacts = [contact(pair, move, world) for pair in move.pairs]
    rows, values = (np.concatenate(each) for each in zip(*contacts, strict=True))
    points = [world.origin(pair.moving) for pair in move.pairs]
    freedoms = Freedoms(world.assembly.part[move.part].pose[:3, 3], points, world.columns.count)
    if freedoms.take(rows, values) < 6:
        raise InputError(
            f"moves.{move.name}: its contacts leave {move.part} free: {freedom_in_words(freedoms.left)}; "
            "expected six that hold all six freedoms"
        )
    return world.with_part_at(move.part, freedoms.torsor)


def contact(pair: Pair, move: Locate | Rest, world: World) -> tuple[Array, Array]:
    """Row (1, 6) and values (1, columns) of the condition n . (moving - target) = locator, n turning with its part."""
    moving, target = world.origin(pair.moving), world.origin(pair.target)
    target_part = world.part_of(pair.target)
    normal = world.turned(pair.normal, target_part if move.points_on == "part" else move.part)
    at_moving, at_target = height_at(moving, normal), height_at(target, normal)
    row = at_moving if move.points_on == "part" else at_target
    # a feature's displacement on its part or body counts at its own origin, that of the normal's frame at the point
    own = at_moving @ world.on_body(pair.moving, move.part)
    other = row @ world.parts[target_part] + at_target @ world.on_part(pair.target)
    gap = world.columns.constants(normal @ (moving - target)[:, None])
    return row, other - own - gap + summed(pair.locator, 1, world.columns)
