"""The columns in which a measure is shown: our roads, and what others published."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

Road = Literal["closed form", "analytic", "geometric", "high-low-mean", "published"]

HEADINGS: Mapping[Road, str] = {
    "closed form": "analytic (closed form)",
    "analytic": "analytic (same trials)",
    "geometric": "3D simulation",
}
KEYS: Mapping[Road, str] = {"closed form": "analytic_closed_form", "analytic": "analytic", "geometric": "geometric"}


@dataclass(frozen=True)
class Column:
    """One column of a measure.

    Args:
        heading: what stands on top.
        road: where it comes from.
        values: mean, sigma, low_3sigma ... in the measure's unit, as far as they are known.
        percents: share of each contributor [% of the variance].
    """

    heading: str
    road: Road
    values: Mapping[str, Any]
    percents: Mapping[str, float | None]

    def value(self, key: str) -> float | None:
        """A value, or None where this column has none."""
        found = self.values.get(key)
        return None if found is None else float(found)


def columns_of(measure: Mapping[str, Any]) -> list[Column]:
    """The columns of a measure's summary, ours first."""
    shares: dict[Road, str] = {"analytic": "analytic_percent", "geometric": "geometric_percent"}
    ours = [
        Column(HEADINGS[road], road, measure[key], _percents(measure, shares.get(road)))
        for road, key in KEYS.items()
        if key in measure
    ]
    published = measure.get("published", {})
    return ours + [
        Column(name, "published", values, values.get("contributors", {})) for name, values in published.items()
    ]


def seated_text(measure: Mapping[str, Any]) -> str:
    """Of how many trials a measure's mean and sigma are, where some of them failed; else nothing.

    >>> seated_text({"status": {"ok": 19441, "interferes": 559}}), seated_text({"status": {"ok": 20}})
    ('of 19441 of 20000 that seated', '')
    """
    status: Mapping[str, int] = measure.get("status", {})
    trials = sum(status.values())
    seated = status.get("ok", trials)
    return f"of {seated} of {trials} that seated" if seated != trials else ""


def best_road(measure: Mapping[str, Any]) -> Road:
    """The road that a summary is told by: the 3D simulation where there is one."""
    return "geometric" if "geometric" in measure or "geometric" in measure.get("curve", {}) else "analytic"


def shares_of(measure: Mapping[str, Any]) -> list[Column]:
    """The columns that know shares of the variance."""
    return [column for column in columns_of(measure) if any(p is not None for p in column.percents.values())]


def contributor_columns(measure: Mapping[str, Any]) -> list[Column]:
    """The columns that know shares, of the variance and of high-low-mean: ours first."""
    alone = Column("high–low–mean", "high-low-mean", {}, _percents(measure, "high_low_mean_percent"))
    columns = shares_of(measure)
    ours = [column for column in columns if column.road != "published"]
    known = any(percent is not None for percent in alone.percents.values())
    return [*ours, *([alone] if known else []), *columns[len(ours) :]]


def ranked_contributors(measure: Mapping[str, Any]) -> list[str]:
    """Contributors by falling share: the 3D simulation's, or the analytic one."""
    columns = shares_of(measure)
    names = [contributor["name"] for contributor in measure.get("contributors", [])]
    leading = next((c for c in columns if c.road == "geometric"), columns[0] if columns else None)
    if leading is None:
        return names
    return sorted(names, key=lambda name: -(leading.percents.get(name) or 0.0))


def _percents(measure: Mapping[str, Any], key: str | None) -> dict[str, float | None]:
    return {c["name"]: c.get(key) for c in measure.get("contributors", [])} if key else {}
