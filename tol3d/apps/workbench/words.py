"""Arguments that a page may give a job: none of them names a file or allows a program."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import isfinite
from typing import Any, Final

from tol3d.errors import InputError


@dataclass(frozen=True)
class Word:
    """A kind of argument.

    Args:
        expected: values that it takes, in words.
        fits: tells them from others.
    """

    expected: str
    fits: Callable[[Any], bool]


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)


def _is_value(value: object) -> bool:
    return isinstance(value, str) or _is_number(value)


WHOLE: Final = Word("a whole number from 0 on", lambda value: type(value) is int and value >= 0)
COUNT: Final = Word("a whole number from 1 on", lambda value: type(value) is int and value >= 1)
NUMBER: Final = Word("a number", _is_number)
TEXT: Final = Word("a text", lambda value: isinstance(value, str))
YES_NO: Final = Word("true or false", lambda value: isinstance(value, bool))
TEXTS: Final = Word(
    "a list of texts", lambda value: isinstance(value, list) and all(isinstance(own, str) for own in value)
)
VALUES: Final = Word(
    "texts or numbers by name",
    lambda value: isinstance(value, dict) and all(isinstance(name, str) and _is_value(value[name]) for name in value),
)

WORDS: Final[Mapping[str, Mapping[str, Word]]] = {
    "run": {"trials": COUNT},
    "report": {},
    "what_if": {
        "set": VALUES,
        "factor": VALUES,
        "limits": VALUES,
        "measure": TEXT,
        "trials": WHOLE,
        "draws": WHOLE,
        "quick": YES_NO,
        "seed": WHOLE,
    },
    "effects": {"measure": TEXT, "base": WHOLE, "seed": WHOLE, "position": TEXT, "shapley": YES_NO},
    "changes": {"measure": TEXT, "accept": NUMBER, "accept_ppk": NUMBER, "builds": WHOLE},
    "allocate": {
        "ppm": NUMBER,
        "ppk": NUMBER,
        "measure": TEXTS,
        "bounds": TEXT,
        "bound": VALUES,
        "freeze": TEXTS,
        "stays": VALUES,
        "beyond_least": YES_NO,
        "draws": WHOLE,
        "seed": WHOLE,
    },
    "rare": {"measure": TEXT, "method": TEXT, "draws": WHOLE, "seed": WHOLE},
}
"""By the kind of job, as in `tol3d.analyses.answers`."""


def refuse_unfit(kind: str, words: Mapping[str, object]) -> None:
    """Raise unless all arguments are of the kind of job.

    Raises:
        InputError: no such kind or argument, or another type.
    """
    known = WORDS.get(kind)
    if known is None:
        raise InputError(f"expected one of {', '.join(WORDS)}, got {kind!r}")
    for name, value in words.items():
        if name not in known:
            raise InputError(f"{kind}: expected {', '.join(known)}, got {name!r}")
        if not known[name].fits(value):
            raise InputError(f"{kind}: {name}: expected {known[name].expected}, got {value!r}")
