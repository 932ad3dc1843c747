"""Folders that commands write into."""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from tol3d.errors import InputError, unwritable


def write_texts(texts: Mapping[str, str], folder: Path) -> tuple[Path, ...]:
    """Write files into a folder, which is made if it is not there.

    Raises:
        InputError: they cannot be written.
    """
    place = made_folder(folder)
    for name, text in texts.items():
        try:
            with whole(place / name) as beside:
                beside.write_text(text, encoding="utf-8")
        except OSError as error:
            raise unwritable(place / name, error, "choose another folder") from None
    return tuple(place / name for name in texts)


def made_folder(folder: Path) -> Path:
    """The folder, made if it is not there.

    Raises:
        InputError: it cannot be, or is a file.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise InputError(f"{folder}: expected a folder, got a file") from None
    except OSError as error:
        raise unwritable(folder, error, "choose another folder") from None
    return folder


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """A file beside `path` that takes its place once all is written; nothing is left of a failure."""
    beside = path.with_name(f"{path.name}.{os.getpid()}.partial")
    try:
        yield beside
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)


def begins_with(path: Path, text: str) -> bool:
    """True if a file begins with a text."""
    try:
        with path.open("rb") as file:
            return path.is_file() and file.read(len(text.encode())) == text.encode()
    except OSError:
        return False
