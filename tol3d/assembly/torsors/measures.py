"""Measures to first order: one row each over the columns; a clipped amount is a term of its own."""

import math
from dataclasses import replace
from itertools import combinations

import numpy as np

from tol3d.assembly.model import Measured
from tol3d.assembly.model.datum_frame import GaugeRoom, MaterialBonus
from tol3d.assembly.torsors.columns import without_rounding
from tol3d.assembly.torsors.gauged_positions import CommonOpening, LeastInRoom, TurnedOpening, on_gauges
from tol3d.assembly.torsors.surfaces import Surfaces
from tol3d.assembly.torsors.terms import Clipped, Ends, Width, balances
from tol3d.assembly.torsors.torsor import cross_matrix, height_at, perpendicular, shift_at
from tol3d.assembly.torsors.world import World
from tol3d.import_path import named
from tol3d.numerics.arrays import Array

NEAR = 1.0
"""Points nominally nearer than this [mm]: their distance is the length of its first-order vector, else linear."""
LEANS = 1e-6
"""Sine of an axis' nominal tilt; a smaller tilt has no azimuth."""
FLAT = 1e-12
"""Sine of an angle about a direction that is 0 or half a turn: half a turn is pi, not -pi."""
SLANT = 1e-3
"""Directions whose sine is nominally less are in line: their angle is the length of its first-order vector."""


def reading(measured: Measured, worlds: list[World]) -> Array:
    """A measure as a row over the columns (columns,) [mm or rad].

    Args:
        measured: the measure.
        worlds: before the first move, and as each leaves it.
    """
    world = worlds[-1] if measured.after < 0 else worlds[measured.after + 1]
    row: Array = named(measured.reads.torsors)(measured, world)
    return row if measured.minus is None else row - reading(measured.minus, worlds)


def _constant(world: World, value: float) -> Array:
    row = np.zeros(world.columns.count)
    row[world.columns.constant] = value
    return row


def _apart(measured: Measured, world: World) -> tuple[Array, Array]:
    """From the first feature's origin to the second's: nominally (3,), and how it varies (3, columns) [mm]."""
    start, end = measured.features
    from_point, to_point = world.origin(start), world.origin(end)
    varying = shift_at(to_point) @ world.placed(end) - shift_at(from_point) @ world.placed(start)
    return to_point - from_point, varying


def _fixed_in(measured: Measured, world: World) -> tuple[Array, Array]:
    """A measure's direction in the world: nominally (3,), and how it varies (3, columns)."""
    part = world.part_of(measured.features[0])
    if measured.direction is None:
        raise ValueError(f"{measured.kind} of {', '.join(measured.features)} has no direction")
    nominal = world.turned(measured.direction, part)
    return nominal, _turned(nominal, world.parts[part] + world.frame_on_part(measured.frame, part))


def _turned(direction: Array, torsor: Array) -> Array:
    """Change of a direction that turns with a torsor (3, columns)."""
    return np.asarray(-cross_matrix(direction) @ torsor[3:])


def _length(nominal: Array, varying: Array, world: World) -> Array:
    """The length of a short vector (columns,), from its parts (parts, columns)."""
    return world.columns.largest((varying + world.columns.constants(nominal))[None])


def distance(measured: Measured, world: World) -> Array:
    """Linear; for nominally coincident points the length of a short vector."""
    nominal, varying = _apart(measured, world)
    if measured.direction is not None:
        return gap(measured, world)
    length = float(np.linalg.norm(nominal))
    if length < NEAR:
        return _length(nominal, varying, world)
    return _constant(world, length) + nominal / length @ varying


def gap(measured: Measured, world: World) -> Array:
    """As the direction turns with its part or datum frame."""
    apart, varying = _apart(measured, world)
    normal, turning = _fixed_in(measured, world)
    return _constant(world, float(normal @ apart)) + normal @ varying + apart @ turning


def point_plane(measured: Measured, world: World) -> Array:
    """As the plane tilts."""
    point, plane = measured.features
    at, normal = world.origin(point), world.axis(plane)
    height = height_at(at, normal) @ (world.placed(point) - world.placed(plane))
    row: Array = _constant(world, float(normal @ (at - world.origin(plane)))) + height[0]
    return row


def angle(measured: Measured, world: World) -> Array:
    """Linear; for nominally parallel directions the length of a short vector."""
    axes = [world.axis(name) for name in measured.features]
    turning = [_turned(axis, world.placed(name)) for axis, name in zip(axes, measured.features, strict=True)]
    (start, end), (start_varies, end_varies) = axes, turning
    across, along = np.cross(start, end), float(start @ end)
    across_varies = cross_matrix(start) @ end_varies - cross_matrix(end) @ start_varies
    if measured.direction is not None:
        normal, normal_varies = _fixed_in(measured, world)
        sine = float(normal @ across)
        sine_varies = normal @ across_varies + across @ normal_varies
        along_varies = start @ end_varies + end @ start_varies
        row = (along * sine_varies - sine * along_varies) / (sine**2 + along**2)
        return _constant(world, math.atan2(0.0 if abs(sine) < FLAT else sine, along)) + row
    sine = float(np.linalg.norm(across))
    if sine >= SLANT:
        return (
            _constant(world, math.atan2(sine, along))
            + across / sine @ (world.placed(measured.features[1]) - world.placed(measured.features[0]))[3:]
        )
    sides = perpendicular(start)
    length = _length(sides @ across, sides @ across_varies, world)
    return length if along > 0.0 else _constant(world, math.pi) - length


def size(measured: Measured, world: World) -> Array:
    """Linear."""
    (name,) = measured.features
    return _constant(world, world.assembly.features[name].shape.nominal_size or 0.0) + world.size(name)


def _from_frame(measured: Measured, world: World) -> Array:
    """The torsor (6, columns) of a feature relative to the datum frame, in the part's frame."""
    (name,) = measured.features
    own = world.own[world.part_of(name)]
    return own.feature(name) - own.datum_frame(measured.frame)


def _at_ends(measured: Measured, world: World, directions: Array) -> Array:
    """Displacements of a feature's ends in its datum frame along directions: (ends, directions, columns) [mm]."""
    (name,) = measured.features
    feature = world.assembly.features[name]
    torsor = _from_frame(measured, world)
    ends = feature.shape.ends @ feature.frame[:3, :3].T + feature.frame[:3, 3]
    return np.array([directions @ shift_at(end) @ torsor for end in ends])


def _disc(measured: Measured, world: World, radius: float) -> tuple[Array, Array]:
    """Height of a round face's middle in its datum frame (columns,), and largest rise of its rim over it [mm]."""
    (name,) = measured.features
    frame = world.assembly.features[name].frame
    torsor = _from_frame(measured, world)
    middle = height_at(frame[:3, 3], frame[:3, 2]) @ torsor
    rim = world.columns.largest(radius * (frame[:3, :2].T @ torsor[3:])[None])
    return world.columns.largest(middle[None]), rim


def _in_room(measured: Measured, room: GaugeRoom, world: World) -> Array:
    """Twice the least distance of the worse end, less the bonus, over the shifts of the gauge in its datum feature."""
    (name,) = measured.features
    shape = world.assembly.features[room.feature].shape
    sides = world.assembly.features[room.feature].frame[:3, :2].T
    still = _constant(world, 0.0)
    bonus = clipped(measured.bonuses[0], name, world) if measured.bonuses else still
    size = world.size(room.feature) + _constant(world, (shape.nominal_size or 0.0) - room.virtual)
    forms: list[Array] = []
    counts: list[int] = []
    for own, radius in ((name, 0.5 * bonus), (room.feature, 0.5 * size if room.grows else -0.5 * size)):
        ends = without_rounding(_at_ends(replace(measured, features=(own,)), world, sides))
        for end in ends[: 1 if np.array_equal(ends[0], ends[-1]) else None]:
            forms += [*end, radius]
        counts.append(len(forms) // 3)
    row: Array = world.columns.made_by(LeastInRoom(np.array(forms), counts[0]))[0]
    return row


def position(measured: Measured, world: World) -> Array:
    """The largest over ends, less the bonus; the least over the play of gauges if datums leave some."""
    if measured.room is not None:
        return _in_room(measured, measured.room, world)
    if measured.over_gauges:
        (name,) = measured.features
        own = clipped(measured.bonuses[0], name, world) if measured.bonuses else _constant(world, 0.0)
        return on_gauges(measured, world, [own])
    feature = world.assembly.features[measured.features[0]]
    if measured.direction is not None:
        directions = perpendicular(measured.direction)
    elif radius := feature.shape.rim_radius:
        middle, rim = _disc(measured, world, radius)
        return 2.0 * (middle + rim)
    else:
        directions = feature.frame[:3, feature.shape.located].T
    row: Array = 2.0 * world.columns.largest(_at_ends(measured, world, directions))
    return row - clipped(measured.bonuses[0], measured.features[0], world) if measured.bonuses else row


def together(measured: Measured, world: World) -> Array:
    """The largest of several, each less its zone; the least over the play of gauges if datums leave some."""
    bonuses = [clipped(own, name, world) for own, name in zip(measured.bonuses, measured.features, strict=False)]
    has = [_constant(world, zone) for zone in measured.zones]
    has = [zone + own for zone, own in zip(has, bonuses, strict=True)] if bonuses else has
    if measured.over_gauges:
        return on_gauges(measured, world, has)
    each = (replace(measured, features=(name,), bonuses=()) for name in measured.features)
    rows = np.array([position(one, world) - own for one, own in zip(each, has, strict=True)])
    row: Array = world.columns.made_by(Ends(rows, is_largest=True))[0]
    return row


def clipped(bonus: MaterialBonus, feature: str, world: World) -> Array:
    """Bonus by a feature's size (columns,) [mm]."""
    sign, origin = (1.0, bonus.low) if bonus.grows else (-1.0, bonus.high)
    departure = sign * (world.size(feature) - _constant(world, origin))
    row: Array = world.columns.made_by(Clipped(departure[None], bonus.high - bonus.low))[0]
    return row


def orientation(measured: Measured, world: World) -> Array:
    """The largest over pairs of ends, or over the rim of a round face."""
    feature = world.assembly.features[measured.features[0]]
    if radius := feature.shape.rim_radius:
        return 2.0 * _disc(measured, world, radius)[1]
    directions = feature.frame[:3, feature.shape.located].T if measured.direction is None else measured.direction[None]
    ends = _at_ends(measured, world, directions)
    return world.columns.largest(np.array([one - other for one, other in combinations(ends, 2)]))


def flatness(measured: Measured, world: World) -> Array:
    """The width over all balances of the points."""
    assert measured.direction is not None
    own = world.own[world.part_of(measured.features[0])]
    points = np.array([world.assembly.features[name].frame[:3, 3] for name in measured.features])
    heights = np.concatenate(
        [
            height_at(point, measured.direction) @ own.feature(name)
            for point, name in zip(points, measured.features, strict=True)
        ]
    )
    heights += world.columns.constants((points - points[0]) @ measured.direction)
    heights = without_rounding(heights)
    weights = balances(points @ perpendicular(measured.direction).T)
    row: Array = world.columns.made_by(Width(heights, weights))[0]
    return row


def virtual_clearance(measured: Measured, world: World) -> Array:
    """The bolt's direction turns with the first hole's part or with its datum frame."""
    first = measured.features[0]
    part = world.part_of(first)
    sides = world.frame(first)[:3, :2].T
    carrier = world.parts[part] + world.frame_on_part(measured.frame, part)
    turning = [_turned(side, carrier) for side in sides]
    start = world.origin(first)
    start_varies = shift_at(start) @ world.placed(first)
    forms = []
    for name in measured.features:
        frame, torsor = world.frame(name), world.placed(name)
        shape = world.assembly.features[name].shape
        radius = 0.5 * size(replace(measured, features=(name,)), world)
        for end in shape.ends @ frame[:3, :3].T + frame[:3, 3]:
            apart, varying = end - start, shift_at(end) @ torsor - start_varies
            aside = [side @ varying + apart @ turn for side, turn in zip(sides, turning, strict=True)]
            forms += [*(aside + world.columns.constants(sides @ apart)), radius]
    row: Array = world.columns.made_by(CommonOpening(without_rounding(np.array(forms))))[0]
    return row


def surface_gap(measured: Measured, world: World) -> Array:
    """Along the nominal common normal."""
    start, end = measured.features
    return Surfaces(world, start, end).gap()


def contact_angle(measured: Measured, world: World) -> Array:
    """As the normal and what it is held against turn."""
    start, end, *against = measured.features
    normal, normal_varies = Surfaces(world, start, end).turning_normal()
    if against:
        direction = world.axis(against[0])
        varies = _turned(direction, world.placed(against[0]))
    else:
        direction, varies = _fixed_in(measured, world)
    across, along = np.cross(normal, direction), float(normal @ direction)
    across_varies = cross_matrix(normal) @ varies - cross_matrix(direction) @ normal_varies
    sine = float(np.linalg.norm(across))
    if sine >= SLANT:
        return _constant(world, math.atan2(sine, along)) - (normal @ varies + direction @ normal_varies) / sine
    sides = perpendicular(normal)
    length = _length(sides @ across, sides @ across_varies, world)
    return length if along > 0.0 else _constant(world, math.pi) - length


def pattern(measured: Measured, world: World) -> Array:
    """Nominal places turn about their middle. Ends that deviate alike are one place."""
    features = [world.assembly.features[name] for name in measured.features]
    sides = features[0].frame[:3, :2].T
    places = np.array([sides @ feature.frame[:3, 3] for feature in features])
    bonuses = [clipped(own, name, world) for own, name in zip(measured.bonuses, measured.features, strict=False)]
    forms: list[Array] = []
    arms: list[Array] = []
    for k, (name, (x, y)) in enumerate(zip(measured.features, places - places.mean(axis=0), strict=True)):
        radius = 0.5 * bonuses[k] if bonuses else _constant(world, 0.0)
        ends = without_rounding(_at_ends(replace(measured, features=(name,)), world, sides))
        for end in ends[: 1 if np.array_equal(ends[0], ends[-1]) else None]:
            forms += [*end, radius]
            arms.append(np.array([-y, x]))
    rows = np.array(forms)
    term = CommonOpening(rows) if measured.gauge == "shift" else TurnedOpening(rows, np.array(arms))
    row: Array = -world.columns.made_by(term)[0]
    return row


def turn(measured: Measured, world: World) -> Array:
    """Rotation between torsors at nominally equal frames."""
    start, end = measured.features
    turned = (world.placed(end) - world.placed(start))[3:]  # nominally both frames are one
    return _length(np.zeros(3), turned, world) if measured.direction is None else _fixed_in(measured, world)[0] @ turned


def lean(measured: Measured, world: World) -> Array:
    """Angle between torsors at nominally equal frames, across their z; with the nominal tilt."""
    start, end = measured.features[:2]
    turned = (world.placed(end) - world.placed(start))[3:]
    axis = world.axis(start)
    leans = -cross_matrix(axis) @ turned
    if measured.direction is None:
        return _length(np.zeros(3), leans, world)
    rest = world.frame(measured.features[2])
    about = np.cross(rest[:3, 2], axis)
    sine = float(np.linalg.norm(about))
    ahead, beside = (rest[:3, 0], rest[:3, 1]) if sine < LEANS else (np.cross(about, axis) / sine, about / sine)
    return np.asarray((measured.direction[0] * ahead + measured.direction[1] * beside) @ leans)


def slack(measured: Measured, world: World) -> Array:
    """As the move has left it."""
    return world.slacks[world.assembly.moves[measured.of_move].name]
