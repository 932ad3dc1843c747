"""Lost motion of a train of a simulated scene, for applications: its stages, many positions of a trial, tip and swing.

Angles are in minutes of arc and tips in mm, as in columns and in summary.json.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.engines.gaps import STATUSES
from tol3d.gearing.meshing.seats import moved
from tol3d.gearing.model import Backlash, LostMotion, Measure, Model, Positions
from tol3d.gearing.model.measure import AnyStage, ParallelStage
from tol3d.gearing.model.mesh_measures import reader_like, refuse_idle_teeth
from tol3d.gearing.model.train_measures import load_changes, lost_motion, over_swing
from tol3d.gearing.model.trains import gravity_torque, loaded_flank
from tol3d.gearing.play.play import breakdowns_of, stages_of
from tol3d.gearing.shafts import Train
from tol3d.gearing.stack_up import closed_form, first_order
from tol3d.gearing.summary.train_sections import train_sections
from tol3d.gearing.summary.types import Ends
from tol3d.gearing.system import GearSystem, gear_model
from tol3d.gears import Flank
from tol3d.gears.flank import opposite
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.study.results.task import materials_of, method_of
from tol3d.study.runs.summary.values import made
from tol3d.study.system.breakdown import Breakdown
from tol3d.study.system.closed_form import ClosedForm
from tol3d.study.system.method import Method
from tol3d.study.system.outcome import METHODS, SEATED, Columns, status_column, value_column
from tol3d.study.system.system import System
from tol3d.study.system.taken import ROWS_AT_ONCE
from tol3d.study.system.trials import Trials
from tol3d.study.tallies.tally import pooled_terms
from tol3d.study.trials.columns import columns_of
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.simulation import Simulation
from tol3d.units import ARCMIN

CLOSED_FORM: Final = "closed form"
USUAL_REACH: Final = math.pi / 3
USUAL_POSITIONS: Final = 25

Shares = Callable[[str, int, int], Array]
"""From a drive's name, a first trial and a number of trials to shares of the long period, (trials, positions)."""


@dataclass(frozen=True, eq=False)
class TrainPlay:
    """Lost motion of a train at a position at random, read where and as the scene's first such measure is.

    Args:
        simulation: of the scene's gears.
        train: of those of `trains_of`.
        measure: the lost motion, in minutes of arc.
        tip: point that it moves; None without an arm.
    """

    simulation: Simulation
    train: Train
    measure: Measure
    tip: LostMotion | None

    @classmethod
    def of(cls, scene: Scene, simulation: Simulation, train: Train) -> "TrainPlay":
        """That of a train.

        Raises:
            SceneError: one tooth is to be read where its flanks are not both in action.
        """
        model = gear_model(simulation.system)
        swing = next((kind for _, kind in _swings_of(model, train)), None)
        tip = swing or _kind(model, train, "tip_displacement")
        like = tip or _kind(model, train, "lost_motion")
        kind = lost_motion(model, train, like.shaft if like else train.output, "lost_motion", reader_like(like))
        measure = Measure(f"lost motion of {train.name}", kind, Positions("random", 1, 1), "value")
        refuse_idle_teeth(scene, ("moves", train.name), measure, model)
        return cls(simulation, train, measure, tip)

    @property
    def model(self) -> Model:
        """Parts, meshes and measures of the scene."""
        return gear_model(self.simulation.system)

    @property
    def shaft(self) -> str:
        """The shaft that is read."""
        return self.measure.kind.shaft if isinstance(self.measure.kind, LostMotion) else self.train.output

    @property
    def stages(self) -> tuple[AnyStage, ...]:
        """Links between the held shaft and the one that is read; none where these are one."""
        return stages_of(self.measure)

    def is_drawn(self, stage: AnyStage) -> bool:
        """True if the play of a stage is drawn; of a reducer without a law only the maximum is known."""
        contributors = self.model.contributors
        return stage.backlash is not None or any(contributor.effect.acts_on(stage.link) for contributor in contributors)

    def motor_turns(self, stage: AnyStage) -> float:
        """Turns of the motor for a turn of the shaft that a stage drives."""
        layout = self.model.layout
        if isinstance(stage, ParallelStage):
            driven = stage.last
        else:
            driven = next(link.driven for link in layout.links if link.name == stage.link)
        return abs(float(layout.ratio(self.train.driven, driven)))

    def tip_error(self, method: str, angle: Array) -> Array:
        """Error of the tip [mm] by a lost motion [arcmin], as each method sees a tip move; without one none."""
        return np.zeros(0) if self.tip is None else _tip_error(replace(self.tip, turned=()), method, angle)

    @property
    def published_tips(self) -> Mapping[str, Mapping[str, float]]:
        """Published displacements of the tip [mm], by column."""
        own = self.tip and self.tip.tip
        alike = [
            measure.name
            for measure in self.model.measures
            if own and isinstance(measure.kind, LostMotion) and measure.kind.quantity == "tip_displacement"
            if measure.kind.train == self.train.name and measure.kind.tip == own
        ]
        published = self.simulation.published
        return {column: own[name].internal for column, own in published.items() for name in alike if name in own}

    # trials -------------------------------------------------------------------------------------------

    def played(self, positions: int, shares: Shares) -> "Played":
        """Lost motions of the study's trials, each at further positions and last at its own.

        Args:
            positions: number of the further ones.
            shares: gives them, as shares of each drive's long period.
        """
        at_once, trials = max(1, ROWS_AT_ONCE // (positions + 1)), self.simulation.study.trials
        pieces = [
            self._columns(first, min(at_once, trials - first), positions, shares) for first in range(0, trials, at_once)
        ]
        (breakdown,) = self._alone.system.breakdowns
        return Played(breakdown, {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]})

    def _columns(self, first: int, count: int, positions: int, shares: Shares) -> Columns:
        layout, own = self.model.layout, drawn(self._alone, first, count)
        angles: dict[str, Array] = {}
        for drive in layout.drives:
            root = 2 * math.pi * float(drive.turns) * shares(drive.name, first, count)
            for mesh in drive.moves:
                turning = layout.mesh_turn[mesh]
                spread = turning.offset + float(turning.rate) * root
                angles[mesh] = np.concatenate([spread, own.positions[mesh][:, None]], axis=1).ravel()
        trials = Trials(np.repeat(own.deviations, positions + 1, axis=0), angles)
        columns = columns_of(self._alone.system, self._method, trials)
        return {name: values.reshape(count, positions + 1) for name, values in columns.items()}

    @cached_property
    def _alone(self) -> Simulation:
        """The simulation of this measure and no other."""
        return replace(self.simulation, system=GearSystem(replace(self.model, measures=(self.measure,))))

    @cached_property
    def _method(self) -> Method | None:
        return method_of(self._alone, materials_of(self._alone))

    # ends of its stages -------------------------------------------------------------------------------

    def ends(self, played: "Played") -> Iterator[tuple[str, Mapping[str, Ends]]]:
        """Means and highs of each stage by its link: by the closed form, by each method, and as published.

        Of publications those that have all meshes of the train. The closed form is there if all stages have one.
        """
        model = self.model
        of_meshes = [
            measure for measure in model.measures if isinstance(measure.kind, Backlash)
        ]  # what others published of them
        known_of = replace(model, measures=(self.measure, *of_meshes))
        breakdowns = breakdowns_of(replace(model, measures=(self.measure,)))
        pooled = pooled_terms(breakdowns, STATUSES, {name: own[:, -1] for name, own in played.columns.items()})
        summary = train_sections(known_of, pooled, self.simulation.published)[self.train.name]
        forms = {stage.link: self._form_of(stage) for stage in self.stages}
        known_forms = {link: form for link, form in forms.items() if form is not None}
        if len(known_forms) == len(forms):
            yield CLOSED_FORM, known_forms
        for method in played.methods:
            yield method, {stage.link: stage.methods.by(method) for stage in summary.stages}
        meshes = [stage for stage in summary.stages if stage.gears]
        for column in summary.sums.published:
            if all(column in stage.published for stage in meshes):
                yield (
                    column,
                    {stage.link: stage.published.get(column, stage.methods.analytic) for stage in summary.stages},
                )

    def _form_of(self, stage: AnyStage) -> Ends | None:
        """A stage's own lost motion by the closed form [arcmin]; None where it has none."""
        if not isinstance(self.measure.kind, LostMotion):
            raise TypeError(f"{self.measure.name} has no stages")
        alone = replace(self.measure, kind=replace(self.measure.kind, stages=(replace(stage, factor=1.0),)))
        form = closed_form(self.model, alone)
        if form is None:
            return None
        return made(Ends, mean=form.mean * ARCMIN, high_3sigma=(form.mean + 3 * form.sigma) * ARCMIN)

    @cached_property
    def form(self) -> ClosedForm | None:
        """Closed form of the lost motion [rad]; None where it has none."""
        return closed_form(self.model, self.measure)

    def turning_variances(self) -> Iterator[tuple[float, float]]:
        """Variances by the closed form of errors that turn with a gear [rad²], with its turns in the long period."""
        shares = {} if self.form is None else {share.name: share for share in self.form.shares}
        layout = self.model.layout
        for contributor in self.model.contributors:
            gear = contributor.effect.turns_with
            if contributor.name in shares and gear is not None:
                shaft = layout.carrying[gear][0]
                drive = next(drive for drive in layout.drives if drive.root == layout.root_of[shaft])
                turns = abs(float(layout.shaft_turn[shaft].rate * drive.turns))
                yield shares[contributor.name].variance, turns

    # a swing ------------------------------------------------------------------------------------------

    def swing(self) -> "TrainSwing | None":
        """The first swing of its tip that the scene measures, or to both sides of a change of the load.

        None without gravity or a tip on the output, and where the load stays on one side.
        """
        found = next(_swings_of(self.model, self.train), None) or self._usual_swing()
        return None if found is None or not any(found[1].turned) else TrainSwing(self, *found)

    def _usual_swing(self) -> tuple[Measure, LostMotion] | None:
        """Swing to both sides of the load change next to 0."""
        model, train = self.model, self.train
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


@dataclass(frozen=True, eq=False)
class Played:
    """Lost motions of trials, each at further positions and last at its own.

    Args:
        breakdown: the lost motion and its stages.
        columns: by the names of a run's columns, each (trials, positions + 1).
    """

    breakdown: Breakdown
    columns: Columns

    @property
    def methods(self) -> tuple[str, ...]:
        """Methods by which they are: both, or the analytic one."""
        return tuple(method for method in METHODS if value_column(method, self.breakdown.measure) in self.columns)

    @property
    def seated(self) -> NDArray[np.bool_]:
        """Which trials could be assembled at every position, (trials,); all of an analytic study."""
        status = self.columns.get(status_column(self.breakdown.measure))
        if status is None:
            return np.ones(len(next(iter(self.columns.values()))), bool)
        return np.asarray(np.all(status == SEATED, axis=1))

    def lost(self, method: str) -> Array:
        """Lost motions at the shaft that is read [arcmin], (trials, positions + 1)."""
        return self.columns[value_column(method, self.breakdown.measure)].astype(np.float64)

    def of_stage(self, method: str, stage: AnyStage) -> Array:
        """A stage's own lost motions at the shaft that it drives [arcmin], (trials, positions + 1)."""
        return self.columns[self.breakdown.column(method, stage.link)].astype(np.float64)


@dataclass(frozen=True, eq=False)
class TrainSwing:
    """A swing of a train's tip, over which gravity changes side.

    Args:
        play: of the train.
        measure, kind: error of the tip over the swing.
    """

    play: TrainPlay
    measure: Measure
    kind: LostMotion

    @property
    def output(self) -> Array:
        """The output's angles [rad], (positions,)."""
        return np.array(self.measure.positions.shown)

    @property
    def turned(self) -> NDArray[np.bool_]:
        """True at positions where the load acts on the other side than at the start, (positions,)."""
        return np.array(self.kind.turned)

    @property
    def jumps(self) -> tuple[float, ...]:
        """The output's angles where it changes side [rad]."""
        return self.kind.changes

    def lost(self, methods: tuple[str, ...], trials: int) -> Mapping[str, Array]:
        """Lost motions of the study's first trials by method [arcmin], (trials, positions)."""
        angle = replace(self.kind, quantity="lost_motion", tip=None, turned=())
        own = replace(self.measure, name=f"lost motion of {self.measure.name}", kind=angle)
        simulation = self.play.simulation
        columns = columns_of(simulation.system, self.play._method, drawn(simulation, 0, trials), (own,))
        return {name: np.asarray(columns[value_column(name, own.name)], dtype=np.float64) for name in methods}

    def tip_error(self, method: str, angle: Array) -> Array:
        """Error of the tip [mm] by lost motions (trials, positions) [arcmin], as each method sees a tip move."""
        return _tip_error(self.kind, method, angle)

    def flanks(self) -> Iterator[tuple[str, tuple[Flank, Flank]]]:
        """By mesh the driver's working flank under the load where the swing begins, and on its other side."""
        model, train = self.play.model, self.play.train
        shown = self.measure.positions.shown
        loaded = next(angle for angle in shown if gravity_torque(train, model.layout, model.arms, angle))
        for stage in self.kind.singles:
            if stage.backlash is not None:
                flank = loaded_flank(model.mesh(stage.link), train, model.layout, model.arms, loaded)
                yield stage.link, (flank, opposite(flank))


def trains_of(system: System) -> Mapping[str, Train]:
    """Trains of a system of gears by name.

    Raises:
        InputError: the system is another one.
    """
    return {train.name: train for train in gear_model(system).trains}


def gears_alone(simulation: Simulation) -> Simulation:
    """The simulation of a machine's gears; their lost motions are the same if no shaft of theirs lies in bores."""
    gears = getattr(simulation.system, "gears", None)
    return replace(simulation, system=gears) if isinstance(gears, GearSystem) else simulation


def shafts_in_bores(system: System) -> tuple[tuple[str, str], ...]:
    """Moves that lay a machine's shafts in bores, and these shafts."""
    bores: Any = getattr(system, "bores", None)
    return () if bores is None else tuple((shaft.move, shaft.shaft) for shaft in bores.shafts)


def _kind(model: Model, train: Train, quantity: str) -> LostMotion | None:
    """The train's first measure of a quantity."""
    kinds = (measure.kind for measure in model.measures)
    own = (kind for kind in kinds if isinstance(kind, LostMotion) and kind.train == train.name)
    return next((kind for kind in own if kind.quantity == quantity), None)


def _swings_of(model: Model, train: Train) -> Iterator[tuple[Measure, LostMotion]]:
    """The measures of a train's tip over a swing."""
    for measure in model.measures:
        kind = measure.kind
        if isinstance(kind, LostMotion) and (kind.train, kind.quantity) == (train.name, "tip_error"):
            yield measure, kind


def _tip_error(kind: LostMotion, method: str, angle: Array) -> Array:
    return first_order(kind, angle / ARCMIN) if method == "analytic" else moved(kind, angle / ARCMIN)
