"""Errors that a user must mend, in the user's words; any other error is a fault of ours, or of the disk."""

import errno
from pathlib import Path

NO_SPACE = (errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC))  # Windows has no quotas of its own number
REFUSED_BY_DISK = frozenset((*NO_SPACE, errno.EFBIG, errno.EIO, errno.EROFS))


class Tol3dError(Exception):
    """Base of every error that tol3d raises on purpose; its text is meant for people."""


class InputError(Tol3dError):
    """Something the user gave (a scene, an option, a folder) cannot be used; exit code 2."""


class SceneError(InputError):
    """A scene cannot be read or understood.

    Args:
        problems: one or several finished messages, each with file, line, place and expectation.
    """

    def __init__(self, *problems: str) -> None:
        self.problems = problems
        super().__init__("\n".join(problems))


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
