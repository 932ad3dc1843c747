"""Poses and twists from the coordinates of joints, in kernels.

Kinds of joints as kernels know them.
"""

from typing import Any, Final

import numpy as np

from tol3d.numerics.compiled import nested
from tol3d.numerics.loops import copy

STRAIGHT: Final = 1e-4
"""Angle [rad] below which series take the place of sines."""


@nested
def composed(left: Any, right: Any, to: Any) -> None:
    """A pose after another one, (3, 4) each."""
    for r in range(3):
        for c in range(4):
            to[r, c] = left[r, 0] * right[0, c] + left[r, 1] * right[1, c] + left[r, 2] * right[2, c]
        to[r, 3] += left[r, 3]


@nested
def rotation_of(x: float, y: float, z: float, to: Any) -> None:
    """The rotation (3, 3) of a rotation vector."""
    square = x * x + y * y + z * z
    angle = np.sqrt(square)
    if angle > STRAIGHT:
        a, b = np.sin(angle) / angle, (1.0 - np.cos(angle)) / square
    else:
        a, b = 1.0 - square / 6.0, 0.5 - square / 24.0
    to[0, 0] = 1.0 - b * (y * y + z * z)
    to[1, 1] = 1.0 - b * (x * x + z * z)
    to[2, 2] = 1.0 - b * (x * x + y * y)
    to[0, 1], to[1, 0] = b * x * y - a * z, b * x * y + a * z
    to[0, 2], to[2, 0] = b * x * z + a * y, b * x * z - a * y
    to[1, 2], to[2, 1] = b * y * z - a * x, b * y * z + a * x


@nested
def rate_of(x: float, y: float, u: float, v: float, to: Any) -> None:
    """The angular velocity (3,) of the rotation by (x, y, 0) while that changes by (u, v, 0)."""
    square = x * x + y * y
    angle = np.sqrt(square)
    if angle > STRAIGHT:
        b, c = (1.0 - np.cos(angle)) / square, (angle - np.sin(angle)) / (square * angle)
    else:
        b, c = 0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0
    spin = x * v - y * u
    to[0] = u + c * y * spin
    to[1] = v - c * x * spin
    to[2] = b * spin


@nested
def motion(kind: int, numbers: Any, q: Any, q0: int, turn: Any, to: Any) -> None:
    """Motion of a joint's frame at some coordinates: a pose (3, 4).

    Args:
        kind: the joint's.
        numbers: its lead per radian or its ratio, then a rotation between its two axes (10,).
        q: all coordinates.
        q0: the first of its own.
        turn: of a ball, its rotation (3, 3).
        to: the pose.
    """
    for r in range(3):
        for c in range(4):
            to[r, c] = 1.0 if r == c else 0.0
    if kind == BALL:
        for r in range(3):
            for c in range(3):
                to[r, c] = turn[r, c]
    elif kind == SWING:
        rotation_of(q[q0], q[q0 + 1], 0.0, to)
    elif kind == PRISMATIC:
        to[2, 3] = q[q0]
    elif kind == UNIVERSAL:
        cos, sin, other, own = np.cos(q[q0]), np.sin(q[q0]), np.cos(q[q0 + 1]), np.sin(q[q0 + 1])
        for r in range(3):
            x, y = numbers[1 + 3 * r], numbers[2 + 3 * r]
            to[r, 0], to[r, 1], to[r, 2] = x * other + y * own, y * other - x * own, numbers[3 + 3 * r]
        for c in range(3):
            x, y = to[0, c], to[1, c]
            to[0, c], to[1, c] = cos * x - sin * y, sin * x + cos * y
    else:
        cos, sin = np.cos(q[q0]), np.sin(q[q0])
        to[0, 0], to[0, 1], to[1, 0], to[1, 1] = cos, -sin, sin, cos
        if kind == CYLINDRICAL:
            to[2, 3] = q[q0 + 1]
        elif kind == SCREW:
            to[2, 3] = numbers[0] * q[q0]


@nested
def add_turn(twists: Any, column: int, axis: Any, point: Any) -> None:
    """Add to a body's twists (6, free) at a column a turn about an axis (3,) through a point (3,)."""
    if column >= 0:
        for r in range(3):
            twists[r, column] += axis[r]
        twists[3, column] += point[1] * axis[2] - point[2] * axis[1]
        twists[4, column] += point[2] * axis[0] - point[0] * axis[2]
        twists[5, column] += point[0] * axis[1] - point[1] * axis[0]


@nested
def add_slide(twists: Any, column: int, axis: Any, rate: float) -> None:
    """Add to a body's twists (6, free) at a column a slide along an axis (3,)."""
    if column >= 0:
        for r in range(3):
            twists[3 + r, column] += rate * axis[r]


@nested
def moving(kind: int, numbers: Any, q: Any, q0: int, at: Any, free: Any, twists: Any, room: Any) -> None:
    """Add to a body's twists (6, free) those of the coordinates of the joint that carries it.

    Args:
        kind, numbers, q, q0: of the joint, see `motion`.
        at: the joint's frame in the world (3, 4).
        free: column of each coordinate; -1 where that is given.
        twists: the body's.
        room: three vectors to work in.
    """
    axis, point, own = room
    for r in range(3):
        axis[r], point[r] = at[r, 2], at[r, 3]
    if kind in (REVOLUTE, CYLINDRICAL, SCREW, UNIVERSAL):
        add_turn(twists, free[q0], axis, point)
    if kind == PRISMATIC:
        add_slide(twists, free[q0], axis, 1.0)
    elif kind == CYLINDRICAL:
        add_slide(twists, free[q0 + 1], axis, 1.0)
    elif kind == SCREW:
        add_slide(twists, free[q0], axis, numbers[0])
    elif kind == UNIVERSAL:
        cos, sin, x, y = np.cos(q[q0]), np.sin(q[q0]), numbers[3], numbers[6]
        for r in range(3):
            axis[r] = at[r, 0] * (cos * x - sin * y) + at[r, 1] * (sin * x + cos * y) + at[r, 2] * numbers[9]
        add_turn(twists, free[q0 + 1], axis, point)
    elif kind == SWING:
        for k in range(2):
            rate_of(q[q0], q[q0 + 1], 1.0 - k, float(k), own)
            for r in range(3):
                axis[r] = at[r, 0] * own[0] + at[r, 1] * own[1] + at[r, 2] * own[2]
            add_turn(twists, free[q0 + k], axis, point)
    elif kind == BALL:
        for k in range(3):
            for r in range(3):
                axis[r] = at[r, k]
            add_turn(twists, free[q0 + k], axis, point)


@nested
def rolled(ratio: float, at: Any, carried: Any, to: Any, tilt: Any) -> None:
    """A gear that rolls on another one: its frame (3, 4), and its carrier's tilt (2,) as a rotation vector.

    Args:
        ratio: its tilt by that of the carrier.
        at: frame of the fixed gear (3, 4).
        carried: frame of the carrier: its origin is the gear's centre, its z lies along that of the fixed gear at rest.
        to, tilt: results.
    """
    n, turned = np.empty(3), np.empty((3, 3))
    for c in range(3):
        n[c] = at[0, c] * carried[0, 2] + at[1, c] * carried[1, 2] + at[2, c] * carried[2, 2]
    sine = np.sqrt(n[0] * n[0] + n[1] * n[1])
    share = np.arctan2(sine, n[2]) / sine if sine > STRAIGHT else 1.0 + sine * sine / 6.0
    tilt[0], tilt[1] = -share * n[1], share * n[0]
    rotation_of(ratio * tilt[0], ratio * tilt[1], 0.0, turned)
    for r in range(3):
        for c in range(3):
            to[r, c] = at[r, 0] * turned[0, c] + at[r, 1] * turned[1, c] + at[r, 2] * turned[2, c]
        to[r, 3] = carried[r, 3]


@nested
def rolling(ratio: float, at: Any, tilt: Any, centre: Any, fixed: Any, carrier: Any, twists: Any) -> None:
    """The twists (6, free) of a gear that rolls on another one.

    Args:
        ratio, at: see `rolled`.
        tilt: of the carrier (2,).
        centre: of the gear's frame (3, 4).
        fixed, carrier: twists of the other gear and of the carrier (6, free).
        twists: results.
    """
    swung, own, rate, turned = np.empty((3, 3)), np.empty(3), np.empty((2, 3)), np.empty(3)
    rotation_of(tilt[0], tilt[1], 0.0, swung)
    for k in range(2):
        rate_of(tilt[0], tilt[1], 1.0 - k, float(k), own)
        copy(rate[k], own)
    # the carrier's axis moves as the two columns of its tilt say: seen along two directions across it
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    for r in range(3):
        a += swung[r, 0] * rate[0, r]
        b += swung[r, 0] * rate[1, r]
        c += swung[r, 1] * rate[0, r]
        d += swung[r, 1] * rate[1, r]
    det = a * d - b * c
    for column in range(twists.shape[1]):
        x, y = 0.0, 0.0
        for r in range(3):
            seen = 0.0
            for s in range(3):
                seen += at[s, r] * (carrier[s, column] - fixed[s, column])
            x += swung[r, 0] * seen
            y += swung[r, 1] * seen
        u, v = (d * x - b * y) / det, (a * y - c * x) / det
        rate_of(ratio * tilt[0], ratio * tilt[1], ratio * u, ratio * v, own)
        for r in range(3):
            turned[r] = fixed[r, column] + at[r, 0] * own[0] + at[r, 1] * own[1] + at[r, 2] * own[2]
        for r in range(3):
            s, t = (r + 1) % 3, (r + 2) % 3
            # the centre goes with the carrier, whatever turns about it
            shift = carrier[3 + r, column] + carrier[s, column] * centre[t, 3] - carrier[t, column] * centre[s, 3]
            twists[3 + r, column] = shift - (turned[s] * centre[t, 3] - turned[t] * centre[s, 3])
            twists[r, column] = turned[r]


BALL: Final = 0
REVOLUTE: Final = 1
PRISMATIC: Final = 2
CYLINDRICAL: Final = 3
UNIVERSAL: Final = 4
SWING: Final = 5
SCREW: Final = 6
ROLLING: Final = 7
ALONG: Final = 8
"""The z of both frames are one direction: of an output that a pose names."""
FIXED: Final = 9
"""Both frames coincide: of such an output too."""
ON_AXES_KINDS: Final = frozenset([REVOLUTE, PRISMATIC, CYLINDRICAL, SCREW])
"""Kinds with two axes on one line."""
