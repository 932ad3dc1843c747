"""Files that a scene names: read once, so that what ran, what is kept and what is hashed are the same bytes."""

import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from tol3d.errors import SceneError

LARGEST_FILE = 20_000_000  # bytes; about two million values, seconds to parse
KEPT_HASH, KEPT_NAME = 12, 60  # characters of the name under which a run keeps a file


@dataclass(frozen=True)
class FileContent:
    """A file's content, and where it was read.

    Args:
        path: where it lay.
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
            raise SceneError(f"{path}: expected a file, got {'a folder' if path.is_dir() else 'no such file'}")
        with path.open("rb") as stream:
            content = stream.read(LARGEST_FILE + 1)
    except OSError as error:
        raise SceneError(f"{path}: expected a file that can be read, got: {error.strerror}") from None
    if len(content) > LARGEST_FILE:
        raise SceneError(f"{path}: expected at most {LARGEST_FILE // 10**6} MB")
    return FileContent(path, content)


def kept_name(name: str, sha256: str) -> str:
    """The name under which a run keeps a file: told by its content, so that it stays inside the run's folder.

    >>> kept_name("../measured/wheel thickness.csv", 64 * "0")
    '000000000000-wheel_thickness.csv'
    """
    return f"{sha256[:KEPT_HASH]}-{re.sub(r'[^A-Za-z0-9.-]', '_', Path(name).name)[-KEPT_NAME:]}"
