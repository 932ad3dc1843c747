"""Slots of plain solids, and covers on two dowels: by CadQuery's own export, numbers known beforehand."""

from pathlib import Path

import cadquery as cq
import pytest
import yaml
from deviations import deviating
from foreign_parts import solid, step_file, turned

from tol3d.apps.drafting import scene_from
from tol3d.cad.step.reading import read_step
from tol3d.files import FileContent

DOWELS = ((-22.0, 4.0), (27.0, 4.0))


def dowelled(folder: Path, pin: float, width: float) -> FileContent:
    """A base 80 × 50 × 20 with two dowels of one diameter, and a cover 70 × 40 × 6 with a hole ⌀6.05 and a slot."""
    base = cq.Workplane().box(80, 50, 20).translate((3, 2, -10))
    base = base.union(cq.Workplane().pushPoints(DOWELS).circle(pin / 2).extrude(5))
    cover = cq.Workplane().box(70, 40, 6).translate((2, 3, 3))
    cover = cover.cut(cq.Workplane().pushPoints(DOWELS[:1]).circle(6.05 / 2).extrude(6))
    cover = cover.cut(cq.Workplane().pushPoints(DOWELS[1:]).slot2D(width + 5, width).extrude(6))
    return step_file({"cover": solid(cover), "base": solid(base)}, folder / "dowelled.step")


def test_a_slot_is_two_half_rounds_and_the_walls_between_them(tmp_path: Path) -> None:
    """A slot 8 mm wide and 20 mm long through 9 mm, askew; pockets with four rounded corners are none."""
    plate = cq.Workplane().box(60, 40, 9).faces(">Z").workplane(origin=(5, -3, 0)).slot2D(20, 8, 25).cutThruAll()
    pocket = cq.Workplane().box(14, 9, 9).edges("|Z").fillet(2).translate((-18, 9, 0))
    content = step_file({"plate": turned(solid(plate.cut(pocket)))}, tmp_path / "plate.step")
    (found,) = read_step(content).part(None).machined.slots
    assert found.width == pytest.approx(8.0, abs=1e-9)
    assert [wall.area for wall in found.walls] == pytest.approx([108.0, 108.0], abs=1e-9)
    assert {wall.kind for wall in found.walls} == {"plane"}


def test_a_cover_on_two_dowels_has_a_hole_and_a_slot_with_their_pins(tmp_path: Path) -> None:
    """Both pairs, the slot's width, and zones that leave half of the play of 0.05 and 0.1 mm."""
    text, _ = scene_from([dowelled(tmp_path, 6.0, 6.1)])
    scene = yaml.safe_load(text)
    (move,) = (own for own in scene["moves"].values() if own["kind"] != "fix")
    assert move["kind"] == "pattern"
    ends = {tuple(own.split(".")[1].split()[0] for own in pair.values()) for pair in move["pairs"]}
    assert ends == {("hole", "pin"), ("slot", "pin")}
    (slot,) = (own for own in scene["parts"]["cover"]["features"].values() if own["kind"] == "slot")
    assert slot["width"] == "6.1 mm"
    zones = {own["of"].split(".")[1].split()[0]: own["zone"] for own in scene["tolerances"].values() if "zone" in own}
    assert zones["slot"] == {"width": "0.025 mm"}
    assert float(zones["hole"]["diameter"].split()[0]) == pytest.approx(0.0125, abs=0.0006)
    assert scene["measures"]
    assert "slot 6.1 wide" not in text.partition("study:")[2]
    assert min(deviating(text, tmp_path).values()) > 1e-6


def test_a_pin_beside_a_slot_or_thicker_than_it_is_no_pair(tmp_path: Path) -> None:
    text, _ = scene_from([dowelled(tmp_path, 6.0, 5.5)])
    scene = yaml.safe_load(text)
    assert not [own for own in scene["parts"]["cover"]["features"].values() if own["kind"] == "slot"]
    left = text.partition("study:")[2]
    assert "cover: slot 5.5 wide, 10.5 long, 6 deep" in left


def test_a_draft_tells_what_its_features_are_part_of_and_which_it_lacks(tmp_path: Path) -> None:
    """A counterbored plate under a bolt M8x30 whose pin is in one of its four holes; a tab that nothing uses."""
    places = [(-30, -14), (-30, 16), (34, -14), (34, 16)]
    plate = cq.Workplane().box(90, 60, 12).faces(">Z").workplane(origin=(0, 0, 0)).pushPoints(places)
    plate = plate.cboreHole(8.0, 14, 5).union(cq.Workplane().box(8, 30, 5).translate((0, 0, 8.5)))
    bolt = cq.Workplane().circle(4).extrude(-7).union(cq.Workplane().circle(6.5).extrude(5)).translate((-30, -14, 1))
    nut = cq.Workplane().circle(7).circle(4).extrude(4).translate((-30, -14, -10))
    shapes = {"plate": solid(plate), "bolt M8x30": solid(bolt), "nut": solid(nut)}
    text, _ = scene_from([step_file(shapes, tmp_path / "bolted.step")])
    counterbore = "counterbore ⌀14 × 5 of a hole ⌀8"
    scene, _, left = text.partition("study:")
    (line,) = (line for line in scene.splitlines() if counterbore in line)
    assert "of 4 holes ⌀8 in a grid of 2 × 2" in line
    assert f"#   plate: 3 × {counterbore}" in left
    assert "#   plate: tab 8 wide, 30 long, 5 high" in left
    assert "#   bolt M8x30: M8x30" in left
    yaml.safe_load(text)


def test_a_pin_that_no_move_uses_is_listed_with_its_hole(tmp_path: Path) -> None:
    """A pin through two cheeks and a link, all of one diameter: what holds it is in a move, the rest is told."""
    pin = cq.Workplane().circle(5).extrude(60)
    hole = cq.Workplane().circle(5).extrude(60)
    cheeks = [cq.Workplane().box(30, 30, 10).translate((0, 0, z)).cut(hole) for z in (10, 50)]
    link = cq.Workplane().box(20, 60, 29).translate((0, 15, 30)).cut(hole)
    shapes = {"left": solid(cheeks[0]), "right": solid(cheeks[1]), "link": solid(link), "pin": solid(pin)}
    text, _ = scene_from([step_file(shapes, tmp_path / "fork.step")])
    left = text.partition("study:")[2].splitlines()
    assert [line for line in left if " in " in line and "⌀" in line] == [
        "#   pin.pin 1 ⌀10 in left.hole 1 ⌀10",
        "#   pin.pin 1 ⌀10 in right.hole 1 ⌀10",
    ]


def keyed(folder: Path, width: float) -> FileContent:
    """A base 80 × 50 × 20 with two pockets 10.1 and `width` wide across each other, and a lid with tabs 10 wide."""
    base = cq.Workplane().box(80, 50, 20).translate((3, 2, -10))
    lid = cq.Workplane().box(70, 40, 6).translate((2, 3, 3))
    for x, pocket, tab in ((-17.0, (10.1, 24.0), (10.0, 12.0)), (24.0, (24.0, width), (12.0, 10.0))):
        base = base.cut(cq.Workplane().box(*pocket, 16).edges("|Z").fillet(4).translate((x, 4, 0)))
        lid = lid.union(cq.Workplane().box(*tab, 5).translate((x, 4, -2.5)))
    return step_file({"lid": solid(lid), "base": solid(base)}, folder / "keyed.step")


def test_tabs_midway_between_walls_are_pairs_of_the_move(tmp_path: Path) -> None:
    """Both, with the play of 0.1 and 0.2 mm; between walls 21 mm apart nothing is located."""
    text, _ = scene_from([keyed(tmp_path, 10.2)])
    scene = yaml.safe_load(text)
    (move,) = (own for own in scene["moves"].values() if own["kind"] != "fix")
    assert move["kind"] == "pattern"
    assert [(pair["from"], pair["to"]) for pair in move["pairs"]] == [
        ("lid.tab 1", "base.slot 1"), ("lid.tab 2", "base.slot 2"),
    ]  # fmt: skip
    slots = {name: own["width"] for name, own in scene["parts"]["base"]["features"].items() if own["kind"] == "slot"}
    assert slots == {"slot 1": "10.1 mm", "slot 2": "10.2 mm"}
    assert "no move uses" not in text
    assert min(deviating(text, tmp_path).values()) > 1e-6
    wide = yaml.safe_load(scene_from([keyed(tmp_path, 21.0)])[0])["parts"]["base"]["features"]
    assert sum(own["kind"] == "slot" for own in wide.values()) == 1
