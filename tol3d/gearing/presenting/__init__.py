"""Presentation of gears in mesh and of trains: chains, tables of stages, parts in one world, contacts and gaps."""

from collections.abc import Mapping, Sequence
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from tol3d.gearing.summary.types import BacklashOfRun, TrainsOfRun
from tol3d.report.presenter import ShowsBuilds
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.run import RunSummary

if TYPE_CHECKING:
    from tol3d.report.page import PageItem
    from tol3d.report.presenter import Display, Draw, FurtherRow
    from tol3d.study.results.replaying import Replay
    from tol3d.study.trials.simulation import Simulation

DISPLAY: Final = "tol3d.gearing.shown.display"  # the module that seats gears again


class GearPresenter(ShowsBuilds):
    """The presenter of gears; see `tol3d.report.presenter.Presenter`."""

    def pictures(self, summary: RunSummary) -> "Mapping[str, Draw]":
        """The chain of every train: "chain" of the first, "chain-<train>" of the others.

        >>> list(PRESENTER.pictures(TrainsOfRun.model_construct(trains={"shoulder": ..., "wrist": ...})))
        ['chain', 'chain-wrist']
        """
        trains = (summary.trains or {}) if isinstance(summary, TrainsOfRun) else {}
        return {f"chain-{name}" if k else "chain": partial(_draw_chain, summary, name) for k, name in enumerate(trains)}

    def sections(self, summary: RunSummary) -> "Sequence[PageItem]":
        """Limits of backlash, tables of every train, and those of its links."""
        limits = (summary.backlash or ()) if isinstance(summary, BacklashOfRun) else ()
        backlash = _lazily("drawing_sizes").backlash_table(limits)
        return (
            *backlash,
            *_lazily("train_tables").train_report(summary),
            *_lazily("shown_train").link_sections(summary),
        )

    def measure_rows(self, measure: MeasureSummary, summary: RunSummary) -> "Sequence[FurtherRow]":
        """Rows with the sums of the stages' ends, if a measure is the sum of a train's stages."""
        return _lazily("train_tables").sum_rows(measure, summary)  # type: ignore[no-any-return]

    def check(self, simulation: "Simulation") -> "Sequence[PageItem]":
        """Tables of gears, meshes, trains, measures, and contributors with their coefficients."""
        return _lazily("scene_check").check_blocks(simulation)  # type: ignore[no-any-return]

    def shown(self, build: "Replay", label: str, *, magnify: float) -> "Display":
        """A build with its gears seated again, its deviations magnified as far as the teeth allow."""
        seated = import_module(DISPLAY).seated_build(build, label, magnify=magnify)
        return _lazily("shown_train").shown_build(seated)  # type: ignore[no-any-return]


def _draw_chain(summary: RunSummary, train: str, path: Path) -> None:
    _lazily("chain").draw_chain(summary, train, path)


def _lazily(module: str) -> Any:
    """A module of this folder, imported at its first use: a table needs no matplotlib, a picture no model."""
    return import_module(f"{__name__}.{module}")


PRESENTER: Final = GearPresenter()
