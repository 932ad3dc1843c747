"""Builds before and after a change, of the same uniforms: spread of a measure, and a verdict on the change.

Builds as a study draws them, as many as an analysis takes.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from tol3d.analyses.response import Response
from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates import LimitCounts, Moments
from tol3d.study.system.measure import Measure
from tol3d.study.tallies.performance import FEWEST, Judged, Performance, Side
from tol3d.study.trials.study import PpkBy

SURE: Final = 3.0
"""Standard errors beyond which a change is taken for one."""
SIGMAS: Final = 1.96
"""Standard errors from a value to either of its bounds."""
WIDER_TAILS: Final = 2.0
"""Factor of the error of a Ppk by quantiles over that by mean and sigma."""


def limits_of(measure: Measure) -> tuple[float | None, float | None]:
    """Its limits in its unit."""
    lower, upper, per = measure.lower_limit, measure.upper_limit, measure.per_internal
    return None if lower is None else lower * per, None if upper is None else upper * per


def judged(measure: Measure, values: Array, asked: PpkBy | None) -> tuple[Moments, LimitCounts, Performance]:
    """Builds (n,) as a study judges trials; NaN where one fails."""
    good = values[~np.isnan(values)]
    moments, counts = Moments.of(good), LimitCounts.of(values, *limits_of(measure))
    side = Side(moments, [], lambda p: float(np.quantile(good, p)) if len(good) else None)
    found = Judged(*limits_of(measure), side, side, counts, counts.out_of_limits.interval_ppm())
    return moments, counts, found.performance(asked)


@dataclass(frozen=True, eq=False)
class Compared:
    """A measure before and after a change.

    Args:
        measure: which.
        before, after: builds of the same uniforms (n,); NaN where one fails.
        asked: rule of its Ppk.
    """

    measure: Measure
    before: Array
    after: Array
    asked: PpkBy | None

    def better(self) -> bool:
        """True if fewer builds are out, or the Ppk is higher, each beyond chance, and neither is worse."""
        mended, spoilt = self._mended_and_spoilt
        if spoilt > mended or (self.ppks is not None and self.ppks[1] < self.ppks[0]):
            return False
        fewer = mended - spoilt > SURE * math.sqrt(mended + spoilt)  # a sign test
        return fewer or (self.ppks is not None and self.ppks[1] - self.ppks[0] > SURE * self._error)

    def no_worse(self, aim: float) -> bool:
        """True if no more builds are out, and the Ppk is no lower or still as high as asked for."""
        mended, spoilt = self._mended_and_spoilt
        return spoilt <= mended and (
            self.ppks is None or self.ppks[1] >= aim or self.ppks[1] >= self.ppks[0] - self._error / 2
        )

    @cached_property
    def ppks(self) -> tuple[float, float] | None:
        """Ppk before and after, by one rule; None where builds failed, so that shares alone are compared."""
        found = self._performances(self.asked)
        if found[0].by != found[1].by:
            found = self._performances("quantiles" if len(self.before) >= FEWEST else "sigma")
        before, after = (own.ppk for own in found)
        failed = any(own.by == "share out of limits" for own in found)
        return None if failed or before is None or after is None else (before, after)

    def _performances(self, asked: PpkBy | None) -> tuple[Performance, Performance]:
        return judged(self.measure, self.before, asked)[2], judged(self.measure, self.after, asked)[2]

    @property
    def _error(self) -> float:
        """Standard error of the Ppk, by that of mean and sigma; less is left between builds of the same uniforms."""
        low, high = judged(self.measure, self.after, "sigma")[2].bounds
        by = judged(self.measure, self.after, self.asked)[2].by
        return (WIDER_TAILS if by == "quantiles" else 1.0) * (high - low) / (2 * SIGMAS)

    @cached_property
    def _mended_and_spoilt(self) -> tuple[int, int]:
        """Builds that are out before alone, and after alone."""
        lower, upper = (own if own is not None else end for own, end in zip(limits_of(self.measure), ENDS, strict=True))
        before, after = (~((own >= lower) & (own <= upper)) for own in (self.before, self.after))
        return int((before & ~after).sum()), int((after & ~before).sum())


ENDS: Final = (-math.inf, math.inf)


def drawn_builds(response: Response, count: int) -> tuple[Array, Mapping[str, Array]]:
    """So many builds as the study draws them, deviations and positions, by independent draws whatever its sampler."""
    study = response.simulation.study
    if study.sampler != "monte_carlo":
        simulation = replace(response.simulation, study=replace(study, sampler="monte_carlo", replicates=1))
        response = replace(response, simulation=simulation)
    return response.drawn(count)
