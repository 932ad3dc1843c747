"""Arguments that a page may give a job: none of them names a file or allows a program."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import isfinite
from typing import Any, Final

from tol3d.errors import InputError

Value = str | int | float | bool | list[str] | dict[str, str | int | float]
Words = Mapping[str, Value]
"""Arguments by name."""

OPTION: Final = re.compile(r"^--([a-z-]+)(?: '.*?'| \(.*?\))?: ")
"""Front of a refusal on a command line, whose options a page does not have; it has fields of these names."""


@dataclass(frozen=True)
class Word:
    """A kind of argument.

    Args:
        expected: values that it takes, in words.
        fits: tells them from others.
        read: value of a text; the text itself where it is none, which is then refused.
        choices: all values, where they are few.
    """

    expected: str
    fits: Callable[[Any], bool]
    read: Callable[[Any], Any] = lambda text: text
    choices: tuple[str, ...] = ()


@dataclass(frozen=True)
class Argument:
    """An argument of a job, as a page asks for it.

    Args:
        word: kind of its values.
        label: in plain words.
        default: meaning of none, in words; for one of few choices, the choice.
    """

    word: Word
    label: str = ""
    default: str = ""


class UnfitError(InputError):
    """An argument that a job does not take.

    Args:
        text: the whole message.
        argument: its name.
        sentence: the message without kind and name.
    """

    def __init__(self, text: str, argument: str, sentence: str) -> None:
        super().__init__(text)
        self.argument, self.sentence = argument, sentence


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)


def _is_value(value: object) -> bool:
    return isinstance(value, str) or _is_number(value)


def _number(text: Any) -> Any:
    """A number of a text, whole where it is: 20000, 2e4 or 0.5."""
    try:
        found = float(text)
    except (TypeError, ValueError):
        return text
    return int(found) if found.is_integer() else found


def _whole(least: int) -> Word:
    return Word(f"a whole number from {least} on", lambda value: type(value) is int and value >= least, _number)


def _one_of(*choices: str) -> Word:
    words = f"{', '.join(choices[:-1])} or {choices[-1]}"
    return Word(words, lambda value: isinstance(value, str) and value in choices, choices=choices)


SEED: Final = _whole(0)
DRAWS: Final = _whole(100)
PPM: Final = Word(
    "builds of a million, from 0 to below 1000000", lambda value: _is_number(value) and 0 <= value < 1e6, _number
)
PPK: Final = Word("a number above 0, such as 1.33", lambda value: _is_number(value) and value > 0, _number)
TEXT: Final = Word("a text", lambda value: isinstance(value, str))
YES_NO: Final = Word("true or false", lambda value: isinstance(value, bool))
TEXTS: Final = Word(
    "a list of texts", lambda value: isinstance(value, list) and all(isinstance(own, str) for own in value)
)
VARIED: Final = replace(TEXTS, expected="a list of texts FIELD=VALUES")
VALUES: Final = Word(
    "texts or numbers by name",
    lambda value: isinstance(value, dict) and all(isinstance(name, str) and _is_value(value[name]) for name in value),
)

WORDS: Final[Mapping[str, Mapping[str, Argument]]] = {
    "run": {"trials": Argument(_whole(1), "trials", "the study's")},
    "report": {},
    "what_if": {
        "set": Argument(VALUES, "new value"),
        "factor": Argument(VALUES, "factor"),
        "limits": Argument(VALUES, "other limits"),
        "measure": Argument(TEXT, "measure", "all that depend on what changes"),
        "trials": Argument(_whole(2), "trials", "the study's"),
        "draws": Argument(DRAWS, "draws for each limit", "4800"),
        "quick": Argument(YES_NO, "rates and first order alone, without a simulation"),
        "seed": Argument(SEED, "seed", "1"),
    },
    "effects": {
        "measure": Argument(TEXT, "measure", "all that are one number a trial"),
        "base": Argument(_whole(2), "pairs of builds, a power of two", "as time allows"),
        "seed": Argument(SEED, "seed", "1"),
        "position": Argument(_one_of("averaged", "as-input"), "positions", "averaged"),
        "shapley": Argument(YES_NO, "Shapley effects too, also where nothing is correlated"),
    },
    "changes": {
        "measure": Argument(TEXT, "measure", "all that are NOT OK"),
        "accept": Argument(PPM, "accepted builds out of limits [ppm]", "as the study asks"),
        "accept_ppk": Argument(PPK, "or a Ppk that is asked", "as the study asks"),
        "builds": Argument(_whole(50), "builds by which each change is judged", "5000, fewer if slow"),
    },
    "allocate": {
        "ppm": Argument(PPM, "accepted builds out of limits [ppm]", "by Ppk"),
        "ppk": Argument(PPK, "or a Ppk that is asked at each limit", "1.33"),
        "measure": Argument(TEXTS, "measures", "all that have limits"),
        "bounds": Argument(TEXT, "bounds of all factors", "0.5..3"),
        "bound": Argument(VALUES, "bounds of its factor"),
        "freeze": Argument(TEXTS, "stays as it is"),
        "stays": Argument(VALUES, "limit that stays"),
        "beyond_least": Argument(YES_NO, "draw below what is physical, such as clearances below 0"),
        "draws": Argument(DRAWS, "draws for each limit", "12000"),
        "seed": Argument(SEED, "seed", "1"),
    },
    "rare": {
        "measure": Argument(TEXT, "measure", "all that have limits"),
        "method": Argument(_one_of("auto", "importance", "subset", "form", "sorm"), "method", "auto"),
        "draws": Argument(DRAWS, "draws for each limit", "4800, or 14000 a level of subset"),
        "seed": Argument(SEED, "seed", "1"),
    },
    "methods": {
        "measure": Argument(TEXT, "measure", "all"),
        "trials": Argument(_whole(2), "trials", "the study's, 20000 at most"),
    },
    "sweep": {
        "vary": Argument(VARIED, "field and its values"),
        "latin_hypercube": Argument(_whole(2), "variants drawn from ranges", "all values of a grid"),
        "hypercube_seed": Argument(SEED, "seed of that drawing", "1"),
        "trials": Argument(_whole(1), "trials of each variant", "the study's"),
        "seed": Argument(SEED, "seed", "the study's"),
        "engine": Argument(TEXT, "engine", "the study's"),
    },
}
"""By the kind of job, as in `tol3d.analyses.answers`, whose defaults hold where nothing is given."""

EITHER: Final = {"changes": ("accept", "accept_ppk"), "allocate": ("ppm", "ppk")}
"""Arguments of which one alone may be given."""


def refuse_unfit(kind: str, words: Mapping[str, object]) -> None:
    """Raise unless all arguments are of the kind of job.

    Raises:
        InputError: no such kind.
        UnfitError: no such argument, another type, or two of which one alone is taken.
    """
    known = WORDS.get(kind)
    if known is None:
        raise InputError(f"expected one of {', '.join(WORDS)}, got {kind!r}")
    for name, value in words.items():
        if name not in known:
            raise UnfitError(f"{kind}: expected {', '.join(known)}, got {name!r}", name, "")
        if not known[name].word.fits(value):
            sentence = f"expected {known[name].word.expected}, got {value!r}"
            raise UnfitError(f"{kind}: {name}: {sentence}", name, sentence)
    both = EITHER.get(kind, ())
    if both and all(name in words for name in both):
        sentence = f"expected {' or '.join(both)}, got both"
        raise UnfitError(f"{kind}: {sentence}", both[1], "leave out one of the two")


def words_of(kind: str, fields: Mapping[str, object]) -> dict[str, Any]:
    """Arguments from the fields of a page, whose texts may be numbers; empty ones are left out.

    A new value that begins with x is a factor: "x1.5".

    Raises:
        InputError: as `refuse_unfit`.
        UnfitError: a what-if without any change too.
    """
    known, found = WORDS.get(kind, {}), dict[str, Any]()
    for name, value in fields.items():
        if isinstance(value, Mapping):
            value = {of: own.strip() if isinstance(own, str) else own for of, own in value.items() if own != ""}
        if value is False or value in ("", {}, []):
            continue
        found[name] = known[name].word.read(value) if name in known and isinstance(value, str) else value
    values = found.pop("set", None) if kind == "what_if" else None
    if isinstance(values, dict):
        factors = {name: _number(own[1:]) for name, own in values.items() if str(own).startswith("x")}
        sizes = {name: own for name, own in values.items() if name not in factors}
        found |= {key: own for key, own in (("set", sizes), ("factor", factors)) if own}
    if kind == "sweep":
        found.setdefault("vary", [])
    refuse_unfit(kind, found)
    if kind == "what_if" and not found.keys() & {"set", "factor", "limits"}:
        sentence = "expected a new value of a tolerance or other limits of a measure, got none"
        raise UnfitError(f"{kind}: {sentence}", "", sentence)
    return found
