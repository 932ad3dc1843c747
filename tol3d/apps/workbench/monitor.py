"""Progress of a job, kept while it goes on, and the job's end when it is cancelled."""

import _thread
import os
import signal
import threading
import time
from contextlib import suppress
from types import TracebackType
from typing import Final, Self

from tol3d.apps.workbench.attempt import Attempt, Progress

LOOK_S: Final = 0.1  # s; so that a cancelled job ends at once
KEEP_S: Final = 0.25  # s between two states on the disk, and of a long job
KEEP_SHARE: Final = 1e-3  # of the time that it has taken so far
PATIENCE_S: Final = 5.0  # s; a cancelled process that does not end by then ends all the same
KILLED: Final = 137  # exit code, as shells tell of SIGKILL


class Monitor:
    """Within it the progress of an attempt is kept, and its process is interrupted when it is cancelled.

    A KeyboardInterrupt comes to the main thread, as by Ctrl-C: all that a run has kept stays whole.

    Args:
        attempt: of this process.
    """

    def __init__(self, attempt: Attempt) -> None:
        self.now = Progress()
        self._attempt = attempt
        self._began = time.monotonic()
        self._closed = threading.Event()
        self._closing = threading.Lock()
        self._thread = threading.Thread(target=self._look, daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._closing:
            self._closed.set()
        self._thread.join()

    def _look(self) -> None:
        kept, kept_at = self.now, self._began
        while not self._closed.wait(LOOK_S):
            if self._attempt.is_cancelled:
                self._interrupt()
                return
            now, at = self.now, time.monotonic()
            if now != kept and at - kept_at >= max(KEEP_S, KEEP_SHARE * (at - self._began)):
                with suppress(OSError):  # a full disk ends the run itself, with words
                    self._attempt.write(now)
                kept, kept_at = now, at

    def _interrupt(self) -> None:
        with self._closing:  # so that no signal comes after the end
            if self._closed.is_set():
                return
            interrupt()
        if not self._closed.wait(PATIENCE_S):
            os._exit(KILLED)


def interrupt() -> None:
    """Interrupt the main thread, also one that waits for others."""
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
    else:  # Windows
        _thread.interrupt_main()
