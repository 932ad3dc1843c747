"""Model and deviations to a Build: where every part's axis lies, and how its flanks deviate.

A Build knows nothing of positions: the poses at a turn come from `world_from_gear`.
"""

from dataclasses import dataclass
from functools import singledispatch

import numpy as np
from numpy.typing import NDArray

from tol3d import frames
from tol3d.model import AxesOffset, AxisOffset, AxisTilt, Effect, Model, Temperature, ToothThickness, TurningOffset

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Build:
    """Virtual builds of a block of trials; axis 1 follows `model.gears`.

    Args:
        world_from_shaft: (trials, gears, 4, 4), the axis at rest: its z is the rotation axis.
        centre: (trials, gears, 2) [mm], the gear's centre off its axis, in the gear's frame (turns with it).
        axis_turn: (trials, gears, 3) [rad], rotation vector by which the axis left its rest, in the world.
        flank_turn: (trials, gears) [rad], by which each flank is turned out of its tooth; positive is thicker.
        flank_offset: (trials, gears) [mm], by which each flank lies outside that, along its normal.
        scale: (trials, gears), thermal growth of the whole gear, 1 at the reference temperature.
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

    def axis(self, gear: int) -> tuple[Array, Array]:
        """Rotation axis of a gear in the world: a point on it and its unit direction, each (trials, 3)."""
        return self.world_from_shaft[:, gear, :3, 3], self.world_from_shaft[:, gear, :3, 2]

    def world_from_gear(self, gear: int, angle: Array) -> Array:
        """Pose of a gear at a turn about its axis [rad] (trials,): (trials, 4, 4).

        world_from_shaft @ turn(angle) @ shaft_from_gear; the last one is the offset of the centre.
        """
        rotation, origin = self.tooth_pose(gear, angle, np.zeros_like(angle)[:, None])
        return frames.transform(rotation[:, 0], origin)

    def tooth_pose(self, gear: int, angle: Array, turn: Array) -> tuple[Array, Array]:
        """Pose of parts of a gear that are turned about the gear's own centre.

        Args:
            gear: index of the gear.
            angle: turn of the shaft [rad], (trials,).
            turn: turns within the gear [rad], (trials, parts): a tooth's place, half its thickness.

        Returns:
            rotations (trials, parts, 3, 3) and their common origin (trials, 3) [mm], in the world.
        """
        shaft = self.world_from_shaft[:, gear, :3, :3]
        return frames.matmul(shaft[:, None], frames.about_z(angle[:, None] + turn)), self.centre_of(gear, angle)

    def centre_of(self, gear: int, angle: Array) -> Array:
        """Where a gear's own centre lies in the world at a turn of its shaft [rad] (trials,): (trials, 3) [mm]."""
        shaft = self.world_from_shaft[:, gear, :3, :3]
        cos, sin = np.cos(angle), np.sin(angle)
        x, y = self.centre[:, gear, 0], self.centre[:, gear, 1]
        offset = np.stack([cos * x - sin * y, sin * x + cos * y, np.zeros_like(x)], axis=-1)
        return self.world_from_shaft[:, gear, :3, 3] + frames.apply(shaft, offset)


@dataclass
class Sums:
    """What the contributors add up to, before poses are made of it; axis 1 follows `model.gears`.

    Args:
        axis_offset, axis_turn: (trials, gears, 3) [mm; rad, a rotation vector], in the gear's frame at rest.
        centre: (trials, gears, 2) [mm].
        flank_turn, flank_offset: (trials, gears) [rad; mm].
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
    trials, gears = len(deviations), len(model.gears)
    sums = Sums(
        axis_offset=np.zeros((trials, gears, 3)),
        axis_turn=np.zeros((trials, gears, 3)),
        centre=np.zeros((trials, gears, 2)),
        flank_turn=np.zeros((trials, gears)),
        flank_offset=np.zeros((trials, gears)),
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
    trials, gears = len(deviations), len(model.gears)
    sums = summed(model, deviations)
    origin = sums.axis_offset
    axis_turn = sums.axis_turn
    shafts = np.zeros((trials, gears, 4, 4))
    shafts[..., :3, :3] = np.eye(3)
    shafts[..., 3, 3] = 1.0
    for mesh in model.meshes:
        driven = model.gear_index[mesh.driven]
        rest = mesh.pair.world_from_wheel
        grown = 1.0 + sums.growth(model, mesh.housing) if mesh.housing else 1.0
        origin[:, driven] = frames.apply(rest, origin[:, driven]) + np.multiply.outer(grown, mesh.pair.wheel_origin)
        axis_turn[:, driven] = frames.apply(rest, axis_turn[:, driven])
        shafts[:, driven, :3, :3] = rest
    for gear in range(gears):
        if axis_turn[:, gear].any():  # a turn by nothing changes no bit
            turn = frames.about_vector(axis_turn[:, gear])
            shafts[:, gear, :3, :3] = frames.matmul(turn, shafts[:, gear, :3, :3])
    shafts[..., :3, 3] = origin
    scale = np.ones((trials, gears))
    for part in model.gears:
        scale[:, model.gear_index[part.name]] += sums.growth(model, part.name)
    return Build(
        world_from_shaft=shafts,
        centre=sums.centre,
        axis_turn=axis_turn,
        flank_turn=sums.flank_turn,
        flank_offset=sums.flank_offset,
        scale=scale,
    )


@singledispatch
def _add(effect: Effect, columns: Array, sums: Sums, model: Model) -> None:
    """Add one contributor's deviations (trials, components); one function an effect."""
    raise TypeError(f"build.py has no function for the effect {type(effect).__name__}")


@_add.register
def _(effect: ToothThickness, columns: Array, sums: Sums, model: Model) -> None:
    gear = model.gear_index[effect.part]
    sums.flank_turn[:, gear] += effect.turn * columns[:, 0]
    sums.flank_offset[:, gear] += effect.offset * columns[:, 0]


@_add.register
def _(effect: TurningOffset, columns: Array, sums: Sums, model: Model) -> None:
    sums.centre[:, model.gear_index[effect.part]] += columns


@_add.register
def _(effect: AxisOffset, columns: Array, sums: Sums, model: Model) -> None:
    gear = model.gear_index[effect.part]
    if columns.shape[1] == 2:
        sums.axis_offset[:, gear, :2] += effect.factor * columns
    else:
        sums.axis_offset[:, gear] += effect.factor * columns * np.array(effect.direction)


@_add.register
def _(effect: AxisTilt, columns: Array, sums: Sums, model: Model) -> None:
    gear = model.gear_index[effect.part]
    turn = effect.per_length * columns * np.array(effect.axis)
    sums.axis_turn[:, gear] += turn
    if effect.pivot == 0.0:
        return
    pivot = np.array([0.0, 0.0, effect.pivot])
    sums.axis_offset[:, gear] += pivot - frames.apply(frames.about_vector(turn), pivot)


@_add.register
def _(effect: AxesOffset, columns: Array, sums: Sums, model: Model) -> None:
    gear = model.gear_index[effect.part]
    mesh = next(mesh for mesh in model.meshes if mesh.driven == effect.part)
    sums.axis_offset[:, gear] += columns * mesh.pair.world_from_wheel[1]


@_add.register
def _(effect: Temperature, columns: Array, sums: Sums, model: Model) -> None:
    for part in effect.parts:
        sums.temperature[part] = sums.temperature.get(part, 0.0) + columns[:, 0]
