"""Measures of drafts: between parts or features, few, each one varies, and none is judged by a limit nobody gave."""

import re
from pathlib import Path
from typing import Any

import cadquery as cq
import pytest
import yaml
from deviations import deviating
from foreign_parts import nist_file, solid, step_file

from tol3d.apps.drafting import scene_from
from tol3d.apps.drafting.entry import Entry, Wording
from tol3d.apps.drafting.measured import MOST_MEASURES, Candidate, ranked
from tol3d.files import FileContent, read_file

PLACES = ((-30, -14), (-30, 16), (34, -15), (31, 19))


def holed(box: cq.Workplane, diameter: float) -> cq.Shape:
    return solid(box.faces(">Z").workplane(origin=(0, 0, 0)).pushPoints(PLACES).hole(diameter))


def bolted(folder: Path, bolt_diameter: float) -> FileContent:
    """A bolt, a plate 90 × 60 × 12 with four ⌀6 holes, a cover 80 × 50 × 5 with four ⌀7 holes, and three more bolts.

    Bolts stand in the holes of both with their heads on the cover.
    """
    bolt = solid(cq.Workplane().circle(bolt_diameter / 2).extrude(-16).union(cq.Workplane().circle(5).extrude(4)))
    made = cq.Assembly(name="all")
    places = [cq.Location(cq.Vector(x, y, 17)) for x, y in PLACES]
    made.add(bolt, name="bolt", loc=places[0])
    made.add(holed(cq.Workplane().box(90, 60, 12).translate((2, 1, 6)), 6.0), name="plate")
    made.add(holed(cq.Workplane().box(80, 50, 5).translate((1, 2, 14.5)), 7.0), name="cover")
    for k, place in enumerate(places[1:]):
        made.add(bolt, name=f"bolt {k}", loc=place)
    path = folder / "bolted.step"
    made.export(str(path), exportType="STEP")
    return read_file(path)


def placed_by(scene: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """The move of each part."""
    return {move["part"]: move for move in scene["moves"].values()}


def test_a_bolted_cover_is_drafted_from_the_plate_out(tmp_path: Path) -> None:
    """Bolts of ⌀5.4 in ⌀6 and ⌀7 leave 0.6 mm: the pattern plays with the bolts that are there."""
    text, _ = scene_from([bolted(tmp_path, 5.4)])
    scene = yaml.safe_load(text)
    moves = placed_by(scene)
    assert [name for name, move in moves.items() if move["kind"] == "fix"] == ["plate"]
    assert list(moves)[1] == "cover"
    assert moves["cover"]["kind"] == "pattern"
    assert {pair["bolt"]["diameter"] for pair in moves["cover"]["pairs"]} == {"5.4 mm"}
    measures = scene["measures"]
    assert 3 <= len(measures) <= MOST_MEASURES
    ends = [[measure[end].split(".")[0] for end in ("from", "to")] for measure in measures.values()]
    assert all(first != second for first, second in ends)
    assert {"plate", "cover"} in [set(own) for own in ends]
    assert any({"plate"} < set(own) and any(name.startswith("bolt") for name in own) for own in ends)
    assert "limit" not in text.replace("no limits", "")
    assert all(deviation > 1e-6 for deviation in deviating(text, tmp_path).values())
    assert all(len(name) <= 24 for name in measures)


def test_bolts_without_play_place_the_cover_by_two_holes(tmp_path: Path) -> None:
    scene = yaml.safe_load(scene_from([bolted(tmp_path, 6.0)])[0])
    cover = placed_by(scene)["cover"]
    assert [relation["kind"] for relation in cover["relations"]] == ["coincident", "coaxial", "coaxial"]


def test_a_recess_for_heads_of_bolts_does_not_float_on_them(tmp_path: Path) -> None:
    """Holes of ⌀13 over holes of ⌀6, for heads of bolts: their axes meet, and no bolt plays in them by 7 mm."""
    plate, cover = cq.Workplane().box(90, 60, 12).translate((2, 1, 6)), cq.Workplane().box(80, 50, 5)
    shapes = {"plate": holed(plate, 6.0), "cover": holed(cover.translate((1, 2, 14.5)), 13.0)}
    placed = placed_by(yaml.safe_load(scene_from([step_file(shapes, tmp_path / "recess.step")])[0]))
    assert placed["cover"]["kind"] == "mate"
    assert [relation["kind"] for relation in placed["cover"]["relations"]] == ["coincident", "coaxial", "coaxial"]


def test_a_single_part_has_distances_and_no_verdict_on_zones_that_hold_by_construction(tmp_path: Path) -> None:
    content = nist_file("ctc_01")
    text, _ = scene_from([content])
    (tmp_path / content.path.name).write_bytes(content.content)
    measures = yaml.safe_load(text)["measures"]
    assert {measure["kind"] for measure in measures.values()} == {"gap"}
    assert 3 <= len(measures) <= MOST_MEASURES
    assert "upper_limit" not in text
    assert all(deviation > 1e-6 for deviation in deviating(text, tmp_path).values())
    for name, measure in measures.items():
        nominal = float(re.search(re.escape(name) + r": .*nominally (\S+) mm", text)[1])  # type: ignore[index]
        assert nominal > 0.0, measure


def candidate(name: str, group: tuple[str, ...], weight: float = 1.0) -> Candidate:
    entry = Entry("measures", name, [Wording(("{}",))])
    return Candidate(entry, (group[0], name, "b", "c", "d", "0"), group, weight)


def test_measures_are_ranked_by_turns_the_largest_parts_first_and_still_ones_are_left_out() -> None:
    small, large, gap = ("in", "nut"), ("in", "plate"), ("to", "plate")
    made = [
        candidate("gap", gap, 9.0), candidate("a", small, 1.0), candidate("b", small, 1.0),
        candidate("c", large, 5.0), candidate("still", large, 5.0),
    ]  # fmt: skip
    deviations = {"gap": 0.5, "a": 0.1, "b": 0.2, "c": 0.05, "still": 1e-7}
    for most, expected in ((9, ["c", "b", "gap", "a"]), (2, ["c", "b"]), (0, [])):
        assert [key[1] for key in ranked(made, deviations, most)] == expected


@pytest.mark.parametrize("most", [1, 10])
def test_of_both_directions_across_one_pair_the_one_that_varies_more_is_taken(most: int) -> None:
    entries = [Entry("measures", name, [Wording(("{}",))]) for name in ("x", "y")]
    key = ("on", "a", "b", "(1,)", "(2,)")
    made = [Candidate(entry, (*key, str(k)), ("on", "a", "b")) for k, entry in enumerate(entries)]
    assert ranked(made, {"x": 0.1, "y": 0.3}, most) == ((*key, "1"),)
