"""Outcome of each trial of a measure: which ones seated, which ones lack what is measured and by how much; statuses.

Statistics of values are of the assembled trials. What is out of limits is counted of all of them, and a build that
lacks what is measured (its parts overlap) is below every lower limit.
"""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import InputError
from tol3d.numerics.arrays import Array

Mask = NDArray[np.bool_]
Columns = Mapping[str, NDArray[Any]]

SEATED: Final = "ok"
ANALYTIC: Final = "analytic"
GEOMETRIC: Final = "geometric"
METHODS: Final = (ANALYTIC, GEOMETRIC)
"""Names of the methods in columns and in summary.json: the stack-up, and the 3D simulation by any engine."""


def value_column(method: str, measure: str) -> str:
    """Name of the column with a method's values of a measure."""
    return f"{method}:{measure}"


def status_column(measure: str) -> str:
    """Name of the column with the status of each trial of a measure."""
    return f"status:{measure}"


def reason_column(measure: str) -> str:
    """Name of the column with the cause of a measure's failed trials, in words of its system.

    One of the details of a method, "" where nothing decided it; not every measure has it.
    """
    return f"reason:{measure}"


@dataclass(frozen=True, eq=False)
class Outcome:
    """A method's values of a measure in some trials.

    Args:
        values: (trials,), or (trials, positions) of a curve, in the measure's unit; nan for trials that failed.
        lacking: (trials,), those whose parts overlap; None where every trial seated.
        deepest: the largest overlap of those that is known, as a value below 0; inf if none is.
    """

    values: Array
    lacking: Mask | None = None
    deepest: float = math.inf


def outcome_of(columns: Columns, method: str, measure: str, lacking: Collection[str]) -> Outcome:
    """A method's column of a measure; the analytic method seats every trial.

    Args:
        columns: trial on axis 0.
        method, measure: whose column.
        lacking: the statuses of trials with less than nothing of the measured quantity.
    """
    column = np.asarray(columns[value_column(method, measure)], dtype=np.float64)
    status = columns.get(status_column(measure))
    if method != GEOMETRIC or status is None:
        return Outcome(column)
    seated = status == SEATED
    if seated.all():
        return Outcome(column)
    lacks = np.zeros(len(status), dtype=bool)
    for text in lacking:
        lacks |= status == text
    values = column.copy()
    values[~seated] = np.nan
    return Outcome(values, lacks, float(np.nanmin(column[lacks], initial=math.inf)))


OK: Final = 0
"""The code of a trial that was assembled and measured, in every system."""

Meaning = Literal["seated", "lacking", "unknown"]
"""Meaning of a status: values count; the trial has less than nothing of what is measured, below every lower limit; or
nothing is known of it but that it failed."""


@dataclass(frozen=True)
class Statuses:
    """The statuses of a system by their codes, from OK on; a larger code is worse, for less is known of the build.

    Args:
        texts: as columns and summary.json show them; the first is that of OK, "ok".
        lacking: those of builds with less than nothing of the measured quantity, such as overlaps.
        words: predicate of such builds, for a sentence: "do not fit".
        states: adjective of such builds, for a row or a count: "too long"; the text itself by default.

    Raises:
        InputError: another first text, or one that is not among them.
    """

    texts: tuple[str, ...]
    lacking: frozenset[str] = frozenset()
    words: Mapping[str, str] = field(default_factory=dict)
    states: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.texts[:1] != (SEATED,):
            raise InputError(f"statuses: expected {SEATED!r} first, which files of runs have for it, got {self.texts}")
        if unknown := sorted((self.lacking | self.words.keys() | self.states.keys()) - set(self.texts)):
            raise InputError(f"statuses: expected some of {', '.join(self.texts)}, got {', '.join(unknown)}")

    @cached_property
    def by_code(self) -> NDArray[np.str_]:
        """The texts as an array, indexed by codes."""
        return np.array(self.texts)

    @property
    def seated(self) -> str:
        """The text of OK."""
        return self.texts[OK]

    @property
    def failed(self) -> tuple[str, ...]:
        """The texts of the others."""
        return self.texts[1:]

    @property
    def meanings(self) -> dict[str, Meaning]:
        """Meaning of each status for statistics."""
        return {text: self._meaning(text) for text in self.texts}

    def _meaning(self, text: str) -> Meaning:
        return "seated" if text == self.seated else "lacking" if text in self.lacking else "unknown"
