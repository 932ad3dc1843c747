"""How many trials ended how."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from tol3d.system.measure import Measure
from tol3d.system.outcome import ANALYTIC, Columns, reason_column, status_column, value_column
from tol3d.system.statuses import Statuses

Counts = Mapping[str, int]


def status_counts(statuses: Statuses, columns: Columns, measure: Measure) -> dict[str, int]:
    """Trials of a block by status, for one measure; those of the analytic road all seat."""
    trials = len(columns[value_column(ANALYTIC, measure.name)])
    return counted(statuses, columns.get(status_column(measure.name)), trials)


def counted(statuses: Statuses, status: NDArray[np.generic] | None, trials: int) -> dict[str, int]:
    """How many of the trials have each status (trials,); None where all of them seat."""
    seated = trials if status is None else int(np.count_nonzero(status == statuses.seated))
    if seated == trials:
        return {statuses.seated: trials, **dict.fromkeys(statuses.failed, 0)}
    return {statuses.seated: seated, **{text: int(np.count_nonzero(status == text)) for text in statuses.failed}}


def reason_counts(columns: Columns, measure: Measure) -> dict[str, int]:
    """Trials of a block that failed, by what decided it; none where the road does not say."""
    reasons = columns.get(reason_column(measure.name))
    if reasons is None or not (said := reasons != "").any():
        return {}
    words, counts = np.unique(np.asarray(reasons[said], dtype=np.str_), return_counts=True)
    return dict(zip(words.tolist(), counts.tolist(), strict=True))


def gathered(mine: Counts, its: Counts) -> dict[str, int]:
    """Both counts as one, of whatever names."""
    return {name: mine.get(name, 0) + its.get(name, 0) for name in sorted(mine.keys() | its.keys())}


def added(mine: Counts, its: Counts) -> dict[str, int]:
    """Both counts as one."""
    return {name: count + its[name] for name, count in mine.items()}
