"""A scene that the app has open: what it says, its measures, and its builds, evaluated a little at each request.

A card asks for its measure's builds until all trials of the study are there; each request goes on for a fraction of a
second. So nothing has to be stopped when a tolerance moves again: the next request simply asks for something else.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from copy import copy
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path
from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from tol3d.analyses.before_after import SIDES, limits_of
from tol3d.analyses.moved_values import MovedValues
from tol3d.analyses.response import Response, Values, response_of
from tol3d.analyses.results import pilots_of, results_of
from tol3d.analyses.stated_changes import Change, change_of, changed, factor_of
from tol3d.analyses.stated_classes import Sizes, classes_of, sizes_of
from tol3d.analyses.stated_limits import OtherLimits, limited, limits_of_text
from tol3d.analyses.stated_sizes import nominals_of, typed_of
from tol3d.apps.workbench.words import OPTION
from tol3d.apps.workbench.workspace import WhatIf, digest
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.simulate import load, simulation_of
from tol3d.study import Simulation
from tol3d.study.execution.pace import FEWEST, LONGEST, Pace
from tol3d.study.runs.summary.judged import Accepted, JudgedMeasure, demand_of
from tol3d.study.runs.summary.sample import Sample
from tol3d.study.system.measure import Measure
from tol3d.study.trials.draws import KeptDraws

Own = TypeVar("Own")
AT_ONCE: Final = 0.3
"""Time that an answer takes for builds or slopes, where these have pieces so short [s]: another question may wait."""
LIMITS: Final = "limits: "
"""Begins the key of a what-if that changes limits, with the measure's name; no line of a scene has a colon."""
MOST_BUILDS: Final = 100_000
"""Builds of a card; a run has all that the study asks for."""
ESTIMATED: Final = 2000
"""Builds of an estimate, where their slopes do not take too long."""
FEW: Final = 200
"""Builds of which a card says something."""
SLOPES_WITHIN: Final = 1.0
"""Time that slopes at each build should take [s]: it decides how many builds an estimate has."""
SLOPES_OF: Final = 6
"""Builds of the slopes at a build: two for each component of a tolerance with three."""
LONGEST_SLOPES: Final = 10.0
"""Time of slopes of a tolerance beyond which there is no estimate [s]."""
KEPT_CARDS: Final = 12
"""Measures and what-ifs whose builds are kept."""


@dataclass(frozen=True)
class NoEstimate:
    """Words on an estimate that is not there.

    Args:
        words: what it waits for, or the reason why there is none.
        is_coming: true if asking again helps.
    """

    words: str
    is_coming: bool = True


@dataclass
class Turn:
    """The time of an answer for builds and slopes: one piece of them, and others that end in time.

    Args:
        until: its end, on the clock of `time.perf_counter` [s].
    """

    until: float = field(default_factory=lambda: time.perf_counter() + AT_ONCE)
    _taken: bool = False

    def has(self, seconds: float) -> bool:
        """True if a piece of about so many seconds may begin."""
        first, self._taken = not self._taken, True
        return first or time.perf_counter() + seconds < self.until


@dataclass(eq=False)
class Evaluated:
    """Builds of one measure by some tolerances, of which more are evaluated with each request.

    Args:
        response: of the measure, with its tolerances.
        kept: all the builds.
        done: number of those that are evaluated.
        pace: time of a build of the last piece [s]; the first compiles kernels.
    """

    response: Response
    kept: KeptDraws
    done: int = 0
    pace: float = 0.0
    _values: Array = field(init=False)
    _codes: NDArray[np.int8] = field(init=False)
    _asked: Pace = field(init=False)
    _piece: float = 0.0
    _sample: Sample | None = None
    _pilots: Sequence[Array] = ()
    _measure: Measure | None = None

    def __post_init__(self) -> None:
        count = len(self.kept.deviations)
        self._values, self._codes = np.full((count, 1), np.nan), np.zeros((count, 1), dtype=np.int8)
        self._asked = Pace.of(60.0 * self.response.minutes)

    @property
    def count(self) -> int:
        """Number of builds."""
        return len(self._values)

    @property
    def values(self) -> Values:
        """Values of the builds that are done."""
        texts = self.response.simulation.system.statuses.texts
        return Values(self._values[: self.done], self._codes[: self.done], texts)

    def go_on(self, turn: Turn, most: int) -> None:
        """Evaluate more builds, up to so many, while it is their turn."""
        most, asked = min(most, self.count), self._asked
        while self.done < most and turn.has(self._piece):
            in_time = max(int(LONGEST / self.pace), FEWEST) if self.pace else asked.count
            rows, begun = slice(self.done, min(self.done + min(asked.count, in_time), most)), time.perf_counter()
            positions = {name: own[rows] for name, own in self.kept.positions.items()}
            values = self.response.values(self.kept.deviations[rows], positions)
            self._values[rows], self._codes[rows] = values.values, values.codes
            self._piece = time.perf_counter() - begun
            asked.took(rows.stop - rows.start, self._piece)
            self.done, self._sample, self.pace = rows.stop, None, self._piece / (rows.stop - rows.start)

    @property
    def is_shown(self) -> bool:
        """True if there are as many builds as a card needs."""
        return self.done >= min(FEW, self.count)

    @property
    def left(self) -> float:
        """Time that the others will take, about [s]."""
        return self.pace * (self.count - self.done)

    @property
    def sample(self) -> Sample:
        """Statistics of the builds that are done, as a run of them has."""
        if self._sample is None:
            rows = slice(0, self.done)
            positions = {name: own[rows] for name, own in self.kept.positions.items()}
            trials = (self.response, self.kept.deviations[rows], positions, self.values)
            self._pilots = self._pilots or pilots_of(*trials)  # once: a sample has at least FEW builds, or all
            found = results_of(*trials, measures=[self.measure], pilots=self._pilots)
            self._sample = found[self.measure.name]
        return self._sample

    @property
    def measure(self) -> Measure:
        """The measure."""
        return self._measure or self.response.measures[0]

    def within(self, limits: Sequence[OtherLimits]) -> "Evaluated":
        """The builds that are done, judged by other limits: nothing is evaluated.

        Raises:
            InputError: limits that cannot be.
        """
        (measure,) = limited(self.response.measures, limits)
        if measure is self.measure:
            return self
        if self.done:
            self.sample  # noqa: B018 - knows the pilots
        other = copy(self)
        other._measure, other._sample = measure, None
        return other

    @property
    def judged(self) -> JudgedMeasure:
        """Its verdict, as a run's."""
        return JudgedMeasure.by(self.sample, self.demand, limited=self.limited)

    @property
    def limited(self) -> bool:
        """True if the measure has a limit."""
        return self.measure.lower_limit is not None or self.measure.upper_limit is not None

    @property
    def demand(self) -> Accepted:
        """Demand of the study on the measure."""
        return demand_of(self.response.simulation.study.accept_ppk)

    def trial(self, number: int) -> tuple[Array, Mapping[str, Array]]:
        """Deviations of a build (components,) [mm, rad, K], and its positions."""
        return self.kept.deviations[number], {name: own[number] for name, own in self.kept.positions.items()}

    @property
    def worst(self) -> int:
        """The build that is nearest to a limit or furthest beyond it; without limits the farthest from the mean."""
        values = self.values.values[:, 0]
        low, high = ((limits_of(self.measure).get(side)) for side in SIDES)
        if low is None and high is None:
            depth = np.abs(values - np.nanmean(values))
        else:
            depth = np.fmax(-np.inf if low is None else low - values, -np.inf if high is None else values - high)
        return int(np.nanargmax(depth)) if np.isfinite(depth).any() else 0

    @property
    def good(self) -> Array:
        """Values of builds that are assembled, in the measure's unit."""
        values = self.values
        return np.asarray(values.values[values.seated])


@dataclass(eq=False)
class Session:
    """An open scene.

    Args:
        path: of its file.
        content: of the file, as it was read.
        scene, simulation, response: what it means.
        look: which tries what acts on its measures.
    """

    path: Path
    content: bytes
    scene: Scene
    simulation: Simulation
    response: Response
    look: "Future[tuple[str, ...]] | None" = None
    _kept: KeptDraws | None = None
    _evaluated: dict[tuple[str, tuple[tuple[str, str], ...]], Evaluated] = field(default_factory=dict)
    _moved: dict[str, MovedValues] = field(default_factory=dict)
    _acting: dict[str, tuple[str, ...]] = field(default_factory=dict)

    @classmethod
    def opened(cls, path: Path, *, trust_parts: bool, run_builders: bool) -> "Session":
        """The scene of a file.

        Raises:
            SceneError, InputError: as `tol3d check` says.
        """
        content = path.read_bytes()
        scene = load(path, trust_parts=trust_parts, run_builders=run_builders)
        simulation = simulation_of(scene)
        return cls(path, content, scene, simulation, response_of(simulation))

    @property
    def digest(self) -> str:
        """Name of the file's content."""
        return digest(self.content)

    @property
    def builds(self) -> int:
        """Number of builds of a card."""
        return min(self.simulation.study.trials, MOST_BUILDS)

    @property
    def kept(self) -> KeptDraws:
        """The study's builds."""
        if self._kept is None:
            self._kept = self.response.kept(self.builds)
        return self._kept

    def changes(self, now: WhatIf) -> list[Change]:
        """Changes of tolerances that were made by hand.

        Raises:
            InputError: no such tolerance, or no such value of it.
        """
        return [self._change(line, words) for line, words in now.items() if not line.startswith(LIMITS)]

    def limits(self, now: WhatIf) -> list[OtherLimits]:
        """Limits of measures that were changed by hand.

        Raises:
            InputError: no such measure, or no such limits of it.
        """
        stated = {key.removeprefix(LIMITS): words for key, words in now.items() if key.startswith(LIMITS)}
        return [_in_a_page(limits_of_text, self.response, f"{own}={text}") for own, text in stated.items()]

    def _change(self, line: str, words: str) -> Change:
        if words.startswith("x"):
            return _in_a_page(factor_of, self.response, f"{line}={words.removeprefix('x')}")
        read = partial(change_of, sizes=self.sizes, nominals=self.nominals)
        return _in_a_page(read, self.response, f"{line}={words}")

    @cached_property
    def sizes(self) -> Mapping[str, Sizes]:
        """Nominal sizes by line, at which tolerance classes are read."""
        return sizes_of(self.scene, self.simulation.lines)

    @cached_property
    def nominals(self) -> Mapping[str, float]:
        """Nominal values of measured sizes by line [mm], such as of a span."""
        return nominals_of(self.scene, self.simulation.lines)

    @cached_property
    def typed(self) -> Mapping[str, str]:
        """Limits of measured sizes as the scene has them, by line."""
        return typed_of(self.scene, self.simulation.lines)

    @cached_property
    def classes(self) -> Mapping[str, str]:
        """Tolerance classes of the scene by line."""
        return classes_of(self.scene, self.simulation.lines)

    def still(self, now: WhatIf) -> tuple[WhatIf, Sequence[str]]:
        """Those of a what-if's changes that the scene still allows, and sentences on the others."""
        known, dropped = dict[str, str](), list[str]()
        for line, words in now.items():
            name = line.removeprefix(LIMITS)
            if name not in (self.response.names if line.startswith(LIMITS) else self.response.lines):
                dropped.append(f"{name} is no longer in the scene: its move was dropped.")
                continue
            try:
                self.changed({line: words})
                limited(self.response.measures, self.limits({line: words}))
                known[line] = words
            except InputError as error:
                dropped.append(f"{name} can no longer be {words.replace('x', '× ')}: its move was dropped ({error}).")
        return known, dropped

    def changed(self, now: WhatIf) -> Response:
        """The response with other tolerances.

        Raises:
            InputError: they cannot be.
        """
        changes = self.changes(now)
        return changed(self.response, changes) if changes else self.response

    def evaluated(self, measure: str, now: WhatIf) -> Evaluated:
        """Builds of a measure by some tolerances, as far as they are there; `within` judges them by other limits.

        Raises:
            InputError: no such measure, or tolerances that cannot be.
        """
        key = (measure, tuple(sorted((line, words) for line, words in now.items() if not line.startswith(LIMITS))))
        found = self._evaluated.pop(key, None)
        if found is None:
            response = self.changed(now)
            kept = self.kept if response is self.response else self.kept.redrawn(response.draws)
            found = Evaluated(response.of(measure), kept)
        self._evaluated[key] = found
        while len(self._evaluated) > KEPT_CARDS:
            del self._evaluated[next(own for own in self._evaluated if own[1] or len(self._evaluated) > KEPT_CARDS)]
        return found

    def estimate(self, measure: str, now: WhatIf, turn: Turn) -> Array | NoEstimate:
        """Values of some builds by other tolerances, by slopes alone, NaN where one has none.

        Args:
            measure: its name.
            now: the other tolerances.
            turn: the time for builds and slopes; the next question goes on with what is not ready then.

        Raises:
            InputError: as `evaluated`.
        """
        changed, base = self.changed(now), self.evaluated(measure, {})
        base.go_on(turn, FEW)
        if not base.is_shown:
            return NoEstimate(f"builds: {base.done} of {FEW}")
        if measure not in self._moved:
            in_time = int(SLOPES_WITHIN / max(SLOPES_OF * base.pace, 1e-9))
            count = min(max(FEW, min(ESTIMATED, in_time)), base.done)
            values = base.values.values[:count]
            self._moved[measure] = MovedValues(base.response, self.response.kept(count), values, LONGEST_SLOPES)
        moved = self._moved[measure]
        redrawn = moved.kept.redrawn(changed.draws)
        for name in moved.moved(redrawn):
            if waits := _made(moved, name, turn):
                return waits
        return np.asarray(moved.of(redrawn)[:, 0])

    def acting(self, measure: str) -> tuple[str, ...]:
        """Lines of the scene whose contributors act on a measure.

        Raises:
            InputError: no such measure.
        """
        if measure not in self._acting:
            names = {own.name for own in self.response.acting(self.measure(measure))}
            lines = self.response.lines.items()
            self._acting[measure] = tuple(line for line, own in lines if not names.isdisjoint(own))
        return self._acting[measure]

    def measure(self, name: str) -> Measure:
        """A measure by its name, the first for "".

        Raises:
            InputError: no such measure.
        """
        if not name:
            return self.response.measures[0]
        return self.response.of(name).measures[0]

    def require_contributors(self) -> None:
        """Refuse a scene in which nothing varies.

        Raises:
            InputError: it has no tolerances.
        """
        if not self.response.components:
            raise InputError("expected a scene with tolerances, got none: all its builds are the nominal one")


def _in_a_page(read: Callable[[Response, str], Own], response: Response, text: str) -> Own:
    """A change read as from a command line, which a page does not have."""
    try:
        return read(response, text)
    except InputError as error:
        raise InputError(OPTION.sub("", str(error))) from None


def _made(moved: MovedValues, name: str, turn: Turn) -> NoEstimate | None:
    """Slopes by a contributor, as far as it is their turn; None where they are there and of use."""
    steps, words, took = moved.steps(name), f"slopes of {name}", 0.0
    while name not in moved.known:
        if not turn.has(took):
            return NoEstimate(words)
        begun = time.perf_counter()
        if step := next(steps, None):
            words = f"{step.part} of {name}: {step.done} of {step.of} builds"
        took = time.perf_counter() - begun
    slopes = moved.known[name]
    if slopes.will_do or slopes.at_each_build:
        return None
    return NoEstimate(f"slopes of {name} take too long; release the slider to simulate", is_coming=False)
