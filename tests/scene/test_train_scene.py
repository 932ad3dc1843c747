"""Trains in scenes: shafts, bearings, arms, reducers and what is measured on them, as text."""

import json
import re
from pathlib import Path

import jsonschema
import pytest
from guides import quoted, text_of
from of_kind import of_kind
from scene.scene_schema import judged

from tol3d import Scene, load_scene
from tol3d.errors import SceneError
from tol3d.gearing.grammar.measures import LostMotionSpec, MeshMeasureSpec, TrainMeasureSpec
from tol3d.gearing.grammar.moves import GearMeshSpec, TrainSpec, meshes_of
from tol3d.gearing.grammar.parts import ArmSpec, BearingSpec, GearSpec, ShaftReference, ShaftSpec, gears_on
from tol3d.gearing.grammar.tolerances.bearing_clearance import BearingClearanceSpec
from tol3d.kinds import all_kinds
from tol3d.scene.entry import any_of

SHOULDER, _ = quoted("trains")

LENGTH = 'expected a length with its unit, such as "4.5 um", got'
SHAFT = "expected the name of a shaft, or of a gear that none carries, got"


def load(folder: Path, text: str) -> Scene:
    path = folder / "shoulder.yaml"
    path.write_text(text, encoding="utf-8")
    return load_scene(path)


def changed(*changes: tuple[str, str]) -> str:
    """The shoulder with some things changed."""
    text = SHOULDER
    for old, new in changes:
        assert text.count(old) == 1, (old, text.count(old))
        text = text.replace(old, new)
    return text


def said_of(folder: Path, text: str) -> list[str]:
    """Messages on a scene, without file and line."""
    with pytest.raises(SceneError) as caught:
        load(folder, text)
    return [re.sub(r"^.*?:\d+: ", "", problem) for problem in caught.value.problems]


# what is right ------------------------------------------------------------------------------------


def test_the_documents_shoulder_is_that_of_the_paper(tmp_path: Path) -> None:
    scene = load(tmp_path, SHOULDER)
    spur, bevel = scene.of(GearMeshSpec).values()
    (train,) = scene.of(TrainSpec).values()
    teeth = [of_kind(GearSpec, scene.parts[gear]).teeth for gear in (*spur.gears, *bevel.gears)]
    assert teeth == [28, 110, 31, 31]
    assert (spur.ratio, bevel.ratio) == pytest.approx((110 / 28, 1.0), rel=1e-4)
    assert train.ratio == pytest.approx(152 * 110 / 28, rel=1e-6)
    x, y, _ = (length.internal for length in of_kind(ArmSpec, scene.parts["arm"]).points["tip"])
    assert x**2 + y**2 == 763**2  # the paper's lever [mm]
    assert of_kind(TrainSpec, scene.moves["shoulder swing"]).gravity == (-1.0, 0.0, 0.0)


def test_the_documents_shoulder_satisfies_the_json_schema() -> None:
    judged(SHOULDER)


def test_the_documents_shoulder_survives_being_written_and_read(tmp_path: Path) -> None:
    scene = load(tmp_path, SHOULDER)
    again = Scene.model_validate(json.loads(scene.model_dump_json(exclude_unset=True, by_alias=True)))
    assert again.model_dump() == scene.model_dump()


def test_defaults_of_trains_are_those_of_the_grammar(tmp_path: Path) -> None:
    scene = load(tmp_path, SHOULDER)
    carried = of_kind(ShaftSpec, scene.parts["reducer output"]).carries["pinion"]
    assert (carried.at.internal, carried.facing, carried.phase.internal) == (0.0, "forward", 0.0)
    spur, motor = of_kind(GearMeshSpec, scene.moves["spur pair"]), of_kind(ShaftSpec, scene.parts["motor"])
    assert motor.carries == {}
    assert (spur.azimuth.internal, motor.diameter, motor.start, motor.end) == (0.0, None, None, None)
    assert of_kind(LostMotionSpec, scene.measures["lost motion"]).shaft is None


def test_reducers_and_trains_hold_no_gears_of_the_scene(tmp_path: Path) -> None:
    scene = load(tmp_path, SHOULDER)
    assert scene.moves.keys() - scene.of(GearMeshSpec) == {"planetary reducer", "shoulder swing"}
    assert meshes_of("wheel", scene.moves) == ("spur pair",)


def test_a_tip_error_is_a_curve_and_other_measures_of_trains_are_values(tmp_path: Path) -> None:
    measures = load(tmp_path, SHOULDER).measures
    taken = {}
    for name, measure in measures.items():
        assert isinstance(measure, MeshMeasureSpec | TrainMeasureSpec)
        taken[name] = (measure.take, measure.several_positions, measure.dimension)
    assert taken == {
        "spur backlash": ("value", False, "length"),
        "lost motion": ("value", False, "angle"),
        "lost motion of the spline shaft": ("value", False, "angle"),
        "tip displacement": ("value", False, "length"),
        "tip error over the swing": ("curve", True, "length"),
    }


def test_gears_on_a_shaft_are_those_it_carries_and_a_free_gear_is_its_own(tmp_path: Path) -> None:
    free = changed(
        ("carries: {pinion: {}}  ", ""),
        ("driven: reducer output", "driven: pinion"),
        ("of: reducer output ", "of: pinion"),
    )
    parts = load(tmp_path, free).parts
    assert gears_on("spline shaft", parts) == ("wheel", "bevel driver")
    assert gears_on("pinion", parts) == ("pinion",)
    assert gears_on("motor", parts) == ()


def test_a_bearing_may_carry_a_gear_that_is_its_own_shaft(tmp_path: Path) -> None:
    free = changed(
        ("      wheel: {phase: 5 deg} ", ""),
        ("    shaft: spline shaft           # a shaft", "    shaft: wheel # a shaft"),
        ("    carries:                      # a gear", "    carries:  # a gear"),
    )
    assert of_kind(BearingSpec, load(tmp_path, free).parts["spline bearing"]).shaft == "wheel"


@pytest.mark.parametrize("direction", ["random", "{at: 30 deg}"])
def test_a_bearing_whose_direction_is_none_of_a_mesh_needs_no_mesh(direction: str, tmp_path: Path) -> None:
    text = re.sub(r"    mesh: spur pair .*\n    direction: apart\n", f"    direction: {direction}\n", SHOULDER)
    assert of_kind(BearingClearanceSpec, load(tmp_path, text).tolerances["spline bearing clearance"]).mesh is None


def test_kinds_are_said_in_words_that_tell_them_apart() -> None:
    assert any_of((GearSpec, ShaftSpec)) == "a gear or a shaft"
    assert any_of((GearSpec, BearingSpec)) == "a gear or a bearing"
    assert any_of((GearMeshSpec,)) == "a mesh move"
    assert ShaftReference(("shaft",), "a").expected == "a shaft, or of a gear that none carries"
    kinds = {**all_kinds().kinds("parts"), **all_kinds().kinds("moves")}
    assert len({spec.words for spec in kinds.values()} - {""}) == len(kinds)


# what is wrong ------------------------------------------------------------------------------------

CHANGES = {
    "unknown gear carried": (
        ("{bevel driven: {}}", "{bevel drivn: {}}"),
        "parts.shoulder flange.carries.bevel drivn: expected the name of a gear, got 'bevel drivn', which is not in "
        'the scene; did you mean "bevel driven"?',
    ),
    "a bearing carried": (
        ("{bevel driven: {}}", "{spline bearing: {}}"),
        "parts.shoulder flange.carries.spline bearing: expected the name of a gear, got 'spline bearing', which is a "
        "bearing",
    ),
    "a gear on two shafts": (
        ("motor: {kind: shaft}  ", "motor: {kind: shaft, carries: {wheel: {}}}  "),
        "parts.spline shaft.carries.wheel: expected a gear that no other shaft carries, got 'wheel', which 'motor' "
        "carries",
    ),
    "unknown key in carries": (
        ("wheel: {phase: 5 deg}", "wheel: {phse: 5 deg}"),
        'parts.spline shaft.carries.wheel.phse: unknown key "phse"; did you mean "phase"?',
    ),
    "nothing behind a carried gear": (
        ("wheel: {phase: 5 deg}", "wheel: "),
        "parts.spline shaft.carries.wheel: expected keys with values, such as {at: …, facing: …, phase: …}, got "
        "nothing",
    ),
    "unknown facing": (
        ("facing: backward", "facing: backwards"),
        "parts.spline shaft.carries.bevel driver.facing: expected forward or backward, got 'backwards'; did you mean "
        '"backward"?',
    ),
    "carried at an angle": (
        ("at: 180 mm", "at: 180 deg"),
        f"parts.spline shaft.carries.bevel driver.at: {LENGTH} '180 deg', which is an angle",
    ),
    "ends reversed": (
        ("start: -30 mm", "start: 110 mm"),
        "parts.spline shaft.start: expected less than the end (110 mm), got '110 mm'",
    ),
    "no diameter": (
        ("diameter: 60 mm", "diameter: 0 mm"),
        "parts.spline shaft.diameter: expected a length of more than zero, got '0 mm'",
    ),
    "negative diameter of an arm": (
        ("diameter: 40 mm", "diameter: -40 mm"),
        "parts.arm.diameter: expected a length of more than zero, got '-40 mm'",
    ),
    "a bearing on a gear that a shaft carries": (
        ("    shaft: spline shaft           # a shaft", "    shaft: wheel # a shaft"),
        f"parts.spline bearing.shaft: {SHAFT} 'wheel', which 'spline shaft' carries; known here: spline shaft",
    ),
    "an arm on a gear that a shaft carries": (
        ("shaft: shoulder flange ", "shaft: bevel driven "),
        f"parts.arm.shaft: {SHAFT} 'bevel driven', which 'shoulder flange' carries",
    ),
    "an arm on a bearing": (
        ("shaft: shoulder flange ", "shaft: spline bearing "),
        f"parts.arm.shaft: {SHAFT} 'spline bearing', which is a bearing",
    ),
    "an arm on nothing": (
        ("shaft: shoulder flange ", "shaft: shoulder flang "),
        f"parts.arm.shaft: {SHAFT} 'shoulder flang', which is not in the scene; did you mean \"shoulder flange\"?",
    ),
    "a bare number in a point": (
        ("tip: [420 mm, 637 mm, 90 mm]", "tip: [420 mm, 3, 90 mm]"),
        f"parts.arm.points.tip[1]: {LENGTH} 3, a bare number without its unit",
    ),
    "an angle in a point": (
        ("tip: [420 mm, 637 mm, 90 mm]", "tip: [420 mm, 637 mm, 90 deg]"),
        f"parts.arm.points.tip[2]: {LENGTH} '90 deg', which is an angle",
    ),
    "a point with two entries": (
        ("tip: [420 mm, 637 mm, 90 mm]", "tip: [420 mm, 637 mm]"),
        "parts.arm.points.tip: expected three lengths, such as [0 mm, 12 mm, 5 mm], got a list of 2",
    ),
    "a point that is one length": (
        ("tip: [420 mm, 637 mm, 90 mm]", "tip: 420 mm"),
        "parts.arm.points.tip: expected three lengths, such as [0 mm, 12 mm, 5 mm], got '420 mm'",
    ),
    "a centre of mass with four entries": (
        ("[60 mm, 400 mm, 90 mm]", "[60 mm, 400 mm, 90 mm, 1 mm]"),
        "parts.arm.centre_of_mass: expected three lengths, such as [0 mm, 12 mm, 5 mm], got a list of 4",
    ),
    "ratio 0": (("ratio: 152 ", "ratio: 0 "), "moves.planetary reducer.ratio: expected a ratio other than 0, got 0"),
    "ratio in words": (
        ("ratio: 152 ", 'ratio: "152:1" '),
        "moves.planetary reducer.ratio: expected a number, got '152:1'",
    ),
    "ratio 0 of a train": (
        ("ratio: 597.143", "ratio: 0.0"),
        "moves.shoulder swing.ratio: expected a ratio other than 0, got 0",
    ),
    "negative ratio of teeth": (
        ("ratio: 3.9286", "ratio: -3.9286"),
        "moves.spur pair.ratio: expected a number of more than 0, got -3.9286",
    ),
    "negative backlash": (
        ("ratio: 152 ", "backlash: -1 arcmin\n    ratio: 152 "),
        "moves.planetary reducer.backlash: expected an angle of zero or more, got '-1 arcmin'",
    ),
    "a reducer that drives itself": (
        ("driven: reducer output", "driven: motor"),
        "moves.planetary reducer.driven: expected another shaft than the driver, got 'motor'",
    ),
    "a reducer that drives a gear on a shaft": (
        ("driven: reducer output", "driven: pinion"),
        f"moves.planetary reducer.driven: {SHAFT} 'pinion', which 'reducer output' carries",
    ),
    "a mesh of shafts": (
        ("driver: pinion", "driver: reducer output"),
        "moves.spur pair.driver: expected the name of a spur gear or a helical gear or an internal gear, "
        "got 'reducer output', which is a shaft",
    ),
    "azimuth without unit": (
        ("azimuth: 90 deg", "azimuth: 90"),
        'moves.bevel pair.azimuth: expected an angle with its unit, such as "20 deg", got 90',
    ),
    "no gravity": (
        ("gravity: [-1, 0, 0]", "gravity: [0, 0, 0]"),
        "moves.shoulder swing.gravity: expected a direction with a number other than 0, got zeros only",
    ),
    "gravity in a plane": (
        ("gravity: [-1, 0, 0]", "gravity: [-1, 0]"),
        "moves.shoulder swing.gravity: expected three numbers, such as [0, -1, 0], got a list of 2",
    ),
    "gravity with a unit": (
        ("gravity: [-1, 0, 0]", "gravity: [-1, 0, 9.81 m]"),
        "moves.shoulder swing.gravity[2]: expected a number, got '9.81 m'",
    ),
    "gravity without end": (
        ("gravity: [-1, 0, 0]", "gravity: [-.inf, 0, 0]"),
        "moves.shoulder swing.gravity[0]: expected a number, got -inf",
    ),
    "a train that ends where it starts": (
        ("output: shoulder flange", "output: motor"),
        "moves.shoulder swing.output: expected another shaft than the driven one, got 'motor'",
    ),
    "a reducer held": (
        ("held: motor ", "held: planetary reducer "),
        f"moves.shoulder swing.held: {SHAFT} 'planetary reducer', which is a reducer",
    ),
    "unknown sense": (
        ("turns: counter_clockwise", "turns: anticlockwise"),
        "moves.shoulder swing.turns: expected counter_clockwise or clockwise, got 'anticlockwise'",
    ),
    "reducer backlash as a length": (
        ("lower: 0 arcmin, upper: 1 arcmin", "lower: 0 um, upper: 1 um"),
        "tolerances.reducer play.distribution.lower: expected an angle with its unit, such as \"20 deg\", got '0 um', "
        "which is a length",
    ),
    "reducer backlash of a mesh": (
        ("    of: planetary reducer", "    of: bevel pair"),
        "tolerances.reducer play.of: expected the name of a reducer, got 'bevel pair', which is a bevel mesh",
    ),
    "reducer backlash twice": (
        ("ratio: 152 ", "backlash: 1 arcmin\n    ratio: 152 "),
        "tolerances.reducer play.of: expected a reducer without a backlash of its own, got 'planetary reducer', which "
        "says backlash: 1 arcmin",
    ),
    "run-out of an arm": (
        ("of: reducer output ", "of: arm "),
        "tolerances.reducer run-out.of: expected the name of a gear or a shaft, got 'arm', which is an arm",
    ),
    "clearance of a shaft": (
        ("of: spline bearing ", "of: spline shaft "),
        "tolerances.spline bearing clearance.of: expected the name of a gear or a bearing, got 'spline shaft', which "
        "is a shaft",
    ),
    "clearance of a bearing in no mesh": (
        ("    mesh: spur pair ", "    #"),
        "tolerances.spline bearing clearance.mesh: expected the mesh that a bearing's direction: apart is of, got "
        "none; known here: spur pair, bevel pair",
    ),
    "clearance of a bearing in a mesh elsewhere": (
        ("    shaft: spline shaft           # a shaft", "    shaft: shoulder flange # a shaft"),
        "tolerances.spline bearing clearance.mesh: expected a mesh of a gear on 'shoulder flange', got 'spur pair'; "
        "known here: bevel pair",
    ),
    "lost motion of a mesh": (
        ("    of: shoulder swing\n    over: random", "    of: spur pair\n    over: random"),
        "measures.lost motion.of: expected the name of a train, got 'spur pair', "
        "which is a mesh of spur or helical gears; known "
        "here: shoulder swing",
    ),
    "normal backlash of a train": (
        ("of: spur pair}", "of: shoulder swing}"),
        "measures.spur backlash.of: expected the name of a mesh move, got 'shoulder swing', which is a train",
    ),
    "lost motion of a carried gear": (
        ("    shaft: spline shaft           # the shaft", "    shaft: wheel # the shaft"),
        f"measures.lost motion of the spline shaft.shaft: {SHAFT} 'wheel', which 'spline shaft' carries",
    ),
    "lost motion over a turn": (
        ("over: random ", "over: turn "),
        "measures.lost motion.over: expected random or {at: 30 deg}, got 'turn'",
    ),
    "something taken of one lost motion": (
        ("over: random ", "take: max "),
        'measures.lost motion.take: unknown key "take"',
    ),
    "limit of a lost motion as a length": (
        ("upper_limit: 10 arcmin", "upper_limit: 10 um"),
        "measures.lost motion.upper_limit: expected an angle with its unit",
    ),
    "a point that is not there": (
        ("point: tip\n    over", "point: tipp\n    over"),
        "measures.tip displacement.point: expected a point of the arm 'arm', got 'tipp'; did you mean \"tip\"?",
    ),
    "a tip of a shaft": (
        ("arm: arm\n    point: tip\n    over", "arm: shoulder flange\n    point: tip\n    over"),
        "measures.tip displacement.arm: expected the name of an arm, got 'shoulder flange', which is a shaft; known "
        "here: arm",
    ),
    "a swing reversed": (
        ("start: -60 deg", "start: 60 deg"),
        "measures.tip error over the swing.start: expected less than the end (60 deg), got '60 deg'",
    ),
    "a swing of one position": (
        ("positions: 25 ", "positions: 1 "),
        "measures.tip error over the swing.positions: expected a number of at least 2, got 1",
    ),
    "a swing that takes a minimum": (
        ("positions: 25 ", "take: min "),
        'measures.tip error over the swing.take: unknown key "take"',
    ),
}


@pytest.mark.parametrize(("change", "words"), CHANGES.values(), ids=CHANGES.keys())
def test_one_wrong_thing_in_a_train_is_said_with_its_place(change: tuple[str, str], words: str, tmp_path: Path) -> None:
    said = said_of(tmp_path, changed(change))
    assert [problem for problem in said if problem.startswith(words)], said


def test_an_arm_without_points_is_refused(tmp_path: Path) -> None:
    text = re.sub(r"points: .*\n.*\n.*\n", "points: {}\n", SHOULDER)
    assert "parts.arm.points: expected at least one entry, got an empty mapping" in said_of(tmp_path, text)


def test_the_documents_message_of_a_train_is_what_the_tool_says(tmp_path: Path) -> None:
    with pytest.raises(SceneError) as caught:
        load(tmp_path, changed(("    shaft: spline shaft           # a shaft", "    shaft: wheel # a shaft")))
    assert str(caught.value).replace(f"{tmp_path}/", "") in text_of("trains")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("gravity: [-1, 0, 0]", "gravity: [0, 0, 0]"),
        ("gravity: [-1, 0, 0]", "gravity: [-1, 0]"),
        ("tip: [420 mm, 637 mm, 90 mm]", "tip: [420 mm, 637 mm]"),
        ("tip: [420 mm, 637 mm, 90 mm]", "tip: [420 mm, 637 deg, 90 mm]"),
        ("ratio: 152 ", "ratio: 0 "),
        ("wheel: {phase: 5 deg}", "wheel: {phse: 5 deg}"),
        ("upper_limit: 10 arcmin", "upper_limit: 10 um"),
        ("positions: 25 ", "take: min "),
    ],
)
def test_the_json_schema_refuses_wrong_trains(old: str, new: str) -> None:
    with pytest.raises(jsonschema.ValidationError):
        judged(changed((old, new)))
