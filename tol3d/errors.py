"""Errors that a user must mend, in the user's words; any other error is a fault of ours, or of the disk."""

import errno
import re
from pathlib import Path
from typing import Final

NO_SPACE = (errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC))  # Windows has no quotas of its own number
REFUSED_BY_DISK = frozenset((*NO_SPACE, errno.EFBIG, errno.EIO, errno.EROFS))

EXPECTED_GOT: Final = re.compile(
    r"""expected\ (?P<expected>.*?),?\ (?:got|found)\b:?\ ?
    (?P<got>(?:'(?:[^'\\]|\\.)*'|"(?:[^"\\]|\\.)*"|[^;'"]|['"])*)""",
    re.VERBOSE | re.DOTALL,
)
"""The form of sentences on what cannot be used: what was expected, what came, then advice behind a semicolon."""


class Tol3dError(Exception):
    """Base of every error that tol3d raises on purpose; its text is meant for people."""


class Problem(str):
    """A finished message on a scene or a file that it reads, and its parts.

    Args:
        text: the message.
        file: its file; "" where none is known.
        line, column: of the file, from 1; 0 where none is known.
        path: place in the scene, such as "tolerances.x.distribution"; in another file a column or a field.
        sentence: the message without file, line and path.
    """

    file: str
    line: int
    column: int
    path: str
    sentence: str

    def __new__(
        cls, text: str, file: str = "", line: int = 0, column: int = 0, path: str = "", sentence: str = ""
    ) -> "Problem":
        """A message with its parts; without any it is a sentence."""
        problem = super().__new__(cls, text)
        problem.file, problem.line, problem.column, problem.path = file, line, column, path
        problem.sentence = sentence or text
        return problem

    @classmethod
    def of(cls, text: str) -> "Problem":
        """A message, with its parts if it has some."""
        return text if isinstance(text, cls) else cls(text)

    @classmethod
    def at(cls, file: Path | str, sentence: str, *, line: int = 0, column: int = 0, path: str = "") -> "Problem":
        """`file:line: path: sentence`, as far as they are known; line and column count from 1."""
        words = (f"{file}:{line}" if line else str(file), path, sentence)
        return cls(": ".join(part for part in words if part), str(file), line, column, path, sentence)

    @property
    def expected(self) -> str:
        """Text between "expected" and ", got" or ", found"; "" of a sentence of another form.

        >>> Problem("expected a length, got '3; 4'; write one").expected
        'a length'
        """
        return self._told["expected"] if self._told else ""

    @property
    def got(self) -> str:
        """Text behind ", got" or ", found", without the advice that follows; "" of a sentence of another form.

        >>> Problem("expected a length, got '3; 4'; write one").got
        "'3; 4'"
        """
        return self._told["got"] if self._told else ""

    def data(self, severity: str = "error") -> dict[str, str | int | None]:
        """Parts for programs, None where one is not known; the message is the sentence.

        Args:
            severity: error, or warning.
        """
        return {
            "severity": severity,
            "file": self.file or None,
            "line": self.line or None,
            "column": self.column or None,
            "place": self.path or None,
            "expected": self.expected or None,
            "got": self.got or None,
            "message": self.sentence,
        }

    @property
    def _told(self) -> re.Match[str] | None:
        return EXPECTED_GOT.match(self.sentence)


class InputError(Tol3dError):
    """Something the user gave (a scene, an option, a folder) cannot be used; exit code 2."""

    @property
    def problems(self) -> tuple[Problem, ...]:
        """Its messages one by one, with their places as far as they are known."""
        return (Problem(str(self)),)


class SceneError(InputError):
    """A scene cannot be read or understood.

    Args:
        problems: one or several finished messages, each with file, line, place and expectation.
    """

    def __init__(self, *problems: str) -> None:
        self._problems = tuple(map(Problem.of, problems))
        super().__init__("\n".join(problems))

    @property
    def problems(self) -> tuple[Problem, ...]:
        """See InputError."""
        return self._problems

    def __reduce__(self) -> tuple[type["SceneError"], tuple[Problem, ...]]:
        """Pickled by its problems: another process has them one by one too."""
        return type(self), self.problems


class GeometryError(InputError):
    """Gears that cannot be made, or cannot run together; the text carries the numbers."""


class MechanismError(Tol3dError):
    """A mechanism of another package is at fault, not the user's input; exit code 3."""


class RunError(InputError):
    """A folder is not a run, is damaged, or cannot be written."""


class DiskError(RunError):
    """The disk or the system refuses a write: tol3d is not at fault; exit code 2."""


def refused_by_disk(error: OSError) -> bool:
    """True if a write failed by the disk or the system's limits: neither the input nor the code is wrong."""
    return error.errno in REFUSED_BY_DISK


def unwritable(path: Path, error: OSError, advice: str) -> RunError:
    """The error to raise for a file that cannot be written.

    Args:
        path: the file or folder.
        error: that of the system.
        advice: remedy where another place would be better; for a failing disk, to mend it.
    """
    why = f"{path}: cannot be written ({error.strerror or error})"
    if refused_by_disk(error):
        return DiskError(f"{why}; the input is not at fault: mend the disk or its limits")
    return RunError(f"{why}; {advice}" if advice else why)
