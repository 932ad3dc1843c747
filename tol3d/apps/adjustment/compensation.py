"""Compensation of lost motion by the motor when the load changes side: its size, the remaining error, a tip's swing.

If the load on a train changes side, the train goes over to the other flanks and its output turns by the lost motion.
The motor corrects it by a turn that is known beforehand: by the mean of the batch, or by the robot's own mean. If only
the maximum of a reducer is known, its lost motion remains whole, as in Jiang et al. 2024, section 4.

Angles here are in minutes of arc and tips in mm, as in columns and in summary.json.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.apps.adjustment.robots import Robots, State, left_of_the_mean, simulated_robots
from tol3d.errors import InputError
from tol3d.gearing import AnyStage, Ends, Train, TrainPlay, TrainSwing, gears_alone, shafts_in_bores, trains_of
from tol3d.gears import Flank
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene, hint
from tol3d.simulate import Overrides, simulation_of
from tol3d.study import AS_WRITTEN, Simulation
from tol3d.units import ARCMIN


@dataclass(frozen=True)
class Correction:
    """The motor's correction by one column: a method, the closed form or a publication; None for missing values.

    Args:
        means: mean lost motion of each compensated link, at its driven shaft [arcmin].
        motor: turn of the motor that corrects all of them [arcmin].
        before: sum of the highs (mean + 3 sigma) of all stages, at the shaft that is read [arcmin].
        left: the same after the correction: highs less means, and uncompensated highs whole [arcmin].
        left_of: high less mean of each compensated link, at its driven shaft [arcmin].
    """

    means: Mapping[str, float | None]
    motor: float | None
    before: float | None
    left: float | None
    left_of: Mapping[str, float | None]


def corrections_of(
    play: TrainPlay, compensated: Sequence[AnyStage], robots: Robots
) -> Iterator[tuple[str, Correction]]:
    """Corrections by column: the closed form, each method, and every publication of all links of the train."""
    for column, ends in play.ends(robots.played):
        yield column, _correction(play, compensated, ends)


def _correction(play: TrainPlay, compensated: Sequence[AnyStage], ends: Mapping[str, Ends]) -> Correction:
    means = {stage.link: ends[stage.link].mean for stage in compensated}
    turns = {stage.link: play.motor_turns(stage) for stage in compensated}
    highs = [(stage.factor, ends[stage.link].high_3sigma) for stage in play.stages]
    corrected = [(stage.factor, means[stage.link] if stage in compensated else 0.0) for stage in play.stages]
    before, correction = _total(highs), _total(corrected)
    return Correction(
        means=means,
        motor=_total([(turns[link], mean) for link, mean in means.items()]),
        before=before,
        left=None if before is None or correction is None else before - correction,
        left_of={link: _total([(1.0, ends[link].high_3sigma), (-1.0, mean)]) for link, mean in means.items()},
    )


def _total(parts: Sequence[tuple[float, float | None]]) -> float | None:
    """Sum of factor times value; None if a value is missing."""
    known = [factor * value for factor, value in parts if value is not None]
    return sum(known) if len(known) == len(parts) else None


def at_shaft(compensated: Sequence[AnyStage], correction: Correction) -> float:
    """Turn of the output shaft due to the motor's correction [arcmin]."""
    return _total([(stage.factor, correction.means[stage.link]) for stage in compensated]) or 0.0


@dataclass(frozen=True, eq=False)
class Swing:
    """Errors of the tip over the output's angles.

    Args:
        measure: name of the scene's measure.
        output: the output's angles [rad], (positions,).
        turned: True where the load acts on the other side than at the start, (positions,).
        jumps: the output's angles at which the load changes side [rad].
        curves: signed error of the tip by method and state, (robots, positions) [mm].
        flanks: by mesh from the held shaft on: the driver's working flank at the start, and after a change.
    """

    measure: str
    output: Array
    turned: NDArray[np.bool_]
    jumps: tuple[float, ...]
    curves: Mapping[str, Mapping[State, Array]]
    flanks: Mapping[str, tuple[Flank, Flank]]

    @property
    def first_turned(self) -> int:
        """Index of the first position after the first change of side."""
        return int(np.argmax(self.turned))


def swing_of(play: TrainPlay, robots: Robots, batch: Mapping[str, float]) -> Swing | None:
    """The first swing that the scene measures, or the usual one, of the same robots; None if the load keeps its side.

    Args:
        play: lost motion of the train.
        robots: with their own means.
        batch: mean of the compensated lost motion, by method [arcmin].
    """
    swing = play.swing()
    if swing is None:
        return None
    lost = swing.lost(tuple(batch), robots.count)
    seated = robots.seated & ~np.any([np.isnan(values).any(axis=1) for values in lost.values()], axis=0)
    return Swing(
        measure=swing.measure.name,
        output=swing.output,
        turned=swing.turned,
        jumps=swing.jumps,
        curves={
            name: _curves(swing, name, lost[name][seated], robots.own[name][seated], batch[name]) for name in batch
        },
        flanks=dict(swing.flanks()),
    )


def _curves(swing: TrainSwing, method: str, lost: Array, robot: Array, batch: float) -> Mapping[State, Array]:
    """Tip errors [mm] by lost motions (robots, positions) [arcmin], less the correction by batch or robot (robots,)."""
    return {
        "before": swing.tip_error(method, lost),
        "batch": swing.tip_error(method, lost - batch),
        "robot": swing.tip_error(method, lost - robot[:, None]),
    }


Unit = Literal["mm", "arcmin"]

MOST_ROBOTS: Final = 2000  # unless a number is stated
POSITIONS: Final = 16  # for a robot's own mean, by default


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
    """Signed error of each assembled robot at a random position, by state, (robots,).

    Args:
        angles: errors of the shaft that is read [arcmin].
        tips: errors of the arm's tip [mm]; empty without an arm.
    """

    angles: Mapping[State, Array]
    tips: Mapping[State, Array]

    def in_unit(self, unit: Unit) -> Mapping[State, Array]:
        """Errors in a unit: of tips in mm, of the shaft in minutes of arc."""
        return self.tips if unit == "mm" else self.angles


@dataclass(frozen=True, eq=False)
class Compensation:
    """Result of a compensation analysis.

    Args:
        name: of the scene's file, without its extension.
        play: the compensated lost motion, of the train whose motor is corrected.
        compensated, left_out: stages whose mean is known, and those of which only the maximum is known.
        positions: number of positions over which a robot's own mean was taken.
        corrections: by column: methods, the closed form and publications.
        remaining: errors by method.
        form_sigmas: sigma of the error at the shaft by the closed form [arcmin], by state; empty without one.
        swing: errors of the tip over a swing; None if the load keeps its side.
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
        """The leading method: the 3D simulation if there is one."""
        return "geometric" if "geometric" in self.remaining else "analytic"

    @property
    def units(self) -> tuple[Unit, ...]:
        """Units in which the error is known: mm of the tip if there is an arm, and minutes of arc of the shaft."""
        return ("mm", "arcmin") if self.play.tip else ("arcmin",)

    @property
    def lever(self) -> float | None:
        """Lever arm of the tip [mm]; None without an arm."""
        tip = self.play.tip
        return tip.tip.lever if tip and tip.tip else None


def compensation(
    scene: Scene, question: CompensationQuestion = CompensationQuestion(), overrides: Overrides = AS_WRITTEN
) -> Compensation:
    """Correction of the motor when the load changes side, and the remaining error.

    Args:
        scene: from `load`.
        question: options of the analysis.
        overrides: values that replace those of the scene's study.

    Raises:
        InputError: no such train, no link in it, or shafts in bores that deviate, too.
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


# simulation ---------------------------------------------------------------------------------------


def _simulation_of(scene: Scene, question: CompensationQuestion, overrides: Overrides) -> Simulation:
    """The scene's simulation with a trial per robot: the number asked for, or the study's up to MOST_ROBOTS."""
    if question.robots is not None:
        return simulation_of(scene, replace(overrides, trials=question.robots))
    simulation = simulation_of(scene, overrides)
    study = simulation.study
    if study.trials <= MOST_ROBOTS and not study.until:
        return simulation
    most = max(study.replicates, MOST_ROBOTS - MOST_ROBOTS % study.replicates)
    return simulation_of(scene, replace(overrides, trials=min(study.trials, most)))


def _of_gears(scene: Scene, simulation: Simulation) -> Simulation:
    """The simulation of a machine's gears alone, whose lost motions are the same, because nothing else acts on them.

    Raises:
        SceneError: the shafts of the gears lie in bores, which deviate, too.
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
    """The lost motion at a random position, read as by a measure of the train, or else at its output."""
    play = TrainPlay.of(scene, simulation, train)
    if not play.stages:
        words = f"nothing to compensate: there is no link between {train.held!r} and {play.shaft!r}"
        raise scene.refuse(("moves", train.name), words)
    return play


# remaining error ----------------------------------------------------------------------------------


def _remaining(play: TrainPlay, robots: Robots, method: str, batch: float) -> Remaining:
    angles = robots.errors(method, batch)
    if play.tip is None:
        return Remaining(angles, {})
    return Remaining(angles, {state: play.tip_error(method, angle) for state, angle in angles.items()})


def _form_sigmas(play: TrainPlay, positions: int) -> Mapping[State, float]:
    """Sigma of the remaining error by the closed form [arcmin].

    A robot's own mean removes all that is constant within a robot. Deviations that turn with a gear remain, and so does
    the error of the own mean, because P positions do not average them out.
    """
    if play.form is None:
        return {}
    turning = sum(variance * (1 + left_of_the_mean(turns, positions)) for variance, turns in play.turning_variances())
    whole = play.form.sigma * ARCMIN
    return {"before": whole, "batch": whole, "robot": float(np.sqrt(turning)) * ARCMIN}
