"""Files that a scene names: read once, so that the same bytes are run, kept and hashed."""

import hashlib
import os
import re
import stat
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from tol3d.errors import Problem, SceneError

LARGEST_FILE = 20_000_000  # bytes; about two million values, seconds to parse
NO_WAIT = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)  # which Windows lacks, and which it needs
KEPT_HASH, KEPT_NAME = 12, 60  # characters of the name under which a run keeps a file


@dataclass(frozen=True)
class FileContent:
    """A file's content and path.

    Args:
        path: the path that was read.
        content: its bytes.
    """

    path: Path
    content: bytes

    @cached_property
    def sha256(self) -> str:
        """Its SHA-256, hexadecimal."""
        return hashlib.sha256(self.content).hexdigest()


Files = Mapping[str, FileContent]
"""Files by the name that the scene gives them."""


def read_file(path: Path) -> FileContent:
    """Read a file that a scene names.

    Raises:
        SceneError: it is missing, too large or cannot be read.
    """
    try:
        if not path.is_file():
            got = "a folder" if path.is_dir() else "no such file"
            raise SceneError(Problem.at(path, f"expected a file, got {got}"))
        with path.open("rb") as stream:
            content = stream.read(LARGEST_FILE + 1)
    except OSError as error:
        raise SceneError(Problem.at(path, f"expected a file that can be read, got: {error.strerror}")) from None
    if len(content) > LARGEST_FILE:
        raise SceneError(Problem.at(path, f"expected at most {LARGEST_FILE // 10**6} MB"))
    return FileContent(path, content)


def kept_name(name: str, sha256: str) -> str:
    """The name under which a run keeps a file: made of its content, so that it stays inside the run's folder.

    >>> kept_name("../measured/wheel thickness.csv", 64 * "0")
    '000000000000-wheel_thickness.csv'
    """
    return f"{sha256[:KEPT_HASH]}-{re.sub(r'[^A-Za-z0-9.-]', '_', Path(name).name)[-KEPT_NAME:]}"


class UnreadableFileError(Exception):
    """A file that is not read; its text is the reason, without the file's name."""


def contained(name: str) -> bool:
    """True if a relative path stays in the folder that it starts from, judged by its text.

    >>> contained("trials/block-000000.parquet"), contained("../mine"), contained("/etc/passwd"), contained("C:/x")
    (True, False, False, False)
    """
    return not ({"", ".", ".."} & set(name.split("/")) or "\\" in name or ":" in name or "\0" in name)


def read_contained(path: Path, folder: Path, largest: int) -> bytes:
    """Read a plain file of a folder that a stranger may have made.

    Args:
        path: the file.
        folder: it lies in here, links followed.
        largest: more bytes are refused before they are read.

    Raises:
        UnreadableFileError: it is missing, a pipe, a device, too large, or a link that leads out of the folder.
    """
    try:
        if not path.resolve(strict=True).is_relative_to(folder.resolve()):
            raise UnreadableFileError(f"a link that leads out of {folder}")
        descriptor = os.open(path, os.O_RDONLY | NO_WAIT)  # of a pipe nothing is waited for
        with os.fdopen(descriptor, "rb") as stream:
            state = os.fstat(descriptor)
            if not stat.S_ISREG(state.st_mode):
                raise UnreadableFileError("expected a plain file, got a folder, a pipe or a device")
            if state.st_size > largest:
                raise UnreadableFileError(f"{state.st_size} bytes, expected at most {largest}")
            content = stream.read(state.st_size + 1)  # as much memory is taken as is asked for
    except OSError as error:
        raise UnreadableFileError(error.strerror or str(error)) from None
    except (ValueError, RuntimeError) as error:  # a NUL in the name, links in a circle
        raise UnreadableFileError(str(error)) from None
    if len(content) > state.st_size:
        raise UnreadableFileError("it grows while it is read")
    return content
