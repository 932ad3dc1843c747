"""A method from deviations to values: its answers, and its properties known before it is made."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.study.system.measure import Measure
from tol3d.study.system.trials import Trials

Codes = NDArray[np.int8]

ANALYTIC_METHOD: Final = "analytic"
"""The method that every system has: its theory. A study that names it as its engine has no 3D simulation."""


@dataclass(frozen=True)
class Answers:
    """Answers of a method for some trials.

    Args:
        values: by measure, (trials, positions) [mm or rad].
        terms: by measure and term of its sum, (trials,) [mm or rad], see System.breakdowns.
        details: further columns by their names, (trials,), such as points of contact.
        status: by measure, codes (trials,) of the system's statuses; empty where every trial seats.
    """

    values: Mapping[str, Array]
    terms: Mapping[tuple[str, str], Array] = field(default_factory=dict)
    details: Mapping[str, NDArray[np.generic]] = field(default_factory=dict)
    status: Mapping[str, Codes] = field(default_factory=dict)


def joined_answers(pieces: Sequence[Answers]) -> Answers:
    """Answers of several pieces of trials as one, in their order."""
    if len(pieces) == 1:
        return pieces[0]
    first = pieces[0]
    return Answers(
        {name: np.concatenate([piece.values[name] for piece in pieces]) for name in first.values},
        {key: np.concatenate([piece.terms[key] for piece in pieces]) for key in first.terms},
        {name: np.concatenate([piece.details[name] for piece in pieces]) for name in first.details},
        {name: np.concatenate([piece.status[name] for piece in pieces]) for name in first.status},
    )


class Method(Protocol):
    """Goes from deviations to values. Made in the worker, as its contents need not pickle."""

    @property
    def chord_error(self) -> float:
        """Largest distance [mm] between its surfaces and the mathematical ones; 0 if it has no facets."""
        ...

    def answers(self, trials: Trials, measures: Sequence[Measure]) -> Answers:
        """Values of some measures in some trials; a trial's do not depend on the others."""
        ...


class WitnessMethod(Method, Protocol):
    """A method that checks another one, and knows its own errors."""

    def reads(self, measure: Measure) -> bool:
        """True if it can read a measure; those that it cannot are left out of its findings."""
        ...

    def bounds(self, measure: Measure) -> tuple[float, float]:
        """Largest error of a measure, in its unit: by its facets, and by all else."""
        ...


@dataclass(frozen=True)
class MethodKind:
    """Properties of a method that are known before it is made.

    Args:
        setup: activity while it is prepared, for a progress line.
        threads: True if workers are threads that take whole blocks; else processes that take pieces of blocks.
        compiled: True if it loads the compiler of kernels anyway, so that draws and sums may use it too.
        witness: True if it can check another method.
        contacts_per_minute: of one core, draws and statistics included; only for the estimate before a long study.
        block_contacts: the most that a block of trials takes; None if even large blocks are quick.
    """

    setup: str
    threads: bool = True
    compiled: bool = False
    witness: bool = False
    contacts_per_minute: int = 40_000_000
    block_contacts: int | None = None
