"""Stopping of an automatic study: every requested standard error is reached, or the message says which is not."""

import math
from collections.abc import Callable, Iterator

from tol3d.statistics.estimates import Moments
from tol3d.study.tallies.tally import Tally
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Until

Enough = Callable[[Tally], bool]


def enough(simulation: Simulation) -> Enough:
    """Called after each merged block, in block order: whether the study may stop.

    A study without `until` never may; it goes through its trials. What is measured are the trials so far on the
    geometric method, or on the analytic one where there is no engine.
    """
    return lambda tally: bool(simulation.study.until) and not any(_short(simulation, tally))


def shortfalls(simulation: Simulation, tally: Tally) -> Iterator[str]:
    """A sentence for each standard error that an automatic study asked for and did not reach."""
    for name, word, wanted, reached, unit in _short(simulation, tally):
        known = f"to ±{reached:.3g} {unit}" if math.isfinite(reached) else "not at all"
        yield f"{name}: {word} known {known} after {tally.trials} trials, not to the ±{wanted:.3g} {unit} of until"


def _short(simulation: Simulation, tally: Tally) -> Iterator[tuple[str, str, float, float, str]]:
    """Measure, statistic, standard error wanted and reached, unit, if it is not reached (or unknown)."""
    measures = {measure.name: measure for measure in simulation.system.measures}
    for until in simulation.study.until:
        measure, moments = measures[until.measure], _moments(tally, until)
        for word, wanted, reached in (
            ("mean", until.mean, moments.mean_se),
            ("sigma", until.sigma, _sigma_se(moments)),
        ):
            if wanted is not None and not reached <= wanted * measure.per_internal:
                yield measure.name, word, wanted * measure.per_internal, reached, measure.unit


def _moments(tally: Tally, until: Until) -> Moments:
    own = tally.measures[until.measure]
    return (own.analytic if own.geometric is None else own.geometric).moments


def _sigma_se(moments: Moments) -> float:
    """Standard error of sigma; 0 where nothing varies, for more trials would not change that."""
    return 0.0 if moments.count > 1 and moments.m2 == 0.0 else moments.sigma_se
