"""A tried tolerance has the numbers of the scene that keeps it, digit for digit: card, `what-if`, run and report.

The scenes: a stack-up with a closed form, an assembly of sums whose trials are a Latin hypercube's, a bent measure, and
fewer trials than a run looks at before it begins.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from html import unescape
from pathlib import Path
from typing import Final

import pytest
from places import SCENES

from tol3d import Overrides, run_scene
from tol3d.analyses.answers import what_if
from tol3d.apps.workbench.place import FolderLock
from tol3d.apps.workbench.questions import Questions
from tol3d.apps.workbench.workspace import Workspace
from tol3d.notebook import write_report
from tol3d.study.runs.summary.judged import JudgedMeasure

WRITTEN: Final = 1e-9
"""Relative: a kept tolerance is written to ten digits."""
CELL = re.compile(r"<t[dh][^>]*>(.*?)</t[dh]>", re.DOTALL)
REPORTED = {
    "mean": "mean",
    "sigma": "sigma",
    "0.135 % quantile": "0.135 to 99.865 %",
    "99.865 % quantile": "0.135 to 99.865 %",
}
"""Rows of a report's table, and those of the card that have their numbers."""


@dataclass(frozen=True)
class Tried:
    """A scene with few trials, of which one tolerance is moved."""

    scene: str
    study: str
    measure: str
    line: str
    factor: float

    @property
    def text(self) -> str:
        """The scene's."""
        return re.sub(r"(?m)^study:.*$", f"study: {{{self.study}}}", (SCENES / f"{self.scene}.yaml").read_text("utf-8"))


CASES = [
    Tried("spur_pair", "trials: 200, seed: 7", "normal backlash", "centre distance", 1.65),
    Tried("door", "trials: 256, seed: 3, sampler: latin_hypercube", "roof gap", "body upper hinge x", 1.37),
    Tried("clutch", "trials: 200, seed: 5", "contact angle", "hub height", 0.7),
    Tried("two_plates", "trials: 40, seed: 2", "slack", "lower face", 1.23),
]


def rows(html: str) -> Iterator[list[str]]:
    """Texts of the cells of each row of a page's tables."""
    for row in re.findall(r"<tr.*?</tr>", html, re.DOTALL):
        yield [unescape(re.sub(r"<[^>]+>", "", cell)) for cell in CELL.findall(row)]


def approx(value: float | list[float | None]) -> object:
    """The same but for the digits that are not written, item by item."""
    if isinstance(value, list):
        return [None if own is None else approx(own) for own in value]
    return pytest.approx(value, rel=WRITTEN)


def statistics(page: str, measure: str) -> dict[str, str]:
    """The 3D simulation's cells in a report's table of a measure, by their rows."""
    section = page.partition(f"<h3>{measure}</h3>")[2].partition("<h3>")[0]
    table = next(own for own in section.split("<table>") if "% quantile" in own)
    head, *others = rows(table)
    heads, *verdicts = rows(page.partition("<h2>verdict</h2>")[2].partition("</table>")[0])
    verdict = dict(zip(heads, next(row for row in verdicts if row[0] == measure), strict=True))
    cells = {row[0].removesuffix(" [µm]"): row[head.index("3D simulation")] for row in others}
    return cells | {key: verdict[key] for key in ("verdict", "fraction out of limits", "Ppk")}


def shown(questions: Questions, case: Tried, now: dict[str, str]) -> dict[str, str]:
    """The card's own numbers, of all trials, by their names."""
    told = questions.card({"scene": "own.yaml", "measure": case.measure, "now": now})
    while told["done"] < told["of"]:
        told = questions.card({"scene": "own.yaml", "measure": case.measure, "now": now})
    return {row[0]: row[1] for row in rows(told["answer"]) if row[0]} | {
        "verdict": re.findall(r'class="verdict[^"]*">(.*?)<', told["answer"])[0]
    }


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.scene)
def test_every_shown_number_is_that_of_the_kept_scene(case: Tried, tmp_path: Path) -> None:
    path = tmp_path / "own.yaml"
    path.write_text(case.text, "utf-8")
    questions = Questions(Workspace.of(path), FolderLock(tmp_path))
    now = {case.line: f"x{case.factor}"}
    tried, scene = shown(questions, case, now), shown(questions, case, {})
    assert tried != scene
    sample = questions.session("own.yaml").evaluated(case.measure, now).sample
    asked = what_if(path, factor={case.line: str(case.factor)}, measure=case.measure, draws=0)
    state = asked.found.measures[case.measure].after
    numbers = {key: getattr(sample, key) for key in ("mean", "sigma", "ppk", "out_ppm", "out_ppm_95")}
    numbers |= {"low": sample.p0_135, "high": sample.p99_865, "verdict": tried["verdict"]}
    for key in numbers.keys() & state.model_fields_set:
        assert getattr(state, key) == numbers[key], key

    told = questions.keep({"scene": "own.yaml", "measure": case.measure, "now": now})
    words = {"scene": "own.yaml", "measure": case.measure, "now": now, "write": True, "digest": told["digest"]}
    questions.keep(words)
    assert path.read_text("utf-8") == asked.scene.text
    assert shown(questions, case, {}) == tried

    run = run_scene(path, overrides=Overrides(witness=0), out=tmp_path / "run")
    summary = run.found.measures[case.measure]
    kept, own = summary.shares.model_dump(), sample.model_dump()
    assert kept.keys() == own.keys()
    for key, value in own.items():
        exact = not isinstance(value, list | float)
        assert kept[key] == (value if exact else approx(value)), key
    assert JudgedMeasure.of(summary).verdict == tried["verdict"]

    page = write_report(run, tmp_path / "run.html", in_3d=False).read_text("utf-8")
    reported = statistics(page, case.measure)
    for name, key in REPORTED.items():
        assert reported[name] in tried[key], name
    judged = [reported[key] for key in ("verdict", "fraction out of limits", "Ppk")]
    verdict = tried["verdict"].replace("no limits", "–")
    assert judged == [verdict, tried.get("out of limits", "–"), tried.get("Ppk", "–")]
    questions.close()
