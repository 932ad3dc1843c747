"""The columns in which a measure is shown: our methods, and what others published.

Ends of a measure's bars: mean ∓ 3 sigma, or quantiles if trials do not reach that far.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Final, Literal, get_args

from tol3d.report.number import COUNTED
from tol3d.report.page import Heading
from tol3d.study.runs.summary.measure import MeasureSummary, SharesBy, Unexplained
from tol3d.study.runs.summary.values import Section

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
    columns = [column for column in shares_of(measure) if column.method != "published"]
    return next((column for column in columns if column.method == "geometric"), columns[0] if columns else None)


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
    """Sentences where some shares are not those of the regression, or are within their sampling error; else none."""
    measures = list(measures)
    yield from dict.fromkeys(words for own in measures if (words := within_error_words(own)))
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


SURE: Final = 2.0
"""Standard errors from which on a share is told from none: one of none has as much in 5 of 100 studies."""
TOLD: Final = 1.0
"""Share [%] that may be within its sampling error, from which on a sentence tells of it."""


@dataclass(frozen=True)
class Share:
    """Share of contributors in the variance of a measure, as it is ranked and told.

    Args:
        percent: of the variance, the 3D simulation's, or the analytic one.
        error: its standard error [%], of a sample of trials; 0 where there is none.
        alone: without chance [%], by high–low–mean or a closed form; None where it is not known.
    """

    percent: float
    error: float
    alone: float | None

    @classmethod
    def together(cls, shares: Iterable["Share"]) -> "Share":
        """That of several contributors, whose errors are independent."""
        every = list(shares)
        alone = [own.alone for own in every if own.alone is not None]
        return cls(
            sum(own.percent for own in every),
            math.hypot(*(own.error for own in every)),
            sum(alone) if len(alone) == len(every) else None,
        )

    @property
    def is_within_error(self) -> bool:
        """True if chance may have made it."""
        return self.error > 0.0 and self.percent < SURE * self.error

    @property
    def most(self) -> float:
        """Upper end of its 95 % interval [%]."""
        return min(max(self.percent, 0.0) + SURE * self.error, 100.0)

    @property
    def order(self) -> tuple[bool, float]:
        """Key of its rank: by itself, or within its error below the others, by the effects alone if they are known."""
        known = self.percent if self.alone is None or not self.is_within_error else self.alone
        return self.is_within_error, -known


def shares_by_contributor(measure: MeasureSummary) -> dict[str, Share]:
    """The leading shares of a measure, by falling rank; none where none are known."""
    leading = leading_shares(measure)
    if leading is None:
        return {}
    sampled, (_, alone) = leading.method == "geometric", _without_chance(measure)
    found = {
        own.name: Share(
            leading.percents.get(own.name) or 0.0,
            (own.geometric_percent_se or 0.0) if sampled else 0.0,
            alone.get(own.name),
        )
        for own in measure.contributors
    }
    return dict(sorted(found.items(), key=lambda own: own[1].order))


def _without_chance(measure: MeasureSummary) -> tuple[str, Mapping[str, float | None]]:
    """Shares in which no chance is [%], if those of all contributors are known, with the name of their method."""
    columns = {"high–low–mean": "high_low_mean_percent"}
    if measure.analytic_closed_form is not None:
        columns["the closed form"] = "analytic_percent"
    for words, key in columns.items():
        found = _percents(measure, key)
        if None not in found.values():
            return words, found
    return "", {}


def within_error_words(measure: MeasureSummary) -> str:
    """A sentence where shares that may matter are within their sampling error; "" where trials tell."""
    found = [own for own in shares_by_contributor(measure).values() if own.is_within_error]
    if not any(own.most > TOLD for own in found):
        return ""
    words, _ = _without_chance(measure)
    by = f", in the order of {words}" if words else ""
    return f"shares of less than {SURE:g} standard errors may be chance in so few trials: they stand last{by}"


def ranked_contributors(measure: MeasureSummary) -> list[str]:
    """Contributors by falling share; see `Share.order`."""
    return list(shares_by_contributor(measure)) or [contributor.name for contributor in measure.contributors]


def _percents(measure: MeasureSummary, key: str | None) -> dict[str, float | None]:
    return {share.name: share.value(key) for share in measure.contributors} if key else {}


SHORT_OF_3_SIGMA: Final = 2.5  # sigma; a quantile nearer to the mean than this is no end of a normal law
BY_CHANCE: Final = 1e-3  # probability, at most, that so many trials of a normal law all stay that near to their mean
QUANTILES: Final = ("p0.135", "p99.865")
THREE_SIGMA: Final = ("low_3sigma", "high_3sigma")
QUANTILES_MEAN: Final = "; marked are the 0.135 % and 99.865 % quantiles, because the trials end before mean ± 3 sigma"


@dataclass(frozen=True)
class Ends:
    """The ends of a bar in the measure's unit, None if unknown, and their names."""

    low: float | None
    high: float | None
    words: tuple[str, str] = ("−3σ", "+3σ")

    @classmethod
    def of(cls, column: Column, *, bounded: bool) -> "Ends":
        """Ends of a column of a measure, `bounded` or not."""
        if bounded and all(column.value(key) is not None for key in QUANTILES):
            low, high = (column.value(key) for key in QUANTILES)
            return cls(low, high, ("0.135 %", "99.865 %"))
        low, high = (column.value(key) for key in THREE_SIGMA)
        return cls(low, high)


def is_bounded(measure: MeasureSummary) -> bool:
    """True if mean ∓ 3 sigma lies where a measure has no values.

    Below 0 that is of counts and ranges, else where trials end before: a range near 0, a sum of a few uniform laws.
    """
    sample = measure.sample(measure.best_method)
    if sample is None:
        return False
    known = (sample.mean, sample.sigma, sample.count, sample.p0_135, sample.p99_865)
    return (_is_never_negative(measure) and _reaches_below_0(*known[:2])) or _ends_early(*known)


def _is_never_negative(measure: MeasureSummary) -> bool:
    """True for counts and peak-to-peak values."""
    return measure.unit in COUNTED or measure.take in ("range", "harmonic")


def _reaches_below_0(mean: float | None, sigma: float | None) -> bool:
    return mean is not None and sigma is not None and mean - 3 * sigma < 0.0


def _ends_early(
    mean: float | None, sigma: float | None, count: int | None, low: float | None, high: float | None
) -> bool:
    """True if an outer quantile of a sample lies nearer to its mean than for any normal distribution.

    Within SHORT_OF_3_SIGMA of it, with trials enough to be sure: n of a normal law all stay within k sigma on one side
    of their mean with a chance of (1 − Φ(−k))^n.

    >>> [_ends_early(0.0, 1.0, count, -1.73, 1.73) for count in (100, 1000)]
    [False, True]
    """
    if mean is None or not sigma or count is None or low is None or high is None:
        return False
    nearest = max(0.0, min(mean - low, high - mean))  # a far outlier pulls the mean out of its quantiles
    if nearest > SHORT_OF_3_SIGMA * sigma:
        return False
    beyond = math.erfc(nearest / sigma / math.sqrt(2)) / 2
    return bool(count * math.log1p(-beyond) < math.log(BY_CHANCE))
