"""Estimates from the values of trials, with their errors: pure functions, gathered block by block."""

from tol3d.statistics.estimates.grid import CountGrid, Grid, Histogram
from tol3d.statistics.estimates.independent_sums import IndependentSums, independent_shares
from tol3d.statistics.estimates.limits import Agreement, LimitCounts, Proportion, equivalent_ppk, pp, ppk
from tol3d.statistics.estimates.moments import Moments
from tol3d.statistics.estimates.pair_sums import PairSums
from tol3d.statistics.estimates.variance_shares import RegressorSums, Shares, shares

__all__ = [
    "Agreement",
    "CountGrid",
    "Grid",
    "Histogram",
    "IndependentSums",
    "LimitCounts",
    "Moments",
    "PairSums",
    "Proportion",
    "RegressorSums",
    "Shares",
    "equivalent_ppk",
    "independent_shares",
    "pp",
    "ppk",
    "shares",
]
