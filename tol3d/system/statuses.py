"""Statuses of a trial, in the words of its system."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from tol3d.errors import InputError
from tol3d.system.outcome import SEATED

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
