"""Worst cases of a scene's measures before any trial, as far as the builds that they take are soon made.

What a build costs is known beforehand by its contacts, so that the same is looked for on any machine: of large models,
and of measures that are read over long turns, the ends by slopes are all there is.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Final

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.study.effects.acting_contributors import acting
from tol3d.study.effects.regions import Built, Codes, Standing, space_of
from tol3d.study.effects.worst_case import WorstCase, builds_a_row, first_starts, worst_case
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import ANALYTIC_METHOD, Method
from tol3d.study.system.outcome import ANALYTIC, OK
from tol3d.study.system.stated import stated
from tol3d.study.system.trials import Trials
from tol3d.study.trials.budget import PLACING
from tol3d.study.trials.evaluation import Evaluation, evaluations
from tol3d.study.trials.simulation import Simulation

CONTACTS: Final = 1_500_000
"""Largest number of contacts of all worst cases of a scene together, before any trial: some seconds."""
USUAL_SPEED: Final = 40_000_000
"""Contacts a minute of the methods for which CONTACTS is stated."""
RANDOM: Final = 1
"""Builds at random ends, from which it is looked for beside the mean build and the ends by slopes."""
ROWS: Final = 2 * (1 + RANDOM) + 4


def worst_cases(
    simulation: Simulation, method: Method | None, measures: Sequence[Measure]
) -> Mapping[str, Mapping[str, WorstCase | None]]:
    """Worst cases of measures at rest, by name and method: "analytic", and "geometric" if there is an engine.

    Args:
        simulation: to be studied.
        method: of its engine; None without one.
        measures: of its system, no curves.

    Returns:
        None if it would take too long.
    """
    every, left = evaluations(simulation.system, method), float(CONTACTS)
    words = {shown: ANALYTIC_METHOD if shown == ANALYTIC else simulation.study.engine for shown in every}
    found: dict[str, dict[str, WorstCase | None]] = {own.name: {} for own in measures}
    for measure in measures:
        for shown, evaluation in every.items():
            one = price(simulation, words[shown], measure)
            worst = _worst_case(simulation, evaluation, measure, left / one)
            left -= one * (worst.evaluations if worst else 0)
            found[measure.name][shown] = worst
    return found


def price(simulation: Simulation, method: str, measure: Measure) -> float:
    """Contacts that take as long as one build of a measure, by a method of the scene's word."""
    system = simulation.system
    contacts = system.cost((measure,)) * measure.positions.in_a_trial
    return (PLACING + contacts) * max(1.0, USUAL_SPEED / system.methods[method].contacts_per_minute)


def built_by(evaluation: Evaluation, measure: Measure, counted: Callable[[int], None] = lambda builds: None) -> Built:
    """A measure of builds, not a number where one cannot be assembled, unless it keeps how deep parts overlap."""

    def built(deviations: Array, positions: Standing) -> tuple[Array, Codes]:
        found, codes = [], []
        for asked in evaluation.asked(Trials(deviations, positions), (measure,)):
            status = asked.answers.status.get(measure.name) if evaluation.method is not None else None
            found.append(asked.values[measure.name])
            codes.append(np.zeros(len(asked.trials), dtype=np.int8) if status is None else status)
        values, judged = np.concatenate(found), np.concatenate(codes)
        counted(len(values))
        if not measure.keeps_overlap:
            values = np.where(judged == OK, values, np.nan)
        return values, judged

    return built


def _worst_case(simulation: Simulation, evaluation: Evaluation, measure: Measure, builds: float) -> WorstCase | None:
    system = simulation.system
    space = space_of(
        system,
        measure,
        {contributor.name: contributor.draw for contributor in system.contributors},
        acting(simulation, measure),
    )
    if not len(space.acting) or ROWS * builds_a_row(space) > builds:
        return None
    built = built_by(evaluation, measure)
    at_rest = stated(system, space.mean[None]).positions
    return worst_case(space, built, first_starts(space, built, at_rest, RANDOM), most=int(builds))
