"""Atomic writes: after a kill or a power cut a file is whole or not there; and the cause of a failed write."""

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from io import BufferedRandom
from pathlib import Path

from tol3d.errors import NO_SPACE, InputError, unwritable

UNFINISHED = ".writing"  # ends the names of files that are being written


def write_whole(path: Path, content: bytes | memoryview) -> None:
    """Write a file with this content atomically; see `write_by`."""
    write_by(path, lambda stream: stream.write(content))


def write_by(path: Path, write: Callable[[BufferedRandom], object]) -> None:
    """Write a file atomically: beside its place, synchronised to disk, then renamed; a failure leaves nothing behind.

    Args:
        path: the file.
        write: writes its content to a stream, which it may also read.

    Raises:
        OSError: the file cannot be written; the error names it.
    """
    beside = path.with_name(path.name + UNFINISHED)
    try:
        with named_in_errors(path):
            with beside.open("w+b") as stream:
                write(stream)
                stream.flush()
                os.fsync(stream.fileno())
            beside.replace(path)
    except BaseException:  # an interrupt, too
        beside.unlink(missing_ok=True)
        raise


def write_texts(texts: Mapping[str, str], folder: Path) -> tuple[Path, ...]:
    """Write texts by file name into a folder, which is made if missing; returns the paths.

    Raises:
        InputError: they cannot be written.
    """
    place = made_folder(folder)
    for name, text in texts.items():
        try:
            write_whole(place / name, text.encode())
        except OSError as error:
            raise unwritable(place / name, error, "choose another folder") from None
    return tuple(place / name for name in texts)


def made_folder(folder: Path) -> Path:
    """The folder, made if missing.

    Raises:
        InputError: it cannot be made, or is a file.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise InputError(f"{folder}: expected a folder, got a file") from None
    except OSError as error:
        raise unwritable(folder, error, "choose another folder") from None
    return folder


@contextmanager
def named_in_errors(path: Path) -> Iterator[None]:
    """Context in which an OSError names the file being written; the system's own names none, or the one beside it."""
    try:
        yield
    except OSError as error:
        error.filename = str(path)
        raise


def lacks_space(error: OSError) -> bool:
    """True if a write failed because the disk, or the user's share of it, is full."""
    return error.errno in NO_SPACE
