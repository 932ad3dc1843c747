"""Nominal constraints of datums and moves, with the freedoms that each takes; for tables."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from tol3d.assembly.model import Assembly, Datum, DatumFrame, Feature
from tol3d.assembly.placing.actual_feature import nominally
from tol3d.assembly.placing.placer import Asked, Placer, frame_in_world, point_rows, rows_of
from tol3d.assembly.placing.seen_motions import sides_of
from tol3d.numerics.arrays import Array

HELD: Final = 1e-6
"""Part of a constraint that must act on the motions left, else earlier ones hold it: directions have some digits."""


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


def held_by_datums(assembly: Assembly, frame: DatumFrame) -> Freedoms:
    """Freedoms taken by each datum of a frame, along the axes of its part."""
    asked = [Asked(_datum_name(datum), _of_datum(assembly, datum, k)) for k, datum in enumerate(frame.datums)]
    origins = np.array([assembly.features[name].frame[:3, 3] for datum in frame.datums for name in datum.features])
    return taken(asked, np.zeros(3), _reach(origins))


def _datum_name(datum: Datum) -> str:
    return "-".join(name.partition(".")[2] for name in datum.features)


def _of_datum(assembly: Assembly, datum: Datum, place: int) -> Array:
    features = [assembly.features[name] for name in datum.features]
    frame = features[0].frame
    at, z = frame[:3, 3], frame[:3, 2]
    if datum.simulator == "pattern":
        return np.concatenate([of_place for feature in features for of_place in _of_places(feature)])
    if len(features) > 1:
        line = features[-1].frame[:3, 3] - at
        return rows_of(("across", "direction"), at, line / np.linalg.norm(line))
    if datum.simulator == "targets" and datum.targets is not None and place > 0:
        return np.concatenate([point_rows(at + frame[:3, :3] @ target, z[None]) for target in datum.targets])
    return rows_of(features[0].shape.asks, at, z)


def _of_places(feature: Feature) -> Iterator[Array]:
    """The rows of a feature of a pattern: of each of its places, along the directions in which that counts."""
    nominal = nominally(feature)
    return (point_rows(end[:, 0], np.array(sides)) for end in nominal.ends for sides in sides_of(nominal))


def held_by(assembly: Assembly, plan: Placer) -> Freedoms:
    """Freedoms taken by each step of a move of one body, along the axes of the world; none where it lists none."""
    part = assembly.part[plan.move.parts[0]]
    middle = part.pose[:3, 3]
    places = [frame_in_world(assembly, feature.name)[:3, 3] for feature in part.features]
    return taken(list(plan.asked(assembly, middle)), middle, _reach(np.array(places).reshape(-1, 3) - middle))


def _reach(places: Array) -> float:
    return max(1.0, float(np.linalg.norm(places.reshape(-1, 3), axis=1).max(initial=0.0)))
