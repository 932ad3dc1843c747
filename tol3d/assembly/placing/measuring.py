"""Measures of features as they lie in their trials."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.model import Assembly, Measured
from tol3d.assembly.model.statuses import OK
from tol3d.assembly.placing.actual_feature import ActualFeature, actual_size, total
from tol3d.assembly.placing.gauged_positions import GaugedPattern, on_gauges, position_in_room
from tol3d.assembly.placing.poses import (
    Codes,
    column,
    cross,
    dot,
    length,
    product,
    rotated,
    rotation_vector,
    square_to,
    unit,
)
from tol3d.assembly.placing.surfaces import PARALLEL, common_normal, gap_of
from tol3d.assembly.placing.world import World
from tol3d.contact.openings import opening
from tol3d.import_path import named
from tol3d.numerics.arrays import Array


def widths(points: Sequence[Array]) -> Array:
    """Widths of points, each (3, n) or (3, 1), in their trials (n,) [mm].

    At the least width one plane touches three points, or each plane two: all such directions are tried.
    """
    least = np.full(1, np.inf)
    for normal in _normals(points):
        square = dot(normal, normal)
        some = square > 0
        heights = [dot(normal, point - points[0]) for point in points]
        spread = np.maximum.reduce(np.broadcast_arrays(*heights)) - np.minimum.reduce(np.broadcast_arrays(*heights))
        least = np.minimum(least, np.where(some, spread / np.sqrt(np.where(some, square, 1.0)), np.inf))
    return np.where(least == np.inf, 0.0, least)


def _normals(points: Sequence[Array]) -> list[Array]:
    faces = [cross(b - a, c - a) for a, b, c in combinations(points, 3)]
    for a, b, c, d in combinations(points, 4):
        faces += [cross(b - a, d - c), cross(c - a, d - b), cross(d - a, c - b)]
    return faces


def bonuses(measured: Measured, world: World) -> list[Array]:
    """Bonus of each measured feature by its size, each (n,) or (1,) [mm]."""
    found = []
    for name, own in zip(measured.features, measured.bonuses, strict=True):
        size = total(world.assembly.features[name].size_by, 1, world.columns)[0]
        found.append(np.clip(size - own.low if own.grows else own.high - size, 0.0, own.high - own.low))
    return found


def pattern(measured: Measured, world: World) -> Array:
    """The largest of 2 distance - bonus at the best pose of the nominal places (n,) or (1,) [mm].

    Each feature counts at both its ends; the places turn about their middle.
    """
    part = world.part_of(measured.features[0])
    into = world.own[part].displacement(measured.frame).inverse
    frames = [world.assembly.features[name].frame for name in measured.features]
    across = frames[0][:3, :2]
    middle = np.mean([frame[:3, 3] for frame in frames], axis=0)
    ends = [[end - column(middle) for end in world.on_part(name).moved(into).ends] for name in measured.features]
    x, y = ([dot(column(own), end) for each in ends for end in each] for own in across.T)
    own_bonuses = bonuses(measured, world) if measured.bonuses else [np.zeros(1)] * len(ends)
    radii = [0.5 * own for own, each in zip(own_bonuses, ends, strict=True) for _ in each]
    nominal = np.array(
        [(frame[:3, 3] - middle) @ across for frame, each in zip(frames, ends, strict=True) for _ in each]
    )
    x_rows, y_rows, radius_rows = np.split(np.stack(np.broadcast_arrays(*x, *y, *radii)), 3)
    if measured.gauge == "shift":
        return 2.0 * opening(x_rows - nominal[:, :1], y_rows - nominal[:, 1:], radius_rows).outside
    return 2.0 * GaugedPattern(x_rows, y_rows, radius_rows, nominal).least()


TURN: Final = 2 * math.pi
LEANS: Final = 1e-6
"""Sine of an axis' nominal tilt; a smaller tilt has no azimuth."""
FLAT: Final = 1e-12
"""Sine of an angle that is nominally 0 or half a turn: half a turn is pi, not -pi."""


def reading(measured: Measured, worlds: Sequence[World]) -> Array:
    """Values of a measure (n,) or (1,) [mm or rad].

    Args:
        measured: the measure.
        worlds: before the first move, and after each.
    """
    world = worlds[-1] if measured.after < 0 else worlds[measured.after + 1]
    values: Array = named(measured.reads.placing)(measured, world)
    return values if measured.minus is None else values - reading(measured.minus, worlds)


def may_lack(measured: Measured, codes: Mapping[int, Codes]) -> NDArray[np.bool_]:
    """Trials in which a measure may have no value although nothing before it fails (n,) or (1,).

    Such as if datums do not fit their gauges, or for the slack of a move that finds no pose.

    Args:
        measured: the measure.
        codes: status codes of moves, by index.
    """
    lacks = np.array([measured.room is not None or measured.over_gauges])
    if measured.of_move >= 0:
        lacks = lacks | (codes[measured.of_move] != OK)
    return lacks if measured.minus is None else lacks | may_lack(measured.minus, codes)


def _direction(measured: Measured, world: World) -> Array:
    """The measure's direction in the world (3, n), carried by its part or datum frame."""
    part = world.part_of(measured.features[0])
    return rotated(world.poses[part].turn, _on_part(measured, world))


def _on_part(measured: Measured, world: World) -> Array:
    assert measured.direction is not None
    part = world.part_of(measured.features[0])
    return rotated(world.own[part].displacement(measured.frame).turn, column(measured.direction))


def _apart(measured: Measured, world: World) -> Array:
    start, end = (world.placed(name) for name in measured.features)
    return end.origin - start.origin


def distance(measured: Measured, world: World) -> Array:
    """|p_to - p_from| of the features' origins p in the world; with a direction along it only, see `gap`."""
    return length(_apart(measured, world)) if measured.direction is None else gap(measured, world)


def gap(measured: Measured, world: World) -> Array:
    """(p_to - p_from) . n, n the direction as it is fixed in the part of `from`, or in a datum frame of it."""
    return dot(_apart(measured, world), _direction(measured, world))


def point_plane(measured: Measured, world: World) -> Array:
    """(p_point - p_plane) . z_plane; features: the point, the plane."""
    point, plane = (world.placed(name) for name in measured.features)
    return dot(point.origin - plane.origin, plane.direction)


def angle(measured: Measured, world: World) -> Array:
    """From z_from to z_to [rad], 0 to pi; with a direction n, fixed as for `gap`, signed about it.

    That is atan2(n . (z_from x z_to), z_from . z_to).
    """
    start, end = (world.placed(name).direction for name in measured.features)
    across, along = cross(start, end), dot(start, end)
    if measured.direction is None:
        return np.asarray(np.arctan2(length(across), along))
    found = np.arctan2(dot(_direction(measured, world), across), along)
    return np.asarray(found + TURN * np.round((_nominal_angle(measured, world.assembly) - found) / TURN))


def _nominal_angle(measured: Measured, assembly: Assembly) -> float:
    """About a direction, above -pi to pi: angles of trials are those within half a turn of it [rad]."""
    assert measured.direction is not None
    start, end = _nominal_directions(measured, assembly)
    owner = assembly.part[assembly.features[measured.features[0]].part]
    sine = float(owner.pose[:3, :3] @ measured.direction @ np.cross(start, end))
    return math.atan2(0.0 if abs(sine) < FLAT else sine, float(start @ end))


def _nominal_directions(measured: Measured, assembly: Assembly) -> tuple[Array, Array]:
    """z of the first two features in the world (3,)."""
    start, end, *_ = (
        assembly.part[assembly.features[name].part].pose[:3, :3] @ assembly.features[name].frame[:3, 2]
        for name in measured.features
    )
    return start, end


def size(measured: Measured, world: World) -> Array:
    """Nominal size and its deviation."""
    return actual_size(world.assembly.features[measured.features[0]], world.columns)


def _inspected(measured: Measured, world: World) -> tuple[ActualFeature, Array]:
    """A feature in its datum frame, and its nominal frame (4, 4)."""
    (name,) = measured.features
    displacement = world.own[world.part_of(name)].displacement(measured.frame)
    return world.on_part(name).moved(displacement.inverse), world.assembly.features[name].frame


def position(measured: Measured, world: World) -> Array:
    """Twice the largest distance of the feature's ends from their nominal places in `frame`.

    Of an axis across the nominal axis, of a plane along the nominal normal, of a point in space; across the direction
    if there is one, which is fixed in that frame. With a modifier it is reduced by the bonus of the feature's size, for
    comparison with the zone at its material condition: 2 distance <= t0 + bonus.
    """
    actual, frame = _inspected(measured, world)
    if measured.room is not None:
        into = world.own[world.part_of(measured.features[0])].displacement(measured.frame).inverse
        return position_in_room(measured, world, actual, into, _bonus(measured, world))
    if measured.over_gauges:
        return on_gauges(measured, world, [_bonus(measured, world)])
    if measured.direction is None:
        return 2.0 * actual.farthest(frame) - _bonus(measured, world)
    largest = np.zeros(1)
    for end, nominal in zip(actual.ends, actual.feature.shape.ends, strict=True):
        aside = end - column(frame[:3, :3] @ nominal + frame[:3, 3])
        largest = np.maximum(largest, length(square_to(aside, column(measured.direction))))
    return 2.0 * largest - _bonus(measured, world)


def together(measured: Measured, world: World) -> Array:
    """The largest of several positions, each less its zone and its bonus (n,) or (1,) [mm].

    Gauges of the frame take one place for all of them.
    """
    has = [np.full(1, zone) for zone in measured.zones]
    if measured.bonuses:
        has = [zone + own for zone, own in zip(has, bonuses(measured, world), strict=True)]
    if measured.over_gauges:
        return on_gauges(measured, world, has)
    each = (replace(measured, features=(name,), bonuses=()) for name in measured.features)
    largest = np.full(1, -np.inf)
    for one, own in zip(each, has, strict=True):
        largest = np.maximum(largest, position(one, world) - own)
    return largest


def _bonus(measured: Measured, world: World) -> Array:
    """Bonus of the measured feature by its size (n,) or (1,) [mm]."""
    return bonuses(measured, world)[0] if measured.bonuses else np.zeros(1)


def orientation(measured: Measured, world: World) -> Array:
    """Width of the zone that holds the feature and is oriented nominally in `frame`.

    Of a plane the range of its ends' heights along the nominal normal, of an axis how far its ends lie apart across the
    nominal axis; in the `direction` alone if there is one.
    """
    actual, frame = _inspected(measured, world)
    z = column(frame[:3, 2])
    if measured.direction is not None and actual.spans:
        return 2.0 * np.abs(dot(column(measured.direction), actual.spans[0]))
    return actual.lean(z)


def flatness(measured: Measured, world: World) -> Array:
    """Smallest distance of two parallel planes with all the points between them.

    The points are of one part and lie nominally on a plane with normal `direction`, in the part's frame.
    """
    return widths([world.on_part(name).origin for name in measured.features])


def surface_gap(measured: Measured, world: World) -> Array:
    """Gap between the surfaces of two features, at least one of them round: 0 at contact.

    The same as for contacts of a touch; negative if they overlap.
    """
    start, end = (world.placed(name) for name in measured.features)
    return gap_of(start, end, world.columns, parallel=_parallel(measured, world.assembly))


def contact_angle(measured: Measured, world: World) -> Array:
    """Angle of the normal of such a contact to the z of a third feature or to a direction [rad], 0 to pi.

    The normal points from the first feature's axis, centre or plane towards the second's; a direction is fixed as for
    `gap`.
    """
    start, end, *against = (world.placed(name) for name in measured.features)
    normal, _ = common_normal(start, end, parallel=_parallel(measured, world.assembly))
    direction = against[0].direction if against else _direction(measured, world)
    return np.asarray(np.arctan2(length(cross(normal, direction)), dot(normal, direction)))


def _parallel(measured: Measured, assembly: Assembly) -> bool:
    """True if both features are nominally parallel."""
    start, end = _nominal_directions(measured, assembly)
    return bool(np.linalg.norm(np.cross(start, end)) < PARALLEL)


def turn(measured: Measured, world: World) -> Array:
    """Component along a direction of the rotation vector from the first feature's frame to the second's.

    The direction is fixed in the part of the first; without one it is the vector's length [rad].
    """
    start, end = (world.placed(name).pose.turn for name in measured.features)
    vector = rotation_vector(product(end, np.swapaxes(start, 0, 1)))
    return length(vector) if measured.direction is None else dot(vector, _direction(measured, world))


def lean(measured: Measured, world: World) -> Array:
    """Angle of the second feature's z to the first's [rad]; with a third feature, tilt along or across that.

    `direction` (2,) then selects: along and across.
    """
    start, end = (world.placed(name).pose.turn[:, 2] for name in measured.features[:2])
    sideways = end - dot(end, start) * start
    size = length(sideways)
    angle = np.arctan2(size, dot(start, end))
    if measured.direction is None:
        return np.asarray(angle)
    rest, about = world.placed(measured.features[2]).pose.turn, None
    if tilts(world.assembly, measured.features):
        about = unit(cross(rest[:, 2], start))
    ahead = rest[:, 0] if about is None else cross(about, start)
    beside = rest[:, 1] if about is None else about
    share = angle / np.where(size > 0.0, size, 1.0)
    chosen, other = measured.direction
    return np.asarray(share * (chosen * dot(sideways, ahead) + other * dot(sideways, beside)))


def tilts(assembly: Assembly, features: Sequence[str]) -> bool:
    """True if the first of three features is nominally tilted to the third."""
    start, rest = (_nominal_axis(assembly, features[k]) for k in (0, 2))
    return bool(np.linalg.norm(np.cross(rest, start)) > LEANS)


def _nominal_axis(assembly: Assembly, name: str) -> Array:
    own = assembly.features[name]
    return np.asarray((assembly.part[own.part].pose @ own.frame)[:3, 2])


def slack(measured: Measured, world: World) -> Array:
    """The slack of the move `of_move`, an Engage; no features."""
    return np.asarray(world.slacks[world.assembly.moves[measured.of_move].name])


def virtual_clearance(measured: Measured, world: World) -> Array:
    """Diameters (n,) [mm]; below 0 where the holes have no line in common.

    The bolt stands along the nominal axis of the first hole, as its part or a datum frame carries it. Each hole leaves
    the circles of its diameter about both its ends; their ellipticity by a tilt is of second order.
    """
    first = measured.features[0]
    part = world.part_of(first)
    turn = world.poses[part].turn
    carried = world.own[part].displacement(measured.frame).turn
    across = [rotated(turn, rotated(carried, column(own))) for own in world.assembly.features[first].frame[:3, :2].T]
    ends = [end for name in measured.features for end in world.placed(name).ends]
    sizes = [actual_size(world.assembly.features[name], world.columns) for name in measured.features]
    middle = ends[0]  # about it, numbers are small
    x, y = ([dot(own, end - middle) for end in ends] for own in across)
    radii = [0.5 * size for size in sizes for _ in range(2)]
    return -2.0 * opening(*np.split(np.stack(np.broadcast_arrays(*x, *y, *radii)), 3)).outside
