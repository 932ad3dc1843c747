"""Advice in messages: to follow it mends the scene, and nothing that a user wrote is dropped without a word."""

from pathlib import Path

import pytest
from assembly_trials import assembled
from fixtures import Command
from places import SCENES
from scene_texts import refusal, written

COVER = (SCENES / "cover_on_base.yaml").read_text("utf-8")
TOLERANCES, MEASURES = "\ntolerances:\n", "\nmeasures:\n"
FLOOR = "  form: {kind: flatness, of: base.floor, zone: {width: 0.05 mm}}\n"
FACE = "      hole: "
EDGE = "      edge: {kind: plane, at: [60 mm, 80 mm, 5 mm], normal: [0, 1, 0], radius: 4 mm}\n"
EDGE_FORM = "  form: {kind: flatness, of: base.edge, zone: {width: 0.05 mm}}\n"
SECOND = COVER[COVER.index("  cover on the base:\n") : COVER.index(MEASURES)]


def added(section: str, text: str, scene: str = COVER) -> str:
    return scene.replace(section, f"{section}{text}", 1)


def test_flatness_with_a_law_of_a_face_that_touches_nothing(tmp_path: Path) -> None:
    text = added(
        TOLERANCES, EDGE_FORM.replace("mm}}", "mm}, law: {kind: uniform}}"), COVER.replace(FACE, EDGE + FACE, 1)
    )
    found = refusal(text, tmp_path)
    assert "form.law: expected a feature that touches a point in a move, got 'base.edge'; lay it on points" in found
    assert "or leave the law out, and the form acts on nothing" in found
    zone = "  place: {kind: profile, of: base.edge, zone: {width: 0.2 mm}, law: {kind: uniform}}\n"
    assert "or leave the law out, and the form only narrows 'place'" in refusal(added(TOLERANCES, zone, text), tmp_path)


def test_flatness_without_a_law_that_acts_on_nothing_is_shown(tol3d: Command, tmp_path: Path) -> None:
    text = added(TOLERANCES, EDGE_FORM, COVER.replace(FACE, EDGE + FACE, 1))
    (found,) = assembled(text, tmp_path).system.warnings
    assert found.startswith("form: this flatness acts on nothing, for it has no law, and 'base.edge' has no location")
    code, out, _ = tol3d("check", str(tmp_path / "scene.yaml"))
    assert (code, "warning: form: this flatness acts on nothing" in out) == (0, True)
    zone = "  place: {kind: profile, of: base.edge, zone: {width: 0.2 mm}, law: {kind: uniform}}\n"
    assert not assembled(added(TOLERANCES, zone, text), tmp_path).system.warnings
    assert not assembled(
        added(TOLERANCES, FLOOR.replace("mm}}", "mm}, law: {kind: uniform}}")), tmp_path
    ).system.warnings


def test_the_forgotten_move_of_a_second_part_is_no_fix(tmp_path: Path) -> None:
    found = refusal(COVER.replace(SECOND, ""), tmp_path)
    assert (
        "parts.cover: expected a move that places 'cover', got none; add one of part: cover, of kind three_tw" in found
    )
    assert "fix where it stays as it is `placed`" in found


@pytest.mark.parametrize(
    "measure",
    ["{kind: slack, of: pins}", "{kind: gap, from: base.hole, to: cover.hole, along: [1, 0, 0], after: pins}"],
)
def test_a_measure_of_a_forgotten_move_names_the_part_that_it_would_place(measure: str, tmp_path: Path) -> None:
    found = refusal(added(MEASURES, f"  play: {measure}\n", COVER.replace(SECOND, "")), tmp_path)
    assert "got 'pins', which is not in the scene" in found
    assert "; no move places 'cover': add one of part: cover, of kind three_two_one" in found
    placed = refusal(added(MEASURES, f"  play: {measure}\n"), tmp_path)
    assert "no move places" not in placed


def test_a_nominal_out_of_limits_is_shown_by_check(tol3d: Command, tmp_path: Path) -> None:
    path = written(COVER.replace("lower_limit: -0.15 mm, upper_limit: 0.15 mm", "lower_limit: 54.85 mm", 1), tmp_path)
    code, out, _ = tol3d("check", str(path))
    assert code == 0
    joined = " ".join(out.split())
    assert "warning: hole offset: nominal 0.000 µm is outside its limits ≥ 54850 µm" in joined
    assert "flush: nominal" not in joined


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (
            "{kind: uniform, lower: 0 mm, upper: 27 mm}",
            "smaller than the nominal 8 mm, got up to 27 mm; state the deviation",
        ),
        ("{kind: constant, value: 8 mm}", "smaller than the nominal 8 mm, got up to 8 mm; state the deviation"),
    ],
)
def test_a_size_as_large_as_the_feature_is_refused(law: str, words: str, tmp_path: Path) -> None:
    size = "  bore: {{kind: size, of: base.hole, distribution: {}}}\n"
    found = refusal(added(TOLERANCES, size.format(law)), tmp_path)
    assert f"tolerances.bore.distribution: expected deviations {words}" in found
    assembled(added(TOLERANCES, size.format(law.replace("7 mm", "7 um").replace("8 mm", "8 um"))), tmp_path)


@pytest.mark.parametrize(
    ("datums", "own", "got"),
    [("base.floor", "floor", "base.floor"), ("base.back-base.left", "back-left", "base.back-base.left")],
)
def test_a_datum_with_its_part_is_answered_without_it(datums: str, own: str, got: str, tmp_path: Path) -> None:
    found = refusal(COVER.replace("datums: [floor]", f"datums: [{datums}]", 1), tmp_path)
    assert f"datums[0]: expected {own}, without its part, for datums are of the same part as the" in found
    assert f"got '{got}'" in found


def test_a_move_with_play_without_a_float_is_answered_with_the_choices(tmp_path: Path) -> None:
    pins = "  cover on pins: {kind: pin_and_hole, part: cover, pairs: [{from: cover.hole, to: base.hole}]}\n"
    found = refusal(COVER.replace(SECOND, pins), tmp_path)
    assert "expected the position of the part within its play (no default): {kind: centred}, {kind: random}" in found
    assert "moves.cover on pins.float" in found
