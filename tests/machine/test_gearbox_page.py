"""The page about gears in a housing says what its scene and the grammar say."""

from pathlib import Path

import pytest
from fixtures import Command
from places import ROOT, SCENES
from ruamel.yaml import YAML

from tol3d import open_run, run_scene
from tol3d.gearing.machine.grammar.bores import CarrierPinsSpec, ShaftInBoresSpec

PAGE = (ROOT / "docs" / "gearboxes.md").read_text("utf-8")

ADDED = "{kind: perpendicularity, of: housing.dowel hole 2, datums: [rim], zone: {diameter: 5 um}}"
UPRIGHT = (
    (SCENES / "gearbox_in_housing.yaml")
    .read_text("utf-8")
    .replace("\ntolerances:\n", f"\ntolerances:\n  dowel hole 2 upright: {ADDED}\n")
)
"""With the line that the page adds."""


RUN = ("housed_gears", "gearbox_in_housing", "helical_gearbox")


def test_the_page_quotes_its_scenes() -> None:
    scenes = [(SCENES / f"{name}.yaml").read_text("utf-8") for name in RUN]
    quoted = [block.partition("```")[0] for block in PAGE.split("```yaml\n")[1:]]
    changed, pins = (own for own in quoted if not any(own in scene for scene in scenes))
    assert changed in UPRIGHT
    CarrierPinsSpec.model_validate(YAML(typ="safe").load(pins)["moves"]["planet pins"])


@pytest.mark.slow
def test_the_tables_and_the_remedy_are_those_of_runs(tol3d: Command, tmp_path: Path) -> None:
    tables = [block.partition("```")[0] for block in PAGE.split("```text\n")[1:]]
    assert len(tables) == 3
    for name, its in (("helical_gearbox", tables[2:]), ("gearbox_in_housing", tables[:2])):
        code, out, _ = tol3d("run", name, "-v", "--no-picture", "--out", str(tmp_path / name))
        assert code == 0
        for table in its:
            assert " ".join(table.split()) in " ".join(out.split())
    scene = tmp_path / "upright.yaml"
    scene.write_text(UPRIGHT, "utf-8")
    found = [open_run(tmp_path / "gearbox_in_housing"), run_scene(scene, out=tmp_path / "upright")]
    drawn, upright = (own.summary["measures"]["output bores aside"]["geometric"] for own in found)
    for said, own in ((6.9, drawn), (5.5, upright)):
        assert own["sigma"] == pytest.approx(said, abs=0.05)
    assert [own["out_ppm"] for own in (drawn, upright)] == [8000, 1500]


def test_the_page_has_a_row_for_every_key_of_the_move() -> None:
    table = PAGE.partition("## What `shaft_in_bores` says")[2].partition("\n- ")[0]
    rows = {line.split("`")[1] for line in table.splitlines() if line.startswith("| `")}
    assert rows == {field.alias or name for name, field in ShaftInBoresSpec.model_fields.items()} - {"kind"}
