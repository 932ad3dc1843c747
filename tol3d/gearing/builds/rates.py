"""Derivatives of a Build by each deviation, exact at the build itself and not only at the nominal one.

Rates are per mm, rad or K of a component of the deviations. Like a Build they do not depend on positions.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.builds.build import Build
from tol3d.gearing.builds.displacements import Displacement, FlankOffsets, Growth, PivotShift, displacements
from tol3d.gearing.builds.slots import CENTRE, FLANK_OFFSET, FLANK_TURN, OFFSET, SLOTS, TURN
from tol3d.gearing.model import Model
from tol3d.numerics import frames
from tol3d.numerics.arrays import Array


@dataclass(frozen=True)
class BuildRates:
    """Rates of a block of builds; axis 1 follows `model.seats`, axis 2 the components of the deviations.

    Args:
        origin: (trials, seats, components, 3), velocity of the shaft frame's origin [mm], in the world.
        turn: (trials, seats, components, 3), angular velocity of the shaft's frame about it [rad], in the world.
        centre: (trials, seats, components, 2), of the gear's centre off its axis [mm], in the gear's frame.
        flank_turn, flank_offset, scale: (trials, seats, components), of the same fields of the Build.

    Offsets of single flanks depend on the components by FlankPlaces, alike in every build.
    """

    origin: Array
    turn: Array
    centre: Array
    flank_turn: Array
    flank_offset: Array
    scale: Array

    def rows(self, rows: NDArray[np.intp]) -> "BuildRates":
        """The rates of some builds."""
        return BuildRates(**{name: rates[rows] for name, rates in vars(self).items()})


def build_rates(model: Model, made: Build, deviations: Array) -> BuildRates:
    """Rates of builds by each component of their deviations.

    Args:
        model: what is built.
        made: `build(model, deviations)`.
        deviations: (trials, components) [mm, rad, K], columns as in `model.component_slices`.
    """
    shape = (len(deviations), len(model.seats), model.component_count)
    seats, temperature = _summed(model, deviations)

    def growth(part: str) -> Array:
        return temperature.get(part, np.zeros(model.component_count)) * model.expansions[part]

    origin, axis_turn = seats[..., OFFSET : OFFSET + 3], seats[..., TURN : TURN + 3]
    for mesh in model.meshes:
        driven = model.seat_index[mesh.name, mesh.driven]
        rest = mesh.pair.world_from_wheel
        origin[:, driven] = frames.apply(rest, origin[:, driven])
        axis_turn[:, driven] = frames.apply(rest, axis_turn[:, driven])
        if mesh.housing:
            origin[:, driven] += growth(mesh.housing)[:, None] * mesh.pair.wheel_origin
    scale = np.zeros(shape)
    for index, seat in enumerate(model.seats):
        scale[:, index] = growth(seat.gear)
    return BuildRates(
        origin=origin,
        turn=frames.apply(left_jacobian(made.axis_turn)[:, :, None], axis_turn),
        centre=seats[..., CENTRE : CENTRE + 2],
        flank_turn=seats[..., FLANK_TURN],
        flank_offset=seats[..., FLANK_OFFSET],
        scale=scale,
    )


def _summed(model: Model, deviations: Array) -> tuple[Array, dict[str, Array]]:
    """Rates of the sums by `build.summed`: (trials, seats, components, slots), and (components,) by part."""
    seats = np.zeros((len(deviations), len(model.seats), model.component_count, SLOTS))
    temperature: dict[str, Array] = {}
    for contributor in model.contributors:
        own = model.component_slices[contributor.name]
        columns = deviations[:, own]
        for effect in contributor.effect.singles:
            for term in displacements(effect, model, columns.shape[1]):
                match term:
                    case Displacement():
                        seats[:, term.seat, own, term.slots] += term.rates
                    case PivotShift():
                        seats[:, term.seat, own, OFFSET : OFFSET + 3] += _shift_rate(term, columns)[:, None]
                    case Growth():
                        temperature.setdefault(term.part, np.zeros(model.component_count))[own] += 1.0
                    case FlankOffsets():
                        pass
    return seats, temperature


def _shift_rate(shift: PivotShift, columns: Array) -> Array:
    """Rate of a seat's origin by a turn about a pivot, (trials, 3); the axis of that turn is fixed."""
    turned = frames.apply(frames.about_vector(columns * shift.turn), np.array([0.0, 0.0, shift.pivot]))
    return np.asarray(-np.cross(shift.turn, turned))


def left_jacobian(vector: Array) -> Array:
    """Angular velocity of the rotation by a rotation vector [rad], from the vector's rate: (..., 3) to (..., 3, 3).

    J = 1 + (1 - cos t)/t^2 [v] + (t - sin t)/t^3 [v]^2, [v] the cross product with v and t its length.
    Source: Chirikjian, Stochastic Models, Information Theory, and Lie Groups 2 (2012), 10.3, for SO(3).
    """
    angle = np.sqrt((vector * vector).sum(axis=-1))
    small = angle < frames.SMALL_TURN
    safe = np.where(small, 1.0, angle)
    first = np.where(small, 0.5, 2 * (np.sin(safe / 2) / safe) ** 2)
    second = np.where(small, 1 / 6, (safe - np.sin(safe)) / safe**3)
    x, y, z = vector[..., 0], vector[..., 1], vector[..., 2]
    zero = np.zeros_like(x)
    cross = np.stack(
        [np.stack([zero, -z, y], axis=-1), np.stack([z, zero, -x], axis=-1), np.stack([-y, x, zero], axis=-1)], axis=-2
    )
    return np.eye(3) + first[..., None, None] * cross + second[..., None, None] * frames.matmul(cross, cross)
