"""Scenes whose features are faces of solids: the same numbers as if stated, kept with the run, wrong picks refused."""

import hashlib
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from fixtures import Command
from scene_texts import refusal

from tol3d import load_scene
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.cad.solids.own_program import run_program
from tol3d.errors import GeometryError, RunError, SceneError
from tol3d.files import FileContent
from tol3d.scene import scene_from_python
from tol3d.simulate import run_scene, simulation_again
from tol3d.study.execution.pools import Execution
from tol3d.study.runs.run import open_run
from tol3d.study.trials.overrides import Overrides

BUILDER = """{kind: plate, length: 120 mm, width: 80 mm, thickness: 20 mm, holes: {
      bore: {at: [30 mm, 10 mm], diameter: 10 mm}, twin: {at: [-30 mm, 10 mm], diameter: 10 mm}},
      slots: {groove: {at: [0 mm, -25 mm], length: 40 mm, width: 10 mm, depth: 6 mm}}}"""
FEATURES = {
    "top": ("face: {name: top}", "at: [0 mm, 0 mm, 20 mm], normal: [0, 0, 1], extent: [120 mm, 80 mm]"),
    "left": (
        "face: {near: [-70 mm, 0 mm, 10 mm]}",
        "at: [-60 mm, 0 mm, 10 mm], normal: [-1, 0, 0], extent: [80 mm, 20 mm]",
    ),
    "bore": (
        "face: {name: bore}, axis: [0, 0, -1]",
        "at: [30 mm, 10 mm, 10 mm], axis: [0, 0, -1], length: 20 mm, diameter: 10 mm, hole: true",
    ),
    "corner": ("face: {near: [60 mm, 30 mm, 5 mm]}", "at: [60 mm, 30 mm, 5 mm], normal: [1, 0, 0]"),
    "groove": (
        "faces: [{name: groove left wall}, {name: groove right wall}]",
        "at: [0 mm, -25 mm, 17 mm], normal: [0, -1, 0], extent: [30 mm, 6 mm], width: 10 mm",
    ),
}
KINDS = {"top": "plane", "left": "plane", "bore": "cylinder", "corner": "point", "groove": "slot"}
SCENE = """
scene: picked
parts:
  base:
    kind: solid
    builder: {builder}
    features:
{features}
  probe:
    kind: solid
    features: {{tip: {{kind: point, at: [0 mm, 0 mm, 40 mm]}}}}
tolerances:
  bore place: {{kind: position, of: base.bore, zone: {{diameter: 90 um}}, law: {{kind: uniform}}, datums: [top, left]}}
  top profile: {{kind: profile, of: base.top, zone: {{width: 0.1 mm}}, law: {{kind: uniform}}}}
  groove place: {{kind: position, of: base.groove, zone: {{width: 90 um}}, law: {{kind: uniform}}, datums: [top, left]}}
moves:
  ground: {{kind: fix, part: base}}
  probing: {{kind: fix, part: probe}}
measures:
  bore gap: {{kind: gap, from: base.bore, to: probe.tip, along: [1, 0, 0]}}
  groove gap: {{kind: gap, from: base.groove, to: probe.tip, along: [0, 1, 0]}}
  corner far: {{kind: distance, from: base.corner, to: probe.tip}}
"""


def text_of(features: dict[str, str], builder: str = BUILDER) -> str:
    lines = "\n".join(f"      {name}: {{kind: {KINDS[name]}, {words}}}" for name, words in features.items())
    return SCENE.format(builder=builder, features=lines)


def written(folder: Path, text: str, name: str = "scene.yaml") -> Path:
    path = folder / name
    path.write_text(text, "utf-8")
    return path


PICKED = {name: words for name, (words, _) in FEATURES.items()}
STATED = {name: words for name, (_, words) in FEATURES.items()}


def test_a_picked_feature_is_the_one_that_its_numbers_would_be(tmp_path: Path) -> None:
    picked, stated = (load_scene(written(tmp_path, text_of(own))) for own in (PICKED, STATED))
    features, expected = (scene.of(SolidSpec)["base"].features for scene in (picked, stated))
    for name, own in expected.items():
        assert np.allclose(features[name].frame, own.frame, rtol=0.0, atol=1e-9), name
        assert features[name].shape.components == own.shape.components
    assert features["bore"].shape == pytest.approx(expected["bore"].shape) or repr(features["bore"].shape) == repr(
        expected["bore"].shape
    )
    runs = [
        run_scene(own, overrides=Overrides(trials=500), out=tmp_path / str(k)) for k, own in enumerate((picked, stated))
    ]
    for column in ("geometric:bore gap", "geometric:groove gap", "geometric:corner far"):
        one, other = (run.columns(column)[column] for run in runs)
        assert np.abs(one - other).max() < 1e-6  # um


def test_stated_numbers_stand_beside_a_face_where_they_agree(tmp_path: Path) -> None:
    both = {name: f"{FEATURES[name][0].partition(', axis')[0]}, {STATED[name]}" for name in FEATURES}
    load_scene(written(tmp_path, text_of(both)))


WRONG = {
    "no such face": ({"top": "face: {name: topp}"}, "parts.base.features.top.face.name: expected a face of the solid"),
    "wrong kind": (
        {"top": "face: {name: bore}"},
        "parts.base.features.top.face.name: expected a plane, got 'bore', which is a cylinder",
    ),
    "ambiguous": (
        {"bore": "face: {near: [0 mm, 10 mm, 10 mm]}"},
        "parts.base.features.bore.face.near: expected a point that one face is nearest to, got one that is 25 mm from "
        "each of 'bore', 'twin'; pick one by its name",
    ),
    "another diameter": (
        {"bore": "face: {name: bore}, diameter: 10.001 mm"},
        "parts.base.features.bore.diameter: expected what the face of the solid has, 10 mm, got 10.001 mm",
    ),
    "another place": (
        {"top": "face: {name: top}, at: [0 mm, 0.001 mm, 20 mm]"},
        "parts.base.features.top.at: expected what the face of the solid has, [0 mm, 0 mm, 20 mm], got [0 mm, 0.001",
    ),
    "into the material": (
        {"top": "face: {name: top}, normal: [0, 0, -1]"},
        "parts.base.features.top.normal: expected what the face of the solid has, [0, 0, 1], got [0, 0, -1]",
    ),
    "a pin for a hole": (
        {"bore": "face: {name: bore}, hole: false"},
        "parts.base.features.bore.hole: expected what the face of the solid has, true, got false",
    ),
    "off the face": (
        {"corner": "at: [60 mm, 30 mm, 25 mm], face: {name: right}"},
        "parts.base.features.corner.at: expected what the face of the solid has, [60 mm, 30 mm, 20 mm], got",
    ),
    "no point of a face": ({"corner": "face: {name: right}"}, "expected which point of the face 'right' is meant"),
    "both": ({"top": "face: {name: top, near: [0 mm, 0 mm, 1 mm]}"}, "expected either a name or a point `near` it"),
    "neither": ({"top": "face: {kind: plane}"}, "expected either a name or a point `near` it, got neither"),
    "unfit kind": (
        {"top": "face: {near: [0 mm, 0 mm, 21 mm], kind: cylinder}"},
        "parts.base.features.top.face.kind: expected plane, got 'cylinder'",
    ),
    "one wall": ({"groove": "faces: [{name: groove left wall}]"}, "expected a list of 2 faces, got a list of 1"),
    "no walls of a slot": (
        {"groove": "faces: [{name: top}, {name: left}]"},
        "parts.base.features.groove: expected two parallel walls that face each other, or face away",
    ),
    "neither face nor numbers": (
        {"top": "normal: [0, 0, 1], extent: [1 mm, 1 mm]"},
        'parts.base.features.top.at: expected the key "at" here, or a face of the solid that it is, got neither',
    ),
}


@pytest.mark.parametrize(("changed", "message"), WRONG.values(), ids=WRONG.keys())
def test_a_wrong_pick_is_refused_at_its_place(changed: dict[str, str], message: str, tmp_path: Path) -> None:
    said = refusal(text_of(PICKED | changed), tmp_path)
    assert message in said
    assert "\n" not in said


def test_all_wrong_picks_are_said_at_once(tmp_path: Path) -> None:
    wrong = {"top": "face: {name: topp}", "left": "face: {name: left}, at: [1 mm, 0 mm, 0 mm]"}
    with pytest.raises(SceneError) as caught:
        load_scene(written(tmp_path, text_of(PICKED | wrong)))
    assert "features.top.face.name" in str(caught.value)


def test_faces_of_a_part_without_a_solid_are_refused(tmp_path: Path) -> None:
    text = text_of(PICKED).replace(f"    builder: {BUILDER}\n", "")
    with pytest.raises(SceneError, match=r"features\.top\.face: expected a part with a builder, whose solid has faces"):
        load_scene(written(tmp_path, text))


def test_a_scene_made_in_python_is_settled_too(tmp_path: Path) -> None:
    scene = load_scene(written(tmp_path, text_of(PICKED)))
    assert scene_from_python(scene.model_copy(update={"measures": dict(scene.measures)})).files.keys() == {
        "features.json"
    }


# a program of the user -------------------------------------------------------------------------------

PROGRAM = """
import cadquery as cq

def build(length, wall, holes):
    plate = cq.Workplane().box(length, 80, wall, centered=(True, True, False))
    for k in range(holes):
        plate = plate.cut(cq.Workplane().center(30 - 60 * k, 10).circle(5).extrude(wall))
    return plate.faces("<X").tag("left").end()
"""
OWN = "{kind: file, file: part.py, dimensions: {length: 120 mm, wall: 20 mm}, counts: {holes: 1}}"
OWN_PICKS = {
    "top": "face: {near: [1 mm, 2 mm, 21 mm]}",
    "left": "face: {name: left}",
    **{name: PICKED[name] for name in ("corner",)},
    "bore": "face: {near: [30 mm, 10 mm, 10 mm]}, axis: [0, 0, -1]",
    "groove": STATED["groove"],
}


def own_scene(folder: Path, program: str = PROGRAM) -> Path:
    (folder / "part.py").write_text(program, "utf-8")
    return written(folder, text_of(OWN_PICKS, OWN), "own.yaml")


def test_a_program_runs_only_with_leave(tmp_path: Path, tol3d: Command) -> None:
    path = own_scene(tmp_path, f"open({str(tmp_path / 'ran')!r}, 'w')\n{PROGRAM}")
    code, _, err = tol3d("check", str(path))
    assert code == 2
    assert "parts.base.builder: expected permission to run part.py, which is a program, got none" in " ".join(
        err.split()
    )
    assert not (tmp_path / "ran").exists()
    assert tol3d("check", str(path), "--run-builders")[0] == 0
    assert (tmp_path / "ran").exists()


@pytest.mark.slow
def test_a_run_keeps_what_a_program_built_and_never_runs_it(tmp_path: Path) -> None:
    path = own_scene(tmp_path, f"open({str(tmp_path / 'ran')!r}, 'w')\n{PROGRAM}")
    run = run_scene(path, overrides=Overrides(trials=300), out=tmp_path / "run", run_builders=True)
    stated = run_scene(written(tmp_path, text_of(STATED)), overrides=Overrides(trials=300), out=tmp_path / "stated")
    assert np.abs(run.columns("geometric:bore gap")["geometric:bore gap"]).size == 300
    assert run.found.files.keys() >= {"features.json", "base.brep", "part.py"}
    column = "geometric:corner far"
    assert np.abs(run.columns(column)[column] - stated.columns(column)[column]).max() < 1e-6
    (tmp_path / "ran").unlink()
    for made in tmp_path.glob("*.py"):
        made.unlink()
    code = (
        "import sys\nfrom tol3d.simulate import replay\n"
        f"print(replay({str(tmp_path / 'run')!r}, 17).geometric['corner far'])\n"
        "assert 'cadquery' not in sys.modules and 'OCP' not in sys.modules"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert float(found) == run.columns(column)[column][17]
    assert not (tmp_path / "ran").exists()


FAILING = {
    "no such function": (PROGRAM.replace("def build", "def make"), "expected a function 'build', found: make"),
    "an argument that it has not": (PROGRAM.replace("wall, holes", "wall"), "TypeError: build() got an unexpected"),
    "an error": (PROGRAM.replace("    plate = cq.Work", "    1 / 0\n    plate = cq.Work", 1), ":5: ZeroDivisionError"),
    "an exit": (
        PROGRAM.replace("    plate = cq.Work", "    raise SystemExit(3)\n    plate = cq.Work", 1),
        ":5: SystemExit: 3",
    ),
    "no syntax": (PROGRAM.replace("def build(", "def build"), ":4: SyntaxError"),
    "no solid": (PROGRAM.replace("return plate", "return 3 #"), "expected one solid (NamedSolid, cadquery"),
    "two solids": (
        PROGRAM.replace(
            "return plate", "plate = plate.union(cq.Workplane().box(9, 9, 9).translate((500, 0, 0)))\n    return plate"
        ),
        "expected one solid (NamedSolid, cadquery Workplane or Solid), got 2 solids",
    ),
    "a tag of a face that was cut since": (
        PROGRAM.replace("    for k", '    plate.faces(">Z").tag("top")\n    for k'),
        "the face 'top' is not on the solid that build returns; tag it after all cuts",
    ),
}


@pytest.mark.parametrize(("program", "message"), FAILING.values(), ids=FAILING.keys())
def test_a_program_that_fails_is_a_message_with_its_line(program: str, message: str) -> None:
    with pytest.raises(GeometryError) as caught:
        run_program(
            FileContent(Path("part.py"), program.encode()), "build", {"length": 120.0, "wall": 20.0, "holes": 1}
        )
    assert message in str(caught.value)


def test_a_program_that_fails_is_a_message_at_its_place_in_the_scene(tmp_path: Path) -> None:
    program, message = FAILING["an error"]
    with pytest.raises(SceneError) as caught:
        load_scene(own_scene(tmp_path, program), run_builders=True)
    assert f"parts.base.builder: {tmp_path / 'part.py'}{message}" in str(caught.value)


def test_a_changed_program_is_not_run_where_a_run_should_go_on(tmp_path: Path) -> None:
    path = own_scene(tmp_path, f"open({str(tmp_path / 'ran')!r}, 'w')\n{PROGRAM}")
    interrupted = tmp_path / "run.partial"
    interrupted.mkdir()
    kept = {"scene": hashlib.sha256(path.read_bytes()).hexdigest(), "files": {"part.py": 64 * "0"}}
    (interrupted / "fingerprint.json").write_text(json.dumps(kept), "utf-8")
    with pytest.raises(RunError, match=r"run: nothing to resume, its run is of something else \(files: part\.py 0000"):
        run_scene(path, out=tmp_path / "run", execution=Execution(resume=True), run_builders=True)
    assert not (tmp_path / "ran").exists()


@pytest.mark.slow
def test_an_unchanged_program_is_run_again_where_a_run_should_go_on(tmp_path: Path, tol3d: Command) -> None:
    path = own_scene(tmp_path)
    words = ("run", str(path), "--trials", "20", "--no-picture", "--run-builders", "--out", str(tmp_path / "run"))
    assert tol3d(*words)[0] == 0
    assert tol3d(*words, "--resume")[0] == 0
    (tmp_path / "part.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w')\n{PROGRAM}", "utf-8")
    code, _, err = tol3d(*words, "--resume")
    assert code == 2
    assert "nothing to resume, its run is of something else (files: part.py" in err
    assert not (tmp_path / "ran").exists()


def test_a_run_with_other_picks_than_it_kept_is_refused(tmp_path: Path) -> None:
    run = run_scene(written(tmp_path, text_of(PICKED)), overrides=Overrides(trials=10), out=tmp_path / "run")
    (kept,) = (run.path / "files").glob("*features.json")
    content = json.loads(kept.read_text("utf-8"))
    content["picks"]["base"]["top"][0]["at"][2] += 1.0
    kept.write_text(json.dumps(content), "utf-8")
    with pytest.raises(RunError, match="was changed since the run was made"):
        simulation_again(open_run(tmp_path / "run"))


def test_check_names_the_faces(tmp_path: Path, tol3d: Command) -> None:
    code, out, _ = tol3d("check", str(written(tmp_path, text_of(PICKED | {"top": STATED["top"]}))))
    assert code == 0
    rows = {line.split()[0]: line.split()[-1] for line in out.splitlines() if line.startswith("base.")}
    assert rows["base.bore"] == "bore"
    assert rows["base.left"] == "left"
    assert rows["base.top"] == "–"
