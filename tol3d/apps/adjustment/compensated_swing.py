"""A tip over the swing of its arm: its error with and without the motor's correction, and which flanks work."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.apps.adjustment.robots import Robots, State
from tol3d.gearing.meshing.backlash import moved
from tol3d.gearing.model import LostMotion, Measure, Model, Train
from tol3d.gearing.model.train_measures import load_changes, over_swing
from tol3d.gearing.model.trains import gravity_torque, loaded_flank
from tol3d.gearing.stack_up import first_order
from tol3d.gearing.system import gear_model
from tol3d.gears import Flank, opposite
from tol3d.numerics.arrays import Array
from tol3d.study import Simulation, drawn
from tol3d.study.columns import columns_of
from tol3d.system.method import Method
from tol3d.system.outcome import value_column
from tol3d.units import ARCMIN

USUAL_REACH: Final = math.pi / 3
USUAL_POSITIONS: Final = 25


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


def swings_of(model: Model, train: Train) -> Iterator[tuple[Measure, LostMotion]]:
    """The measures of a train's tip over a swing."""
    for measure in model.measures:
        kind = measure.kind
        if isinstance(kind, LostMotion) and (kind.train, kind.quantity) == (train.name, "tip_error"):
            yield measure, kind


def usual_swing(model: Model, train: Train) -> tuple[Measure, LostMotion] | None:
    """Swing to both sides of the load change next to 0; None without gravity or a tip on the output."""
    kinds = [measure.kind for measure in model.measures if isinstance(measure.kind, LostMotion)]
    own = [kind for kind in kinds if (kind.train, kind.shaft) == (train.name, train.output)]
    plain = next((kind for kind in own if kind.tip), None)
    changes = [*load_changes(model, train, (-math.pi, math.pi))]
    if plain is None or plain.tip is None or not changes:
        return None
    middle = min(changes, key=abs)
    shown = tuple(np.linspace(middle - USUAL_REACH, middle + USUAL_REACH, USUAL_POSITIONS).tolist())
    measure = over_swing(model, train, plain, shown, f"{plain.tip.point} of {plain.tip.arm} over the swing")
    return (measure, measure.kind) if isinstance(measure.kind, LostMotion) else None


def swing_of(
    simulation: Simulation, method: Method | None, train: Train, robots: Robots, batch: Mapping[str, float]
) -> Swing | None:
    """The first swing that the scene measures, or the usual one, of the same robots; None where the load stays.

    Args:
        simulation, method: the scene's; no method for an analytic study.
        train: which.
        robots: with their own means.
        batch: mean of what is compensated, by method [arcmin].
    """
    model = gear_model(simulation.system)
    found = next(swings_of(model, train), None) or usual_swing(model, train)
    if found is None or not any(found[1].turned):
        return None
    measure, kind = found
    angle = replace(kind, quantity="lost_motion", tip=None, turned=())
    own = replace(measure, name=f"lost motion of {measure.name}", kind=angle)
    columns = columns_of(simulation.system, method, drawn(simulation, 0, robots.count), (own,))
    lost = {name: np.asarray(columns[value_column(name, own.name)], dtype=np.float64) for name in batch}
    seated = robots.seated & ~np.any([np.isnan(values).any(axis=1) for values in lost.values()], axis=0)
    return Swing(
        measure=measure.name,
        output=np.array(measure.positions.shown),
        turned=np.array(kind.turned),
        jumps=kind.changes,
        curves={name: _curves(kind, name, lost[name][seated], robots.own[name][seated], batch[name]) for name in batch},
        flanks=dict(_flanks(model, train, kind, measure.positions.shown)),
    )


def _curves(kind: LostMotion, method: str, lost: Array, own: Array, batch: float) -> Mapping[State, Array]:
    """Tip errors [mm] of lost motions (robots, positions) [arcmin], less the motor's correction."""
    return {
        "before": tip_error(kind, method, lost),
        "batch": tip_error(kind, method, lost - batch),
        "robot": tip_error(kind, method, lost - own[:, None]),
    }


def tip_error(kind: LostMotion, method: str, angle: Array) -> Array:
    """The tip's error [mm] by the remaining lost motion [arcmin], as each method sees a tip move."""
    return first_order(kind, angle / ARCMIN) if method == "analytic" else moved(kind, angle / ARCMIN)


def _flanks(
    model: Model, train: Train, kind: LostMotion, shown: tuple[float, ...]
) -> Iterator[tuple[str, tuple[Flank, Flank]]]:
    """Working flanks under the load where the swing begins, and on its other side."""
    loaded = next(angle for angle in shown if gravity_torque(train, model.layout, model.arms, angle))
    for stage in kind.singles:
        if stage.backlash is not None:
            flank = loaded_flank(model.mesh(stage.link), train, model.layout, model.arms, loaded)
            yield stage.link, (flank, opposite(flank))
