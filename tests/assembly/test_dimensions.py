"""A dimension from datums is longer where its deviation is positive, whichever way the face looks."""

import math
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import pytest
from assembly_trials import assembled, constant

from tol3d.assembly.presenting.tables import drawing_blocks
from tol3d.errors import SceneError
from tol3d.report.page import page

LONGER = 0.12  # mm
HALF = math.sqrt(0.5)

FEATURES = """
      foot: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [60 mm, 40 mm]}
      lip: {kind: plane, at: [20 mm, 0 mm, 40.1 mm], normal: [0, 0, -1], extent: [20 mm, 40 mm]}
      top: {kind: plane, at: [20 mm, 0 mm, 50 mm], normal: [0, 0, 1], extent: [20 mm, 40 mm]}
      well: {kind: plane, at: [5 mm, 5 mm, -20 mm], normal: [0, 0, 1], extent: [10 mm, 10 mm]}
      chamfer: {kind: plane, at: [30 mm, 0 mm, 45 mm], normal: [-1, 0, -1], extent: [5 mm, 20 mm]}
      bore: {kind: cylinder, at: [10 mm, 0 mm, 10 mm], axis: [0, 0, 1], length: 20 mm, diameter: 6 mm, hole: true}
      stop: {kind: plane, at: [35 mm, 3 mm, 10 mm], normal: [-1, 0, 0], extent: [10 mm, 10 mm]}
      seat 1: {kind: cylinder, at: [0 mm, 8 mm, 5 mm], axis: [1, 0, 0], length: 10 mm, diameter: 6 mm}
      seat 2: {kind: cylinder, at: [50 mm, 8 mm, 5 mm], axis: [1, 0, 0], length: 10 mm, diameter: 6 mm}
      wall: {kind: plane, at: [25 mm, -7 mm, 5 mm], normal: [0, 1, 0], extent: [10 mm, 10 mm]}
      groove: {kind: slot, at: [-9 mm, 0 mm, 10 mm], normal: [1, 0, 0], extent: [10 mm, 10 mm], width: 4 mm}
      ball: {kind: sphere, at: [0 mm, 30 mm, 10 mm], diameter: 4 mm}
      spot: {kind: point, at: [3 mm, 18 mm, 14 mm], normal: [0, 1, 0]}
      level: {kind: plane, at: [9 mm, 9 mm, 0 mm], normal: [0, 0, 1], extent: [5 mm, 5 mm]}
      corner: {kind: point, at: [9 mm, 9 mm, 12 mm]}
"""

DIMENSIONS: Mapping[str, tuple[str, str, str, float]] = {  # of, datums, measured along, distance with the deviation
    "back": ("lip", "foot", "[0, 0, 1]", 40.1 + LONGER),
    "front": ("top", "foot", "[0, 0, 1]", 50.0 + LONGER),
    "below": ("well", "foot", "[0, 0, -1]", 20.0 + LONGER),
    "slanted": ("chamfer", "foot", "[0, 0, 1]", 45.0 + HALF * LONGER),
    "from an axis": ("stop", "foot, bore", "[1, 0, 0]", 25.0 + LONGER),
    "from two seats": ("wall", "seat 1-seat 2", "[0, -1, 0]", 15.0 + LONGER),
    "to a slot": ("groove", "foot, bore", "[-1, 0, 0]", 19.0 + LONGER),
    "from a ball": ("spot", "ball", "[0, -1, 0]", 12.0 + LONGER),
}
"""The foot holds no place along x, so that `bore` is the first datum off which the stop and the slot lie."""


def scene(dimensions: str, measures: str) -> str:
    return (
        f"scene: a hook\nparts:\n  hook:\n    kind: solid\n    features:{FEATURES}"
        f"tolerances:\n{dimensions}moves:\n  clamp: {{kind: fix, part: hook}}\nmeasures:\n{measures}"
    )


def dimension(name: str, of: str, datums: str, more: str = "") -> str:
    return (
        f"  {name}: {{kind: plus_minus, of: hook.{of}, datums: [{datums}], distribution: {constant(LONGER)}{more}}}\n"
    )


@cache
def all_dimensions() -> str:
    """Each dimension measured, from a foot that lies 0.3 mm off itself."""
    dimensions = "".join(dimension(name, of, datums) for name, (of, datums, _, _) in DIMENSIONS.items())
    dimensions += f"  foot off: {{kind: plus_minus, of: hook.foot, distribution: {constant(0.3)}}}\n"
    measures = "".join(
        f"  {name} measured: {{kind: gap, from: hook.{datums.split(', ')[-1].split('-')[0]}, to: hook.{of}, "
        f"along: {along}}}\n"
        for name, (of, datums, along, _) in DIMENSIONS.items()
    )
    return scene(dimensions, measures)


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_a_positive_deviation_makes_every_distance_from_its_datum_longer(tmp_path: Path, method: str) -> None:
    found = assembled(all_dimensions(), tmp_path).drawn(1, method)
    for name, (*_, distance) in DIMENSIONS.items():
        assert found[f"{name} measured"][0] == pytest.approx(distance, abs=1e-9), name


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_a_direction_that_is_written_counts_as_written(tmp_path: Path, method: str) -> None:
    for z, distance in ((1, 40.1 + LONGER), (-1, 40.1 - LONGER)):
        text = scene(
            dimension("height", "lip", "foot", f", along: [0, 0, {z}]"),
            "  seen: {kind: gap, from: hook.foot, to: hook.lip, along: [0, 0, 1]}\n",
        )
        assert assembled(text, tmp_path).drawn(1, method)["seen"][0] == pytest.approx(distance, abs=1e-9)


@pytest.mark.parametrize(
    ("of", "datums", "words"),
    [
        ("level", "foot", r"and 'hook\.level' lies off none of its datums \(foot\) along its normal"),
        ("stop", "foot", r"and 'hook\.stop' lies off none of its datums \(foot\) along its normal"),
        ("corner", "foot", r"and 'hook\.corner' has no normal to say it"),
        ("ball", "foot", r"and 'hook\.ball' has no normal to say it"),
        ("bore", "foot", "expected a direction across the axis as `along`"),
    ],
)
def test_where_no_datum_says_which_way_is_longer_along_is_asked_for(
    tmp_path: Path, of: str, datums: str, words: str
) -> None:
    text = scene(dimension("own", of, datums), "  seen: {kind: gap, from: hook.foot, to: hook.lip, along: [0, 0, 1]}\n")
    with pytest.raises(SceneError, match=rf"tolerances\.own: .*{words}"):
        assembled(text, tmp_path)


def test_check_says_what_a_positive_deviation_does_to_each_dimension(tmp_path: Path) -> None:
    more = dimension("as written", "level", "foot", ", along: [0, 0, 1]").replace("hook.level", "hook.corner")
    more += dimension("against", "ball", "foot, bore", ", along: [0, 0, -1]")
    text = all_dimensions().replace("tolerances:\n", f"tolerances:\n{more}")
    tables = page(*drawing_blocks(assembled(text, tmp_path).system)).tables
    (table,) = (own for own in tables if own.headings[-1].text == "a positive deviation moves it")
    assert {row.label: row.cells[-1] for row in table.rows} == {
        "back": "along z: longer, away from foot",
        "front": "along z: longer, away from foot",
        "below": "along -z: longer, away from foot",
        "slanted": "along (0.7071, 0, 0.7071): longer, away from foot",
        "from an axis": "along x: longer, away from bore",
        "from two seats": "along -y: longer, away from seat 1-seat 2",
        "to a slot": "along -x: longer, away from bore",
        "from a ball": "along -y: longer, away from ball",
        "foot off": "along -z: out of the material",
        "as written": "along z: longer, away from foot",
        "against": "along -z: shorter, towards foot",
    }
