"""Builds that may be made after the trials of a run: less than the trials themselves, a stated share for each use.

What builds take is counted in contacts and never timed, so that the same is looked at on any machine, with any number
of workers. A use that wants less than its share leaves the rest to the others.

Builds that may be made whatever the others want have shares of their own: those that tell what acts
(`acting_contributors.SHARE`), total effects (`attribution.MOST_OF_RUN`), and high–low–mean by the method that does not
lead (OTHER_METHOD).
"""

from collections.abc import Mapping, Sequence
from typing import Final, Literal

from tol3d.study.system.measure import Measure
from tol3d.study.system.system import Methods
from tol3d.study.trials.simulation import Simulation

Use = Literal["high-low-mean", "second look", "second differences"]

SHARES: Final[Mapping[Use, float]] = {"high-low-mean": 0.3, "second look": 0.35, "second differences": 0.1}
"""Share of the contacts of the trials that each use may take if all want more."""
OTHER_METHOD: Final = 0.1
"""The same of high–low–mean of measures that the regression of the method that does not lead does not explain."""
FREE: Final = 150_000
"""Contacts that may be made after however few trials: some tenths of a second."""
PLACING: Final = 20
"""Contacts that take as long as placing the parts of a build."""
ALONE: Final = 1 / 6
"""Time of a build in which one contributor alone leaves its mean, as a part of that of a trial: what a machine has that
it does not act on is not solved again (robot_arm: 0.1 to 0.2), and such builds have no regressors."""


def price(system: Methods, measures: Sequence[Measure]) -> int:
    """Contacts that take as long as one build by one method of which measures are read."""
    return PLACING + system.cost(measures)


def contacts_of_trials(simulation: Simulation, trials: int) -> float:
    """Contacts of trials of all measures, by one or both methods."""
    methods = 2 if simulation.has_geometry else 1
    return methods * trials * price(simulation.system, simulation.system.measures)


def of_other_method(simulation: Simulation, trials: int) -> float:
    """Contacts for high–low–mean by the method that does not lead."""
    return max(OTHER_METHOD * contacts_of_trials(simulation, trials), FREE)


def shared(contacts: float, wanted: Mapping[Use, float]) -> Mapping[Use, float]:
    """Contacts for each use, of those of the trials: what it wants, up to its share of what the others leave.

    Args:
        contacts: of the trials.
        wanted: by use.
    """
    left = max(sum(SHARES.values()) * contacts, FREE)
    found, waiting = dict[Use, float](), dict(wanted)
    while waiting:
        each = left / sum(SHARES[use] for use in waiting)
        content = {use: own for use, own in waiting.items() if own <= each * SHARES[use]}
        if not content:
            return found | {use: each * SHARES[use] for use in waiting}
        found |= content
        left -= sum(content.values())
        waiting = {use: own for use, own in waiting.items() if use not in content}
    return found
