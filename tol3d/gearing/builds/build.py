"""Model and deviations to a Build: the place of every part's axis, and the deviations of its flanks.

A Build knows nothing of positions: the poses at a turn come from `world_from_gear`.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.builds.displacements import (
    AnyDisplacement,
    Displacement,
    FlankOffsets,
    Growth,
    PivotShift,
    displacements,
)
from tol3d.gearing.builds.flank_offsets import FlankDeviations, FlankPlaces
from tol3d.gearing.builds.slots import CENTRE, FLANK_OFFSET, FLANK_TURN, OFFSET, SLOTS, TURN
from tol3d.gearing.model import Model
from tol3d.numerics import frames
from tol3d.numerics.arrays import Array


@dataclass(frozen=True)
class Build:
    """Virtual builds of a block of trials; axis 1 follows `model.seats`: a gear has one entry per mesh.

    The world is that of the seat's mesh.

    Args:
        world_from_shaft: (trials, seats, 4, 4), the axis at rest: its z is the rotation axis.
        centre: (trials, seats, 2) [mm], the gear's centre off its axis, in the gear's frame (turns with it).
        axis_turn: (trials, seats, 3) [rad], rotation vector by which the axis left its rest, in the world.
        flank_turn: (trials, seats) [rad], by which each flank is turned out of its tooth; positive is thicker.
        flank_offset: (trials, seats) [mm], by which each flank lies outside that, along its normal.
        scale: (trials, seats), thermal growth of the whole gear, 1 at the reference temperature.
        flanks: offsets of single flanks besides; None where all flanks of a gear are alike.
    """

    world_from_shaft: Array
    centre: Array
    axis_turn: Array
    flank_turn: Array
    flank_offset: Array
    scale: Array
    flanks: FlankDeviations | None = None

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
        parts: dict[str, Any] = {name: values[rows] for name, values in vars(self).items() if values is not None}
        return Build(**parts)

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
        """Position of a gear's own centre in the world at a turn of its shaft [rad] (trials,): (trials, 3) [mm]."""
        shaft = self.world_from_shaft[:, seat, :3, :3]
        cos, sin = np.cos(angle), np.sin(angle)
        x, y = self.centre[:, seat, 0], self.centre[:, seat, 1]
        offset = np.stack([cos * x - sin * y, sin * x + cos * y, np.zeros_like(x)], axis=-1)
        return self.world_from_shaft[:, seat, :3, 3] + frames.apply(shaft, offset)


@dataclass
class Sums:
    """Sums of contributors' deviations, from which poses are made.

    Args:
        seats: (trials, seats, slots) [mm or rad], see slots.py; axis 1 follows `model.seats`.
        temperature: (trials,) [K], by part.
    """

    seats: Array
    temperature: dict[str, Array]

    def growth(self, model: Model, part: str) -> Array:
        """Growth of a part, (trials,)."""
        return self.temperature.get(part, np.zeros(len(self.seats))) * model.expansions[part]


def summed(model: Model, deviations: Array) -> Sums:
    """Sums of the deviations (trials, components) [mm, rad, K]."""
    sums = Sums(np.zeros((len(deviations), len(model.seats), SLOTS)), {})
    for contributor in model.contributors:
        columns = deviations[:, model.component_slices[contributor.name]]
        for effect in contributor.effect.singles:
            for term in displacements(effect, model, columns.shape[1]):
                _add(term, columns, sums)
    return sums


def _add(term: AnyDisplacement, columns: Array, sums: Sums) -> None:
    """Add displacements by deviations (trials, components); single flanks are not in a seat's sums."""
    match term:
        case Displacement():
            sums.seats[:, term.seat, term.slots] += term.change(columns)
        case PivotShift():
            pivot = np.array([0.0, 0.0, term.pivot])
            turned = frames.apply(frames.about_vector(columns * term.turn), pivot)
            sums.seats[:, term.seat, OFFSET : OFFSET + 3] += pivot - turned
        case Growth():
            sums.temperature[term.part] = sums.temperature.get(term.part, 0.0) + columns[:, 0]
        case FlankOffsets():
            pass


def build(model: Model, deviations: Array) -> Build:
    """Builds of the trials with these deviations.

    Args:
        model: what is built.
        deviations: (trials, components) [mm, rad, K], columns as in `model.component_slices`.
    """
    trials, seats = len(deviations), len(model.seats)
    sums = summed(model, deviations)
    origin = sums.seats[..., OFFSET : OFFSET + 3]
    axis_turn = sums.seats[..., TURN : TURN + 3].copy()
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
        if axis_turn[:, index].any():  # a zero turn changes no bit
            turn = frames.about_vector(axis_turn[:, index])
            shafts[:, index, :3, :3] = frames.matmul(turn, shafts[:, index, :3, :3])
    shafts[..., :3, 3] = origin
    scale = np.ones((trials, seats))
    for index, seat in enumerate(model.seats):
        scale[:, index] += sums.growth(model, seat.gear)
    return Build(
        world_from_shaft=shafts,
        centre=sums.seats[..., CENTRE : CENTRE + 2].copy(),
        axis_turn=axis_turn,
        flank_turn=sums.seats[..., FLANK_TURN].copy(),
        flank_offset=sums.seats[..., FLANK_OFFSET].copy(),
        scale=scale,
        flanks=FlankPlaces.of(model).made(deviations),
    )
