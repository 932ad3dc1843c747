"""Sliders land on round numbers, which the card, the estimate and the kept line share."""

import math
import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from places import SCENES

from tol3d.apps.workbench.card import STEP, numbers_of
from tol3d.apps.workbench.place import FolderLock
from tol3d.apps.workbench.questions import Questions
from tol3d.apps.workbench.round_numbers import ALIKE
from tol3d.apps.workbench.session import Session
from tol3d.apps.workbench.workspace import Workspace

CENTRE = "centre distance"


@pytest.fixture(scope="module")
def questions(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Questions]:
    folder = tmp_path_factory.mktemp("round")
    for name in ("spur_pair", "door"):
        shutil.copy(SCENES / f"{name}.yaml", folder)
    with FolderLock(folder) as lock:
        own = Questions(Workspace.of(folder), lock)
        yield own
        own.close()


def words(questions: Questions, line: str, step: int, scene: str = "spur_pair") -> str:
    """Words of a slider that is so many steps from the scene's width."""
    asked = {"scene": f"{scene}.yaml", "line": line, "words": f"x{STEP**step:.4g}"}
    return str(questions.rounded(asked)["words"])


@pytest.mark.parametrize(
    ("line", "step", "wanted"),
    [
        (CENTRE, 37, "±28.8 µm"),  # 20 µm × 1.445 = 28.9 µm: in fifths
        (CENTRE, -20, "±16.4 µm"),
        ("pinion tooth thickness", 10, "-30.6 µm..-18.4 µm"),
        ("wheel eccentricity", 10, "5.7 µm"),
    ],
)
def test_a_slider_lands_on_round_numbers(line: str, step: int, wanted: str, questions: Questions) -> None:
    assert words(questions, line, step) == wanted


@pytest.mark.parametrize("scene", ["spur_pair", "door"])
def test_no_step_stands_still_and_each_is_near_its_factor(scene: str, questions: Questions) -> None:
    session = questions.session(f"{scene}.yaml")
    for line, (name, *_) in session.response.lines.items():
        scope = session.response.scope(line).factors
        assert scope is not None
        ends = (math.ceil(math.log(own) / math.log(STEP)) for own in np.clip(scope, 0.25, 4.0) * (1.01, 0.99))
        before = -math.inf
        for step in range(*ends):
            if step == 0:
                continue
            draw = session.changed({line: words(questions, line, step, scene)}).drawn_by(name)
            numbers = numbers_of(draw)
            width = numbers[-1] - numbers[0] if len(numbers) > 1 else numbers[0]
            assert width > before, (line, step)
            wanted = STEP**step * session.response.drawn_by(name).distribution.sigma
            assert draw.distribution.sigma == pytest.approx(wanted, rel=ALIKE), (line, step)
            before = width


def test_a_held_slider_is_estimated_at_the_number_that_it_will_have(questions: Questions) -> None:
    asked = {"scene": "spur_pair.yaml", "measure": "normal backlash"}
    held = questions.estimate({**asked, "now": {CENTRE: "x1.445"}, "held": CENTRE})
    assert held["written"] == {CENTRE: "±28.8 µm"}
    while "chart" not in held:
        held = questions.estimate({**asked, "now": {CENTRE: "x1.445"}, "held": CENTRE})
    assert held["chart"] == questions.estimate({**asked, "now": {CENTRE: "±28.8 µm"}})["chart"]
    typed = questions.estimate({**asked, "now": {CENTRE: "x1.445"}})
    assert typed["written"] == {CENTRE: "±28.9 µm"}, "a factor that is typed is that factor"


def test_a_limit_that_stays_is_not_rounded(tmp_path: Path) -> None:
    text = (SCENES / "spur_pair.yaml").read_text("utf-8")
    law = "{kind: rayleigh, scale: 5.166666666666667 um}"
    (tmp_path / "pair.yaml").write_text(text.replace(law, "{kind: uniform, lower: 0 um, upper: 9.37 um}"), "utf-8")
    session = Session.opened(tmp_path / "pair.yaml", trust_parts=False, run_builders=False)
    with FolderLock(tmp_path) as lock:
        own = Questions(Workspace.of(tmp_path), lock, sessions={"pair.yaml": session})
        assert words(own, "wheel eccentricity", 10, "pair") == "0 µm..10.36 µm"
        own.close()
