"""Displacements of gears in their meshes by effects: used by builds, their rates and compiled builds."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import singledispatch

import numpy as np

from tol3d.gearing.builds.slots import CENTRE, FLANK_TURN, OFFSET, TURN
from tol3d.gearing.effects import (
    AxesOffset,
    AxialPlay,
    AxisOffset,
    AxisTilt,
    Clocking,
    Effect,
    FlankDeviation,
    LinkDeviation,
    Temperature,
    ToothThickness,
    TurningOffset,
)
from tol3d.gearing.model import Model, Seat
from tol3d.numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class Displacement:
    """Change of some slots of a seat, linear in the components of a deviation.

    Args:
        seat: its place in `model.seats`.
        slot: the first of the slots, see slots.py.
        matrix: (slots, components) [mm or rad per mm or rad].
        factor: on the deviation.
    """

    seat: int
    slot: int
    matrix: Array
    factor: float = 1.0

    @property
    def slots(self) -> slice:
        """All of its slots."""
        return slice(self.slot, self.slot + len(self.matrix))

    @property
    def rates(self) -> Array:
        """Change of its slots per component, (components, slots)."""
        return self.factor * self.matrix.T

    def change(self, columns: Array) -> Array:
        """Change of its slots, (trials, slots), by deviations (trials, components)."""
        first, *others = (self.factor * columns[:, k, None] * own for k, own in enumerate(self.matrix.T))
        return np.asarray(sum(others, first))


@dataclass(frozen=True, eq=False)
class PivotShift:
    """Shift of a seat's origin because its axis turns about another point of the axis.

    Not linear: the pivot less the turned pivot. The turn itself is a Displacement of its own.

    Args:
        seat: its place in `model.seats`.
        turn: rotation vector per deviation (3,) [rad per mm or rad], in the seat's frame at rest; of one component.
        pivot: z of that point [mm], in the same frame.
    """

    seat: int
    turn: Array
    pivot: float


@dataclass(frozen=True)
class Growth:
    """Temperature of a part: the deviation [K]. Every length of it grows by its coefficient of expansion."""

    part: str


@dataclass(frozen=True)
class FlankOffsets:
    """Offsets of single flanks of a gear, in all of its meshes, by the effect."""

    effect: FlankDeviation


AnyDisplacement = Displacement | PivotShift | Growth | FlankOffsets


@singledispatch
def displacements(effect: Effect, model: Model, components: int) -> Iterator[AnyDisplacement]:
    """Displacements by a deviation of so many components in a model; each file of this folder registers one effect."""
    raise TypeError(f"builds/displacements.py has no function for the effect {type(effect).__name__}")


def in_seat(vector: tuple[float, float, float], seat: Seat, mesh: str | None) -> Array:
    """A vector in a gear's frame at rest in one of its meshes, (3,).

    Args:
        vector: in the gear's frame at rest on its shaft, or in that of the mesh if one is named.
        seat: the gear in its mesh.
        mesh: the one in which the vector is stated, if any.
    """
    if mesh is not None or seat.azimuth == 0.0:
        return np.array(vector)
    (x, y, z), cos, sin = vector, np.cos(seat.azimuth), np.sin(seat.azimuth)
    return np.array([cos * x + sin * y, cos * y - sin * x, z])


@displacements.register
def _(effect: AxesOffset, model: Model, components: int) -> Iterator[Displacement]:
    sideways = model.mesh(effect.mesh).pair.world_from_wheel[1]  # +y of the world in the driven gear's frame
    yield Displacement(model.seat_index[effect.mesh, effect.part], OFFSET, sideways[:, None])


@displacements.register
def _(effect: AxisOffset, model: Model, components: int) -> Iterator[Displacement]:
    for seat in model.seats_of(effect.part, effect.mesh):
        own = model.seats[seat]
        if components == 2:
            matrix = effect.plane.seen_from(own.azimuth).matrix
        else:
            matrix = in_seat(effect.direction, own, effect.mesh)[:, None]
        yield Displacement(seat, OFFSET, matrix, effect.factor)


@displacements.register
def _(effect: AxisTilt, model: Model, components: int) -> Iterator[Displacement | PivotShift]:
    """A planar tilt is about the gear's origin: bearings of a shaft shift their gears by an effect of their own."""
    for seat in model.seats_of(effect.part, effect.mesh):
        own = model.seats[seat]
        if components == 2:
            yield Displacement(seat, TURN, effect.matrix(own.azimuth))
            continue
        axis = in_seat(effect.axis, own, effect.mesh)
        yield Displacement(seat, TURN, axis[:, None], effect.per_length)
        if effect.pivot != 0.0:
            yield PivotShift(seat, effect.per_length * axis, effect.pivot)


@displacements.register
def _(effect: FlankDeviation, model: Model, components: int) -> Iterator[FlankOffsets]:
    yield FlankOffsets(effect)


@displacements.register(LinkDeviation)
@displacements.register(Clocking)
@displacements.register(AxialPlay)
def _(effect: LinkDeviation | Clocking | AxialPlay, model: Model, components: int) -> Iterator[Displacement]:
    """A mesh finds its rest for any turn of its gears; play of a train adds what its shafts turn, see play/play.py."""
    return iter(())


@displacements.register
def _(effect: Temperature, model: Model, components: int) -> Iterator[Growth]:
    yield from (Growth(part) for part in effect.parts)


@displacements.register
def _(effect: ToothThickness, model: Model, components: int) -> Iterator[Displacement]:
    for seat in model.seats_of(effect.part):
        yield Displacement(seat, FLANK_TURN, np.array([[effect.turn], [effect.offset]]))


@displacements.register
def _(effect: TurningOffset, model: Model, components: int) -> Iterator[Displacement]:
    for seat in model.seats_of(effect.part):
        yield Displacement(seat, CENTRE, effect.plane.seen_from(-model.seats[seat].ahead).matrix)
