"""The columns in which a measure is shown: our methods, and what others published."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal, get_args

from tol3d.report.page import Heading
from tol3d.runs.summary.measure import MeasureSummary, SharesBy, Unexplained
from tol3d.runs.summary.values import Section

Method = Literal["closed form", "analytic", "geometric", "high-low-mean", "published"]

HEADINGS: Mapping[Method, str] = {
    "closed form": "analytic (closed form)",
    "analytic": "analytic (same trials)",
    "geometric": "3D simulation",
}
NOT_ATTRIBUTED = "not attributed"
SHARES_BY: Mapping[SharesBy, str] = {
    "total effects": "total effects",
    "high-low-mean": "high–low–mean",
    "regression": "regression",
}
SHARES_BY_MEANS: Mapping[SharesBy, str] = {
    "total effects": "total effects, the variance by a contributor alone and in interactions, together more than 100 %",
    "high-low-mean": "high–low–mean, each contributor's squared range as a part of their sum",
    "regression": "regression, of the little that it explains: the run has too few trials for total effects",
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


def heading_by(method: str, text: str) -> Heading:
    """Head of values by a method: bold of the 3D simulation, green of what somebody published."""
    ours = method in get_args(Method) and method != "published"
    return Heading(text, "bold" if method == "geometric" else "" if ours else "green")


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


def leading_shares(measure: MeasureSummary) -> Column | None:
    """The column whose shares are named first: the 3D simulation's, or the analytic one's."""
    columns = shares_of(measure)
    return next((own for own in columns if own.method == "geometric"), columns[0] if columns else None)


def unexplained_of(measure: MeasureSummary, column: Column) -> Unexplained | None:
    """Means by which a column's shares were found where a regression explains too little; else None."""
    by_method = measure.shares_by or {}
    return by_method.get(column.method) if column.method in ("analytic", "geometric") else None


def unexplained_words(measure: MeasureSummary) -> str:
    """The share not attributed, and by what the leading ones are instead; "" where a regression explains enough."""
    leading = leading_shares(measure)
    unexplained = unexplained_of(measure, leading) if leading else None
    if unexplained is None:
        return ""
    explained = unexplained.explained_percent
    left = "" if explained is None else f"{NOT_ATTRIBUTED} {100 - explained:.0f} %; "
    return f"{left}by {SHARES_BY[unexplained.by]}"


def shares_by_words(measures: Iterable[MeasureSummary]) -> Iterator[str]:
    """A sentence where some shares are not those of the regression; nothing if all are."""
    used = {own.by for measure in measures for own in (measure.shares_by or {}).values()}
    meanings = [SHARES_BY_MEANS[by] for by in SHARES_BY_MEANS if by in used]
    if meanings:
        yield (
            f"{NOT_ATTRIBUTED} first: a regression on the contributors explains less than 90 % of the variance, or has "
            f"too few trials; the shares are then by {'; by '.join(meanings)}"
        )


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
    names = [contributor.name for contributor in measure.contributors]
    leading = leading_shares(measure)
    if leading is None:
        return names
    return sorted(names, key=lambda name: -(leading.percents.get(name) or 0.0))


def _percents(measure: MeasureSummary, key: str | None) -> dict[str, float | None]:
    return {share.name: share.value(key) for share in measure.contributors} if key else {}
