"""Recommended changes for measures out of limits: nominals to move, tolerances to halve, causes of a mean off nominal.

Rates select contributors (slopes.py). Each change is then simulated: the same uniforms again, drawn by the changed
laws. Only what helps is told (compared_builds.py): fewer builds of the measure out of limits, or a higher Ppk, beyond
chance, and no other measure with limits worse.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Final

import numpy as np
from pydantic import Field

from tol3d.analyses.compared_builds import SURE, Compared, drawn_builds, judged, limits_of
from tol3d.analyses.response import Response
from tol3d.analyses.slopes import BATCHES, Lever, Rates, levers_of, nominal_of, rates_of
from tol3d.analyses.stated_changes import told
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.report.number import COUNTED
from tol3d.statistics.estimates import LimitCounts
from tol3d.study.runs.summary.judged import ACCEPTED_PPM
from tol3d.study.runs.summary.shows import Shows
from tol3d.study.runs.summary.values import Count, Known, Label, Number, Positive, Ppm, PpmRange, Section, made
from tol3d.study.system.measure import Inspecting, Measure
from tol3d.study.tallies.performance import OUTER
from tol3d.study.tallies.sample import finite, listed

AIM: Final = 1.33
"""Ppk that a change should reach, where none is asked for."""
SECONDS: Final = 20.0
"""Seconds of builds for a measure, by the method's stated cost of one: a result must not depend on the clock."""
MOST_ROWS: Final = 16
ROWS: Final = 0.25
"""Fraction of the seconds for slopes."""
MOST_SLOPES: Final = 1600
"""Builds at which slopes are taken: so many, or more where there are so few contributors."""
MOST_BUILDS: Final = 5000
FEWEST_BUILDS: Final = 400
"""For each change."""
TRIED: Final = 8
"""Tolerances that are halved."""
LEVERS: Final = 3
"""Contributors whose nominals are moved."""
STEPS: Final = 2
"""Ways of each of them: by its slope, and by the secant."""
SHORTER: Final = (0.2, 0.35, 0.5, 0.6, 0.7, 0.8)
"""Fractions of the way, where the mean follows neither."""
BENT: Final = 0.1
"""Fraction of a shift; if more is left after the secant, the mean does not follow it."""
TOGETHER: Final = 4
"""Changes that are made together, at most."""
TOLD: Final = 8
HALF: Final = 0.5
NO_SHIFT: Final = 0.01
"""Fraction of sigma; a mean that is nearer to its target stays."""
MET: Final = 0.01
"""Fraction of a shift that may be left, and of a Ppk."""
SHARE_OF_PLAY: Final = "1"
"""Unit of what is no tolerance: where a part lies in its play."""
USELESS: Final = 1e-3
"""Fraction of the steepest slope; a mean is not moved by a flatter one."""
BESIDE: Final = 50
"""Builds of measures without limits, beside a change; more where these take no longer than the measure itself."""
TINY: Final = 1e-12
"""Minutes."""
SEEN: Final = 0.1
"""Fraction of sigma, by which the mean of another measure moves if it is told; of a Ppk as much."""


class Spread(Section):
    """Spread of a measure within its limits, in its unit."""

    mean: Annotated[Known, Shows("mean")]
    sigma: Annotated[Known, Shows("sigma")]
    out_ppm: Annotated[Ppm | None, Shows("out of limits", "share")] = Field(
        description="failed or out of limits, of all builds"
    )
    out_ppm_95: Annotated[PpmRange | None, Shows("95 % interval", "share range", optional=True)]
    ppk: Annotated[Known, Shows("Ppk", ".2f")]


class Step(Section):
    """A change to one tolerance: its nominal moved, or half as wide."""

    contributor: Label = Field(description="the line of the scene that states it, for all that it holds for")
    change: Known = Field(description="of the nominal, in `unit`; None where the tolerance is half as wide")
    unit: Label
    nominal: str = Field(description="the word of a drawing for it, such as E_sns and E_sni; empty of a half")
    becomes: Label = Field(description="the tolerance then, in words and numbers")


class Beside(Section):
    """Another measure before and after a change, in its unit."""

    measure: Label
    unit: Label
    has_limits: bool
    now: Spread
    after: Spread


class Proposal(Section):
    """Changes that help, and what they make of the measure and of others."""

    steps: list[Step]
    after: Spread
    beside: list[Beside]

    def reaches(self, ppk: float) -> bool:
        """True if its Ppk is as high as that."""
        return self.after.ppk is not None and self.after.ppk >= (1.0 - MET) * ppk


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
    proposals: list[Proposal] = Field(description="the best first")
    tried: Count = Field(description="changes that were simulated")
    nominal: Known = Field(description="every deviation 0, averaged over positions")
    taken: list[MeanOffset]
    taken_together: Known = Field(description="what of mean less nominal is no contributor's alone")
    taken_error: Known = Field(description="standard error of that")


class Changes(Section):
    """Recommended changes to a scene, measure by measure."""

    accepted_ppm: Ppm
    ppk: Number = Field(description="that a change should reach")
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
        ppk: that a change should reach.
        seconds: of builds for a measure.
        most_builds: of each change, where `builds` says none.
    """

    measure: str | None = None
    accepted_ppm: float = ACCEPTED_PPM
    builds: int | None = None
    ppk: float = AIM
    seconds: float = SECONDS
    most_builds: int = MOST_BUILDS


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
        found[name] = _Asked(response, own, question.ppk, rates, deviations, positions).changes()
    return made(
        Changes,
        accepted_ppm=question.accepted_ppm,
        ppk=question.ppk,
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
        enough: whether the seconds suffice for as many builds as can judge a change.
    """

    rows: int
    builds: int
    enough: bool

    @classmethod
    def of(cls, response: Response, question: ChangesQuestion) -> "Effort":
        """By what a build takes, as the method says, so that it is the same on every machine."""
        cost = 60.0 * response.minutes or 1e-9
        rows = int(ROWS * question.seconds / cost / max(BATCHES * response.components, 1))
        quick = int(question.seconds / cost / (TRIED + STEPS * LEVERS + TOGETHER + 1))
        builds = question.builds or min(max(quick, FEWEST_BUILDS), question.most_builds)
        most = max(MOST_SLOPES // max(response.components, 1), MOST_ROWS)
        return cls(min(max(rows, 2), most, builds), builds, quick >= FEWEST_BUILDS and rows > 0)


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


# a measure ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Change:
    """Nominals that are moved, by line of the scene [mm, rad or K], and tolerances that are half as wide."""

    moved: Mapping[str, float]
    halved: tuple[str, ...] = ()

    def made(self, response: Response) -> Response:
        """The system with it."""
        halves = {name: HALF for line in self.halved for name in response.lines[line]}
        moved = {name: by for line, by in self.moved.items() for name in response.lines[line]}
        return response.scaled(halves).shifted(moved)

    def beside(self, other: "_Change") -> "_Change":
        """Both."""
        return _Change({**self.moved, **other.moved}, (*self.halved, *other.halved))


@dataclass(frozen=True, eq=False)
class _Asked:
    """A measure that leaves its limits, and the builds by which changes are judged.

    Args:
        whole: of all measures.
        response: of it alone.
        aim: Ppk that is asked for.
        rates: of it.
        deviations, positions: the builds.
    """

    whole: Response
    response: Response
    aim: float
    rates: Rates
    deviations: Array
    positions: Mapping[str, Array]

    @property
    def measure(self) -> Measure:
        return self.response.measures[0]

    def built(self, response: Response, deviations: Array) -> Array:
        """Values (n, measures), NaN where a build fails."""
        found = response.values(deviations, {name: own[: len(deviations)] for name, own in self.positions.items()})
        return np.asarray(np.where(found.seated, found.values, np.nan))

    @cached_property
    def now(self) -> Array:
        """Samples of the measure as it is."""
        return self.built(self.response, self.deviations)[:, 0]

    def changes(self) -> MeasureChanges:
        """All of them."""
        lower, upper = limits_of(self.measure)
        nominal, taken = finite(float(self.rates.nominal[0])), list(self.taken())
        known = sum(own.first_order + own.second_order for own in taken)
        mean, error = self.mean_and_error
        singles = [*self.moves(), *self.halves()]
        tried = len(singles)
        found = [own for single in singles if single is not None and (own := self.proposal(*single)) is not None]
        if more := self.together(found):
            tried, found = tried + 1, [*found, more]
        found.sort(key=lambda own: _worth(own[1].after))
        return made(
            MeasureChanges,
            unit=self.measure.unit,
            lower_limit=lower,
            upper_limit=upper,
            builds=len(self.now),
            now=self.spread(self.measure, self.now),
            proposals=[own for _, own in found[:TOLD]],
            tried=tried,
            nominal=nominal,
            taken=taken,
            taken_together=None if nominal is None else finite(mean - nominal - known),
            taken_error=finite(error),
        )

    def spread(self, measure: Measure, values: Array) -> Spread:
        """Spread of a measure's builds (n,)."""
        moments, counts, performance = judged(measure, values, self.response.simulation.study.ppk_by)
        out = counts.out_of_limits
        return made(
            Spread,
            mean=finite(moments.mean) if moments.count else None,
            sigma=finite(moments.sigma) if moments.count > 1 else None,
            out_ppm=finite(out.ppm),
            out_ppm_95=listed(out.interval_ppm()),
            ppk=finite(performance.ppk),
        )

    # which changes --------------------------------------------------------------------------------

    @cached_property
    def mean_and_error(self) -> tuple[float, float]:
        """Mean of the measure and its standard error, less what the draws are off their means, by slopes."""
        good = ~np.isnan(self.now)
        if not good.any():
            return math.nan, math.nan
        off = (self.deviations[good] - self.response.mean) @ self.rates.slopes[0]
        left = self.now[good] - off
        return float(left.mean()), float(left.std() / math.sqrt(len(left)))

    @cached_property
    def shift(self) -> float:
        """Distance of the mean from the middle of both limits, or from where the Ppk is what is asked for."""
        good = self.now[~np.isnan(self.now)]
        if len(good) < 2:
            return 0.0
        mean, error = self.mean_and_error
        lower, upper = limits_of(self.measure)
        if lower is not None and upper is not None:
            shift = (lower + upper) / 2 - mean
        else:
            sign, limit = (1.0, upper) if upper is not None else (-1.0, lower)
            assert limit is not None, "a measure with limits"
            values = sign * good  # as of an upper limit
            _, _, performance = judged(self.measure, good, self.response.simulation.study.ppk_by)
            middle, reach = sign * mean, 3 * float(np.std(values, ddof=1))
            if performance.by == "quantiles":
                middle, outer = (float(own) for own in np.quantile(values, (0.5, 1 - OUTER)))
                reach = outer - middle
            shift = sign * min(sign * limit - self.aim * reach - middle, 0.0)
        return shift if abs(shift) > max(NO_SHIFT * float(np.std(good)), SURE * error) else 0.0

    def moves(self) -> Iterator[tuple[_Change, Array] | None]:
        """Nominals moved, of those that move the mean with the least change.

        A number of things that are counted has no mean to be moved, and no nominal moves what is judged against it.
        """
        measure = self.measure
        inspects = isinstance(measure, Inspecting) and measure.inspects
        if measure.unit in COUNTED or inspects or not self.shift:
            return
        levers = levers_of(self.response, self.rates.slopes[0], self.rates.steadiness[0])
        most = max((abs(own.slope) * own.per_unit for own in levers), default=0.0)
        count = 0
        for lever in levers:
            if abs(lever.slope) * lever.per_unit > USELESS * most and self._can_be(lever, self.shift / lever.slope):
                yield self.moved(lever)
                count += 1
                if count == LEVERS:
                    return

    def _can_be(self, lever: Lever, change: float) -> bool:
        try:
            _Change({lever.line: change}).made(self.response)
        except InputError:
            return False
        return True

    def moved(self, lever: Lever) -> tuple[_Change, Array] | None:
        """A nominal moved, once more by the secant where the mean does not follow its slope; None if that harms.

        Where it does not follow the secant either, the best of some shorter ways.
        """
        change = self.shift / lever.slope
        tried = {change: self.changed(_Change({lever.line: change}))}
        factor = self.left(tried[change])
        if abs(factor - 1.0) > MET and 0.5 < factor < 2.0 and self._can_be(lever, change * factor):
            change *= factor
            tried[change] = self.changed(_Change({lever.line: change}))
        if abs(self.left(tried[change]) - 1.0) > BENT:
            for shorter in (share * change for share in SHORTER):
                if self._can_be(lever, shorter):
                    tried[shorter] = self.changed(_Change({lever.line: shorter}))
            change = min(tried, key=lambda own: _worth(self.spread(self.measure, tried[own])))
        after = tried[change]
        return (_Change({lever.line: change}), after) if self.compared(after).better() else None

    def left(self, after: Array) -> float:
        """The shift over that of the mean after a change; 0 where none is known."""
        if not np.isfinite(after).any():
            return 0.0
        got = float(np.nanmean(after) - np.nanmean(self.now))
        return self.shift / got if got else 0.0

    def halves(self) -> Iterator[tuple[_Change, Array] | None]:
        """Tolerances half as wide, of those with the largest shares."""
        known = {own.name: k for k, own in enumerate(self.response.contributors)}
        shares = {
            line: float(self.rates.shares[0, [known[name] for name in names]].sum())
            for line, names in self.response.lines.items()
            if self.response.contributors[known[names[0]]].unit != SHARE_OF_PLAY
        }
        for line in sorted((line for line in shares if shares[line] > 0.0), key=lambda own: -shares[own])[:TRIED]:
            change = _Change({}, (line,))
            try:
                after = self.changed(change)
            except InputError:  # it has no width of its own, or acts by more than its deviation
                continue
            yield (change, after) if self.compared(after).better() else None

    def together(self, found: "Sequence[tuple[_Change, Proposal]]") -> "tuple[_Change, Proposal] | None":
        """The best nominal and the best halves at once, as few as reach the Ppk; None where one does, or none do."""
        if not found or any(own.reaches(self.aim) for _, own in found):
            return None
        ranked = sorted(found, key=lambda own: _worth(own[1].after))
        moves = [change for change, _ in ranked if change.moved][:1]
        steps = [*moves, *(change for change, _ in ranked if change.halved)][:TOGETHER]
        whole = steps[0]
        for step in steps[1:]:
            whole = whole.beside(step)
            own = self.proposal(whole, self.changed(whole))
            if own is not None and own[1].reaches(self.aim):
                return own
        return None

    # what comes of them -----------------------------------------------------------------------------

    def changed(self, change: _Change) -> Array:
        """Values of the measure (n,) with a change."""
        deviations, _ = drawn_builds(change.made(self.response), len(self.deviations))
        return self.built(self.response, deviations)[:, 0]

    def compared(self, after: Array) -> Compared:
        """The measure before and after a change."""
        return Compared(self.measure, self.now, after, self.response.simulation.study.ppk_by)

    def proposal(self, change: _Change, after: Array) -> "tuple[_Change, Proposal] | None":
        """A change that helps, with what it does beside; None where it harms another measure with limits."""
        if not self.compared(after).better():
            return None
        deviations, _ = drawn_builds(change.made(self.response), len(self.deviations))
        beside = []
        for response, before in self.others:
            values = self.built(response, deviations[: len(before)])
            for k, measure in enumerate(response.measures):
                own = Compared(measure, before[:, k], values[:, k], response.simulation.study.ppk_by)
                limits = limits_of(measure) != (None, None)
                if limits and not own.no_worse(self.aim):
                    return None
                each = made(
                    Beside,
                    measure=measure.name,
                    unit=measure.unit,
                    has_limits=limits,
                    now=self.spread(measure, own.before),
                    after=self.spread(measure, own.after),
                )
                if _is_seen(each):
                    beside.append(each)
        spread = self.spread(self.measure, after)
        return change, made(Proposal, steps=list(self.steps(change)), after=spread, beside=beside)

    @cached_property
    def others(self) -> list[tuple[Response, Array]]:
        """Other measures, with limits and without, each with builds as they are."""
        found = []
        for limits in (True, False):
            others = [measure for measure in self.whole.measures if measure.name != self.measure.name]
            if names := [other.name for other in others if (limits_of(other) != (None, None)) == limits]:
                response, count = self.whole.of(*names), len(self.deviations)
                share = 1.0 if limits else self.response.minutes / max(response.minutes, self.response.minutes, TINY)
                found.append((response, self.built(response, self.deviations[: max(int(share * count), BESIDE)])))
        return found

    def steps(self, change: _Change) -> Iterator[Step]:
        """A change, line by line."""
        known, draws = (
            {contributor.name: contributor for contributor in self.response.contributors},
            change.made(self.response).draws,
        )
        for line in (*change.moved, *change.halved):
            first, *others = self.response.lines[line]
            own, moved = known[first], line in change.moved
            yield made(
                Step,
                contributor=line,
                change=change.moved[line] / own.per_unit if moved else None,
                unit=own.unit,
                nominal=nominal_of(own) if moved else "",
                becomes=told(own, draws[first]) + (f", each of {1 + len(others)}" if others else ""),
            )

    def taken(self) -> Iterator[MeanOffset]:
        """By contributor, the most first."""
        first, second = self.rates.first[0], self.rates.second[0]
        for k in np.argsort(-np.abs(first + second), kind="stable"):
            if first[k] or second[k]:
                name = self.response.contributors[int(k)].name
                yield made(MeanOffset, contributor=name, first_order=float(first[k]), second_order=float(second[k]))


def _worth(after: Spread) -> tuple[float, float]:
    return after.out_ppm or 0.0, -(after.ppk or 0.0)


def _is_seen(beside: Beside) -> bool:
    """True if the mean or the Ppk of another measure changes by what a reader should see."""
    now, after = beside.now, beside.after
    moved = abs((after.mean or 0.0) - (now.mean or 0.0)) > SEEN * (now.sigma or 0.0)
    return moved or (beside.has_limits and abs((after.ppk or 0.0) - (now.ppk or 0.0)) > SEEN)
