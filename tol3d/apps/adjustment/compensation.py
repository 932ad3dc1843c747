"""The motor's correction when the load changes side: its size, the remaining lost motion, and a tip over its swing.

A train whose load changes side goes over to the other flanks, and its output turns by the lost motion. The motor makes
good for it by a turn that is known beforehand: that of the batch's mean builds, or of this robot's own mean. A reducer
of which only the maximum is known is left out of it, as in Jiang et al. 2024, section 4; it remains whole.

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
        means: each compensated link's own lost motion, at its driven shaft [arcmin].
        motor: turn of the motor that makes good for them together [arcmin].
        before: sum of all stages' highs at the shaft that is read [arcmin].
        left: sum of the excess of their highs over their means, and of the uncompensated highs [arcmin].
        left_of: excess of each compensated link's own high over its mean, at its driven shaft [arcmin].
    """

    means: Mapping[str, float | None]
    motor: float | None
    before: float | None
    left: float | None
    left_of: Mapping[str, float | None]


def corrections_of(
    play: TrainPlay, compensated: Sequence[AnyStage], robots: Robots
) -> Iterator[tuple[str, Correction]]:
    """Corrections by the closed form, by each method, and by every publication of all meshes of the train."""
    for column, ends in play.ends(robots.played):
        yield column, _correction(play, compensated, ends)


def _correction(play: TrainPlay, compensated: Sequence[AnyStage], ends: Mapping[str, Ends]) -> Correction:
    means = {stage.link: ends[stage.link].mean for stage in compensated}
    turns = {stage.link: play.motor_turns(stage) for stage in compensated}
    highs = [(stage.factor, ends[stage.link].high_3sigma) for stage in play.stages]
    kept = [(stage.factor, 0.0 if stage not in compensated else means[stage.link]) for stage in play.stages]
    before, known = _total(highs), _total(kept)
    return Correction(
        means=means,
        motor=_total([(turns[link], mean) for link, mean in means.items()]),
        before=before,
        left=None if before is None or known is None else before - known,
        left_of={link: _total([(1.0, ends[link].high_3sigma), (-1.0, mean)]) for link, mean in means.items()},
    )


def _total(parts: Sequence[tuple[float, float | None]]) -> float | None:
    """The sum of factor times value; None where a value is missing."""
    known = [factor * value for factor, value in parts if value is not None]
    return sum(known) if len(known) == len(parts) else None


def at_shaft(compensated: Sequence[AnyStage], correction: Correction) -> float:
    """Turn of the output shaft due to the motor's correction [arcmin]."""
    return _total([(stage.factor, correction.means[stage.link]) for stage in compensated]) or 0.0


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
