"""How a Build moves with each deviation: its derivatives, exact at the build itself and not only at the nominal one.

Rates are per mm, rad or K of a component of the deviations. Like a Build they know nothing of positions.
"""

from dataclasses import dataclass
from functools import singledispatch

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.build import Build, in_seat
from tol3d.gearing.model import (
    AxesOffset,
    AxisOffset,
    AxisTilt,
    Clocking,
    Effect,
    Model,
    ReducerBacklash,
    Temperature,
    Together,
    ToothThickness,
    TurningOffset,
)
from tol3d.numerics import frames

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Tangent:
    """Rates of a block of builds; axis 1 follows `model.seats`, axis 2 the components of the deviations.

    Args:
        origin: (trials, seats, components, 3), velocity of the shaft frame's origin [mm], in the world.
        turn: (trials, seats, components, 3), angular velocity of the shaft's frame about it [rad], in the world.
        centre: (trials, seats, components, 2), of the gear's centre off its axis [mm], in the gear's frame.
        flank_turn, flank_offset, scale: (trials, seats, components), of the same fields of the Build.
    """

    origin: Array
    turn: Array
    centre: Array
    flank_turn: Array
    flank_offset: Array
    scale: Array

    def rows(self, rows: NDArray[np.intp]) -> "Tangent":
        """The rates of some builds."""
        return Tangent(**{name: rates[rows] for name, rates in vars(self).items()})


@dataclass
class _Rates:
    """What the contributors put in, before the seats' frames at rest are placed in the world."""

    axis_offset: Array  # (trials, seats, components, 3), in the seat's frame at rest
    axis_turn: Array  # the same shape: rate of the rotation vector there
    centre: Array  # (trials, seats, components, 2)
    flank_turn: Array  # (trials, seats, components)
    flank_offset: Array  # (trials, seats, components)
    temperature: dict[str, Array]  # part -> (components,)


def tangent(model: Model, made: Build, deviations: Array) -> Tangent:
    """Rates of builds by each component of their deviations.

    Args:
        model: what is built.
        made: `build(model, deviations)`.
        deviations: (trials, components) [mm, rad, K], columns as in `model.component_slices`.
    """
    shape = (len(deviations), len(model.seats), model.component_count)
    components = model.component_count
    rates = _Rates(
        axis_offset=np.zeros((*shape, 3)),
        axis_turn=np.zeros((*shape, 3)),
        centre=np.zeros((*shape, 2)),
        flank_turn=np.zeros(shape),
        flank_offset=np.zeros(shape),
        temperature={},
    )
    for contributor in model.contributors:
        own = model.component_slices[contributor.name]
        _put(contributor.effect, own, deviations[:, own], rates, model)

    def growth(part: str) -> Array:
        return rates.temperature.get(part, np.zeros(components)) * model.expansions[part]

    origin, axis_turn = rates.axis_offset, rates.axis_turn
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
    return Tangent(
        origin=origin,
        turn=frames.apply(left_jacobian(made.axis_turn)[:, :, None], axis_turn),
        centre=rates.centre,
        flank_turn=rates.flank_turn,
        flank_offset=rates.flank_offset,
        scale=scale,
    )


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


@singledispatch
def _put(effect: Effect, own: slice, columns: Array, rates: _Rates, model: Model) -> None:
    """Put in one contributor's rates: its `own` components with deviations (trials, own); one function an effect."""
    raise TypeError(f"tangent.py has no function for the effect {type(effect).__name__}")


@_put.register
def _(effect: ToothThickness, own: slice, columns: Array, rates: _Rates, model: Model) -> None:
    for seat in model.seats_of(effect.part):
        rates.flank_turn[:, seat, own] += effect.turn
        rates.flank_offset[:, seat, own] += effect.offset


@_put.register
def _(effect: TurningOffset, own: slice, columns: Array, rates: _Rates, model: Model) -> None:
    for seat in model.seats_of(effect.part):
        rates.centre[:, seat, own] += effect.plane.seen_from(-model.seats[seat].ahead).matrix.T


@_put.register
def _(effect: AxisOffset, own: slice, columns: Array, rates: _Rates, model: Model) -> None:
    for seat in model.seats_of(effect.part, effect.mesh):
        if columns.shape[1] == 2:
            plane = effect.plane.seen_from(model.seats[seat].azimuth)
            rates.axis_offset[:, seat, own, :2] += effect.factor * plane.matrix.T
        else:
            direction = effect.direction if effect.mesh else in_seat(effect.direction, model.seats[seat])
            rates.axis_offset[:, seat, own] += effect.factor * np.array(direction)


@_put.register
def _(effect: AxisTilt, own: slice, columns: Array, rates: _Rates, model: Model) -> None:
    """The pivot's own turn has a fixed axis, so that its angular velocity is the rate of its vector.

    A planar tilt is about the gear's origin: the shaft's bearings lead its offset by an effect of their own.
    """
    for seat in model.seats_of(effect.part, effect.mesh):
        if columns.shape[1] == 2:
            rates.axis_turn[:, seat, own] += effect.matrix(model.seats[seat].azimuth).T
            continue
        axis = effect.axis if effect.mesh else in_seat(effect.axis, model.seats[seat])
        rate = effect.per_length * np.array(axis)
        turned = frames.apply(frames.about_vector(columns * rate), np.array([0.0, 0.0, effect.pivot]))
        rates.axis_turn[:, seat, own] += rate
        rates.axis_offset[:, seat, own] += -np.cross(rate, turned)[:, None]


@_put.register
def _(effect: AxesOffset, own: slice, columns: Array, rates: _Rates, model: Model) -> None:
    mesh = model.mesh(effect.mesh)
    rates.axis_offset[:, model.seat_index[mesh.name, effect.part], own] += mesh.pair.world_from_wheel[1]


@_put.register
def _(effect: Temperature, own: slice, columns: Array, rates: _Rates, model: Model) -> None:
    for part in effect.parts:
        rate = rates.temperature.setdefault(part, np.zeros(model.component_count))
        rate[own] += 1.0


@_put.register
def _(effect: ReducerBacklash, own: slice, columns: Array, rates: _Rates, model: Model) -> None:
    """A data sheet moves no axis and no flank."""


@_put.register
def _(effect: Clocking, own: slice, columns: Array, rates: _Rates, model: Model) -> None:
    """A mesh finds its rest for any turn of its gears: the shafts tell the difference, see clocking.py."""


@_put.register
def _(effect: Together, own: slice, columns: Array, rates: _Rates, model: Model) -> None:
    for single in effect.effects:
        _put(single, own, columns, rates, model)
