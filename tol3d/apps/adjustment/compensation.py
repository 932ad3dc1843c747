"""The motor's correction when the load changes side: its size, and the remaining lost motion.

A train whose load changes side goes over to the other flanks, and its output turns by the lost motion. The motor makes
good for it by a turn that is known beforehand: that of the batch's mean builds, or of this robot's own mean. A reducer
of which only the maximum is known is left out of it, as in Jiang et al. 2024, section 4; it remains whole.

Angles here are in minutes of arc and tips in mm, as in columns and in summary.json.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, Literal

import numpy as np

from tol3d.apps.adjustment.compensated_swing import Swing, swing_of
from tol3d.apps.adjustment.correction import Correction, at_shaft, corrections_of
from tol3d.apps.adjustment.robots import Robots, State, left_of_the_mean, simulated_robots
from tol3d.errors import InputError
from tol3d.gearing import AnyStage, Train, TrainPlay, gears_alone, shafts_in_bores, trains_of
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene, hint
from tol3d.simulate import Overrides, simulation_of
from tol3d.study import AS_WRITTEN, Simulation
from tol3d.units import ARCMIN

Unit = Literal["mm", "arcmin"]

MOST_ROBOTS: Final = 2000  # where nobody says how many
POSITIONS: Final = 16


@dataclass(frozen=True)
class CompensationQuestion:
    """Options of a compensation analysis.

    Args:
        train: name of the train; None is the scene's first.
        positions: number of positions over which a robot's own mean is taken.
        robots: number drawn; None is the study's number of trials, MOST_ROBOTS at most.
    """

    train: str | None = None
    positions: int = POSITIONS
    robots: int | None = None


@dataclass(frozen=True, eq=False)
class Remaining:
    """Signed error of each robot at a random position that a method leaves, (robots,) by state.

    Args:
        angles: of the shaft that is read [arcmin].
        tips: of the arm's point [mm]; empty without an arm.
    """

    angles: Mapping[State, Array]
    tips: Mapping[State, Array]

    def in_unit(self, unit: Unit) -> Mapping[State, Array]:
        """Errors of the unit: tips are in mm, turns in minutes of arc."""
        return self.tips if unit == "mm" else self.angles


@dataclass(frozen=True, eq=False)
class Compensation:
    """The answer for a scene.

    Args:
        name: of the scene's file.
        play: the lost motion that is compensated, of the train whose motor is corrected.
        compensated, left_out: the stages whose mean is known, and those of which only the maximum is.
        positions: number of positions over which a robot's own mean was taken.
        corrections: by column; methods, the closed form and who published.
        remaining: by method.
        form_sigmas: of the error at the shaft by the closed form [arcmin], by state; empty where there is none.
        swing: the tip over the swing; None where the scene measures none.
        robots, failed: number drawn, and number of these that could not be assembled.
    """

    name: str
    play: TrainPlay
    compensated: tuple[AnyStage, ...]
    left_out: tuple[AnyStage, ...]
    positions: int
    corrections: Mapping[str, Correction]
    remaining: Mapping[str, Remaining]
    form_sigmas: Mapping[State, float]
    swing: Swing | None
    robots: int
    failed: int

    @property
    def method(self) -> str:
        """The leading method: the 3D simulation where there is one."""
        return "geometric" if "geometric" in self.remaining else "analytic"

    @property
    def units(self) -> tuple[Unit, ...]:
        """Units in which the error is known: of the tip if there is an arm, and of the turn."""
        return ("mm", "arcmin") if self.play.tip else ("arcmin",)

    @property
    def lever(self) -> float | None:
        """Lever arm of the tip [mm]."""
        tip = self.play.tip
        return tip.tip.lever if tip and tip.tip else None


def compensation(
    scene: Scene, question: CompensationQuestion = CompensationQuestion(), overrides: Overrides = AS_WRITTEN
) -> Compensation:
    """Correction of the motor when the load changes side, and the remaining error.

    Args:
        scene: as `load` gives it.
        question: options of the analysis.
        overrides: values that replace those of the scene's study.

    Raises:
        InputError: no such train, or no link in it.
    """
    simulation = _of_gears(scene, _simulation_of(scene, question, replace(overrides, witness=0)))
    play = _play_of(scene, simulation, _train_of(scene, simulation, question.train))
    compensated = tuple(stage for stage in play.stages if play.is_drawn(stage))
    robots = simulated_robots(play, compensated, question.positions)
    corrections = dict(corrections_of(play, compensated, robots))
    batch = {name: at_shaft(compensated, corrections[name]) for name in robots.lost}
    return Compensation(
        name=Path(scene.source).stem,
        play=play,
        compensated=compensated,
        left_out=tuple(stage for stage in play.stages if stage not in compensated),
        positions=question.positions,
        corrections=corrections,
        remaining={name: _remaining(play, robots, name, batch[name]) for name in batch},
        form_sigmas=_form_sigmas(play, question.positions),
        swing=swing_of(play, robots, batch),
        robots=robots.count,
        failed=int(np.sum(~robots.seated)),
    )


# what is asked ------------------------------------------------------------------------------------


def _simulation_of(scene: Scene, question: CompensationQuestion, overrides: Overrides) -> Simulation:
    if question.robots is not None:
        return simulation_of(scene, replace(overrides, trials=question.robots))
    simulation = simulation_of(scene, overrides)
    study = simulation.study
    if study.trials <= MOST_ROBOTS and not study.until:
        return simulation
    most = max(study.replicates, MOST_ROBOTS - MOST_ROBOTS % study.replicates)
    return simulation_of(scene, replace(overrides, trials=min(study.trials, most)))


def _of_gears(scene: Scene, simulation: Simulation) -> Simulation:
    """The simulation of a machine's gears alone, whose lost motions are the same: nothing else acts on them.

    Raises:
        SceneError: the shafts of the gears lie in bores, which deviate too.
    """
    for move, shaft in shafts_in_bores(simulation.system):
        words = f"expected trains whose shafts lie in no bores, got {shaft!r} in those of a part"
        raise scene.refuse(("moves", move), f"{words}: compensation asks the gears alone")
    return gears_alone(simulation)


def _train_of(scene: Scene, simulation: Simulation, name: str | None) -> Train:
    trains = trains_of(simulation.system)
    if not trains:
        raise scene.refuse(("moves",), "expected a move of kind train, whose motor is corrected, got none")
    if name is None:
        return next(iter(trains.values()))
    if name not in trains:
        raise InputError(f"--train: expected a train of {scene.source}, got {name!r}{hint(name, trains)}")
    return trains[name]


def _play_of(scene: Scene, simulation: Simulation, train: Train) -> TrainPlay:
    """The lost motion at a random position, read where and as another measure is, or else at the train's output."""
    play = TrainPlay.of(scene, simulation, train)
    if not play.stages:
        words = f"nothing to compensate: there is no link between {train.held!r} and {play.shaft!r}"
        raise scene.refuse(("moves", train.name), words)
    return play


# what is left -------------------------------------------------------------------------------------


def _remaining(play: TrainPlay, robots: Robots, method: str, batch: float) -> Remaining:
    angles = robots.errors(method, batch)
    if play.tip is None:
        return Remaining(angles, {})
    return Remaining(angles, {state: play.tip_error(method, angle) for state, angle in angles.items()})


def _form_sigmas(play: TrainPlay, positions: int) -> Mapping[State, float]:
    """Sigma of the remaining error by the closed form [arcmin].

    A robot's own mean takes away all that stays as it is within a robot. What turns with a gear is left, and the own
    mean's error with it, for P positions do not average it out.
    """
    if play.form is None:
        return {}
    turning = sum(variance * (1 + left_of_the_mean(turns, positions)) for variance, turns in play.turning_variances())
    whole = play.form.sigma * ARCMIN
    return {"before": whole, "batch": whole, "robot": float(np.sqrt(turning)) * ARCMIN}
