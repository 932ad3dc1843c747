"""A scene that the app has open: what it says, its measures, and its builds, evaluated a little at each request.

A card asks for its measure's builds until all trials of the study are there; each request goes on for a fraction of a
second. So nothing has to be stopped when a tolerance moves again: the next request simply asks for something else.
"""

import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from tol3d.analyses.before_after import SIDES, limits_of
from tol3d.analyses.moved_values import MovedValues
from tol3d.analyses.response import Response, Values, response_of
from tol3d.analyses.results import results_of
from tol3d.analyses.stated_changes import Change, change_of, changed, factor_of
from tol3d.apps.workbench.workspace import WhatIf, digest
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.scene import Scene
from tol3d.simulate import load, simulation_of
from tol3d.study import Simulation
from tol3d.study.runs.summary.judged import JudgedMeasure, demand_of
from tol3d.study.runs.summary.sample import Sample
from tol3d.study.system.measure import Measure
from tol3d.study.trials.draws import KeptDraws

AT_ONCE: Final = 0.35
"""Time that a request evaluates builds [s]."""
MOST_BUILDS: Final = 100_000
"""Builds of a card; a run has all that the study asks for."""
ESTIMATED: Final = 2000
"""Builds of an estimate, where they take no longer than AT_ONCE; else FEW."""
FEW: Final = 200
KEPT_CARDS: Final = 12
"""Measures and what-ifs whose builds are kept."""


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
    _pieces: Iterator[tuple[slice, Values]] = field(init=False)
    _sample: Sample | None = None

    def __post_init__(self) -> None:
        count = len(self.kept.deviations)
        self._values, self._codes = np.full((count, 1), np.nan), np.zeros((count, 1), dtype=np.int8)
        self._pieces = self.response.pieces(self.kept.deviations, self.kept.positions)

    @property
    def count(self) -> int:
        """Number of builds."""
        return len(self._values)

    @property
    def values(self) -> Values:
        """Values of the builds that are done."""
        texts = self.response.simulation.system.statuses.texts
        return Values(self._values[: self.done], self._codes[: self.done], texts)

    def go_on(self, seconds: float, at_least: int = 1) -> None:
        """Evaluate more builds, for some time [s], and until there are so many."""
        until = time.perf_counter() + seconds
        while self.done < self.count and (time.perf_counter() < until or self.done < at_least):
            begun = time.perf_counter()
            rows, values = next(self._pieces)
            self._values[rows], self._codes[rows] = values.values, values.codes
            self.pace = (time.perf_counter() - begun) / (rows.stop - rows.start)
            self.done, self._sample = rows.stop, None

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
            found = results_of(self.response, self.kept.deviations[rows], positions, self.values)
            self._sample = found[self.measure.name]
        return self._sample

    @property
    def measure(self) -> Measure:
        """The measure."""
        return self.response.measures[0]

    @property
    def judged(self) -> JudgedMeasure:
        """Its verdict, as a run's."""
        limited = self.measure.lower_limit is not None or self.measure.upper_limit is not None
        return JudgedMeasure.by(self.sample, demand_of(self.response.simulation.study.accept_ppk), limited=limited)

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
    """

    path: Path
    content: bytes
    scene: Scene
    simulation: Simulation
    response: Response
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
        """Changes that were made by hand.

        Raises:
            InputError: no such tolerance, or no such value of it.
        """
        return [self._change(line, words) for line, words in now.items()]

    def _change(self, line: str, words: str) -> Change:
        of, option = (factor_of, "--factor") if words.startswith("x") else (change_of, "--set")
        text = f"{line}={words.removeprefix('x')}"
        try:
            return of(self.response, text)
        except InputError as error:  # the page has no options
            raise InputError(str(error).removeprefix(f"{option} {text!r}: ").removeprefix(f"{option}: ")) from None

    def changed(self, now: WhatIf) -> Response:
        """The response with other tolerances.

        Raises:
            InputError: they cannot be.
        """
        return changed(self.response, self.changes(now)) if now else self.response

    def evaluated(self, measure: str, now: WhatIf) -> Evaluated:
        """Builds of a measure by some tolerances, as far as they are there.

        Raises:
            InputError: no such measure, or tolerances that cannot be.
        """
        key = (measure, tuple(sorted(now.items())))
        found = self._evaluated.pop(key, None)
        if found is None:
            response = self.changed(now)
            kept = self.kept if response is self.response else self.kept.redrawn(response.draws)
            found = Evaluated(response.of(measure), kept)
        self._evaluated[key] = found
        while len(self._evaluated) > KEPT_CARDS:
            del self._evaluated[next(own for own in self._evaluated if own[1] or len(self._evaluated) > KEPT_CARDS)]
        return found

    def estimate(self, measure: str, now: WhatIf) -> Array:
        """Values of some builds by other tolerances, by slopes alone, NaN where one has none.

        Raises:
            InputError: as `evaluated`.
        """
        if measure not in self._moved:
            base = self.evaluated(measure, {})
            base.go_on(AT_ONCE, FEW)
            count = min(ESTIMATED if base.done >= ESTIMATED else FEW, base.done)
            kept = self.response.kept(count)
            self._moved[measure] = MovedValues(self.response.of(measure), kept, base.values.values[:count])
        moved = self._moved[measure]
        return np.asarray(moved.of(moved.kept.redrawn(self.changed(now).draws))[:, 0])

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
