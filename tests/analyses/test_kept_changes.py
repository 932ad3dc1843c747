"""What-ifs kept in a scene: one place of its text changes, and it draws what the response with the changes draws."""

import difflib
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from assembly.composite_plate import plate
from fixtures import Command

from tol3d import InputError
from tol3d.analyses.kept_changes import in_numbers, scene_with
from tol3d.analyses.response import Response, response_of
from tol3d.analyses.stated_changes import Change, change_of, changed
from tol3d.analyses.stated_classes import sizes_of
from tol3d.analyses.stated_limits import limited, limits_of_text
from tol3d.assembly.zones import Process
from tol3d.kinds import NEEDED_KINDS
from tol3d.scene import Scene
from tol3d.scene.bundled import bundled_scenes
from tol3d.scene.load import scene_of_text
from tol3d.simulate import load, simulation_of
from tol3d.study.system.other_laws import Zoned

ROWS = 4  # of draws, by which laws are compared

NOT_IN_NUMBERS = {("every_field", "wheel tooth thickness"): "expected a law that numbers state, got empirical"}
"""Tolerances that can be scaled and that no numbers of the scene state."""


@cache
def response(name: str) -> Response:
    return response_of(simulation_of(load(name)), analytic=True)


def read_again(scene: Scene) -> Scene:
    return scene_of_text(scene.source, scene.text.encode(), scene.grammar, files=scene.files)


def hunks(before: str, after: str) -> list[list[str]]:
    """Lines of the new text, by places that changed."""
    own, other = before.splitlines(), after.splitlines()
    codes = difflib.SequenceMatcher(None, own, other, autojunk=False).get_opcodes()
    return [other[code[3] : code[4]] for code in codes if code[0] != "equal"]


def drawn(own: Response) -> dict[str, list[list[float]]]:
    deviations = own.kept(ROWS).deviations
    return {name: deviations[:, columns].tolist() for name, columns in own.slices.items()}


def assert_kept(name: str, change: Change, scene: Scene | None = None, before: Response | None = None) -> Scene:
    """The scene with a change draws what the response draws; the text written as read again."""
    scene, before = scene or load(name), before or response(name)
    kept = scene_with(before, scene, [change])
    again = read_again(kept)
    assert again.model_dump(warnings=False) == kept.model_dump(warnings=False), change
    found, expected = (
        drawn(own) for own in (response_of(simulation_of(again), analytic=True), changed(before, [change]))
    )
    assert found.keys() == expected.keys()
    for contributor, values in expected.items():  # to the ten digits that are written, of deviations of mm
        np.testing.assert_allclose(
            found[contributor], values, rtol=1e-9, atol=1e-10, err_msg=f"{change}, {contributor}"
        )
    return kept


def others(own: Response, line: str) -> list[Change]:
    """Changes of a line: wider, or as near to it as it may be; other limits or another width."""
    scope, draw = own.scope(line), own.drawn_by(own.lines[line][0])
    if scope.factors is None:
        return []
    most = scope.factors[1]
    changes = [Change(line, factor=1.25 if most > 1.25 else (1 + most) / 2 if most > 1.01 else 0.75)]
    limits = getattr(draw.distribution, "limits", None)
    if isinstance(draw, Zoned):
        return changes if isinstance(draw, Process) else [*changes, Change(line, size=0.9 * draw.width)]
    if limits is not None:
        inside = 0.1 * (limits[1] - limits[0])
        changes.append(Change(line, limits=(limits[0] + inside, limits[1] - inside)))
    return changes


def keeps_every_line(name: str) -> None:
    scene, own, kept = load(name), response(name), 0
    windows = scene_of_text(scene.source, scene.text.replace("\n", "\r\n").encode(), scene.grammar, files=scene.files)
    for line in own.simulation.lines:
        for change in others(own, line.name) if line.entries else ():
            if (name, line.name) in NOT_IN_NUMBERS:
                with pytest.raises(InputError, match=NOT_IN_NUMBERS[name, line.name]):
                    scene_with(own, scene, [change])
                continue
            text = assert_kept(name, change).text
            (lines,) = hunks(scene.text, text)
            assert len(lines) == 1 + ("outward" in lines[-1] and len(lines) > 1), change
            assert scene_with(own, windows, [change]).text == text.replace("\n", "\r\n")
            kept += 1
    assert kept or not any(others(own, line.name) for line in own.simulation.lines if line.entries)


@pytest.mark.parametrize(
    "name",
    [
        own if own in ("spur_pair", "tooth_deviations", "bolted_cover") else pytest.param(own, marks=pytest.mark.slow)
        for own in sorted(bundled_scenes())
    ],
)
def test_a_kept_change_is_one_place_of_the_text_and_draws_what_the_response_draws(name: str) -> None:
    keeps_every_line(name)


# as it is written -------------------------------------------------------------------------------------------------

PAIR = """scene: small  # a pair
default_law: {kind: normal, sigmas: 3}
parts:
  a: {kind: spur_gear, teeth: 24, module: 2 mm, face_width: 18 mm}
  b: {kind: spur_gear, teeth: 36, module: 2 mm, face_width: 18 mm}
tolerances:
  t: {kind: tooth_thickness, of: a, distribution: WRITTEN}  # thin
moves: {mesh: {kind: mesh, driver: a, driven: b, centre_distance: 60.2 mm}}
measures: {play: {kind: normal_backlash, of: mesh}}
"""


def pair(written: str, text: str = PAIR) -> Scene:
    return read(text.replace("WRITTEN", written))


def read(text: str) -> Scene:
    return scene_of_text(Path("scene.yaml"), text.encode(), NEEDED_KINDS)


@pytest.mark.parametrize(
    ("written", "value", "after"),
    [
        ("±0.02 mm", 1.25, "±0.025 mm"),
        ("±0.02 mm", "+0.03/-0.01 mm", "+0.03/-0.01 mm"),
        ("+- 20um", 0.5, "+- 10um"),
        ("±20 µm", 1 / 3, "±6.666666667 µm"),
        ("+0.02/0 mm", 1.5, "+0.025/-0.005 mm"),
        ("+0.02/0 mm", "±0.01 mm", "+0.01/-0.01 mm"),
        ("0/−25 µm", 0.6, "-5/-20 µm"),
        ("40.1 mm +0.12/0", 0.5, "40.1 mm +0.09/+0.03"),
        ("40.1 mm ±0.05", 1.2, "40.1 mm ±0.06"),
        ("40.1 mm -20 um / -0.036 mm", "[-40 um, -10 um]", "40.1 mm -10 um / -0.04 mm"),
        ("[-19 um, -30 um]", "[-31 um, -18 um]", "[-18 um, -31 um]"),
        ("[ -0.001 in, 0.002 in ]", 2.0, "[ -0.0025 in, 0.0035 in ]"),
        ("{limits: ±0.1 mm, law: {kind: uniform}}", 0.5, "{limits: ±0.05 mm, law: {kind: uniform}}"),
        ("{limits: [-30 um, -19 um]}", "[-25 um, -19 um]", "{limits: [-25 um, -19 um]}"),
        ("{fit: H7, of: 32 mm}", "+0.0375/0 mm", "+0.0375/0 mm"),
        ("{fit: js7, of: 60 mm}", 1.25, "±0.01875 mm"),
        (
            "{fit: k6, of: 1.26 in, law: {kind: triangular}}",
            0.5,
            "{limits: +0.0005511811024/+0.0002362204724 in, law: {kind: triangular}}",
        ),
        ("{general: m, of: 60 mm}", 0.5, "±0.15 mm"),
        ("{kind: uniform, lower: -5µm, upper: 0.01 mm}", "-5um..8um", "{kind: uniform, lower: -5µm, upper: 0.008 mm}"),
        (
            "{kind: normal, sigmas: 4, upper: '9 um', lower: 0 um}",
            2.0,
            "{kind: normal, sigmas: 4, upper: '13.5 um', lower: -4.5 um}",
        ),
    ],
)
def test_units_and_words_stay_as_they_were_written(written: str, value: str | float, after: str) -> None:
    scene = pair(written)
    own = response_of(simulation_of(scene), analytic=True)
    change = Change("t", factor=value) if isinstance(value, float) else change_of(own, f"t={value}")
    text = assert_kept("", change, scene, own).text
    assert text == PAIR.replace("WRITTEN", after)


def test_letters_that_became_numbers_are_told() -> None:
    scene = pair("{fit: js7, of: 60 mm}")
    own = response_of(simulation_of(scene), analytic=True)
    kept = scene_with(own, scene, [Change("t", factor=0.5)])
    assert in_numbers(scene, kept) == {"t": "±0.0075 mm, was js7"}
    again = response_of(simulation_of(kept), analytic=True)
    assert in_numbers(kept, scene_with(again, kept, [Change("t", factor=0.5)])) == {}
    teeth = load("tooth_deviations")
    kept = scene_with(response("tooth_deviations"), teeth, [Change("pinion pitch", factor=2.0)])
    assert in_numbers(teeth, kept) == {"pinion pitch": "{single: 12 um, cumulative: 34 um}, was iso_class 5"}


def test_a_shared_law_is_changed_at_its_tolerance_alone() -> None:
    text = PAIR.replace("WRITTEN", "&thin [-30 um, -19 um]").replace(
        "moves:", "  u: {kind: tooth_thickness, of: b, distribution: *thin}\nmoves:"
    )
    scene = read(text)
    own = response_of(simulation_of(scene), analytic=True)
    kept = assert_kept("", Change("u", limits=(-0.03, -0.02)), scene, own)
    assert hunks(text, kept.text) == [["  u: {kind: tooth_thickness, of: b, distribution: [-30 um, -20 um]}"]]
    assert_kept("", Change("t", factor=0.5), scene, own)


TURNING = "measures: {error: {kind: transmission_error, of: mesh, positions: 384, take: range}}"


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        (
            "{kind: tooth_to_tooth, of: a, limits: {grade: 7}, law: {kind: uniform}}",
            "{kind: tooth_to_tooth, of: a, limits: {size: 16.25 um}, law: {kind: uniform}}",
            "{size: 16.25 um}, was grade 7",
        ),
        (
            "{kind: pitch_deviation, of: a, flanks: each, limits: {iso_class: 7}, law: {kind: normal, cpk: 1.33}}",
            "{kind: pitch_deviation, of: a, flanks: each, limits: {single: 15 um, cumulative: 43.75 um}, "
            "law: {kind: normal, cpk: 1.33}}",
            "{single: 15 um, cumulative: 43.75 um}, was iso_class 7",
        ),
        (
            "{kind: helix_slope, of: a, flanks: each, each: tooth, law: {kind: stated, distribution: ±4 um}}",
            "{kind: helix_slope, of: a, flanks: each, each: tooth, law: {kind: stated, distribution: ±5 um}}",
            None,
        ),
    ],
)
def test_classes_of_flanks_become_the_numbers_that_they_are_of_the_gear(
    before: str, after: str, words: str | None
) -> None:
    """f_i'' 13 um and f_p 12 um, F_p 35 um, each by 1.25."""
    measures = PAIR[PAIR.index("measures:") :].strip()
    text = PAIR.replace(measures, TURNING).replace("60.2", "60.5")
    entry = "{kind: tooth_thickness, of: a, distribution: WRITTEN}"
    scene = read(text.replace(entry, before))
    own = response_of(simulation_of(scene), analytic=True)
    kept = assert_kept("", Change("t", factor=1.25), scene, own)
    assert kept.text == text.replace(entry, after)
    assert in_numbers(scene, kept).get("t") == words


ANCHORED = """\
  t: &all
    kind: tooth_thickness
    distribution: {kind: normal, lower: &low -30 um, upper: -19 um}
    of: a
"""
WIDER = "    distribution: {kind: normal, lower: %s-31.375 um, upper: -17.625 um}"
ALL = "{kind: tooth_thickness, distribution: {kind: normal, lower: -30 um, upper: -19 um}, of: a}"


@pytest.mark.parametrize(
    ("lines", "after"),
    [
        (
            "  t:\n    kind: tooth_thickness\n    of: a\n    distribution:\n      # why\n      - -30 um  # low\n"
            "      - -19 um  # high\n",
            [["      - -31.375 um  # low", "      - -17.625 um  # high"]],
        ),
        (
            "  t:\n    kind: tooth_thickness\n    distribution:\n      fit: g6\n      of: 32 mm\n    of: a\n",
            [["    distribution: -0.007/-0.027 mm"]],
        ),
        (f"{ANCHORED}  u:\n    <<: *all\n    of: b\n", [["  t:"], [WIDER % "&low "], [f"    <<: &all {ALL}"]]),
        (
            f"{ANCHORED}  u: {{kind: tooth_thickness, of: b, distribution: [*low, 1 um]}}\n",
            [[WIDER % ""], ["  u: {kind: tooth_thickness, of: b, distribution: [&low -30 um, 1 um]}"]],
        ),
    ],
)
def test_values_on_several_lines_and_shared_ones_change_in_their_place(lines: str, after: list[list[str]]) -> None:
    text = "".join(lines if "WRITTEN" in line else line for line in PAIR.splitlines(keepends=True))
    scene = read(text)
    own = response_of(simulation_of(scene), analytic=True)
    assert hunks(text, assert_kept("", Change("t", factor=1.25), scene, own).text) == after


# of other files, and of none -------------------------------------------------------------------------------------

GEAR = """parts:
  gear: {kind: spur_gear, teeth: 30, module: 2 mm, face_width: 18 mm}
tolerances:
  thin: {kind: tooth_thickness, of: gear, distribution: {kind: uniform, lower: -30 um, upper: -10 um}}
"""
INCLUDING = """scene: two alike
include: {one: gear.yaml, other: gear.yaml}
moves: {mesh: {kind: mesh, driver: one gear, driven: other gear, centre_distance: 60.2 mm}}
measures: {play: {kind: normal_backlash, of: mesh}}
"""


def test_a_line_of_a_file_that_is_included_twice_is_kept_for_both(tmp_path: Path) -> None:
    (tmp_path / "gear.yaml").write_text(GEAR, "utf-8")
    (tmp_path / "scene.yaml").write_text(INCLUDING, "utf-8")
    scene = load(tmp_path / "scene.yaml")
    own = response_of(simulation_of(scene), analytic=True)
    kept = assert_kept("", Change("thin of gear.yaml", factor=0.5), scene, own)
    assert kept.text.count("without: [thin]") == kept.text.count("lower: -25 um, upper: -15 um") == 2


def test_a_dimension_under_a_general_tolerance_gets_one_of_its_own() -> None:
    plates = read(GENERAL)
    own = response_of(simulation_of(plates), analytic=True)
    kept = assert_kept("", Change("size of plate bore", factor=0.5), plates, own)
    (added,) = hunks(GENERAL, kept.text)
    assert added == ["tolerances:", "  size of plate bore: {kind: size, of: plate.bore, distribution: ±0.1 mm}"]


GENERAL = """scene: plate
default_law: {kind: uniform}
general: mK
parts:
  plate:
    kind: solid
    features:
      A: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [100 mm, 60 mm]}
      bore: {kind: cylinder, at: [0 mm, 0 mm, 5 mm], axis: [0, 0, 1], length: 10 mm, diameter: 8 mm, hole: true}
moves: {bench: {kind: fix, part: plate}}
measures: {bore: {kind: inspected_size, of: plate.bore}}
"""


# refused ----------------------------------------------------------------------------------------------------------


def test_what_the_scene_cannot_say_is_refused() -> None:
    with pytest.raises(InputError, match="pinion profile slope: expected a tolerance whose law the scene states"):
        scene_with(
            response("tooth_deviations"),
            load("tooth_deviations"),
            [Change("pinion profile slope", limits=(0.0, 0.001))],
        )
    with pytest.raises(InputError, match="encoder of angle: expected a tolerance of the scene, got what a move says"):
        scene_with(response("slider_crank"), load("slider_crank"), [Change("encoder of angle", factor=0.5)])
    with pytest.raises(InputError, match="bearing clearance: expected at least 0 um"):
        scene_with(response("spur_pair"), load("spur_pair"), [Change("bearing clearance", factor=1.2)])


@pytest.mark.parametrize("law", ["uniform", "normal"])
@pytest.mark.parametrize("envelope", ["false", "true"])
def test_a_form_in_a_fit_begins_at_nothing_however_wide(law: str, envelope: str) -> None:
    """With an envelope it is what the size leaves of it."""
    form = f"  form: {{kind: straightness, of: base.pin 1, zone: {{diameter: 4 um}}, law: {{kind: {law}}}}}\n"
    text = load("hole_and_slot").text.replace("tolerances:\n", f"tolerances:\n{form}", 1)
    scene = read(f"envelope: {envelope}\n{text}")
    own = response_of(simulation_of(scene), analytic=True)
    kept = assert_kept("", Change("form", factor=1.5), scene, own)
    assert hunks(scene.text, kept.text) == [[form.replace("4 um", "6 um").rstrip()]]
    assert own.scaled({"form": 1.5}).drawn_by("form").distribution.low == 0.0


def test_both_segments_of_a_composite_tolerance_go_together() -> None:
    scene = read(plate())
    own = response_of(simulation_of(scene), analytic=True)
    both = ("holes", "holes shift and turn")
    with pytest.raises(InputError, match="holes: expected one factor on 'holes' and 'holes shift and turn', which one"):
        scene_with(own, scene, [Change("holes", factor=0.5)])
    kept = scene_with(own, scene, [Change(name, factor=0.5) for name in both])
    assert hunks(scene.text, kept.text) == [
        ["    zone: {diameter: 0.15 mm}"],
        ["    lower_segment: {zone: {diameter: 0.05 mm}, datums: [A]}"],
    ]


def test_the_command_writes_the_scene(tol3d: Command, tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(PAIR.replace("WRITTEN", "{fit: js7, of: 60 mm}"), "utf-8")
    out = tmp_path / "wider.yaml"
    words = ("what-if", f"{tmp_path}/scene.yaml", "--factor", "t=1.25", "--quick", "--out", str(out))
    code, said, _ = tol3d(*words)
    assert code == 0
    assert said.replace("\n", "").endswith(f"scene: {out}t: ±0.01875 mm, was js7")
    assert out.read_text("utf-8") == PAIR.replace("WRITTEN", "±0.01875 mm")
    code, _, said = tol3d(*words)
    assert code == 2
    assert "expected the name of a new file" in said


@pytest.mark.parametrize(
    ("written", "value", "after"),
    [
        ("{fit: js7, of: 60 mm}", "js8", "{fit: js8, of: 60 mm}"),
        ("{fit: k6, of: 1.26 in, law: {kind: triangular}}", "h7", "{fit: h7, of: 1.26 in, law: {kind: triangular}}"),
        ("40.1 mm +0.12/0", "H9", "{fit: H9, of: 40.1 mm}"),
        ("{general: m, of: 60 mm}", "m6", "{fit: m6, of: 60 mm}"),
        ("{din_3967: cd25}", "d24", "{din_3967: d24}"),
        ("{din_3967: c25, law: {kind: triangular}}", "{din_3967: 24 d}", "{din_3967: 24 d, law: {kind: triangular}}"),
        ("-40/-90 um", "{din_3967: cd25}", "{din_3967: cd25}"),
        ("{fit: js7, of: 60 mm}", "cd25", "{din_3967: cd25}"),
        ("-40/-90 um", "{fit: h7, of: 60 mm}", "{fit: h7, of: 60 mm}"),
        ("{fit: js7, of: 60 mm}", "{of: 10 mm, fit: h7}", "{fit: h7, of: 10 mm}"),
    ],
)
def test_a_class_is_kept_as_a_class_where_the_line_has_limits_of_a_drawing(
    written: str, value: str, after: str
) -> None:
    scene = pair(written)
    simulation = simulation_of(scene)
    own, sizes = response_of(simulation, analytic=True), sizes_of(scene, simulation.lines)
    kept = assert_kept("", change_of(own, f"t={value}", sizes), scene, own)
    assert hunks(scene.text, kept.text) == [[f"  t: {{kind: tooth_thickness, of: a, distribution: {after}}}  # thin"]]
    assert in_numbers(scene, kept) == {}


def test_a_series_of_din_3967_is_read_at_the_reference_diameter() -> None:
    """At 48 mm cd is -54 um and 25 a tolerance of 30 um; a law with limits of its own is kept in numbers."""
    scene = pair("{kind: uniform, lower: -90 um, upper: -40 um}")
    simulation = simulation_of(scene)
    own, sizes = response_of(simulation, analytic=True), sizes_of(scene, simulation.lines)
    change = change_of(own, "t={ din_3967: cd25 }", sizes)
    assert change.limits == pytest.approx((-0.084, -0.054), rel=1e-12)
    assert change == change_of(own, "t=cd25", sizes)
    kept = assert_kept("", change, scene, own)
    assert kept.text == scene.text.replace("lower: -90 um, upper: -40 um", "lower: -84 um, upper: -54 um")
    for value in ("cd40", "H7", "{din_3967: H7}"):
        with pytest.raises(InputError, match="and 21 to 30, as in cd25, got"):
            change_of(own, f"t={value}", sizes)
    scene = read(CENTRE)
    simulation = simulation_of(scene)
    own, sizes = response_of(simulation, analytic=True), sizes_of(scene, simulation.lines)
    with pytest.raises(InputError, match="measured: arc, got 'cd25' of another tolerance"):
        change_of(own, "t={din_3967: cd25}", sizes)
    assert change_of(own, "t={din_3964: js7}", sizes).limits == pytest.approx((-0.015, 0.015), rel=1e-12)


CENTRE = PAIR.replace(
    "t: {kind: tooth_thickness, of: a, distribution: WRITTEN}",
    "t: {kind: centre_distance, of: mesh, distribution: {kind: normal, lower: -5 um, upper: 9 um}}",
)


def test_a_class_of_a_size_that_a_part_or_move_states_is_kept_in_numbers_where_a_law_has_limits_of_its_own() -> None:
    """H7 of 60.2 mm is 0 to 30 µm, ISO 286-2, table 6; j6 of it -7 to 12 µm."""
    scene = read(CENTRE)
    simulation = simulation_of(scene)
    own, sizes = response_of(simulation, analytic=True), sizes_of(scene, simulation.lines)
    assert {name: str(own["fit"]) for name, own in sizes.items()} == {"t": "60.2 mm"}
    for value, lower, upper in (("H7", 0, 30), ("j6", -7, 12)):
        kept = assert_kept("", change_of(own, f"t={value}", sizes), scene, own)
        assert kept.text == scene.text.replace("lower: -5 um, upper: 9 um", f"lower: {lower} um, upper: {upper} um")
    for value, words in (("H77", "expected"), ("q7", "expected")):
        with pytest.raises(InputError, match=words):
            change_of(own, f"t={value}", sizes)
    with pytest.raises(
        InputError, match="for the scene states no nominal size at which a class could be read, got 'H7'"
    ):
        change_of(own, "t=H7")
    at_60 = change_of(own, "t={fit: H8, of: 60 mm}")
    assert at_60.limits == pytest.approx((0.0, 0.046), rel=1e-12)
    kept = assert_kept("", at_60, scene, own)
    assert kept.text == scene.text.replace("lower: -5 um, upper: 9 um", "lower: 0 um, upper: 46 um")
    for value, got in (("60", "got '60'"), ("60 deg", "got 60 deg"), ("-60 mm", "got -60 mm")):
        with pytest.raises(InputError, match=f"nominal size such as 60 mm in .fit: H8, of: {value}.*{got}"):
            change_of(own, f"t={{fit: H8, of: {value}}}")


@pytest.mark.parametrize(
    ("text", "before", "after"),
    [
        ("play=30 um..", "lower_limit: 40 µm", "lower_limit: 30 µm"),
        ("play=0.03 mm..", "lower_limit: 40 µm", "lower_limit: 0.03 mm"),
        ("play=..90 um", "lower_limit: 40 µm}", "lower_limit: 40 µm, upper_limit: 90 um}"),
        ("play=none..", "lower_limit: 40 µm", "lower_limit: null"),
        ("play=none..90 µm", "lower_limit: 40 µm}", "lower_limit: null, upper_limit: 90 um}"),
        ("play=±90um", "lower_limit: 40 µm}", "lower_limit: -90 µm, upper_limit: 90 um}"),
    ],
)
def test_limits_are_kept_in_their_line(text: str, before: str, after: str) -> None:
    scene = pair("±20 um", PAIR.replace("of: mesh}}", "of: mesh, lower_limit: 40 µm}}  # play"))
    own = response_of(simulation_of(scene), analytic=True)
    limits = limits_of_text(own, text)
    kept = scene_with(own, scene, [], [limits])
    assert kept.text == scene.text.replace(before, after)
    again = read_again(kept)
    assert again.model_dump(warnings=False) == kept.model_dump(warnings=False)
    (asked,) = limited(own.measures, [limits])
    (found,) = simulation_of(again).system.measures
    assert (found.lower_limit, found.upper_limit) == (asked.lower_limit, asked.upper_limit)
    assert asked.lower_limit != own.measures[0].lower_limit or asked.upper_limit != own.measures[0].upper_limit


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("play=50 um", "expected limits such as 10 um..40 um"),
        ("play=..", "expected limits such as 10 um..40 um"),
        ("play=50..60 um", "expected a length with its unit, such as \"4.5 um\", or none, got '50', a bare number"),
        ("play=wide..", "or none, got 'wide'"),
        ("play=5 deg..", "expected a length with its unit"),
        ("play=", "expected MEASURE=LOW..HIGH"),
        ("plai=5 um..", "got 'plai'; did you mean"),
        ("play=..39 um", "expected a lower limit below the upper one, got 40 um and 39 um"),
    ],
)
def test_limits_that_cannot_be_are_refused(text: str, words: str) -> None:
    scene = pair("±20 um", PAIR.replace("of: mesh}}", "of: mesh, lower_limit: 40 um}}"))
    own = response_of(simulation_of(scene), analytic=True)
    with pytest.raises(InputError, match=re.escape(words)):
        limited(own.measures, [limits_of_text(own, text)])


def test_limits_of_a_curve_are_those_of_its_ends() -> None:
    """Its lowest value has the lower one alone; kept, they are the curve's."""
    name = "error"
    scene = read(
        pair("±20 um").text.replace(
            "play: {kind: normal_backlash, of: mesh}",
            f"{name}: {{kind: normal_backlash, of: mesh, over: turn, positions: 6, take: curve}}",
        )
    )
    own = response_of(simulation_of(scene), analytic=True)
    texts = (f"{name}, lowest=7 um..", f"{name}, highest=..95 um")
    kept = scene_with(own, scene, [], [limits_of_text(own, text) for text in texts])
    assert kept.text == scene.text.replace("take: curve}", "take: curve, lower_limit: 7 um, upper_limit: 95 um}")
    for text in (f"{name}, lowest=..7 um", f"{name}, highest=7 um.."):
        with pytest.raises(InputError, match="which the other end of its curve has"):
            limits_of_text(own, text)
