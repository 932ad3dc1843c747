"""Turns of joints by trains: each joint is solved once for each build of its own train and each position.

Builds that differ in other trains alone, such as those of slopes, ends and second looks, share what is found; so do all
measures and poses that read a joint in the same position.
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
    """Joints of some trials.

    Args:
        play: by reading of a drive (trials,) [rad].
        failed: by reading, trials in which the train has none (trials,).
    """

    play: Mapping[str, Array] = field(default_factory=dict)
    failed: Mapping[str, NDArray[np.bool_]] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Turning:
    """Free motion of a system's trains, by one of its methods.

    Args:
        system: that has the trains; its solutions are shared by all methods of a kind in this process.
        method: of its gears.
    """

    system: Joined
    method: Method

    def turned(self, trials: Trials, readings: Sequence[Measure]) -> Turned:
        """The lost motions of some readings.

        Args:
            trials: as the gears see them.
            readings: each at one position that all trials share.
        """
        plays = {reading.name: self._play(trials, reading) for reading in readings if self._is_dear(reading)}
        others = [reading for reading in readings if reading.name not in plays]
        if others:
            plays |= self._solved(trials, others)
        ordered = {reading.name: plays[reading.name] for reading in readings}
        return Turned(ordered, {name: ~np.isfinite(own) for name, own in ordered.items()})

    def _is_dear(self, reading: Measure) -> bool:
        return any(self.system.gears.model.link(name).contacts >= DEAR for _, name in reading.kind.links)

    def _solved(self, trials: Trials, readings: Sequence[Measure]) -> dict[str, Array]:
        """Lost motions (trials,) by reading, not a number where a train has none."""
        answers = self.method.answers(trials, list(readings))
        found = {}
        for reading in readings:
            codes = answers.status.get(reading.name, np.zeros(len(trials), dtype=np.int8))
            found[reading.name] = np.where(codes != 0, np.nan, answers.values[reading.name][:, 0])
        return found

    def _play(self, trials: Trials, reading: Measure) -> Array:
        """Lost motion (trials,), of builds that are not known solved anew, each once."""
        own = np.ascontiguousarray(trials.deviations[:, self._acting(reading)])

        def find(rows: NDArray[np.intp]) -> Sequence[float]:
            part = Trials(trials.deviations[rows], {name: at[rows] for name, at in trials.positions.items()})
            solved: list[float] = self._solved(part, [reading])[reading.name].tolist()
            return solved

        return np.array(self.system.known_turns(type(self.method).__name__, reading.name).of(row_keys(own), find))

    @kept
    def _acting(self, reading: Measure) -> NDArray[np.intp]:
        """Columns of the deviations that act on a reading."""
        slices = component_slices(self.system.gears)
        its = [np.arange(slices[own.name].start, slices[own.name].stop) for own in self.system.gears.acting(reading)]
        return np.concatenate([*its, np.zeros(0)]).astype(np.intp)
