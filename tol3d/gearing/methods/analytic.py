"""The analytic method: stack-ups of single meshes, added up and compared by trains."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tol3d.gearing.meshing.seats import driver_angles
from tol3d.gearing.model import Backlash, Measure, Model, TransmissionError
from tol3d.gearing.model.measure import gear_measures
from tol3d.gearing.play.linked import Remembered, by_theory
from tol3d.gearing.play.play import Play, SeatKey, seat_key, staged_measures
from tol3d.gearing.stack_up import analytic_backlash, analytic_transmission_error, first_order, per_normal_backlash
from tol3d.gearing.stack_up.tooth_pairs import pieces, teeth_deviate
from tol3d.numerics.arrays import Array
from tol3d.study.system import measure as system_measure
from tol3d.study.system.method import Answers
from tol3d.study.system.trials import Trials


@dataclass(frozen=True)
class AnalyticMethod:
    """The stack-ups of a model's meshes."""

    model: Model

    chord_error = 0.0

    def answers(self, trials: Trials, measures: Sequence[system_measure.Measure]) -> Answers:
        """See Method."""
        stacks = _Stacks(self.model, trials)
        own = gear_measures(measures)
        law = Remembered(by_theory)
        plays = {measure.name: Play(self.model, measure, trials, stacks, law) for measure in own}
        values = {measure.name: _values(plays[measure.name]) for measure in own}
        terms = {
            (measure.name, link): values[:, 0]
            for measure in staged_measures(self.model)
            if measure.name in plays
            for link, _, values in plays[measure.name].parts()
        }
        return Answers(values, terms)


def analytic_play(model: Model, measure: Measure, trials: Trials) -> Play:
    """The backlashes of a measure by the analytic method."""
    return Play(model, measure, trials, _Stacks(model, trials), by_theory)


def analytic_values(model: Model, measure: Measure, trials: Trials) -> Array:
    """Values of a measure by the analytic method [mm or rad], (trials, positions)."""
    return _values(analytic_play(model, measure, trials))


def _values(play: Play) -> Array:
    """Values of a measure, from its play or from rotating deviations in its meshes."""
    kind = play.measure.kind
    if not isinstance(kind, TransmissionError):
        return first_order(kind, play.free())
    angles = [np.array(play.model.driver_angles(play.measure, mesh) or (0.0,)) for mesh in kind.meshes]
    return analytic_transmission_error(play.model, kind, play.trials.deviations, angles)


def analytic_backlashes(model: Model, measure: Measure, trials: Trials) -> Iterator[tuple[Backlash, Array]]:
    """The backlashes of the meshes that a measure reads, each with its values by the analytic method [mm or rad]."""
    stacks = _Stacks(model, trials)
    for _, read in measure.kind.backlashes:
        backlash = replace(read, quantity="angular_backlash") if read.quantity == "rest_angle" else read
        yield backlash, stacks(backlash, seat_key(model, measure, backlash))


class _Stacks:
    """Reads backlashes by the analytic method; those that are read alike share one stack-up."""

    def __init__(self, model: Model, trials: Trials) -> None:
        self._model, self._trials = model, trials
        self._known: dict[SeatKey, Array] = {}
        self._of_flanks: dict[tuple[Backlash, SeatKey], Array] = {}

    def __call__(self, backlash: Backlash, key: SeatKey) -> Array:
        """See Read."""
        angles = driver_angles(key, self._trials)
        if teeth_deviate(self._model, self._model.mesh(backlash.mesh)):
            return self._by_flanks(backlash, key, angles)
        if key not in self._known:
            self._known[key] = self._asked(replace(backlash, quantity="normal_backlash"), angles)
        if backlash.quantity != "rest_angle":
            return self._known[key] * per_normal_backlash(self._model, backlash)
        play = self._known[key] * per_normal_backlash(self._model, backlash)
        return self._asked(backlash, angles) - self._model.mesh(backlash.mesh).driven_flank * play / 2

    def _by_flanks(self, backlash: Backlash, key: SeatKey, angles: Array) -> Array:
        """Backlash of a mesh whose flanks deviate one by one: gaps at rest and turns have their own stacks."""
        if (backlash, key) not in self._of_flanks:
            count, positions = angles.shape
            found = np.empty(angles.shape)
            for piece in pieces(count, positions, self._trials.deviations.shape[1]):
                found[piece] = self._asked(backlash, angles[piece], piece)
            if backlash.quantity == "rest_angle":
                mesh = self._model.mesh(backlash.mesh)
                play = self._by_flanks(replace(backlash, quantity="angular_backlash", gear=mesh.driven), key, angles)
                found = found - mesh.driven_flank * play / 2
            self._of_flanks[backlash, key] = found
        return self._of_flanks[backlash, key]

    def _asked(self, backlash: Backlash, angles: Array, trials: slice = slice(None)) -> Array:
        rows, positions = self._trials.deviations[trials], angles.shape[1]
        repeated = rows if positions == 1 else np.repeat(rows, positions, axis=0)
        return analytic_backlash(self._model, backlash, repeated, angles.ravel()).reshape(angles.shape)
