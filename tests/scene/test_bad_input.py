"""Scenes that are wrong: each gets readable lines with file, line, place and expectation, soon."""

import os
import random
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from of_kind import of_kind
from places import SCENES
from ruamel.yaml import YAML
from scene_texts import Edit, edited, refusal_at, scene_of

from tol3d import Scene, load_scene
from tol3d.errors import Problem, SceneError
from tol3d.scene.problems import MOST_PROBLEMS
from tol3d.scene.text import MAX_BYTES, MAX_DEPTH
from tol3d.units import Quantity

SPUR_PAIR = (SCENES / "spur_pair.yaml").read_text(encoding="utf-8")
EVERY_FIELD = (SCENES / "every_field.yaml").read_text(encoding="utf-8")
HANGS = 120  # s; a guard against waiting for ever, no claim
JARGON = re.compile(
    r"Input should|validation error|pydantic|Traceback|another value here|\[key\]|function-|[a-z]Spec\b"
)


def problems(path: Path) -> tuple[Problem, ...]:
    """Messages on a scene, checked for what holds of every message."""
    with pytest.raises(SceneError) as caught:
        load_scene(path)
    said = caught.value.problems
    assert 1 <= len(said) <= MOST_PROBLEMS + 1
    for problem in said:
        assert problem.startswith(f"{path}:") or problem.startswith("… and ")
        assert problem.isprintable()
        assert problem == Problem.at(problem.file, problem.sentence, line=problem.line, path=problem.path)
        assert problem.expected or " got " not in problem.sentence
        assert len(problem) < len(str(path)) + 600
        ours = re.sub("'.*'|\".*\"", "", problem[problem.find("expected ") :])  # without the place and what was written
        assert not JARGON.search(ours)
    return said


def said_of(folder: Path, content: str | bytes) -> tuple[str, ...]:
    """The same for a content, without the file's name."""
    path = folder / "scene.yaml"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return tuple(problem.removeprefix(f"{path}:") for problem in problems(path))


def changed(old: str, new: str) -> str:
    """The spur pair with one thing changed, and its line."""
    assert old in SPUR_PAIR
    return SPUR_PAIR.replace(old, new, 1)


def line_of(text: str, part: str) -> int:
    return text[: text.index(part)].count("\n") + 1


# one wrong thing in a good scene --------------------------------------------------------------------

CHANGES = {
    "unknown key": (("teeth: 28", "tooth: 28"), 'parts.pinion.tooth: unknown key "tooth"; did you mean "teeth"?'),
    "unknown key at the top": (("measures:", "measure:"), 'measure: unknown key "measure"; did you mean "measures"?'),
    "key of another kind": (
        ("scale: 4.5 um", "scale: 4.5 um, sigma: 4 um"),
        'tolerances.pinion eccentricity.distribution.sigma: unknown key "sigma"; known here: kind, scale',
    ),
    "missing key": (("teeth: 28, ", ""), 'parts.pinion: expected the key "teeth" here, found none'),
    "missing unit": (
        ("module: 2.5 mm", "module: 2.5"),
        'parts.pinion.module: expected a length with its unit, such as "4.5 um", got 2.5, a bare number without',
    ),
    "missing unit in a distribution": (
        ("lower: -30 um", "lower: -30"),
        'tolerances.pinion tooth thickness.distribution.lower: expected a length with its unit, such as "4.5 um"',
    ),
    "neither true nor false": (
        ("measures:", "envelope: perhaps\nmeasures:"),
        "envelope: expected true or false, got 'perhaps'",
    ),
    "a decimal comma": (
        ("module: 2.5 mm", "module: 2,5 mm"),
        'parts.pinion.5 mm: expected a key, got "5 mm"; write decimals with a point: a comma starts a new entry',
    ),
    "unknown unit": (("module: 2.5 mm", "module: 2.5 inch"), "unknown unit 'inch'; units are mm, um, nm, m, cm, in"),
    "wrong dimension": (
        ("module: 2.5 mm", "module: 2.5 deg"),
        "parts.pinion.module: expected a length with its unit, such as \"4.5 um\", got '2.5 deg', which is an angle",
    ),
    "wrong dimension in a distribution": (
        ("scale: 4.5 um", "scale: 4.5 K"),
        "pinion eccentricity.distribution.scale: expected a length with its unit, such as \"4.5 um\", got '4.5 K'",
    ),
    "wrong dimension of a column": (
        ("mean: 53 um", "mean: 53 arcsec"),
        "published.paper, analytic.normal backlash.mean: expected a length with its unit",
    ),
    "dimensions of a distribution mixed": (
        ("lower: -30 um", "lower: -30 deg"),
        "tolerances.pinion tooth thickness.distribution: expected quantities of one dimension, "
        "got lower '-30 deg' (angle) and upper '-19 um' (length)",
    ),
    "limits of a distribution reversed": (
        ("lower: -30 um", "lower: -10 um"),
        "tolerances.pinion tooth thickness.distribution.lower: expected less than upper (-19 um), got '-10 um'",
    ),
    "limits of a measure reversed": (
        ("lower_limit: 15 um", "lower_limit: 15 um\n    upper_limit: 14 um"),
        "measures.normal backlash.lower_limit: expected less than the upper_limit (14 um), got '15 um'",
    ),
    "negative sigma": (
        ("lower: -30 um, upper: -19 um", "mean: -25 um, sigma: -2 um"),
        "tolerances.pinion tooth thickness.distribution.sigma: expected more than 0",
    ),
    "negative scale": (
        ("scale: 4.5 um", "scale: -4.5 um"),
        "tolerances.pinion eccentricity.distribution.scale: expected more than 0",
    ),
    "negative length": (
        ("module: 2.5 mm", "module: -2.5 mm"),
        "parts.pinion.module: expected a length of more than zero, got '-2.5 mm'",
    ),
    "zero teeth": (("teeth: 28", "teeth: 0"), "parts.pinion.teeth: expected a number of at least 1, got 0"),
    "half a tooth": (("teeth: 28", "teeth: 28.5"), "parts.pinion.teeth: expected a whole number, got 28.5"),
    "not a number": (("teeth: 28", "addendum: .nan, teeth: 28"), "parts.pinion.addendum: expected a number, got nan"),
    "text where a number is due": (
        ("trials: 2000", "trials: no"),
        "study.trials: expected a whole number or auto, got 'no'",
    ),
    "half a trial": (("trials: 2000", "trials: 1.5e0"), "study.trials: expected a whole number or auto, got 1.5"),
    "nothing behind a key": (
        ("teeth: 28, module: 2.5 mm", "teeth: 28, module: "),
        'parts.pinion.module: expected a length with its unit, such as "4.5 um", got nothing',
    ),
    "missing part": (
        ("driver: pinion", "driver: pinon"),
        "moves.gear pair.driver: expected the name of a spur gear or a helical gear or an internal gear, "
        "got 'pinon', which is not in the scene; "
        'did you mean "pinion"?',
    ),
    "a mesh in place of a gear": (
        ("driver: pinion", "driver: gear pair"),
        "moves.gear pair.driver: expected the name of a spur gear or a helical gear or an internal gear, "
        "got 'gear pair', which is a mesh of spur or helical gears",
    ),
    "a gear that drives itself": (
        ("driver: pinion", "driver: wheel"),
        "moves.gear pair.driven: expected another gear than the driver, got 'wheel'",
    ),
    "tolerance of a missing part": (
        ("of: pinion", "of: pinon"),
        "tolerances.pinion tooth thickness.of: expected the name of a gear, got 'pinon'",
    ),
    "a gear in place of a mesh": (
        ("of: gear pair", "of: wheel"),
        "tolerances.centre distance.of: expected the name of a mesh of spur or "
        "helical gears, got 'wheel', which is a spur gear",
    ),
    "eccentricity of a housing": (
        (
            "tolerances:",
            "  box: {kind: housing}\ntolerances:\n  e: {kind: eccentricity, of: box, "
            "distribution: {kind: rayleigh, scale: 1 um}}",
        ),
        "tolerances.e.of: expected the name of a gear, got 'box', which is a housing; known here: pinion, wheel",
    ),
    "temperature of a part without expansion": (
        (
            "tolerances:",
            "tolerances:\n  warm: {kind: temperature, of: [wheel, pinion], "
            "distribution: {kind: uniform, lower: 0 K, upper: 20 K}}",
        ),
        "tolerances.warm.of[0]: expected a part with its coefficient of expansion, got 'wheel' without expansion:",
    ),
    "bearing of a gear without mesh": (
        (
            "tolerances:",
            "  idler: {kind: spur_gear, teeth: 20, module: 1 mm, face_width: 9 mm}\ntolerances:\n"
            "  play: {kind: bearing_clearance, of: idler, distribution: {kind: uniform, lower: 0 um, upper: 2 um}}",
        ),
        "tolerances.play.of: expected a gear of one mesh (or the mesh named beside it), got 'idler', which is in none",
    ),
    "unknown kind": (
        ("kind: rayleigh", "kind: raleigh"),
        "tolerances.wheel eccentricity.distribution.kind: expected one of normal, truncated_normal, uniform, "
        "triangular, rayleigh, arcsine, constant, empirical, got 'raleigh'; did you mean \"rayleigh\"?",
    ),
    "unknown kind of move": (
        ("kind: mesh", "kind: mash"),
        "moves.gear pair.kind: expected a kind of move, got 'mash'; did you mean \"mesh\"?",
    ),
    "a kind by the word of the field": (
        ("kind: mesh", "kind: 3-2-1"),
        "moves.gear pair.kind: expected another word here, got '3-2-1'; write three_two_one",
    ),
    "a kind like none": (
        ("kind: run_out", "kind: wobble"),
        "tolerances.reducer run-out.kind: expected a kind of tolerance, got 'wobble'; tol3d schema lists all 55",
    ),
    "a length for a law": (
        ("distribution: {kind: rayleigh, scale: 4.5 um}", "distribution: 0.05 mm"),
        'tolerances.pinion eccentricity.distribution: expected limits, such as "±0.05 mm" by the default_law of the '
        "scene, or {kind: normal, lower: -0.05 mm, upper: 0.05 mm}, got '0.05 mm'",
    ),
    "a list of features": (
        (
            "of: pinion\n    distribution: {kind: rayleigh, scale: 4.5 um}",
            "of: [pinion, wheel]\n    distribution: {kind: rayleigh, scale: 4.5 um}",
        ),
        "tolerances.pinion eccentricity.of: expected one name, got a list (pinion, wheel); write an entry for each, or "
        "name a pattern of them",
    ),
    "missing kind": (
        ("{kind: rayleigh, scale", "{scale"),
        'tolerances.wheel eccentricity.distribution: expected the key "kind" here, found none',
    ),
    "standard's word": (
        ("{kind: rayleigh, scale: 4.5 um}", "{iso_1328: F_r 6}"),
        'tolerances.pinion eccentricity.distribution: expected the key "kind" here, found none; did you mean '
        '"iso_1328_2"?',
    ),
    "unknown word": (
        ("working_flank: right", "working_flank: rihgt"),
        "moves.gear pair.working_flank: expected one of right, left, either, got 'rihgt'; did you mean \"right\"?",
    ),
    "unknown direction": (
        ("kind: eccentricity", "direction: apart\n    kind: eccentricity"),
        "tolerances.wheel eccentricity.direction: expected random or {at: 30 deg}, got 'apart'",
    ),
    "length in place of an angle": (
        ("kind: eccentricity", "direction: {at: 3 mm}\n    kind: eccentricity"),
        "tolerances.wheel eccentricity.direction.at: expected an angle with its unit, such as \"20 deg\", got '3 mm'",
    ),
    "same name in two sections": (
        ("  reducer run-out:", "  wheel:"),
        "tolerances.wheel: expected a name of its own, got 'wheel', which already stands in parts (line 13)",
    ),
    "a measure with a mesh's name": (
        ("  lost motion:\n    kind", "  gear pair:\n    kind"),
        "measures.gear pair: expected a name of its own, got 'gear pair', which already stands in moves (line ",
    ),
    "take without over": (
        ("kind: normal_backlash", "take: min\n    kind: normal_backlash"),
        "measures.normal backlash.take: expected over: turn or over: long_period beside it, got over: random",
    ),
    "over without take": (
        ("kind: normal_backlash", "over: turn\n    kind: normal_backlash"),
        "measures.normal backlash.take: expected min, max, range or curve beside over: turn, got no take",
    ),
    "positions of one position": (
        ("kind: normal_backlash", "over: {at: 3 deg}\n    positions: 9\n    kind: normal_backlash"),
        "measures.normal backlash.positions: expected over: turn or over: long_period beside it, got over: {at: …}",
    ),
    "wrong published measure": (
        ("    lost motion: {low", "    lots motion: {low"),
        "published.paper, 3DCS.lots motion: expected the name of a measure, got 'lots motion'; "
        'did you mean "lost motion"?',
    ),
    "wrong published contributor": (
        ("reducer run-out: 0.8", "reducer runout: 0.8"),
        "published.paper, 3DCS.normal backlash.contributors.reducer runout: expected the name of a tolerance, "
        "got 'reducer runout'; did you mean \"reducer run-out\"?",
    ),
    "published values out of order": (
        ("mean: 53 um", "mean: 530 um"),
        "published.paper, analytic.normal backlash.mean: expected at most high_3sigma (74 um), got '530 um'",
    ),
    "more than all of the variance": (
        ("reducer run-out: 0.8", "reducer run-out: 180"),
        "contributors.reducer run-out: expected a number of at most 100, got 180",
    ),
    "forbidden name": (("  wheel: ", "  a/b: "), r"parts.a/b: expected a name without / \ :, got 'a/b'"),
    "name like a column": (("  wheel: ", "  a.x: "), 'parts.a.x: expected a name that does not end in ".x" or ".y"'),
    "name too long": (("  wheel: ", f"  {'w' * 81}: "), "expected a name of up to 80 characters, got 81 of them"),
    "number as a key": (("  wheel: ", "  1: "), "parts: expected a key that is text, got 1; put it into quotes"),
    "list as a key": (("  wheel: ", "  [a]: "), "parts: expected a key that is text, got something else"),
    "number as text": (
        ("scene: spur pair at the drive end", "scene: 12"),
        "scene: expected text, got 12; put it into quotes",
    ),
    "list in place of keys": (
        ("study: {", "study: [1]  # {"),
        "study: expected keys with values, such as {trials: …, until: …, at_most: …}, got a list",
    ),
    "undefined alias": (("teeth: 28", "teeth: *z"), "parts.pinion.teeth: the alias *z has no anchor (&z) before it"),
    "tag": (
        ("teeth: 28", "teeth: !!python/object/apply:os.system ['true']"),
        "parts.pinion.teeth: expected no tags, got '!!python/object/apply:os.system'",
    ),
    "merge key": (
        ("teeth: 28", "<<: 28"),
        "parts.pinion.<<: expected a mapping beside <<, or a list of them, such as <<: *block, got 28",
    ),
    "second document": (("study:", "---\nstudy:"), 'expected one scene in a file, got a second document ("---")'),
    "colon too many": (
        ("scene: spur", "scene: a: spur"),
        'not YAML: mapping values are not allowed in this context (column 9); a ":" too many or a wrong indent',
    ),
    "tab": (("    kind: tooth_thickness", "\tkind: tooth_thickness"), "indent with spaces, not with tabs"),
    "control character": (("scene: spur", "scene: \x1b[2Jspur"), "not YAML: the character U+001B is not allowed"),
    "escape in a key": (("teeth: 28", '"te\\e[2Jeth": 28'), 'parts.pinion.te\\x1b[2Jeth: unknown key "te\\x1b[2Jeth"'),
    "a face of no width": (
        ("face_width: 20 mm", "face_width: 1e-9 mm"),
        "parts.pinion.face_width: expected at least 1e-06 mm, got '1e-09 mm'",
    ),
    "half a surrogate pair": (
        ("scene: spur pair at the drive end", 'scene: "\\ud800"'),
        "not YAML: found invalid Unicode character escape code",
    ),
    "escape beyond Unicode": (("scene: spur pair at the drive end", 'scene: "\\UFFFFFFFF"'), "not YAML: "),
}


@pytest.mark.parametrize(("change", "words"), CHANGES.values(), ids=CHANGES.keys())
def test_one_wrong_thing_is_said_with_its_line_and_place(tmp_path: Path, change: tuple[str, str], words: str) -> None:
    text = changed(*change)
    said = said_of(tmp_path, text)
    first_changed = next(n for n, (a, b) in enumerate(zip(SPUR_PAIR, text, strict=False)) if a != b)
    line = text[:first_changed].count("\n") + 1
    found = [problem for problem in said if words in problem]
    assert len(found) == 1, said
    # a missing key has the line of its mapping, of two entries that do not fit either may be meant, and text that
    # grows by lines moves what stands below it; an escape beyond Unicode has no place in ruamel.yaml's error
    assert abs(int(found[0].partition(":")[0]) - line) <= 3 or "UFFFFFFFF" in text


def test_a_repeated_key_is_said_with_both_lines(tmp_path: Path) -> None:
    text = changed("    of: wheel\n", "    of: wheel\n    of: pinion\n")
    line = line_of(text, "    of: pinion\n    distribution: {kind: normal, lower: -32 um")
    expected = f"the key stands twice, first in line {line - 1}, again in line {line}; remove one"
    assert said_of(tmp_path, text) == (f"{line}: tolerances.wheel tooth thickness.of: {expected}",)


def test_a_repeated_name_is_a_repeated_key(tmp_path: Path) -> None:
    (said,) = said_of(tmp_path, changed("  wheel: ", "  pinion: "))
    assert "parts.pinion: the key stands twice, first in line 11, again in line 13" in said


def test_a_gear_outside_the_mesh_is_refused_where_an_angle_is_measured(tmp_path: Path) -> None:
    text = changed("tolerances:", "  idler: {kind: spur_gear, teeth: 20, module: 1 mm, face_width: 9 mm}\ntolerances:")
    (said,) = said_of(tmp_path, text.replace("    gear: wheel", "    gear: idler"))
    assert "measures.lost motion.gear: expected a gear of the mesh 'gear pair', got 'idler'" in said


def test_a_name_repeated_in_other_code_points_is_a_repeated_key(tmp_path: Path) -> None:
    text = changed(
        "  wheel: ", '  "roue dent\\u00e9e": {kind: housing}\n  "roue dente\\u0301e": {kind: housing}\n  wheel: '
    )
    (said,) = said_of(tmp_path, text)
    assert "parts.roue dentée: the key stands twice, first in line 13, again in line 14" in said


def test_empty_sections_are_refused(tmp_path: Path) -> None:
    said = said_of(tmp_path, "scene: a\nparts: {}\nmoves: {}\nmeasures:\n")
    assert said[0] == "2: parts: expected at least one entry, got an empty mapping"
    assert said[1] == "3: moves: expected at least one entry, got an empty mapping"
    assert said[2] == '4: measures: expected keys with values, such as "name: {…}", got nothing'


def test_the_first_eight_problems_are_listed_in_the_order_of_the_file(tmp_path: Path) -> None:
    said = said_of(tmp_path, SPUR_PAIR.replace(" um", " furlong"))
    lines = [int(problem.partition(":")[0]) for problem in said[:-1]]
    assert len(lines) == MOST_PROBLEMS
    assert lines == sorted(lines)
    quantities = len(re.findall(r"\d furlong[,}\n ]", re.sub("#.*", "", SPUR_PAIR.replace(" um", " furlong"))))
    assert said[-1] == f"… and {quantities - MOST_PROBLEMS} more"


# trains ---------------------------------------------------------------------------------------------

OTHER = (
    ("parts:\n", "parts:\n  a: {kind: spur_gear, teeth: 20, module: 1 mm, face_width: 5 mm}\n"
     "  b: {kind: spur_gear, teeth: 30, module: 1 mm, face_width: 5 mm}\n"),
    ("moves:\n", "moves:\n  other: {kind: mesh, driver: a, driven: b, centre_distance: 25 mm}\n"),
)  # fmt: skip
"""A pair of its own beside the train."""
ON_TABLE = ("table gear: {at: 0 mm", "b: {at: 15 mm}\n      table gear: {at: 0 mm")

TRAINS = {
    "a train that does not connect": (
        "three_stage_train",
        (*OTHER, ("output: encoder gear", "output: b")),
        "output: b",
        "moves.indexing.output: the train does not connect: from 'motor' one gets to 'motor', 'gearbox output', "
        "'idler', 'table shaft', 'encoder gear'; 'b' is driven from 'a'",
    ),
    "an output that nothing turns": (
        "three_stage_train",
        (("parts:\n", "parts:\n  loose: {kind: shaft}\n"), ("output: encoder gear", "output: loose")),
        "output: loose",
        "moves.indexing.output: the train does not connect: from 'motor' one gets to 'motor', 'gearbox output', "
        "'idler', 'table shaft', 'encoder gear'; nothing drives 'loose'",
    ),
    "a shaft with two drivers": (
        "three_stage_train",
        (
            ("parts:\n", "parts:\n  hand wheel: {kind: shaft}\n"),
            ("moves:\n", "moves:\n  belt: {kind: reducer, driver: hand wheel, driven: idler, ratio: 3}\n"),
        ),
        "first mesh: {kind: mesh",
        "moves.first mesh: two drivers: 'idler' is driven by 'gearbox output' here and by 'hand wheel' in 'belt'",
    ),
    "a motor on a shaft that is driven": (
        "three_stage_train",
        (("train, driven: motor", "train, driven: idler"),),
        "indexing: {kind: train",
        "moves.indexing.driven: two drivers: expected the shaft that the motor turns and no other, got 'idler', which "
        "'gearbox output' drives in 'first mesh'; the first shaft there is 'motor'",
    ),
    "teeth that give another ratio": (
        "three_stage_train",
        (("ratio: 0.6667", "ratio: 1.5"),),
        "ratio: 1.5",
        "moves.third mesh.ratio: expected 0.666667 = 32/48, teeth of 'encoder gear' over 'encoder driver', got 1.5",
    ),
    "stages that give another ratio": (
        "three_stage_train",
        (("ratio: -10.4", "ratio: -11"),),
        "ratio: -11",
        "moves.indexing.ratio: expected -10.4 (its sign may be left out) = -5.2 (gearbox) · -1.55 (first mesh) · "
        "-1.93548 (second mesh) · 0.666667 (third mesh), got -11",
    ),
    "stages that turn the other way": (
        "three_stage_train",
        (("ratio: -5.2", "ratio: 5.2"),),
        "indexing: {kind: train",
        "moves.indexing.ratio: expected 10.4 = 5.2 (gearbox) · ",
    ),
    "a ratio that nobody builds": (
        "three_stage_train",
        (("ratio: -5.2", "ratio: 1e-320"),),
        "gearbox: {kind: reducer",
        "moves.gearbox.ratio: expected a ratio of 1/1e+06 to 1e+06, either sign, got ",
    ),
    "three shafts in a ring": (
        "three_stage_train",
        (("driver: motor, driven: gearbox output", "driver: table shaft, driven: gearbox output"),),
        "gearbox: {kind: reducer",
        "moves.gearbox: a loop of shafts: 'gearbox output' → 'idler' → 'table shaft' → 'gearbox output'; no motor can "
        "turn them: take out a link",
    ),
    "two meshes between the same shafts": (
        "three_stage_train",
        (
            *OTHER,
            ("parts:\n", "parts:\n  encoder shaft: {kind: shaft, carries: {encoder gear: {at: 30 mm}, a: {}}}\n"),
            ON_TABLE,
            ("driver: a, driven: b", "driver: b, driven: a"),
            ("output: encoder gear", "output: encoder shaft"),
        ),
        "third mesh: ",
        "moves.third mesh: a loop of shafts",
    ),
    "both gears on one shaft": (
        "three_stage_train",
        (*OTHER, ("parts:\n", "parts:\n  both: {kind: shaft, carries: {a: {}, b: {}}}\n")),
        "other: {kind: mesh",
        "moves.other: driver and driven sit on the same shaft, 'both': it would lock itself",
    ),
    "a load that no train tells": (
        "three_stage_train",
        (*OTHER, ("centre_distance: 25 mm", "centre_distance: 25 mm, working_flank: either")),
        "other: {kind: mesh",
        "moves.other.working_flank: expected right or left, got either: no train gives the load; add a move of kind "
        "train that drives 'a'",
    ),
    "a gear in no mesh": (
        "three_stage_train",
        (OTHER[0], ("  b: {kind: spur_gear, teeth: 30, module: 1 mm, face_width: 5 mm}\n", "")),
        "  a: {kind: spur_gear",
        "parts.a: 'a' is used by no move; put it into a mesh or take it out",
    ),
    "a bevel gear with mates that are not alike": (
        "robot_shoulder",
        (
            ("parts:\n", "parts:\n  third: {kind: bevel_gear, teeth: 40, module: 3.5 mm, face_width: 9 mm}\n"),
            ("moves:\n", "moves:\n  other: {kind: bevel_mesh, driver: bevel driver, driven: third, azimuth: 1 deg}\n"),
            ("of: bevel driver, distribution: {kind: normal, lower: 10", "of: bevel driver, mesh: other, distribution: "
             "{kind: normal, lower: 10"),
        ),
        "bevel pair: {kind: bevel_mesh",
        "moves.bevel pair: 'bevel driver' would need another pitch angle than in 'other': a bevel gear can be in "
        "several meshes only where shaft angle and mate are alike",
    ),
    "lost motion of another tree": (
        "three_stage_train",
        (*OTHER, ("shaft: idler,", "shaft: b,")),
        "shaft: b,",
        "measures.lost motion of the idler.shaft: expected a shaft that 'motor' turns, got 'b'",
    ),
    "lost motion of the shaft that is held": (
        "three_stage_train",
        (("shaft: idler,", "shaft: motor,"),),
        "shaft: motor,",
        "measures.lost motion of the idler: expected another shaft than the one that is held, got 'motor'",
    ),
    "gravity along the axis": (
        "robot_shoulder_swing",
        (("gravity: [0, -1, 0]", "gravity: [-3, 0, 0]"),),
        "tip error over the swing: ",
        "measures.tip error over the swing: gravity does not turn 'shoulder flange' anywhere on this swing: its "
        "direction in the world, or the arm's centre of mass, lies along the axis",
    ),
    "a swing without gravity": (
        "robot_shoulder_swing",
        ((", gravity: [0, -1, 0]", ""),),
        "tip error over the swing: ",
        "measures.tip error over the swing: what turns the load over a swing is gravity: give 'shoulder swing' its "
        "direction",
    ),
    "three bearings of one shaft": (
        "three_stage_train",
        (("  pinion: {", "  top bearing: {kind: bearing, shaft: table shaft, at: 9 mm}\n  pinion: {"),),
        "  top bearing:",
        "parts.top bearing: expected two bearings of 'table shaft' at most, got a third beside 'lower bearing' and "
        "'upper bearing'",
    ),
    "two bearings in one place": (
        "three_stage_train",
        (("upper bearing: {kind: bearing, shaft: table shaft, at: 20 mm}",
          "upper bearing: {kind: bearing, shaft: table shaft, at: -20 mm}"),),
        "  upper bearing: {kind",
        "parts.upper bearing.at: expected another place than that of 'lower bearing', got '-20 mm'",
    ),
    "two trains that load a mesh on other flanks": (
        "three_stage_train",
        (("  indexing: {", "  back: {kind: train, driven: motor, output: idler}\n  indexing: {"),),
        "  first mesh: {",
        "moves.first mesh.working_flank: expected right or left, got either: ",
    ),
    "a reducer's play drawn twice": (
        "three_stage_train",
        (("  pinion tooth thickness:", "  more play: {kind: reducer_backlash, of: gearbox, distribution: "
          "{kind: constant, value: 1 arcmin}}\n  pinion tooth thickness:"),),
        "  more play:",
        "tolerances.more play.of: expected one distribution of its play, got another one in 'gearbox play'",
    ),
    "a reducer's backlash twice": (
        "robot_shoulder",
        (("tolerances:", "tolerances:\n  play: {kind: reducer_backlash, of: planetary reducer, distribution: "
          "{kind: uniform, lower: 0 arcmin, upper: 1 arcmin}}"),),
        "  play: ",
        "tolerances.play.of: expected a reducer without a backlash of its own, got 'planetary reducer', which says "
        "backlash: 1 arcmin",
    ),
    "run-out of a shaft without gears": (
        "three_stage_train",
        (("run_out, of: table shaft", "run_out, of: motor"),),
        "run_out, of: motor",
        "tolerances.table shaft run-out.of: expected a shaft with a gear on it, or a bearing of one, got 'motor'",
    ),
    "clearance of a bearing whose shaft has no gears": (
        "three_stage_train",
        (
            ("parts:\n", "parts:\n  end bearing: {kind: bearing, shaft: motor}\n"),
            ("    of: upper bearing", "    of: end bearing"),
        ),
        "    of: end bearing",
        "tolerances.upper bearing clearance.of: expected a shaft with a gear on it, or a bearing of one, got "
        "'end bearing'",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("scene", "changes", "there", "words"), TRAINS.values(), ids=TRAINS.keys())
def test_what_makes_no_train_is_said_once_with_its_line_and_place(
    scene: str, changes: tuple[Edit, ...], there: str, words: str, tmp_path: Path
) -> None:
    text = edited((SCENES / f"{scene}.yaml").read_text("utf-8"), *changes)
    said = refusal_at(text, tmp_path)
    assert said.startswith(f"{line_of(text, there)}: {words}")
    assert said.isprintable()


@pytest.mark.slow
def test_a_train_that_does_not_connect_ends_the_command_with_2(tmp_path: Path) -> None:
    text = (SCENES / "three_stage_train.yaml").read_text(encoding="utf-8")
    (tmp_path / "scene.yaml").write_text(text.replace("train, driven: motor", "train, driven: idler"), encoding="utf-8")
    words = [str(Path(sys.executable).with_name("tol3d")), "run", "scene.yaml", "--out", "run"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.count("scene.yaml:") == 1
    assert "Traceback" not in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["scene.yaml"]


# files ----------------------------------------------------------------------------------------------


def empirical(file: str) -> str:
    law = f"{{kind: empirical, file: {file!r}, column: a, unit: um}}"
    return changed("{kind: rayleigh, scale: 4.5 um}", law)


def test_a_file_outside_the_folder_is_read_only_on_trust(tmp_path: Path) -> None:
    folder = tmp_path / "scenes"
    folder.mkdir()
    outside = tmp_path / "data.csv"
    outside.write_text("a\n1\n2\n")
    (folder / "link.csv").symlink_to(outside)
    for file in ("../data.csv", "link.csv", str(outside), "/etc/passwd"):
        (said,) = said_of(folder, empirical(file))
        assert "pinion eccentricity.distribution.file: expected a file in the scene's own folder" in said
        assert "--trust-parts" in said
    for file in ("../data.csv", "link.csv", str(outside)):
        (folder / "scene.yaml").write_text(empirical(file))
        assert load_scene(folder / "scene.yaml", trust_parts=True).files[file].content == b"a\n1\n2\n"


def test_a_file_that_is_none_is_refused(tmp_path: Path) -> None:
    (tmp_path / "thickness.csv").write_text("a\n1\n2\n")
    (tmp_path / "ring.csv").symlink_to(tmp_path / "ring.csv")
    for file, words in {
        "thicknes.csv": 'which is not there; did you mean "thickness.csv"?',
        ".": "which is a folder or a device",
        "ring.csv": "expected a file that can be read, got 'ring.csv'",
        "n" * 300: "expected a file that can be read",
    }.items():
        (said,) = said_of(tmp_path, empirical(file))
        assert words in said


def test_no_such_scene(tmp_path: Path) -> None:
    (tmp_path / "spur_pair.yaml").write_text(SPUR_PAIR)
    (said,) = problems(tmp_path / "spur_pear.yaml")
    assert f"found no file of that name; did you mean {tmp_path / 'spur_pair.yaml'}?" in said
    (said,) = problems(tmp_path / "no" / "such" / "folder.yaml")
    assert said.endswith("found no file of that name")


def test_a_folder_is_no_scene(tmp_path: Path) -> None:
    (tmp_path / "spur_pair.yaml").write_text(SPUR_PAIR)
    (said,) = problems(tmp_path)
    assert f"got a folder; give a file in it, such as {tmp_path / 'spur_pair.yaml'}" in said


def test_an_unreadable_scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "scene.yaml").write_text(SPUR_PAIR)

    def refuse(*_: object) -> None:
        raise PermissionError(13, "Permission denied")  # the super-user of a test machine may read everything

    monkeypatch.setattr(Path, "open", refuse)
    (said,) = problems(tmp_path / "scene.yaml")
    assert said.endswith("expected a scene file that can be read, got: Permission denied")


def test_a_name_with_a_nul_is_no_scene() -> None:
    with pytest.raises(SceneError, match="expected a scene file"):
        load_scene(Path("a\0b.yaml"))


# noise ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["", "\n\n", "# nothing but a comment\n", "---\n", "--- # nothing\n...\n"])
def test_an_empty_file_is_said_to_be_empty(tmp_path: Path, text: str) -> None:
    (said,) = said_of(tmp_path, text)
    assert said.startswith("1: ")
    assert "got an empty file" in said or "got nothing" in said


@pytest.mark.parametrize("text", ["a novel", "- a\n- list\n", "42", "{}x", "scene: [", '"', "@", "%YAML 3.0\n---\na"])
def test_what_is_no_scene_at_all_is_said_so(tmp_path: Path, text: str) -> None:
    (said,) = said_of(tmp_path, text)
    assert re.match(r"\d+: (not YAML: |expected keys such as scene:, parts:)", said)


def test_ten_megabytes_of_noise_are_refused_unread(tmp_path: Path) -> None:
    assert said_of(tmp_path, random.Random(1).randbytes(10_000_000)) == (
        "1: expected a scene of at most 4 MB, got a larger file",
    )


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no such device here")
def test_an_endless_file_is_refused() -> None:
    assert problems(Path("/dev/zero")) == ("/dev/zero: expected a scene file, got a pipe or a device",)


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names here")
def test_a_pipe_is_refused_and_not_waited_for(tmp_path: Path) -> None:
    pipe = tmp_path / "scene.yaml"
    os.mkfifo(pipe)
    command = [sys.executable, "-m", "tol3d.cli", "check", str(pipe)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=HANGS)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"{pipe}: expected a scene file, got a pipe or a device\n"


def test_bytes_that_are_no_text_are_refused_with_their_line(tmp_path: Path) -> None:
    (said,) = said_of(tmp_path, b"scene: a\nparts: \xff\n")
    assert said == "2: expected UTF-8 text, got the byte 0xff, which is none"


@pytest.mark.parametrize("opening", ["[", "{", "[\n", "{a: ", "- ", "? ", "[{a: "])
def test_twenty_thousand_nested_brackets_are_one_message(tmp_path: Path, opening: str) -> None:
    (said,) = said_of(tmp_path, opening * 20_000)
    assert f"expected at most {MAX_DEPTH} levels" in said or "a key that is text" in said


@pytest.mark.parametrize(
    "text",
    ["a" * 999_000, " " * 999_000, '"' + "\\u0041" * 166_000, "[" + "aaaaaaaaa," * 99_900, "&a " * 333_000,
     "a: |\n" + " x\n" * 333_000, "[ " * 40 + "a, " * 300_000],
    ids=lambda text: ascii(text[:8]),
)  # fmt: skip
@pytest.mark.slow
def test_a_megabyte_of_anything_is_refused_without_a_crash(tmp_path: Path, text: str) -> None:
    assert len(text) < MAX_BYTES
    path = tmp_path / "scene.yaml"
    path.write_text(text)
    with pytest.raises(SceneError):
        load_scene(path)


GROWING: dict[str, Callable[[int], str]] = {
    "one word": lambda n: "a" * n,
    "blanks": lambda n: " " * n,
    "escapes": lambda n: '"' + "\\u0041" * (n // 6),
    "a list": lambda n: "[" + "a," * (n // 2),
    "a list deep down": lambda n: "[ " * 40 + "a, " * (n // 3),
    "anchors": lambda n: "&a " * (n // 3),
    "aliases": lambda n: "a: &a [x]\nb: [" + "*a, " * (n // 4),
    "lines": lambda n: "a: |\n" + " x\n" * (n // 3),
    "keys": lambda n: "".join(f"k{k}: 1\n" for k in range(n // 8)),
    "brackets": lambda n: "[" * n,
    "braces": lambda n: "{a: " * (n // 4),
    "indents": lambda n: "- " * (n // 2),
    "quotes": lambda n: "a: '" + "''" * (n // 2),
    "comments": lambda n: "#\n" * (n // 2),
    "names": lambda n: f"scene: {'n' * n}\nparts: {{{'p' * n}: {{kind: spur_gear}}}}\n",
}


@pytest.mark.parametrize("what", GROWING)
def test_the_work_on_a_text_grows_with_its_length_and_no_faster(what: str, tmp_path: Path) -> None:
    """Calls that are made while it is refused, Python's and C's: twice the text, twice the calls at most."""
    path = tmp_path / "scene.yaml"

    def calls(length: int) -> int:
        path.write_text(GROWING[what](length), "utf-8")
        counted = 0

        def count(frame: object, event: str, argument: object) -> None:
            nonlocal counted
            counted += 1

        sys.setprofile(count)
        try:
            with pytest.raises(SceneError):
                load_scene(path)
        finally:
            sys.setprofile(None)
        return counted

    once, twice = calls(3000), calls(6000)
    assert twice <= 2.1 * once + 1000  # what is done once for any text, such as imports, is done in the first


def test_an_alias_bomb_is_refused_and_a_few_aliases_are_not(tmp_path: Path) -> None:
    bomb = "a: &a [x, x, x, x, x, x, x, x, x, x]\n"
    for this, last in zip("bcdefghi", "abcdefgh", strict=True):
        bomb += f"{this}: &{this} [{', '.join([f'*{last}'] * 10)}]\n"
    (said,) = said_of(tmp_path, bomb)
    assert re.match(r"\d+: .*expected at most 500000 values \(aliases count written out\), got more", said)
    text = SPUR_PAIR.replace("{kind: rayleigh, scale: 4.5 um}", "&law {kind: rayleigh, scale: 4.5 um}")
    (tmp_path / "scene.yaml").write_text(text.replace("{kind: rayleigh, scale: 1.3333333333333333 um}", "*law"))
    law = load_scene(tmp_path / "scene.yaml").distributed["reducer run-out"].distribution
    assert of_kind(Quantity, vars(law)["scale"]).number == 4.5


def test_an_alias_of_what_holds_it_is_refused(tmp_path: Path) -> None:
    (said,) = said_of(tmp_path, "scene: &a [*a]\n")
    assert "the alias *a has no anchor (&a) before it" in said


# whatever a hand or a disk may do ---------------------------------------------------------------------

fuzz = settings(
    max_examples=60,
    deadline=None,  # the machine is shared
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
WORDS = sorted(set(re.findall(r"[\w.]+|[^\w\s]", EVERY_FIELD + SPUR_PAIR)) | {"null", "~", "[]", "{}", "[1]", "{a: 1}"})


def loads_or_is_refused_well(folder: Path, content: str | bytes) -> None:
    path = folder / "scene.yaml"
    path.write_bytes(content.encode("utf-8", "surrogatepass") if isinstance(content, str) else content)
    (folder / "wheel_thickness.csv").write_text("a\n1\n2\n")
    try:
        load_scene(path)
    except SceneError:
        problems(path)


@fuzz
@given(text=st.text() | st.binary() | st.text(alphabet="[]{}:,-?&*!|>'\"%@` \n\tab1"))
def test_garbage_is_refused_and_nothing_else_happens(tmp_path: Path, text: str | bytes) -> None:
    loads_or_is_refused_well(tmp_path, text)


@pytest.mark.slow
@fuzz
@given(data=st.data(), text=st.sampled_from([EVERY_FIELD, SPUR_PAIR]))
def test_a_scene_with_bits_replaced_is_read_or_refused_well(tmp_path: Path, data: st.DataObject, text: str) -> None:
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(text)))
        end = data.draw(st.integers(start, min(len(text), start + 12)))
        text = text[:start] + data.draw(st.text(max_size=6) | st.sampled_from(WORDS)) + text[end:]
    loads_or_is_refused_well(tmp_path, text)


@fuzz
@given(data=st.data(), text=st.sampled_from([EVERY_FIELD, SPUR_PAIR]))
def test_a_scene_with_a_value_replaced_is_read_or_refused_well(tmp_path: Path, data: st.DataObject, text: str) -> None:
    values = list(re.finditer(r"(?<=: )[^\s{\[#,}][^,}#\n]*", text))
    value = data.draw(st.sampled_from(values))
    new = data.draw(
        st.sampled_from(["", "~", "true", "0", "-1", "1e999", ".nan", "[]", "[a, a]", "{}", "{at: 1}", "{kind: x}"])
        | st.sampled_from(values).map(lambda other: other[0])
    )
    loads_or_is_refused_well(tmp_path, text[: value.start()] + new + text[value.end() :])


COMMAS = """
scene: commas
parts:
  base:
    kind: solid
    features:
      floor: {{kind: plane, at: [{at}], normal: [0, 0, 1], extent: [60 mm, 40 mm]}}
tolerances:
  height: {{kind: {kind}, of: base.floor{law}}}
moves:
  fixed: {{kind: fix, part: base}}
measures:
  tilt: {{kind: angle, from: base.floor, to: base.floor}}
"""
PLACE, LAW = "0 mm, 0 mm, 1 mm", ", distribution: {kind: constant, value: 0.1 mm}"


@pytest.mark.parametrize(
    ("at", "kind", "law", "expected"),
    [
        (
            "0 mm, 0 mm, 40,1 mm",
            "plus_minus",
            LAW,
            "got a list of 4; write decimals with a point: a comma starts a new",
        ),
        (PLACE, "plus_minus", LAW.replace("0.1", "0,1"), 'expected a key, got "1 mm"; write decimals with a point'),
        (PLACE, "true_position", LAW, "expected another word here, got 'true_position'; write position"),
        (
            PLACE,
            "plus_minus",
            "",
            'expected the key "distribution" here, such as {kind: normal, lower: -10 um, upper: ',
        ),
    ],
)
def test_slips_of_the_field_are_told_by_file_and_by_python(
    tmp_path: Path, at: str, kind: str, law: str, expected: str
) -> None:
    text = COMMAS.format(at=at, kind=kind, law=law)
    with pytest.raises(SceneError) as of_file:
        scene_of(text, tmp_path)
    assert expected in str(of_file.value)
    with pytest.raises(SceneError) as of_python:
        Scene.model_validate(YAML(typ="safe").load(text))
    assert expected in str(of_python.value)
