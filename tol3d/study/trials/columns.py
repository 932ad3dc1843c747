"""Trials to columns, by both methods: run by every worker and every replay.

Columns are in the user's units (um, mm, mrad, K, deg, arcmin), trial on axis 0; a curve has positions on axis 1.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.study.system.measure import Measure
from tol3d.study.system.method import Answers, Codes, Method
from tol3d.study.system.outcome import ANALYTIC, GEOMETRIC, OK, Statuses, status_column, value_column
from tol3d.study.system.stated import component_slices
from tol3d.study.system.system import Described, System
from tol3d.study.system.trials import Trials
from tol3d.study.trials.evaluation import Asked, evaluations

Columns = dict[str, NDArray[Any]]


def columns_of(
    system: System, method: Method | None, trials: Trials, measures: Sequence[Measure] | None = None
) -> Columns:
    """All columns of some trials.

    Args:
        system: the system to build.
        method: of the 3D simulation; None for the analytic columns only.
        trials: deviations and positions.
        measures: which are read; all by default.

    Returns:
        deviations, positions, `analytic:<measure>`, and with a method `geometric:<measure>`, `status:<measure>`, its
        details (such as points of contact) and `status`, the worst of them all; of each breakdown also its terms. A
        geometric value whose status lacks what is measured is an overlap, below 0.
    """
    measures = system.measures if measures is None else measures
    asked = (evaluation.asked(trials, measures) for evaluation in evaluations(system, method).values())
    pieces = [_columns(system, measures, by_method) for by_method in zip(*asked, strict=True)]
    if len(pieces) == 1:
        return pieces[0]
    return {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}


def _columns(system: System, measures: Sequence[Measure], by_method: Sequence[Asked]) -> Columns:
    """Columns of the same trials by each method, the analytic one first."""
    columns = drawn_columns(system, by_method[0].trials)
    for method, asked in zip((ANALYTIC, GEOMETRIC), by_method, strict=False):
        columns |= {value_column(method, name): values for name, values in asked.values.items()}
        if method == GEOMETRIC:
            columns |= asked.answers.details
        columns |= _terms(system, method, asked.answers)
    if len(by_method) == 1:
        return columns
    status, seated = by_method[1].answers.status, np.full(len(by_method[1].trials), OK, dtype=np.int8)
    return columns | _status_columns(
        system.statuses, {measure.name: status.get(measure.name, seated) for measure in measures}
    )


def drawn_columns(system: System, trials: Trials) -> Columns:
    """Columns of the input of trials: their deviations and positions."""
    columns: Columns = {}
    for contributor, slots in zip(system.contributors, component_slices(system).values(), strict=True):
        own = trials.deviations[:, slots]
        for k, name in enumerate(contributor.columns):
            columns[name] = own[:, k] / contributor.per_unit
    return columns | dict(system.columns(trials))


def _terms(system: Described, method: str, answers: Answers) -> Columns:
    return {
        breakdown.column(method, term.name): answers.terms[breakdown.measure, term.name] * breakdown.per_internal
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
