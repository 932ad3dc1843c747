"""Verdicts: whether the share of trials out of limits, or the Ppk, of a measure is within what is accepted."""

import math
from dataclasses import dataclass
from typing import Final, Literal

from tol3d.statistics.estimates.limits import Proportion, normal_share
from tol3d.statistics.estimates.performance_bounds import CHANCE
from tol3d.study.runs.summary.measure import MeasureSummary
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.summary.sample import CurveSample, Sample

Verdict = Literal["OK", "NOT OK", "too few trials", "no limits"]

ACCEPTED_PPM: Final = 2700.0  # fraction of a normal measure outside ±3 sigma, Pp = Ppk = 1


@dataclass(frozen=True)
class AcceptedPpk:
    """A Ppk that a measure must have, by the method that its verdict states."""

    ppk: float

    @property
    def beyond_one_ppm(self) -> float:
        """Share of a normal measure beyond a limit at this Ppk [ppm].

        >>> round(AcceptedPpk(1.33).beyond_one_ppm), round(AcceptedPpk(1.0).beyond_one_ppm)
        (33, 1350)
        """
        return 1e6 * normal_share(3 * self.ppk, 1.0)


Accepted = float | AcceptedPpk
"""The share of trials that may be out of a measure's limits [ppm], or the Ppk that it must have."""


def demand_of(accept_ppk: float | None, given: Accepted | None = None) -> Accepted:
    """Demand on the measures of a study: as given, or the Ppk that the study accepts, or 0.27 % out of limits."""
    if given is not None:
        return given
    return ACCEPTED_PPM if accept_ppk is None else AcceptedPpk(accept_ppk)


@dataclass(frozen=True)
class JudgedMeasure:
    """A measure as it is judged.

    Args:
        out_ppm: share of all trials that is out of its limits or failed; None where it is not known.
        interval: that holds the true share with 95 % confidence [ppm]; None where trials are too few.
        verdict: whether that, or its Ppk, is accepted.
    """

    out_ppm: float | None
    interval: tuple[float, float] | None
    verdict: Verdict

    @classmethod
    def of(cls, measure: MeasureSummary, accepted: Accepted = ACCEPTED_PPM) -> "JudgedMeasure":
        """A measure of a run."""
        return cls.by(measure.shares, accepted, limited=measure.has_limits)

    @classmethod
    def by(cls, own: Sample | CurveSample, accepted: Accepted, *, limited: bool) -> "JudgedMeasure":
        """Trials of a measure with or without limits: OK or NOT OK where an interval lies on one side of the demand.

        The interval is that of the share of trials out of limits, or of Ppk. A measure without limits, of which builds
        failed, is judged by the share that an accepted Ppk stands for; one that does not vary, by a single trial.
        """
        found = own.out_ppm_95
        out, interval = own.out_ppm, (found[0], found[1]) if found else None
        if not limited and not out:
            return cls(out, interval, "no limits")
        if not isinstance(accepted, AcceptedPpk):
            return cls(out, interval, _verdict(interval, accepted))
        if not limited:
            return cls(out, interval, _verdict(interval, accepted.beyond_one_ppm))
        if own.ppk is None and own.ppk_by == "mean and sigma" and own.trials > 1:
            return cls(out, interval, "NOT OK" if out else "OK")
        low, high = own.ppk_95 or (None, None)
        if low is not None and low > accepted.ppk:
            return cls(out, interval, "OK")
        return cls(out, interval, "NOT OK" if high is not None and high < accepted.ppk else "too few trials")


def _verdict(interval: tuple[float, float] | None, accepted_ppm: float) -> Verdict:
    """Verdict from an interval of the true fraction out of limits.

    >>> [_verdict(found, ACCEPTED_PPM) for found in ((0.0, 1843.0), (2000.0, 3500.0), (2701.0, 9000.0), None)]
    ['OK', 'too few trials', 'NOT OK', 'too few trials']
    """
    if interval is None or interval[0] <= accepted_ppm < interval[1]:
        return "too few trials"
    return "OK" if interval[1] <= accepted_ppm else "NOT OK"


MOST_TRIALS: Final = 10**9
"""Trials beyond which nobody goes."""
FIRST_BOUND: Final = math.ceil(math.log(CHANCE) / math.log1p(-ACCEPTED_PPM / 2e6))
"""Trials from which on a quantile of 0.135 % has a bound, and so a Ppk by quantiles: 2731."""


def trials_to_judge(own: Sample | CurveSample, accepted: Accepted, *, limited: bool) -> int | None:
    """About how many trials would give a verdict, if the share out of limits, or the Ppk, stays as it is.

    Bounds of a Ppk shrink by the root of the number of trials; those of a share are taken at each number. None where a
    billion would not do, because it lies at what is accepted.

    Args:
        own, accepted, limited: as of `JudgedMeasure.by`.
    """
    if isinstance(accepted, AcceptedPpk) and limited:
        low, high = own.ppk_95 or (None, None)
        bound = None if own.ppk is None else low if own.ppk > accepted.ppk else high
        if own.ppk is None or bound is None:
            return max(2 * own.trials, FIRST_BOUND)
        away = abs(own.ppk - accepted.ppk)
        count = own.trials * ((own.ppk - bound) / away) ** 2 if away else math.inf
        return math.ceil(count) if count <= MOST_TRIALS else None
    ppm = accepted.beyond_one_ppm if isinstance(accepted, AcceptedPpk) else accepted
    share = (own.out_ppm or 0.0) * 1e-6
    few, many = own.trials, MOST_TRIALS
    if not _decides(share, many, ppm):
        return None
    while many > 1.01 * few + 1:
        middle = math.isqrt(few * many)
        few, many = (few, middle) if _decides(share, middle, ppm) else (middle, many)
    return many


def _decides(share: float, trials: int, accepted_ppm: float) -> bool:
    interval = Proportion(round(share * trials), trials).interval_ppm()
    return _verdict(interval, accepted_ppm) != "too few trials"


def all_ok(run: RunSummary, accepted: Accepted | None = None) -> bool:
    """True if every measure that has limits, or failed trials, is OK."""
    asked = demand_of(run.study.accept_ppk, accepted)
    return all(JudgedMeasure.of(measure, asked).verdict in ("OK", "no limits") for measure in run.measures.values())
