"""One row a measure: where it lies, what is out of its limits, and whether that is within what is accepted."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final, Literal

from rich.console import RenderableType
from rich.text import Text

from tol3d.report.column import best_road, columns_of, ranked_contributors, seated_text, shares_of
from tol3d.report.ends import Ends, is_bounded
from tol3d.report.number import NOTHING, given_text, share_text, short_text, unit_suffix, unsigned_zero
from tol3d.report.sheet import Heading, Row, Sheet, note

Summary = Mapping[str, Any]
Verdict = Literal["OK", "NOT OK", "too few trials", "no limits"]

ACCEPTED_PPM: Final = 2700.0  # what ±3 sigma of a normal measure leave out, Pp = Ppk = 1
STYLES: Final[Mapping[Verdict, str]] = {"NOT OK": "red", "too few trials": "yellow"}


@dataclass(frozen=True)
class Judged:
    """A measure as it is judged.

    Args:
        out_ppm: share of all trials that is out of its limits or failed; None where it is not known.
        interval: that holds the true share with 95 % confidence [ppm]; None where trials cannot tell.
        verdict: whether that is within the accepted share.
    """

    out_ppm: float | None
    interval: tuple[float, float] | None
    verdict: Verdict

    @classmethod
    def of(cls, measure: Summary, accepted_ppm: float = ACCEPTED_PPM) -> "Judged":
        """A measure of a summary: OK or NOT OK where all of the interval is on one side of the accepted share.

        >>> def judged(*interval):
        ...     own = {"out_ppm": 100.0, "out_ppm_95": list(interval)}
        ...     return Judged.of({"take": "value", "analytic": own, "lower_limit": 15.0, "upper_limit": None}).verdict
        >>> judged(0.0, 1843.0), judged(2000.0, 3500.0), judged(2701.0, 9000.0)
        ('OK', 'too few trials', 'NOT OK')
        """
        road = best_road(measure)
        sample = measure["curve"][road] if measure["take"] == "curve" else measure[road]
        out, found = sample.get("out_ppm"), sample.get("out_ppm_95")
        interval = (float(found[0]), float(found[1])) if found else None
        if (measure.get("lower_limit"), measure.get("upper_limit")) == (None, None) and not out:
            return cls(out, interval, "no limits")
        return cls(out, interval, _verdict(interval, accepted_ppm))


def _verdict(interval: tuple[float, float] | None, accepted_ppm: float) -> Verdict:
    if interval is None or interval[0] <= accepted_ppm < interval[1]:
        return "too few trials"
    return "OK" if interval[1] <= accepted_ppm else "NOT OK"


def all_ok(summary: Summary, accepted_ppm: float) -> bool:
    """Whether every measure that has limits, or failed trials, is OK."""
    return all(Judged.of(own, accepted_ppm).verdict in ("OK", "no limits") for own in summary["measures"].values())


def verdict_report(
    summary: Summary, accepted_ppm: float = ACCEPTED_PPM, *, blame: bool = False
) -> list[RenderableType]:
    """The verdict of every measure, what it rests on, and how it is reached.

    Args:
        summary: of a run.
        accepted_ppm: share of trials that may be out of a measure's limits.
        blame: name the contributor that most of each measure's variance comes from.
    """
    title = Text("\n").append("verdict", style="bold cyan")
    title.append(f" · accepted: {share_text(accepted_ppm)} out of limits", "dim")
    return [title, "", verdict_table(summary, accepted_ppm, blame=blame), *map(note, _notes(summary))]


def verdict_table(summary: Summary, accepted_ppm: float = ACCEPTED_PPM, *, blame: bool = False) -> Sheet:
    """A row a measure, by the 3D simulation where there is one."""
    headings = [Heading("verdict", words=True), *(Heading(word) for word in ("mean", "low", "high"))]
    headings += [Heading("limits"), Heading("out of limits (95 %)", words=True), Heading("Ppk")]
    headings += [Heading("mostly from", words=True, optional=True)] if blame else []
    rows = [_row(name, measure, accepted_ppm, blame=blame) for name, measure in summary["measures"].items()]
    return Sheet("measure", headings, rows, repeated=1)


def _row(name: str, measure: Summary, accepted_ppm: float, *, blame: bool) -> Row:
    judged = Judged.of(measure, accepted_ppm)
    low, mean, high = _curve_ends(measure) if measure["take"] == "curve" else _ends(measure)
    verdict = NOTHING if judged.verdict == "no limits" else judged.verdict
    cells = [verdict, *(_short(value, measure["unit"]) for value in (mean, low, high)), _limits(measure)]
    cells += [NOTHING if judged.verdict == "no limits" else _out(judged), _ppk(measure)]
    cells += [_mostly(measure)] if blame else []
    return Row(f"{name} *" if _by_quantiles(measure) else name, cells, STYLES.get(judged.verdict, ""))


def _ends(measure: Summary) -> tuple[float | None, float | None, float | None]:
    own = next(column for column in columns_of(measure) if column.road == best_road(measure))
    ends = Ends.of(own, bounded=is_bounded(measure))
    return ends.low, own.value("mean"), ends.high


def _curve_ends(measure: Summary) -> tuple[float | None, float | None, float | None]:
    """The lowest of mean − 3 sigma and the highest of mean + 3 sigma over a curve's positions; it has no one mean."""
    own = measure["curve"][best_road(measure)]
    known = [(m, s) for m, s in zip(own["mean"], own["sigma"], strict=True) if m is not None and s is not None]
    if not known:
        return None, None, None
    return min(mean - 3 * sigma for mean, sigma in known), None, max(mean + 3 * sigma for mean, sigma in known)


def _by_quantiles(measure: Summary) -> bool:
    return measure["take"] != "curve" and is_bounded(measure)


def _short(value: float | None, unit: str) -> str:
    return NOTHING if value is None else short_text(value, unit)


def _limits(measure: Summary) -> str:
    unit = measure["unit"]
    lower, upper = (measure.get(key) for key in ("lower_limit", "upper_limit"))
    suffix = unit_suffix(unit)
    if lower is None or upper is None:
        given = [(sign, limit) for sign, limit in (("≥", lower), ("≤", upper)) if limit is not None]
        return "".join(f"{sign} {given_text(limit, unit)}{suffix}" for sign, limit in given) or NOTHING
    return f"{given_text(lower, unit)} to {given_text(upper, unit)}{suffix}"


def _out(judged: Judged) -> str:
    if judged.out_ppm is None or judged.interval is None:
        return share_text(judged.out_ppm)
    low, high = map(share_text, judged.interval)
    if not judged.out_ppm:
        return f"0 (< {high})"
    return f"{share_text(judged.out_ppm)} ({low} to {high})"


def _ppk(measure: Summary) -> str:
    value = None if measure["take"] == "curve" else measure[best_road(measure)].get("ppk")
    return NOTHING if value is None else unsigned_zero(f"{value:.2f}")


def _mostly(measure: Summary) -> str:
    """The contributor with the largest share of the variance."""
    columns = shares_of(measure) if measure["take"] != "curve" else []
    leading = next((column for column in columns if column.road == best_road(measure)), None)
    if leading is None:
        return NOTHING
    name = ranked_contributors(measure)[0]
    return f"{name} {leading.percents.get(name) or 0.0:.0f} %"


def _notes(summary: Summary) -> Iterator[str]:
    measures = summary["measures"].values()
    yield (
        "out of limits: share of all trials, failed ones included, and the interval that holds the true share with "
        "95 % confidence; OK where all of it is accepted, NOT OK where none is, else too few trials to say"
    )
    ends = "low, high: mean ∓ 3 sigma"
    ends += ", * 0.135 % and 99.865 % of the trials, which end before" if any(map(_by_quantiles, measures)) else ""
    ends += ", of a curve over its positions" if any(own["take"] == "curve" for own in measures) else ""
    yield ends + ("; of the trials that seated" if any(map(seated_text, measures)) else "")
