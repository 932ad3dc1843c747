"""One evaluation of stated deviations: measures of a system by one method, all rows at once.

Columns of trials, replays, witnesses, ends, slopes, shares and explanations ask this and nothing else, in batches: each
call places every part again, and most of what it takes does not grow with the rows.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.study.system.faults import UnfitError
from tol3d.study.system.measure import Measure
from tol3d.study.system.method import ANALYTIC_METHOD, Answers, Method
from tol3d.study.system.outcome import ANALYTIC, GEOMETRIC, OK
from tol3d.study.system.positions import Positions
from tol3d.study.system.stated import stated
from tol3d.study.system.system import System
from tol3d.study.system.taken import taken, trials_at_once
from tol3d.study.system.trials import Trials

T = TypeVar("T")
BATCH: Final = 2**22
"""Numbers that are built at once: rows times components, 32 MB."""

Values = Callable[[Array, Sequence[Measure]], Mapping[str, Array]]
"""Measures (rows,) by name of deviations (rows, components), in their units; nan where a build cannot be assembled."""


@dataclass(frozen=True, eq=False)
class Asked:
    """Answers of a method for some trials.

    Args:
        trials: the trials.
        answers: those of the method.
        values: values taken by measures: by name (trials,), or (trials, positions) of a curve, in their units.
    """

    trials: Trials
    answers: Answers
    values: Mapping[str, Array]


@dataclass(frozen=True)
class Evaluation:
    """A system by one method.

    Args:
        system: the system to build.
        method: of the 3D simulation; None for the analytic one.
    """

    system: System
    method: Method | None = None

    @property
    def name(self) -> str:
        """The method's name in columns."""
        return GEOMETRIC if self.method else ANALYTIC

    def values(self, deviations: Array, measures: Sequence[Measure]) -> dict[str, Array]:
        """Values of measures of builds (rows, components) [mm, rad, K] at rest; see `of`."""
        return self.of(stated(self.system, deviations), measures)

    def of(
        self, trials: Trials, measures: Sequence[Measure], overlaps: Callable[[Measure], bool] = lambda own: False
    ) -> dict[str, Array]:
        """Values of measures of trials; one's do not depend on the others.

        Args:
            trials: stated or drawn.
            measures: of the system.
            overlaps: keep a method's answers for builds that cannot be assembled, such as the depth of their overlap.

        Returns:
            By name (trials,), or (trials, positions) of a curve, in the measure's unit; nan where a build cannot
            be assembled.
        """
        pieces = []
        judged = {measure.name for measure in measures if self.method and not overlaps(measure)}
        for asked in self.asked(trials, measures):
            found = dict(asked.values)
            for name, codes in asked.answers.status.items():
                if name in judged and codes.any():
                    found[name] = found[name].copy()
                    found[name][codes != OK] = np.nan
            pieces.append(found)
        if len(pieces) == 1:
            return pieces[0]
        return {measure.name: np.concatenate([piece[measure.name] for piece in pieces]) for measure in measures}

    def asked(self, trials: Trials, measures: Sequence[Measure]) -> Iterator[Asked]:
        """All answers of the method for trials, as many at once as their positions let it."""
        method = self.method or self.system.method(ANALYTIC_METHOD, None)
        rows = trials_at_once(measures)
        for first in range(0, len(trials), rows):
            piece = trials.part(first, first + rows)
            answers = method.answers(piece, measures)
            values = {
                measure.name: taken(measure, _read(self.name, answers, measure, len(piece))) * measure.per_internal
                for measure in measures
            }
            yield Asked(piece, answers, values)


def _read(method: str, answers: Answers, measure: Measure, count: int) -> NDArray[np.float64]:
    """Values (trials, positions) of a measure, if the method has answered as many."""
    values, expected = answers.values.get(measure.name), (count, measure.positions.in_a_trial)
    if values is None or np.shape(values) != expected:
        got = "none" if values is None else f"an array of shape {np.shape(values)}"
        raise UnfitError(
            f"{method} method, measure {measure.name!r}: expected values (trials, positions) of shape {expected}, "
            f"got {got}"
        )
    return values


def evaluations(system: System, method: Method | None) -> Mapping[str, Evaluation]:
    """Evaluation by each method: "analytic", and "geometric" if there is an engine."""
    own = {ANALYTIC: Evaluation(system)}
    return own | {GEOMETRIC: Evaluation(system, method)} if method else own


def measures_alike(system: System, measures: Sequence[Measure]) -> list[tuple[Mapping[str, bool], list[Measure]]]:
    """Measures by the directions that turn at random at their positions: those that share a mean build."""
    names = [contributor.name for contributor in system.contributors]
    turning: dict[Positions, tuple[bool, ...]] = {}
    alike: dict[tuple[bool, ...], list[Measure]] = {}
    for measure in measures:
        if (positions := measure.positions) not in turning:
            turning[positions] = tuple(
                system.turns_at_random(contributor, positions) for contributor in system.contributors
            )
        alike.setdefault(turning[positions], []).append(measure)
    return [(dict(zip(names, turns, strict=True)), group) for turns, group in alike.items()]


def of_alike(
    system: System,
    measures: Sequence[Measure],
    find: Callable[[Sequence[Measure], Mapping[str, bool]], Mapping[str, T]],
) -> dict[str, T]:
    """Findings by measure; `find` is asked of those that share a mean build together, and told what turns."""
    found: dict[str, T] = {}
    for turning, alike in measures_alike(system, measures):
        found |= find(alike, turning)
    return found


def batches(contributors: Sequence[T], rows: Sequence[int], width: int) -> Iterator[Sequence[T]]:
    """Contributors whose builds are made together, by the number of rows that each takes for its components."""
    batch: list[T] = []
    size = 0
    for own, count in zip(contributors, rows, strict=True):
        if batch and (size + count) * width > BATCH:
            yield batch
            batch, size = [], 0
        batch.append(own)
        size += count
    if batch:
        yield batch
