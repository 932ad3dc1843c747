"""An analysis as a page asks for it: by the function of its command, or only as far as that reads its arguments."""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, Final

from tol3d.analyses.answers import Answer
from tol3d.analyses.subject import Subject
from tol3d.apps.workbench.words import OPTION, Words, refuse_unfit
from tol3d.errors import InputError
from tol3d.import_path import named
from tol3d.scene import Scene
from tol3d.simulate import Overrides

ANALYSES: Final = "tol3d.analyses.answers"
OF_STUDY: Final = ("trials", "seed", "engine")
"""Arguments of a sweep that replace values of the study."""


class _Begins(BaseException):
    """The analysis begins to evaluate: all that it has read is right. No error, so that nobody takes it for one."""


def ask(
    kind: str,
    subject: Scene | Subject | Path,
    words: Words,
    activity: Callable[[str], None],
    *,
    out: Path | None = None,
    trust_parts: bool = False,
    run_builders: bool = False,
) -> Answer[Any]:
    """An analysis.

    Args:
        kind: of it, a function of tol3d.analyses.answers.
        subject: a scene, its path, or but for a sweep a subject.
        words: arguments by name, see `words.WORDS`.
        activity: progress callback.
        out: folder of the variants of a sweep; None keeps none.
        trust_parts, run_builders: see run_scene.

    Raises:
        InputError: as its command.
    """
    more: dict[str, Any] = {"activity": activity, "trust_parts": trust_parts, "run_builders": run_builders}
    if kind == "sweep":
        study: dict[str, Any] = {name: words[name] for name in OF_STUDY if name in words}
        more |= {"overrides": Overrides(**study), "out": out}
        words = {name: own for name, own in words.items() if name not in OF_STUDY}
    found: Answer[Any] = named(f"{ANALYSES}:{kind}")(subject, **words, **more)
    return found


def refusal(kind: str, subject: Scene | Subject, words: Words) -> Mapping[str, str] | None:
    """The refusal of an analysis, before it evaluates anything; None where it begins.

    Args:
        kind, subject, words: see `ask`.

    Returns:
        "message", and the "argument" without which there is none, or at least another one; "of": its entry of several.
    """
    message = _refused(kind, subject, words)
    if not message:
        return None
    found = {(argument, of): _refused(kind, subject, others) for argument, of, others in _less(words)}
    suspects = sorted((own for own in found if found[own] != message), key=lambda own: bool(found[own]))
    argument, of = suspects[0] if suspects else ("", "")
    return {"argument": argument, "of": of, "message": OPTION.sub("", message)}


def _refused(kind: str, subject: Scene | Subject, words: Words) -> str:
    def begins(text: str) -> None:
        raise _Begins

    try:
        refuse_unfit(kind, words)
        ask(kind, subject, words, begins)
    except InputError as error:
        return str(error)
    except _Begins:
        pass
    return ""


def _less(words: Words) -> Iterator[tuple[str, str, Words]]:
    """Each entry of the arguments, with the arguments that are left without it."""
    for argument, value in words.items():
        if isinstance(value, dict):
            for of in value:
                yield argument, of, {**words, argument: {name: own for name, own in value.items() if name != of}}
        elif isinstance(value, list):
            for of in value:
                yield argument, of, {**words, argument: [own for own in value if own != of]}
        else:
            yield argument, "", {name: own for name, own in words.items() if name != argument}
