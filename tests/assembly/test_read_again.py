"""A scene that is read again after an edit gives what a process gives that reads it first, bit by bit."""

import hashlib
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
import pytest

from tol3d.scene.bundled import scene_path
from tol3d.simulate import load, simulation_of
from tol3d.study.trials.draws import drawn

TRIALS = 25


def state_of(path: Path) -> list[bytes]:
    """Trials of both methods by a scene's file, and what is known of its measures without trials."""
    simulation = simulation_of(load(path))
    system, trials = simulation.system, drawn(simulation, 0, TRIALS)
    found: list[Any] = [repr(list(system.problems())), trials.deviations]
    for name in ("analytic", "exact"):
        answers = system.method(name, system.materials(name)).answers(trials, system.measures)
        found += [*answers.values.values(), *answers.status.values()]
    for measure in system.measures:
        form = system.closed_form(measure)
        found += [repr((measure, system.describe(measure), form)), repr([own.name for own in system.acting(measure)])]
    return [own.tobytes() if isinstance(own, np.ndarray) else own.encode() for own in found]


def forget() -> None:
    """Leave nothing of what scenes before have made in this process."""
    rooms = tuple(f"tol3d.{room}." for room in ("assembly", "cad"))
    for own in [own for name in [*sys.modules] if name.startswith(rooms) for own in vars(sys.modules[name]).values()]:
        if isinstance(own, WeakKeyDictionary):
            own.clear()
        elif callable(forgotten := getattr(own, "cache_clear", None)):
            forgotten()


def edited(name: str, folder: Path, edit: tuple[str, str]) -> Iterator[Path]:
    """A bundled scene in a folder of its own: as it is but for a shorter path, then with one edit."""
    source = scene_path(name)
    for file in source.parent.glob("*.st*p"):
        shutil.copy(file, folder)
    path, text = folder / source.name, source.read_text("utf-8").replace("steps: 24", "steps: 3")
    path.write_text(text, "utf-8")
    yield path
    changed, count = re.subn(*edit, text, count=1)
    assert count == 1
    path.write_text(changed, "utf-8")
    yield path


EDITS = {
    "a law": ("slider_crank", (r"lower: -20 um, upper: 20 um", "lower: -25 um, upper: 20 um")),
    "a zone": ("box_with_discs", (r"zone: \{diameter: 50 um\}", "zone: {diameter: 60 um}")),
    "a place": ("slider_crank", (r"pin: \{kind: point, at: \[0 mm, 40 mm", "pin: {kind: point, at: [0 mm, 40.001 mm")),
}


@pytest.mark.parametrize("what", EDITS)
def test_an_edited_scene_read_again_is_as_read_first(what: str, tmp_path: Path) -> None:
    name, edit = EDITS[what]
    forget()
    *_, path = edited(name, tmp_path, edit)
    cold = state_of(path)
    forget()
    states = [state_of(path) for path in edited(name, tmp_path, edit)]
    assert states[1] == cold
    assert states[0] != cold


ELSEWHERE = f"""
import sys
from pathlib import Path
sys.path.insert(0, {str(Path(__file__).parent)!r})
from test_read_again import state_of, told
print(told(state_of(Path(sys.argv[1]))))
"""


def told(state: list[bytes]) -> str:
    """A state in one word."""
    return hashlib.sha256(repr(state).encode()).hexdigest()


@pytest.mark.parametrize(
    ("name", "edit"),
    [
        ("bracket_in_box", (r"zone: \{diameter: 0\.381 mm\}", "zone: {diameter: 0.4 mm}")),
        ("stewart", (r"lower: -20 um, upper: 20 um", "lower: -25 um, upper: 20 um")),
    ],
)
def test_an_edited_scene_read_again_is_that_of_a_fresh_process(
    name: str, edit: tuple[str, str], tmp_path: Path
) -> None:
    states = [told(state_of(path)) for path in edited(name, tmp_path, edit)]
    path = tmp_path / f"{name}.yaml"
    words = [sys.executable, "-c", ELSEWHERE, str(path)]
    done = subprocess.run(words, stdout=subprocess.PIPE, text=True, check=True, env=os.environ)
    assert states[1] == done.stdout.split()[-1]
    assert states[0] != states[1]
