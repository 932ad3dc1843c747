"""The cache on disk: whole entries in a folder to which only its user may write.

Compiled kernels are among them, and loading one runs it: anyone with write access can run code as the user who starts
tol3d next. An entry is a file, its bytes followed by their SHA-256: a torn or damaged one counts as none. It is written
aside and renamed, so processes that make the same thing at once end with a whole one; what takes long is made by one
of them while the others wait. The folder may be deleted at any time.
"""

import contextlib
import hashlib
import io
import os
import stat
import tempfile
import zipfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import platformdirs
from filelock import FileLock

from tol3d.errors import InputError

FOLDER_VARIABLE = "TOL3D_CACHE"
DIGEST_BYTES = 32
PRIVATE = 0o700
OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH
ROOT = 0  # may write anywhere, so a folder of its own is none the worse
LOCK_POLL = 0.05  # s between attempts to take a lock


class CacheError(InputError):
    """The cache's folder belongs to another user, or others may write to it."""


def cache_folder() -> Path:
    """Folder of the entries: TOL3D_CACHE, or the user's cache folder; it need not exist.

    Raises:
        CacheError: others could write there. Systems without POSIX's owners and modes are not checked.
    """
    stated = os.environ.get(FOLDER_VARIABLE)
    folder = Path(stated) if stated else platformdirs.user_cache_path("tol3d", appauthor=False)
    if hasattr(os, "getuid"):
        _refuse_others(folder)
    return folder


def _refuse_others(folder: Path) -> None:
    try:
        found = folder.stat()
    except OSError:  # not there: it is made for this user alone; or not to be seen, and then not used
        return
    if not stat.S_ISDIR(found.st_mode):
        return
    remedy = f"{FOLDER_VARIABLE} names another folder"
    if found.st_uid not in (os.getuid(), ROOT):
        raise CacheError(
            f"{folder}: this folder of cached kernels belongs to user {found.st_uid}, who could have you run anything; "
            f"expected one of your own: {remedy}"
        )
    if found.st_mode & OTHERS_WRITE:
        raise CacheError(
            f"{folder}: others may write to this folder of cached kernels (mode {stat.S_IMODE(found.st_mode):o}) and "
            f"could have you run anything; expected mode 700: delete it, or `chmod 700` it if you know all that is in "
            f"it; {remedy}"
        )


def read_entry(name: str) -> bytes | None:
    """An entry as it was written; None where there is none, or none that is whole."""
    path = cache_folder() / name
    try:
        if not stat.S_ISREG(path.stat().st_mode):  # a pipe would be waited for
            return None
        content = path.read_bytes()
    except OSError:
        return None
    payload, digest = content[:-DIGEST_BYTES], content[-DIGEST_BYTES:]
    return payload if payload and hashlib.sha256(payload).digest() == digest else None


def write_entry(name: str, payload: bytes) -> None:
    """Keep an entry, all or nothing.

    Raises:
        OSError: it cannot be written.
    """
    folder = _made_folder()
    handle, unfinished = tempfile.mkstemp(dir=folder, prefix=Path(name).stem, suffix=".partial")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(payload + hashlib.sha256(payload).digest())
        Path(unfinished).replace(folder / name)
    except OSError:
        with contextlib.suppress(OSError):
            Path(unfinished).unlink()
        raise


@contextmanager
def sole_maker(name: str, longest_wait: float) -> Iterator[None]:
    """Make an entry alone: while another process is making it, wait for that to finish, but not for ever.

    It saves work and guards nothing: where no lock can be had (folder not writable, file system without locks) or the
    wait ends, the caller goes on as if it were alone. A process that dies loses its lock.

    Args:
        name: of the entry.
        longest_wait: [s].
    """
    with contextlib.ExitStack() as stack:
        # Timeout is an OSError
        with contextlib.suppress(OSError, NotImplementedError, RuntimeError):
            path = _made_folder() / f"{name}.lock"
            lock = FileLock(path)
            stack.enter_context(lock.acquire(timeout=longest_wait, poll_interval=LOCK_POLL))
            stack.callback(_deleted, path)
        yield


def _deleted(path: Path) -> None:
    """Delete a lock's file before the lock is given back; where open files cannot be deleted it stays, empty."""
    with contextlib.suppress(OSError):
        path.unlink()


def _made_folder() -> Path:
    """The cache's folder, for this user alone if it was not there."""
    folder = cache_folder()
    folder.parent.mkdir(parents=True, exist_ok=True)
    folder.mkdir(mode=PRIVATE, exist_ok=True)
    return folder


def packed(files: Sequence[Path]) -> bytes:
    """Files as an archive, by their names: the form of an entry of several."""
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w") as entries:
        for path in files:
            entries.write(path, path.name)
    return archive.getvalue()
