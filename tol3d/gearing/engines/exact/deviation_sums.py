"""Displacements, compiled to builds: they are linear, so that each deviation has its coefficients.

A turn about a point off the gear's origin is the exception, worked out in sums.py.

Deviations added up to builds, compiled; `compiled_displacements.py` finds what is added.

No model is imported here: whatever a kernel's module imports has it compiled anew where it changes.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.builds.build import Build
from tol3d.gearing.builds.displacements import (
    CENTRE,
    FLANK_OFFSET,
    FLANK_TURN,
    TURN,
    Displacement,
    FlankOffsets,
    Growth,
    PivotShift,
    displacements,
)
from tol3d.gearing.builds.displacements import SLOTS as DISPLACED
from tol3d.gearing.builds.flank_offsets import FlankPlaces
from tol3d.gearing.engines.exact.numbers import sine
from tol3d.gearing.model import Model
from tol3d.numerics.arrays import Array
from tol3d.numerics.compiled import FULL, kernel, part
from tol3d.numerics.loops import fill


@dataclass(frozen=True, eq=False)
class CompiledDisplacements:
    """Dependence of a build's seats on deviations, as summed by the kernel.

    Args:
        terms: (terms, 2), component of the deviations and slot: SLOTS a seat, then the growth of each mesh's housing.
        coefficients: (terms,), of the slot by the component.
        pivots: (pivots, 2), component and seat of turns about a point off the gear's origin.
        levers: (pivots, 4), rotation vector per deviation in the seat's frame at rest, and the point's z there [mm].
        rest: (seats, 16), rotation of each seat's frame at rest row by row, its origin [mm], its mesh or -1; padded.
        flanks: offsets of single flanks.
    """

    terms: NDArray[np.int64]
    coefficients: Array
    pivots: NDArray[np.int64]
    levers: Array
    rest: Array
    flanks: FlankPlaces

    def build(self, deviations: Array) -> Build:
        """Builds of the trials with these deviations, (trials, components): build.build to the last few bits."""
        trials, seats = len(deviations), len(self.rest)
        made = Build(
            world_from_shaft=np.empty((trials, seats, 4, 4)),
            centre=np.empty((trials, seats, 2)),
            axis_turn=np.empty((trials, seats, 3)),
            flank_turn=np.empty((trials, seats)),
            flank_offset=np.empty((trials, seats)),
            scale=np.empty((trials, seats)),
        )
        write_builds(
            np.require(deviations, requirements=["C", "W"]),
            self.terms,
            self.coefficients,
            self.pivots,
            self.levers,
            self.rest,
            *(values for values in vars(made).values() if values is not None),
        )
        return replace(made, flanks=self.flanks.made(deviations))


def compiled_displacements(model: Model) -> CompiledDisplacements:
    """The displacements of a model's contributors."""
    terms, coefficients, pivots, levers = [], [], [], []
    for contributor in model.contributors:
        first, components = model.component_slices[contributor.name].start, len(contributor.draw.components)
        totals = np.zeros((components, SLOTS * len(model.seats) + len(model.meshes)))
        for effect in contributor.effect.singles:
            for term in displacements(effect, model, components):
                match term:
                    case Displacement():
                        start = SLOTS * term.seat
                        totals[:, start + term.slots.start : start + term.slots.stop] += term.rates
                    case PivotShift():
                        pivots.append((first, term.seat))
                        levers.append((*term.turn, term.pivot))
                    case Growth():
                        totals[:, _growing(model, term.part)] += model.expansions[term.part]
                    case FlankOffsets():
                        pass
        terms += [(first + component, slot) for component, slot in np.argwhere(totals)]
        coefficients += totals[totals != 0.0].tolist()
    return CompiledDisplacements(
        np.array(terms, dtype=np.int64).reshape(-1, 2),
        np.array(coefficients),
        np.array(pivots, dtype=np.int64).reshape(-1, 2),
        np.array(levers, dtype=float).reshape(-1, 4),
        _rest(model),
        FlankPlaces.of(model),
    )


def _growing(model: Model, part: str) -> list[int]:
    """Slots of a part's growth: in its own seats, and in the meshes that it holds."""
    seats = [SLOTS * index + SCALE for index, seat in enumerate(model.seats) if seat.gear == part]
    after = SLOTS * len(model.seats)
    return seats + [after + index for index, mesh in enumerate(model.meshes) if mesh.housing == part]


def _rest(model: Model) -> Array:
    rest = np.zeros((len(model.seats), 16))
    rest[:, [0, 4, 8]] = 1.0
    rest[:, 12] = -1.0
    for index, mesh in enumerate(model.meshes):
        driven = model.seat_index[mesh.name, mesh.driven]
        rest[driven, :13] = [*mesh.pair.world_from_wheel.ravel(), *mesh.pair.wheel_origin, index]
    return rest


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
