"""Values of a scene's text replaced: the asked value alone, in the asked line alone."""

import difflib
import random
from collections.abc import Iterator
from copy import deepcopy
from typing import Any

import pytest
import yaml
from ruamel.yaml import YAML

from tol3d.errors import InputError
from tol3d.scene.bundled import bundled_scenes
from tol3d.scene.splice import flow_text, spliced

TEXT = """\
scene: a pair  # of gears
parts:
  pinion: &gear {kind: spur_gear, teeth: 20, module: 2 mm}   # the small one
  wheel: {<<: *gear, teeth: 50}
tolerances:
  thin:
    kind: tooth_thickness
    of: pinion   # both sides
    distribution: &thin {kind: normal, lower: '-50 um', upper: -30 um}

  thick: {kind: tooth_thickness, of: wheel, distribution: *thin}
# the order of assembly
moves:
- {kind: mesh}
- [1, 2.50, 3]
"""


def by_another_parser(text: str) -> Any:
    """Plain values, with merges and aliases written out."""
    return YAML(typ="safe").load(text)


def changed_lines(before: str, after: str) -> list[str]:
    lines = difflib.unified_diff(before.splitlines(), after.splitlines(), n=0, lineterm="")
    return [line for line in lines if line[0] in "+-" and line[:3] not in ("+++", "---")]


def leaves(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], Any]]:
    pairs = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else None
    if pairs is None:
        yield path, value
        return
    for key, own in pairs:
        yield from leaves(own, (*path, key))


def put(values: Any, path: tuple[Any, ...], value: Any) -> Any:
    found = deepcopy(values)
    here = found
    for key in path[:-1]:
        here[key] = deepcopy(here[key]) if isinstance(here, list) or key in here else {}
        here = here[key]
    here[path[-1]] = value
    return found


THICK = "+  thick: {kind: tooth_thickness, of: wheel, distribution: "


@pytest.mark.parametrize(
    ("path", "value", "lines"),
    [
        (("parts", "wheel", "teeth"), 51, ["+  wheel: {<<: *gear, teeth: 51}"]),
        (("parts", "wheel", "module"), "3 mm", ["+  wheel: {<<: *gear, teeth: 50, module: 3 mm}"]),
        (("tolerances", "thin", "of"), "wheel", ["+    of: wheel   # both sides"]),
        (
            ("tolerances", "thick", "distribution", "upper"),
            "0 um",
            [THICK + "{kind: normal, lower: -50 um, upper: 0 um}}"],
        ),
        (
            ("tolerances", "thin", "distribution", "lower"),
            "-9 um",
            [
                "+    distribution: {kind: normal, lower: '-9 um', upper: -30 um}",
                THICK + "&thin {kind: normal, lower: '-50 um', upper: -30 um}}",
            ],
        ),
        (("tolerances", "b: c"), {"kind": "x", "on": ["a, b", True]}, ['+  "b: c": {kind: x, on: ["a, b", true]}']),
        (("tolerances", "thin", "form"), "5 um", ["+    form: 5 um"]),
        (("measures", "gap"), {"kind": "y"}, ["+measures:", "+  gap: {kind: y}"]),
        (("moves", 1, 1), 2.75, ["+- [1, 2.75, 3]"]),
        (("tolerances", "thin"), {"kind": "z"}, ["+  thin: {kind: z}"]),
    ],
)
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_a_value_is_written_in_its_place(path: tuple[Any, ...], value: Any, lines: list[str], newline: str) -> None:
    text = TEXT.replace("\n", newline)
    after = spliced(text, path, value)
    assert by_another_parser(after) == put(by_another_parser(text), path, value)
    if "thin" not in path[-1:] or isinstance(value, str):  # its anchor moves to the alias, which is a line more
        assert [line for line in changed_lines(text, after) if line[0] == "+"] == lines
    assert after.count("\r\n") == after.count("\n") * (newline == "\r\n")


def one_line_each(name: str, count: int) -> None:
    """Some values of a bundled scene, each as another parser reads it, and nothing else; shared ones take two lines."""
    text = bundled_scenes()[name].read_text("utf-8")
    values = yaml.load(text, yaml.CSafeLoader)
    found = [*leaves(values)]
    for path, old in random.Random(1).sample(found, min(count, len(found))):
        new: Any = f"{old} x" if isinstance(old, str) else 7.25
        after = spliced(text, path, new)
        assert yaml.load(after, yaml.CSafeLoader) == put(values, path, new), path
        lines = changed_lines(text, after)
        assert "&" in "".join(lines) or len([line for line in lines if line[0] == "+"]) == 1, (path, lines)


@pytest.mark.parametrize("name", ["spur_pair", "part_in_fixture"])
def test_a_change_of_a_bundled_scene_is_one_line(name: str) -> None:
    one_line_each(name, 12)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(bundled_scenes()))
def test_changes_of_every_bundled_scene_are_one_line_each(name: str) -> None:
    one_line_each(name, 30)


@pytest.mark.parametrize(
    "path", [("parts", "pinion", "teeth", "more"), ("moves", "first"), ("parts", 0), ("moves", 7, "x")]
)
def test_a_path_that_leads_nowhere_is_refused(path: tuple[Any, ...]) -> None:
    with pytest.raises(InputError, match="expected"):
        spliced(TEXT, path, 1)


@pytest.mark.parametrize(
    "value", ["", " a", "a: b", "no #", "- x", "true", "1.5", "~", "é {", "two\nlines", "'", '"', "@x"]
)
def test_texts_are_quoted_where_they_would_be_read_otherwise(value: str) -> None:
    assert by_another_parser(f"{{x: {flow_text(value)}}}") == {"x": value}
    assert by_another_parser(spliced("scene: a\nparts: {}\n", ("scene",), value))["scene"] == value
