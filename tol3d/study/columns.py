"""Trials to columns, by both roads: what every worker and every replay runs.

Columns are in the user's units (um, mm, mrad, K, deg, arcmin), trial on axis 0; a curve has positions on axis 1.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.system.faults import UnfitError
from tol3d.system.measure import Measure
from tol3d.system.outcome import ANALYTIC, GEOMETRIC, status_column, value_column
from tol3d.system.road import ANALYTIC_ROAD, Answers, Codes, Road
from tol3d.system.stated import component_slices
from tol3d.system.statuses import OK, Statuses
from tol3d.system.system import System
from tol3d.system.taken import ROWS_AT_ONCE, taken
from tol3d.system.trials import Trials

Columns = dict[str, NDArray[Any]]


def columns_of(system: System, road: Road | None, trials: Trials, measures: Sequence[Measure] | None = None) -> Columns:
    """All columns of some trials.

    Args:
        system: what is built.
        road: of the 3D simulation; None for the analytic columns only.
        trials: deviations and positions.
        measures: which are read; all by default.

    Returns:
        deviations, positions, `analytic:<measure>`, and with a road `geometric:<measure>`, `status:<measure>`, its
        details (such as points of contact) and `status`, the worst of them all; of each breakdown also its terms. A
        geometric value whose status lacks what is measured is an overlap, below 0.
    """
    measures = system.measures if measures is None else measures
    rows = rows_at_once(measures)
    pieces = [
        _columns(system, road, trials.part(first, first + rows), measures) for first in range(0, len(trials), rows)
    ]
    if len(pieces) == 1:
        return pieces[0]
    return {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}


def drawn_columns(system: System, trials: Trials) -> Columns:
    """Columns of what trials are: their deviations and positions."""
    columns: Columns = {}
    for contributor, slots in zip(system.contributors, component_slices(system).values(), strict=True):
        own = trials.deviations[:, slots]
        for k, name in enumerate(contributor.columns):
            columns[name] = own[:, k] / contributor.per_unit
    return columns | dict(system.columns(trials))


def rows_at_once(measures: Sequence[Measure]) -> int:
    """Trials that a road is asked at once, by the positions of its measures."""
    return max(1, ROWS_AT_ONCE // max(measure.positions.in_a_trial for measure in measures))


def _columns(system: System, road: Road | None, trials: Trials, measures: Sequence[Measure]) -> Columns:
    columns = drawn_columns(system, trials)
    analytic = system.road(ANALYTIC_ROAD, None).answers(trials, measures)
    columns |= _values(ANALYTIC, analytic, measures, len(trials)) | _terms(system, ANALYTIC, analytic)
    if road is None:
        return columns
    geometric = road.answers(trials, measures)
    columns |= _values(GEOMETRIC, geometric, measures, len(trials))
    columns |= {**geometric.details, **_terms(system, GEOMETRIC, geometric)}
    seated = np.full(len(trials), OK, dtype=np.int8)
    status = {measure.name: geometric.status.get(measure.name, seated) for measure in measures}
    return columns | _status_columns(system.statuses, status)


def answered(road: str, answers: Answers, measures: Sequence[Measure], count: int) -> dict[str, NDArray[np.float64]]:
    """Values that measures take of a road's answers of so many trials, by name, in their units."""
    return {
        measure.name: taken(measure, _read(road, answers, measure, count)) * measure.per_internal
        for measure in measures
    }


def _values(road: str, answers: Answers, measures: Sequence[Measure], count: int) -> Columns:
    found = answered(road, answers, measures, count)
    return {value_column(road, name): values for name, values in found.items()}


def _read(road: str, answers: Answers, measure: Measure, count: int) -> NDArray[np.float64]:
    """Values (trials, positions) of a measure, if the road has answered as many."""
    values, expected = answers.values.get(measure.name), (count, measure.positions.in_a_trial)
    if values is None or np.shape(values) != expected:
        got = "none" if values is None else f"an array of shape {np.shape(values)}"
        raise UnfitError(
            f"{road} road, measure {measure.name!r}: expected values (trials, positions) of shape {expected}, got {got}"
        )
    return values


def _terms(system: System, road: str, answers: Answers) -> Columns:
    return {
        breakdown.column(road, term.name): answers.terms[breakdown.measure, term.name] * breakdown.per_internal
        for breakdown in system.breakdowns
        for term in breakdown.terms
        if (breakdown.measure, term.name) in answers.terms
    }


def _status_columns(statuses: Statuses, by_measure: Mapping[str, Codes]) -> Columns:
    """Texts of the codes (trials,) of each measure, and the worst of all; where that is OK they share one array."""
    worst = np.max([*by_measure.values()], axis=0)
    text = statuses.by_code[worst]
    all_ok = not worst.any()
    own = {status_column(name): text if all_ok else statuses.by_code[codes] for name, codes in by_measure.items()}
    return {**own, "status": text}
