"""Runs laid over each other: histograms of both roads, the difference of every trial beside, and a table."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation
from rich.console import Group, RenderableType
from rich.text import Text

from tol3d.errors import InputError
from tol3d.report.bars import bars_of
from tol3d.report.canvas import (
    BLACK,
    GREY,
    OUTSIDE,
    ROAD_COLOURS,
    RUN_COLOURS,
    label_angles,
    legible,
    new_figure,
    plain_axes,
    save_figure,
    say_instead,
    title_measure,
)
from tol3d.report.difference import Difference, difference_of
from tol3d.report.heading import heading, position_of, reading_words
from tol3d.report.histogram import density_label, values_label
from tol3d.report.number import NOTHING, UNIT_SIGNS, difference_text, given_text, value_text
from tol3d.report.sheet import Heading, Row, Sheet, note
from tol3d.result import Run

Summary = Mapping[str, Any]

NO_SIMULATION = "no 3D simulation in these runs"
NO_ONE_MEAN = "no row: it is 0 with the load on one side and jumps where the load changes side; the picture shows it"
NO_TRIALS = "these runs kept no trials (--no-trials)"
ROADS = {"analytic": "analytic", "geometric": "3D simulation"}
SHORT = {"analytic": "analytic", "geometric": "3D"}
ROW_HEIGHT = 4.1  # inch, of a measure without its legend
LEGEND_LINE, LEGEND_BELOW = 0.2, 0.5  # inch; height of a line, and from the axis to the first one
DIFFERENCE_UNITS = {"um": ("µm", 1.0), "mm": ("µm", 1000.0), "arcmin": ("″", 60.0)}
"""Unit of small differences, and how many of it are one of the measure's unit."""


@dataclass(frozen=True)
class Compared:
    """A measure as runs may share it on one axis; the same name over other positions is another measure.

    Args:
        name, unit, kind, over, take, reading: as in its summary.
        at: the gear whose angle it is, the shaft that is read, or the point of an arm.
    """

    name: str
    unit: str
    kind: str
    at: str | None
    over: str
    take: str
    reading: str

    @classmethod
    def of(cls, name: str, measure: Summary) -> "Compared":
        """From a measure's summary."""
        unit, kind, over, take = (measure[key] for key in ("unit", "kind", "over", "take"))
        at = measure["gear"] or measure.get("point") or measure.get("shaft")
        return cls(name, unit, kind, at, over, take, reading_words(measure["reading"]))

    @property
    def jumps(self) -> bool:
        """Whether it is a curve whose mean over its positions says nothing: many of them are 0."""
        return (self.kind, self.take) == ("tip_error", "curve")

    def found_in(self, runs: Sequence[Run]) -> list[tuple[str, Run]]:
        """The runs that have it, each with its label."""
        return [(label, run) for label, run in _labelled(runs) if self in measures_of([run])]


def measures_of(runs: Sequence[Run]) -> list[Compared]:
    """The measures of all runs, each once.

    Raises:
        InputError: there are no runs.
    """
    if not runs:
        raise InputError("nothing to compare: give the folder of at least one run")
    found = (Compared.of(name, measure) for run in runs for name, measure in run.summary["measures"].items())
    return list(dict.fromkeys(found))


def comparison_report(runs: Sequence[Run]) -> Group:
    """Tables of every measure: mean, sigma and range of each run and road, and how far the roads differ."""
    blocks: list[RenderableType] = []
    for measure in measures_of(runs):
        own = measure.found_in(runs)
        blocks += [Text("\n").append(measure.name, style="bold cyan")]
        blocks += [Text(heading(own[0][1].summary["measures"][measure.name]), style="dim")]
        blocks += [note(NO_ONE_MEAN)] if measure.jumps else ["", _table(measure.name, measure.unit, own)]
    words = "low and high: mean ∓ 3 sigma; max and rms: of 3D simulation − analytic, trial by trial"
    words += "; shift: of the mean against the first run" if len(runs) > 1 else ""
    blocks.append(Text(f"\n{words}", style="dim"))
    return Group(*blocks)


def _labelled(runs: Sequence[Run]) -> list[tuple[str, Run]]:
    """Each run with the shortest name that tells it from the others."""
    names = [run.path.resolve().name for run in runs]
    return [(name if names.count(name) == 1 else str(run.path), run) for name, run in zip(names, runs, strict=True)]


def _table(name: str, unit: str, runs: Sequence[tuple[str, Run]]) -> Sheet:
    shift = ("shift",) if len(runs) > 1 else ()
    numbers = ("trials", "mean", "sigma", "low", "high", "max", "rms", *shift)
    headings = [Heading("road", words=True), *(Heading(word) for word in numbers)]
    rows, first = [], dict[str, float]()
    for label, run in runs:
        for index, (road, sample) in enumerate(_samples(run.summary["measures"][name])):
            mean = sample.get("mean")
            cells = [SHORT[road], str(sample.get("count", "")), *(value_text(sample.get(key), unit) for key in KEYS)]
            cells += _differences(run, name, unit) if road == "geometric" else [NOTHING, NOTHING]
            if shift:
                cells.append(NOTHING if mean is None else _bare(mean - first.setdefault(road, mean), unit))
            rows.append(Row(label if index == 0 else "", cells))
    return Sheet("run" if unit == "arcmin" else f"run [{UNIT_SIGNS[unit]}]", headings, rows, repeated=1)


KEYS = ("mean", "sigma", "low_3sigma", "high_3sigma")


def _samples(measure: Summary) -> Iterator[tuple[str, Summary]]:
    """What each road found; of a curve the average over its positions."""
    for road in ROADS:
        if measure["take"] != "curve" and road in measure:
            yield road, measure[road]
        elif road in measure.get("curve", {}):
            curve = {key: [v for v in measure["curve"][road][key] if v is not None] for key in ("mean", "sigma")}
            yield road, {key: float(np.mean(values)) for key, values in curve.items() if values}


def _differences(run: Run, name: str, unit: str) -> list[str]:
    agreement = run.summary["measures"][name].get("agreement")
    if agreement is not None:
        found = (agreement["max_abs_difference"], agreement["rms_difference"])
    else:
        difference = difference_of(run, name)
        found = (difference.largest, difference.rms) if difference else (None, None)
    return [_bare(value, unit) for value in found]


def _bare(difference: float | None, unit: str) -> str:
    """A difference in a table whose corner tells the unit."""
    return difference_text(difference, unit).removesuffix(f" {UNIT_SIGNS[unit]}")


# picture ------------------------------------------------------------------------------------------


def draw_comparison(runs: Sequence[Run], path: Path) -> None:
    """Draw a row a measure: histograms of both roads, histogram of their differences, differences by position.

    Raises:
        InputError: there are no runs, or the picture cannot be written.
    """
    save_figure(comparison_figure(runs), path)


def comparison_figure(runs: Sequence[Run]) -> Figure:
    """The picture of `draw_comparison`, not yet written.

    Raises:
        InputError: there are no runs.
    """
    measures = measures_of(runs)
    height = ROW_HEIGHT + LEGEND_LINE * (len(runs) + 1)  # a line a run, and one of limits
    figure = new_figure(15.0, height * len(measures) + 0.4)
    names = ",  ".join(legible(label, 50) for label, _ in _labelled(runs))
    figure.suptitle(f"{names}", fontsize=12, color=BLACK, x=0.01, ha="left")
    grid = figure.add_gridspec(len(measures), 3, width_ratios=[1.6, 1, 1.3])
    for row, measure in enumerate(measures):
        name, unit, own = measure.name, measure.unit, measure.found_in(runs)
        axes = [plain_axes(figure.add_subplot(grid[row, column])) for column in range(3)]
        _draw_roads(figure, axes[0], name, unit, own)
        differences = [(label, difference_of(run, name)) for label, run in own]
        known = [(index, label, found) for index, (label, found) in enumerate(differences) if found is not None]
        instead = NO_SIMULATION if any(run.keeps_trials for _, run in own) else NO_TRIALS
        if not known:
            say_instead(axes[1], instead, GREY)
            say_instead(axes[2], instead, GREY)
        _draw_differences(axes[1], unit, known, single=len(own) == 1)
        _draw_by_position(axes[2], measure, known, single=len(own) == 1)
    return figure


def _colour(index: int, *, single: bool) -> str:
    return ROAD_COLOURS["geometric"] if single else RUN_COLOURS[index % len(RUN_COLOURS)]


def _draw_roads(figure: Figure, axes: Axes, name: str, unit: str, runs: Sequence[tuple[str, Run]]) -> None:
    single = len(runs) == 1
    for index, (label, run) in enumerate(runs):
        measure = run.summary["measures"][name]
        colours = {"geometric": _colour(index, single=single)}
        colours["analytic"] = ROAD_COLOURS["analytic"] if single else colours["geometric"]
        where = "" if single else f"{legible(label, 24)}: "
        if measure["take"] == "curve":
            _draw_curves(axes, measure, where, colours)
            continue
        for road, bars in bars_of(measure["histogram"]).items():
            filled = road == "geometric"
            axes.stairs(
                bars.density,
                bars.edges,
                fill=filled,
                alpha=0.45 if filled else 1.0,
                linestyle="-" if filled or single else "--",
                linewidth=0.0 if filled else 1.8,
                color=colours[road],
                label=f"{where}{ROADS[road]}",
            )
    first = runs[0][1].summary["measures"][name]
    if first["take"] != "curve":
        for limit in (first.get("lower_limit"), first.get("upper_limit")):
            if limit is not None and axes.get_xlim()[0] <= limit <= axes.get_xlim()[1]:
                axes.axvline(limit, color=OUTSIDE, linewidth=2, label=f"limit {given_text(limit, unit)}")
        label_angles(axes.xaxis, unit)
        axes.set_xlabel(values_label(name, unit), fontsize=10)
        axes.set_ylabel(density_label(unit), fontsize=10)
    else:
        label_angles(axes.yaxis, unit)
        axes.set_xlabel(f"{position_of(first)} position [deg]", fontsize=10)
        axes.set_ylabel(values_label(name, unit, 34), fontsize=10)
    title_measure(axes, name, first, 90)
    _add_legend(axes, figure)


def _add_legend(axes: Axes, figure: Figure) -> None:
    """A legend below the axis and its label, where it hides nothing; row by row in two columns."""
    handles, labels = axes.get_legend_handles_labels()
    rows_first = [*range(0, len(labels), 2), *range(1, len(labels), 2)]  # matplotlib fills column by column
    axes.legend(
        [handles[index] for index in rows_first],
        [labels[index] for index in rows_first],
        ncols=2,
        loc="upper left",
        bbox_to_anchor=(0.0, 0.0),
        bbox_transform=axes.transAxes + ScaledTranslation(0.0, -LEGEND_BELOW, figure.dpi_scale_trans),
        borderaxespad=0.0,
        fontsize=8.5,
        frameon=False,
    )


def _draw_curves(axes: Axes, measure: Summary, where: str, colours: Mapping[str, str]) -> None:
    for road, style in (("geometric", "-"), ("analytic", "--")):
        if road in measure["curve"]:
            mean = np.asarray(measure["curve"][road]["mean"], dtype=float)
            label = f"{where}{ROADS[road]}, mean"
            axes.plot(measure["position_deg"], mean, style, linewidth=2, color=colours[road], label=label)


Known = Sequence[tuple[int, str, Difference]]


def _draw_differences(axes: Axes, unit: str, known: Known, *, single: bool) -> None:
    word, factor = DIFFERENCE_UNITS[unit]
    axes.set_title("3D simulation − analytic\n", loc="left", fontsize=11, fontweight="bold")
    if not known:
        return
    for index, label, found in known:
        text = f"max {factor * found.largest:.3f} {word}, rms {factor * found.rms:.3f} {word}"
        axes.stairs(
            found.bars.density / factor,
            factor * found.bars.edges,
            fill=True,
            alpha=0.45,
            color=_colour(index, single=single),
            label=text if single else f"{legible(label, 20)}: {text}",
        )
    axes.axvline(0, color=BLACK, linewidth=0.8)
    axes.set_xlabel(f"difference of a trial [{word}]", fontsize=10)
    axes.set_ylabel("share of trials", fontsize=10)
    axes.set_yticks([])
    axes.locator_params(axis="x", nbins=6)
    axes.margins(y=0.22 + 0.05 * len(known))
    axes.set_ylim(bottom=0)
    axes.legend(fontsize=8.5, frameon=False, loc="upper left")


def _draw_by_position(axes: Axes, measure: Compared, known: Known, *, single: bool) -> None:
    word, factor = DIFFERENCE_UNITS[measure.unit]
    turning = position_of({"kind": measure.kind})
    by_position = all(found.by_position for _, _, found in known)
    title = f"by position of the {turning}" if by_position else "by value"
    axes.set_title(f"difference {title}\n", loc="left", fontsize=11, fontweight="bold")
    if not known:
        return
    for index, _, found in known:
        axes.plot(
            found.at,
            factor * found.values,
            linestyle="",
            marker=".",
            markersize=3.5,
            markeredgewidth=0,
            alpha=0.5,
            color=_colour(index, single=single),
        )
    axes.axhline(0, color=BLACK, linewidth=0.8)
    if by_position:
        turn = " within its turn" if turning == "driver" else ""
        axes.set_xlabel(f"{turning} position{turn} [deg]", fontsize=10)
    else:
        label_angles(axes.xaxis, measure.unit)
        axes.set_xlabel(f"analytic: {values_label(measure.name, measure.unit, 40)}", fontsize=10)
    axes.set_ylabel(f"difference [{word}]", fontsize=10)
