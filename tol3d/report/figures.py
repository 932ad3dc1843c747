"""Pictures of one measure of a run as figures of matplotlib, for notebooks and papers."""

from dataclasses import dataclass
from typing import Final

from matplotlib.figure import Figure

from tol3d.errors import InputError, RunError
from tol3d.report.bars import draw_contributors, height_of_contributors
from tol3d.report.canvas import BLACK, METHOD_COLOURS, label_angles, new_figure, plain_axes, title_axes
from tol3d.report.column import columns_of
from tol3d.report.compare import difference_of
from tol3d.report.comparison_picture import DIFFERENCE_UNITS
from tol3d.report.convergence import CONFIDENCE, convergence_of
from tol3d.report.distribution import column_colours, values_label
from tol3d.report.heading import heading
from tol3d.report.histogram import histogram_figure, of_measures
from tol3d.report.shown_unit import shown_run
from tol3d.runs.run import Run
from tol3d.runs.summary.measure import MeasureSummary
from tol3d.scene.nearest import hint

WIDTH, HEIGHT = 9.0, 4.2  # inch
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
        height = height_of_contributors(measure) if measure.take != "curve" else 0.0
        if not height:
            raise InputError(f"{self.name}: expected shares of its variance, got none")
        figure = new_figure(WIDTH, height + 0.6)
        draw_contributors(figure.add_subplot(), measure, column_colours(columns_of(measure)))
        return figure

    def difference(self) -> Figure:
        """The 3D simulation less the analytic method, trial by trial.

        Raises:
            InputError: the run has no 3D simulation. RunError: it kept no trials.
        """
        own = difference_of(self.run, self.name) if self.run.keeps_trials else None
        if own is None:
            raise _lacking(self.run, self.name)
        unit, factor = DIFFERENCE_UNITS[self.summary.unit]
        figure = new_figure(WIDTH, HEIGHT)
        axes = plain_axes(figure.add_subplot())
        bars = own.bars.times(factor)
        axes.stairs(bars.counts, bars.edges, fill=True, color=METHOD_COLOURS["geometric"], alpha=0.6)
        title_axes(
            axes, self.name, f"rms {factor * own.rms:.3g} {unit}, at most {factor * own.largest:.3g} {unit}", 8.0
        )
        axes.set_xlabel(f"3D simulation − analytic [{unit}]")
        axes.set_ylabel("trials")
        return figure

    def convergence(self) -> Figure:
        """Mean and sigma of the first trials over how many they are, with what 95 % of other draws would give.

        Raises:
            InputError: a curve, which has no one mean. RunError: the run kept no trials.
        """
        own = convergence_of(self.run, self.name, POINTS)
        figure = new_figure(WIDTH, 1.5 * HEIGHT)
        for row, (word, found, error) in enumerate(
            (("mean", own.mean, own.mean_error), ("sigma", own.sigma, own.sigma_error))
        ):
            axes = plain_axes(figure.add_subplot(2, 1, row + 1))
            colour = METHOD_COLOURS[self.summary.best_method]
            axes.fill_between(
                own.counts, found - CONFIDENCE * error, found + CONFIDENCE * error, color=colour, alpha=0.2, linewidth=0
            )
            axes.plot(own.counts, found, color=colour)
            axes.axhline(float(found[-1]), color=BLACK, linewidth=0.8, linestyle=":")
            axes.set_xscale("log")
            axes.set_ylabel(values_label(word, self.summary.unit))
            label_angles(axes.yaxis, self.summary.unit)
            if row == 0:
                title_axes(axes, self.name, heading(self.summary), 8.0)
        axes.set_xlabel("trials")
        return figure


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
