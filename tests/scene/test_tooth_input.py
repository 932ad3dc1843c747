"""Wrong tolerances of single flanks get one message that says what would do."""

from pathlib import Path

import pytest
from scene_texts import refusal

SPUR = """
  pinion: {kind: spur_gear, teeth: 20, module: 2 mm, face_width: 12 mm}
  wheel: {kind: spur_gear, teeth: 30, module: 2 mm, face_width: 10 mm}
moves:
  pair: {kind: mesh, driver: pinion, driven: wheel, centre_distance: 50.2 mm}
"""
BEVEL = """
  pinion: {kind: bevel_gear, teeth: 20, module: 2 mm, face_width: 12 mm}
  wheel: {kind: bevel_gear, teeth: 30, module: 2 mm, face_width: 12 mm}
moves:
  pair: {kind: bevel_mesh, driver: pinion, driven: wheel}
"""
REST = "measures:\n  play: {kind: normal_backlash, of: pair}\ntolerances:\n"
WALK = "law: {kind: random_walk, fill: [0.7, 1]}"
PITCH = "kind: pitch_deviation, of: pinion, flanks: each"
UNIFORM = "limits: {size: 3 um}, law: {kind: uniform}"
SLOPE = "kind: profile_slope, of: pinion, flanks: each, each: tooth"
FORM = "kind: profile_form, of: pinion, flanks: each, each: tooth, limits: {iso_class: 5}, law: {kind: uniform}"


def refused(folder: Path, tolerances: str, gears: str = SPUR) -> str:
    return refusal(f"scene: teeth\nparts:{gears}{REST}{tolerances}\n", folder)


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        (f"{PITCH}, {WALK}", "limits: expected limits such as {iso_class: 5}, which the law fills, got none"),
        (f"{PITCH}, limits: {{iso_class: 5}}", 'expected the key "law" here, such as {kind: uniform}, found none'),
        (f"{PITCH}, limits: {{iso_class: 12}}, {WALK}", "iso_class: expected"),
        (
            f"{PITCH}, limits: {{single: 5 um}}, {WALK}",
            "expected either iso_class, or single and cumulative, got single",
        ),
        (f"{PITCH}, limits: 5 um, {WALK}", "expected limits such as {iso_class: 5}"),
        (
            f"{PITCH}, limits: {{iso_class: 5}}, law: random_walk",
            "expected a law such as {kind: random_walk, fill: [0.7, 1]}",
        ),
        (
            f"{PITCH}, limits: {{iso_class: 5}}, law: {{kind: random_walk, fill: [1, 0.7]}}",
            "the least share before the most",
        ),
        (f"{PITCH}, limits: {{iso_class: 5}}, law: {{kind: random_walk, fill: [0, 1]}}", "fill"),
        (
            f"{PITCH}, law: {{kind: given, right: [1 um, 2 um, 3 um]}}",
            "expected right and left for flanks each, got right",
        ),
        (
            "kind: pitch_deviation, of: pinion, flanks: right, law: {kind: given, right: [1 um, 2 um, 3 um]}",
            "law.right: expected 20 lengths, got 3",
        ),
        (f"{SLOPE}, law: {{kind: uniform}}", "limits such as {iso_class: 7}"),
        (f"{SLOPE}, limits: {{size: 3 um}}, law: {{kind: normal, cpk: 0}}", "cpk"),
        (
            f"{SLOPE}, limits: {{size: 3 um}}, law: {{kind: stated, distribution: {{kind: constant, value: 1 um}}}}",
            "none beside a law that is stated, got limits",
        ),
        (f"{SLOPE}, law: {{kind: stated, distribution: {{kind: constant, value: 1 deg}}}}", "expected a length"),
        (f"{SLOPE}, {UNIFORM}, range: [38 mm]", "range: expected a list of 2 lengths, got a list of 1"),
        (f"{SLOPE}, {UNIFORM}, range: [38 mm, 2 deg]", "range"),
        (
            f"{SLOPE}, {UNIFORM}, range: [38 mm, 45 mm]",
            "range: expected two diameters from 37.5877 mm, where the involute begins, to 44.0000 mm, its tip, got",
        ),
        (f"{FORM}, shape: barrel, range: [43 mm, 40 mm]", "range: expected two diameters"),
        (
            f"{SLOPE.replace('profile_slope', 'helix_slope')}, {UNIFORM}, range: [0 mm, 12.1 mm]",
            "range: expected two heights from 0 mm, the lower end of the face, to 12 mm, its upper end, got 0 mm and",
        ),
        (f"{FORM}, shape: wave", "waves: expected a number of waves, got none"),
        (f"{FORM}, shape: barrel, waves: 2", "waves: expected none of a barrel, got waves"),
        (
            "kind: pitch_deviation, of: pair, flanks: each, limits: {iso_class: 5}, " + WALK,
            "expected the name of a spur gear or a helical gear or an internal gear, got 'pair'",
        ),
    ],
)
def test_what_is_wrong_is_said_with_what_would_do(entry: str, words: str, tmp_path: Path) -> None:
    message = refused(tmp_path, f"  teeth: {{{entry}}}")
    assert words in message
    assert "\n" not in message.strip()


def test_single_flanks_of_bevel_gears_are_refused(tmp_path: Path) -> None:
    message = refused(tmp_path, f"  teeth: {{{PITCH}, limits: {{iso_class: 5}}, {WALK}}}", BEVEL)
    assert (
        "tolerances.teeth.of: expected the name of a spur gear or a helical gear or an internal gear, "
        "got 'pinion', which is a bevel gear" in message
    )


def test_classes_are_refused_for_gears_beyond_their_ranges(tmp_path: Path) -> None:
    small = SPUR.replace("module: 2 mm", "module: 0.4 mm").replace("50.2", "10.04")
    message = refused(tmp_path, f"  teeth: {{{PITCH}, limits: {{iso_class: 5}}, {WALK}}}", small)
    assert "module of 0.5 to 70 mm, got 0.4 mm; state the limits themselves" in message


def test_a_gear_has_forms_of_one_shape(tmp_path: Path) -> None:
    message = refused(tmp_path, f"  first: {{{FORM}, shape: barrel}}\n  second: {{{FORM}, shape: wave, waves: 1}}")
    assert "tolerances.second.shape: expected the shape of 'first', the form of 'pinion' too" in message
