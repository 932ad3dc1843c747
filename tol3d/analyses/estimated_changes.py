"""Recommended changes below the verdict of a run: quick estimates from its trials and a few slopes.

The run's own trials are shifted, or narrowed about their mean by the root of 1 - 3/4 of a contributor's share of the
variance, as for a measure that adds up. what_to_change.py simulates each change.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from tol3d.analyses.drawn_builds import drawn_builds
from tol3d.analyses.response import response_of
from tol3d.analyses.slopes import few_slopes, levers_of
from tol3d.analyses.what_to_change import (
    SHARE_OF_PLAY,
    TOLD,
    Asked,
    Changes,
    Halved,
    MeasureChanges,
    Moved,
    Shift,
    Spread,
    helpful,
    levers_for,
    limits_of,
)
from tol3d.numerics.arrays import Array
from tol3d.report.column import ranked_contributors, shares_of
from tol3d.report.heading import badness
from tol3d.report.number import COUNTED
from tol3d.report.verdict import Accepted, AcceptedPpk, JudgedMeasure, accepted_in
from tol3d.runs.run import Run
from tol3d.runs.summary.measure import MeasureSummary
from tol3d.runs.summary.values import made
from tol3d.study.simulation import Simulation
from tol3d.system.method import ANALYTIC_METHOD
from tol3d.system.outcome import SEATED

MOST_MEASURES: Final = 3
STEEPEST: Final = 6
"""Contributors with the largest shares, whose slopes are taken."""
MOST_ROWS: Final = 8
SECONDS: Final = 0.2
"""Seconds of builds for a measure, by the method's stated cost of one."""
MOST_TRIALS: Final = 100_000
"""Trials of a run that are shifted and narrowed."""


def not_ok(run: Run, accepted: Accepted | None = None) -> list[str]:
    """Measures whose verdict is NOT OK, the worst first; by default by what the study asks."""
    found, asked = run.found.measures, accepted_in(run.found, accepted)
    names = [name for name, own in found.items() if JudgedMeasure.of(own, asked).verdict == "NOT OK"]
    return sorted(names, key=lambda name: badness(found[name].shares.out_ppm, found[name].shares.ppk))


def estimated_changes(run: Run, simulation: Simulation, accepted: Accepted | None = None) -> Changes | None:
    """Recommended changes to the scene of a run, for the worst measures; None if none can be estimated."""
    asked_for = accepted_in(run.found, accepted)
    accepted_ppm = asked_for.beyond_one_ppm if isinstance(asked_for, AcceptedPpk) else asked_for
    bad = [name for name in not_ok(run, asked_for) if run.found.measures[name].has_limits]
    asked = [name for name in bad if _can_be_estimated(run.found.measures[name])]
    if not asked:
        return None
    response = response_of(_by_the_quickest_method(simulation))
    shown = asked[:MOST_MEASURES]
    return made(
        Changes,
        by="rates",
        accepted_ppm=accepted_ppm,
        measures={name: _Told(response.of(name), accepted_ppm, run).changes() for name in shown},
        further=[name for name in bad if name not in shown],
        evaluations=response.evaluations,
    )


def _can_be_estimated(measure: MeasureSummary) -> bool:
    """True if it is one unrestricted number per trial: no curve, and no count."""
    return measure.take != "curve" and measure.unit not in COUNTED


def _by_the_quickest_method(simulation: Simulation) -> Simulation:
    """By the 3D simulation that takes least."""
    methods = {name: own for name, own in simulation.system.methods.items() if name != ANALYTIC_METHOD}
    if not simulation.has_geometry or not methods:
        return simulation
    quickest = max(methods, key=lambda name: (methods[name].contacts_per_minute, name == simulation.study.engine))
    return replace(simulation, study=replace(simulation.study, engine=quickest))


@dataclass(frozen=True, eq=False)
class _Told(Asked):
    """A measure, and the run that found it NOT OK."""

    run: Run

    @property
    def summary(self) -> MeasureSummary:
        return self.run.found.measures[self.measure.name]

    def changes(self) -> MeasureChanges:
        now = self.trials()
        lower, upper = limits_of(self.measure)
        nominal, spread = getattr(self.summary.nominal, self.summary.best_method), self.spread(now)
        return made(
            MeasureChanges,
            unit=self.measure.unit,
            lower_limit=lower,
            upper_limit=upper,
            builds=len(now),
            now=spread,
            shifts=list(self.shifts(now)),
            halved=self.halved(now, spread),
            nominal=nominal if isinstance(nominal, float) else None,
            taken=[],
            taken_together=None,
            taken_error=None,
        )

    def trials(self) -> Array:
        """Values of the run's trials, nan of those that failed; of one that kept none by the bars of its histogram."""
        name, method = self.measure.name, self.summary.best_method
        if not self.run.keeps_trials:
            return self._from_bars()
        found: list[Array] = []
        columns = (f"{method}:{name}", f"status:{name}")
        there = [own for own in columns if own in self.run.column_names]
        for piece in self.run.pieces(*there):
            values = np.array(piece[columns[0]], dtype=np.float64)
            if columns[1] in piece:
                values[np.asarray(piece[columns[1]]) != SEATED] = np.nan
            found.append(values)
            if sum(map(len, found)) >= MOST_TRIALS:
                break
        return np.concatenate(found)[:MOST_TRIALS]

    def _from_bars(self) -> Array:
        bars = self.summary.histogram
        failed = self.summary.trials - self.summary.seated
        if bars is None or bars.counts is None or bars.lower_edge is None or bars.bin_width is None:
            return np.full(max(failed, 1), np.nan)
        counts = np.array([*bars.counts[self.summary.best_method], failed], dtype=np.float64)
        counts = np.rint(counts * min(1.0, MOST_TRIALS / max(counts.sum(), 1.0))).astype(np.int64)
        edges = bars.lower_edge + bars.bin_width * np.arange(len(counts) - 1)
        spread = [edge + bars.bin_width * (np.arange(n) + 0.5) / n for edge, n in zip(edges, counts, strict=False) if n]
        return np.concatenate([*spread, np.full(int(counts[-1]), np.nan)])

    @property
    def shares(self) -> dict[str, float]:
        """Shares of the variance, the largest first."""
        column = next((own for own in shares_of(self.summary) if own.method == self.summary.best_method), None)
        if column is None:
            return {}
        known = {name: column.percents.get(name) for name in ranked_contributors(self.summary)}
        return {name: min(share, 100.0) / 100 for name, share in known.items() if share is not None and share > 0.0}

    def shifts(self, now: Array) -> Iterator[Shift]:
        good = now[~np.isnan(now)]
        mean = float(good.mean()) if len(good) else 0.0
        error = float(good.std() / np.sqrt(len(good))) if len(good) else 0.0
        targets = list(self.targets(now, mean, error))
        if not targets:
            return
        slopes, steadiness = self.slopes([*self.shares][:STEEPEST])
        levers = levers_of(self.response, slopes, steadiness)
        for target, shift in targets:
            after = self.spread(now + shift)
            by = [
                made(
                    Moved,
                    contributor=own.name,
                    change=shift / own.slope / own.per_unit,
                    unit=own.unit,
                    after=after,
                )
                for own in levers_for(levers, shift)
            ]
            yield made(Shift, target=target, shift=shift, after=after, by=by)

    def slopes(self, names: Sequence[str]) -> tuple[Array, Array]:
        names = [name for name in names if name in self.response.slices]
        simulation = self.response.simulation
        cost = max(simulation.system.cost(self.response.measures), 1) * 60.0 / simulation.method.contacts_per_minute
        columns = sum(self.response.slices[name].stop - self.response.slices[name].start for name in names)
        rows = min(max(int(SECONDS / cost / max(2 * columns, 1)), 1), MOST_ROWS)
        slopes, steadiness = few_slopes(self.response, names, *drawn_builds(self.response, rows))
        return slopes[0], steadiness[0]

    def halved(self, now: Array, spread: Spread) -> list[Halved]:
        good = now[~np.isnan(now)]
        mean = float(good.mean()) if len(good) else 0.0
        found = []
        units = {own.name: own.unit for own in self.response.contributors}
        shares = {name: share for name, share in self.shares.items() if units.get(name) != SHARE_OF_PLAY}
        for name, share in [*shares.items()][:TOLD]:
            after = self.spread(mean + (now - mean) * float(np.sqrt(1.0 - 0.75 * share)))
            found.append(made(Halved, contributor=name, share_percent=100 * share, after=after))
        return helpful(found, spread)
