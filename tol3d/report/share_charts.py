"""Charts of contributors: their shares of the variance of a measure, and which tolerance matters where."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from tol3d.report.chart import Axis, Cells, Chart, Lengths, Names, Panel, Role
from tol3d.report.column import Column, columns_of, ranked_contributors, shares_of, unexplained_words
from tol3d.report.heading import WORST_FIRST, largest, shown_measures
from tol3d.report.measure_charts import METHOD_WORDS, column_roles
from tol3d.report.number import percent_text
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.run import RunSummary

MOST_CONTRIBUTORS: Final = 9  # bars; the rest is shown as one
MOST_COLUMNS: Final = 40  # measures
MOST_ROWS: Final = 50  # contributors; the others share a row
FEWEST: Final = 2
"""Measures of a matrix; of one the contributors' bars say all."""
Shares = Mapping[str, Mapping[str, float]]
"""Shares of contributors [%], by measure."""


def shown_names(measure: MeasureSummary) -> tuple[list[str], list[str]]:
    """The contributors with a bar of their own, and those that share one."""
    names = ranked_contributors(measure)
    return names[:MOST_CONTRIBUTORS], names[MOST_CONTRIBUTORS:]


def pareto(measure: MeasureSummary, roles: Mapping[str, Role] | None = None) -> Chart:
    """Shares of the variance by each method and as published, the largest first, the others as one bar.

    Args:
        measure: one of whose columns knows shares.
        roles: of columns by their headings; default: `column_roles` of its own.
    """
    columns, (shown, rest) = shares_of(measure), shown_names(measure)
    roles = roles or column_roles(columns_of(measure))
    names = [*shown, *([f"{len(rest)} other{'s' if len(rest) > 1 else ''}"] if rest else [])]
    series, most = [], 0.0
    for column in columns:
        percents = _percents(column, shown, rest)
        most = max([most, *(percent or 0.0 for percent in percents)])
        texts = ["" if percent is None else percent_text(percent) for percent in percents]
        lengths = [None if percent is None else max(percent, 0.0) for percent in percents]
        label = METHOD_WORDS.get(column.method, column.heading)
        series.append(Lengths(lengths, texts, roles[column.heading], label))
    leading = series[-1 if len(series) > 1 and columns[1].method == "geometric" else 0].texts if series else ()
    across = Axis("share of the variance", 0.0, most or 1.0, "%")
    return Chart(
        "contributors, the largest first",
        across,
        [Panel(Names(names), series)],
        "contributors",
        unexplained_words(measure),
        [(name, f"{text} %") for name, text in zip(names, leading, strict=False)],
    )


def _percents(column: Column, shown: Sequence[str], rest: Sequence[str]) -> list[float | None]:
    """A column's share of each bar [%]; None where it has none."""
    others = [share for name in rest if (share := column.percents.get(name)) is not None]
    return [column.percents.get(name) for name in shown] + ([sum(others) if others else None] if rest else [])


# the matrix ---------------------------------------------------------------------------------------


def of_scalars(summary: RunSummary) -> dict[str, MeasureSummary]:
    """The measures whose shares of the variance are known."""
    return {name: own for name, own in summary.measures.items() if own.take != "curve" and shares_of(own)}


def percents_of(measure: MeasureSummary) -> Mapping[str, float]:
    """Share of each contributor by the best method that knows it [%]."""
    columns = [column for column in shares_of(measure) if column.method != "published"]
    own = next((column for column in columns if column.method == measure.best_method), columns[0])
    return {name: share for name, share in own.percents.items() if share is not None}


def shares_in(run: RunSummary) -> Shares:
    """Shares of the variance in the worst measures of a run."""
    every = of_scalars(run)
    return {name: percents_of(every[name]) for name in shown_measures(every, MOST_COLUMNS)}


def run_matrix(summary: RunSummary) -> Chart:
    """Shares of the largest contributors in the worst measures of a run."""
    every = of_scalars(summary)
    by = {own.best_method for own in every.values()}
    word = METHOD_WORDS["geometric"] if by == {"geometric"} else METHOD_WORDS["analytic"]
    return matrix(shares_in(summary), f"{summary.scene}   ·   share of the variance [%], {word}", worst_of=len(every))


def matrix(
    shares: Shares, title: str, words: str = "", worst_of: int = 0, what: str = "shares of the variance"
) -> Chart:
    """A row a contributor, a column a measure, each share [%] as a colour and a number.

    Args:
        shares: by measure.
        title: above it.
        words: below the title.
        worst_of: number of a run's measures of which these are the worst; 0 where they are all there are.
        what: the numbers are, told to who does not see them.
    """
    names = [*shares][:MOST_COLUMNS]
    acting = list(dict.fromkeys(contributor for name in names for contributor in shares[name]))
    sums = {contributor: sum(shares[name].get(contributor, 0.0) for name in names) for contributor in acting}
    ranked = sorted(acting, key=lambda contributor: -sums[contributor])
    shown = largest(ranked, sums, MOST_ROWS)
    rest = ranked[len(shown) :]
    rows = [[shares[name].get(contributor, np.nan) for name in names] for contributor in shown]
    rows += [[sum(shares[name].get(contributor, 0.0) for contributor in rest) for name in names]] if rest else []
    labels = [*shown, *([f"{len(rest)} others"] if rest else [])]
    head = [words] if words else []
    if len(names) < max(worst_of, len(shares)):
        head.append(
            f"the {len(names)} worst of {worst_of} measures {WORST_FIRST}"
            if worst_of
            else f"the first {len(names)} of {len(shares)} measures"
        )
    if rest:
        kept = "; all in contributors.csv" if worst_of else ""
        head.append(f"the {len(shown)} largest of {len(acting)} contributors{kept}")
    return Chart(
        f"{what} of contributors in measures",
        Names(names),
        [Panel(Names(labels), [Cells(np.array(rows).reshape(len(rows), len(names)), len(shown))])],
        title,
        "\n".join(head),
        [
            (contributor, f"{sums[contributor] / max(len(names), 1):.1f} % in the mean of the measures")
            for contributor in shown[:5]
        ],
    )
