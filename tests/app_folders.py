"""Folders for tests of the local app: a stranger's scenes in them, jobs that somebody left there, and its command."""

import json
import os
import signal
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

from tol3d.apps.workbench.attempt import Attempt, Order, Progress

HANGS: Final = 300.0  # s; a guard against waiting for ever, no claim
EVIL: Final = "<img src=x onerror=alert(1)>"
HOSTILE: Final = f"""scene: "{EVIL}"
parts:
  "{EVIL} part": {{kind: spur_gear, teeth: 28, module: 2.5 mm, pressure_angle: 20 deg, face_width: 20 mm, bore: 25 mm}}
  wheel: {{kind: spur_gear, teeth: 110, module: 2.5 mm, pressure_angle: 20 deg, face_width: 20 mm, bore: 60 mm}}
tolerances:
  "{EVIL} tolerance":
    {{kind: centre_distance, of: "{EVIL} move", distribution: {{kind: normal, lower: -20 um, upper: 20 um}}}}
moves:
  "{EVIL} move": {{kind: mesh, driver: "{EVIL} part", driven: wheel, centre_distance: 172.5 mm, working_flank: right}}
measures:
  "{EVIL} measure": {{kind: normal_backlash, of: "{EVIL} move", lower_limit: -90 um}}
study: {{trials: 200, seed: 1, sampler: monte_carlo, engine: exact, witness: 0}}
"""
BUILT: Final = """scene: built
parts: {block: {kind: solid, builder: {kind: file, file: ours.py}, features: {A: {kind: plane, face: {name: top}}}}}
moves: {bench: {kind: fix, part: block}}
measures: {gap: {kind: gap, from: block.A, to: block.A, along: [0, 0, 1]}}
"""
"""Names a program that builds a part."""
ORDER: Final = Order("0001", "allocate", "spur_pair.yaml", {}, "2026-11-29T09:00:00+00:00")


def until(found: Callable[[], bool]) -> None:
    """Wait until something is so."""
    began = time.monotonic()
    while not found():
        assert time.monotonic() - began < HANGS
        time.sleep(0.01)


def left_attempt(folder: Path, order: Order, progress: Progress | None = None, number: int = 1) -> Attempt:
    """An attempt that somebody left in a folder, long ago."""
    attempt = Attempt(folder, number)
    attempt.place.mkdir(parents=True)
    attempt.write(order)
    if progress is not None:
        attempt.write(progress)
    os.utime(attempt.place, (0.0, 0.0))
    return attempt


@contextmanager
def started(folder: Path) -> Iterator[tuple[subprocess.Popen[str], str, str]]:
    """The command in a process, its origin and its token."""
    command = [sys.executable, "-m", "tol3d.cli", "app", "--no-browser", str(folder)]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # a shell's `&` has it ignored
    ) as process:  # fmt: skip
        assert process.stdout is not None
        _, _, address = process.stdout.readline().strip().partition(": ")
        origin, _, token = address.partition("/#")
        try:
            yield process, origin, token
        finally:
            process.kill()


def posted(origin: str, token: str, name: str, words: Mapping[str, object]) -> Any:
    """Answer of a started app to the page's own question."""
    headers = {"x-tol3d-token": token, "content-type": "application/json", "origin": origin}
    request = urllib.request.Request(f"{origin}/api/{name}", json.dumps(words).encode(), headers)
    with urllib.request.urlopen(request, timeout=60) as answer:
        return json.loads(answer.read())
