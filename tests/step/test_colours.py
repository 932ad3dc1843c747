"""Colours of a file's faces in what is shown: by the areas of the faces that were painted."""

import json
from pathlib import Path

import cadquery as cq
import numpy as np
import pytest
import trimesh
from fixtures import Command
from printing import printed

from tol3d.cad.step.reading import read_step
from tol3d.cad.step.step_shape import StepShape
from tol3d.files import read_file
from tol3d.report.body import Body, built_body
from tol3d.report.step_tables import features_report
from tol3d.simulate import Overrides, run_scene

SCENE = """
scene: painted
parts:
  box: {kind: step, file: box.step, features: {top: {kind: plane, near: [0 mm, 0 mm, 15 mm]}}}
tolerances:
  top: {kind: profile, of: box.top, zone: {width: 50 um}, law: {kind: uniform}}
moves:
  ground: {kind: fix, part: box}
measures:
  height: {kind: inspected_position, of: box.top, datums: [top], upper_limit: 50 um}
"""
RED, GREEN = "#FF0000", "#00FF00"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A box 10 × 20 × 30 mm, blue, with a red top and green sides along x; painted faces are on a layer."""
    made = tmp_path_factory.mktemp("painted")
    box = cq.Workplane().box(10, 20, 30)
    assembly = cq.Assembly(name="all").add(box, name="box", color=cq.Color(0.0, 0.0, 1.0))
    for picked, colour in ((">Z", (1.0, 0.0, 0.0)), ("|X", (0.0, 1.0, 0.0))):
        for face in box.faces(picked).vals():
            assert isinstance(face, cq.Shape)
            assembly.objects["box"].addSubshape(face, color=cq.Color(*colour), layer="painted")
    assembly.export(str(made / "box.step"), exportType="STEP")
    (made / "scene.yaml").write_text(SCENE, "utf-8")
    return made


def area(body: Body) -> float:
    return float(trimesh.Trimesh(*body.mesh, process=False).area)


def test_faces_have_their_colours_and_the_others_that_of_the_part(folder: Path) -> None:
    shape = StepShape.of(read_file(folder / "box.step"), None, None)
    body = built_body("box", shape, np.eye(4), "#4682B4", deflection=0.05)
    assert {own.name: own.colour for own in body.pieces} == {
        "box": "#4682B4", f"box, {GREEN} faces": GREEN, f"box, {RED} faces": RED,
    }  # fmt: skip
    found = {own.colour: area(own) for own in body.pieces}
    assert found == pytest.approx({"#4682B4": 2 * 300 + 200, GREEN: 2 * 600, RED: 200}, abs=1e-9)
    top = next(own for own in body.pieces if own.colour == RED).mesh[0]
    assert top[:, 2] == pytest.approx(15.0)


def test_files_and_pages_show_them(folder: Path, tmp_path: Path, tol3d: Command) -> None:
    run_scene(folder / "scene.yaml", overrides=Overrides(trials=20), out=tmp_path / "run")
    code, _, wrong = tol3d("export", str(tmp_path / "run"), "--nominal", "--format", "glb", "--out", str(tmp_path))
    assert code == 0, wrong
    scene = trimesh.load_scene(next(tmp_path.glob("*.glb")))
    factors = {tuple(mesh.visual.material.baseColorFactor[:3]) for mesh in scene.geometry.values()}
    assert {(255, 0, 0), (0, 255, 0)} < factors
    code, _, wrong = tol3d("report", str(tmp_path / "run"), "--out", str(tmp_path / "page.html"))
    assert code == 0, wrong
    page = (tmp_path / "page.html").read_text("utf-8")
    told = json.loads(page.split('id="view-data"')[1].split(">", 1)[1].split("</script>")[0])
    assert [own["colour"] for own in told["parts"]][1:] == [GREEN, RED]
    assert {len(own["poses"]) for build in told["builds"] for own in build["states"]} == {3}


def test_layers_are_ignored_and_said_so(folder: Path) -> None:
    file = read_step(read_file(folder / "box.step"))
    assert set(file.layers) == {"painted"}
    assert "layers are ignored: 'painted'" in printed(features_report(file))
