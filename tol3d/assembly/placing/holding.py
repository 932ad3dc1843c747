"""Nominal constraints of datums and moves, with the freedoms that each takes; for tables."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.assembly.model import (
    Assembly,
    Axis,
    BestFit,
    Cone,
    Datum,
    DatumFrame,
    Engage,
    Feature,
    Locate,
    Mate,
    Move,
    Pair,
    Plane,
    Relation,
    Rest,
    RoundPlane,
    StatedMove,
    Touch,
)
from tol3d.assembly.placing import contact_equations
from tol3d.assembly.placing.actual_feature import nominally
from tol3d.assembly.placing.engaging import Engaging
from tol3d.assembly.placing.mating import asked_of
from tol3d.assembly.placing.plan import Placing
from tol3d.assembly.placing.resting import Resting
from tol3d.assembly.placing.seen_motions import sides_of
from tol3d.assembly.placing.touching import Touching
from tol3d.numerics.arrays import Array

HELD: Final = 1e-6
"""Part of a constraint that must act on the motions left, else earlier ones hold it: directions have some digits."""


@dataclass(frozen=True, eq=False)
class Asked:
    """Constraint by one feature, contact or relation, or by several at once.

    Args:
        words: its description.
        rows: its change per shift of the reference point of motions, and per turn (rows, 6) [mm].
        is_room: True if it takes no freedom but leaves a clearance.
    """

    words: str
    rows: Array
    is_room: bool = False


@dataclass(frozen=True, eq=False)
class HeldFreedoms:
    """Freedoms taken by a constraint.

    Args:
        words: the constraint.
        shifts: orthonormal directions (shifts, 3).
        turns: orthonormal directions of their axes (turns, 3).
        is_room: True if they are not taken, but limited by a clearance.
    """

    words: str
    shifts: Array
    turns: Array
    is_room: bool = False

    @property
    def count(self) -> int:
        """Number of freedoms."""
        return len(self.shifts) + len(self.turns)


@dataclass(frozen=True, eq=False)
class Freedoms:
    """Freedoms taken and left.

    Args:
        taken: in order.
        left: taken by none.
        where: place of the axis of a single remaining turn, such as "through (0, 40, 0)"; else "".
    """

    taken: tuple[HeldFreedoms, ...]
    left: HeldFreedoms
    where: str


def taken(asked: Sequence[Asked], middle: Array, reach: float) -> Freedoms:
    """Freedoms that each constraint takes of those left by earlier ones.

    Args:
        asked: constraints in order.
        middle: the point (3,) about which their rows are [mm].
        reach: largest distance from there [mm].
    """
    scale = np.array([1.0, 1.0, 1.0, 1 / reach, 1 / reach, 1 / reach])
    left, found = np.eye(6), []
    for own in asked:
        rows = own.rows * scale
        size = max(float(np.linalg.norm(rows, axis=1).max(initial=0.0)), 1e-300)
        _, sizes, right = np.linalg.svd(rows @ left)
        after = left @ right[int(np.sum(sizes > HELD * size)) :].T
        pairs = zip(_parts(left), _parts(after), strict=True)
        shifts, turns = (_without(before, rest) for before, rest in pairs)
        found.append(HeldFreedoms(own.words, shifts, turns, own.is_room))
        left = after
    return Freedoms(
        tuple(found), HeldFreedoms("", *_parts(left)), _place(left[:, 0] * scale, middle) if left.size == 6 else ""
    )


def _place(motion: Array, middle: Array) -> str:
    """The point nearest to the origin on the axis of a motion (6,), in words; "" for a shift."""
    shift, turn = np.split(motion, 2)
    size = float(turn @ turn)
    if size * max(1.0, float(middle @ middle)) < HELD**2:
        return ""
    place = np.cross(turn, shift - np.cross(turn, middle)) / size
    return "through (" + ", ".join(f"{value:.6g}" for value in place.round(6) + 0.0) + ")"


def _parts(motions: Array) -> tuple[Array, Array]:
    """Directions of the shifts alone and of the turns among motions (6, motions), shift and turn times reach."""
    turns, sizes, right = np.linalg.svd(motions[3:], full_matrices=True)
    rank = int(np.sum(sizes > HELD))
    shifts = np.linalg.svd(motions[:3] @ right[rank:].T)[0][:, : motions.shape[1] - rank]
    return shifts.T, turns[:, :rank].T


def _without(directions: Array, others: Array) -> Array:
    """Orthogonal complement (n - m, 3) of a subspace (m, 3) in a space of directions (n, 3)."""
    inside = directions - directions @ others.T @ others
    return np.linalg.svd(inside)[2][: len(directions) - len(others)]


def in_words(taken: HeldFreedoms) -> str:
    """Freedoms, such as "z, turns x, y": a shift along z, turns about x and y."""
    if taken.count == 6:
        return "all six"
    words = [_directions(taken.shifts)] if len(taken.shifts) else []
    words += [f"turns {_directions(taken.turns)}"] if len(taken.turns) else []
    return ", ".join(words) or "none"


def _directions(directions: Array) -> str:
    """The axes that orthonormal directions (n, 3) span: "x, y", "(0.6, 0.8, 0)", "all across (0.6, 0.8, 0)"."""
    span = directions.T @ directions
    axes = [k for k in range(3) if abs(span[k, k] - 1.0) < HELD]
    words = ["xyz"[k] for k in axes]
    others = np.linalg.svd(span - np.diag([float(k in axes) for k in range(3)]))[0][:, : len(directions) - len(axes)]
    if others.shape[1] == 1:
        words.append(_numbers(others[:, 0]))
    elif others.shape[1] == 2:
        words.append(f"all across {_numbers(np.cross(others[:, 0], others[:, 1]))}")
    return ", ".join(words)


def _numbers(vector: Array) -> str:
    vector = vector * np.sign(vector[int(np.argmax(np.abs(vector.round(6))))])
    return "(" + ", ".join(f"{value:.4g}" for value in vector.round(6) + 0.0) + ")"


ORDER: Final = ("primary", "secondary", "tertiary")

SAME: Final = 1e-6
"""Sine of the angle between directions that are the same."""


def held_by_datums(assembly: Assembly, frame: DatumFrame) -> Freedoms:
    """Freedoms taken by each datum of a frame, along the axes of its part."""
    asked = [Asked(_datum_name(datum), _of_datum(assembly, datum, k)) for k, datum in enumerate(frame.datums)]
    origins = np.array([assembly.features[name].frame[:3, 3] for own in frame.datums for name in own.features])
    return taken(asked, np.zeros(3), _reach(origins))


def _datum_name(datum: Datum) -> str:
    return "-".join(name.partition(".")[2] for name in datum.features)


def _of_datum(assembly: Assembly, datum: Datum, place: int) -> Array:
    features = [assembly.features[name] for name in datum.features]
    frame = features[0].frame
    at, z = frame[:3, 3], frame[:3, 2]
    if datum.simulator == "pattern":
        return np.concatenate([own for each in features for own in _of_places(each)])
    if len(features) > 1:
        line = features[-1].frame[:3, 3] - at
        return _line(at, line / np.linalg.norm(line))
    if isinstance(features[0].shape, Cone):
        return np.concatenate([_line(at, z), _point(at, z[None])])
    if isinstance(features[0].shape, Axis):
        return _line(at, z)
    if not isinstance(features[0].shape, Plane | RoundPlane):
        return _point(at, np.eye(3))
    if datum.simulator == "targets" and datum.targets is not None and place > 0:
        return np.concatenate([_point(at + frame[:3, :3] @ target, z[None]) for target in datum.targets])
    return np.concatenate([_point(at, z[None]), _direction(z)])


def _of_places(feature: Feature) -> Iterator[Array]:
    """The rows of a feature of a pattern: of each of its places, along the directions in which that counts."""
    nominal = nominally(feature)
    return (_point(end[:, 0], np.array(sides)) for end in nominal.ends for sides in sides_of(nominal))


def held_by(assembly: Assembly, plan: Placing) -> Freedoms:
    """Freedoms taken by each step of a move, along the axes of the world; none if the part lies against nothing."""
    move: Move = getattr(plan, "move", None) or plan  # type: ignore[assignment]  # a move that is its own plan
    if isinstance(move, StatedMove):
        raise TypeError(f"{move.name}: expected a move of one body")
    part = move.part
    middle = assembly.part[part].pose[:3, 3]
    asked = list(_asked(assembly, plan, middle))
    places = [_pose(assembly, own.name)[:3, 3] for own in assembly.part[part].features]
    return taken(asked, middle, _reach(np.array(places) - middle))


def _asked(assembly: Assembly, plan: Placing, middle: Array) -> Iterator[Asked]:
    """Rows about a middle (3,) in the world."""
    match getattr(plan, "move", plan):
        case Locate() as move:
            yield from _located(assembly, move, middle)
        case BestFit() as move:
            directions = []
            for fit in move.fits:
                turn = assembly.part[assembly.features[fit.target].part].pose[:3, :3]
                directions.append(_point(_pose(assembly, fit.moving)[:3, 3] - middle, fit.directions @ turn.T))
            yield Asked(f"fit of {_listed([own.moving for own in move.fits])}", np.concatenate(directions))
        case Mate() as move:
            yield from _related(assembly, move.relations, middle)
        case Engage() as move:
            assert isinstance(plan, Engaging)
            yield from _related(assembly, move.relations, middle)
            count = plan.freedoms.shape[1]  # beside them, those of bolts
            rows = plan.rows[..., :count].reshape(2 * len(plan.rows), count) @ plan.freedoms.T
            rows = np.hstack([rows[:, :3], plan.reach * rows[:, 3:]])
            words = ", ".join(own.name for own in move.engagements)
            yield Asked(words, _about(rows, plan.middle - middle), is_room=True)
        case Rest() as move:
            assert isinstance(plan, Resting)
            yield from _related(assembly, move.relations, middle)
            rows = np.hstack([plan.all_rows[:, 3:], plan.reach * plan.all_rows[:, :3]])
            targets = dict.fromkeys(_touched(assembly, own.target) for own in move.pairs)
            words = f"contacts with {_listed(list(targets))}, pressed on"
            yield Asked(words, _about(rows, plan.origin[:, 0] - middle))
        case Touch() as move:
            assert isinstance(plan, Touching)
            start = 0
            for contact, kind in zip(move.contacts, plan.kinds, strict=True):
                end = start + (2 if kind in contact_equations.TWO else 1)
                words = f"{contact.moving} on {contact.target}"
                yield Asked(words, _about(plan.rows[start:end], plan.origin[:, 0] - middle))
                start = end


def _located(assembly: Assembly, move: Locate, middle: Array) -> Iterator[Asked]:
    """Contacts with one normal together."""
    groups: list[list[tuple[Pair, Array]]] = []
    for pair in move.pairs:
        stays = pair.target if move.points_on == "part" else pair.moving
        normal = assembly.part[assembly.features[stays].part].pose[:3, :3] @ pair.normal
        if groups and np.linalg.norm(groups[-1][-1][1] - normal) < SAME:
            groups[-1].append((pair, normal))
        else:
            groups.append([(pair, normal)])
    in_order = [len(group) for group in groups] == [3, 2, 1]
    first = 1
    for k, group in enumerate(groups):
        last = first + len(group) - 1
        name = ORDER[k] if in_order else f"contact {first}" if first == last else f"contacts {first} to {last}"
        points = [own.moving if move.points_on == "part" else own.target for own, _ in group]
        rows = [
            _point(_pose(assembly, at)[:3, 3] - middle, own[1][None]) for at, own in zip(points, group, strict=True)
        ]
        targets = dict.fromkeys(_touched(assembly, own.target) for own, _ in group)
        moving = dict.fromkeys(_touched(assembly, own.moving) for own, _ in group)
        yield Asked(f"{name}: {_listed(list(moving))} on {_listed(list(targets))}", np.concatenate(rows))
        first = last + 1


def _related(assembly: Assembly, relations: Sequence[Relation], middle: Array) -> Iterator[Asked]:
    for own in relations:
        asked = asked_of(own, assembly.features)
        assert asked is not None  # others were refused before
        held, turning = asked
        moving, target = _pose(assembly, own.moving), _pose(assembly, own.target)
        at, z = moving[:3, 3] - middle, target[:3, 2]
        across = np.eye(3) if held == "all" else z[None] if held == "along" else _across(z)
        rows = [_point(at, across)]
        if turning == "direction":
            rows.append(_direction(z))
        elif turning == "level":
            rows.append(np.hstack([np.zeros(3), np.cross(moving[:3, 2], z)])[None])
        yield Asked(f"{own.kind}: {own.moving} on {own.target}", np.concatenate(rows))


def _pose(assembly: Assembly, feature: str) -> Array:
    """A feature's frame in the world (4, 4)."""
    own = assembly.features[feature]
    return np.asarray(assembly.part[own.part].pose @ own.frame)


def _touched(assembly: Assembly, name: str) -> str:
    """A feature, or the plane of which it is a point that another feature touches."""
    return name if assembly.features[name].is_named else name.rpartition(" at ")[0] or name


def _listed(names: Sequence[str]) -> str:
    """Names of features; a common part is named once: "cover.A1, A2"."""
    part = names[0].partition(".")[0]
    if any(name.partition(".")[0] != part for name in names):
        return ", ".join(names)
    return ", ".join([names[0], *(name.partition(".")[2] for name in names[1:])])


def _point(at: Array, directions: Array) -> Array:
    """Rows of a point (3,) along directions (n, 3)."""
    return np.hstack([directions, np.cross(at, directions)])


def _direction(toward: Array) -> Array:
    """Rows of a direction that stays."""
    return np.hstack([np.zeros((2, 3)), _across(toward)])


def _line(at: Array, direction: Array) -> Array:
    """Rows of a line that stays."""
    return np.concatenate([_point(at, _across(direction)), _direction(direction)])


def _across(direction: Array) -> Array:
    """Two directions square to one (2, 3)."""
    return np.asarray(np.linalg.svd(direction[None])[2][1:])


def _about(rows: Array, off: Array) -> Array:
    """Rows (n, 6) about another point, from which that of the given rows is offset by (3,)."""
    return np.hstack([rows[:, :3], rows[:, 3:] + np.cross(off, rows[:, :3])])


def _reach(places: Array) -> float:
    return max(1.0, float(np.linalg.norm(places.reshape(-1, 3), axis=1).max(initial=0.0)))
