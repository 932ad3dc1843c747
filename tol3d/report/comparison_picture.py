"""Runs laid over each other: histograms of both methods, the difference of every trial beside."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from matplotlib.figure import Figure

from tol3d.report.canvas import (
    save_figure,
)
from tol3d.report.chart_figure import charts_figure
from tol3d.report.compare import difference_of, labelled, measures_of, require_shared_measures
from tol3d.report.trial_charts import NO_SIMULATION, NO_TRIALS, by_position, compared_runs, differences, shown_runs
from tol3d.study.runs.run import Run

WIDTH: Final = 15.0  # inch

RATIOS: Final = (1.6, 1.0, 1.3)


def draw_comparison(runs: Sequence[Run], path: Path) -> None:
    """Draw a row a measure: histograms of both methods, histogram of their differences, differences by position.

    Raises:
        InputError: there are no runs, they share no measure, or the picture cannot be written.
    """
    save_figure(comparison_figure(runs), path)


def comparison_figure(runs: Sequence[Run]) -> Figure:
    """The picture of `draw_comparison`, not yet written.

    Raises:
        InputError: there are no runs, or they share no measure.
    """
    require_shared_measures(runs)
    shown, rows = shown_runs(runs), []
    for measure in measures_of(runs):
        own = [each for each in shown if measure in measures_of([each.run])]
        found = [(each, difference_of(each.run, measure.name)) for each in own]
        known = [(each, difference) for each, difference in found if difference is not None]
        instead = NO_SIMULATION if any(each.run.keeps_trials for each in own) else NO_TRIALS
        beside = (differences(measure.name, measure.unit, known, instead), by_position(measure, known, instead))
        rows.append([compared_runs(measure, own), *beside])
    names = ",   ".join(label for label, _ in labelled(runs))
    return charts_figure(rows, names, WIDTH, RATIOS)
