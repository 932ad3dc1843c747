"""Recommended changes for measures out of limits: nominals to move, tolerances to halve, causes of a mean off nominal.

Rates select contributors (slopes.py). Each change is then simulated: the same builds again, as the study draws them,
but with a nominal moved, or with a tolerance half as wide. As draws are the same, only the change differs.
estimated_changes.py prints estimates below a verdict, by rates alone.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from pydantic import Field

from tol3d.analyses.drawn_builds import drawn_builds, halved_deviations
from tol3d.analyses.response import Response
from tol3d.analyses.slopes import BATCHES, Lever, Rates, levers_of, rates_of
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.report.number import COUNTED
from tol3d.report.verdict import ACCEPTED_PPM
from tol3d.runs.summary.values import Count, Known, Label, Number, Positive, Ppm, PpmRange, Section, made
from tol3d.statistics import LimitCounts, Moments
from tol3d.study.performance import OUTER, Judged, Performance, Side
from tol3d.study.sample import finite, listed
from tol3d.system.measure import Measure

By = Literal["simulation", "rates"]
Target = Literal["middle of the limits", "accepted share", "Ppk 1.33"]

TARGET_PPK: Final = 1.33
SECONDS: Final = 20.0
"""Seconds of builds for a measure, by the method's stated cost of one: a result must not depend on the clock."""
MOST_ROWS: Final = 16
"""At how many builds slopes are taken."""
MOST_BUILDS: Final = 5000
FEWEST_BUILDS: Final = 400
"""For each change."""
TRIED: Final = 8
"""Tolerances that are halved, of which the best are told."""
TOLD: Final = 5
LEVERS: Final = 3
"""Contributors by which a mean is moved."""
NO_SHIFT: Final = 0.01
"""Fraction of sigma; a mean that is nearer to its target stays."""
SURE: Final = 3.0
"""Standard errors of a mean, within which it stays too."""
MET: Final = 0.01
"""Fraction of a shift that may be left."""
SHARE_OF_PLAY: Final = "1"
"""Unit of what is no tolerance: where a part lies in its play."""
USELESS: Final = 1e-3
"""Fraction of the steepest slope; a mean is not moved by a flatter one."""


class Spread(Section):
    """Spread of a measure within its limits, in its unit."""

    mean: Known
    sigma: Known
    out_ppm: Ppm | None = Field(description="failed or out of limits, of all builds")
    out_ppm_95: PpmRange | None
    ppk: Known


class Moved(Section):
    """A nominal that moves a mean as far as it should."""

    contributor: Label
    change: Number = Field(description="of the nominal, in `unit`")
    unit: Label
    after: Spread


class Shift(Section):
    """A shift of a measure's mean, all else as it is."""

    target: Target
    shift: Number
    after: Spread
    by: list[Moved]


class Halved(Section):
    """A tolerance that is half as wide about its middle."""

    contributor: Label
    share_percent: Known = Field(description="of the variance, by slopes")
    after: Spread


class MeanOffset(Section):
    """Shift of a measure's mean from the nominal build by a contributor, in its unit."""

    contributor: Label
    first_order: Number = Field(description="by its own mean")
    second_order: Number = Field(description="by the curvature along it and its spread")


class MeasureChanges(Section):
    """Recommended changes for a measure."""

    unit: Label
    lower_limit: Known
    upper_limit: Known
    builds: Positive = Field(description="by which each change is judged")
    now: Spread
    shifts: list[Shift]
    halved: list[Halved]
    nominal: Known = Field(description="every deviation 0, averaged over positions")
    taken: list[MeanOffset]
    taken_together: Known = Field(description="what of mean less nominal is no contributor's alone")
    taken_error: Known = Field(description="standard error of that")


class Changes(Section):
    """Recommended changes to a scene, measure by measure."""

    by: By
    accepted_ppm: Ppm
    measures: Mapping[Label, MeasureChanges]
    further: list[Label] = Field(description="measures that leave their limits too and were not looked at")
    evaluations: Count


@dataclass(frozen=True)
class ChangesQuestion:
    """Question for recommended changes.

    Args:
        measure: its name; None for all that leave their limits.
        accepted_ppm: share of builds that may be out of limits.
        builds: number that judges each change; None takes as many as are quick to make.
    """

    measure: str | None = None
    accepted_ppm: float = ACCEPTED_PPM
    builds: int | None = None


def changes_of(
    response: Response,
    question: ChangesQuestion = ChangesQuestion(),
    *,
    bad: Sequence[str] | None = None,
    activity: Callable[[str], None] = lambda text: None,
) -> Changes:
    """Recommended changes to a scene, each of them simulated.

    Args:
        response: of its measures.
        question: the question.
        bad: measures that leave their limits, the worst first, where a run has judged them, of a curve its name; judged
            here if None.
        activity: progress callback.

    Raises:
        InputError: no such measure, or no limits.
    """
    before = response.evaluations
    limited = _limited(response, question.measure)
    if question.measure is not None:
        bad = [question.measure]
    if bad is None:
        activity("builds as they are")
        bad = _bad(limited, *drawn_builds(limited, Effort.of(limited, question).builds), question.accepted_ppm)
    found = {}
    for name in (end for asked in bad for end in _read_of(limited, asked)):
        activity(name)
        own = limited.of(name)
        effort = Effort.of(own, question)
        deviations, positions = drawn_builds(own, effort.builds)
        rates = rates_of(own, deviations, positions, effort.rows)
        found[name] = _Simulated(own, question.accepted_ppm, rates, deviations, positions).changes()
    return made(
        Changes,
        by="simulation",
        accepted_ppm=question.accepted_ppm,
        measures=found,
        further=[],
        evaluations=response.evaluations - before,
    )


def contributions_of(response: Response, measure: str | None = None) -> Rates:
    """Slopes and shares of every contributor in every measure, or in one.

    Raises:
        InputError: no such measure.
    """
    asked = response if measure is None else response.of(measure)
    effort = Effort.of(asked, ChangesQuestion())
    return rates_of(asked, *drawn_builds(asked, effort.builds), effort.rows)


def _limited(response: Response, measure: str | None) -> Response:
    """The response of measures with limits."""
    asked = response if measure is None else response.of(measure)
    names = [own.name for own in asked.measures if limits_of(own) != (None, None)]
    if not names:
        whose = repr(measure) if measure else "any measure that is one number a trial"
        raise InputError(f"expected a limit (lower_limit, upper_limit) of {whose}, got none")
    return response.of(*names)


@dataclass(frozen=True)
class Effort:
    """Number of builds to make.

    Args:
        rows: at which slopes are taken.
        builds: of each change.
    """

    rows: int
    builds: int

    @classmethod
    def of(cls, response: Response, question: ChangesQuestion) -> "Effort":
        """By what a build takes, as the method says, so that it is the same on every machine."""
        simulation = response.simulation
        cost = max(simulation.system.cost(response.measures), 1) * 60.0 / simulation.method.contacts_per_minute
        rows = int(SECONDS / cost / max(BATCHES * response.components, 1))
        builds = int(SECONDS / cost / (TRIED + 2 * LEVERS + 1))
        builds = question.builds or min(max(builds, FEWEST_BUILDS), MOST_BUILDS)
        return cls(min(max(rows, 2), MOST_ROWS), builds)


def _read_of(response: Response, name: str) -> list[str]:
    """The measure of a name; of a curve those of its ends that have limits."""
    ends = [end for end, curve in response.curves.items() if curve.name == name]
    return [own for own in response.names if own == name or own in ends]


def _bad(response: Response, deviations: Array, positions: Mapping[str, Array], accepted_ppm: float) -> list[str]:
    """Measures that leave their limits more often than is accepted, the worst first."""
    found = response.values(deviations, positions)
    values = np.where(found.seated, found.values, np.nan)
    out = {
        own.name: LimitCounts.of(values[:, k], *limits_of(own)).out_of_limits.ppm or 0.0
        for k, own in enumerate(response.measures)
    }
    return sorted((name for name in out if out[name] > accepted_ppm), key=lambda name: -out[name])


def limits_of(measure: Measure) -> tuple[float | None, float | None]:
    """Its limits in its unit."""
    lower, upper, per = measure.lower_limit, measure.upper_limit, measure.per_internal
    return None if lower is None else lower * per, None if upper is None else upper * per


# a measure ----------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Asked:
    """A measure that leaves its limits.

    Args:
        response: of it alone.
        accepted_ppm: share of builds that may be out of limits.
    """

    response: Response
    accepted_ppm: float

    @property
    def measure(self) -> Measure:
        """Which."""
        return self.response.measures[0]

    def judged(self, values: Array) -> tuple[Moments, LimitCounts, Performance]:
        """Builds (n,) as a study judges trials; NaN where one fails."""
        good = values[~np.isnan(values)]
        moments, counts = Moments.of(good), LimitCounts.of(values, *limits_of(self.measure))
        side = Side(moments, [], lambda p: float(np.quantile(good, p)) if len(good) else None)
        judged = Judged(*limits_of(self.measure), side, side, counts, counts.out_of_limits.interval_ppm())
        return moments, counts, judged.performance(self.response.simulation.study.ppk_by)

    def spread(self, values: Array) -> Spread:
        """Spread of builds (n,)."""
        moments, counts, performance = self.judged(values)
        out = counts.out_of_limits
        return made(
            Spread,
            mean=finite(moments.mean) if moments.count else None,
            sigma=finite(moments.sigma),
            out_ppm=finite(out.ppm),
            out_ppm_95=listed(out.interval_ppm()),
            ppk=finite(performance.ppk),
        )

    def targets(self, now: Array, mean: float, error: float) -> Iterator[tuple[Target, float]]:
        """Shift of the mean needed for each target that is not reached.

        Args:
            now: builds (n,); NaN where one fails.
            mean, error: of the measure, and its standard error.
        """
        good = now[~np.isnan(now)]
        least = max(NO_SHIFT * float(np.std(good)), SURE * error) if len(good) > 1 else 0.0
        for target, shift in self._targets(now, good, mean) if len(good) else ():
            if abs(shift) > least:
                yield target, shift

    def _targets(self, now: Array, good: Array, mean: float) -> Iterator[tuple[Target, float]]:
        lower, upper = limits_of(self.measure)
        if lower is not None and upper is not None:
            yield "middle of the limits", (lower + upper) / 2 - mean
            return
        sign, limit = (1.0, upper) if upper is not None else (-1.0, lower)
        assert limit is not None, "a measure with limits"
        values, edge = np.sort(sign * good), sign * limit  # as of an upper limit
        spare = math.floor(self.accepted_ppm * 1e-6 * len(now)) - (len(now) - len(good))
        if 0 <= spare < len(good):
            outer = values[-1 - spare : len(values) - spare + 1].mean()  # between the last one within and the next
            yield "accepted share", sign * min(edge - float(outer), 0.0)
        if len(now) == len(good) > 1:
            _, _, performance = self.judged(now)
            middle, reach = sign * mean, 3 * float(np.std(values, ddof=1))
            if performance.by == "quantiles":
                middle, outer = (float(own) for own in np.quantile(values, (0.5, 1 - OUTER)))
                reach = outer - middle
            yield "Ppk 1.33", sign * min(edge - TARGET_PPK * reach - middle, 0.0)


def levers_for(levers: Sequence[Lever], shift: float) -> list[Lever]:
    """Those that move a mean so far with the least change, and stay physical."""
    most = max((abs(own.slope) * own.per_unit for own in levers), default=0.0)
    useful = (own for own in levers if abs(own.slope) * own.per_unit > USELESS * most)
    return [own for own in useful if own.allows(shift / own.slope)][:LEVERS]


@dataclass(frozen=True, eq=False)
class _Simulated(Asked):
    """The same, with the builds by which changes are judged."""

    rates: Rates
    deviations: Array
    positions: Mapping[str, Array]

    def built(self, deviations: Array) -> Array:
        """Values (n,), NaN where a build fails."""
        found = self.response.values(deviations, self.positions)
        return np.asarray(np.where(found.seated[:, 0], found.values[:, 0], np.nan))

    def changes(self) -> MeasureChanges:
        """All of them."""
        now = self.built(self.deviations)
        lower, upper = limits_of(self.measure)
        nominal, taken = finite(float(self.rates.nominal[0])), list(self.taken())
        told = sum(own.first_order + own.second_order for own in taken)
        spread, (mean, error) = self.spread(now), self.mean_of(now)
        return made(
            MeasureChanges,
            unit=self.measure.unit,
            lower_limit=lower,
            upper_limit=upper,
            builds=len(now),
            now=spread,
            shifts=list(self.shifts(now, mean, error)),
            halved=self.halved(spread),
            nominal=nominal,
            taken=taken,
            taken_together=None if nominal is None else finite(mean - nominal - told),
            taken_error=finite(error),
        )

    def mean_of(self, now: Array) -> tuple[float, float]:
        """Mean of the measure and its standard error, less what the draws are off their means, by slopes."""
        good = ~np.isnan(now)
        if not good.any():
            return math.nan, math.nan
        off = (self.deviations[good] - self.response.mean) @ self.rates.slopes[0]
        left = now[good] - off
        return float(left.mean()), float(left.std() / math.sqrt(len(left)))

    def shifts(self, now: Array, mean: float, error: float) -> Iterator[Shift]:
        """Towards each target, by several nominals; a number of things that are counted has no mean to be moved."""
        if self.measure.unit in COUNTED:
            return
        levers = levers_of(self.response, self.rates.slopes[0], self.rates.steadiness[0])
        for target, shift in self.targets(now, mean, error):
            by = [self.moved(lever, shift, now) for lever in levers_for(levers, shift)]
            yield made(Shift, target=target, shift=shift, after=self.spread(now + shift), by=by)

    def moved(self, lever: Lever, shift: float, now: Array) -> Moved:
        """A nominal moved; where the mean does not follow its slope, once more by the secant."""
        change = shift / lever.slope
        after = self.built(self.deviations + change * lever.direction)
        got = float(np.nanmean(after) - np.nanmean(now)) if np.isfinite(after).any() else 0.0
        factor = shift / got if got else 0.0
        if abs(factor - 1.0) > MET and 0.5 < factor < 2.0 and lever.allows(change * factor):
            change *= factor
            after = self.built(self.deviations + change * lever.direction)
        told, unit = change / lever.per_unit, lever.unit
        return made(Moved, contributor=lever.name, change=told, unit=unit, after=self.spread(after))

    def halved(self, now: Spread) -> list[Halved]:
        """The tolerances whose halving helps most."""
        shares = self.rates.shares[0]
        found = []
        known = self.response.contributors
        ranked = [int(k) for k in np.argsort(-shares, kind="stable") if shares[k] > 0.0]
        for k in [k for k in ranked if known[k].unit != SHARE_OF_PLAY][:TRIED]:
            name = known[k].name
            after = self.spread(self.built(halved_deviations(self.response, name, self.deviations)))
            found.append(made(Halved, contributor=name, share_percent=100 * float(shares[k]), after=after))
        return helpful(found, now)

    def taken(self) -> Iterator[MeanOffset]:
        """By contributor, the most first."""
        first, second = self.rates.first[0], self.rates.second[0]
        for k in np.argsort(-np.abs(first + second), kind="stable"):
            if first[k] or second[k]:
                name = self.response.contributors[int(k)].name
                yield made(MeanOffset, contributor=name, first_order=float(first[k]), second_order=float(second[k]))


def helpful(found: Sequence[Halved], now: Spread) -> list[Halved]:
    """Those that make less fail, the best first; where the mean is beyond a limit, less spread makes more fail."""
    return sorted((own for own in found if _worth(own.after) < _worth(now)), key=lambda own: _worth(own.after))[:TOLD]


def _worth(after: Spread) -> tuple[float, float]:
    return after.out_ppm or 0.0, after.sigma or 0.0
