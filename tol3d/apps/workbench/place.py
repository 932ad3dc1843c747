"""The app's own place in a folder, `.tol3d/app/`: it stays in the folder, and one app at a time writes there."""

from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Final, Self

from filelock import FileLock, Timeout

from tol3d.errors import InputError
from tol3d.study.runs import made_folder, write_whole

APP: Final = ".tol3d/app"
IGNORED: Final = b"*\n"
"""Content of `.tol3d/.gitignore`, so that no repository takes in what an app keeps."""


def inside(path: Path, folder: Path) -> Path:
    """A path that stays in a folder, links followed.

    Raises:
        InputError: it leads out of it.
    """
    try:
        stays = path.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError, ValueError):  # links in a circle, a NUL
        stays = False
    if not stays:
        raise InputError(f"{path}: leads out of {folder}; expected a place in it, without links out")
    return path


def lock_in(path: Path, folder: Path) -> FileLock:
    """Lock of a file in a folder, which a stranger may have made: opening a link would empty what it leads to.

    Raises:
        InputError: it is a link, or leads out of the folder.
    """
    if inside(path, folder).is_symlink():
        raise InputError(f"{path}: expected a file, got a link")
    return FileLock(path, thread_local=False)


class FolderLock:
    """The right to write in a folder: the first app that opens it has it, until it ends, however it does.

    Attributes:
        folder: the opened folder, links followed.
        refusal: the reason why this app only reads; "" if it writes.

    Raises:
        InputError: it is no folder, or its place for the app leads out of it.
    """

    def __init__(self, folder: Path) -> None:
        if not folder.is_dir():
            raise InputError(f"{folder}: expected a folder, got {'a file' if folder.exists() else 'no such folder'}")
        self.folder: Final = folder.resolve()
        self._lock = lock_in(self.folder / APP / "lock", self.folder)
        self.refusal = ""
        self.acquire()

    def acquire(self) -> None:
        """Take the right, if nobody has it."""
        try:
            made_folder(self.folder / APP)
            if not self._lock.is_locked:
                self._lock.acquire(blocking=False)
        except Timeout:
            self.refusal = f"{self.folder}: another tol3d app has it open and writes there; this one only reads"
        except (OSError, NotImplementedError, InputError) as error:
            self.refusal = f"{self.folder}: nothing can be kept there, so this app only reads ({error})"
        else:
            self.refusal = ""
            self._ignore()

    def _ignore(self) -> None:
        """Let no repository take in the app's place; what lies there already stays."""
        path = (self.folder / APP).parent / ".gitignore"
        if not path.exists() and not path.is_symlink():
            with suppress(OSError):
                write_whole(path, IGNORED)

    def demand(self) -> None:
        """Raise unless this app may write.

        Raises:
            InputError: another app does, or nobody can.
        """
        if self.refusal:
            raise InputError(self.refusal)

    def release(self) -> None:
        """Let another app write."""
        self._lock.release(force=True)
        self.refusal = f"{self.folder}: this app has closed it"

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.release()
