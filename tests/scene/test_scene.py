"""Scenes that are right: what the shipped ones say, and how text becomes a Scene."""

import json
import pickle
import random
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml
from guides import quoted
from hypothesis import given
from hypothesis import strategies as st
from of_kind import known, of_kind
from places import ROOT
from pydantic import ValidationError
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError
from said_fields import fields_said, fields_within, unsaid
from scene.scene_schema import judged
from scene_texts import written

from tol3d import Scene, load_scene
from tol3d.errors import SceneError
from tol3d.gearing.grammar.measures import GearStudyOptions, NormalBacklashSpec
from tol3d.gearing.grammar.moves import MeshSpec
from tol3d.gearing.grammar.parts import GearSpec, SpurGearSpec
from tol3d.gearing.mechanism import GEARING
from tol3d.kinds import all_kinds
from tol3d.scene import Grammar, read_scene
from tol3d.scene.place import plain
from tol3d.scene.temperature import TemperatureSpec
from tol3d.scene.text import core_value, scene_text
from tol3d.statistics.distributions import Rayleigh

GEARS = Grammar((GEARING,))
Geared = GEARS.scene
SPUR_PAIR = ROOT / "scenes" / "spur_pair.yaml"
EVERY_FIELD = ROOT / "scenes" / "every_field.yaml"
EVERY_BEVEL_FIELD = ROOT / "scenes" / "every_bevel_field.yaml"
TWO_SIDED_TE = ROOT / "scenes" / "two_sided_te.yaml"
INTERNAL_PAIR = ROOT / "scenes" / "internal_pair.yaml"
TOOTH_DEVIATIONS = ROOT / "scenes" / "tooth_deviations.yaml"
MEASURED_TEETH = ROOT / "scenes" / "measured_teeth.yaml"
SCENES = sorted((ROOT / "scenes").glob("*.yaml"))
DOCUMENT = (ROOT / "docs" / "scene.md").read_text(encoding="utf-8")
QUOTED = re.findall(r"```yaml\n(.*?)```", DOCUMENT, re.DOTALL)
STUDIES = re.findall(r"```text\n(study:.*?)```", DOCUMENT, re.DOTALL)

SIGNS = (
    *"{}[]:,#&*!|>'\"%@`- \n?~\\/ab10.+=<é",
    "\n  ",
    ": ",
    " #",
    "\r\n",
    "---\n",
    "''",
    "|\n   ",
    ">-\n   ",
    "\\x41",
    "*a",
    "&a ",
)
SMALL = """
scene: small
parts:
  a: {kind: spur_gear, teeth: 20, module: 1 mm, face_width: 10 mm}
  b: {kind: spur_gear, teeth: 30, module: 1 mm, face_width: 10 mm, expansion: 11.5e-6 1/K}
moves:
  ab: {kind: mesh, driver: a, driven: b, centre_distance: 25 mm}
measures:
  play: {kind: normal_backlash, of: ab}
"""


TIGHT = "distribution: {kind: normal, lower: -1 um, upper: 1 um}"


def load(folder: Path, text: str, kinds: Grammar | None = None) -> Scene:
    path = written(text, folder)
    return load_scene(path, kinds)


# the paper's pair ---------------------------------------------------------------------------------


def test_the_spur_pair_is_that_of_the_papers_tables() -> None:
    scene = load_scene(SPUR_PAIR)
    parts = {name: of_kind(GearSpec, part) for name, part in scene.parts.items()}
    gears = {name: (part.teeth, part.module.internal, part.pressure_angle.number) for name, part in parts.items()}
    assert gears == {"pinion": (28, 2.5, 20.0), "wheel": (110, 2.5, 20.0)}
    move = of_kind(MeshSpec, scene.moves["gear pair"])
    assert known(move.centre_distance).internal == 172.5 == 2.5 * (28 + 110) / 2
    assert known(scene.measures["normal backlash"].lower_limit).internal == 0.015
    laws = {name: tolerance.distribution.resolve(scene.files) for name, tolerance in scene.distributed.items()}
    mean_and_sigma_um = {name: (1e3 * law.mean, 1e3 * law.sigma) for name, law in laws.items()}
    assert mean_and_sigma_um["pinion tooth thickness"] == pytest.approx(((-19 - 30) / 2, 11 / 6))
    assert mean_and_sigma_um["wheel tooth thickness"] == pytest.approx(((-21 - 32) / 2, 11 / 6))
    assert mean_and_sigma_um["centre distance"] == pytest.approx((0.0, 20 / 3))
    assert mean_and_sigma_um["bearing clearance"] == pytest.approx((16.0, 28 / 6))
    limits_um = {"wheel eccentricity": 31, "pinion eccentricity": 27, "reducer run-out": 8}
    assert {name: 6e3 * of_kind(Rayleigh, laws[name]).scale for name in limits_um} == pytest.approx(limits_um)
    assert len(laws) == 7


def test_the_papers_published_columns_agree_with_its_own_formulas() -> None:
    scene = load_scene(SPUR_PAIR)
    column = scene.published["paper, 3DCS"]
    for field in ("low_3sigma", "mean", "high_3sigma"):
        normal = getattr(column["normal backlash"], field).internal
        lost_motion = getattr(column["lost motion"], field).internal
        degrees = 0.12195 * 1e3 * normal / 275  # the paper's formula, normal backlash in um
        assert lost_motion * 57.29577951 == pytest.approx(degrees, abs=0.5 / 3600)  # printed to the second of arc
    # Table 3 is printed to 0.1 % a row, so its seven rows make 100 % to 0.35
    assert sum(column["normal backlash"].percents.values()) == pytest.approx(100.0, abs=0.35)


# every field --------------------------------------------------------------------------------------


def shoulders() -> tuple[str, str, str]:
    """The document's train, with a distribution of its reducer's backlash and with the data sheet's word for it.

    And that of helical gears whose shafts slide.
    """
    shoulder, sliding = quoted("trains")
    drawn = re.search(r"  reducer play:\n(    .*\n)+", shoulder)
    assert drawn
    by_data_sheet = shoulder.replace(drawn[0], "").replace("    ratio: 152 ", "    backlash: 1 arcmin\n    ratio: 152 ")
    return shoulder, by_data_sheet, sliding


HELICAL = """\
scene: helical pair
parts:
  a: {kind: helical_gear, teeth: 20, module: 2 mm, pressure_angle: 20 deg, helix_angle: 15 deg, hand: right,
    face_width: 20 mm, profile_shift: 0.1, addendum: 1, dedendum: 1.25, root_fillet: 0.5 mm, bore: 10 mm,
    expansion: 11.5e-6 1/K}
  b: {kind: helical_gear, teeth: 41, module: 2 mm, helix_angle: 15 deg, hand: left, face_width: 20 mm}
tolerances:
  thickness: {kind: tooth_thickness, of: b, measured: {balls: 3.5 mm},
    distribution: {kind: normal, lower: -90 um, upper: -60 um}}
moves:
  pair: {kind: mesh, driver: a, driven: b, centre_distance: 63.4 mm}
measures:
  play: {kind: normal_backlash, of: pair}
"""


def test_every_field_uses_every_field_of_every_kind(tmp_path: Path) -> None:
    known = fields_within(Geared)
    assert len({model for model, _ in known}) >= 24  # scene, study, 2 parts, 9 tolerances, 7 laws, mesh, 3 measures, …
    scenes = (EVERY_FIELD, EVERY_BEVEL_FIELD, INTERNAL_PAIR, TWO_SIDED_TE, TOOTH_DEVIATIONS, MEASURED_TEETH)
    said = {use for scene in scenes for use in fields_said(load_scene(scene, GEARS))}
    plain = SMALL.replace("  play:", "  normal backlash:")
    said |= {use for study in STUDIES for use in fields_said(load(tmp_path, plain + study, GEARS))}
    arcs = ", ".join(["1 um"] * 20)
    law = f"{{kind: given, right: [{arcs}], left: [{arcs}]}}"
    measured = f"tolerances: {{pitch: {{kind: pitch_deviation, of: a, flanks: each, law: {law}}}}}"
    said |= set(fields_said(load(tmp_path, f"{SMALL}{measured}\n", GEARS)))
    normal = "limits: {iso_class: 6}, law: {kind: normal, cpk: 1.33}"
    capable = f"tolerances: {{pitch: {{kind: pitch_deviation, of: a, flanks: each, {normal}}}}}"
    said |= set(fields_said(load(tmp_path, f"{SMALL}{capable}\n", GEARS)))
    span = f"{{kind: tooth_thickness, of: a, measured: {{span: 3}}, {TIGHT}}}"
    pins = f"{{kind: tooth_thickness, of: b, measured: {{pins: 3.5 mm}}, {TIGHT}}}"
    teeth = [
        f"{{kind: tooth_to_tooth, of: a, limits: {{{own}}}, law: {{kind: uniform}}}}"
        for own in ("grade: 7", "size: 9 um")
    ]
    measured = f"tolerances: {{span: {span}, pins: {pins}, graded: {teeth[0]}, sized: {teeth[1]}}}"
    said |= set(
        fields_said(
            load(
                tmp_path,
                f"{SMALL}default_law: {{kind: uniform}}\nstandard: iso\nenvelope: false\ngeneral: mK\n{measured}\n",
                GEARS,
            )
        )
    )
    said |= set(fields_said(load(tmp_path, HELICAL, GEARS)))
    heights = ", ".join(f"{name}: {{kind: tooth_thickness, of: {name[0]}, {TIGHT}}}" for name in ("a1", "b1"))
    both = "{between: [a1, b1], rho: 0.5}, {between: [a1, b1], matrix: [[1, 0.5], [0.5, 1]]}"
    said |= set(fields_said(load(tmp_path, f"{SMALL}tolerances: {{{heights}}}\ncorrelations: [{both}]\n", GEARS)))
    for default in (
        "{kind: normal, sigmas: 3}",
        "{kind: truncated_normal, sigmas: 3}",
        "{kind: uniform}",
        "{kind: triangular}",
    ):
        said |= set(fields_said(load(tmp_path, f"{SMALL}default_law: {default}\n", GEARS)))
    said |= {use for text in shoulders() for use in fields_said(load(tmp_path, text, GEARS))}
    assert unsaid(known, said) == set()


def test_the_documents_scenes_are_read(tmp_path: Path) -> None:
    assert load(tmp_path, QUOTED[0]).scene == "a pinion and its wheel"
    rings = (ROOT / "docs" / "internal_gears.md").read_text(encoding="utf-8")
    assert re.findall(r"```yaml\n(.*?)```", rings, re.DOTALL)[0] == INTERNAL_PAIR.read_text(encoding="utf-8")


def test_the_documents_message_is_what_the_tool_says(tmp_path: Path) -> None:
    text = SPUR_PAIR.read_text(encoding="utf-8").replace("lower: -30 um", "lower: -30", 1)
    with pytest.raises(SceneError) as caught:
        load(tmp_path, text)
    assert str(caught.value).replace(str(tmp_path / "scene.yaml"), "scenes/spur_pair.yaml") in DOCUMENT


# JSON Schema --------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_shipped_scenes_satisfy_the_json_schema(path: Path) -> None:
    judged(path.read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("teeth: 28", "tooth: 28"),
        ("module: 2.5 mm", "module: 2.5"),
        ("module: 2.5 mm", "module: 2.5 deg"),
        ("teeth: 28", "teeth: 0"),
        ("kind: rayleigh", "kind: raleigh"),
        ("kind: eccentricity", "direction: apart\n    kind: eccentricity"),
        ("engine: exact", "engine: exakt"),
    ],
)
def test_the_json_schema_refuses_what_it_can(old: str, new: str) -> None:
    with pytest.raises(jsonschema.ValidationError):
        judged(SPUR_PAIR.read_text(encoding="utf-8").replace(old, new, 1))


def test_the_json_schema_describes_the_fields() -> None:
    schema = Scene.model_json_schema()
    gear = schema["$defs"]["SpurGearSpec"]["properties"]
    assert gear["teeth"]["description"] == "number of teeth z"
    assert gear["pressure_angle"]["default"] == "20 deg"


# text to values -----------------------------------------------------------------------------------


@given(
    st.from_regex(r"[-+]?[0-9]{0,6}(\.[0-9]{0,4})?([eE][-+]?[0-9]{1,2})?", fullmatch=True)
    | st.sampled_from(["null", "~", "true", "False", "no", "on", "0o17", "0x1F", "1_000", "12:30", "2024-01-01", "x"])
)
def test_plain_scalars_are_those_of_yaml_1_2(text: str) -> None:
    value = core_value(text)
    try:
        expected: Any = json.loads(text)  # YAML 1.2 took JSON's scalars; the rest is in the table below
    except ValueError:
        others = {"~": None, "": None, "False": False, "0o17": 15, "0x1F": 31}
        number = re.fullmatch(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?", text)
        expected = others.get(text, (float(text) if re.search("[.eE]", text) else int(text)) if number else text)
    assert value == expected
    assert type(value) is type(expected)


def test_special_floats_are_read() -> None:
    assert core_value("-.inf") == -float("inf")
    assert str(core_value(".nan")) == "nan"


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_shipped_scenes_read_the_same_by_another_yaml_parser(path: Path) -> None:
    scene = read_scene(path, all_kinds(), settle=False)
    plain = yaml.safe_load(path.read_text(encoding="utf-8"))  # YAML 1.1; these scenes hold nothing it reads otherwise
    other = Scene.model_validate(plain)
    assert other.model_dump() == scene.model_dump()


def altered(text: str, rng: random.Random) -> str:
    """Some lines of a text with signs put in, taken out and exchanged."""
    lines = text.split("\n")
    first = rng.randrange(len(lines))
    piece = "\n".join(lines[first : first + rng.randrange(1, 12)])
    for _ in range(rng.randrange(1, 6)):
        at, sign = rng.randrange(len(piece) + 1), rng.choice(SIGNS)
        piece = piece[:at] + rng.choice((sign, "", sign + piece[at : at + 1])) + piece[at + 1 :]
    return piece


@pytest.mark.parametrize("count", [100, pytest.param(3000, marks=pytest.mark.slow)])
def test_altered_scenes_are_read_as_another_parser_reads_them_or_refused_in_a_line(count: int) -> None:
    rng, texts, read = random.Random(1), [path.read_text("utf-8") for path in SCENES], 0
    for _ in range(count):
        text = altered(rng.choice(texts), rng)
        try:
            top, _origin = scene_text(Path("scene.yaml"), text.encode())
            other = YAML(typ="base", pure=True).load(text)  # all scalars as text; refuses some tabs that YAML allows
        except SceneError as error:
            assert re.fullmatch(r"scene.yaml:\d+: .+", str(error))  # noqa: PT017  # a line
            continue
        except YAMLError:
            continue
        read += 1
        assert alike(plain(top), other), text
    assert read > count // 6  # of 3000 a fifth


def alike(ours: Any, other: Any) -> bool:
    """True if two readings hold the same keys and values, of which the other knows texts alone."""
    if isinstance(ours, dict):
        return list(ours) == list(other) and all(alike(ours[key], other[key]) for key in ours)
    if isinstance(ours, list):
        return len(ours) == len(other) and all(map(alike, ours, other))
    return ours == other or repr(core_value(other)) == repr(ours)


SEVERAL = ("bracket_in_box",)
"""Whose selectors select several features of a STEP file at once: its text alone says them."""


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_a_scene_survives_being_written_and_read(path: Path) -> None:
    scene = load_scene(path)
    if path.stem not in SEVERAL:
        again = Scene.model_validate(json.loads(scene.model_dump_json(exclude_unset=True, by_alias=True)))
        assert again.model_dump() == scene.model_dump()
    copied = pickle.loads(pickle.dumps(scene))
    assert copied == scene
    assert copied.places == scene.places


@pytest.mark.slow
@pytest.mark.parametrize("name", SEVERAL)
def test_a_scene_that_selects_several_features_survives_by_its_text(name: str, tmp_path: Path) -> None:
    scene = load_scene(ROOT / "scenes" / f"{name}.yaml")
    for own in (ROOT / "scenes").glob("*.st*p"):
        (tmp_path / own.name).write_bytes(own.read_bytes())
    (tmp_path / "again.yaml").write_text(scene.dump(), encoding="utf-8")
    again = load_scene(tmp_path / "again.yaml")
    assert again.model_dump(warnings=False) == scene.model_dump(warnings=False)


def test_places_are_lines_and_columns_of_the_file() -> None:
    scene = load_scene(SPUR_PAIR)
    lines = SPUR_PAIR.read_text(encoding="utf-8").splitlines()
    for path, place in scene.places.items():
        assert lines[place.line - 1][place.column - 1 :].startswith(str(path[-1]))
    assert len(scene.places) > 100


def test_keys_in_an_alias_have_the_place_where_they_are_written(tmp_path: Path) -> None:
    text = SMALL.replace("  a: {", "  a: &gear {").replace("\n  b: {", "\n  c: *gear\n  b: {")
    scene = load(tmp_path, text)
    assert scene.parts["c"] == scene.parts["a"]
    assert scene.place(("parts", "c", "teeth")) == scene.place(("parts", "a", "teeth"))
    assert scene.place(("parts", "c")).line == 5 == scene.place(("parts", "a")).line + 1


def test_a_refusal_of_the_model_names_file_line_and_place(tmp_path: Path) -> None:
    scene = load(tmp_path, SMALL)
    file = tmp_path / "scene.yaml"
    assert str(scene.refuse(("parts", "b", "teeth"), "too few")) == f"{file}:5: parts.b.teeth: too few"
    error = scene.refuse(("moves", "ab", "working_flank"), "too left")
    assert str(error) == f"{file}:7: moves.ab.working_flank: too left"  # the line of the move itself


def test_names_that_look_alike_are_equal(tmp_path: Path) -> None:
    composed, decomposed = "roue dentée", "roue dente\u0301e"
    text = SMALL.replace("  a: {", f"  {decomposed}: {{").replace("driver: a", f"driver: {composed}")
    scene = load(tmp_path, text)
    assert of_kind(MeshSpec, scene.moves["ab"]).gears == (composed, "b")
    assert scene.text == text  # kept as written, for the copy in a run


@pytest.mark.parametrize("encode", [lambda t: t.replace("\n", "\r\n").encode(), lambda t: b"\xef\xbb\xbf" + t.encode()])
def test_windows_line_ends_and_byte_order_marks_are_read(tmp_path: Path, encode: Any) -> None:
    path = tmp_path / "scene.yaml"
    path.write_bytes(encode(SMALL))
    assert load_scene(path).place(("measures", "play")).line == 9


# meaning of single fields ---------------------------------------------------------------------------


def test_defaults_are_those_of_the_grammar(tmp_path: Path) -> None:
    scene = load(tmp_path, SMALL)
    gear, move = of_kind(SpurGearSpec, scene.parts["a"]), of_kind(MeshSpec, scene.moves["ab"])
    measure = of_kind(NormalBacklashSpec, scene.measures["play"])
    assert (gear.pressure_angle.number, gear.profile_shift, gear.addendum, gear.dedendum) == (20.0, 0.0, 1.0, 1.25)
    assert (gear.root_fillet, gear.bore, gear.expansion) == (None, None, None)
    assert (move.working_flank, move.housing) == ("right", None)
    assert (measure.over, measure.take, measure.lower_limit, measure.upper_limit) == ("random", "value", None, None)
    study = scene.study
    assert (study.trials, study.seed, study.sampler, study.engine) == (2000, 1, "monte_carlo", "exact")
    assert scene.options(GearStudyOptions).profile_steps == 120


@pytest.mark.parametrize(("text", "count"), [("1e6", 1_000_000), ("2.5e3", 2500), ("400.0", 400)])
def test_trials_are_whole_numbers_however_they_are_written(text: str, count: int, tmp_path: Path) -> None:
    trials = load(tmp_path, f"{SMALL}study: {{trials: {text}}}\n").study.trials
    assert (trials, type(trials)) == (count, int)


@pytest.mark.parametrize(
    ("engine", "words"), [("fcl", "is the witness itself"), ("analytic", "no 3D simulation to check")]
)
def test_only_an_exact_study_has_a_witness(engine: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=f"study.witness: expected none for {engine}, .*{words}.*, got 5"):
        load(tmp_path, f"{SMALL}study: {{engine: {engine}, witness: 5}}\n")
    assert load(tmp_path, f"{SMALL}study: {{witness: 5}}\n").study.engine == "exact"


@pytest.mark.parametrize(("of", "names"), [("b", ("b",)), ("[b]", ("b",)), ("[b, h]", ("b", "h"))])
def test_a_temperature_takes_one_part_or_several(tmp_path: Path, of: str, names: tuple[str, ...]) -> None:
    text = SMALL.replace("moves:", "  h: {kind: housing, expansion: 23e-6 1/K}\nmoves:")
    text += f"tolerances:\n  t: {{kind: temperature, of: {of}, distribution: {{kind: constant, value: 20 K}}}}\n"
    assert of_kind(TemperatureSpec, load(tmp_path, text).tolerances["t"]).of == names


def test_files_that_a_scene_names_are_listed(tmp_path: Path) -> None:
    (name, file), *others = load_scene(EVERY_FIELD).files.items()
    assert (name, file.path, others) == ("wheel_thickness.csv", ROOT / "scenes" / "wheel_thickness.csv", [])
    assert file.content == file.path.read_bytes()


def test_a_scene_cannot_be_changed() -> None:
    scene = load_scene(SPUR_PAIR)
    with pytest.raises(ValidationError, match="frozen"):
        scene.scene = "another"


def test_opening_a_scene_loads_no_heavy_library() -> None:
    code = f"import sys, tol3d\ntol3d.load_scene({str(SPUR_PAIR)!r})\n"
    code += "print(*{name.partition('.')[0] for name in sys.modules})"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT).stdout
    heavy = {"pint", "pandas", "cadquery", "trimesh", "fcl", "numba", "pyvista", "matplotlib"}
    assert heavy.isdisjoint(loaded.split())
