"""Scenes of many parts, written by merge keys, likes, patterns and included files, against the same written out."""

import json
import random
import re
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import pytest
import yaml
from assembly_trials import Assembled
from fixtures import Command
from places import ROOT, SCENES
from scene.scene_schema import judged

from tol3d import Overrides, RunError
from tol3d.errors import SceneError
from tol3d.kinds import all_kinds
from tol3d.scene import Scene, read_scene
from tol3d.scene.edit import with_tolerances, write_scene
from tol3d.scene.place import plain
from tol3d.scene.text import read_scene_text
from tol3d.simulate import load, replay, run_scene, simulation_of

SECTIONS = ("parts", "tolerances", "moves", "measures")
TRIALS = 64
ZERO = [0, 0, 0]


# an expander of its own ------------------------------------------------------------------------------


def mm(values: Iterable[float]) -> list[str]:
    return [f"{value:g} mm" for value in values]


def numbers(lengths: list[str]) -> list[float]:
    return [float(own.removesuffix(" mm")) for own in lengths]


def together(folder: Path, name: str) -> dict[str, Any]:
    """A scene with the entries of what it includes; lengths are whole mm."""
    data = yaml.safe_load((folder / name).read_text())  # it knows merge keys
    found: dict[str, Any] = {section: {} for section in SECTIONS}
    for prefix, spec in data.pop("include", {}).items():
        spec = {"file": spec} if isinstance(spec, str) else spec
        inner = together(folder / Path(spec["file"]).parent, Path(spec["file"]).name)
        for section in SECTIONS:
            for own, given in inner[section].items():
                entry = prefixed(given, prefix)
                if section == "parts" and "at" in spec:
                    at = zip(numbers(spec["at"]), numbers(entry.get("placed", {}).get("at", mm(ZERO))), strict=True)
                    entry["placed"] = {"at": mm([a + b for a, b in at])}
                found[section][f"{prefix} {own}"] = entry
    return {**data, **{section: found[section] | data.get(section, {}) for section in SECTIONS}}


def written_out(folder: Path, name: str) -> dict[str, Any]:
    """A scene without include, like or pattern."""
    found = together(folder, name)
    parts, tolerances = found["parts"], dict[str, Any]()
    for part in parts.values():
        part["features"] = dict(in_rows(part.get("features", {})))
        part["copied"] = part.pop("like", None)
        if part["copied"]:
            part["features"] = parts[part["copied"]]["features"] | part["features"]
    for own, entry in found["tolerances"].items():
        part, _, feature = entry["of"].partition(".")
        holders = [part, *(name for name, other in parts.items() if other["copied"] == part)]
        for holder in holders:
            ending = "" if holder == part else f" of {holder}"
            members = [its for its in parts[holder]["features"] if re.fullmatch(rf"{feature} \d+", its)]
            for its in [feature] if feature in parts[holder]["features"] else members:
                tolerances[own + its.removeprefix(feature) + ending] = {**entry, "of": f"{holder}.{its}"}
    for part in parts.values():
        del part["copied"]
    return {**found, "tolerances": tolerances}


def prefixed(value: Any, prefix: str, key: str = "") -> Any:
    if isinstance(value, dict):
        return {own: prefixed(its, prefix, own) for own, its in value.items()}
    if isinstance(value, list):
        return [prefixed(its, prefix) for its in value]
    return f"{prefix} {value}" if key in ("of", "part", "from", "to", "like") else value


def in_rows(features: dict[str, Any]) -> list[tuple[str, Any]]:
    found = []
    for name, own in features.items():
        pattern = own.pop("pattern", None)
        if pattern is None:
            found.append((name, own))
            continue
        pitch = pattern["pitch"]
        k, (apart, between) = 0, numbers(pitch if isinstance(pitch, list) else [pitch, pitch])
        for row in range(pattern.get("rows", 1)):
            for column in range(pattern.get("columns", 1)):
                k, (x, y, z) = k + 1, numbers(own["at"])
                found.append((f"{name} {k}", {**own, "at": mm([x + column * apart, y + row * between, z])}))
    return found


def columns(scene: Scene) -> Mapping[str, bytes]:
    """The bits of what both methods make of its first trials, and the names of its contributors."""
    made = Assembled(simulation_of(scene))
    found = {
        f"{method} {name}": values.tobytes()
        for method in ("exact", "analytic")
        for name, values in made.drawn(TRIALS, method).items()
    }
    return found | {"contributors": "|".join(own.name for own in made.system.contributors).encode()}


def assert_alike(folder: Path, name: str) -> Scene:
    scene, plain = load(folder / name), written_out(folder, name)
    (folder / "by hand.yaml").write_text(json.dumps(plain))
    by_hand = load(folder / "by hand.yaml")
    placed = [{name: vars(part)["placed"] for name, part in its.parts.items()} for its in (scene, by_hand)]
    assert placed[0] == placed[1]
    assert columns(scene) == columns(by_hand)
    return scene


# the document's ---------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def rack(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("rack")
    document = (ROOT / "docs" / "scene.md").read_text(encoding="utf-8")
    for name, text in re.findall(r"```yaml\n# (\w+\.yaml): .*\n((?:.*\n)*?)```", document):
        (folder / name).write_text(text)
    return folder


def test_the_documents_bays_are_what_their_expansion_by_hand_is(rack: Path) -> None:
    (rack / "two.yaml").write_text(
        "scene: two\ninclude: {u: bay.yaml, v: {file: bay.yaml, at: [600 mm, 0 mm, 250 mm]}}\nmeasures:\n"
        "  span: {kind: gap, from: u c1.lens, to: v c4.lens, along: [0, 0, 1]}\n"
    )
    assert_alike(rack, "two.yaml")


@pytest.mark.slow
def test_the_documents_rack_has_what_it_says(rack: Path) -> None:
    scene = load(rack / "rack.yaml")
    lines = sum(len((rack / f"{name}.yaml").read_text().splitlines()) + 1 for name in ("bay", "row", "rack"))
    contributors = [own.name for own in simulation_of(scene).system.contributors]
    assert (len(scene.parts), len(contributors), len(scene.measures), lines) == (300, 960, 241, 86)
    assert "r1 b3 A2 of r1 b3 c2" in contributors
    assert str(vars(scene.parts["r6 b10 c4"])["placed"].at[2]) == "1250 mm"
    judged((rack / "rack.yaml").read_text())
    judged((rack / "bay.yaml").read_text())


# random ones ------------------------------------------------------------------------------------------


HOLES = "{kind: cylinder, axis: [0, 0, 1], length: 10 mm, diameter: 4 mm, hole: true, at: [20 mm, 20 mm, 5 mm]"
BODY = """\
      A1: &A@ {kind: point, at: [10 mm, 10 mm, 0 mm], normal: [0, 0, -1]}
      A2: {<<: *A@, at: [90 mm, 10 mm, 0 mm]}
      A3: {<<: *A@, at: [50 mm, 90 mm, 0 mm]}
      B1: &B@ {<<: *A@, at: [10 mm, 0 mm, 5 mm], normal: [0, -1, 0]}
      B2: {<<: *B@, at: [90 mm, 0 mm, 5 mm]}
      C1: {<<: [*B@, *A@], at: [0 mm, 50 mm, 5 mm], normal: [-1, 0, 0]}
      p: &p@ {at: [20 mm, 30 mm, 10 mm], <<: *A@, normal: [0, 0, 1]}
      top: &plane@ {kind: plane, at: [50 mm, 50 mm, 10 mm], normal: [0, 0, 1], extent: [100 mm, 100 mm]}
      back: {<<: *plane@, at: [50 mm, 0 mm, 15 mm], normal: [0, 1, 0], extent: [100 mm, 10 mm]}
      left: {<<: *plane@, at: [0 mm, 50 mm, 15 mm], normal: [1, 0, 0], along: [0, 1, 0]}
"""
TOLERANCES = """\
tolerances:
  t0: &t {kind: plus_minus, of: q0.A1, distribution: {kind: normal, mean: 0 mm, sigma: 0.01 mm}}
  t1: {<<: *t, of: q0.A2}
  t2: {kind: profile, of: q0.top, zone: {width: 0.05 mm}, law: {kind: uniform}}
moves:
  m0: {kind: fix, part: q0}
"""
ON = (("A1", "top"), ("A2", "top"), ("A3", "top"), ("B1", "back"), ("B2", "back"), ("C1", "left"))


def stack(rng: random.Random, files: list[str]) -> str:
    """A file: some blocks on each other, holes in rows, parts like others, and files included before."""
    names = [f"q{k}" for k in range(rng.randrange(2, 4))]
    text = "scene: any\n" + ("include:\n" if files else "")
    for k, file in enumerate(rng.sample(files, rng.randrange(1, len(files) + 1)) if files else []):
        at = mm([rng.randrange(-500, 500) for _ in range(3)])
        text += f"  i{k}: {file if rng.random() < 0.3 else json.dumps({'file': file, 'at': at})}\n"
    pitch, rows, across = rng.randrange(5, 20), rng.randrange(1, 3), rng.randrange(2, 4)
    pattern = f"pattern: {{rows: {rows}, columns: {across}, pitch: [{pitch} mm, {pitch + 3} mm]}}"
    text += "parts:\n"
    for k, name in enumerate(names):
        text += f"  {name}:\n    kind: solid\n    placed: {{at: [0 mm, 0 mm, {10 * k} mm]}}\n"
        if k and rng.random() < 0.6:
            text += f"    like: q0\n    features: {{extra: {{<<: *p0, at: [1 mm, 2 mm, {k} mm]}}}}\n"
        else:
            text += f"    features:\n{BODY.replace('@', str(k))}      hole: {HOLES}, {pattern}}}\n"
    text += TOLERANCES
    for k, name in enumerate(names[1:], start=1):
        pairs = [f"{{from: {name}.{own}, to: {names[k - 1]}.{face}}}" for own, face in ON]
        text += f"  m{k}:\n    kind: three_two_one\n    part: {name}\n    primary: [{', '.join(pairs[:3])}]\n"
        text += f"    secondary: [{', '.join(pairs[3:5])}]\n    tertiary: [{pairs[5]}]\n"
    last = f"{names[-1]}.hole {rows * across}"
    text += f"measures:\n  g0: {{kind: gap, from: q0.hole 1, to: {last}, along: [0, 0, 1]}}\n"
    return text + f"  g1: {{kind: gap, from: q0.p, to: {names[-1]}.p, along: [1, 0, 0]}}\n"


@pytest.mark.parametrize("seed", range(12))
def test_random_scenes_are_what_their_expansion_by_hand_is(tmp_path: Path, seed: int) -> None:
    rng, files = random.Random(seed), list[str]()
    for k in range(3):
        name = f"f{k}.yaml"
        (tmp_path / name).write_text(stack(rng, files))
        files.append(name)
    scene = assert_alike(tmp_path, files[-1])
    assert any(name.startswith("i0 ") for name in scene.parts)


# files ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", sorted(SCENES.glob("*.yaml")), ids=lambda path: path.stem)
def test_a_bundled_scene_that_is_included_is_itself_under_other_names(path: Path, tmp_path: Path) -> None:
    alone = read_scene(path, all_kinds(), settle=False)
    for name in (path.name, *alone.file_names):
        (tmp_path / "below" / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path.parent / name, tmp_path / "below" / name)
    (tmp_path / "outer.yaml").write_text(f"scene: outer\ninclude: {{unit ü: below/{path.name}}}\n")
    scene = read_scene(tmp_path / "outer.yaml", all_kinds(), settle=False)
    for section in SECTIONS:
        assert list(scene.section(section)) == [f"unit ü {name}" for name in alone.section(section)]
    said, expected = (json.dumps({s: its.model_dump(mode="json")[s] for s in SECTIONS}) for its in (scene, alone))
    for name in alone.file_names:
        said = said.replace(json.dumps(f"below/{name}"), json.dumps(name))
    assert said.replace(json.dumps("unit ü ")[1:-1], "") == expected


BLOCK = """\
parts:
  block:
    kind: solid
    features:
      p: {kind: point, at: [1 mm, 2 mm, 3 mm], normal: [0, 0, 1]}
      q: {kind: point, at: [1 mm, 2 mm, 9 mm], normal: [0, 0, 1]}
tolerances:
  t: {kind: plus_minus, of: block.p, distribution: {kind: empirical, file: t.csv, column: t, unit: um}}
moves:
  stand: {kind: fix, part: block}
measures:
  m: {kind: gap, from: block.p, to: block.q, along: [0, 0, 1]}
"""
OUTER = "scene: outer\ninclude:\n  a: below/block.yaml\n  b: {file: below/block.yaml, at: [0 mm, 0 mm, 20 mm]}\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "below").mkdir()
    (tmp_path / "below" / "block.yaml").write_text(BLOCK)
    (tmp_path / "below" / "t.csv").write_text("t\n1\n2\n4\n")
    (tmp_path / "scene.yaml").write_text(OUTER)
    return tmp_path


def test_a_run_keeps_what_it_includes_and_is_made_again_without_the_sources(folder: Path) -> None:
    run = run_scene(folder / "scene.yaml", out=folder / "run", overrides=Overrides(trials=TRIALS))
    values = run.columns("geometric:b m")["geometric:b m"]
    assert {"below/block.yaml", "below/t.csv"} <= set(run.found.files)
    shutil.rmtree(folder / "below")
    (folder / "scene.yaml").unlink()
    assert replay(run, 5).geometric["b m"] == values[5]
    changed = next((folder / "run" / "files").glob("*block.yaml"))
    changed.write_text(changed.read_text().replace("9 mm", "8 mm"))
    with pytest.raises(RunError, match="was changed since the run was made"):
        replay(run, 5)


def test_a_changed_included_file_makes_another_run(folder: Path) -> None:
    asked = Overrides(trials=TRIALS)
    run_scene(folder / "scene.yaml", out=folder / "run", overrides=asked)
    (folder / "below" / "block.yaml").write_text(BLOCK.replace("9 mm", "8 mm"))
    with pytest.raises(RunError, match=r"below/block\.yaml"):
        run_scene(folder / "scene.yaml", out=folder / "run", overrides=asked)


LID = """\
  lid: {kind: solid, features: {r: {kind: point, at: [1 mm, 2 mm, 9 mm]}}}
tolerances:
"""
PUT = "  put: {kind: mate, part: lid, relations: [{kind: coincident, from: lid.r, to: block.q}]}\nmeasures:"
SHELF = """\
scene: shelf
include:
  a: below/block.yaml
  b: {file: below/block.yaml, without: [stand], at: [0 mm, 0 mm, 6 mm]}
moves:
  lay: {kind: mate, part: b block, relations: [{kind: coincident, from: b block.p, to: a block.q}]}
"""


def test_moves_of_an_included_file_come_after_the_scene_has_placed_its_part(folder: Path) -> None:
    text = BLOCK.replace("tolerances:\n", LID).replace("measures:", PUT)
    (folder / "below" / "block.yaml").write_text(text)
    (folder / "scene.yaml").write_text(SHELF)
    scene = load(folder / "scene.yaml")
    assert list(scene.moves) == ["a stand", "a put", "lay", "b put"]
    assert list(scene.parts) == ["a block", "a lid", "b block", "b lid"]


def test_an_entry_that_is_left_out_may_be_said_by_the_scene(folder: Path) -> None:
    own = '  b: {file: below/block.yaml, without: [t]}\ntolerances:\n  "b t": {kind: plus_minus, of: b block.q, '
    law = "distribution: {kind: normal, mean: 0 mm, sigma: 1 um}}\n"
    (folder / "scene.yaml").write_text(OUTER[: OUTER.index("  b:")] + own + law)
    judged((folder / "scene.yaml").read_text())
    scene = load(folder / "scene.yaml")
    assert {name: entry.model_dump()["of"] for name, entry in scene.tolerances.items()} == {
        "a t": "a block.p",
        "b t": "b block.q",
    }


def test_what_is_wrong_in_an_included_file_is_told_with_its_line(folder: Path) -> None:
    (folder / "below" / "block.yaml").write_text(BLOCK.replace("of: block.p", "of: blok.p"))
    (said,) = problems(folder)
    where = f"{folder / 'below' / 'block.yaml'}:8: tolerances.t.of: expected the name of a solid part, got 'blok'"
    assert said.startswith(where)
    (folder / "below" / "block.yaml").write_text(BLOCK.replace("along: [0, 0, 1]", "along: [0, 0]"))
    (said,) = problems(folder)
    assert said.startswith(f"{folder / 'below' / 'block.yaml'}:12: measures.m.along: expected three numbers")
    (folder / "below" / "block.yaml").write_text(BLOCK.replace("of: block.p", "of: block.z"))
    first, second = problems(folder)
    assert first.startswith(
        f"{folder / 'below' / 'block.yaml'}:8: tolerances.a t.of: expected a feature of 'a block', got 'a block.z'"
    )
    assert "tolerances.b t.of" in second


def problems(folder: Path) -> tuple[str, ...]:
    with pytest.raises(SceneError) as raised:
        load(folder / "scene.yaml")
    assert not any("\n" in said for said in raised.value.problems)
    return raised.value.problems


BLOCKS = OUTER.replace("below/", "")
MANY = "".join(f"  p{k}: {{kind: solid, like: p0}}\n" for k in range(1, 2001))
MANY_BLOCKS = "parts:\n  p: &p {kind: solid, features: {p: {kind: point, at: [0 mm, 0 mm, 0 mm]}}}\n"
BAD: Mapping[str, tuple[Mapping[str, str], str]] = {
    "a ring of two": (
        {"block.yaml": "include: {c: other.yaml}", "other.yaml": "include: {d: block.yaml}"},
        r"other\.yaml:1: include\.d: expected a file that does not include itself, got a ring: "
        r"block\.yaml includes other\.yaml includes block\.yaml",
    ),
    "itself": ({"scene.yaml": "scene: s\ninclude: {c: scene.yaml}"}, r"scene\.yaml:2: include\.c: .* a ring: scene"),
    "the scene": (
        {"block.yaml": "include: {c: ./scene.yaml}"},
        r"block\.yaml:1: .* does not include itself, got a ring",
    ),
    "out of the folder": (
        {"scene.yaml": BLOCKS.replace("a: block.yaml", "a: ../block.yaml")},
        r"scene\.yaml:3: include\.a: expected a file in the scene's folder, got '\.\./block\.yaml', which lies outside",
    ),
    "absolute": ({"scene.yaml": BLOCKS.replace("a: block.yaml", "a: /etc/passwd")}, r"scene\.yaml:3: .* lies outside"),
    "missing": (
        {"scene.yaml": BLOCKS.replace("a: block.yaml", "a: blok.yaml")},
        r"scene\.yaml:3: include\.a: expected a scene in the scene's folder, got 'blok\.yaml': No such file",
    ),
    "no scene": (
        {"block.yaml": "teeth: 12"},
        r"block\.yaml:1: expected a scene, or the parts of one \(parts:\), for it is included; found none",
    ),
    "text": ({"block.yaml": "just some words"}, r"block\.yaml:1: expected keys such as scene:, parts:"),
    "an unknown key": (
        {"block.yaml": BLOCK + "part: {}"},
        r'block\.yaml:13: part: unknown key "part"; did you mean "parts"',
    ),
    "two of one name": (
        {"scene.yaml": BLOCKS + BLOCK.replace("block", "a block")},
        r"scene\.yaml:6: parts\.a block: expected a name of its own, got 'a block' of .*block\.yaml:2, "
        r"which also stands in .*scene\.yaml:6; rename one",
    ),
    "two of one name in two sections": (
        {"scene.yaml": BLOCKS + "parts:\n  a m: {kind: solid, like: a block}\n"},
        r"block\.yaml:12: measures\.a m: expected a name of its own, got 'a m', which already stands in parts "
        r"\(line 6\); rename one",
    ),
    "a name that is not there": (
        {"scene.yaml": BLOCKS.replace("at: [0 mm, 0 mm, 20 mm]", "without: [stad]")},
        r"scene\.yaml:4: include\.b\.without\[0\]: expected a name of block\.yaml, got 'stad'; did you mean \"stand\"",
    ),
    "what is left out and used": (
        {"scene.yaml": BLOCKS.replace("at: [0 mm, 0 mm, 20 mm]", "without: [block]")},
        r"block\.yaml:8: tolerances\.b t\.of: expected the name of a solid part, got 'b block', which is not in the",
    ),
    "a dot": ({"scene.yaml": BLOCKS.replace("  a:", "  a.b:")}, r"include\.a\.b: expected a name without dots"),
    "no file": (
        {"scene.yaml": "scene: s\ninclude: {a: {at: [0 mm, 0 mm, 0 mm]}}"},
        r'include\.a: expected the key "file"',
    ),
    "nothing": ({"scene.yaml": "scene: s\ninclude:\n"}, r"scene\.yaml:2: include: expected keys with values, such as"),
    "too deep": (
        {"block.yaml": "include: {c: d0.yaml}"} | {f"d{k}.yaml": f"include: {{c: d{k + 1}.yaml}}" for k in range(9)},
        r"d6\.yaml:1: include\.c: expected at most 8 files that include each other, got more",
    ),
    "two thousand and one parts": (
        {"scene.yaml": f"scene: s\nparts:\n  p0: {{kind: solid}}\n{MANY}"},
        r"scene\.yaml:2: parts: expected at most 2000 parts in a scene, got 2001 up to here",
    ),
    "as many by doubling": (
        {"scene.yaml": "scene: s\ninclude: {a: d0.yaml, b: d0.yaml}", "d7.yaml": MANY_BLOCKS}
        | {f"d{k}.yaml": "include: {" + ", ".join(f"x{m}: d{k + 1}.yaml" for m in range(10)) + "}" for k in range(7)},
        r"d3\.yaml:1: include\.x2: expected at most 2000 parts in a scene, got 3000 up to here",
    ),
    "a gear elsewhere": (
        {"block.yaml": "parts: {w: {kind: housing}}"},
        r"scene\.yaml:4: include\.b\.at: expected none, for 'w' of block\.yaml is a housing, which has no place of its",
    ),
    "a merge of a number": (
        {"block.yaml": BLOCK + "study: {<<: 3}"},
        r"block\.yaml:13: study\.<<: expected a mapping beside",
    ),
    "a file by the name that runs keep": (
        {"block.yaml": "include: {c: below/../scene.yaml}", "scene.yaml": BLOCKS},
        r"block\.yaml:1: .* got a ring: scene\.yaml includes block\.yaml includes scene\.yaml",
    ),
}


@pytest.mark.parametrize("what", BAD)
def test_what_cannot_be_included_is_told_in_one_line(tmp_path: Path, what: str) -> None:
    texts, expected = BAD[what]
    for name, text in ({"scene.yaml": BLOCKS, "block.yaml": BLOCK, "t.csv": "t\n1\n2\n"} | dict(texts)).items():
        (tmp_path / name).write_text(text)
    said = problems(tmp_path)
    assert re.search(expected, said[0]), said[0]


def test_a_link_out_of_the_folder_is_no_way_in(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    outside = tmp_path_factory.mktemp("outside") / "block.yaml"
    shutil.move(folder / "below" / "block.yaml", outside)
    (folder / "below" / "block.yaml").symlink_to(outside)
    (said,) = problems(folder)
    assert "include.a: expected a scene in the scene's folder, got 'below/block.yaml': a link that leads out of" in said


def test_the_command_line_refuses_with_code_2(folder: Path, tol3d: Command) -> None:
    (folder / "below" / "block.yaml").unlink()
    code, out, err = tol3d("check", str(folder / "scene.yaml"))
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "include.a: expected a scene in the scene's folder, got 'below/block.yaml': No such file or directory" in err


# edited and kept --------------------------------------------------------------------------------------


def test_a_tolerance_of_an_included_file_is_changed_by_the_scene(folder: Path) -> None:
    scene = load(folder / "scene.yaml")
    spec = scene.distributed["b t"].model_copy(update={"description": "by hand"})
    edited = with_tolerances(scene, {"b t": spec})
    write_scene(edited, folder / "edited.yaml")
    assert "b: {file: below/block.yaml, at: [0 mm, 0 mm, 20 mm], without: [t]}" in edited.text
    again = load(folder / "edited.yaml")
    assert {name: own.description for name, own in again.tolerances.items()} == {"a t": "", "b t": "by hand"}


def test_copies_of_a_scene_take_included_files_along(folder: Path) -> None:
    assert set(load(folder / "scene.yaml").files) == {"below/block.yaml", "below/t.csv"}
    assert load(folder / "scene.yaml").file_names[0] == "below/block.yaml"


# merge keys -------------------------------------------------------------------------------------------

MERGED = """\
scene: merged
parts:
  a: &a {kind: spur_gear, teeth: 20, module: 2 mm, face_width: 10 mm}
  b: &b {<<: *a, teeth: 30}
  c: {face_width: 9 mm, <<: [*b, *a], module: 3 mm}
  "<<": {<<: *a}
"""


@pytest.mark.parametrize("parser", ["quick", "slow"])
def test_merge_keys_are_those_of_yaml_1_1(tmp_path: Path, parser: str) -> None:
    (tmp_path / "scene.yaml").write_text(
        MERGED if parser == "quick" else MERGED + "# \t\n"
    )  # tabs are read by the slow one
    top, origin = read_scene_text(tmp_path / "scene.yaml")
    expected = yaml.safe_load(MERGED.replace('  "<<"', "  d"))
    found = plain(top)
    found["parts"]["d"] = found["parts"].pop("<<")
    assert found == expected
    assert list(found["parts"]["c"]) == ["face_width", "kind", "teeth", "module"]
    assert origin.place(("parts", "c", "teeth")).line == 4
