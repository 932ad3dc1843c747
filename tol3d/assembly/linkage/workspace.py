"""Workspace of a loop: condition numbers over its output or its inputs, and its singular positions."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.assembly.linkage.kinematics import Kinematics, Position, UnreachedError
from tol3d.assembly.linkage.loop import ClosedLoop
from tol3d.errors import InputError

Array = NDArray[np.float64]

NEAREST: Final = 0.985
"""Fraction of the reach up to which a ray is examined."""
FURTHEST: Final = np.radians(175.0)
"""Tilt beyond which nothing is looked at."""


@dataclass(frozen=True, eq=False)
class Workspace:
    """A grid of poses, in rays from where the loop is drawn, each as far as it reaches.

    Args:
        azimuths: directions of the rays [rad].
        shares: places on each, as shares of its reach.
        reach: of each ray, the tilt at which the loop is singular or ends [rad].
        positions: by ray and place.
    """

    azimuths: Array
    shares: Array
    reach: Array
    positions: Sequence[Sequence[Position]]

    @property
    def tilts(self) -> Array:
        """Tilts of all places (rays, places) [rad]."""
        return self.reach[:, None] * self.shares

    @property
    def conditions(self) -> Array:
        """Condition numbers (rays, places)."""
        return np.array([[own.condition for own in ray] for ray in self.positions])


def workspace_of(
    move: ClosedLoop, rays: int, places: int, activity: Callable[[int], None] = lambda done: None
) -> Workspace:
    """The workspace of a loop whose output tilts.

    Args:
        move: the loop.
        rays: azimuths, evenly over a turn.
        places: on each ray, from no tilt to near its end.
        activity: progress callback, with the number of rays done.

    Raises:
        InputError: it has no output that tilts.
    """
    kinematics = move.kinematics
    output = kinematics.structure.output
    if output is None or output.whole:
        words = "expected a loop with `output: {tilt: …, from: …}`, whose tilts and azimuths a picture can show"
        raise InputError(f"moves.{move.name}: {words}; this one has none")
    azimuths = 2 * np.pi * np.arange(rays) / rays
    shares = NEAREST * np.arange(places) / (places - 1)
    reach, positions = np.empty(rays), []
    for k, azimuth in enumerate(azimuths):
        reach[k] = reach_of(kinematics, float(azimuth))
        ray, at = [], kinematics.drawn
        for tilt in reach[k] * shares:
            at = kinematics.at_output(_tilted(tilt, azimuth), at)
            ray.append(at)
        positions.append(ray)
        activity(k + 1)
    return Workspace(azimuths, shares, reach, positions)


@dataclass(frozen=True, eq=False)
class InputGrid:
    """Condition numbers over one or two inputs, the others as parts are placed.

    Args:
        names: of the inputs.
        values: of each, from where parts are placed [mm or rad].
        conditions: (values, values) or (values,), not a number where the loop does not get there.
    """

    names: tuple[str, ...]
    values: tuple[Array, ...]
    conditions: Array


def range_of(move: ClosedLoop, name: str) -> tuple[float, float]:
    """Range of an input, counted from the placed parts; that of its poses if none is stated.

    Raises:
        InputError: neither a range nor two poses state it.
    """
    own = move.inputs[name]
    if own.range is not None:
        return own.range[0] - own.as_placed, own.range[1] - own.as_placed
    values = [move.kinematics.inputs_at(at)[name] for at in (move.kinematics.drawn, *move.stations.values())]
    if max(values) > min(values):
        return min(values), max(values)
    words = "expected a `range`, or poses in which it differs"
    raise InputError(f"moves.{move.name}.inputs.{name}: {words}, got none")


def input_grid_of(move: ClosedLoop, count: int, activity: Callable[[int], None] = lambda done: None) -> InputGrid:
    """Condition numbers over the first one or two inputs of a loop.

    Args:
        move: the loop.
        count: values of each input.
        activity: progress callback, with the number of values of the first one done.

    Raises:
        InputError: it has no inputs, or their ranges are unknown.
    """
    names = tuple(move.inputs)[:2]
    if not names:
        raise InputError(f"moves.{move.name}: expected a loop with inputs, whose values a picture can show, got none")
    values = tuple(np.linspace(*range_of(move, name), count) for name in names)
    found = np.full((count,) * len(names), np.nan)
    for k, first in enumerate(values[0]):
        at = _reached(move.kinematics, {names[0]: float(first)}, move.kinematics.drawn)
        if len(names) == 1:
            found[k] = at.condition if at is not None else np.nan
        for n, second in enumerate(values[1] if len(names) > 1 else ()):
            inputs = {names[0]: float(first), names[1]: float(second)}
            there = _reached(move.kinematics, inputs, at or move.kinematics.drawn)
            found[k, n] = there.condition if there is not None else np.nan
        activity(k + 1)
    return InputGrid(names, values, found)


def _reached(kinematics: Kinematics, inputs: Mapping[str, float], start: Position) -> Position | None:
    try:
        return kinematics.at_inputs(inputs, start)
    except UnreachedError:
        return None


def reach_of(kinematics: Kinematics, azimuth: float) -> float:
    """The tilt towards an azimuth at which the loop is singular or ends [rad]; FURTHEST where it is neither."""
    try:
        kinematics.at_output(_tilted(FURTHEST, azimuth))
    except UnreachedError as error:
        return float(np.hypot(*kinematics.tilt_at(error.position)))
    return float(FURTHEST)


def _tilted(tilt: float, azimuth: float) -> Array:
    return tilt * np.array([-np.sin(azimuth), np.cos(azimuth)])
