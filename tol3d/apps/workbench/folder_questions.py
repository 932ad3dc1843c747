"""Questions of the app's page on the folder: its scenes, jobs and runs; answered while a scene is evaluated, too."""

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final

from tol3d.apps.workbench.attempt import RUNS
from tol3d.apps.workbench.jobs import Jobs
from tol3d.apps.workbench.place import FolderLock
from tol3d.apps.workbench.standing import Job
from tol3d.apps.workbench.words import UnfitError, words_of
from tol3d.apps.workbench.workspace import Told, Workspace, digest
from tol3d.errors import InputError
from tol3d.import_path import named

KEPT_ANSWER: Final = "tol3d.apps.workbench.answer:kept_answer"  # loads analyses: seconds
RUNS_OF: Final = "tol3d.apps.workbench.made_runs:runs_of"  # loads pyarrow
DELETE_RUN: Final = "tol3d.apps.workbench.made_runs:delete_run"


@dataclass(eq=False)
class FolderQuestions:
    """Answers on a folder.

    Args:
        workspace: the folder.
        lock: the right to write in it.
        trust_parts, run_builders: as `tol3d run` has them.
    """

    workspace: Workspace
    lock: FolderLock
    trust_parts: bool = False
    run_builders: bool = False
    queue: Jobs = field(init=False)

    def __post_init__(self) -> None:
        self.queue = Jobs(self.lock)
        self.queue.drop_oldest()

    def folder(self, asked: Told) -> Told:
        """The scenes of the folder."""
        del asked
        return {
            "folder": self.workspace.folder.name,
            "scenes": [*self.workspace.scenes],
            "first": self.workspace.first or self.workspace.last,
            "listed": self._listed,
            "read_only": self.lock.refusal,
        }

    @property
    def _listed(self) -> str:
        """Name of the list of scenes, by which the page sees that it changes."""
        return digest("\n".join(self.workspace.scenes).encode())

    def changed(self, asked: Told) -> Told:
        """Names of the content of a scene's file, "" where it is gone, and of the list of scenes."""
        path = self.workspace.scenes.get(str(asked["scene"]))
        try:
            content = "" if path is None else digest(path.read_bytes())
        except OSError:  # it goes at this moment
            content = ""
        return {"digest": content, "listed": self._listed}

    # jobs -----------------------------------------------------------------------------------------

    def jobs(self, asked: Told) -> Told:
        """Jobs of the folder as they stand, the newest first."""
        del asked
        return {"jobs": [_told(own) for own in reversed(self.queue.list())]}

    def start(self, asked: Told) -> Told:
        """Run a scene, as `tol3d run` does; or the argument that is refused."""
        return self._started(asked, "run")

    def analyse(self, asked: Told) -> Told:
        """Ask an analysis of a scene by its file's tolerances; or the argument that is refused."""
        return self._started(asked, str(asked["kind"]))

    def _started(self, asked: Told, kind: Any) -> Told:
        path = self.workspace.scene(str(asked["scene"]))
        trusted = {"trust_parts": self.trust_parts, "run_builders": self.run_builders}
        try:
            words = words_of(kind, dict(asked.get("fields") or {}))
        except UnfitError as error:
            return {"refused": {"argument": error.argument, "message": error.sentence or str(error)}}
        if kind == "run":
            return _told(self.queue.start(path, trials=words.get("trials"), **trusted))
        return _told(self.queue.analyse(path, kind, words, **trusted))

    def cancel(self, asked: Told) -> Told:
        """End a job in order: what it has made is kept."""
        return _told(self.queue.cancel(str(asked["id"])))

    def resume(self, asked: Told) -> Told:
        """Let a job go on from where it stopped."""
        trusted = {"trust_parts": self.trust_parts, "run_builders": self.run_builders}
        return _told(self.queue.resume(str(asked["id"]), **trusted))

    def delete(self, asked: Told) -> Told:
        """Delete a job that has ended; with the run that is named, if one is, in `runs`."""
        job, run = self.queue.job(str(asked["id"])), str(asked.get("run") or "")
        if run:
            self.lock.demand()
            if job.state != "done" or job.run is None or job.run.name != run:
                raise InputError(f"job {job.id}: expected its own finished run, got {run!r}")
            if any(own.run == job.run for own in self.queue.working):
                raise InputError(f"{RUNS}/{run}: another job works on it")
            named(DELETE_RUN)(run, self.workspace.folder)
        self.queue.delete(job.id)
        return {}

    def runs(self, asked: Told) -> Told:
        """Finished runs of a scene, the newest first."""
        found = named(RUNS_OF)(self.workspace.scene(str(asked["scene"])), self.workspace.folder)
        return {"runs": [asdict(own) for own in found]}

    def report(self, asked: Told) -> Path | Told:
        """File of the report of a job's run, or of a run by its name; the job that makes it, while it does."""
        scene, run = str(asked["scene"]), asked.get("run")
        found = self.queue.report_of(str(run), scene) if run else self.queue.report(str(asked["id"]))
        return found if isinstance(found, Path) else _told(found)

    def answer(self, asked: Told) -> Told:
        """A finished analysis as reports show it."""
        job = self.queue.job(str(asked["id"]))
        kept = named(KEPT_ANSWER)(self.queue.answer(job.id), job.kind, str(asked.get("title") or job.scene))
        return {"html": kept.html, "job": _told(job)}

    def numbers(self, asked: Told) -> Path:
        """File of the numbers of a finished analysis."""
        return self.queue.numbers(str(asked["id"]))


def _told(job: Job) -> dict[str, Any]:
    """A job for the page."""
    told = asdict(job) | {"run": job.run.name if job.run else ""}
    return told | {"goes_on": job.goes_on}
