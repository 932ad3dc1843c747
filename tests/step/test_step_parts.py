"""Parts from STEP files in scenes: the numbers that a person would type, kept with the run, wrong selectors refused."""

import re
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import cadquery as cq
import numpy as np
import pytest
from fixtures import Command
from foreign_parts import halved_plate, slotted_block, step_file

from tol3d import load_scene
from tol3d.assembly.grammar.features import FeatureUnion
from tol3d.assembly.grammar.parts import SolidSpec
from tol3d.cad.step import reading
from tol3d.cad.step.reading import read_step
from tol3d.errors import SceneError
from tol3d.files import read_file
from tol3d.numerics.cache_folder import FOLDER_VARIABLE
from tol3d.simulate import run_scene, simulation_again
from tol3d.study.runs.run import open_run
from tol3d.study.trials.overrides import Overrides

SELECTED = {
    "block": {
        "A": "{kind: plane, near: [-10 mm, 8 mm, -10 mm]}",
        "B": "{kind: plane, near: [20 mm, 0 mm, 0 mm]}",
        "edges": "{kind: round, diameter: 8 mm, count: 4}",
        "pin": "{kind: pin}",
        "bottom": "{kind: plane, near: [13 mm, 0 mm, -5 mm]}",
        "top": "{kind: plane, near: [-14 mm, 5 mm, 10 mm], along: [0, 1, 0]}",
    },
    "halved": {
        "hole": "{kind: hole, diameter: 12 mm, near: [0 mm, 3 mm, 0 mm], within: 1 um}",
        "under": "{kind: plane, near: [20 mm, 0 mm, -5 mm]}",
    },
}
SCENE = """
scene: foreign
parts:
  block:
    kind: {kind}
{block}
  halved:
    kind: {kind}
{halved}
    placed: {{at: [-12 mm, -3 mm, 15 mm]}}
{more}
tolerances:
  edge place{all}:
    {{kind: position, of: block.edges{first}, zone: {{diameter: 80 um}}, law: {{kind: uniform}}, datums: [A, B]}}
{rest}
  pin place: {{kind: position, of: block.pin, zone: {{diameter: 90 um}}, law: {{kind: uniform}}, datums: [A, B]}}
  top place: {{kind: profile, of: block.top, zone: {{width: 50 um}}, law: {{kind: uniform}}, datums: [A]}}
  hole size: {{kind: size, of: halved.hole, distribution: {{kind: uniform, lower: 0 um, upper: 18 um}}}}
moves:
  ground: {{kind: fix, part: block}}
  covered: {{kind: fix, part: halved}}
measures:
  play: {{kind: gap, from: halved.hole, to: block.pin, along: [1, 0, 0]}}
  step: {{kind: gap, from: halved.under, to: block.top, along: [0, 0, 1]}}
  apart: {{kind: gap, from: block.edges 1, to: block.edges 3, along: [1, 0, 0]}}
  inspected: {{kind: inspected_position, of: block.edges 2, datums: [A, B], upper_limit: 80 um}}
"""
MEASURES = ("play", "step", "apart", "inspected")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the file, which is read once."""
    made = tmp_path_factory.mktemp("foreign")
    step_file({"block": slotted_block(), "halved": halved_plate()}, made / "parts.step")
    return made


def lines(features: Mapping[str, str], head: str) -> str:
    return head + "    features:\n" + "\n".join(f"      {name}: {words}" for name, words in features.items())


def selected(folder: Path, more: str = "", **changed: str) -> Path:
    """The scene whose features are selected, some otherwise."""
    block = lines({**SELECTED["block"], **changed}, "    file: parts.step\n    product: block\n")
    halved = lines(SELECTED["halved"], "    file: parts.step\n    product: halved\n")
    path = folder / "selected.yaml"
    path.write_text(
        SCENE.format(kind="step", block=block, halved=halved, more=more, all="", first="", rest=""), "utf-8"
    )
    return path


def typed(folder: Path, features: Mapping[str, Mapping[str, str]]) -> Path:
    """The scene whose features are numbers."""
    places = "\n".join(
        f"  edge place {k}: {{kind: position, of: block.edges {k}, zone: {{diameter: 80 um}}, law: {{kind: uniform}}, "
        "datums: [A, B]}"
        for k in (2, 3, 4)
    )
    path = folder / "typed.yaml"
    block, halved = (lines(features[part], "") for part in ("block", "halved"))
    text = SCENE.format(kind="solid", block=block, halved=halved, more="", all=" 1", first=" 1", rest=places)
    path.write_text(text, "utf-8")
    return path


def numbers(spec: FeatureUnion) -> str:
    """A feature as a person types it, with all digits."""
    said: dict[str, Any] = {name: getattr(spec, name) for name in type(spec).model_fields if name != "pattern"}
    return "{" + ", ".join(f"{name}: {_typed(own)}" for name, own in said.items() if own not in (None, ())) + "}"


def _typed(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f"[{', '.join(map(_typed, value))}]" if isinstance(value, tuple) else str(value)


def test_selected_features_give_the_columns_of_their_numbers_bit_by_bit(folder: Path, tmp_path: Path) -> None:
    scene = load_scene(selected(folder))
    specs = {name: own.features for name, own in scene.of(SolidSpec).items()}
    assert specs["block"]["pin"].origin == pytest.approx((-12.0, 0.0, 14.5), abs=1e-9)
    assert repr(specs["block"]["top"].shape) == "Plane(extent=(30.0, 40.0))"
    by_hand = {
        part: {own: numbers(each) for name, spec in found.items() for own, each in spec.members(name).items()}
        for part, found in specs.items()
    }
    runs = [
        run_scene(path, overrides=Overrides(trials=400), out=tmp_path / path.stem)
        for path in (selected(folder), typed(folder, by_hand))
    ]
    for method in ("geometric", "analytic"):
        for name in MEASURES:
            one, other = (run.columns(f"{method}:{name}")[f"{method}:{name}"] for run in runs)
            assert np.array_equal(one, other)
            assert np.ptp(one) > 0.0


def test_a_run_is_made_again_without_reading_the_file(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = run_scene(selected(folder), overrides=Overrides(trials=50), out=tmp_path / "run")
    values = run.columns("geometric:play")["geometric:play"]
    (tmp_path / "cache").mkdir(mode=0o700)
    monkeypatch.setenv(FOLDER_VARIABLE, str(tmp_path / "cache"))
    monkeypatch.setattr(reading, "PROGRAM", "import os; os.abort()")
    again = simulation_again(open_run(tmp_path / "run"))
    assert [own.name for own in again.system.measures] == list(MEASURES)
    assert np.isfinite(values).all()


def test_a_part_like_a_step_part_has_its_features_and_draws_of_its_own(folder: Path) -> None:
    more = "  twin: {kind: solid, like: block, placed: {at: [100 mm, 0 mm, 0 mm]}}"
    path = selected(folder, more)
    path.write_text(
        path.read_text("utf-8").replace("measures:", "  twinned: {kind: fix, part: twin}\nmeasures:"), "utf-8"
    )
    scene = load_scene(path)
    run = run_scene(scene, overrides=Overrides(trials=20), out=folder / "twin")
    names = [own.name for own in simulation_again(run).system.contributors]
    assert {"pin place", "pin place of twin", "edge place 4", "edge place 4 of twin"} <= set(names)


def test_parts_of_an_assembly_stand_where_its_file_says_bit_by_bit(tmp_path: Path) -> None:
    """A bolt that is used four times is four parts, each with draws of its own."""
    places = [cq.Location((x, y, 5.0), (1.0, 2.0, 0.5), angle) for x, y, angle in PLACES]
    inner = cq.Assembly(name="bolts")
    bolt = cq.Workplane().circle(3).extrude(20)
    for k, place in enumerate(places, 1):
        inner.add(bolt, name=f"bolt {k}", loc=place)
    whole = cq.Assembly(name="top").add(slotted_block(), name="block", loc=cq.Location((1.0, 2.0, 3.0)))
    whole.add(inner, name="bolts", loc=cq.Location((0.0, 0.0, 7.0), (0.0, 1.0, 0.0), 30.0))
    whole.export(str(tmp_path / "all.step"), exportType="STEP")
    cq.Assembly(name="one").add(bolt, name="bolt").export(str(tmp_path / "bolt.step"), exportType="STEP")
    uses = read_step(read_file(tmp_path / "all.step")).uses
    assert [own.path for own in uses] == ["block", *(f"bolts/bolt {k}" for k in (1, 2, 3, 4))]
    in_world = cq.Location((0.0, 0.0, 7.0), (0.0, 1.0, 0.0), 30.0) * places[1]
    assert uses[2].frame[0] == pytest.approx(in_world.toTuple()[0], abs=1e-9)
    placed = [own.frame for own in uses[1:]]
    assembled, alone = (
        run_scene(_bolted(tmp_path, name, placed), overrides=Overrides(trials=200), out=tmp_path / f"run {name}")
        for name in ("assembled", "alone")
    )
    for name in ("from 1 to 2", "from 2 to 3", "from 3 to 4"):
        one, other = (run.columns(f"geometric:{name}")[f"geometric:{name}"] for run in (assembled, alone))
        assert np.array_equal(one, other)
        assert np.ptp(one) > 0.0
    names = [own.name for own in simulation_again(assembled).system.contributors]
    assert names == ["axis", "axis of bolt 2", "axis of bolt 3", "axis of bolt 4"]


PLACES = ((10.0, 4.0, 10.0), (-10.0, 4.0, 20.0), (-10.0, -4.0, 30.0), (10.0, -4.0, 40.0))


def _bolted(folder: Path, name: str, placed: Sequence[tuple[Any, Any, Any]]) -> Path:
    """Four bolts, by their uses in the assembly, or each from the file of one with its place typed."""
    features = "features: {shaft: {kind: pin}, foot: {kind: plane, near: [0 mm, 0.5 mm, 0 mm]}}"
    parts = []
    for k, (at, z, x) in enumerate(placed, 1):
        own = features if k == 1 else "like: bolt 1"
        place = f"at: [{', '.join(f'{v!r} mm' for v in at)}], z: {list(z)}, x: {list(x)}"
        file = f"file: all.step, use: bolts/bolt {k}" if name == "assembled" else "file: bolt.step, product: bolt"
        said = "" if name == "assembled" else f", placed: {{{place}}}"
        parts.append(f"  bolt {k}: {{kind: step, {file}, {own}{said}}}")
    fixed = "\n".join(f"  fix {k}: {{kind: fix, part: bolt {k}}}" for k in (1, 2, 3, 4))
    read = "\n".join(
        f"  from {k} to {k + 1}: {{kind: gap, from: bolt {k}.shaft, to: bolt {k + 1}.shaft, along: [1, 0, 0]}}"
        for k in (1, 2, 3)
    )
    zone = "zone: {diameter: 0.1 mm}, law: {kind: uniform}"
    text = "\n".join(
        [
            "scene: bolts",
            "parts:",
            *parts,
            "tolerances:",
            f"  axis: {{kind: position, of: bolt 1.shaft, {zone}}}",
            "moves:",
            fixed,
            "measures:",
            read,
        ]
    )
    path = folder / f"{name}.yaml"
    path.write_text(text + "\n", "utf-8")
    return path


WRONG = {
    "none": ({"pin": "{kind: socket}"}, "features.pin.kind: expected a socket, found none there"),
    "several": ({"pin": "{kind: round}"}, "features.pin: expected exactly 1 feature, found 4: {kind: round, near: ["),
    "near": ({"pin": "{near: [-3 mm, 0 mm, 10 mm]}"}, "features.pin.near: expected a point to which the next feature"),
    "far": ({"pin": "{kind: pin, near: [0 mm, 0 mm, 0 mm], within: 1 mm}"}, "features.pin.within: expected it within"),
    "number": ({"pin": '{face: "#1"}'}, "features.pin.face: expected a face of 'block', got #1"),
    "name": ({"pin": "{face: lid}"}, "features.pin.face: expected the name of a face, got 'lid'"),
    "nothing": ({"pin": "{count: 2}"}, "features.pin: expected a face, or a kind with a diameter or a point near it"),
    "faces by name": ({"pin": "{faces: [lid]}"}, 'features.pin.faces: expected numbers of faces, such as "#764"'),
    "within alone": ({"pin": "{kind: pin, within: 1 mm}"}, "features.pin.within: expected the point `near` it as well"),
    "a torus": ({"pin": "{kind: torus}"}, "features.pin.kind: expected "),
    "no datum": ({"pin": "{datum: Q}"}, "features.pin.datum: expected the letter of a datum of 'block', got 'Q'"),
    "two ways": ({"pin": "{datum: Q, pmi: x}"}, "features.pin: expected one of `datum`, `pmi` and `tolerance`, got"),
    "value alone": ({"pin": "{datum: Q, value: 1 mm}"}, "features.pin.value: expected the kind of `tolerance` as well"),
    "unknown key": ({"pin": "{kind: pin, radius: 3 mm}"}, 'features.pin.radius: unknown key "radius"'),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_selector_is_refused_where_it_stands(name: str, folder: Path) -> None:
    changed, words = WRONG[name]
    with pytest.raises(SceneError) as error:
        load_scene(selected(folder, **changed))
    assert f"parts.block.{words}" in str(error.value)
    assert re.match(r".*selected\.yaml:\d+: ", str(error.value))


def test_products_and_files_are_refused_where_they_stand(folder: Path, tmp_path: Path) -> None:
    text = selected(folder).read_text("utf-8")
    path = folder / "wrong.yaml"
    path.write_text(text.replace("product: block", "product: blok"), "utf-8")
    with pytest.raises(SceneError, match=r"parts\.block\.product: .* got 'blok', none of that name"):
        load_scene(path)
    path.write_text(text.replace("file: parts.step", "file: ../parts.step"), "utf-8")
    with pytest.raises(SceneError, match=r"parts\.block\.file: expected a file in the scene's own folder"):
        load_scene(path)
    (folder / "cut.step").write_bytes((folder / "parts.step").read_bytes()[:5000])
    path.write_text(text.replace("file: parts.step", "file: cut.step"), "utf-8")
    with pytest.raises(SceneError, match=r"parts\.block\.file: cut\.step:\d+: "):
        load_scene(path)


def test_solids_are_shown_by_triangles_and_written_by_another_process(
    folder: Path, tmp_path: Path, tol3d: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    run_scene(selected(folder), overrides=Overrides(trials=20), out=tmp_path / "run")

    def refuse() -> Any:
        raise AssertionError("a shape of a foreign file in this process")

    monkeypatch.setattr(sys.modules["tol3d.cad.solids.display_mesh"], "cad", refuse)
    out = str(tmp_path / "exported")
    assert tol3d("export", str(tmp_path / "run"), "--nominal", "--format", "stl", "--out", out)[0] == 0
    code, _, wrong = tol3d("export", str(tmp_path / "run"), "--nominal", "--format", "step", "--out", out)
    assert code == 0, wrong
    text = next((tmp_path / "exported").glob("*.step")).read_text("latin-1")
    assert text.count("MANIFOLD_SOLID_BREP(") == 2
