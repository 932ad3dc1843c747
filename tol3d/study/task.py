"""What workers run: blocks of a study's trials, from their numbers to columns and statistics."""

import importlib
import importlib.metadata
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import RunError
from tol3d.execution.pools import Way, suggested_workers
from tol3d.gearing.engines import Engine
from tol3d.gearing.engines.lazy import exact_engine
from tol3d.gearing.model import Model
from tol3d.numerics.processor import processor, unlike
from tol3d.solids import FlankStrips, measuring_strips
from tol3d.statistics import Grid
from tol3d.study.block import block_trials, drawn_block, positions_in_all, simulate_block
from tol3d.study.tally import Tally

VERSIONS_OF = ("tol3d", "numpy", "scipy", "numba", "llvmlite", "python-fcl", "cadquery")

Columns = dict[str, NDArray[np.generic]]
Strips = Mapping[str, FlankStrips]


def strips_of(model: Model) -> dict[str, FlankStrips]:
    """Measuring strips of every gear, from its CAD solid (cached on disk)."""
    return {part.name: measuring_strips(part.gear, model.study.profile_steps) for part in model.gears}


def strips_for(model: Model) -> Strips | None:
    """The strips that the study's engine measures with; None if it needs none."""
    return strips_of(model) if model.study.engine == "fcl" else None


def engine_of(model: Model, strips: Strips | None) -> Engine | None:
    """The engine that the study names, on its strips; None for an analytic study."""
    match model.study.engine:
        case "analytic":
            return None
        case "fcl":
            return fcl_engine(model, strips or {})
        case "exact":
            return exact_engine(model)


def fcl_engine(model: Model, strips: Strips) -> Engine:
    """FCL on measuring strips; the library is loaded only by who measures with it."""
    engine: Engine = importlib.import_module("tol3d.gearing.engines.fcl").FclEngine(model, strips)
    return engine


def way_of(engine: str) -> Way:
    """How an engine's trials are handed out: FCL holds Python's lock and takes half a minute for a block."""
    return Way.PROCESSES if engine == "fcl" else Way.THREADS


def workers_for(model: Model) -> int:
    """How many workers a study is worth where nobody says: no more threads than it has blocks."""
    contacts = model.study.trials * positions_in_all(model)
    suggested = suggested_workers(contacts, way_of(model.study.engine))
    if way_of(model.study.engine) is Way.PROCESSES:
        return suggested
    return min(suggested, -(-model.study.trials // block_trials(model)))


@dataclass(frozen=True, eq=False)
class Task:
    """Blocks of a study. Equal by fingerprint, so that a process makes one engine for all of its calls.

    Args:
        model: what is simulated.
        strips: what an engine needs besides.
        grids: the empty grid of each scalar measure; none for a pilot, which has no statistics.
        fingerprint: tells studies apart.
        keep_trials: whether the columns of a whole block are wanted, or its statistics only.
        versions: of what decides the last bit, as installed_versions has it.
    """

    model: Model
    strips: Strips | None
    grids: Mapping[str, Grid]
    fingerprint: str
    keep_trials: bool
    versions: tuple[tuple[str, str], ...]

    @property
    def way(self) -> Way:
        """See folding.Work."""
        return way_of(self.model.study.engine)

    @property
    def engine(self) -> Engine | None:
        """The engine of this process; None for an analytic study."""
        return _engine_of(self)

    def columns(self, first: int, count: int) -> Columns:
        """See folding.Work."""
        refuse_other_versions(self.versions)
        if self.way is Way.THREADS:
            return self._columns(first, count)
        with _ONE_AT_A_TIME:  # an engine of processes may have state, and a Dask worker has several threads
            return self._columns(first, count)

    def _columns(self, first: int, count: int) -> Columns:
        return simulate_block(self.model, self.engine, drawn_block(self.model, self.model.study.seed, first, count))

    def statistics(self, first: int, columns: Columns) -> Tally:
        """See folding.Work."""
        return Tally.of(self.model, self.grids, columns, first)

    def block(self, first: int, count: int) -> tuple[Columns | None, Tally]:
        """See folding.Work."""
        columns = self.columns(first, count)
        return columns if self.keep_trials else None, self.statistics(first, columns)

    def __hash__(self) -> int:
        return hash(self.fingerprint)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Task) and other.fingerprint == self.fingerprint

    def __getstate__(self) -> dict[str, Any]:
        """Grids travel as what they are made of: a megabyte of zeros each would go with every call."""
        spans = {name: (grid.lower, grid.width, len(grid.counts)) for name, grid in self.grids.items()}
        return {**self.__dict__, "grids": spans}

    def __setstate__(self, state: dict[str, Any]) -> None:
        grids = {name: Grid.empty(*span) for name, span in state["grids"].items()}
        self.__dict__.update({**state, "grids": grids})


_ONE_AT_A_TIME = threading.Lock()


@lru_cache(maxsize=1)
def _engine_of(task: Task) -> Engine | None:
    return engine_of(task.model, task.strips)


@cache
def installed_versions() -> tuple[tuple[str, str], ...]:
    """What decides a result's last bit, here: versions of packages, and the processor."""
    packages = {name: importlib.metadata.version(name) for name in VERSIONS_OF}
    return tuple({**packages, **processor()}.items())


@cache
def refuse_other_versions(versions: tuple[tuple[str, str], ...]) -> None:
    """Refuse to work for a run whose results might differ in the last bit.

    Raises:
        RunError: a package has another version here, or the processor is of another kind.
    """
    asked, own = dict(versions), dict(installed_versions())
    pairs = {
        name: unlike(own.get(name), asked.get(name)) for name in {**asked, **own} if own.get(name) != asked.get(name)
    }
    if pairs:
        other = "; ".join(f"{name} {here} instead of {there}" for name, (here, there) in pairs.items())
        raise RunError(
            f"a worker has {other}: results could differ in the last bit; install the same packages there, and start "
            "the run on a machine with the workers' kind of processor"
        )
