"""Lost motion of joints by their trains: each joint is solved once for each build of its own train and each position.

Builds that differ in other trains alone, such as those for slopes and ends, share the result; so do all measures and
poses that read a joint in the same position.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tol3d.gearing.machine.joined import Joined
from tol3d.gearing.model.measure import Measure
from tol3d.gearing.play.linked import DEAR
from tol3d.numerics.arrays import Array
from tol3d.numerics.kept import kept, row_keys
from tol3d.study.system.method import Method
from tol3d.study.system.stated import component_slices
from tol3d.study.system.trials import Trials


@dataclass(frozen=True, eq=False)
class Turned:
    """Lost motion of joints in some trials.

    Args:
        play: by reading of a drive (trials,) [rad]; NaN where it failed.
        failed: by reading, True for trials in which the train has no lost motion (trials,).
    """

    play: Mapping[str, Array] = field(default_factory=dict)
    failed: Mapping[str, NDArray[np.bool_]] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Turning:
    """Free motion of a system's trains, by one of its methods.

    Args:
        system: the system of the trains; it keeps the solutions for all methods of a kind in this process.
        method: of its gears.
    """

    system: Joined
    method: Method

    def turned(self, trials: Trials, readings: Sequence[Measure]) -> Turned:
        """The lost motions of some readings.

        Args:
            trials: of the system's gears.
            readings: each at one position that all trials share.
        """
        plays = {reading.name: self._play(trials, reading) for reading in readings if self._is_dear(reading)}
        others = [reading for reading in readings if reading.name not in plays]
        if others:
            plays |= self._solved(trials, others)
        ordered = {reading.name: plays[reading.name] for reading in readings}
        return Turned(ordered, {name: ~np.isfinite(play) for name, play in ordered.items()})

    def _is_dear(self, reading: Measure) -> bool:
        return any(self.system.gears.model.link(name).contacts >= DEAR for _, name in reading.kind.links)

    def _solved(self, trials: Trials, readings: Sequence[Measure]) -> dict[str, Array]:
        """Lost motions (trials,) [rad] by reading, NaN where a train has none."""
        answers = self.method.answers(trials, list(readings))
        plays = {}
        for reading in readings:
            codes = answers.status.get(reading.name, np.zeros(len(trials), dtype=np.int8))
            plays[reading.name] = np.where(codes != 0, np.nan, answers.values[reading.name][:, 0])
        return plays

    def _play(self, trials: Trials, reading: Measure) -> Array:
        """Lost motion (trials,) [rad]; builds that are not known yet are solved, each once."""
        acting = np.ascontiguousarray(trials.deviations[:, self._acting(reading)])

        def solve(rows: NDArray[np.intp]) -> Sequence[float]:
            part = Trials(trials.deviations[rows], {name: at[rows] for name, at in trials.positions.items()})
            solved: list[float] = self._solved(part, [reading])[reading.name].tolist()
            return solved

        return np.array(self.system.known_turns(type(self.method).__name__, reading.name).of(row_keys(acting), solve))

    @kept
    def _acting(self, reading: Measure) -> NDArray[np.intp]:
        """Columns of the deviations that act on a reading."""
        slices = component_slices(self.system.gears)
        acting = [slices[contributor.name] for contributor in self.system.gears.acting(reading)]
        columns = [np.arange(columns.start, columns.stop) for columns in acting]
        return np.concatenate([*columns, np.zeros(0)]).astype(np.intp)
