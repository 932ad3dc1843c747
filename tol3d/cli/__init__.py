"""The command line: arguments, exit codes, progress. The only place that prints.

Exit codes: 0 done, 1 limits failed (with --fail-on-limits), 2 wrong input, a write that the disk or the system refused
(full, read-only, broken, a limit on files) or too little memory, 3 a fault of tol3d or of a mechanism of another
package, 130 interrupted, 141 where nobody reads the output any more (`| head`). Imports stand inside the functions
here, so that `tol3d --help` loads no numpy, no CAD and no plotting.
"""

import gc
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Annotated, TextIO

import typer

from tol3d.cli.arguments import app
from tol3d.cli.console import BROKEN_PIPE, DONE, FAULT, INTERRUPTED, WRONG_INPUT, err_console, warn, write_plainly

__all__ = ["app", "main"]

NO_ROOM_TO_LOAD = "failed to map segment"  # of the dynamic loader, where a library does not fit into memory
FULL = 0.8  # of an allowed address space; the piece that did not fit would have gone beyond it
OBJECTS_A_COLLECTION = 200_000  # instead of Python's 700: 0.3 s of a command of 2 s


def _version(asked: bool) -> None:
    from importlib.metadata import version

    if asked:
        typer.echo(f"tol3d {version('tol3d')}")
        raise typer.Exit(DONE)


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    """Options of tol3d itself; the help of `app` is shown for it."""


@contextmanager
def _plain_warnings() -> Iterator[None]:
    """Warnings of ours are one yellow line each; those of other packages stay as Python shows them."""
    with warnings.catch_warnings():
        as_python_does = warnings.showwarning

        def show(
            message: Warning | str,
            category: type[Warning],
            filename: str,
            lineno: int,
            file: TextIO | None = None,
            line: str | None = None,
        ) -> None:
            if category.__module__.startswith("tol3d."):
                warn(str(message))
            else:
                as_python_does(message, category, filename, lineno, file, line)

        warnings.showwarning = show
        yield


@contextmanager
def _exit_codes() -> Iterator[None]:
    from tol3d.errors import InputError, MechanismError

    try:
        yield
    except InputError as error:
        err_console.print(str(error))
        sys.exit(WRONG_INPUT)
    except KeyboardInterrupt:
        err_console.print("stopped")
        sys.exit(INTERRUPTED)
    except SystemExit as ended:
        if ended.__context__ is not None and isinstance(ended.__context__.__cause__, KeyboardInterrupt):
            err_console.print("stopped")  # typer ends an interrupted command without a word
        raise
    except BrokenPipeError:
        raise
    except Exception as error:
        if short := _out_of_memory(error):
            sys.stderr.write(f"{short}\n")  # rich would want more of it
            sys.exit(WRONG_INPUT)
        if refused := _refused_write(error):
            err_console.print(refused)
            sys.exit(WRONG_INPUT)
        if isinstance(error, MechanismError):
            _print_fault(str(error), "to its authors ", error.__cause__ or error)
        else:
            _print_fault(f"a fault in tol3d, not in your scene: {type(error).__name__}: {error}", "", error)
        sys.exit(FAULT)


@contextmanager
def _broken_pipes() -> Iterator[None]:
    """End without a word where nobody reads the output any more, as in `tol3d check scene.yaml | head`."""
    import os

    try:
        try:
            yield
        finally:
            if sys.stdout is not None:
                sys.stdout.flush()
    except (BrokenPipeError, SystemExit) as ended:
        if not any(isinstance(cause, BrokenPipeError) for cause in _causes(ended)):  # typer ends with 1 of one
            raise
        nowhere = os.open(os.devnull, os.O_WRONLY)
        for stream in (sys.stdout, sys.stderr):  # what is left in them would be refused again as Python ends
            with suppress(OSError, ValueError, AttributeError):
                os.dup2(nowhere, stream.fileno())
        sys.exit(BROKEN_PIPE)


def _print_fault(words: str, whom: str, error: BaseException) -> None:
    """A fault of code, with the last lines of its traceback for those who mend it."""
    import traceback

    err_console.print(words)
    err_console.print(f"please report it {whom}with the scene and these lines:")
    err_console.print("".join(traceback.format_exception(error)[-3:]).rstrip())


def _out_of_memory(error: Exception) -> str:
    """Message where the system gives no more memory; empty for other errors."""
    lacking = next((cause for cause in _causes(error) if _wants_memory(cause)), None)
    if lacking is None and not _has_filled_its_room():
        return ""
    why = " ".join(str(lacking or error).split())
    return (
        f"out of memory{f' ({why})' if why else ''}: the input is not at fault; allow more (a run takes 1 to 2 GB of "
        "address space and some for each worker), or use fewer --workers; finished blocks are kept, and the same "
        "command resumes the run"
    )


def _causes(error: BaseException | None) -> Iterator[BaseException]:
    """An error and those that it was raised for, from the last to the first: libraries hide what the system told."""
    while error is not None:
        yield error
        error = error.__cause__ or error.__context__


def _wants_memory(error: BaseException) -> bool:
    import errno

    if isinstance(error, OSError) and error.errno == errno.ENOMEM:
        return True
    unloaded = isinstance(error, ImportError | OSError) and NO_ROOM_TO_LOAD in str(error)
    return unloaded or isinstance(error, MemoryError)


def _has_filled_its_room() -> bool:
    """True if the address space is limited (`ulimit -v`) and nearly used up: libraries then fail in any way."""
    try:
        import resource

        allowed, _ = resource.getrlimit(resource.RLIMIT_AS)
        with open("/proc/self/status", "rb") as status:  # noqa: PTH123, pathlib wants more memory
            peak = next(int(row.split()[1]) << 10 for row in status if row.startswith(b"VmPeak"))
    except MemoryError:
        return True
    except (ImportError, OSError, ValueError, StopIteration):  # another system
        return False
    return allowed != resource.RLIM_INFINITY and peak > FULL * allowed


def _refused_write(error: Exception) -> str:
    """Message on a write that the disk refused; empty for other errors."""
    from pathlib import Path

    from tol3d.errors import refused_by_disk, unwritable

    if not isinstance(error, OSError) or not refused_by_disk(error):
        return ""
    return str(unwritable(Path(error.filename or "standard output, or a temporary file"), error, ""))


@contextmanager
def _few_collections() -> Iterator[None]:
    """Within it Python looks for garbage seldom: libraries being loaded make much that stays, and little garbage."""
    before = gc.get_threshold()
    gc.set_threshold(OBJECTS_A_COLLECTION, *before[1:])
    try:
        yield
    finally:
        gc.set_threshold(*before)


def main() -> None:
    """Entry point of the `tol3d` command."""
    write_plainly()
    try:
        with _few_collections(), _plain_warnings(), _broken_pipes(), _exit_codes():
            app()
    finally:
        gc.freeze()  # else Python looks through all of it again while it ends: 0.4 s of a command of 2 s
