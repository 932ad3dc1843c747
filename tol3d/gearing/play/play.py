"""Play of a measure: its backlashes added along a train, compared where parallel load paths join.

Both methods use this module; each reads single backlashes for itself.

Where parallel load paths join, the play is the intersection of theirs.
The free turn of a shaft on one load path is an interval: from where its driven gear rests on the working flank to where
the other flank touches, links in series added up. Once the path that ends first on either side is known, all is linear
in the play of each mesh and its rest angle; so derivatives are computed like values. Load paths that share links are
compared likewise, walk by walk; each of their loops must have some play, or they bind.

Where the load changes sides, the thrust of helical teeth moves a shaft through its axial play the way it yields: what
it turns there adds to the play of the teeth; see model/slides.py.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.links.stated_link import FreeTurn, middle_of
from tol3d.gearing.model import AxialPlay, Backlash, LostMotion, Measure, Mesh, Model, Reading, TransmissionError
from tol3d.gearing.model.measure import AnyStage, Mix, ParallelStage, Slide, Stage
from tol3d.gearing.play.linked import LinkLaw, link_trials
from tol3d.numerics.arrays import Array
from tol3d.study.system.breakdown import Breakdown, SumTerm
from tol3d.study.system.trials import Trials
from tol3d.units import ARCMIN

FREE: Final = 1e-9  # rad; load paths that overlap by rounding errors do not bind each other

Variable = tuple[Stage, Literal["play", "rest"]] | tuple[str, Literal["slide"]]
VariableValues = Callable[[Variable], Array]
"""A stage's own play [rad], or the angle at which its driven gear rests [rad]; (trials, positions).

Of a link that is no mesh the middle of its free turn stands for that angle. Of a shaft that slides its axial play [mm].
"""

LinearForm = Mapping[Variable, Array]
"""Weights of the stages' plays and rests, each (trials, positions) or a scalar."""

WorkingFlank = Callable[[Stage], int | None]
"""The driven gear's flank that works in a stage; None for a link that is no mesh."""


def value(form: LinearForm, read: VariableValues) -> Array:
    """Value of a linear form [rad], (trials, positions)."""
    return np.asarray(sum(weight * read(variable) for variable, weight in form.items()))


def free_form(stage: ParallelStage, flank: WorkingFlank, read: VariableValues) -> LinearForm:
    """Play of the shaft where load paths join; below 0 they bind each other."""
    low, high = _meeting(stage, flank, read)
    free = _sum(high, _reversed(low))
    if not stage.loops and not stage.gaps:
        return free
    loops = [form for loop in stage.loops for form in _around(loop, flank, read)]
    each = [_ends_of_path(path, flank, read) for path in stage.paths] if stage.gaps else []
    loops += [_mixed(mix, each)[1] for mix in stage.gaps]
    lacking = [value(form, read) for form in loops]
    tightest = np.argmin(lacking, axis=0)
    binds = np.min(lacking, axis=0) < -FREE
    return _chosen([free, *loops], np.where(binds, 1 + tightest, 0))


def _around(loop: tuple[Stage, ...], flank: WorkingFlank, read: VariableValues) -> tuple[LinearForm, LinearForm]:
    """Play of a loop of links in either sense; below 0 it cannot be closed."""
    low, high = _ends_of_path(loop, flank, read)
    return high, _reversed(low)


def _meeting(stage: ParallelStage, flank: WorkingFlank, read: VariableValues) -> tuple[LinearForm, LinearForm]:
    """Both ends of the common play of all load paths."""
    each = [_ends_of_path(path, flank, read) for path in stage.paths]
    each = [_mixed(mix, each) for mix in stage.mixes] or each
    lows, highs = [low for low, _ in each], [high for _, high in each]
    return (
        _chosen(lows, np.argmax([value(form, read) for form in lows], axis=0)),
        _chosen(highs, np.argmin([value(form, read) for form in highs], axis=0)),
    )


def _mixed(mix: Mix, each: Sequence[tuple[LinearForm, LinearForm]]) -> tuple[LinearForm, LinearForm]:
    """Both bounds by several load paths and the shafts that slide."""
    low: LinearForm = {}
    high: LinearForm = {}
    for weight, ends in zip(mix.weights, each, strict=True):
        if weight:
            first, last = ends if weight > 0.0 else reversed(ends)
            low, high = _sum(low, _times(first, weight)), _sum(high, _times(last, weight))
    sliding: LinearForm = {(slide.shaft, "slide"): np.array(slide.factor / 2) for slide in mix.slides}
    return _sum(low, _reversed(sliding)), _sum(high, sliding)


def _times(form: LinearForm, factor: float) -> LinearForm:
    return {variable: factor * weight for variable, weight in form.items()}


def _ends_of_path(
    path: tuple[AnyStage, ...], flank: WorkingFlank, read: VariableValues
) -> tuple[LinearForm, LinearForm]:
    low: LinearForm = {}
    high: LinearForm = {}
    for stage in path:
        ends = _ends(stage, flank, read)
        low, high = _sum(low, ends[0]), _sum(high, ends[1])
    return low, high


def _ends(stage: AnyStage, flank: WorkingFlank, read: VariableValues) -> tuple[LinearForm, LinearForm]:
    """Both ends of a stage's play, at the shaft where its load paths join."""
    factor = np.array(stage.sense * stage.factor)
    if isinstance(stage, ParallelStage):
        both = tuple(
            {variable: factor * weight for variable, weight in form.items()} for form in _meeting(stage, flank, read)
        )
        return (both[0], both[1]) if stage.sense > 0 else (both[1], both[0])
    side = flank(stage)
    if side is None:
        half = np.array(stage.factor / 2)
        middle: LinearForm = {(stage, "rest"): factor} if stage.has_middle else {}
        return {**middle, (stage, "play"): -half}, {**middle, (stage, "play"): half}
    # a right flank (1) is left by a turn in the positive sense
    resting: LinearForm = {(stage, "rest"): factor}
    turned: LinearForm = {(stage, "rest"): factor, (stage, "play"): factor * side}
    return (resting, turned) if factor * side > 0.0 else (turned, resting)


def _reversed(form: LinearForm) -> LinearForm:
    return {variable: -weight for variable, weight in form.items()}


def _sum(first: LinearForm, second: LinearForm) -> LinearForm:
    zero = np.array(0.0)
    return {
        variable: np.asarray(first.get(variable, zero) + second.get(variable, zero)) for variable in {**first, **second}
    }


def _chosen(forms: list[LinearForm], which: NDArray[np.intp]) -> LinearForm:
    """Row by row one of several forms."""
    variables = dict.fromkeys(variable for form in forms for variable in form)
    zero = np.array(0.0)
    return {
        variable: np.select([which == k for k in range(len(forms))], [form.get(variable, zero) for form in forms])
        for variable in variables
    }


def clocking(model: Model, mesh: Mesh, deviations: Array) -> Array:
    """Turn of the shaft that a mesh drives, about the driven gear's z, by how its gears sit on their shafts [rad].

    Args:
        model, mesh: the mesh.
        deviations: (trials, components) [mm, rad, K].

    Returns:
        (trials,)
    """
    total = np.zeros(len(deviations))
    for contributor in model.contributors:
        if rate := contributor.effect.clocking(mesh):
            total = total + rate * deviations[:, model.component_slices[contributor.name].start]
    return total


def axial_play(model: Model, shaft: str, deviations: Array) -> Array:
    """Play of a shaft along its axis [mm], (trials,), by deviations (trials, components) [mm, rad, K]."""
    total = np.zeros(len(deviations))
    for columns, effect in _sliding_by(model, shaft):
        total = total + effect.play(deviations[:, columns])
    return total


def axial_rates(model: Model, shaft: str, deviations: Array) -> Array:
    """Its derivatives, (trials, components)."""
    rates = np.zeros(deviations.shape)
    for columns, effect in _sliding_by(model, shaft):
        rates[:, columns] += effect.rates(deviations[:, columns])
    return rates


def _sliding_by(model: Model, shaft: str) -> Iterator[tuple[slice, AxialPlay]]:
    """Columns of the deviations that let a shaft slide, each with its effect."""
    for contributor in model.contributors:
        for effect in contributor.effect.singles:
            if isinstance(effect, AxialPlay) and effect.slides(shaft):
                yield model.component_slices[contributor.name], effect


def staged_measures(model: Model) -> tuple[Measure, ...]:
    """The measure of each train whose stages are kept: its first of one value at random positions."""
    found: dict[str, Measure] = {}
    for measure in model.measures:
        if isinstance(measure.kind, LostMotion) and measure.positions.over == "random":
            found.setdefault(measure.kind.train, measure)
    return tuple(found.values())


def breakdowns_of(model: Model) -> tuple[Breakdown, ...]:
    """The stages of each of them: lost motion [arcmin] at the shaft that each stage drives."""
    return tuple(
        Breakdown(
            measure.name, tuple(SumTerm(stage.link, stage.factor) for stage in measure.kind.stages), "arcmin", ARCMIN
        )
        for measure in staged_measures(model)
        if isinstance(measure.kind, LostMotion)
    )


def stages_of(measure: Measure) -> tuple[AnyStage, ...]:
    """The stages that a train's measure adds up, from the held shaft on."""
    if not isinstance(measure.kind, LostMotion):
        raise TypeError(f"{measure.name} has no stages")
    return measure.kind.stages


Angles = tuple[float, ...] | None
"""Driver angles [rad] that every trial shares; None for those of the trial."""

SeatKey = tuple[str, Angles, Reading]
"""Mesh, positions and reading: backlashes that share them share their contacts."""

Read = Callable[[Backlash, SeatKey], Array]
"""Values (trials, positions) of a backlash [mm or rad] where it is read."""


def seat_key(model: Model, measure: Measure, backlash: Backlash) -> SeatKey:
    """Key of a measure's reading of one of its backlashes."""
    return backlash.mesh, model.driver_angles(measure, backlash.mesh), backlash.reading


def seat_keys(model: Model, measure: Measure) -> tuple[SeatKey, ...]:
    """The same of all of them."""
    return tuple(seat_key(model, measure, backlash) for _, backlash in measure.kind.backlashes)


@dataclass(frozen=True, eq=False)
class Play:
    """The backlashes of a measure in some trials.

    Args:
        model, measure: what is read.
        trials: deviations and positions.
        read: gives the values of each backlash.
        law: gives the free turns of links that are no meshes.
    """

    model: Model
    measure: Measure
    trials: Trials
    read: Read
    law: LinkLaw

    def free(self) -> Array:
        """Total play [mm or rad], (trials, positions)."""
        return np.asarray(sum(factor * values for _, factor, values in self.parts()))

    def parts(self) -> Iterator[tuple[str, float, Array]]:
        """Parts of the sum: the name of each link or group of parallel load paths, its factor, its play."""
        kind = self.measure.kind
        if isinstance(kind, Backlash):
            read = self.read(kind, seat_key(self.model, self.measure, kind))
            yield kind.mesh, 1.0, self._sliding(read, kind.slides)
            return
        if isinstance(kind, TransmissionError):
            for factor, backlash in kind.backlashes:
                yield backlash.mesh, factor, self.read(backlash, seat_key(self.model, self.measure, backlash))
            return
        for stage in kind.stages:
            yield stage.link, stage.factor, self.of(stage)

    def overlap(self) -> Array:
        """Interference of meshes, parallel load paths and other links where they bind [mm or rad], (trials, positions).

        0 or less. In a train that is jammed somewhere the play of other stages does not compensate for it.
        """
        if not isinstance(self.measure.kind, LostMotion):
            return np.minimum(self.free(), 0.0)
        return np.asarray(sum(stage.factor * self._lacking(stage) for stage in self.measure.kind.stages))

    def _lacking(self, stage: AnyStage) -> Array:
        """Interference of a stage [rad]; of a link that is no mesh only where it jams: data sheets may say anything."""
        lacking = np.minimum(self._of_teeth(stage), 0.0)
        if isinstance(stage, Stage) and stage.backlash is None:
            return np.where(self._jams(stage), lacking, 0.0)
        return lacking

    def jammed(self) -> NDArray[np.bool_]:
        """True where a link that is no mesh cannot be assembled, (trials, positions)."""
        found = np.zeros(self._shape, dtype=bool)
        for stage in self.measure.kind.singles if isinstance(self.measure.kind, LostMotion) else ():
            if stage.backlash is None:
                found |= self._jams(stage)
        return found

    def untouched(self) -> NDArray[np.bool_]:
        """True where no stop is found for a link that is no mesh, (trials, positions)."""
        found = np.zeros(self._shape, dtype=bool)
        for stage in self.measure.kind.singles if isinstance(self.measure.kind, LostMotion) else ():
            if stage.backlash is None:
                found |= np.isnan(self._turn(stage).play)
        return found

    def _jams(self, stage: Stage) -> NDArray[np.bool_]:
        turn = self._turn(stage)
        return np.broadcast_to(False if turn.jams is None else turn.jams, self._shape)

    def bound(self) -> NDArray[np.bool_]:
        """True where parallel load paths bind each other, (trials, positions)."""
        tight = np.zeros(self._shape, dtype=bool)
        stages = self.measure.kind.stages if isinstance(self.measure.kind, LostMotion) else ()
        for stage in _parallel(stages):
            tight |= self._of_teeth(stage) < -FREE
        return tight

    def of(self, stage: AnyStage) -> Array:
        """Play of a stage at the shaft that it drives [rad], (trials, positions), with that of shafts that slide."""
        return self._sliding(self._of_teeth(stage), stage.slides)

    def _of_teeth(self, stage: AnyStage) -> Array:
        """Play of a stage while no shaft slides [rad], (trials, positions)."""
        return value(self.form(stage), self.values_of)

    def _sliding(self, play: Array, slides: Sequence[Slide]) -> Array:
        """A play and the turns by which shafts slide through theirs [rad], (trials, positions)."""
        for slide in slides:
            play = play + slide.factor * axial_play(self.model, slide.shaft, self.trials.deviations)[:, None]
        return play

    def form(self, stage: AnyStage) -> LinearForm:
        """The play as a weighted sum of the readings of its links."""
        if isinstance(stage, Stage):
            return {(stage, "play"): np.array(1.0)}
        return free_form(stage, self._flank, self.values_of)

    def values_of(self, variable: Variable) -> Array:
        """A stage's own play, or the angle at which its driven gear rests on its shaft [rad], (trials, positions).

        Of a link that is no mesh the middle of its free turn stands for that angle.
        """
        stage, what = variable
        if isinstance(stage, str):
            play = axial_play(self.model, stage, self.trials.deviations)
            return np.broadcast_to(play[:, None], self._shape)
        if stage.backlash is None:
            turn = self._turn(stage)
            return np.broadcast_to(turn.play if what == "play" else middle_of(turn), self._shape)
        key = seat_key(self.model, self.measure, stage.backlash)
        if what == "play":
            return self.read(stage.backlash, key)
        sits = clocking(self.model, self.model.mesh(stage.backlash.mesh), self.trials.deviations)
        return self.read(replace(stage.backlash, quantity="rest_angle"), key) + sits[:, None]

    def _turn(self, stage: Stage) -> FreeTurn:
        """The free turn of a link that is no mesh."""
        link = self.model.link(stage.link)
        return self.law(link, link_trials(self.model, self.measure, link, self.trials))

    @property
    def _shape(self) -> tuple[int, int]:
        return len(self.trials), self.measure.positions.in_a_trial

    def _flank(self, stage: Stage) -> int | None:
        return None if stage.backlash is None else self.model.mesh(stage.backlash.mesh).driven_flank


def _parallel(stages: Iterable[AnyStage]) -> Iterator[ParallelStage]:
    """All parallel load paths among some stages, those inside others too."""
    for stage in stages:
        if isinstance(stage, ParallelStage):
            yield stage
            yield from (inner for path in stage.paths for inner in _parallel(path))
