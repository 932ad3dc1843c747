"""An attempt at a job, a folder of its own, which the app, the job's process and later apps read.

    order.json      the job, by the app that started it; it never changes
    progress.json   state, by the job's process, whole at every moment
    lock            held by that process until it ends, however it ends: no other process can be taken for it
    cancel          asks that process to end
    output.txt      its warnings, and the traceback of a fault
    answer.json     findings of an analysis, and answer.csv, its numbers

Attempts are numbered as they were started, and take turns in that order. Files of others are read as a stranger's.
"""

import json
import re
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated, Final, Literal, TypeVar

from filelock import FileLock, Timeout
from pydantic import AfterValidator, TypeAdapter, ValidationError

from tol3d.apps.workbench.place import APP, inside, lock_in
from tol3d.apps.workbench.words import Words
from tol3d.errors import InputError, unwritable
from tol3d.files import UnreadableFileError, read_contained
from tol3d.study.runs import write_whole
from tol3d.study.runs.atomic_write import UNFINISHED

JOBS: Final = f"{APP}/jobs"
RUNS: Final = "runs"
ANSWER: Final = "answer.json"
NUMBERS: Final = "answer.csv"
FILES: Final = ("order.json", "progress.json", "lock", "cancel", "output.txt", ANSWER, NUMBERS)
"""Files of an attempt, the order first: without it there is no job."""
NUMBER: Final = re.compile(r"[0-9]{4,}")
LARGEST: Final = 1_000_000  # bytes of an order or a progress
PROBE_S: Final = 0.02  # s; others hold a lock for less than this when they look whether it is held
STARTS_WITHIN: Final = 10.0  # s; a process that has not begun to live by then will not

Kind = Literal["run", "what_if", "effects", "changes", "allocate", "rare", "methods", "sweep", "report"]
Said = Literal["waiting", "running", "cancelled", "failed", "done"]
Version = Literal[1]

T = TypeVar("T")


def is_name(text: str) -> bool:
    """True if a text names a file or folder in another one.

    >>> is_name("spur_pair-2"), is_name("../else"), is_name("/etc"), is_name(".."), is_name("")
    (True, False, False, False, False)
    """
    return text == Path(text).name and text not in ("", "..")


def _refuse_path(text: str) -> str:
    if text and not is_name(text):
        raise ValueError("expected a name, not a path")
    return text


RunName = Annotated[str, AfterValidator(_refuse_path)]


@dataclass(frozen=True)
class Order:
    """A job that was asked for.

    Args:
        job: its name, that of its first attempt.
        kind: of it.
        scene: path of its scene in the folder.
        words: arguments by name; "trials" of a run.
        asked: time, ISO 8601.
        run: name of the run that is continued or reported; "" for none.
        version: of this format.
    """

    job: str
    kind: Kind
    scene: str
    words: Words
    asked: str
    run: RunName = ""
    version: Version = 1


@dataclass(frozen=True)
class Progress:
    """State of an attempt.

    Args:
        state: by its process.
        done, of: trials.
        words: activity.
        run: name of the run's folder in `runs`; "" until there is one.
        sha256: of the scene when it was read.
        started: time of its turn, ISO 8601; "" before.
        message: for the user: why it failed, or remarks on an answer.
        version: of this format.
    """

    state: Said = "waiting"
    done: int = 0
    of: int = 0
    words: str = ""
    run: RunName = ""
    sha256: str = ""
    started: str = ""
    message: str = ""
    version: Version = 1

    @property
    def is_ended(self) -> bool:
        """True if its process has nothing more to do."""
        return self.state in ("cancelled", "failed", "done")


ORDERS: Final = TypeAdapter(Order)
PROGRESSES: Final = TypeAdapter(Progress)


@dataclass(frozen=True)
class Attempt:
    """An attempt at a job of a folder.

    Args:
        folder: the opened folder.
        number: of the attempt, from 1 on.
        place: folder of its files.
    """

    folder: Path
    number: int
    place: Path = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "place", self.folder / JOBS / f"{self.number:04}")

    def order(self) -> Order | None:
        """The order; None if there is none of this version."""
        return self._read("order.json", ORDERS)

    def progress(self) -> Progress | None:
        """Progress so far; None if its process has not begun to live."""
        return self._read("progress.json", PROGRESSES)

    def _read(self, name: str, kind: TypeAdapter[T]) -> T | None:
        try:
            return kind.validate_json(read_contained(self.place / name, self.folder, LARGEST), strict=True)
        except (UnreadableFileError, ValidationError):
            return None

    def write(self, content: Order | Progress) -> None:
        """Keep an order or progress, all or nothing."""
        text = json.dumps(asdict(content), indent=1, ensure_ascii=False)
        write_whole(self.place / f"{type(content).__name__.lower()}.json", text.encode())

    @property
    def lock(self) -> FileLock:
        """Held by its process."""
        return lock_in(self.place / "lock", self.folder)

    def is_alive(self) -> bool:
        """True while its process lives."""
        with suppress(InputError, OSError, NotImplementedError):
            if not (self.place / "lock").is_file():
                return self.progress() is None and time.time() - self.place.stat().st_mtime < STARTS_WITHIN
            try:
                with self.lock.acquire(timeout=PROBE_S, poll_interval=PROBE_S / 4):
                    return False
            except Timeout:
                return True
        return False

    def wait_for_earlier(self) -> None:
        """Wait until no process of an earlier attempt lives."""
        for other in attempts(self.folder):
            if other.number < self.number and other.is_alive():
                with other.lock:
                    pass

    def cancel(self) -> None:
        """Ask its process to end."""
        with suppress(FileExistsError):
            (self.place / "cancel").open("xb").close()

    @property
    def is_cancelled(self) -> bool:
        """True if it was asked to end."""
        return (self.place / "cancel").exists()

    def delete(self) -> None:
        """Delete its files and its folder; files of others in there stay.

        Raises:
            InputError: they cannot be deleted.
        """
        place = inside(self.place, self.folder)
        try:
            if place.is_symlink():
                place.unlink()
                return
            for name in FILES:
                for own in (place / name, place / f"{name}{UNFINISHED}"):
                    own.unlink(missing_ok=True)
            with suppress(OSError):  # something else is in it
                place.rmdir()
        except OSError as error:
            raise unwritable(place, error, "close what holds it") from None


def attempts(folder: Path) -> Iterator[Attempt]:
    """All attempts in a folder, in their order; none where they lie outside it."""
    with suppress(InputError, OSError):
        names = [path.name for path in inside(folder / JOBS, folder).iterdir() if NUMBER.fullmatch(path.name)]
        yield from (Attempt(folder, number) for number in sorted(map(int, names)))
