"""A run as programs and notebooks get it: it shows itself, and draws its measures."""

from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from tol3d.study.runs.run import Run
from tol3d.study.runs.run import open_run as opened

if TYPE_CHECKING:
    from tol3d.report.figures import MeasureFigures

FIGURES = "tol3d.report.figures"  # loads what draws, and so not before it is asked for
SHOWN = "tol3d.report.html.blocks"  # so does this, tables


@dataclass(frozen=True, repr=False)
class DisplayedRun(Run):
    """A finished run that shows itself in notebooks; see Run."""

    @classmethod
    def of(cls, run: Run) -> "DisplayedRun":
        """The same run."""
        return cls(run.path, run.summary, run.kinds)

    def _repr_html_(self) -> str:
        """Name of the run and its verdict, for notebooks."""
        shown: str = import_module(SHOWN).run_html(self)
        return shown

    def measure(self, name: str) -> "MeasureFigures":
        """One of its measures, to draw: `run.measure("play").histogram()`, and pareto, difference, convergence.

        Raises:
            InputError: no such measure.
        """
        figures: MeasureFigures = import_module(FIGURES).measure_figures(self, name)
        return figures


def open_run(path: Path | str) -> DisplayedRun:
    """Open a run's folder, which a stranger may have made; executes nothing of it: see tol3d.study.runs.run.open_run.

    Raises:
        RunError: not a run, damaged, or changed since it was made.
    """
    return DisplayedRun.of(opened(path))
