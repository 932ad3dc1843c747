"""Patterns of features, and parts that are like others: what they stand for, and what is refused."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from tol3d.assembly.grammar.drawing import Drawing, Stated
from tol3d.errors import SceneError
from tol3d.scene import Scene
from tol3d.simulate import load

HOLE = "kind: cylinder, at: [1 in, 2 mm, 0.1 mm], axis: [0, 0, 1], length: 6 mm, diameter: 8 mm, hole: true"
PLATE = """\
scene: plates
parts:
  plate:
    kind: solid
    features:
      floor: {kind: plane, at: [50 mm, 50 mm, 0 mm], normal: [0, 0, 1], extent: [100 mm, 100 mm]}
      hole: {HOLE}
  other: {kind: solid, like: plate, placed: {at: [0 mm, 0 mm, 20 mm]}}
  third: {kind: solid, like: other, features: {hole 3: {HOLE3}, pip: {kind: point, at: [0 mm, 0 mm, 0 mm]}}}
tolerances:
  position: {kind: position, of: plate.hole, zone: {diameter: 0.1 mm}, law: {kind: normal}, datums: [floor]}
  tight: {kind: position, of: other.hole 2, zone: {diameter: 0.05 mm}, law: {kind: normal}, datums: [floor]}
  flat: {kind: flatness, of: plate.floor, zone: {width: 0.01 mm}}
  size: {kind: size, of: plate.hole 1, distribution: {kind: normal, lower: 0 mm, upper: 0.03 mm}}
moves:
  a: {kind: fix, part: plate}
  b: {kind: fix, part: other}
  c: {kind: fix, part: third}
measures:
  m: {kind: gap, from: plate.hole 1, to: third.hole 4, along: [1, 0, 0]}
"""


def plates(tmp_path: Path, pattern: str, **instead: str) -> Scene:
    text = PLATE.replace("{HOLE}", f"{{{HOLE}, pattern: {pattern}}}").replace("{HOLE3}", f"{{{HOLE}}}")
    for old, new in instead.items():
        assert old in text
        text = text.replace(old, new, 1)
    (tmp_path / "scene.yaml").write_text(text)
    return load(tmp_path / "scene.yaml")


def places(scene: Scene, part: str = "plate") -> dict[str, list[str]]:
    features = Drawing(scene).features[part]
    return {name: [str(own) for own in spec.at or ()] for name, spec in features.items() if name.startswith("hole")}


def test_places_are_those_that_one_would_write(tmp_path: Path) -> None:
    scene = plates(tmp_path, "{rows: 2, columns: 2, pitch: [0.2 mm, 1 in]}")
    assert places(scene) == {  # 0.1 + 0.2 is 0.3, not 0.30000000000000004
        "hole 1": ["1 in", "2 mm", "0.1 mm"],
        "hole 2": ["25.6 mm", "2 mm", "0.1 mm"],
        "hole 3": ["1 in", "27.4 mm", "0.1 mm"],
        "hole 4": ["25.6 mm", "27.4 mm", "0.1 mm"],
    }
    up = plates(tmp_path, "{columns: 4, pitch: 0.2 mm, along: [0, 0, -1]}")
    assert [z for _, _, z in places(up).values()] == ["0.1 mm", "-0.1 mm", "-0.3 mm", "-0.5 mm"]


@pytest.mark.parametrize("seed", range(3))
def test_slanted_rows_and_columns_are_steps_along_unit_vectors(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    along, across = rng.normal(size=(2, 3))
    spec = {"rows": 3, "columns": 2, "pitch": ["7 mm", "5 mm"], "along": along.tolist(), "across": across.tolist()}
    found = Drawing(plates(tmp_path, json.dumps(spec))).features["plate"]
    x, y = (own / math.sqrt(own @ own) for own in (along, across))
    for row in range(3):
        for column in range(2):
            expected = np.array([25.4, 2.0, 0.1]) + 7.0 * column * x + 5.0 * row * y
            np.testing.assert_allclose(found[f"hole {2 * row + column + 1}"].origin, expected, atol=1e-12)


def stated(scene: Scene) -> dict[str, tuple[str, str]]:
    return {own.name: (own.entry, own.feature) for own in Drawing(scene).stated if isinstance(own, Stated)}


def test_each_feature_and_part_has_tolerances_of_its_own_and_what_it_says_itself_goes_before(tmp_path: Path) -> None:
    scene = plates(tmp_path, "{rows: 2, columns: 2, pitch: 30 mm}")
    expected = {f"position {k}": ("position", f"plate.hole {k}") for k in (1, 2, 3, 4)}
    expected |= {f"position {k} of other": ("position", f"other.hole {k}") for k in (1, 3, 4)}
    expected |= {f"position {k} of third": ("position", f"third.hole {k}") for k in (1, 3, 4)}
    expected |= {"tight": ("tight", "other.hole 2"), "tight of third": ("tight", "third.hole 2")}
    for name, feature in (("flat", "floor"), ("size", "hole 1")):
        expected |= {name: (name, f"plate.{feature}")}
        expected |= {f"{name} of {part}": (name, f"{part}.{feature}") for part in ("other", "third")}
    assert stated(scene) == expected
    features = Drawing(scene).features
    assert set(features["third"]) == {"floor", "pip", "hole 1", "hole 2", "hole 3", "hole 4"}
    assert places(scene, "third")["hole 3"] == ["1 in", "2 mm", "0.1 mm"]  # its own
    assert places(scene, "other") == places(scene)


def test_a_part_may_have_another_pattern_than_the_one_that_it_is_like(tmp_path: Path) -> None:
    own = {
        "{hole 3: ": "{hole: ",
        f"{HOLE}}}, pip": f"{HOLE}, pattern: {{columns: 2, pitch: 9 mm}}}}, pip",
        "third.hole 4": "third.hole 2",
    }
    scene = plates(tmp_path, "{rows: 2, columns: 2, pitch: 30 mm}", **own)
    assert list(places(scene, "third")) == ["hole 1", "hole 2"]
    assert [name for name, (_, feature) in stated(scene).items() if feature.startswith("third.hole")] == [
        "position 1 of third",
        "tight of third",
        "size of third",
    ]


PATTERN = "7: parts.plate.features.hole.pattern"
GRID = "{rows: 2, columns: 2, pitch: 30 mm}"
CHAIN = "".join(f"  p{k}: {{kind: solid, like: {f'p{k - 1}' if k > 1 else 'third'}}}\n" for k in range(1, 9))
BAD: dict[str, tuple[str, dict[str, str], str]] = {
    "no rows": ("{rows: 0, columns: 2, pitch: 3 mm}", {}, f"{PATTERN}.rows: expected a number of at least 1, got 0"),
    "no pitch": ("{columns: 2}", {}, '7: parts.plate.features.hole.pattern: expected the key "pitch" here, found none'),
    "a bare pitch": ("{columns: 2, pitch: 3}", {}, f"{PATTERN}.pitch: expected a length with its unit"),
    "three pitches": (
        "{columns: 2, pitch: [1 mm, 1 mm, 1 mm]}",
        {},
        f"{PATTERN}.pitch: expected a length, or two: between columns and between rows, got a",
    ),
    "one": ("{pitch: 3 mm}", {}, f"{PATTERN}: expected 2 to 1000 features in rows and columns, got 1"),
    "too many": (
        "{rows: 40, columns: 40, pitch: 3 mm}",
        {},
        f"{PATTERN}: expected 2 to 1000 features in rows and columns, got 1600",
    ),
    "one way": (
        "{rows: 2, columns: 2, pitch: 3 mm, along: [0, 0, 1]}",
        {},
        f"{PATTERN}: expected `across`, from row to row, that is not along the columns, got none",
    ),
    "a number of its own": (
        GRID,
        {"      hole: ": "      hole 3: {kind: point, at: [1 mm, 1 mm, 1 mm]}\n      hole: "},
        "7: parts.plate.features.hole 3: expected a name of its own, for the pattern 'hole' has such a feature",
    ),
    "a whole pattern measured": (
        GRID,
        {"from: plate.hole 1": "from: plate.hole"},
        "20: measures.m.from: expected a feature of 'plate', got 'plate.hole', which it does not have",
    ),
    "a pattern of another kind": (
        GRID,
        {"kind: flatness, of: plate.floor": "kind: flatness, of: plate.hole"},
        "13: tolerances.flat.of: expected a plane or slot, got 'plate.hole', which is a cylinder",
    ),
    "a pattern and one of it": (
        GRID,
        {"of: other.hole 2": "of: plate.hole 2"},
        "12: tolerances.tight: expected one tolerance of 'plate.hole 2' for where it",
    ),
    "a taken name": (
        GRID,
        {"  flat:": "  position 2:"},
        "13: tolerances.position 2: expected another name: 'position' has 'position 2' for 'plate.hole 2'",
    ),
    "too many in the scene": (
        "{rows: 40, columns: 25, pitch: 3 mm}",
        {"tolerances:\n": "".join(f"  p{k}: {{kind: solid, like: plate}}\n" for k in range(97)) + "tolerances:\n"},
        "106: parts.p96: expected at most 100000 features in a scene, got 100102 up to here",
    ),
    "like nobody": (
        GRID,
        {"like: plate": "like: plat"},
        "8: parts.other.like: expected the name of a solid part, got 'plat', which is not",
    ),
    "like itself": (
        GRID,
        {"like: plate": "like: other"},
        "8: parts.other.like: expected a part that is not like itself, got a ring: other like other",
    ),
    "a ring": (
        GRID,
        {"like: plate": "like: third"},
        "8: parts.other.like: expected a part that is not like itself, got a ring: other like third like other",
    ),
    "too many in sequence": (
        GRID,
        {"tolerances:\n": CHAIN + "tolerances:\n"},
        "16: parts.p7.like: expected at most 8 parts in sequence that are each like another, got one",
    ),
}


@pytest.mark.parametrize("what", BAD)
def test_what_has_no_sense_is_told_in_one_line(tmp_path: Path, what: str) -> None:
    pattern, instead, expected = BAD[what]
    with pytest.raises(SceneError) as raised:
        plates(tmp_path, pattern, **instead)
    said = raised.value.problems
    assert len(said) == 1, said
    assert said[0].startswith(f"{tmp_path / 'scene.yaml'}:{expected}"), said[0]
