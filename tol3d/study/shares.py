"""Shares of the variance by regression, in percent."""

from tol3d.statistics import RegressorSums, shares
from tol3d.study.regressors import regressor_groups
from tol3d.study.sample import finite
from tol3d.system.measure import Measure
from tol3d.system.system import System


def share_percents(
    system: System, measure: Measure, sums: RegressorSums | None
) -> dict[str, tuple[float | None, float | None]]:
    """Share of the variance [%] of each acting contributor by regression, its standard error; None where unknown."""
    unknown = dict.fromkeys((contributor.name for contributor in system.acting(measure)), (None, None))
    if sums is None:
        return {**unknown}
    groups = regressor_groups(system, measure)
    found = shares(sums, groups)
    known = {name: (finite(100 * found.share[name]), finite(100 * found.standard_error[name])) for name in groups}
    return {**unknown, **known}
