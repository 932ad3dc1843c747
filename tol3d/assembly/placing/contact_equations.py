"""Contact equations of round features and their changes with the pose, in kernels.

A contact has two sides, each a point, a line or a plane by an origin and a direction: centres of spheres, axes of
cylinders. Its error is the gap between the surfaces [mm]; a cylinder that lies along something has a second one, the
rise of its axis over a stated length. `rows` are their changes with a shift of the part and a turn about the middle of
its features that touch, from which its sides are counted; the others' are from where that lies nominally.
"""

from typing import Any, Final

import numpy as np

from tol3d.numerics.compiled import nested
from tol3d.numerics.loops import fill_matrix

POINT_PLANE: Final = 0
PLANE_POINT: Final = 1
LINE_PLANE: Final = 2
PLANE_LINE: Final = 3
POINT_POINT: Final = 4
POINT_LINE: Final = 5
LINE_POINT: Final = 6
ALONG: Final = 7
CROSSING: Final = 8
"""Sides of a contact, that of the part that is placed first; two lines lie along each other or cross."""

TWO: Final = (LINE_PLANE, PLANE_LINE, ALONG)
"""Contacts along a line: they have two equations."""


@nested
def count_of(kind: int) -> Any:
    """Number of equations of a contact."""
    return 2 if kind in TWO else 1


@nested
def dot(a: Any, b: Any) -> Any:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@nested
def crossed(a: Any, b: Any, out: Any) -> None:
    """Vector product."""
    x = a[1] * b[2] - a[2] * b[1]
    y = a[2] * b[0] - a[0] * b[2]
    z = a[0] * b[1] - a[1] * b[0]
    out[0], out[1], out[2] = x, y, z


@nested
def add_point_motion(row: Any, normal: Any, arm: Any, factor: float) -> None:
    """Add to a row the motion of a point along a normal, at an arm from the middle of the part's turn."""
    for k in range(3):
        row[k] += factor * normal[k]
    row[3] += factor * (arm[1] * normal[2] - arm[2] * normal[1])
    row[4] += factor * (arm[2] * normal[0] - arm[0] * normal[2])
    row[5] += factor * (arm[0] * normal[1] - arm[1] * normal[0])


@nested
def tilted(row: Any, direction: Any, normal: Any, factor: float) -> None:
    """Add to a row the motion along a normal of a direction that turns with the part."""
    row[3] += factor * (direction[1] * normal[2] - direction[2] * normal[1])
    row[4] += factor * (direction[2] * normal[0] - direction[0] * normal[2])
    row[5] += factor * (direction[0] * normal[1] - direction[1] * normal[0])


@nested
def aside(apart: Any, direction: Any, normal: Any) -> Any:
    """Length of a vector's part across a direction; `normal` becomes its direction."""
    along = dot(apart, direction)
    for k in range(3):
        normal[k] = apart[k] - along * direction[k]
    length = np.sqrt(dot(normal, normal))
    for k in range(3):
        normal[k] = normal[k] / length
    return length


@nested
def on_plane(kind: int, sides: Any, errors: Any, rows: Any, e: int, length: float) -> Any:
    """A contact with a plane: its first error without the radius; fills the second one of a line."""
    arm, along, other, apart, room = sides
    if kind in (POINT_PLANE, LINE_PLANE):
        normal, lying = other, along
        height = dot(apart, normal)
        add_point_motion(rows[e], normal, arm, 1.0)
    else:
        normal, lying = along, other
        height = -dot(apart, normal)
        for k in range(3):
            room[k] = arm[k] - apart[k]  # to the target, which the plane of the part touches there
        add_point_motion(rows[e], normal, room, -1.0)
    if kind in (LINE_PLANE, PLANE_LINE):
        errors[e + 1] = length * dot(normal, lying)
        tilted(rows[e + 1], along, other, length)
    return height


@nested
def off_line(kind: int, sides: Any, normal: Any, errors: Any, rows: Any, e: int, length: float) -> Any:
    """Distance of a point and a point or a line, or of lines along each other, whose second error it fills."""
    arm, along, other, apart, room = sides
    if kind == POINT_POINT:
        distance = np.sqrt(dot(apart, apart))
        for k in range(3):
            normal[k] = apart[k] / distance
        add_point_motion(rows[e], normal, arm, 1.0)
    elif kind == LINE_POINT:
        distance = aside(apart, along, normal)
        back = dot(apart, along)
        for k in range(3):
            room[k] = arm[k] - back * along[k]
        add_point_motion(rows[e], normal, room, 1.0)
    else:
        distance = aside(apart, other, normal)
        add_point_motion(rows[e], normal, arm, 1.0)
    if kind == ALONG:
        rise, lies = dot(along, normal), dot(along, other)
        errors[e + 1] = length * rise
        tilted(rows[e + 1], along, normal, length)
        for k in range(3):
            room[k] = along[k] - rise * normal[k] - lies * other[k]
        add_point_motion(rows[e + 1], room, arm, length / distance)
    return distance


@nested
def at_crossing(sides: Any, normal: Any, rows: Any, e: int, sign: float) -> Any:
    """Distance of two lines that cross, along their common normal, with a sign."""
    arm, along, other, apart, room = sides
    crossed(along, other, normal)
    sine = np.sqrt(dot(normal, normal))
    for k in range(3):
        normal[k] = sign * normal[k] / sine
    distance = dot(apart, normal)
    add_point_motion(rows[e], normal, arm, 1.0)
    for k in range(3):
        room[k] = sign * (apart[k] - distance * normal[k]) / sine
    crossed(other, room, room)
    tilted(rows[e], along, room, 1.0)
    return distance


@nested
def interpolated(nominal: Any, given: Any, c: int, i: int, share: float, out: Any) -> None:
    """A side (6,), origin and direction: of a trial, or at a fraction of the path to it."""
    at = min(i, given.shape[2] - 1)
    square = 0.0
    for k in range(6):
        out[k] = given[c, k, at]
        if share != 1.0:
            out[k] = nominal[c, k] + share * (out[k] - nominal[c, k])
            square += out[k] * out[k] if k > 2 else 0.0
    if share != 1.0 and square > 0.0:
        for k in range(3, 6):
            out[k] = out[k] / np.sqrt(square)


@nested
def asked_of(asked: Any, i: int, share: float, rooms: Any) -> Any:
    """Fill in the contact constraints of a trial, at a fraction of the path from nominal; True if they are valid."""
    kinds, _, _, moving, targets, sums, nominal = asked
    ours, theirs, totals = rooms[:3]
    for c in range(kinds.shape[0]):
        interpolated(nominal[0], moving, c, i, share, ours[c])
        interpolated(nominal[1], targets, c, i, share, theirs[c])
        totals[c] = sums[c, min(i, sums.shape[1] - 1)]
        if share != 1.0:
            totals[c] = nominal[2][c] + share * (totals[c] - nominal[2][c])
        if not totals[c] > 0.0:
            return False  # the inner one is larger
    return True


@nested
def equations(pose: Any, asked: Any, errors: Any, rows: Any, rooms: Any) -> None:
    """Errors and rows of all contacts at a pose (3, 4), as `asked_of` has filled them in."""
    kinds, signs, length = asked[:3]
    ours, theirs, totals, sides, normal = rooms
    arm, along, other, apart, _ = sides
    fill_matrix(rows, 0.0)
    e = 0
    for c in range(kinds.shape[0]):
        for r in range(3):
            arm[r] = pose[r, 0] * ours[c, 0] + pose[r, 1] * ours[c, 1] + pose[r, 2] * ours[c, 2]
            along[r] = pose[r, 0] * ours[c, 3] + pose[r, 1] * ours[c, 4] + pose[r, 2] * ours[c, 5]
            other[r] = theirs[c, 3 + r]
            apart[r] = arm[r] + pose[r, 3] - theirs[c, r]
        kind = kinds[c]
        if kind <= PLANE_LINE:
            distance = on_plane(kind, sides, errors, rows, e, length)
        elif kind == CROSSING:
            distance = at_crossing(sides, normal, rows, e, signs[c])
        else:
            distance = off_line(kind, sides, normal, errors, rows, e, length)
        errors[e] = distance - totals[c]
        e += count_of(kind)


@nested
def new_sides(contacts: int) -> Any:
    """Work arrays for the equations."""
    sides = (np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3))
    return np.empty((contacts, 6)), np.empty((contacts, 6)), np.empty(contacts), sides, np.empty(3)
