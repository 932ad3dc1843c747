"""Reading and writing summary.json."""

import json
import unicodedata
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from tol3d.errors import RunError
from tol3d.study.runs.summary.kinds import SummaryKinds, default_kinds
from tol3d.study.runs.summary.run import RunSummary
from tol3d.study.runs.summary.values import UNSAFE
from tol3d.units import shown

SUMMARY_FILE = "summary.json"
LONGEST_MESSAGE = 400  # characters
MOST_NAMED = 3  # unknown kinds
OWN_PACKAGE = "tol3d"
WHERE = "its keys are written down in tol3d/study/runs/summary/ and by mechanisms, a line each in its class"


class SchemaWarning(UserWarning):
    """A summary is written that its own schema does not know; the tests take it for an error."""


def parsed(content: bytes, path: Path) -> dict[str, Any]:
    """The JSON of a summary's file, which a stranger may have made.

    Raises:
        RunError: it is no JSON, or not that of a summary.
    """
    try:
        found = json.loads(content, parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        raise RunError(f"{path}: cannot be read ({_printable(str(error))})") from None
    if not isinstance(found, dict):
        raise RunError(f"{path}: expected the summary of a tol3d run, got {shown(found)}")
    return found


def written(summary: Mapping[str, Any], kinds: SummaryKinds | None = None) -> str:
    """The text of a summary; unknown keys cause a warning, so that a fault does not lose a long study."""
    text = json.dumps(summary, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    try:
        typed(json.loads(text), lambda place, words: RunError(f"{place}: {words}"), kinds)
    except RunError as error:
        warnings.warn(f"a fault of tol3d: {SUMMARY_FILE}: {error}; {WHERE}", SchemaWarning, stacklevel=2)
    return text


def typed(
    summary: Mapping[str, Any], fault: Callable[[str, str], Exception], kinds: SummaryKinds | None = None
) -> RunSummary:
    """A summary as an object.

    Args:
        summary: as JSON.
        fault: makes the error of a place and what is wrong there, which is raised.
        kinds: allowed contents; default: those of this package's mechanisms.
    """
    tried = kinds or kinds_of(summary)
    try:
        return tried.run.model_validate(summary)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
    context = first.get("ctx", {})
    extra = context.get("key") if first["type"] == "unknown_key" else context.get("field")
    place = ".".join(map(str, (*_without_tag(first["loc"], tried), *([extra] if extra else []))))
    got = "" if first["type"] == "value_refused" else f", got {shown(first['input'])}"
    raise fault(_printable(place or "the whole"), _printable(f"{first['msg']}{got}"))


def kinds_of(summary: Mapping[str, Any]) -> SummaryKinds:
    """Kinds by which a summary is read: of its mechanisms where these know all of it, or of every mechanism."""
    own = default_kinds(summary)
    try:
        own.run.model_validate(summary)
    except ValidationError:  # every mechanism's know what else it has; or their message names all that it could be
        return default_kinds()
    return own


def missing_mechanism(summary: Mapping[str, Any], kinds: SummaryKinds | None = None) -> str:
    """The message for a summary with kinds of measures that no mechanism here has; "" if it has none."""
    unknown = (kinds or default_kinds(summary)).unknown_in(summary)
    maker = summary.get("mechanism")
    name, module = (maker.get("name"), maker.get("module")) if isinstance(maker, Mapping) else (None, None)
    if not unknown or str(module).partition(".")[0] == OWN_PACKAGE:  # its own are always there: damaged, or another's
        return ""
    its = f"mechanism {name!r} (Python module {module!r})" if name and module else "mechanism"
    listed = ", ".join(map(repr, unknown[:MOST_NAMED])) + (", …" if len(unknown) > MOST_NAMED else "")
    return _printable(
        f"expected the {its} that made this run, for its measures of kind {listed}: install the package that "
        "brings it, or register it in your program first (tol3d.register)"
    )


def _without_tag(loc: tuple[int | str, ...], kinds: SummaryKinds) -> tuple[int | str, ...]:
    """A place in the file: `measures.play.its_kind.unit` of pydantic is measures.play.unit there."""
    return (*loc[:2], *loc[3:]) if loc[:1] == ("measures",) and len(loc) > 2 and loc[2] in kinds.tags else loc


def _refuse_constant(word: str) -> None:
    raise ValueError(f"{word} is no number of JSON")


def _printable(text: str) -> str:
    """A short text in which a stranger's characters do nothing."""
    safe = "".join(sign if unicodedata.category(sign) not in UNSAFE else "?" for sign in text)
    return safe if len(safe) <= LONGEST_MESSAGE else safe[: LONGEST_MESSAGE - 1] + "…"
