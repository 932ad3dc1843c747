"""The columns in which a measure is shown: our methods, and what others published."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from tol3d.runs.summary.measure import MeasureSummary
from tol3d.runs.summary.values import Section

Method = Literal["closed form", "analytic", "geometric", "high-low-mean", "published"]

HEADINGS: Mapping[Method, str] = {
    "closed form": "analytic (closed form)",
    "analytic": "analytic (same trials)",
    "geometric": "3D simulation",
}
SHARES: Mapping[Method, str] = {"analytic": "analytic_percent", "geometric": "geometric_percent"}


@dataclass(frozen=True)
class Column:
    """One column of a measure.

    Args:
        heading: its title.
        method: its source.
        values: mean, sigma, low_3sigma ... in the measure's unit, as far as they are known; None of shares alone.
        percents: share of each contributor [% of the variance].
    """

    heading: str
    method: Method
    values: Section | None
    percents: Mapping[str, float | None]

    def value(self, key: str) -> float | None:
        """A value by its key in summary.json, or None where this column has none."""
        return None if self.values is None else self.values.value(key)


def columns_of(measure: MeasureSummary) -> list[Column]:
    """The columns of a measure, ours first."""
    found: dict[Method, Section | None] = {
        "closed form": measure.analytic_closed_form,
        "analytic": measure.analytic,
        "geometric": measure.geometric,
    }
    ours = [
        Column(HEADINGS[method], method, values, _percents(measure, SHARES.get(method)))
        for method, values in found.items()
        if values is not None
    ]
    return ours + [Column(name, "published", values, values.percents) for name, values in measure.published.items()]


def seated_text(measure: MeasureSummary) -> str:
    """Words for the number of trials behind mean and sigma, if some could not be assembled; else ""."""
    return (
        f"of the {measure.seated} of {measure.trials} that were assembled" if measure.seated != measure.trials else ""
    )


def best_method(measure: MeasureSummary) -> Literal["analytic", "geometric"]:
    """The method by which a measure is shown: the 3D simulation where there is one."""
    return measure.best_method


def shares_of(measure: MeasureSummary) -> list[Column]:
    """The columns that know shares of the variance."""
    return [column for column in columns_of(measure) if any(p is not None for p in column.percents.values())]


def contributor_columns(measure: MeasureSummary) -> list[Column]:
    """The columns that know shares, of the variance and of high-low-mean: ours first."""
    alone = Column("high–low–mean", "high-low-mean", None, _percents(measure, "high_low_mean_percent"))
    columns = shares_of(measure)
    ours = [column for column in columns if column.method != "published"]
    known = any(percent is not None for percent in alone.percents.values())
    others = (
        Column(f"{name}, {alone.heading}", "published", None, own.high_low_mean_percents)
        for name, own in measure.published.items()
        if own.high_low_mean_percents
    )
    return [*ours, *([alone] if known else []), *columns[len(ours) :], *others]


def ranked_contributors(measure: MeasureSummary) -> list[str]:
    """Contributors by falling share: the 3D simulation's, or the analytic one."""
    columns = shares_of(measure)
    names = [contributor.name for contributor in measure.contributors]
    leading = next((c for c in columns if c.method == "geometric"), columns[0] if columns else None)
    if leading is None:
        return names
    return sorted(names, key=lambda name: -(leading.percents.get(name) or 0.0))


def _percents(measure: MeasureSummary, key: str | None) -> dict[str, float | None]:
    return {share.name: share.value(key) for share in measure.contributors} if key else {}
