"""A disk that refuses while a run is written: what is kept, and what to do."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from tol3d.errors import DiskError, RunError, refused_by_disk
from tol3d.runs.atomic_write import lacks_space
from tol3d.runs.writer import RunWriter


@contextmanager
def refusals_explained(writer: RunWriter, kept: Callable[[], str]) -> Iterator[None]:
    """Within it, a write that fails raises a RunError that says what is kept.

    Args:
        writer: writes the run.
        kept: what is kept of it, such as "300 of 2000 trials are".
    """
    try:
        yield
    except OSError as error:
        if refused_by_disk(error):
            why, way = _why(error, writer)
            raise DiskError(f"{why}: {kept()} kept in {writer.partial}; {way}, then the same command goes on") from None
        if str(error.filename or "").startswith(str(writer.partial)):
            raise RunError(f"{error.filename}: cannot be written ({error.strerror})") from None
        raise


def _why(error: OSError, writer: RunWriter) -> tuple[str, str]:
    """What the disk refused, and what helps."""
    if lacks_space(error):
        return f"{writer.path}: no space left on the disk", "make room"
    return f"{error.filename or writer.partial}: cannot be written ({error.strerror})", "mend the disk or its limits"
