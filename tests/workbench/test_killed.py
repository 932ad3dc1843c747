"""An app that is killed or interrupted at any moment: scenes stay whole, what-ifs are there, jobs go on or resume."""

import os
import pty
import signal
import subprocess
import sys
import time
from contextlib import suppress
from http.client import HTTPException
from pathlib import Path
from threading import Thread

import pytest
from app_folders import HANGS, posted, started, until
from places import SPUR_PAIR

from tol3d.apps.workbench.attempt import attempts
from tol3d.apps.workbench.jobs import Jobs
from tol3d.apps.workbench.place import FolderLock
from tol3d.apps.workbench.workspace import Workspace

pytestmark = pytest.mark.slow

TEXT = SPUR_PAIR.read_text("utf-8").replace("trials: 2000", "trials: 200")
WIDER = {"centre distance": "x2"}
KEPT = TEXT.replace("-20 um, upper: 20 um", "-40 um, upper: 40 um")
PAIR = {"scene": "pair.yaml", "measure": "normal backlash"}
LONG = "50000000"  # trials: minutes, so that a run goes on until it is ended


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "pair.yaml").write_text(TEXT, "utf-8")
    return tmp_path


@pytest.mark.parametrize("after", [0.01, 0.31])
def test_an_app_that_is_killed_while_it_writes_leaves_a_whole_scene_and_whole_notes(after: float, folder: Path) -> None:
    """It saves, keeps and notes as fast as it can; what is half written has another name."""
    ended = False

    def write(origin: str, token: str) -> None:
        with suppress(OSError, HTTPException):
            while not ended:
                digest = posted(origin, token, "changed", PAIR)["digest"]
                posted(origin, token, "keep", {**PAIR, "now": WIDER, "write": True, "digest": digest})
                posted(origin, token, "notes", {**PAIR, "now": WIDER, "beside": [WIDER]})
                digest = posted(origin, token, "changed", PAIR)["digest"]
                posted(origin, token, "save", {**PAIR, "text": TEXT, "digest": digest})

    with started(folder) as (process, origin, token):
        posted(origin, token, "card", PAIR)
        writing = Thread(target=write, args=(origin, token))
        writing.start()
        until(lambda: (folder / ".tol3d" / "app" / "pair.yaml.json").exists())
        time.sleep(after)
        process.kill()
        process.wait()
        ended = True
        writing.join()
    assert (folder / "pair.yaml").read_text("utf-8") in (TEXT, KEPT)
    assert [*Workspace.of(folder).scenes] == ["pair.yaml"]
    with started(folder) as (_, origin, token):
        assert posted(origin, token, "scene", PAIR)["problems"] == []
        assert posted(origin, token, "scene", PAIR)["notes"]["now"] in ({}, WIDER)
        until(lambda: posted(origin, token, "card", PAIR)["done"] == 200)


def test_jobs_of_an_app_that_is_killed_end_and_wait_for_no_app(folder: Path) -> None:
    with started(folder) as (process, origin, token):
        run = posted(origin, token, "start", {**PAIR, "fields": {"trials": "20000"}})
        effects = posted(origin, token, "analyse", {**PAIR, "kind": "effects", "fields": {"base": "64"}})
        assert (run["goes_on"], effects["state"]) == (True, "waiting")
        process.kill()
    with FolderLock(folder) as lock:
        jobs = Jobs(lock)
        until(lambda: not jobs.working)
        assert [(job.state, job.kind) for job in jobs.list()] == [("done", "run"), ("done", "effects")]


def take_terminal() -> None:
    """Make the first input the terminal from which Ctrl-C comes: the first one that a new session opens."""
    os.close(os.open(os.ttyname(0), os.O_RDWR))
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.mark.parametrize(("typed", "goes_on"), [("n\n", False), ("\n", True), ("\x03", True)])
def test_an_app_that_is_interrupted_at_a_terminal_asks_whether_a_run_goes_on(
    typed: str, goes_on: bool, folder: Path
) -> None:
    terminal, own = pty.openpty()
    told = b""

    def wait_for(words: bytes) -> None:
        nonlocal told
        began = time.monotonic()
        while words not in told:
            assert time.monotonic() - began < HANGS, told
            told += os.read(terminal, 1 << 16)

    command = [sys.executable, "-m", "tol3d.cli", "app", "--no-browser", str(folder)]
    process = subprocess.Popen(
        command,
        stdin=own,
        stdout=own,
        stderr=own,
        start_new_session=True,
        preexec_fn=take_terminal,
    )
    try:
        wait_for(b"Ctrl-C ends it")
        address = next(line for line in told.decode().splitlines() if "/#" in line).split()[-1]
        origin, _, token = address.partition("/#")
        posted(origin, token, "start", {**PAIR, "fields": {"trials": LONG}})
        until(lambda: posted(origin, token, "jobs", PAIR)["jobs"][0]["done"] > 0)
        os.write(terminal, b"\x03")
        wait_for(b"leave it running? [Y/n]")
        assert b"run of pair.yaml goes on (" in told
        os.write(terminal, typed.encode())
        assert process.wait(HANGS) == 130
    finally:
        process.kill()
        os.close(own)
        os.close(terminal)
    with FolderLock(folder) as lock:
        (job,) = Jobs(lock).list()
        assert job.state == ("running" if goes_on else "cancelled")
        if goes_on:
            Jobs(lock).cancel(job.id)
        (attempt,) = attempts(folder)
        until(lambda: not attempt.is_alive())
        assert Jobs(lock).list()[0].state == "cancelled"
        assert Jobs(lock).resume(job.id).goes_on
        Jobs(lock).cancel(job.id)
        until(lambda: not any(own.is_alive() for own in attempts(folder)))
