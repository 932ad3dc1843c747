"""Pictures of one measure of a run as figures of matplotlib, for notebooks and papers."""

from dataclasses import dataclass
from typing import Final

from matplotlib.figure import Figure

from tol3d.errors import InputError, RunError
from tol3d.report.chart_figure import charts_figure
from tol3d.report.column import shares_of
from tol3d.report.compare import difference_of
from tol3d.report.histogram import histogram_figure, of_measures
from tol3d.report.share_charts import pareto
from tol3d.report.shown_unit import shown_run
from tol3d.report.trial_charts import convergence, convergence_of, differences, shown_runs
from tol3d.scene.nearest import hint
from tol3d.study.runs.run import Run
from tol3d.study.runs.summary.measure import MeasureSummary

POINTS: Final = 200
"""Numbers of trials at which a convergence is drawn."""


@dataclass(frozen=True)
class MeasureFigures:
    """One measure of a run, drawn.

    Args:
        run: a finished one.
        name: the measure's.
    """

    run: Run
    name: str

    @property
    def summary(self) -> MeasureSummary:
        """Its numbers, in its unit."""
        return self.run.found.measures[self.name]

    def histogram(self) -> Figure:
        """Both methods' histograms with limits, ends and published ranges, contributors beside; a curve as it runs."""
        return histogram_figure(of_measures(self.run.found, [self.name]))

    def pareto(self) -> Figure:
        """Shares of the variance, the largest first.

        Raises:
            InputError: none is known, as of a curve.
        """
        measure = shown_run(self.run.found).measures[self.name]
        if measure.take == "curve" or not shares_of(measure):
            raise InputError(f"{self.name}: expected shares of its variance, got none")
        return charts_figure([[pareto(measure)]])

    def difference(self) -> Figure:
        """The 3D simulation less the analytic method, trial by trial.

        Raises:
            InputError: the run has no 3D simulation. RunError: it kept no trials.
        """
        own = difference_of(self.run, self.name) if self.run.keeps_trials else None
        if own is None:
            raise _lacking(self.run, self.name)
        return charts_figure([[differences(self.name, self.summary.unit, [(shown_runs([self.run])[0], own)])]])

    def convergence(self) -> Figure:
        """Mean and sigma of the first trials over how many they are, with what 95 % of other draws would give.

        Raises:
            InputError: a curve, which has no one mean. RunError: the run kept no trials.
        """
        own = convergence_of(self.run, self.name, POINTS)
        return charts_figure([[convergence(self.name, self.summary, own)]])


def _lacking(run: Run, name: str) -> InputError | RunError:
    if not run.keeps_trials:
        return RunError(f"{run.path}: this run kept its statistics only (--no-trials); run the scene again with them")
    return InputError(f"{name}: expected a run with a 3D simulation, got an analytic one")


def measure_figures(run: Run, name: str) -> MeasureFigures:
    """The figures of a measure.

    Raises:
        InputError: the run has no such measure.
    """
    if name not in run.found.measures:
        raise InputError(f"expected a measure, got {name!r}{hint(name, run.found.measures)}")
    return MeasureFigures(run, name)


# overview -----------------------------------------------------------------------------------------
