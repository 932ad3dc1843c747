"""Shares of the variance by regression, in percent."""

from tol3d.statistics import IndependentSums, independent_shares, shares
from tol3d.study.regression import Sums
from tol3d.study.regressors import regressor_groups
from tol3d.study.sample import finite
from tol3d.system.measure import Measure
from tol3d.system.system import System

Percent = tuple[float | None, float | None]
"""A share of the variance [%] and its standard error; None where unknown."""


def share_percents(system: System, measure: Measure, sums: Sums | None) -> dict[str, Percent]:
    """Share of the variance of each acting contributor by regression."""
    groups = regressor_groups(system, measure)
    if sums is None:
        return dict.fromkeys(groups, (None, None))
    if isinstance(sums, IndependentSums):
        share, error, _ = independent_shares(sums)
        found = zip(groups, share.tolist(), error.tolist(), strict=True)
        return {name: (finite(100 * own), finite(100 * its)) for name, own, its in found}
    known = shares(sums, groups)
    return {name: (finite(100 * known.share[name]), finite(100 * known.standard_error[name])) for name in groups}
