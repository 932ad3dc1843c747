"""Tables beside summary.json, as comma-separated values: contributors by measures, and correlations of all measures."""

import csv
import io
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, Final

from tol3d.study.joint import correlation_rows
from tol3d.study.simulation import Simulation
from tol3d.study.tally import Tally

CONTRIBUTORS: Final = "contributors.csv"
CORRELATIONS: Final = "correlations.csv"
SHARES: Final[Mapping[str, str]] = {
    "geometric_percent": "3D simulation",
    "analytic_percent": "analytic",
    "high_low_mean_percent": "high-low-mean",
}
"""What the rows of contributors.csv are called, by the keys of a share in summary.json."""


def run_tables(simulation: Simulation, tally: Tally, found: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Files of a run with their texts; none that would be empty.

    Args:
        simulation: what was simulated.
        tally: of all trials.
        found: the findings, as summary.json has them.
    """
    tables = {
        CONTRIBUTORS: contributor_rows(found["measures"]),
        CORRELATIONS: correlation_rows(simulation, tally.joint),
    }
    for name, rows in tables.items():
        if text := _csv(rows):
            yield name, text


def contributor_rows(measures: Mapping[str, Mapping[str, Any]]) -> Iterator[list[Any]]:
    """Shares of the variance [%]: a row a contributor, a column a measure, one matrix below the other for each kind.

    Nothing stands where a contributor does not act on a measure, or its share is not known.
    """
    shares = {name: own["contributors"] for name, own in measures.items() if own.get("contributors")}
    names = dict.fromkeys(share["name"] for own in shares.values() for share in own)
    if not names:
        return
    yield ["share of the variance [%]", "contributor", *shares]
    for key, words in SHARES.items():
        by_measure = [{share["name"]: share.get(key) for share in own} for own in shares.values()]
        if any(value is not None for own in by_measure for value in own.values()):
            yield from ([words, name, *(own.get(name) for own in by_measure)] for name in names)


def _csv(rows: Iterable[Sequence[Any]]) -> str:
    """Comma-separated values, numbers with all their digits; nothing for one not known."""
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows(rows)
    return stream.getvalue()
