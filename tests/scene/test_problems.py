"""Messages as data: file, line, column, place, expected and got of each, beside the text that is printed."""

import json
import pickle
from pathlib import Path

import pytest
from fixtures import Command
from places import SCENES

from tol3d import SceneError, load_scene
from tol3d.errors import GeometryError, InputError, Problem
from tol3d.kinds import NEEDED_KINDS
from tol3d.scene.load import scene_of_text
from tol3d.simulate import simulation_of

TEXT = (SCENES / "spur_pair.yaml").read_text("utf-8")


def refused(text: str, source: Path = Path("scene.yaml")) -> tuple[Problem, ...]:
    with pytest.raises(SceneError) as caught:
        simulation_of(scene_of_text(source, text.encode(), NEEDED_KINDS))
    return caught.value.problems


def written_at(text: str, problem: Problem) -> str:
    """The rest of the line from where a problem stands."""
    return text.splitlines()[problem.line - 1][problem.column - 1 :]


@pytest.mark.parametrize(
    ("old", "new", "place", "begins", "expected", "got"),
    [
        ("module: 2.5 mm", "module: 2.5", "parts.pinion.module", "module: 2.5",
         'a length with its unit, such as "4.5 um"', "2.5, a bare number without its unit"),
        ("module: 2.5 mm", "modul: 2.5 mm", "parts.pinion.modul", "modul", "", ""),
        ("kind: spur_gear", "kind: spur_gaer", "parts.pinion.kind", "kind: spur_gaer", "a kind of part", "'spur_gaer'"),
        ("driver: pinion", "driver: 'a; b, got c'", "moves.gear pair.driver", "driver:",
         "the name of a spur gear or a helical gear or an internal gear", "'a; b, got c', which is not in the scene"),
        ("upper: 20 um", "upper: -21 um", "tolerances.centre distance.distribution.lower", "lower:",
         "less than upper (-21 um)", "'-20 um'"),
        ("teeth: 28", "teeth: 28, teeth: 29", "parts.pinion.teeth", "teeth: 29", "", ""),
        ("parts:", "parts: [", "", "", "", ""),
    ],
)  # fmt: skip
def test_a_problem_knows_its_place_and_what_was_expected(
    old: str, new: str, place: str, begins: str, expected: str, got: str
) -> None:
    assert old in TEXT
    text = TEXT.replace(old, new, 1)
    problem = refused(text)[0]
    assert (problem.file, problem.path) == ("scene.yaml", place)
    assert written_at(text, problem).startswith(begins)
    assert (problem.expected, problem.got) == (expected, got)
    where = f"scene.yaml:{problem.line}: " + (f"{place}: " if place else "")
    assert problem == where + problem.sentence


def test_problems_stay_apart_in_another_process() -> None:
    text = TEXT.replace("module: 2.5 mm", "module: 2.5", 2)
    with pytest.raises(SceneError) as caught:
        scene_of_text(Path("scene.yaml"), text.encode(), NEEDED_KINDS)
    again = pickle.loads(pickle.dumps(caught.value))
    assert len(again.problems) == 2
    assert str(again) == str(caught.value) == "\n".join(again.problems)
    assert [own.data() for own in again.problems] == [own.data() for own in caught.value.problems]


def test_other_errors_are_sentences() -> None:
    (problem,) = GeometryError("expected a ring, got none").problems
    assert (problem, problem.line, problem.got) == ("expected a ring, got none", 0, "none")


def test_a_table_of_values_has_lines_too(tmp_path: Path) -> None:
    (tmp_path / "sizes.csv").write_text("size\n1.5\n2.x\n", "utf-8")
    law = "{kind: empirical, file: sizes.csv, column: size, unit: um}"
    text = TEXT.replace("distribution: {kind: normal, lower: -20 um, upper: 20 um}", f"distribution: {law}", 1)
    assert law in text
    (tmp_path / "scene.yaml").write_text(text, "utf-8")
    with pytest.raises(SceneError) as caught:
        simulation_of(load_scene(tmp_path / "scene.yaml"))
    (problem,) = caught.value.problems
    assert (problem.file, problem.line, problem.path) == (str(tmp_path / "sizes.csv"), 3, "column 'size'")
    assert problem.got == "'2.x'"


def test_a_file_that_is_included_is_named(tmp_path: Path) -> None:
    (tmp_path / "gear.yaml").write_text("parts:\n  gear: {kind: spur_gear, teeth: x}\n", "utf-8")
    (tmp_path / "scene.yaml").write_text("scene: two\ninclude: {a: gear.yaml}\n", "utf-8")
    with pytest.raises(InputError) as caught:
        load_scene(tmp_path / "scene.yaml")
    problem = next(own for own in caught.value.problems if own.path == "parts.gear.teeth")
    assert (problem.file, problem.line, problem.column) == (str(tmp_path / "gear.yaml"), 2, 27)


def test_a_warning_knows_its_place() -> None:
    text = TEXT.replace("{kind: normal, lower: -20 um, upper: 20 um}", "{kind: normal, lower: -2 mm, upper: 2 mm}", 1)
    warnings = simulation_of(scene_of_text(Path("scene.yaml"), text.encode(), NEEDED_KINDS)).warnings
    (warning,) = (own for own in map(Problem.of, warnings) if own.path.startswith("tolerances.centre distance"))
    assert written_at(text, warning).startswith("distribution:")
    assert warning == f"{warning.path}: {warning.sentence}"
    assert warning.got == "-2 mm (80 %)"


def test_check_prints_problems_for_programs(tol3d: Command, tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(TEXT.replace("module: 2.5 mm", "module: 2.5", 1), "utf-8")
    code, said, _ = tol3d("check", str(path), "--json")
    (problem,) = json.loads(said)
    assert code == 2
    assert (problem["severity"], problem["file"], problem["place"]) == ("error", str(path), "parts.pinion.module")
    assert path.read_text("utf-8").splitlines()[problem["line"] - 1][problem["column"] - 1 :].startswith("module: 2.5")
    _, _, printed = tol3d("check", str(path))
    assert f"{path}:{problem['line']}: {problem['place']}: {problem['message']}" == printed.replace("\n", "")
    path.write_text(TEXT, "utf-8")
    assert tol3d("check", str(path), "--json")[:2] == (0, "[]\n")
    code, _, said = tol3d("check", str(path), "--json", "--parts")
    assert (code, said.strip()) == (2, "--parts: of --json leave it out, which prints no tables")
