"""Findings of a study, and those of its witness."""

from collections.abc import Iterator, Mapping
from typing import Any, Final

from threadpoolctl import threadpool_limits

from tol3d.study.execution.watch import Activity
from tol3d.study.results.summary import study_summary
from tol3d.study.results.witness import witness_of, witness_summary, witness_warnings
from tol3d.study.runs.csv_text import csv_text
from tol3d.study.runs.summary.run import Findings
from tol3d.study.runs.summary.values import as_json
from tol3d.study.system.method import Method
from tol3d.study.tallies.joint import correlation_rows
from tol3d.study.tallies.tally import Tally
from tol3d.study.trials.simulation import Simulation


def findings(simulation: Simulation, method: Method | None, tally: Tally, activity: Activity) -> dict[str, Any]:
    """Everything of summary.json but files, timing and versions.

    Args:
        simulation: that was run.
        method: of the 3D simulation; None for an analytic study.
        tally: of all trials.
        activity: callback for the current activity, in words.
    """
    with threadpool_limits(1, user_api="blas"):  # threads make these small matrices three to ten times as slow
        found = study_summary(simulation, method, tally)
    wanted, witness = simulation.study.witness, witness_of(simulation.system)
    if method is not None and wanted and witness is not None:
        activity(f"witness: {witness.upper()} measures {min(wanted, tally.trials)} trials again")
        own = witness_summary(simulation, method, tally.trials)
        warnings = [*found.warnings, *witness_warnings(simulation, own)]
        found = found.model_copy(update={"witness": own, "warnings": warnings})
    summary: dict[str, Any] = as_json(described(simulation, tally, found))
    return summary


def described(simulation: Simulation, tally: Tally, found: Findings) -> dict[str, Any]:
    """Findings with what their system adds: descriptions of measures, and sections of its own after the measures."""
    system, options = simulation.system, simulation.study.options
    measures = {
        measure.name: {**system.describe(measure), **dict(found.measures[measure.name].items())}
        for measure in system.measures
    }
    whole = dict(found.items()) | {"measures": measures}
    whole |= {key: {**dict(whole[key].items()), **options} for key in ("study", "witness") if key in whole}
    behind = [*whole].index("measures") + 1
    sections = system.sections(tally.terms, simulation.published, simulation.copula)
    return {**dict([*whole.items()][:behind]), **sections, **dict([*whole.items()][behind:])}


CONTRIBUTORS: Final = "contributors.csv"
CORRELATIONS: Final = "correlations.csv"
SHARES: Final[Mapping[str, str]] = {
    "geometric_percent": "3D simulation",
    "analytic_percent": "analytic",
    "high_low_mean_percent": "high-low-mean",
}
"""Names of the rows of contributors.csv, by the keys of a share in summary.json."""


def run_tables(simulation: Simulation, tally: Tally, found: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Files of a run with their texts; none that would be empty.

    Args:
        simulation: that was run.
        tally: of all trials.
        found: the findings, as summary.json has them.
    """
    tables = {
        CONTRIBUTORS: contributor_rows(found["measures"]),
        CORRELATIONS: correlation_rows(simulation, tally.joint),
    }
    for name, rows in tables.items():
        if text := csv_text(rows):
            yield name, text


def contributor_rows(measures: Mapping[str, Mapping[str, Any]]) -> Iterator[list[Any]]:
    """Shares of the variance [%]: a row a contributor, a column a measure, one matrix below the other for each kind.

    Nothing stands where a contributor does not act on a measure, or its share is not known. Where shares are not those
    of a regression, what it does not attribute stands first, and below all matrices what the shares are by.
    """
    shares = {name: own["contributors"] for name, own in measures.items() if own.get("contributors")}
    names = dict.fromkeys(share["name"] for own in shares.values() for share in own)
    if not names:
        return
    yield ["share of the variance [%]", "contributor", *shares]
    others = {
        key: [measures[name].get("shares_by", {}).get(key.removesuffix("_percent")) for name in shares]
        for key in SHARES
    }
    for key, words in SHARES.items():
        by_measure = [{share["name"]: share.get(key) for share in own} for own in shares.values()]
        if any(others[key]):
            explained = [own and own["explained_percent"] for own in others[key]]
            yield [words, "not attributed", *(None if own is None else 100 - own for own in explained)]
        if any(value is not None for own in by_measure for value in own.values()):
            yield from ([words, name, *(own.get(name) for own in by_measure)] for name in names)
    for key, words in SHARES.items():
        if any(others[key]):
            yield ["shares by", words, *("regression" if own is None else own["by"] for own in others[key])]
