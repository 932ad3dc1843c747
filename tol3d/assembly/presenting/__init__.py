"""Presentation of assemblies: features as they lie in a trial, deviations magnified; tables of parts and moves.

symbols         closed surfaces that represent features
shown_assembly  a build's parts, for pictures and files of triangles
measured_lines  lines along which measures are read
tables          tables of a scene
parts_tree      tree of parts that lie on others
"""

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from tol3d.report.presenter import ShowsBuilds
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.run import RunSummary

if TYPE_CHECKING:
    from collections.abc import Callable

    from tol3d.report.page import PageItem
    from tol3d.report.presenter import Display, Draw, FurtherRow, Map, Which
    from tol3d.study.results.replaying import Replay
    from tol3d.study.runs.run import Run
    from tol3d.study.trials.simulation import Simulation


class AssemblyPresenter(ShowsBuilds):
    """The presenter of assemblies; see `tol3d.report.presenter.Presenter`."""

    def pictures(self, summary: RunSummary) -> "Mapping[str, Draw]":
        """None besides the histograms."""
        return {}

    def sections(self, summary: RunSummary) -> "Sequence[PageItem]":
        """Laws of deviations in their zones."""
        laws: dict[str, str] = {}
        sigmas: dict[str, float] = {}
        for measure in summary.measures.values():
            laws |= measure.laws or {}
            sigmas |= measure.law_sigmas_um or {}
        return _lazily("tables").law_blocks(laws, sigmas) if laws else ()

    def measure_rows(self, measure: MeasureSummary, summary: RunSummary) -> "Sequence[FurtherRow]":
        """None."""
        return ()

    def check(self, simulation: "Simulation") -> "Sequence[PageItem]":
        """Features with their datum frames, moves, and what any system shows."""
        return _lazily("tables").check_blocks(simulation)  # type: ignore[no-any-return]

    def parts(self, simulation: "Simulation") -> "Sequence[PageItem]":
        """Tree of parts, each below the one on which its move places it."""
        return _lazily("tables").parts_blocks(simulation)  # type: ignore[no-any-return]

    def workspace(self, simulation: "Simulation", measure: str | None, activity: "Callable[[str], None]") -> "Map":
        """That of the first move that has one; see `tol3d.report.presenter.Mapped`."""
        return _lazily("tables").workspace(simulation, measure, activity)  # type: ignore[no-any-return]

    def display(self, run: "Run", which: "Which", *, magnify: float) -> "Display":
        """A build of a run; the worst of those that could be assembled, if no other can be shown."""
        return _lazily("shown_assembly").display(run, which, magnify=magnify)  # type: ignore[no-any-return]

    def shown(self, build: "Replay", label: str, *, magnify: float) -> "Display":
        """A build with its parts placed again, its deviations magnified as far as it can be assembled."""
        return _lazily("shown_assembly").shown(build, label, magnify=magnify)  # type: ignore[no-any-return]


def _lazily(module: str) -> Any:
    """A module of this folder, imported when it is needed."""
    return import_module(f"{__name__}.{module}")


PRESENTER: Final = AssemblyPresenter()
