"""Task of the workers: blocks of a study's trials, from their numbers to columns and statistics.

Trials of a block are folded together and written as one file. `workers_for` says how many workers a run of the command
line has unless it states their number; `run_scene` has one.
"""

import math
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from typing import Any, Final

from numpy.typing import NDArray

from tol3d.statistics.estimates import Grid
from tol3d.study.effects.acting_contributors import looked_at
from tol3d.study.execution.folding import Plan, Progress, joined_columns
from tol3d.study.execution.pace import Pace
from tol3d.study.execution.pools import Concurrency, suggested_workers
from tol3d.study.results.versions import Versions, installed_versions, refuse_other_versions
from tol3d.study.system.faults import faults_of
from tol3d.study.system.method import Method
from tol3d.study.system.stated import component_count
from tol3d.study.tallies.tally import PILOT_TRIALS, Tally, grids_of
from tol3d.study.trials.columns import columns_of
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.simulation import Simulation

Columns = dict[str, NDArray[Any]]

PIECE_S: Final = 2.0
"""Seconds of a piece of a block, about: after each one progress may be told."""
TOGETHER: Final = 64
"""Pieces have a multiple of so many trials. A trial sees no other, but numpy computes complex numbers at an array's
end, past the last full vector of the processor, to another last bit: so the same trials stand there as in the whole."""


def materials_of(simulation: Simulation) -> Any:
    """Materials of the method of the study's engine."""
    return simulation.system.materials(simulation.study.engine)


def method_of(simulation: Simulation, materials: Any) -> Method | None:
    """The method of the study's engine; None for an analytic study."""
    return simulation.system.method(simulation.study.engine, materials) if simulation.has_geometry else None


def concurrency_of(simulation: Simulation) -> Concurrency:
    """Scheduling of its trials."""
    return Concurrency.THREADS if simulation.method.threads else Concurrency.PROCESSES


def workers_for(simulation: Simulation) -> int:
    """Default number of workers of a study: no more threads than it has blocks."""
    trials = simulation.study.trials
    suggested = suggested_workers(trials * contacts_of(simulation), concurrency_of(simulation))
    if concurrency_of(simulation) is Concurrency.PROCESSES:
        return suggested
    return min(suggested, -(-trials // block_trials(simulation)))


def task_of(simulation: Simulation, fingerprint: str, *, keep_trials: bool) -> "Task":
    """Task of the workers; its pilot trials load what trials need: that is setup, not simulation."""
    versions = installed_versions(simulation.requires)
    for measure in simulation.system.measures[:1]:
        looked_at(simulation, measure)  # once, for all workers
    pilot = Task(simulation, materials_of(simulation), {}, fingerprint, keep_trials, versions)
    return replace(pilot, grids=grids_of(simulation.system, pilot.columns(0, PILOT_TRIALS)))


@dataclass(frozen=True, eq=False)
class Task:
    """Blocks of a study. Equal by fingerprint, so that a process makes one method for all of its calls.

    Args:
        simulation: to be run.
        materials: of its method.
        grids: the empty grid of each scalar measure; none for a pilot, which has no statistics.
        fingerprint: one a study.
        keep_trials: whether the columns of a whole block are wanted, or its statistics only.
        versions: of the packages that decide the last bit, as installed_versions has it.
        pace: of the pieces of blocks.
    """

    simulation: Simulation
    materials: Any
    grids: Mapping[str, Grid]
    fingerprint: str
    keep_trials: bool
    versions: Versions
    pace: Pace = field(default_factory=partial(Pace, piece=PIECE_S))

    @property
    def concurrency(self) -> Concurrency:
        """See folding.Work."""
        return concurrency_of(self.simulation)

    @property
    def requires(self) -> tuple[str, ...]:
        """Packages that its system needs."""
        return self.simulation.requires

    @property
    def method(self) -> Method | None:
        """The method of this process; None for an analytic study."""
        return _method_of(self)

    def columns(self, first: int, count: int) -> Columns:
        """See folding.Work."""
        refuse_other_versions(self.versions, self.requires)
        with faults_of(self.simulation.mechanism):  # here too: what is raised in a process loses where it came from
            return self._by_threads_or_one(first, count)

    def _by_threads_or_one(self, first: int, count: int) -> Columns:
        if self.concurrency is Concurrency.THREADS:
            return self._columns(first, count)
        with _ONE_AT_A_TIME:  # a method of processes may have state, and a Dask worker has several threads
            return self._columns(first, count)

    def _columns(self, first: int, count: int) -> Columns:
        return columns_of(self.simulation.system, self.method, drawn(self.simulation, first, count))

    def statistics(self, first: int, columns: Columns) -> Tally:
        """See folding.Work."""
        return Tally.of(self.simulation, self.grids, columns, first)

    def block(self, first: int, count: int, progress: Progress) -> tuple[Columns | None, Tally]:
        """See folding.Work; in pieces of about PIECE_S, whose bits are those of the whole."""
        pieces, at = list[Columns](), first
        while at < first + count:
            trials, begun = max(self.pace.count // TOGETHER, 1) * TOGETHER, time.perf_counter()
            trials = min(trials, first + count - at)
            pieces.append(self.columns(at, trials))
            self.pace.took(trials, time.perf_counter() - begun)
            progress(trials)
            at += trials
        columns = joined_columns(pieces)
        return columns if self.keep_trials else None, self.statistics(first, columns)

    def __hash__(self) -> int:
        return hash(self.fingerprint)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Task) and other.fingerprint == self.fingerprint


_ONE_AT_A_TIME = threading.Lock()


@lru_cache(maxsize=1)
def _method_of(task: Task) -> Method | None:
    return method_of(task.simulation, task.materials)


BLOCK_TRIALS: Final = 65_536
AUTO_BLOCK_TRIALS: Final = 16_384  # of a study that may stop after any block
AUTO_SLOW_BLOCK_TRIALS: Final = 2048  # the same where a trial is slow: a second of them
BLOCK_VALUES: Final = 2**22  # values of a curve, or of all draws, in one block: 32 MB


def block_trials(simulation: Simulation) -> int:
    """Trials of a canonical block: fewer where curves keep many positions, a trial has many draws, or it takes long."""
    curves = (measure for measure in simulation.system.measures if measure.take == "curve")
    kept = max((measure.positions.in_a_trial for measure in curves), default=1)
    values = max(kept, component_count(simulation.system), 1)
    return max(min(_most(simulation), _tidy(BLOCK_VALUES / values), *_in_time(simulation)), 1)


def _in_time(simulation: Simulation) -> list[int]:
    most = simulation.method.block_contacts
    return [] if most is None else [_tidy(most / max(contacts_of(simulation), 1))]


def _tidy(trials: float) -> int:
    return 1 << max(int(math.log2(trials)), 0)


def _most(simulation: Simulation) -> int:
    if not simulation.study.until:
        return BLOCK_TRIALS
    return AUTO_BLOCK_TRIALS if simulation.method.threads else AUTO_SLOW_BLOCK_TRIALS


def contacts_of(simulation: Simulation) -> int:
    """Number of contacts that one trial takes."""
    return simulation.system.cost(simulation.system.measures)


def plan_of(simulation: Simulation) -> Plan:
    """Largest number of trials, and their division into blocks."""
    return Plan(simulation.study.trials, block_trials(simulation), contacts_of(simulation))
