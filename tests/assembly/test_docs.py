"""Examples of docs/assemblies.md and its neighbours; the scenes that between them say every field of assemblies."""

import re
from pathlib import Path
from typing import Any

import pytest
from fixtures import Command
from guides import quoted, text_of
from places import SCENES
from ruamel.yaml import YAML
from said_fields import fields_said, fields_within, unsaid
from scene_texts import scene_of

from tol3d import Overrides, load_scene, run_scene
from tol3d.assembly.grammar.builders import OwnFileSpec
from tol3d.assembly.grammar.measures.assembly_measure import TimedSpec
from tol3d.assembly.grammar.moves.play import PatternPairSpec
from tol3d.assembly.grammar.parts import SolidSpec, StepSpec
from tol3d.assembly.mechanism import ASSEMBLY
from tol3d.assembly.zones import catalogue, normal_in, uniform_in
from tol3d.scene import Grammar, Scene
from tol3d.scene.schema import SECTIONS

KINDS = Grammar((ASSEMBLY,))
OWN = ("tol3d.assembly", "tol3d.scene.temperature")  # modules of its kinds
TABLES = re.findall(r"```text\n([^\n]*analytic.*?)```", text_of("assemblies"), re.DOTALL)


def one_line(text: str) -> str:
    return " ".join(text.split())


FIELD_SCENES = (
    "every_assembly_field",
    "bolted_cover",
    "four_pads",
    "box_with_discs",
    "clutch",
    "hole_and_slot",
    "two_plates",
    "lid_by_a_wall",
    "machined_parts",
    "warm_bar",
)
"""Between them every kind and every field, but for the builders of linkages."""
LINKAGES = ("spherical_drive", "stewart", "robot_arm")

BUILDERS_PAGE = text_of("builders")
OWN_PROGRAM, OWN_LINES = (
    re.findall(rf"```{language}\n({start}.*?)```", BUILDERS_PAGE, re.DOTALL)[0]
    for language, start in (("python", "import"), ("yaml", "builder:"))
)
PAIRS = [
    PatternPairSpec.model_validate(YAML(typ="safe").load(pair))
    for pair in re.findall(r"`(\{from: cover\.hole .*\})`", text_of("moves"))
]
OWN_BUILDER = OwnFileSpec.model_validate(YAML(typ="safe").load(OWN_LINES)["builder"])

STEP_PAGE = text_of("step")
STEP_PARTS = [
    StepSpec.model_validate(own)
    for lines in re.findall(r"```yaml\n(parts:\n.*?)```", STEP_PAGE, re.DOTALL)
    for own in YAML(typ="safe").load(lines)["parts"].values()
]

DRAWINGS = [text for text in quoted("drawings") if text.startswith("scene:")]


def drawn(text: str, folder: Path) -> Scene:
    """A scene of the page of drawings."""
    return scene_of(text, folder)


# the scenes --------------------------------------------------------------------------------------------------


def test_the_page_quotes_its_scene() -> None:
    assert quoted("assemblies") == [(SCENES / "cover_on_base.yaml").read_text("utf-8")]


def test_the_tables_of_the_example_are_those_of_the_run(tol3d: Command, tmp_path: Any) -> None:
    code, out, _ = tol3d("run", "cover_on_base", "-v", "--no-picture", "--out", str(tmp_path / "run"))
    assert code == 0
    assert len(TABLES) == 3
    for table in TABLES:
        assert one_line(table) in one_line(out)


def test_the_scenes_use_every_field_of_every_kind(tmp_path: Path) -> None:
    kinds = [spec for section in SECTIONS for spec in ASSEMBLY.specs(section)]
    known = {own for spec in kinds for own in fields_within(spec) if own[0].__module__.startswith(OWN)}
    assert len({model for model, _ in known}) > len(kinds) + 40  # with features, laws, pairs, floats, builders, details
    said = {own for name in FIELD_SCENES for own in fields_said(load_scene(SCENES / f"{name}.yaml", KINDS))}
    said |= {own for name in LINKAGES for own in fields_said(load_scene(SCENES / f"{name}.yaml"))}
    assert len(PAIRS) == 3
    said |= {own for pair in PAIRS for own in fields_said(pair)}  # of the page
    said |= set(fields_said(OWN_BUILDER))  # which runs only where the user says so: no scene that comes along has one
    said |= {own for text in DRAWINGS for own in fields_said(drawn(text, tmp_path))}
    said |= {own for part in STEP_PARTS for own in fields_said(part)}  # of the page; no STEP file comes along
    of_poses = {"at", "over", "take"}  # of machines and linkages
    posed = {(model, field) for model, field in known if field in of_poses and issubclass(model, TimedSpec)}
    assert unsaid(known - posed, said) == set()
    assert set(kinds) <= {model for model, _ in said}


@pytest.mark.parametrize("text", DRAWINGS, ids=lambda text: text.splitlines()[0])
def test_every_scene_of_the_page_of_drawings_runs_and_holds_its_limits(text: str, tmp_path: Path) -> None:
    found = run_scene(drawn(text, tmp_path), overrides=Overrides(trials=300), out=tmp_path / "run").summary
    assert {own["geometric"]["above_limit_ppm"] for own in found["measures"].values()} == {0.0}


def test_the_program_of_the_page_builds_what_it_says(tmp_path: Path) -> None:
    (tmp_path / "my_part.py").write_text(OWN_PROGRAM, "utf-8")
    lines = "".join(f"    {line}\n" for line in OWN_LINES.splitlines())
    scene = (
        "scene: own\nparts:\n  base:\n    kind: solid\n"
        + lines
        + (
            "    features:\n      bottom: {kind: plane, face: {name: bottom}}\n"
            "      rib: {kind: plane, face: {near: [0 mm, 0 mm, 31 mm]}}\n"
            "moves: {ground: {kind: fix, part: base}}\n"
            "measures: {height: {kind: gap, from: base.bottom, to: base.rib, along: [0, 0, 1]}}\n"
        )
    )
    (tmp_path / "own.yaml").write_text(scene, "utf-8")
    features = load_scene(tmp_path / "own.yaml", run_builders=True).of(SolidSpec)["base"].features
    assert repr(features["bottom"].shape) == "Plane(extent=(120.0, 40.0))"
    assert features["rib"].origin == pytest.approx((0.0, 0.0, 30.0), abs=1e-9)  # 20 mm and a rib of 10 mm


def test_the_table_of_sigmas_has_those_of_the_draws() -> None:
    """In parts of the zone's width; `uniform` where the orientation is free, and the most where it is refined."""
    free = {
        "axis in a cylinder": catalogue.axis(1.0),
        "axis at one section": catalogue.axis_section(1.0),
        "face": catalogue.rectangle(1.0),
        "axis between planes": catalogue.flat_axis(1.0, (1.0, 0.0)),
        "point between planes": catalogue.point_between_planes(1.0),
        "point in a sphere": catalogue.point_in_sphere(1.0),
    }
    refined = {"axis in a cylinder": catalogue.axis(1.0, 1e-6), "face": catalogue.rectangle(1.0, 1e-6)}
    refined["axis between planes"] = catalogue.flat_axis(1.0, (1.0, 0.0), 1e-6)
    for name, zone in free.items():
        (row,) = re.findall(rf"^\| {name}[^|]* \| ([\d.]+)([^|]*) \| ([\d.]+) \|", text_of("assemblies"), re.MULTILINE)
        assert row[0] == f"{uniform_in(zone).middle_sigma:.3f}"
        assert row[2] == f"{normal_in(zone).middle_sigma:.3f}"
        assert re.findall(r"([\d.]+) at most", row[1]) == [
            f"{uniform_in(refined[own]).middle_sigma:.3f}" for own in refined if own == name
        ]
