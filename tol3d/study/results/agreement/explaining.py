"""Explanation of the difference of the two methods: by contributor and by trial, or a warning.

A stack-up is of first order. So the difference (geometric - analytic) may be of second order, which `second_look.py`
measures; and of first order only where the stack-up leaves something out on purpose, and by how much at most
(`System.neglected`). Any other difference is an error of one of the methods.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.statistics.estimates.linear_fit import LinearFit
from tol3d.study.effects.regressors import Regressed
from tol3d.study.results.agreement.explanation import Explanation, LinearPart
from tol3d.study.results.agreement.method_fits import MethodFits
from tol3d.study.results.agreement.second_look import SecondLook, largest_bends
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.measure import Measure
from tol3d.study.system.regressors import has_square
from tol3d.study.system.stated import component_slices, mean_deviations
from tol3d.study.system.system import System
from tol3d.study.system.trials import Trials
from tol3d.units import FACTORS, RESOLVED

SURE = 5.0  # standard errors; by chance once in two million
SUREST = 1e6  # standard errors, at most, in a summary; without any chance there are infinitely many
SHARE = 0.02  # of a contributor's own effect; a wrong coefficient of 3 % and half a step of 110 a turn are beyond it
LEAST_LEFT = 0.01  # of the measure's sigma; what adds 0.005 % to it cannot be distinguished from 0 by 10^8 trials
LARGEST_LEFT = 5.0  # times that; the most that one of very many trials may be off by kinks of an extreme over a turn
NAMED = 3  # contributors of one sentence
CHORDS_OF_A_LOOK = 4  # chord errors in a second look: 4 D(1/2) - D(1) - 3 D(0), none of them below 0
SECOND_ORDER = "second order, for the means lie off the nominal build"
ROUNDING = 1e-9  # of the measure's unit; methods that never differ by more agree
ROUNDINGS = 32 * 2.0**-52  # of a coordinate; 14 were seen in a difference of the methods and its second look
REACH = 1e4  # mm; coordinates of a scene, or the measure where it is larger


@dataclass(frozen=True, eq=False)
class Case:
    """A measure whose difference is to be explained.

    Args:
        system, measure: those studied.
        fits: of all its trials.
        look: a second look at `looked` trials and others after them, of which `worst` has the largest difference; None
            if that was not looked at.
        whole: True if as many were looked at as were wanted.
        means: shift of the measure by each contributor's mean.
        chords: part of a difference that may be chord error.
    """

    system: System
    measure: Measure
    fits: MethodFits
    look: SecondLook
    worst: int | None
    looked: int
    whole: bool
    means: Mapping[str, float]
    chords: float

    def explained(self, bent: Mapping[str, float]) -> Explanation:
        """Explanation of the difference; `bent` are the second differences of each contributor."""
        name, first = self.measure.name, slice(0, self.looked)
        curved = np.where(np.arange(len(self.look.trials)) < self.looked, self.look.second_order[name], np.nan)
        straight = np.where(np.isnan(curved), np.nan, self.look.left(name))
        second, left = (self._fit(target) for target in (curved, straight))
        bounds = self.system.neglected(self.measure, self.look.trials)
        first_order = self.fits.difference.less(second) if second else self.fits.difference
        parts = tuple(self._linear_parts(first_order))
        open_parts = [part.contributor for part in parts if not part.by]
        untold = bool(open_parts) and second is None and not self.whole
        mean = self._mean(curved, first_order, sum((bound[first].mean() for bound in bounds.values()), 0.0))
        allowed = math.hypot(self._negligible, _rms(sum(bounds.values(), np.zeros(len(curved)))[first]))
        jumps = self.measure.unit in FACTORS["count"]  # what is near a bound one method counts and the other does not
        known = not jumps and not np.isnan(curved[first]).all()
        left_rms = min(left.residual, self.fits.difference.residual) if left else None
        beyond: tuple[str, ...] = ()
        if not jumps:
            beyond = (
                *self._beyond(left_rms, allowed + CHORDS_OF_A_LOOK * self.chords),
                *self._beyond_in_the_worst(bounds, mean),
                *self._mean_fault(mean),
            )
        found = (*(() if untold else self._unexplained(parts)), *beyond)
        return Explanation(
            undecided=self._untold(open_parts) if untold else "",
            faults=() if self.fits.disagreement.largest <= ROUNDING else found,
            linear=parts,
            largest_trial=self.fits.disagreement.trial,
            largest_percent=self._largest_percent([part.contributor for part in parts]),
            neglected={words: _rms(own[first]) for words, own in bounds.items()},
            second_order_rms=_rms(curved[first]) if known else None,
            second_order_mean=float(np.nanmean(curved[first])) if known else None,
            second_order_of=largest_bends(bent),
            left_rms=left_rms,
            mean_left=mean.left,
            mean_allowed=mean.allowed,
        )

    @property
    def _regressed(self) -> Regressed:
        return self.fits.regressed

    def _fit(self, target: Array) -> LinearFit | None:
        return LinearFit.of(self.look.sums(self.measure.name, self._regressed, target), self._regressed.parts)

    @property
    def _negligible(self) -> float:
        """Remainder that need not be explained [unit of the measure].

        A share of sigma; of a measure that does not vary, for all that acts on it is constant, rounding and the same
        share of the shift by its constants in second order: that of higher order is less.
        """
        resolution = RESOLVED * self.measure.per_internal
        rounding = max(resolution, ROUNDINGS * max(REACH * self.measure.per_internal, self.fits.magnitude))
        if self.fits.sigma > rounding:
            return max(LEAST_LEFT * self.fits.sigma, resolution)
        return rounding + LEAST_LEFT * _rms(self.look.second_order[self.measure.name][: self.looked])

    # linear parts -----------------------------------------------------------------------------------

    def _linear_parts(self, first_order: LinearFit) -> Iterator[LinearPart]:
        """Contributors whose linear part is beyond chance and SHARE, with its explanation.

        Args:
            first_order: first-order part of the difference, less that which follows from second order.
        """
        fit, own = self.fits.difference, self.fits.own
        sure, size = fit.standard_errors, fit.effects
        left, left_sure = first_order.effects, first_order.standard_errors
        for k in np.flatnonzero((sure > SURE) & (size > SHARE * own)).tolist():
            reason = self._reason(k, float(left[k]), float(left_sure[k]))
            yield LinearPart(
                self._regressed.names[k], 100 * float(size[k] / own[k]), min(float(sure[k]), SUREST), reason
            )

    def _reason(self, k: int, left: float, sure: float) -> str:
        """Explanation of a contributor's linear part, "" if there is none.

        Args:
            k: index of the contributor.
            left: the part beside second order [unit of the measure].
            sure: that part in standard errors.
        """
        allowed = SHARE * float(self.fits.own[k])
        if left <= allowed:
            return SECOND_ORDER
        if sure <= SURE:
            return f"{SECOND_ORDER}, as far as {self.looked} builds tell"
        beyond_chance = left * (1 - SURE / sure)
        sizes = {words: _rms(own) for words, own in self._left_out_by(k).items()}
        reasons: list[str] = []
        for words, size in sorted(sizes.items(), key=lambda item: -item[1]):
            if size > 0.0:
                reasons.append(words)
                allowed += size
                if beyond_chance <= allowed:
                    return " and ".join(reasons)
        return ""

    def _left_out_by(self, k: int) -> Mapping[str, Array]:
        """Largest part of a contributor's effect that the stack-up leaves out.

        Where positions or load paths are compared all that is left out helps to choose one of them, and by that what
        any contributor does; its part in the difference is no larger than the difference then. Else it is scaled: the
        spread of the contributor in all trials is not that in those looked at.
        """
        trials = self.look.trials.part(0, self.looked)
        if self.measure.take != "value" or not self.measure.adds_up:
            return self.system.neglected(self.measure, trials)
        name = self._regressed.names[k]
        found = self.system.neglected(self.measure, self._alone(trials, name))
        rows = self._regressed.rows[self._regressed.groups[name]]
        seen = self.look.regressors[self.measure.name][rows, : self.looked].var(axis=1)
        spread = self.fits.difference.variances(k)
        first = np.s_[:1] if has_square(self._contributor(name)) else np.s_[:]  # a square is no component
        to_scale = math.sqrt(spread[first].sum() / seen[first].sum()) if seen[first].any() else 1.0
        return {words: to_scale * own for words, own in found.items()}

    def _alone(self, trials: Trials, name: str) -> Trials:
        """Trials in which one contributor alone deviates, as far from its mean as in these."""
        own = component_slices(self.system)[name]
        deviations = np.zeros_like(trials.deviations)
        middle = mean_deviations(self.system, self.measure.positions)
        deviations[:, own] = trials.deviations[:, own] - middle[:, own]
        return replace(trials, deviations=deviations)

    def _contributor(self, name: str) -> Contributor:
        return next(contributor for contributor in self.system.contributors if contributor.name == name)

    def _untold(self, names: Sequence[str]) -> str:
        named = ", ".join(names[:NAMED]) + (f" and {len(names) - NAMED} more" if len(names) > NAMED else "")
        return (
            f"it depends on {named} by more than {100 * SHARE:.0f} % of their own effects, and {self.looked} builds "
            "looked at again are too few to tell why; more trials let more builds follow them"
        )

    def _unexplained(self, parts: tuple[LinearPart, ...]) -> Iterator[str]:
        for part in parts:
            if not part.by:
                yield (
                    f"the two methods disagree on {part.contributor}: their difference depends on it by "
                    f"{part.percent:.3g} % of its own effect ({part.standard_errors:.3g} standard errors), "
                    "which no second-order term explains; one of the methods is wrong there"
                )

    def _largest_percent(self, besides: list[str]) -> float:
        """The largest part of the other contributors that is beyond chance, of its own effect [%]."""
        fit = self.fits.difference
        others = ~np.isin(self._regressed.names, besides) & (fit.standard_errors > SURE)
        return float(np.max(100 * fit.effects[others] / self.fits.own[others], initial=0.0))

    # what is left -----------------------------------------------------------------------------------

    def _beyond(self, left_rms: float | None, allowed: float) -> Iterator[str]:
        if left_rms is not None and left_rms > allowed:
            yield (
                f"differences of rms {left_rms:.3g} {self.measure.unit} are neither linear in a contributor nor of "
                f"second order; at most {allowed:.3g} {self.measure.unit} of that are explained"
            )

    def _beyond_in_the_worst(self, bounds: Mapping[str, Array], mean: "_Mean") -> Iterator[str]:
        """The trial of the largest difference, where more of it than contributors may be off is not of second order."""
        if self.worst is None:
            return
        straight, whole = self.look.left(self.measure.name), self.look.whole[self.measure.name]
        left = min(abs(float(straight[self.worst])), abs(float(whole[self.worst])))
        regressors = self.look.regressors[self.measure.name][self._regressed.rows, self.worst]
        allowed = mean.allowed + CHORDS_OF_A_LOOK * self.chords + LARGEST_LEFT * self._negligible
        allowed += sum(float(bound[self.worst]) for bound in bounds.values())
        allowed += SHARE * float(np.sum(self.fits.own * self.fits.difference.reaches(regressors)))
        if left > allowed:  # not where it is nan
            yield (
                f"trial {self.fits.disagreement.trial} differs by {self.fits.disagreement.largest:.3g} "
                f"{self.measure.unit}, of which {left:.3g} {self.measure.unit} are not of second order; {allowed:.3g} "
                f"{self.measure.unit} are explained"
            )

    # means ------------------------------------------------------------------------------------------

    def _mean(self, curved: Array, first_order: LinearFit, left_out: float) -> "_Mean":
        """The difference of the means less the second-order part, and the allowed remainder."""
        sums, nominal = self.fits.disagreement.sums, self.look.nominal[self.measure.name][: self.looked]
        known = curved[~np.isnan(curved)]
        if not len(known):
            known, nominal = np.zeros(1), np.zeros(1)
        error = math.hypot(sums.target_sigma / math.sqrt(sums.count), float(known.std()) / math.sqrt(len(known)))
        allowed = SURE * error + self._negligible + left_out + self.chords
        allowed += float(self._accuracies(first_order) @ [self.means[name] for name in self._regressed.names])
        at_nominal = float(np.nanmean(nominal))
        return _Mean(sums.target_mean, error, at_nominal, sums.target_mean - float(known.mean()) - at_nominal, allowed)

    def _left_out_at_nominal(self) -> float:
        """Part of nominal builds that the stack-up leaves out on purpose, in the mean of the positions looked at."""
        trials = self.look.trials.part(0, self.looked)
        nominal = replace(trials, deviations=np.zeros_like(trials.deviations))
        return sum(float(own.mean()) for own in self.system.neglected(self.measure, nominal).values())

    def _accuracies(self, first_order: LinearFit) -> Array:
        """Share of its effect to which both methods are known to agree on a contributor's coefficient, SHARE at most.

        Counts may not change with one at all.
        """
        fit, own = self.fits.difference, self.fits.own
        known = (own > 0.0) & (fit.spreads > 0.0)
        left = first_order.effects + SURE * fit.chances
        shares: Array = np.divide(left, own, out=np.full(len(own), SHARE), where=known)
        return np.minimum(shares, SHARE)

    def _mean_fault(self, mean: "_Mean") -> Iterator[str]:
        unit = self.measure.unit
        allowed = self._negligible + self.chords
        if abs(mean.nominal) > allowed and abs(mean.nominal) > allowed + self._left_out_at_nominal():
            yield f"the methods differ by {mean.nominal:.3g} {unit} in the mean at the nominal build already"
        if abs(mean.left) > mean.allowed:
            yield (
                f"the means differ by {mean.difference:.3g} {unit} (standard error {mean.error:.2g} {unit}), of which "
                f"{mean.left:.3g} {unit} are not of second order; {mean.allowed:.3g} {unit} are explained"
            )


@dataclass(frozen=True)
class _Mean:
    """A difference of means: whole, its standard error, that of the nominal build, the rest beside second order."""

    difference: float
    error: float
    nominal: float
    left: float
    allowed: float


def _rms(values: Array) -> float:
    known = values[~np.isnan(values)]
    return float(np.sqrt(np.mean(known**2))) if len(known) else 0.0
