"""The motor's correction when the load changes side: its size, and the remaining lost motion.

A train whose load changes side goes over to the other flanks, and its output turns by the lost motion. The motor makes
good for it by a turn that is known beforehand: that of the batch's mean builds, or of this robot's own mean. A reducer
of which only the maximum is known is left out of it, as in Jiang et al. 2024, section 4; it remains whole.

Angles here are in minutes of arc and tips in mm, as in columns and in summary.json.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, Literal

import numpy as np

from tol3d.apps.adjustment.compensated_swing import Swing, swing_of, swings_of, tip_error
from tol3d.apps.adjustment.correction import Correction, at_shaft, corrections_of
from tol3d.apps.adjustment.robots import Robots, State, left_of_the_mean, simulated_robots
from tol3d.errors import InputError
from tol3d.gearing.model import LostMotion, Measure, Model, Positions, Train
from tol3d.gearing.model.contributor import Contributor
from tol3d.gearing.model.measure import AnyStage
from tol3d.gearing.model.mesh_measures import reader_like, refuse_idle_teeth
from tol3d.gearing.model.train_measures import lost_motion
from tol3d.gearing.play.play import stages_of
from tol3d.gearing.stack_up import closed_form
from tol3d.gearing.system import GearSystem, gear_model
from tol3d.machine.system import MachineSystem
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene, hint
from tol3d.simulate import Overrides, simulation_of
from tol3d.study import Simulation
from tol3d.study.overrides import AS_WRITTEN
from tol3d.study.task import materials_of, method_of
from tol3d.system.closed_form import ClosedForm, Share
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
        simulation: the scene's.
        train: whose motor is corrected.
        measure: the lost motion that is compensated, at a random position.
        tip: point that it moves; None without an arm.
        compensated, left_out: the stages whose mean is known, and those of which only the maximum is.
        positions: number of positions over which a robot's own mean was taken.
        corrections: by column; methods, the closed form and who published.
        remaining: by method.
        form_sigmas: of the error at the shaft by the closed form [arcmin], by state; empty where there is none.
        swing: the tip over the swing; None where the scene measures none.
        robots, failed: number drawn, and number of these that could not be assembled.
    """

    name: str
    simulation: Simulation
    train: Train
    measure: Measure
    tip: LostMotion | None
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
    def model(self) -> Model:
        """Parts, meshes and measures of the scene."""
        return gear_model(self.simulation.system)

    @property
    def method(self) -> str:
        """The leading method: the 3D simulation where there is one."""
        return "geometric" if "geometric" in self.remaining else "analytic"

    @property
    def shaft(self) -> str:
        """The shaft whose lost motion is compensated."""
        return self.measure.kind.shaft if isinstance(self.measure.kind, LostMotion) else self.train.output

    @property
    def units(self) -> tuple[Unit, ...]:
        """Units in which the error is known: of the tip if there is an arm, and of the turn."""
        return ("mm", "arcmin") if self.tip else ("arcmin",)

    @property
    def lever(self) -> float | None:
        """Lever arm of the tip [mm]."""
        return self.tip.tip.lever if self.tip and self.tip.tip else None

    @property
    def published_tips(self) -> Mapping[str, Mapping[str, float]]:
        """Published displacements of the tip without compensation [mm]."""
        own = self.tip and self.tip.tip
        alike = [
            measure.name
            for measure in self.model.measures
            if own and isinstance(measure.kind, LostMotion) and measure.kind.quantity == "tip_displacement"
            if measure.kind.train == self.train.name and measure.kind.tip == own
        ]
        published = self.simulation.published
        return {column: own[name].internal for column, own in published.items() for name in alike if name in own}


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
    model = gear_model(simulation.system)
    train = _train_of(scene, model, question.train)
    tip = next((kind for _, kind in swings_of(model, train)), None) or _kind(model, train, "tip_displacement")
    measure = _measure(scene, model, train, tip or _kind(model, train, "lost_motion"))
    stages = stages_of(measure)
    compensated = tuple(stage for stage in stages if stage.backlash or _law_of(model, stage))
    alone = replace(simulation, system=GearSystem(replace(model, measures=(measure,))))
    method = method_of(alone, materials_of(alone))
    robots = simulated_robots(alone, method, measure, compensated, question.positions)
    corrections = dict(corrections_of(simulation, train, measure, compensated, robots))
    batch = {name: at_shaft(compensated, corrections[name]) for name in robots.lost}
    return Compensation(
        name=Path(scene.source).stem,
        simulation=simulation,
        train=train,
        measure=measure,
        tip=tip,
        compensated=compensated,
        left_out=tuple(stage for stage in stages if stage not in compensated),
        positions=question.positions,
        corrections=corrections,
        remaining={name: _remaining(robots, name, tip, batch[name]) for name in batch},
        form_sigmas=_form_sigmas(model, measure, question.positions),
        swing=swing_of(simulation, method, train, robots, batch),
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
    system = simulation.system
    if not isinstance(system, MachineSystem):
        return simulation
    for own in system.bores.shafts:
        words = f"expected trains whose shafts lie in no bores, got {own.shaft!r} in those of a part"
        raise scene.refuse(("moves", own.move), f"{words}: compensation asks the gears alone")
    return replace(simulation, system=system.gears)


def _train_of(scene: Scene, model: Model, name: str | None) -> Train:
    trains = {train.name: train for train in model.trains}
    if not trains:
        raise scene.refuse(("moves",), "expected a move of kind train, whose motor is corrected, got none")
    if name is None:
        return next(iter(trains.values()))
    if name not in trains:
        raise InputError(f"--train: expected a train of {scene.source}, got {name!r}{hint(name, trains)}")
    return trains[name]


def _kind(model: Model, train: Train, quantity: str) -> LostMotion | None:
    """The train's first measure of a quantity."""
    kinds = (measure.kind for measure in model.measures)
    own = (kind for kind in kinds if isinstance(kind, LostMotion) and kind.train == train.name)
    return next((kind for kind in own if kind.quantity == quantity), None)


def _measure(scene: Scene, model: Model, train: Train, like: LostMotion | None) -> Measure:
    """The lost motion at a random position, read where and as another measure is, or else at the train's output."""
    shaft = like.shaft if like else train.output
    kind = lost_motion(model, train, shaft, "lost_motion", reader_like(like))
    if not kind.stages:
        raise scene.refuse(
            ("moves", train.name), f"nothing to compensate: there is no link between {kind.held!r} and {kind.shaft!r}"
        )
    measure = Measure(f"lost motion of {train.name}", kind, Positions("random", 1, 1), "value")
    refuse_idle_teeth(scene, ("moves", train.name), measure, model)
    return measure


def _law_of(model: Model, stage: AnyStage) -> Contributor | None:
    """The contributor that draws a reducer's backlash; without one only its maximum is known."""
    return next((own for own in model.contributors if own.effect.acts_on(stage.link)), None)


# what is left -------------------------------------------------------------------------------------


def _remaining(robots: Robots, method: str, tip: LostMotion | None, batch: float) -> Remaining:
    angles = robots.errors(method, batch)
    if tip is None:
        return Remaining(angles, {})
    still = replace(tip, turned=())
    return Remaining(angles, {state: tip_error(still, method, angle) for state, angle in angles.items()})


def _form_sigmas(model: Model, measure: Measure, positions: int) -> Mapping[State, float]:
    """Sigma of the remaining error by the closed form [arcmin].

    A robot's own mean takes away all that stays as it is within a robot. What turns with a gear is left, and the own
    mean's error with it, for P positions do not average it out.
    """
    form = closed_form(model, measure)
    if form is None:
        return {}
    turning = sum(share.variance * (1 + left_of_the_mean(turns, positions)) for share, turns in _turning(model, form))
    whole = form.sigma * ARCMIN
    return {"before": whole, "batch": whole, "robot": float(np.sqrt(turning)) * ARCMIN}


def _turning(model: Model, form: ClosedForm) -> Iterator[tuple[Share, float]]:
    """The shares of errors that turn with a gear, and its turns in the long period."""
    shares = {share.name: share for share in form.shares}
    layout = model.layout
    for contributor in model.contributors:
        gear = contributor.effect.turns_with
        if contributor.name in shares and gear is not None:
            shaft = layout.carrying[gear][0]
            drive = next(drive for drive in layout.drives if drive.root == layout.root_of[shaft])
            yield shares[contributor.name], abs(float(layout.shaft_turn[shaft].rate * drive.turns))
