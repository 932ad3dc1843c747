"""A tip over the swing of its arm: its error with and without the motor's correction, and which flanks work."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.apps.adjustment.robots import Robots, State
from tol3d.gearing import TrainPlay, TrainSwing
from tol3d.gears import Flank
from tol3d.numerics.arrays import Array


@dataclass(frozen=True, eq=False)
class Swing:
    """Errors of the tip over the output's angles.

    Args:
        measure: the scene's.
        output: the output's angles [rad], (positions,).
        turned: where the load acts on the other side than at the start, (positions,).
        jumps: the output's angles where it changes side [rad].
        curves: the tip's error with its sign by method and state, (robots, positions) [mm].
        flanks: by mesh of the way from the held shaft: its driver's flank that works at the start, and the other.
    """

    measure: str
    output: Array
    turned: NDArray[np.bool_]
    jumps: tuple[float, ...]
    curves: Mapping[str, Mapping[State, Array]]
    flanks: Mapping[str, tuple[Flank, Flank]]

    @property
    def first_turned(self) -> int:
        """The first position behind the first change of side."""
        return int(np.argmax(self.turned))


def swing_of(play: TrainPlay, robots: Robots, batch: Mapping[str, float]) -> Swing | None:
    """The first swing that the scene measures, or the usual one, of the same robots; None where the load stays.

    Args:
        play: lost motion of the train.
        robots: with their own means.
        batch: mean of what is compensated, by method [arcmin].
    """
    found = play.swing()
    if found is None:
        return None
    lost = found.lost(tuple(batch), robots.count)
    seated = robots.seated & ~np.any([np.isnan(values).any(axis=1) for values in lost.values()], axis=0)
    return Swing(
        measure=found.measure.name,
        output=found.output,
        turned=found.turned,
        jumps=found.jumps,
        curves={
            name: _curves(found, name, lost[name][seated], robots.own[name][seated], batch[name]) for name in batch
        },
        flanks=dict(found.flanks()),
    )


def _curves(swing: TrainSwing, method: str, lost: Array, own: Array, batch: float) -> Mapping[State, Array]:
    """Tip errors [mm] of lost motions (robots, positions) [arcmin], less the motor's correction."""
    return {
        "before": swing.tip_error(method, lost),
        "batch": swing.tip_error(method, lost - batch),
        "robot": swing.tip_error(method, lost - own[:, None]),
    }
