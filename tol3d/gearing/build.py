"""Model and deviations to a Build: where every part's axis lies, and how its flanks deviate.

A Build knows nothing of positions: the poses at a turn come from `world_from_gear`.
"""

from dataclasses import dataclass
from functools import singledispatch

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.model import (
    AxesOffset,
    AxisOffset,
    AxisTilt,
    Clocking,
    Effect,
    Model,
    ReducerBacklash,
    Seat,
    Temperature,
    Together,
    ToothThickness,
    TurningOffset,
)
from tol3d.numerics import frames

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Build:
    """Virtual builds of a block of trials; axis 1 follows `model.seats`: a gear has a place in each of its meshes.

    The world is that of the seat's mesh.

    Args:
        world_from_shaft: (trials, seats, 4, 4), the axis at rest: its z is the rotation axis.
        centre: (trials, seats, 2) [mm], the gear's centre off its axis, in the gear's frame (turns with it).
        axis_turn: (trials, seats, 3) [rad], rotation vector by which the axis left its rest, in the world.
        flank_turn: (trials, seats) [rad], by which each flank is turned out of its tooth; positive is thicker.
        flank_offset: (trials, seats) [mm], by which each flank lies outside that, along its normal.
        scale: (trials, seats), thermal growth of the whole gear, 1 at the reference temperature.
    """

    world_from_shaft: Array
    centre: Array
    axis_turn: Array
    flank_turn: Array
    flank_offset: Array
    scale: Array

    @property
    def trials(self) -> int:
        """Number of builds."""
        return len(self.scale)

    def repeated(self, count: int) -> "Build":
        """Each build `count` times in a row, for as many positions; shape (trials * count, ...)."""
        if count == 1:
            return self
        return self.rows(np.repeat(np.arange(self.trials), count))

    def rows(self, rows: NDArray[np.intp] | NDArray[np.bool_]) -> "Build":
        """The builds of some rows."""
        return Build(**{name: values[rows] for name, values in vars(self).items()})

    def axis(self, seat: int) -> tuple[Array, Array]:
        """Rotation axis of a gear in the world: a point on it and its unit direction, each (trials, 3)."""
        return self.world_from_shaft[:, seat, :3, 3], self.world_from_shaft[:, seat, :3, 2]

    def world_from_gear(self, seat: int, angle: Array) -> Array:
        """Pose of a gear at a turn about its axis [rad] (trials,): (trials, 4, 4).

        world_from_shaft @ turn(angle) @ shaft_from_gear; the last one is the offset of the centre.
        """
        rotation, origin = self.tooth_pose(seat, angle, np.zeros_like(angle)[:, None])
        return frames.transform(rotation[:, 0], origin)

    def tooth_pose(self, seat: int, angle: Array, turn: Array) -> tuple[Array, Array]:
        """Pose of parts of a gear that are turned about the gear's own centre.

        Args:
            seat: the gear's place in arrays over seats.
            angle: turn of the shaft [rad], (trials,).
            turn: turns within the gear [rad], (trials, parts): a tooth's place, half its thickness.

        Returns:
            rotations (trials, parts, 3, 3) and their common origin (trials, 3) [mm], in the world.
        """
        shaft = self.world_from_shaft[:, seat, :3, :3]
        return frames.matmul(shaft[:, None], frames.about_z(angle[:, None] + turn)), self.centre_of(seat, angle)

    def centre_of(self, seat: int, angle: Array) -> Array:
        """Where a gear's own centre lies in the world at a turn of its shaft [rad] (trials,): (trials, 3) [mm]."""
        shaft = self.world_from_shaft[:, seat, :3, :3]
        cos, sin = np.cos(angle), np.sin(angle)
        x, y = self.centre[:, seat, 0], self.centre[:, seat, 1]
        offset = np.stack([cos * x - sin * y, sin * x + cos * y, np.zeros_like(x)], axis=-1)
        return self.world_from_shaft[:, seat, :3, 3] + frames.apply(shaft, offset)


@dataclass
class Sums:
    """What the contributors add up to, before poses are made of it; axis 1 follows `model.seats`.

    Args:
        axis_offset, axis_turn: (trials, seats, 3) [mm; rad, a rotation vector], in the seat's frame at rest.
        centre: (trials, seats, 2) [mm].
        flank_turn, flank_offset: (trials, seats) [rad; mm].
        temperature: (trials,) [K], by part.
    """

    axis_offset: Array
    axis_turn: Array
    centre: Array
    flank_turn: Array
    flank_offset: Array
    temperature: dict[str, Array]

    def growth(self, model: Model, part: str) -> Array:
        """By how much a part has grown, (trials,)."""
        return self.temperature.get(part, np.zeros(len(self.flank_turn))) * model.expansions[part]


def summed(model: Model, deviations: Array) -> Sums:
    """What the deviations (trials, components) [mm, rad, K] add up to."""
    trials, seats = len(deviations), len(model.seats)
    sums = Sums(
        axis_offset=np.zeros((trials, seats, 3)),
        axis_turn=np.zeros((trials, seats, 3)),
        centre=np.zeros((trials, seats, 2)),
        flank_turn=np.zeros((trials, seats)),
        flank_offset=np.zeros((trials, seats)),
        temperature={},
    )
    for contributor in model.contributors:
        columns = deviations[:, model.component_slices[contributor.name]]
        _add(contributor.effect, columns, sums, model)
    return sums


def build(model: Model, deviations: Array) -> Build:
    """Builds of the trials with these deviations.

    Args:
        model: what is built.
        deviations: (trials, components) [mm, rad, K], columns as in `model.component_slices`.
    """
    trials, seats = len(deviations), len(model.seats)
    sums = summed(model, deviations)
    origin = sums.axis_offset
    axis_turn = sums.axis_turn
    shafts = np.zeros((trials, seats, 4, 4))
    shafts[..., :3, :3] = np.eye(3)
    shafts[..., 3, 3] = 1.0
    for mesh in model.meshes:
        driven = model.seat_index[mesh.name, mesh.driven]
        rest = mesh.pair.world_from_wheel
        grown = 1.0 + sums.growth(model, mesh.housing) if mesh.housing else 1.0
        origin[:, driven] = frames.apply(rest, origin[:, driven]) + np.multiply.outer(grown, mesh.pair.wheel_origin)
        axis_turn[:, driven] = frames.apply(rest, axis_turn[:, driven])
        shafts[:, driven, :3, :3] = rest
    for index in range(seats):
        if axis_turn[:, index].any():  # a turn by nothing changes no bit
            turn = frames.about_vector(axis_turn[:, index])
            shafts[:, index, :3, :3] = frames.matmul(turn, shafts[:, index, :3, :3])
    shafts[..., :3, 3] = origin
    scale = np.ones((trials, seats))
    for index, seat in enumerate(model.seats):
        scale[:, index] += sums.growth(model, seat.gear)
    return Build(
        world_from_shaft=shafts,
        centre=sums.centre,
        axis_turn=axis_turn,
        flank_turn=sums.flank_turn,
        flank_offset=sums.flank_offset,
        scale=scale,
    )


def in_seat(vector: tuple[float, float, float], seat: Seat) -> Array:
    """A vector of a gear's frame at rest on its shaft, in the gear's frame at rest in one of its meshes."""
    if seat.azimuth == 0.0:
        return np.array(vector)
    (x, y, z), cos, sin = vector, np.cos(seat.azimuth), np.sin(seat.azimuth)
    return np.array([cos * x + sin * y, cos * y - sin * x, z])


@singledispatch
def _add(effect: Effect, columns: Array, sums: Sums, model: Model) -> None:
    """Add one contributor's deviations (trials, components); one function an effect."""
    raise TypeError(f"build.py has no function for the effect {type(effect).__name__}")


@_add.register
def _(effect: ToothThickness, columns: Array, sums: Sums, model: Model) -> None:
    for seat in model.seats_of(effect.part):
        sums.flank_turn[:, seat] += effect.turn * columns[:, 0]
        sums.flank_offset[:, seat] += effect.offset * columns[:, 0]


@_add.register
def _(effect: TurningOffset, columns: Array, sums: Sums, model: Model) -> None:
    for seat in model.seats_of(effect.part):
        sums.centre[:, seat] += effect.plane.seen_from(-model.seats[seat].ahead).turned(columns)


@_add.register
def _(effect: AxisOffset, columns: Array, sums: Sums, model: Model) -> None:
    for seat in model.seats_of(effect.part, effect.mesh):
        if columns.shape[1] == 2:
            plane = effect.plane.seen_from(model.seats[seat].azimuth)
            sums.axis_offset[:, seat, :2] += effect.factor * plane.turned(columns)
        else:
            direction = effect.direction if effect.mesh else in_seat(effect.direction, model.seats[seat])
            sums.axis_offset[:, seat] += effect.factor * columns * np.array(direction)


@_add.register
def _(effect: AxisTilt, columns: Array, sums: Sums, model: Model) -> None:
    for seat in model.seats_of(effect.part, effect.mesh):
        if columns.shape[1] == 2:
            by_x, by_y = effect.matrix(model.seats[seat].azimuth).T
            turn = columns[:, :1] * by_x + columns[:, 1:] * by_y
        else:
            axis = effect.axis if effect.mesh else in_seat(effect.axis, model.seats[seat])
            turn = effect.per_length * columns * np.array(axis)
        sums.axis_turn[:, seat] += turn
        if effect.pivot != 0.0:
            pivot = np.array([0.0, 0.0, effect.pivot])
            sums.axis_offset[:, seat] += pivot - frames.apply(frames.about_vector(turn), pivot)


@_add.register
def _(effect: AxesOffset, columns: Array, sums: Sums, model: Model) -> None:
    mesh = model.mesh(effect.mesh)
    sums.axis_offset[:, model.seat_index[mesh.name, effect.part]] += columns * mesh.pair.world_from_wheel[1]


@_add.register
def _(effect: Temperature, columns: Array, sums: Sums, model: Model) -> None:
    for part in effect.parts:
        sums.temperature[part] = sums.temperature.get(part, 0.0) + columns[:, 0]


@_add.register
def _(effect: ReducerBacklash, columns: Array, sums: Sums, model: Model) -> None:
    """A data sheet moves no axis and no flank."""


@_add.register
def _(effect: Clocking, columns: Array, sums: Sums, model: Model) -> None:
    """A mesh finds its rest for any turn of its gears: the shafts tell the difference, see clocking.py."""


@_add.register
def _(effect: Together, columns: Array, sums: Sums, model: Model) -> None:
    for single in effect.effects:
        _add(single, columns, sums, model)
