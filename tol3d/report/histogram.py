"""The pictures of a run: each measure's histogram with limits and published ranges, its contributors beside."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final, assert_never

from matplotlib.figure import Figure

from tol3d.report.canvas import save_figure
from tol3d.report.chart import Axis, Chart, Panel
from tol3d.report.chart_figure import charts_figure, matrix_figure
from tol3d.report.column import columns_of, shares_of
from tol3d.report.heading import shown_measures
from tol3d.report.measure_charts import SEATED, chart_of, column_roles
from tol3d.report.picture import MOST_TOGETHER, Pictures
from tol3d.report.share_charts import pareto, run_matrix
from tol3d.report.shown_unit import shown_run
from tol3d.study.runs.summary.run import RunSummary

WIDTH: Final = 13.0  # inch

HISTOGRAM_SHARE: Final = 2.2  # widths of the contributors' bars

OVERVIEW_COLUMNS: Final = 3

OVERVIEW_HEIGHT: Final = 0.5


def draw_histogram(summary: RunSummary, path: Path, pictures: Pictures = Pictures.WORST) -> None:
    """Draw the measures of a run: of more than MOST_TOGETHER the worst, or an overview of all.

    Args:
        summary: of the run.
        path: ends in .png, .svg or .pdf.
        pictures: which of many measures are drawn; with all of them each has a picture of its own (`measure_files`).

    Raises:
        InputError: the picture cannot be written there.
    """
    few = len(summary.measures) <= MOST_TOGETHER
    match pictures:
        case Pictures.ALL if not few:
            figure = overview_figure(summary)
        case Pictures.ALL | Pictures.WORST:
            figure = histogram_figure(summary)
        case _:
            assert_never(pictures)
    save_figure(figure, path)


def draw_measure(summary: RunSummary, name: str, path: Path) -> None:
    """Draw one measure of a run.

    Raises:
        InputError: the picture cannot be written there.
    """
    save_figure(histogram_figure(of_measures(summary, [name])), path)


def of_measures(summary: RunSummary, names: Sequence[str]) -> RunSummary:
    """A summary with some of its measures alone."""
    return summary.model_copy(update={"measures": {name: summary.measures[name] for name in names}})


def histogram_figure(summary: RunSummary) -> Figure:
    """Measures of a summary one below the other, of many the worst, each with its contributors; not yet written."""
    names, count = shown_measures(summary.measures, MOST_TOGETHER), len(summary.measures)
    measures = shown_run(of_measures(summary, names)).measures
    worst = f"   ·   the {len(names)} worst of {count} measures" if len(names) < count else ""
    columns = [column for measure in measures.values() if measure.take != "curve" for column in columns_of(measure)]
    roles = column_roles(columns)
    rows = [
        [chart_of(name, own, roles), *([pareto(own, roles)] if own.take != "curve" and shares_of(own) else [])]
        for name, own in measures.items()
    ]
    return charts_figure(rows, _head(summary) + worst, WIDTH, (HISTOGRAM_SHARE, 1.0))


def _head(summary: RunSummary) -> str:
    failed = sum(count for status, count in summary.status.items() if status != "ok")
    words = f"{summary.scene}   ·   {summary.trials} trials, seed {summary.seed}"
    return words + (f", {failed} failed" if failed else "")


def overview_figure(summary: RunSummary) -> Figure:
    """Every measure of a run small, several in a row, not yet written."""
    charts = [_small(chart_of(name, own)) for name, own in shown_run(summary).measures.items()]
    rows = [charts[k : k + OVERVIEW_COLUMNS] for k in range(0, len(charts), OVERVIEW_COLUMNS)]
    return charts_figure(rows, _head(summary), WIDTH, [1.0] * OVERVIEW_COLUMNS, shared=True)


def _small(chart: Chart) -> Chart:
    """A chart's first panel alone, the words at its lines above it."""
    if chart.instead:
        return replace(chart, words=chart.instead)
    panel, x = chart.panels[0], chart.x
    assert isinstance(x, Axis)
    assert isinstance(panel.y, Axis)
    y = replace(panel.y, label="", ticks=bool(panel.y.unit))
    marks = [replace(mark, words=()) for mark in panel.marks]
    words = "; ".join(f"{word} {text}" for word, text in chart.table)
    seated = chart.words.partition(SEATED)[2]
    small = Panel(y, panel.series, marks, OVERVIEW_HEIGHT)
    return replace(chart, x=replace(x, label=""), panels=[small], words=words + (f"; {seated}" if seated else ""))


def draw_heat_map(summary: RunSummary, path: Path) -> None:
    """Draw the shares of the largest contributors in the worst measures.

    Raises:
        InputError: the picture cannot be written there.
    """
    save_figure(matrix_figure(run_matrix(summary)), path)
