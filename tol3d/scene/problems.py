"""Errors that pydantic finds, in the user's words and with their place."""

import difflib
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, Protocol

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from tol3d.errors import Problem
from tol3d.scene.bases import ToleranceSpec
from tol3d.scene.entry import Entry
from tol3d.scene.nearest import LISTED_WORDS, LONGEST_WORD, hint, nearest
from tol3d.scene.place import KeyPath, Origin, key_text
from tol3d.statistics.distributions import drawn
from tol3d.units import COMMA_SEPARATES, EXAMPLES, FACTORS, NUMBER_UNIT, Dimension, expectation, shown

MOST_PROBLEMS = 8  # what a screen shows and a person mends in one go
QUOTED_WORD = re.compile(r"'((?:[^'\\]|\\.)*)'")
SUCH_AS: Final[Mapping[object, str]] = {
    "distribution": ", such as {kind: normal, lower: -10 um, upper: 10 um}",
    "law": ", such as {kind: uniform}",
}
OF_SIZE: Final[Mapping[object, str]] = {
    "distribution": 'limits, such as "±%s" by the default_law of the scene, or {kind: normal, lower: -%s, upper: %s}',
    "zone": "{width: %s}, or {diameter: %s} of a round zone",
}
"""Spelling of a key's value where a plain length was written."""
PLUS_MINUS: Final = re.compile(r"\s*(?:±|\+-|\+/-)")
KIND_OF: Final[Mapping[object, str]] = {
    "parts": "kind of part",
    "tolerances": "kind of tolerance",
    "moves": "kind of move",
    "measures": "kind of measure",
    "features": "kind of feature",
    "relations": "kind of relation",
    "joints": "kind of joint",
    "distribution": "kind of distribution",
    "law": "kind of law",
}
"""Common name of the kinds under a key."""
SOME_WORDS: Final = 3  # that are named where none is near
SOMEWHAT_LIKE: Final = 0.55  # ratio of difflib from which a word is worth naming


class Words(Protocol):
    """Words of a grammar, and what stands for those that it has not."""

    def kinds(self, section: str) -> Mapping[str, type[Entry]]:
        """The kinds of a section by their words."""
        ...

    def instead_of_kind(self, word: object) -> str:
        """Replacement for a kind that is not known; "" where no vocabulary gives one."""
        ...

    def instead_of_key(self, word: object) -> str:
        """The same of a key or a choice."""
        ...


def messages(error: ValidationError, data: Any, origin: Origin, grammar: Words) -> list[Problem]:
    """One message for each problem, in the order of the file, at most MOST_PROBLEMS of them.

    Args:
        error: pydantic's findings.
        data: the plain values that it was given.
        origin: their place.
        grammar: the kinds that they may be of.
    """
    found: dict[Problem, tuple[str, int]] = {}
    for details in error.errors(include_url=False):
        path = _path(details["loc"], data)
        sentence = problem_sentence(details, _dimensions(path, data, grammar))
        context = details.get("ctx", {})
        if details["type"] == "unknown_key":
            path = (*path, context["key"])
        elif details["type"] == "union_tag_invalid":
            path = (*path, "kind")
        sentence = _other_word(details, grammar) or sentence
        if context.get("field"):
            path = (*path, *str(context["field"]).split("."))
        found.setdefault(origin.message(path, sentence), origin.order(path))
    ordered = sorted(found, key=lambda message: found[message])
    return first_few(ordered)


def first_few(problems: list[Problem]) -> list[Problem]:
    """The problems that are worth showing at once."""
    left = len(problems) - MOST_PROBLEMS
    return problems if left <= 0 else [*problems[:MOST_PROBLEMS], Problem(f"… and {left} more")]


def _path(loc: tuple[int | str, ...], data: Any) -> KeyPath:
    """Pydantic's location without the tags of unions, as far as the data go.

    A tag stands behind the keys of the mapping whose `kind` it is; other tags are no key at all.
    """
    path: list[str | int] = []
    step: Any
    tag_expected = True
    for step in loc:
        if isinstance(data, dict) and tag_expected and path and data.get("kind") == step:
            tag_expected = False
        elif (isinstance(data, dict) and step in data) or (
            isinstance(data, list) and isinstance(step, int) and step < len(data)
        ):
            path.append(step)
            data, tag_expected = data[step], True
    return tuple(path)


def _dimensions(path: KeyPath, data: Any, grammar: Words) -> tuple[Dimension, ...]:
    """Dimensions of the quantities of a distribution, by the kind of the tolerance that holds it."""
    if len(path) < 2 or path[0] != "tolerances":
        return ()
    tolerance = data["tolerances"][path[1]]
    kind = tolerance.get("kind") if isinstance(tolerance, dict) else None
    spec = grammar.kinds("tolerances").get(kind) if isinstance(kind, str) else None
    return spec.dimensions if spec is not None and issubclass(spec, ToleranceSpec) else ()


# sentences ----------------------------------------------------------------------------------------


def problem_sentence(details: ErrorDetails, dimensions: tuple[Dimension, ...] = ()) -> str:
    """Sentence on one of pydantic's findings: what was expected and what came.

    Args:
        details: the finding.
        dimensions: those of a quantity there.
    """
    if details["type"] == "quantity":
        return _quantity(details, dimensions)
    return SENTENCES.get(details["type"], _unexpected)(details)


def _got(expected: str) -> Callable[[ErrorDetails], str]:
    def sentence(details: ErrorDetails) -> str:
        return f"expected {expected}, got {shown(details['input'])}"

    return sentence


def _text_expected(details: ErrorDetails) -> str:
    value = details["input"]
    if isinstance(value, list) and details["loc"][-1] == "of":
        several = ", ".join(map(str, value[:SOME_WORDS])) + (", …" if len(value) > SOME_WORDS else "")
        return f"expected one name, got a list ({several}); write an entry for each, or name a pattern of them"
    advice = "; put it into quotes" if isinstance(value, bool | int | float) else ""
    return f"expected text, got {shown(value)}{advice}"


def _unknown_key(details: ErrorDetails) -> str:
    key = details["ctx"]["key"]
    if NUMBER_UNIT.fullmatch(key):
        return f'expected a key, got "{key_text(key)}"; {COMMA_SEPARATES}'
    known = details["ctx"]["known"]
    if PLUS_MINUS.match(key) and {"lower", "upper"} <= set(known):
        return f'unknown key "{key_text(key)}"; write both limits, such as lower: -15 um, upper: 15 um'
    return f'unknown key "{key_text(key)}"{hint(key, known)}'


def _missing(details: ErrorDetails) -> str:
    key = details["loc"][-1]
    return f'expected the key "{key}" here{SUCH_AS.get(key, "")}, found none'


def _missing_kind(details: ErrorDetails) -> str:
    keys, is_law = details["input"], details["loc"][-1] in ("distribution", "law")
    near = next(filter(None, (nearest(own, drawn.KEYS) for own in keys if isinstance(own, str))), "") if is_law else ""
    return f'expected the key "kind" here, found none{near}'


def _other_word(details: ErrorDetails, grammar: Words) -> str:
    """The sentence for a word that is written otherwise here, or not at all; "" for other findings."""
    match details["type"]:
        case "union_tag_invalid":
            word = _tag(details)
            instead = grammar.instead_of_kind(word)
        case "unknown_key":
            word = details["ctx"]["key"]
            instead = grammar.instead_of_key(word)
        case "literal_error":
            word = details["input"]
            instead = grammar.instead_of_key(word)
        case _:
            return ""
    return f"expected another word here, got {shown(word)}; {instead}" if instead else ""


def _tag(details: ErrorDetails) -> object:
    return details["input"].get("kind") if isinstance(details["input"], dict) else details["ctx"]["tag"]


def _unknown_kind(details: ErrorDetails) -> str:
    section = next((own for own in reversed(details["loc"]) if own in KIND_OF), None)
    what = KIND_OF[section] if section else "word"
    return word_expected(_tag(details), QUOTED_WORD.findall(details["ctx"]["expected_tags"]), what)


def _literal(details: ErrorDetails) -> str:
    return word_expected(details["input"], QUOTED_WORD.findall(details["ctx"]["expected"]))


def word_expected(value: object, known: Sequence[str], what: str = "word") -> str:
    """The sentence of a word that is none of those known, with the nearest of them; only a few are all listed.

    Args:
        value: the word that came.
        known: those that there are.
        what: their common name.
    """
    near = nearest(value, known) if isinstance(value, str) else ""
    if len(known) <= LISTED_WORDS:
        listed = " or ".join(known) if len(known) < 3 else f"one of {', '.join(known)}"
        return f"expected {listed}, got {shown(value)}{near}"
    like = difflib.get_close_matches(str(value)[:LONGEST_WORD].casefold(), known, n=SOME_WORDS, cutoff=SOMEWHAT_LIKE)
    some = f"; nearest are {', '.join(like)}" if like else ""
    return f"expected a {what}, got {shown(value)}{near or some + f'; tol3d schema lists all {len(known)}'}"


def _quantity(details: ErrorDetails, of_law: tuple[Dimension, ...]) -> str:
    context = details["ctx"]
    dimensions = context["expected"] or of_law
    expected = expectation(*dimensions) if dimensions else f'a number with its unit, such as "{EXAMPLES["length"]}"'
    advice = ""
    if "unknown unit" in context["reason"]:
        units = [unit for dimension in dimensions or FACTORS for unit in FACTORS[dimension]]
        advice = f"; units are {', '.join(units)}"
    return f"expected {expected}, {context['reason']}{advice}"


def _wrong_dimension(details: ErrorDetails) -> str:
    context = details["ctx"]
    return f"expected {expectation(*context['expected'])}, got {context['got']}, which is {context['came']}"


def _refused(details: ErrorDetails) -> str:
    return f"expected {details['ctx']['expected']}, got {details['ctx']['got']}"


def _bound(words: str, limit: str) -> Callable[[ErrorDetails], str]:
    def sentence(details: ErrorDetails) -> str:
        return f"expected a number of {words} {details['ctx'][limit]:g}, got {shown(details['input'])}"

    return sentence


def _too_few(details: ErrorDetails) -> str:
    least, count = details["ctx"]["min_length"], details["ctx"]["actual_length"]
    return (
        f"expected at least {'one entry' if least == 1 else f'{least} entries'}, got {count or shown(details['input'])}"
    )


def _unexpected(details: ErrorDetails) -> str:
    """Sentence for an error that no scene has caused yet: true, if plain."""
    return f"expected another value here, got {shown(details['input'])}"


def _keys(details: ErrorDetails) -> str:
    """The keys that a value should have had, if possible with the number that came instead."""
    came, key = details["input"], next((own for own in reversed(details["loc"]) if own in OF_SIZE), None)
    size = NUMBER_UNIT.fullmatch(came) if isinstance(came, str) else None
    if key is not None and size:
        number = f"{size[1].lstrip('+-')} {size[2]}"
        return f"expected {OF_SIZE[key].replace('%s', number)}, got {shown(came)}"
    if names := details.get("ctx", {}).get("keys"):
        return f"expected keys with values, such as {{{', '.join(f'{name}: …' for name in names)}}}, got {shown(came)}"
    example = next((SUCH_AS[own] for own in reversed(details["loc"]) if own in SUCH_AS), ', such as "name: {…}"')
    return f"expected keys with values{example}, got {shown(came)}"


_number = _got("a number")
_whole_number = _got("a whole number")

SENTENCES: Final[dict[str, Callable[[ErrorDetails], str]]] = {
    "unknown_key": _unknown_key,
    "wrong_dimension": _wrong_dimension,
    "value_refused": _refused,
    "missing": _missing,
    "literal_error": _literal,
    "union_tag_not_found": _missing_kind,
    "union_tag_invalid": _unknown_kind,
    "keys_expected": _keys,
    "model_type": _keys,
    "model_attributes_type": _keys,
    "dict_type": _keys,
    "mapping_type": _keys,
    "string_type": _text_expected,
    "bool_type": _got("true or false"),
    "bool_parsing": _got("true or false"),
    "int_type": _whole_number,
    "int_from_float": _whole_number,
    "int_parsing_size": _whole_number,
    "float_type": _number,
    "finite_number": _number,
    "greater_than": _bound("more than", "gt"),
    "greater_than_equal": _bound("at least", "ge"),
    "less_than_equal": _bound("at most", "le"),
    "less_than": _bound("less than", "lt"),
    "too_short": _too_few,
}
