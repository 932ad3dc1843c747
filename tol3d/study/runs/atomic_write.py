"""Files that are whole or not there, also after a kill or a power cut; and whose fault it is when they are not."""

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from io import BufferedRandom
from pathlib import Path

from tol3d.errors import NO_SPACE, InputError, unwritable

UNFINISHED = ".writing"


def write_whole(path: Path, content: bytes | memoryview) -> None:
    """A file of this content, see `write_by`."""
    write_by(path, lambda stream: stream.write(content))


def write_by(path: Path, write: Callable[[BufferedRandom], object]) -> None:
    """Write beside the file's place, bring it to the disk and rename it there; a failure leaves nothing behind.

    Args:
        path: the file.
        write: writes its content to a stream that it may read again.

    Raises:
        OSError: it names the file.
    """
    beside = path.with_name(path.name + UNFINISHED)
    try:
        with named_in_errors(path):
            with beside.open("w+b") as stream:
                write(stream)
                stream.flush()
                os.fsync(stream.fileno())
            beside.replace(path)
    except BaseException:  # one who interrupts it too
        beside.unlink(missing_ok=True)
        raise


def write_texts(texts: Mapping[str, str], folder: Path) -> tuple[Path, ...]:
    """Write files into a folder, which is made if it is not there.

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
def named_in_errors(path: Path) -> Iterator[None]:
    """Within it an OSError names the file that is written: the system's own may name none, or one beside it."""
    try:
        yield
    except OSError as error:
        error.filename = str(path)
        raise


def lacks_space(error: OSError) -> bool:
    """True if a write failed because the disk, or the user's share of it, is full."""
    return error.errno in NO_SPACE
