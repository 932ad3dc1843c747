"""Three methods to how far a spring lifts."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.study.system.measure import Measure
from tol3d.study.system.method import Answers
from tol3d.study.system.stated import component_slices
from tol3d.study.system.system import System
from tol3d.study.system.trials import Trials
from toys.parabola.springs import LOST_LEVER, Room, Springs, coil_weights, own_measure

Array = NDArray[np.float64]

TERMS = ("line", "bow", "ripple", "offset", "wave")
OK, TOO_LONG, LOST = range(3)
POSITION = "turn"
ROUNDING = 1e-9  # um


@dataclass(frozen=True)
class Deviations:
    """Deviations that make up the terms, (trials,) [mm]: sums over the contributors of each kind."""

    x: Array
    ripple: Array
    offset: Array
    wave: Array

    @classmethod
    def of(cls, system: System, trials: Trials) -> "Deviations":
        slices = component_slices(system)
        found = {kind: np.zeros(len(trials)) for kind in ("abscissa", "ripple", "offset", "wave")}
        for contributor in system.contributors:
            own = trials.deviations[:, slices[contributor.name]]
            weights = coil_weights(own.shape[1]) if contributor.kind == "ripple" else np.ones(1)
            for k, weight in enumerate(weights):  # one by one: the bits of a trial do not depend on the others
                found[contributor.kind] = found[contributor.kind] + weight * own[:, k]
        return cls(*found.values())


@dataclass(frozen=True)
class Lift:
    """Terms of how far a spring lifts [mm]: those at rest (trials,), and the wave's size."""

    line: Array
    bow: Array
    ripple: Array
    offset: Array
    wave: Array

    def heights(self, angles: Array) -> Array:
        """At angles (trials, positions) [rad]."""
        rest = self.line + self.bow + self.ripple + self.offset
        return np.asarray(rest[:, None] + self.wave[:, None] * np.sin(angles))


def angles_of(measure: Measure, trials: Trials) -> Array:
    """Positions (trials, positions) at which a measure is read [rad]."""
    fixed = measure.positions.fixed
    if fixed is None:
        return trials.positions[POSITION][:, None]
    return np.broadcast_to(np.array(fixed), (len(trials), len(fixed)))


def answered(springs: Springs, system: System, trials: Trials, measures: Sequence[Measure], lift: Lift) -> Answers:
    """Values and terms of measures, from the terms of a lift."""
    values, terms = {}, {}
    for measure in map(own_measure, measures):
        angles = angles_of(measure, trials)
        heights = lift.heights(angles)
        room = springs.room(measure)
        values[measure.name] = heights if room is None else room.room - heights
        if measure.name in {breakdown.measure for breakdown in system.breakdowns}:
            waves = lift.wave * np.sin(angles[:, 0])
            for term, own in zip(TERMS, (lift.line, lift.bow, lift.ripple, lift.offset, waves), strict=True):
                terms[measure.name, term] = own
    return Answers(values, terms)


@dataclass(frozen=True)
class Theory:
    """The first order: a x + t + c + w sin; of the offset it leaves out 5 %."""

    springs: Springs
    system: System
    chord_error = 0.0

    def answers(self, trials: Trials, measures: Sequence[Measure]) -> Answers:
        own = Deviations.of(self.system, trials)
        lift = Lift(self.springs.spring.a * own.x, np.zeros(len(trials)), own.ripple, own.offset, own.wave)
        return answered(self.springs, self.system, trials, measures, lift)


@dataclass(frozen=True)
class Exact:
    """The parabola itself, with what becomes of each trial."""

    springs: Springs
    system: System
    square: Callable[[Array], Array] = np.square
    chord_error: float = 0.0

    def answers(self, trials: Trials, measures: Sequence[Measure]) -> Answers:
        own, spring = Deviations.of(self.system, trials), self.springs.spring
        ripple = own.ripple + spring.q * np.square(own.ripple)
        bow, offset = spring.b * self.square(own.x), (1 + LOST_LEVER) * own.offset
        found = answered(
            self.springs, self.system, trials, measures, Lift(spring.a * own.x, bow, ripple, offset, own.wave)
        )
        details: dict[str, NDArray[np.generic]] = {"bow [um]": 1e3 * bow}
        status = {
            m.name: _status(self.springs.room(m), own.x, found.values[m.name]) for m in map(own_measure, measures)
        }
        return Answers(_told(found.values, status), found.terms, details, status)


def _status(room: Room | None, x: Array, values: Array) -> NDArray[np.int8]:
    """Status of each trial of a measure."""
    status = np.zeros(len(x), dtype=np.int8)
    if room is not None:
        status[values[:, 0] < 0.0] = TOO_LONG
        status[np.abs(x) > room.lost_beyond] = LOST
    return status


def _told(values: Mapping[str, Array], status: Mapping[str, NDArray[np.int8]]) -> dict[str, Array]:
    """Values, nan where nothing is known."""
    return {name: np.where((status[name] == LOST)[:, None], np.nan, own) for name, own in values.items()}


@dataclass(frozen=True)
class Chords(Exact):
    """The parabola's chords between knots, as a witness."""

    def reads(self, measure: Measure) -> bool:
        """Every one."""
        return True

    def bounds(self, measure: Measure) -> tuple[float, float]:
        """By its chords, and by rounding [um]."""
        return 1e3 * self.chord_error, ROUNDING


def chords_method(springs: Springs, system: System, materials: Mapping[str, Array]) -> Chords:
    """The chords of x^2 between the knots; a chord over h lies at most h^2/4 above the square."""
    knots, squares = materials["knots"], materials["squares"]
    step = float(np.diff(knots).max())
    error = abs(springs.spring.b) * step**2 / 4

    def square(x: Array) -> Array:
        return np.interp(x, knots, squares)

    return Chords(springs, system, square, error)
