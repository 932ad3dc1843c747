"""A job as it stands, by the files of its last attempt."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from tol3d.apps.workbench.attempt import RUNS, Attempt, Kind, Order, Progress
from tol3d.apps.workbench.words import Words

State = Literal["waiting", "running", "cancelled", "interrupted", "failed", "done"]


@dataclass(frozen=True)
class Job:
    """A job as it stands.

    Args:
        id: its name.
        scene: path of its scene in the folder.
        kind: run, report, or an analysis.
        asked: arguments by name.
        state: waiting for others, running, done; cancelled by the user; interrupted, if its process is gone without an
            end; failed.
        done, of: trials; of that ends by itself, the most. 0 of analyses and reports.
        words: activity.
        started: time of its turn, or before that when it was asked for; ISO 8601.
        run: folder that its run has once it is done; None until that is known.
        message: for the user: why it failed, or remarks on an answer.
    """

    id: str
    scene: str
    kind: Kind
    asked: Words
    state: State
    done: int
    of: int
    words: str
    started: str
    run: Path | None
    message: str

    @property
    def goes_on(self) -> bool:
        """True while it runs or waits for its turn."""
        return self.state in ("waiting", "running")


@dataclass(frozen=True)
class LastAttempt:
    """The last attempt at a job."""

    attempt: Attempt
    order: Order

    def seen(self) -> tuple[State, Progress]:
        """State and progress, in that order: what a process that is gone has said is its last word."""
        lives = self.attempt.is_alive()
        progress = self.attempt.progress() or Progress()
        if progress.is_ended:
            return progress.state, progress
        if self.attempt.is_cancelled:
            return "cancelled", progress
        return (progress.state if lives else "interrupted"), progress

    def job(self) -> Job:
        """The job as it stands."""
        state, progress = self.seen()
        run = progress.run or self.order.run
        return Job(
            id=self.order.job,
            scene=self.order.scene,
            kind=self.order.kind,
            asked=self.order.words,
            state=state,
            done=progress.done,
            of=progress.of,
            words=progress.words,
            started=progress.started or self.order.asked,
            run=self.attempt.folder / RUNS / run if run else None,
            message=progress.message,
        )
