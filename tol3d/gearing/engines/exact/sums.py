"""Deviations added up to builds, compiled; `compiled_displacements.py` finds what is added.

No model is imported here: whatever a kernel's module imports has it compiled anew where it changes.
"""

import math
from typing import Any

import numpy as np

from tol3d.gearing.builds.slots import CENTRE, FLANK_OFFSET, FLANK_TURN, TURN
from tol3d.gearing.builds.slots import SLOTS as DISPLACED
from tol3d.gearing.engines.exact.numbers import sine
from tol3d.numerics.arrays import Array
from tol3d.numerics.compiled import FULL, kernel, part
from tol3d.numerics.loops import fill

SCALE = DISPLACED  # growth of the seat's gear comes after the displacements
SLOTS = DISPLACED + 1
BUILD_ARRAYS = (
    "float64[:, ::1], int64[:, ::1], float64[::1], int64[:, ::1], float64[:, ::1], float64[:, ::1], "
    "float64[:, :, :, ::1], float64[:, :, ::1], float64[:, :, ::1], float64[:, ::1], float64[:, ::1], float64[:, ::1]"
)


@part
def rotate(shaft: Array, x: float, y: float, z: float) -> None:
    """Turn a frame, the upper left of (4, 4), by a rotation vector in its own axes; Rodrigues' formula."""
    square = x * x + y * y + z * z
    if square == 0.0:
        return
    angle = math.sqrt(square)
    first = sine(angle) / angle
    half = sine(0.5 * angle) / angle
    second = 2.0 * half * half
    for i in range(3):
        a, b, c = shaft[i, 0], shaft[i, 1], shaft[i, 2]
        along = second * (a * x + b * y + c * z)
        cosine = 1.0 - second * square
        shaft[i, 0] = cosine * a + along * x + first * (b * z - c * y)
        shaft[i, 1] = cosine * b + along * y + first * (c * x - a * z)
        shaft[i, 2] = cosine * c + along * z + first * (a * y - b * x)


@kernel(arrays=BUILD_ARRAYS, level=FULL)
def write_builds(
    deviations: Any,
    terms: Any,
    coefficients: Any,
    pivots: Any,
    levers: Any,
    rest: Any,
    shafts: Any,
    centre: Any,
    axis_turn: Any,
    flank_turn: Any,
    flank_offset: Any,
    scale: Any,
) -> None:
    """Write the arrays of a Build; arguments as in CompiledDisplacements and Build."""
    seats = len(rest)
    slots = np.empty(SLOTS * seats + seats)
    for row in range(len(deviations)):
        fill(slots, 0.0)
        for k in range(len(terms)):
            slots[terms[k, 1]] += coefficients[k] * deviations[row, terms[k, 0]]
        for k in range(len(pivots)):
            deviation, at = deviations[row, pivots[k, 0]], SLOTS * pivots[k, 1]
            x, y, z = deviation * levers[k, 0], deviation * levers[k, 1], levers[k, 3]
            # pivot less the turned pivot, for a turn across the axis
            angle = math.sqrt(x * x + y * y)
            if angle > 0.0:
                first, half = sine(angle) / angle, sine(0.5 * angle)
                slots[at] -= first * y * z
                slots[at + 1] += first * x * z
                slots[at + 2] += 2.0 * half * half * z
        for seat in range(seats):
            at, mesh = SLOTS * seat, int(rest[seat, 12])
            grown = 1.0 + slots[SLOTS * seats + mesh] if mesh >= 0 else 1.0
            shaft = shafts[row, seat]
            x, y, z = slots[at], slots[at + 1], slots[at + 2]
            for i in range(3):
                a, b, c = rest[seat, 3 * i], rest[seat, 3 * i + 1], rest[seat, 3 * i + 2]
                shaft[i, 0], shaft[i, 1], shaft[i, 2] = a, b, c
                shaft[i, 3] = a * x + b * y + c * z + grown * rest[seat, 9 + i]
                shaft[3, i] = 0.0
                u, v, w = slots[at + TURN], slots[at + TURN + 1], slots[at + TURN + 2]
                axis_turn[row, seat, i] = a * u + b * v + c * w
            shaft[3, 3] = 1.0
            rotate(shaft, slots[at + TURN], slots[at + TURN + 1], slots[at + TURN + 2])
            centre[row, seat, 0], centre[row, seat, 1] = slots[at + CENTRE], slots[at + CENTRE + 1]
            flank_turn[row, seat], flank_offset[row, seat] = slots[at + FLANK_TURN], slots[at + FLANK_OFFSET]
            scale[row, seat] = 1.0 + slots[at + SCALE]
