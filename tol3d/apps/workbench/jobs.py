"""Runs, analyses and reports of a folder as jobs: processes of their own, one at a time, which outlive the app.

    asked        words -> attempt, process    Jobs.start, analyse, resume, report
    done         turn, work, progress         job.py (monitor.py, work.py)
    seen         files -> state               Jobs.list           (attempt.py: which files)

All state is on the disk: another app on the folder, or the next one, sees the same jobs.
"""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Final, Literal, get_args

from tol3d.apps.workbench.attempt import (
    ANSWER,
    JOBS,
    NUMBERS,
    RUNS,
    STARTS_WITHIN,
    Attempt,
    Kind,
    Order,
    Progress,
    attempts,
    is_name,
)
from tol3d.apps.workbench.job import TRUSTED
from tol3d.apps.workbench.monitor import PATIENCE_S
from tol3d.apps.workbench.place import FolderLock, inside
from tol3d.apps.workbench.standing import Job, LastAttempt
from tol3d.apps.workbench.words import Words, refuse_unfit
from tol3d.errors import InputError, unwritable
from tol3d.files import read_file
from tol3d.study.runs import made_folder

COMMAND: Final = (sys.executable, "-P", "-m", "tol3d.apps.workbench.job")  # -P: not from the folder it is called in
REPORT: Final = "report.html"  # in a run's folder
LOOK_S: Final = 0.02  # s
MOST_ENDED: Final = 50
"""Jobs that have ended and are kept; older ones are dropped as an app starts."""

Analysis = Literal["what_if", "effects", "changes", "allocate", "rare", "methods", "sweep"]


class Jobs:
    """Jobs of an opened folder. Its methods may be called from any thread.

    Args:
        lock: of the folder; where another app has it, jobs are seen, and none is started or ended.
    """

    def __init__(self, lock: FolderLock) -> None:
        self._lock = lock
        self._folder = lock.folder
        self._processes: dict[int, subprocess.Popen[bytes]] = {}
        self._starting = threading.RLock()

    def list(self) -> tuple[Job, ...]:
        """All jobs, in the order in which they were first asked for."""
        return tuple(last.job() for last in self._last().values())

    @property
    def working(self) -> tuple[Job, ...]:
        """Jobs that run or wait for their turn, in that order."""
        return tuple(job for job in self.list() if job.goes_on)

    def job(self, id: str) -> Job:
        """A job as it stands.

        Raises:
            InputError: no such job.
        """
        return self._of(id).job()

    def start(
        self, scene: Path, *, trials: int | None = None, trust_parts: bool = False, run_builders: bool = False
    ) -> Job:
        """Run a scene's study, into `runs` as `tol3d run` does; after the jobs that were asked for before it.

        The scene is read when its turn comes.

        Args:
            scene: its file, in the folder.
            trials: default: the study's.
            trust_parts, run_builders: see run_scene.

        Raises:
            InputError: another app writes in the folder, or no scene of the folder.
        """
        words: Words = {} if trials is None else {"trials": trials}
        return self._asked("run", scene, words, {"trust_parts": trust_parts, "run_builders": run_builders})

    def analyse(
        self,
        scene: Path,
        kind: Analysis,
        words: Words,
        *,
        trust_parts: bool = False,
        run_builders: bool = False,
    ) -> Job:
        """Ask an analysis of a scene; see `answer`.

        Args:
            scene: its file, in the folder.
            kind: of the analysis, a function of tol3d.analyses.answers.
            words: arguments by name, see `words.WORDS`; they may come from a page.
            trust_parts, run_builders: see run_scene.

        Raises:
            InputError: as `start`, and no such analysis or argument.
        """
        if kind not in get_args(Analysis):
            raise InputError(f"expected {', '.join(get_args(Analysis))}, got {kind!r}")
        return self._asked(kind, scene, words, {"trust_parts": trust_parts, "run_builders": run_builders})

    def _asked(self, kind: Kind, scene: Path, words: Words, trusted: Mapping[str, bool]) -> Job:
        place = inside(self._folder / scene, self._folder)
        if not place.is_file():
            raise InputError(
                f"{place}: expected a scene's file, got {'a folder' if place.is_dir() else 'no such file'}"
            )
        name = place.relative_to(self._folder).as_posix()
        return self._begun(Order("", kind, name, words, _now()), trusted)

    def cancel(self, id: str) -> Job:
        """End a job; what it has finished is kept. Its process ends in order, or is killed after 5 s.

        Raises:
            InputError: another app writes in the folder, no such job, or it has ended.
        """
        self._lock.demand()
        last = self._of(id)
        state, _ = last.seen()
        if state not in ("waiting", "running"):
            raise InputError(f"job {id}: expected one that goes on, this one is {state}")
        last.attempt.cancel()
        if process := self._processes.get(last.attempt.number):
            threading.Thread(target=_kill, args=(process,), daemon=True).start()
        return last.job()

    def resume(self, id: str, *, trust_parts: bool = False, run_builders: bool = False) -> Job:
        """Go on with a job that was cancelled or interrupted or failed, after the others.

        Args:
            id: its name.
            trust_parts, run_builders: see run_scene.

        Raises:
            InputError: another app writes in the folder, no such job, one that goes on or is done, or its scene was
                changed since.
        """
        with self._starting:
            self._lock.demand()
            last = self._of(id)
            state, progress = last.seen()
            if state in ("waiting", "running", "done"):
                raise InputError(f"job {id}: expected one that has stopped, this one is {state}")
            scene = inside(self._folder / last.order.scene, self._folder)
            if progress.run and read_file(scene).sha256 != progress.sha256:
                raise InputError(
                    f"{scene}: was changed since this run began, and old and new trials do not go together; run the "
                    "scene anew, which keeps the old ones, or undo the change"
                )
            order = replace(last.order, asked=_now(), run=progress.run or last.order.run)
            return self._begun(order, {"trust_parts": trust_parts, "run_builders": run_builders})

    def delete(self, id: str) -> None:
        """Delete the files of a job that has ended; its run in `runs` stays.

        Raises:
            InputError: another app writes in the folder, no such job, or one whose process lives.
        """
        with self._starting:
            self._lock.demand()
            last = self._of(id)
            if last.job().goes_on:
                raise InputError(f"job {id}: expected one that has ended, this one is {last.job().state}")
            if last.attempt.is_alive():
                raise InputError(f"job {id}: its process is still ending; ask again in a few seconds")
            for attempt, order in self._attempts():
                if order.job == id:
                    attempt.delete()

    def drop_oldest(self) -> None:
        """Delete the files of jobs that ended long ago; MOST_ENDED are kept."""
        with suppress(InputError):  # of an app that only reads
            ended = [job for job in self.list() if not job.goes_on]
            for job in ended[: max(len(ended) - MOST_ENDED, 0)]:
                self.delete(job.id)

    def report(self, id: str) -> Path | Job:
        """Report of a finished run, in its folder, or the job that makes it when it is first asked for.

        Raises:
            InputError: another app writes in the folder, no such job, or it is no finished run.
        """
        job = self.job(id)
        if job.kind not in ("run", "report") or job.state != "done" or job.run is None:
            raise InputError(f"job {id}: expected a finished run, this one is {job.kind}, {job.state}")
        return self.report_of(job.run.name)

    def report_of(self, run: str, scene: str = "") -> Path | Job:
        """Report of a run by the name of its folder in `runs`, and of its scene; see `report`."""
        with self._starting:
            path = inside(self._folder / RUNS / run / REPORT, self._folder)
            if not is_name(run) or not path.parent.is_dir():
                raise InputError(f"{path.parent}: expected the folder of a finished run")
            if path.is_file():
                return path
            jobs = [own for own in self.list() if own.run == path.parent]
            making = [own for own in jobs if own.kind == "report" and own.state in ("waiting", "running")]
            scene = scene or next((own.scene for own in jobs), "")
            return making[0] if making else self._begun(Order("", "report", scene, {}, _now(), run), {})

    def answer(self, id: str) -> Path:
        """File of the answer of an analysis, for `answer.kept_answer`; beside it lie its numbers, `answer.csv`.

        Raises:
            InputError: no such job, or it is no finished analysis.
        """
        last = self._of(id)
        path = inside(last.attempt.place / ANSWER, self._folder)
        if last.seen()[0] != "done" or not path.is_file():
            raise InputError(f"job {id}: expected a finished analysis, this one is {last.order.kind}, {last.seen()[0]}")
        return path

    def numbers(self, id: str) -> Path:
        """File of the numbers of an analysis, a CSV; see `answer`."""
        return inside(self.answer(id).with_name(NUMBERS), self._folder)

    def _last(self) -> dict[str, LastAttempt]:
        """Last attempts by job."""
        return {order.job: LastAttempt(attempt, order) for attempt, order in self._attempts()}

    def _attempts(self) -> Iterator[tuple[Attempt, Order]]:
        """All attempts, with their orders."""
        found = ((attempt, attempt.order()) for attempt in attempts(self._folder))
        return ((attempt, order) for attempt, order in found if order is not None)

    def _of(self, id: str) -> LastAttempt:
        last = self._last()
        if id not in last:
            raise InputError(f"job {id!r}: there is none; there are: {', '.join(last) or 'none'}")
        return last[id]

    def _begun(self, order: Order, trusted: Mapping[str, bool]) -> Job:
        """A job whose process lives: the next one's then waits for it."""
        with self._starting:
            self._lock.demand()
            refuse_unfit(order.kind, order.words)  # those of an order on the disk too, which anybody may have written
            attempt = self._next()
            order = replace(order, job=order.job or attempt.place.name)
            options = [option for argument, option in TRUSTED.items() if trusted.get(argument)]
            command = [*COMMAND, str(self._folder), str(attempt.number), *options]
            try:
                attempt.write(order)
                with (attempt.place / "output.txt").open("xb") as output:
                    process = subprocess.Popen(
                        command,
                        stdin=subprocess.DEVNULL,
                        stdout=output,
                        stderr=output,
                        start_new_session=True,  # what ends the app ends no job
                    )
            except OSError as error:
                raise unwritable(attempt.place, error, "free it, or open another folder") from None
            self._processes[attempt.number] = process
            threading.Thread(target=process.wait, daemon=True).start()
            began = time.monotonic()
            while attempt.progress() is None and process.poll() is None and time.monotonic() - began < STARTS_WITHIN:
                time.sleep(LOOK_S)
            if attempt.progress() is None and process.poll() is not None:
                words = f"its process ended with {process.returncode} as it started: see {attempt.place / 'output.txt'}"
                attempt.write(Progress("failed", message=words))
            return LastAttempt(attempt, order).job()

    def _next(self) -> Attempt:
        """A new attempt, with a folder of its own."""
        made_folder(inside(self._folder / JOBS, self._folder))
        number = max((own.number for own in attempts(self._folder)), default=0) + 1
        while True:
            attempt = Attempt(self._folder, number)
            with suppress(FileExistsError):
                attempt.place.mkdir()
                return attempt
            number += 1


def _now() -> str:
    return datetime.now().astimezone().isoformat(timespec="seconds")


def _kill(process: "subprocess.Popen[bytes]") -> None:
    """Kill a process that does not end in order, with those that it started."""
    with suppress(subprocess.TimeoutExpired):
        process.wait(PATIENCE_S)
    if process.poll() is None:
        if hasattr(os, "killpg"):
            os.killpg(process.pid, signal.SIGKILL)
        else:  # Windows
            process.kill()
