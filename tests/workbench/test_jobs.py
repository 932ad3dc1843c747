"""Jobs outlive the app, are cancelled and resumed without a loss, and obey no file that a stranger wrote."""

import inspect
import json
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, get_args

import numpy as np
import pytest
from app_folders import HANGS, ORDER, left_attempt, until
from places import SPUR_PAIR

from tol3d import InputError, Overrides, RunError, load_scene, open_run, run_scene
from tol3d.analyses import answers
from tol3d.apps.workbench import job as job_module
from tol3d.apps.workbench import jobs as jobs_module
from tol3d.apps.workbench.answer import NAMES, keep_answer, kept_answer
from tol3d.apps.workbench.asked_analysis import OF_STUDY
from tol3d.apps.workbench.attempt import ANSWER, JOBS, Attempt, Order, Progress
from tol3d.apps.workbench.jobs import Analysis, Jobs
from tol3d.apps.workbench.place import APP, FolderLock
from tol3d.apps.workbench.standing import Job
from tol3d.apps.workbench.words import WORDS
from tol3d.errors import MechanismError
from tol3d.report import page_html
from tol3d.study.results import task

SCENE = Path("spur_pair.yaml")
BLOCK = 2000  # trials
TRIALS = 20 * BLOCK

# a job's process with small blocks, each made to last 0.1 s on the one core that it sees, whatever the machine; it has
# all the time to end in order
SLOW_BLOCKS = f"""
import os, sys, time
from tol3d.apps.workbench import job, monitor
monitor.PATIENCE_S = {HANGS}
os.cpu_count = lambda: 1
really = job.named
def named(path):
    from tol3d.study.results import task
    task.BLOCK_TRIALS = {BLOCK}
    made = task.columns_of
    task.columns_of = lambda *arguments: (time.sleep(0.1), made(*arguments))[1]
    return really(path)
job.named = named
job.main(*sys.argv[1:])
"""


def opened(folder: Path) -> Path:
    """A folder with the spur pair."""
    shutil.copy(SPUR_PAIR, folder / SCENE)
    return folder


def blocks(folder: Path) -> int:
    return len(list((folder / "runs" / "spur_pair.partial" / "trials").glob("*.parquet")))


@dataclass(frozen=True)
class Story:
    """A run that was killed, resumed, cancelled and resumed, a job that waited for it, and an analysis."""

    folder: Path
    jobs: Jobs
    begun: Job
    other_waits: Job
    other_cancelled: Job
    seen_elsewhere: tuple[Job, ...]
    killed: Job
    kept_by_killed: int
    resumed: Job
    cancelled: Job
    cancelled_at_once: bool
    cancelled_ended_with: int | None
    kept_by_cancelled: int
    seen_later: tuple[Job, ...]
    end: Job
    analysis: Job
    answer: Path
    refusals: tuple[str, ...]


def refused(*calls: Callable[[], object]) -> tuple[str, ...]:
    """Messages of calls that are refused."""
    found = []
    for call in calls:
        with pytest.raises(InputError) as error:
            call()
        found.append(str(error.value))
    return tuple(found)


@pytest.fixture(scope="module")
def story(tmp_path_factory: pytest.TempPathFactory) -> Story:
    folder = opened(tmp_path_factory.mktemp("story"))
    started: list[subprocess.Popen[bytes]] = []
    really = subprocess.Popen

    def noted(*arguments: Any, **options: Any) -> subprocess.Popen[bytes]:
        started.append(really(*arguments, **options))
        return started[-1]

    lock = FolderLock(folder)
    jobs = Jobs(lock)
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)  # as of an app that a shell started by `&`
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(subprocess, "Popen", noted)
        patch.setattr(jobs_module, "PATIENCE_S", HANGS)
        patch.setattr(jobs_module, "COMMAND", (sys.executable, "-P", "-c", SLOW_BLOCKS))
        begun = jobs.start(SCENE, trials=TRIALS)
        other = jobs.start(SCENE, trials=5)
        until(lambda: jobs.job(begun.id).done >= BLOCK)
        other_waits = jobs.job(other.id)
        elsewhere = Jobs(FolderLock(folder))
        seen_elsewhere = elsewhere.list()
        refusals = refused(lambda: elsewhere.start(SCENE), lambda: elsewhere.cancel(begun.id))
        started[0].kill()
        started[0].wait(HANGS)
        jobs.cancel(other.id)
        killed, kept_by_killed, other_cancelled = jobs.job(begun.id), blocks(folder), jobs.job(other.id)
        resumed = jobs.resume(begun.id)
        until(lambda: jobs.job(begun.id).of > 0)
        started[-1].send_signal(signal.SIGSTOP)  # so that it cannot end
        cancelled = jobs.cancel(begun.id)
        cancelled_at_once = started[-1].poll() is None
        started[-1].send_signal(signal.SIGCONT)
        cancelled_ended_with = started[-1].wait(HANGS)
        kept_by_cancelled = blocks(folder)
        jobs.resume(begun.id)
        analysis = jobs.analyse(SCENE, "what_if", {"set": {"centre distance": "±10 um"}, "quick": True})
        lock.release()
        later = Jobs(FolderLock(folder))
        seen_later = later.list()
        until(lambda: later.job(analysis.id).state not in ("waiting", "running"))
        answer = later.answer(analysis.id)
        refusals += refused(
            lambda: later.cancel(begun.id), lambda: later.resume(begun.id), lambda: later.answer("0001")
        )
    signal.signal(signal.SIGINT, before)
    return Story(
        folder,
        later,
        begun,
        other_waits,
        other_cancelled,
        seen_elsewhere,
        killed,
        kept_by_killed,
        resumed,
        cancelled,
        cancelled_at_once,
        cancelled_ended_with,
        kept_by_cancelled,
        seen_later,
        later.job(begun.id),
        later.job(analysis.id),
        answer,
        refusals,
    )


def test_a_killed_job_is_interrupted_and_keeps_its_blocks(story: Story) -> None:
    assert (story.killed.state, story.killed.id) == ("interrupted", story.begun.id)
    assert 0 < story.kept_by_killed < TRIALS // BLOCK
    assert BLOCK <= story.killed.done < TRIALS == story.killed.of


def test_a_cancelled_job_keeps_its_blocks_and_its_caller_does_not_wait(story: Story) -> None:
    assert (story.cancelled.state, story.end.state) == ("cancelled", "done")
    assert story.cancelled_at_once
    assert story.cancelled_ended_with == 0
    assert story.kept_by_killed <= story.kept_by_cancelled < TRIALS // BLOCK


def test_a_resumed_run_goes_on_to_the_same_bits(story: Story, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(task, "BLOCK_TRIALS", BLOCK)
    assert story.resumed.state in ("waiting", "running")
    assert (story.end.done, story.end.of) == (TRIALS, TRIALS)
    assert story.end.run == story.folder / "runs" / "spur_pair"
    found = open_run(story.end.run)
    whole = run_scene(SPUR_PAIR, overrides=Overrides(trials=TRIALS), out=story.folder / "whole")
    assert found.summary["timing"]["resumed_trials"] >= story.kept_by_cancelled * BLOCK
    assert found.summary["measures"] == whole.summary["measures"]
    resumed, columns = found.columns(), whole.columns()
    assert resumed.keys() == columns.keys()
    assert all(np.array_equal(resumed[name], columns[name]) for name in columns)


def test_jobs_take_turns(story: Story) -> None:
    assert (story.other_waits.state, story.other_cancelled.state) == ("waiting", "cancelled")
    assert [job.state for job in story.seen_later[1:]] == ["cancelled", "waiting"]
    assert story.analysis.started >= story.end.started


def test_another_app_sees_the_jobs_and_only_reads(story: Story) -> None:
    first, second = story.seen_elsewhere
    assert (first.id, first.state, first.kind, first.scene) == (story.begun.id, "running", "run", "spur_pair.yaml")
    assert (second.state, second.asked) == ("waiting", {"trials": 5})
    assert first.done >= BLOCK
    only_reads = f"{story.folder.resolve()}: another tol3d app has it open and writes there; this one only reads"
    assert story.refusals[:2] == (only_reads, only_reads)


def test_what_has_ended_is_neither_cancelled_nor_resumed(story: Story) -> None:
    assert story.refusals[2:] == (
        "job 0001: expected one that goes on, this one is done",
        "job 0001: expected one that has stopped, this one is done",
        "job 0001: expected a finished analysis, this one is run, done",
    )


def test_an_answer_is_kept_as_the_analysis_gives_it(story: Story) -> None:
    assert (story.analysis.state, story.analysis.message) == ("done", "")
    asked = answers.what_if(SPUR_PAIR, set={"centre distance": "±10 um"}, quick=True)
    kept = kept_answer(story.answer, "what_if", "spur pair at the drive end")
    assert page_html(kept.page) == page_html(asked.page)
    assert story.answer.with_suffix(".csv").read_text("utf-8") == asked.csv()
    assert kept.charts.rows


@pytest.mark.slow
@pytest.mark.parametrize("kind", get_args(Analysis))
def test_each_answer_is_shown_again_as_it_was(kind: Analysis, tmp_path: Path) -> None:
    words: dict[str, Any] = {
        "what_if": {"set": {"centre distance": "±10 um"}},
        "sweep": {"vary": ["parts.pinion.teeth=17,28"]},
    }
    asked = getattr(answers, kind)(SPUR_PAIR, **words.get(kind, {}))
    keep_answer(asked, tmp_path)
    kept = kept_answer(tmp_path / ANSWER, kind, "spur pair at the drive end")
    assert page_html(kept.page) == page_html(asked.page)
    assert len(kept.charts.rows) == len(asked.charts().rows) > 0


def test_a_sweep_keeps_its_variants_where_the_command_does(tmp_path: Path) -> None:
    jobs = Jobs(FolderLock(opened(tmp_path)))
    asked = jobs.analyse(SCENE, "sweep", {"vary": ["parts.pinion.teeth=27,28"], "trials": 50})
    until(lambda: not jobs.job(asked.id).goes_on)
    assert (jobs.job(asked.id).state, jobs.job(asked.id).words) == ("done", "2 of 2 variants")
    kept = kept_answer(jobs.answer(asked.id), "sweep", "spur pair at the drive end")
    assert len(kept.page.tables[0].rows) == 2
    again = answers.sweep(
        SPUR_PAIR,
        {"parts.pinion.teeth": "27,28"},
        out=tmp_path / "runs" / "spur_pair-sweep",
        overrides=Overrides(trials=50),
    )
    assert page_html(again.page) == page_html(kept.page)
    assert jobs.numbers(asked.id).read_text("utf-8") == again.csv()
    assert len([*(tmp_path / "runs" / "spur_pair-sweep").glob("variant-*")]) == 2


def test_a_damaged_answer_is_refused(story: Story, tmp_path: Path) -> None:
    found = json.loads(story.answer.read_text("utf-8"))
    damaged = tmp_path / "answer.json"
    damaged.write_text(json.dumps(found | {"more": "<script>"}), "utf-8")
    with pytest.raises(RunError, match="it is damaged, or of another tol3d; ask for what-if again"):
        kept_answer(damaged, "what_if", "spur pair")


def test_a_report_is_made_by_a_job_once(story: Story) -> None:
    jobs = story.jobs
    (story.folder / "wrong.yaml").write_text(SPUR_PAIR.read_text("utf-8").replace("teeth: 28", "teeth: many"), "utf-8")
    wrong = jobs.start(Path("wrong.yaml"))  # the report waits for it
    making = jobs.report(story.begun.id)
    assert isinstance(making, Job)
    assert (making.kind, making.state, making.scene) == ("report", "waiting", "spur_pair.yaml")
    assert jobs.report_of("spur_pair") == replace(making, state=jobs.job(making.id).state)
    jobs.cancel(making.id)
    until(lambda: jobs.job(wrong.id).state == "failed")
    assert jobs.job(wrong.id).message == refused(lambda: load_scene(story.folder / "wrong.yaml"))[0]
    assert story.end.run is not None
    (story.end.run / "report.html").touch()
    assert jobs.report(story.begun.id) == story.end.run / "report.html"


@pytest.mark.slow
def test_a_report_is_the_run_s_own(tmp_path: Path) -> None:
    jobs = Jobs(FolderLock(opened(tmp_path)))
    run = jobs.start(SCENE, trials=50)
    until(lambda: jobs.job(run.id).state == "done")
    jobs.report(run.id)
    until(lambda: isinstance(jobs.report(run.id), Path))
    path = jobs.report(run.id)
    assert isinstance(path, Path)
    assert "spur pair at the drive end" in path.read_text("utf-8")
    assert open_run(path.parent).manifest.foreign() == []


def test_arguments_are_those_of_the_analyses_but_files_and_programs() -> None:
    others = {"subject", "activity", "warn", "trust_parts", "run_builders", "cost"}
    others |= {"scene", "overrides", "workers", "out", "picture"}
    for kind in get_args(Analysis):
        study = {*OF_STUDY} if kind == "sweep" else set()
        assert set(WORDS[kind]) == {*inspect.signature(getattr(answers, kind)).parameters} - others | study
    assert set(NAMES) == set(get_args(Analysis))


@pytest.mark.parametrize(
    ("kind", "words", "message"),
    [
        ("run", {}, "expected what_if, effects, changes, allocate, rare, methods, sweep, got 'run'"),
        ("allocate", {"cost": "/etc/passwd"}, "allocate: expected ppm, ppk, measure, bounds, bound, freeze, stays"),
        ("effects", {"run_builders": True}, "effects: expected measure, base, seed, position, shapley, got 'run_bui"),
        ("effects", {"base": True}, "effects: base: expected a whole number from 2 on, got True"),
        (
            "changes",
            {"accept": float("nan")},
            "changes: accept: expected builds of a million, from 0 to below 1000000, got nan",
        ),
        ("what_if", {"set": {"centre distance": [1]}}, "what_if: set: expected texts or numbers by name, got"),
        ("what_if", {"quick": 1}, "what_if: quick: expected true or false, got 1"),
        ("allocate", {"freeze": "play"}, "allocate: freeze: expected a list of texts, got 'play'"),
    ],
)
def test_other_arguments_are_refused(kind: Any, words: Any, message: str, tmp_path: Path) -> None:
    jobs = Jobs(FolderLock(opened(tmp_path)))
    with pytest.raises(InputError) as error:
        jobs.analyse(SCENE, kind, words)
    assert str(error.value).startswith(message)
    assert jobs.list() == ()


def test_no_link_leads_out_of_the_folder(tmp_path: Path) -> None:
    folder, outside = tmp_path / "folder", tmp_path / "outside"
    folder.mkdir()
    outside.mkdir()
    shutil.copy(SPUR_PAIR, outside / "linked.yaml")
    (folder / "linked.yaml").symlink_to(outside / "linked.yaml")
    jobs = Jobs(FolderLock(opened(folder)))
    for scene in ("linked.yaml", "../outside/linked.yaml"):
        assert refused(lambda scene=scene: jobs.start(Path(scene)))[0].endswith(  # type: ignore[misc]
            f"leads out of {folder}; expected a place in it, without links out"
        )


@pytest.mark.parametrize("link", ["runs", "runs/spur_pair", "runs/spur_pair.partial"])
def test_a_run_that_would_lead_out_of_the_folder_is_refused(link: str, tmp_path: Path) -> None:
    folder, outside = tmp_path / "folder", tmp_path / "outside"
    folder.mkdir()
    outside.mkdir()
    jobs = left(folder, replace(ORDER, kind="run", words={"trials": 5}, run="spur_pair"))
    (folder / link).parent.mkdir(exist_ok=True)
    (folder / link).symlink_to(outside)
    job_module.main(str(folder), "1")
    (job,) = jobs.list()
    assert job.state == "failed"
    assert f"leads out of {folder}; expected a place in it, without links out" in job.message
    assert list(outside.iterdir()) == []
    assert "leads out of" in refused(lambda: jobs.report_of("spur_pair" if link == "runs" else Path(link).name))[0]


def test_the_app_s_own_place_does_not_lead_out_either(tmp_path: Path) -> None:
    folder, outside = tmp_path / "folder", tmp_path / "outside"
    folder.mkdir()
    outside.mkdir()
    (folder / ".tol3d").symlink_to(outside)
    assert "leads out of" in refused(lambda: FolderLock(folder))[0]
    assert list(outside.iterdir()) == []
    assert refused(lambda: FolderLock(tmp_path / "none"))[0].endswith("none: expected a folder, got no such folder")


def test_a_lock_that_is_a_link_is_not_opened(tmp_path: Path) -> None:
    (opened(tmp_path) / APP).mkdir(parents=True)
    (tmp_path / APP / "lock").symlink_to(tmp_path / SCENE)
    assert refused(lambda: FolderLock(tmp_path))[0].endswith("lock: expected a file, got a link")
    assert (tmp_path / SCENE).read_bytes() == SPUR_PAIR.read_bytes()


def test_the_folder_goes_to_the_next_app_when_the_first_lets_it_go(tmp_path: Path) -> None:
    with FolderLock(opened(tmp_path)) as first:
        second = FolderLock(tmp_path)
        assert (first.refusal, second.refusal != "") == ("", True)
    second.acquire()
    assert second.refusal == ""
    assert refused(lambda: Jobs(first).start(SCENE))[0].endswith("this app has closed it")


def test_a_folder_that_cannot_be_written_is_read(tmp_path: Path) -> None:
    (tmp_path / ".tol3d").write_text("a file")
    lock = FolderLock(tmp_path)
    assert "nothing can be kept there, so this app only reads" in lock.refusal
    assert Jobs(lock).list() == ()


def left(folder: Path, order: Order, progress: Progress | None = None) -> Jobs:
    """Jobs of a folder in which somebody left an attempt."""
    left_attempt(folder, order, progress)
    return Jobs(FolderLock(opened(folder)))


@pytest.mark.parametrize(
    ("order", "message"),
    [
        (replace(ORDER, words={"cost": "/etc/passwd"}), "allocate: expected ppm, ppk, "),
        (replace(ORDER, scene="../other.yaml"), "leads out of"),
        (
            replace(ORDER, kind="run", words={"trials": "many"}),
            "run: trials: expected a whole number from 1 on, got 'many'",
        ),
    ],
)
def test_an_order_that_a_stranger_wrote_is_looked_at_before_it_is_resumed(
    order: Order, message: str, tmp_path: Path
) -> None:
    jobs = left(tmp_path, order)
    assert [job.state for job in jobs.list()] == ["interrupted"]
    assert message in refused(lambda: jobs.resume("0001"))[0]


def test_a_run_whose_process_was_killed_after_its_end_is_not_made_again(tmp_path: Path) -> None:
    order = replace(ORDER, kind="run", words={"trials": 5})
    jobs = left(tmp_path, order)
    job_module.main(str(tmp_path), "1")
    summary = tmp_path / "runs" / "spur_pair" / "summary.json"
    made = summary.stat()
    Attempt(tmp_path, 2).place.mkdir()
    Attempt(tmp_path, 2).write(replace(order, run="spur_pair"))
    job_module.main(str(tmp_path), "2")
    assert [(job.state, job.done, job.of) for job in jobs.list()] == [("done", 5, 5)]
    assert summary.stat() == made


@pytest.mark.parametrize("run", ["../elsewhere", "..", "/etc"])
def test_a_run_of_another_place_is_not_seen(run: str, tmp_path: Path) -> None:
    assert left(tmp_path, replace(ORDER, run=run)).list() == ()


def test_attempts_of_another_version_are_left_alone(tmp_path: Path) -> None:
    jobs = left(tmp_path, ORDER)
    order = tmp_path / JOBS / "0001" / "order.json"
    order.write_text(order.read_text("utf-8").replace('"version": 1', '"version": 2'), "utf-8")
    assert jobs.list() == ()
    assert refused(lambda: jobs.job("0001")) == ("job '0001': there is none; there are: none",)


def test_a_run_of_a_changed_scene_is_not_resumed(tmp_path: Path) -> None:
    jobs = left(tmp_path, replace(ORDER, kind="run"), Progress("cancelled", run="spur_pair", sha256="0" * 64))
    assert "was changed since this run began" in refused(lambda: jobs.resume("0001"))[0]


@pytest.mark.parametrize("allowed", [{}, {"run_builders": True}, {"trust_parts": True}])
def test_the_app_alone_says_what_a_scene_may_do(
    allowed: dict[str, bool], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not the order that lies in the folder, and no argument of a page."""
    commands: list[list[str]] = []

    def noted(command: list[str], **options: Any) -> subprocess.Popen[bytes]:
        commands.append(command)
        return really([sys.executable, "-c", "1 / 0"], **options)

    really = subprocess.Popen
    jobs = Jobs(FolderLock(opened(tmp_path)))
    with monkeypatch.context() as patch:
        patch.setattr(subprocess, "Popen", noted)
        job = jobs.analyse(SCENE, "effects", {}, **allowed)
        assert (job.state, job.message.partition(":")[0]) == ("failed", "its process ended with 1 as it started")
        jobs.resume(job.id, **allowed)
    asked: list[Mapping[str, bool]] = []

    def work(attempt: Attempt, order: Order, monitor: object, trusted: Mapping[str, bool]) -> str:
        asked.append(trusted)
        return "no remark"

    monkeypatch.setattr(job_module, "named", lambda path: work)
    for command in commands:
        job_module.main(*command[len(jobs_module.COMMAND) :])
    assert asked == 2 * [{"trust_parts": False, "run_builders": False} | allowed]
    assert (jobs.job(job.id).state, jobs.job(job.id).message) == ("done", "no remark")


@pytest.mark.parametrize(
    ("error", "state", "message"),
    [
        (InputError("spur_pair.yaml: wrong"), "failed", "spur_pair.yaml: wrong"),
        (MechanismError("their fault"), "failed", "their fault"),
        (MemoryError(), "failed", "out of memory: the input is not at fault"),
        (
            ZeroDivisionError("by 0"),
            "failed",
            "a fault in tol3d, not in your scene: ZeroDivisionError: by 0; please report",
        ),
        (KeyboardInterrupt(), "cancelled", ""),
    ],
)
def test_a_job_says_how_it_ended(
    error: BaseException, state: str, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def work(*words: object) -> None:
        raise error

    jobs = left(tmp_path, ORDER)
    monkeypatch.setattr(job_module, "named", lambda path: work)
    job_module.main(str(tmp_path), "1")
    (job,) = jobs.list()
    assert job.state == state
    assert job.message.startswith(message)
    assert (job.message == "") == (message == "")


def test_a_process_that_goes_on_after_its_end_is_killed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jobs_module, "PATIENCE_S", 0.01)
    with subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"], start_new_session=True) as process:
        jobs_module._kill(process)
    assert process.returncode == -signal.SIGKILL


DEAF = """
import sys, threading
from pathlib import Path
from tol3d.apps.workbench import monitor
from tol3d.apps.workbench.attempt import Attempt
monitor.PATIENCE_S = 0.5
with monitor.Monitor(Attempt(Path(sys.argv[1]), 1)):
    print("waits", flush=True)
    try:
        threading.Event().wait()
    except KeyboardInterrupt:
        print("interrupted", flush=True)
    threading.Event().wait()
"""


def test_a_job_that_waits_for_others_is_interrupted_and_one_that_does_not_hear_ends(tmp_path: Path) -> None:
    left(tmp_path, ORDER)
    with subprocess.Popen([sys.executable, "-c", DEAF, str(tmp_path)], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "waits\n"
        Attempt(tmp_path, 1).cancel()
        assert process.stdout.read() == "interrupted\n"
    assert process.returncode == 137
