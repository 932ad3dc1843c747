"""Refused loops: one line with its place, what was expected and what came; and the words of trials instead."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import assembled
from fixtures import Command
from linkage.drive_scene import drive_text, error
from linkage.linked_bodies import Part, axis, point
from linkage.mechanisms import placed, slider_crank

from tol3d.assembly.model.statuses import NO_BUILD, OK
from tol3d.study.system.stated import component_count, component_slices, stated

FRAME = """
  frame:
    kind: solid
    features:
      zero: {kind: point, at: [0 mm, 0 mm, 0 mm]}
      A: {kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 20 mm}
      D: {kind: axis, at: [100 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 20 mm}
      E: {kind: point, at: [100 mm, 0 mm, 0 mm]}"""
PARTS = f"""{FRAME}
  crank:
    kind: solid
    features:
      A: {{kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 20 mm}}
      B: {{kind: axis, at: [0 mm, 30 mm, 0 mm], axis: [0, 0, 1], length: 20 mm}}
      P: {{kind: point, at: [0 mm, 30 mm, 0 mm]}}
  rod:
    kind: solid
    placed: {{at: [0 mm, 30 mm, 0 mm]}}
    features:
      B: {{kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 20 mm}}
      P: {{kind: point, at: [0 mm, 0 mm, 0 mm]}}
      C: {{kind: axis, at: [100 mm, 30 mm, 0 mm], axis: [0, 0, 1], length: 20 mm}}
      Q: {{kind: point, at: [100 mm, 30 mm, 0 mm]}}
      side: {{kind: point, at: [50 mm, 0 mm, 10 mm]}}
  rocker:
    kind: solid
    placed: {{at: [100 mm, 0 mm, 0 mm]}}
    features:
      C: {{kind: axis, at: [0 mm, 60 mm, 0 mm], axis: [0, 0, 1], length: 20 mm}}
      Q: {{kind: point, at: [0 mm, 60 mm, 0 mm]}}
      D: {{kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 20 mm}}
      tip: {{kind: point, at: [5 mm, 60 mm, 3 mm]}}"""
JOINTS = {
    "a": "{kind: revolute, between: [frame.A, crank.A]}",
    "b": "{kind: ball, between: [crank.P, rod.P]}",
    "c": "{kind: cylindrical, between: [rod.C, rocker.C]}",
    "d": "{kind: revolute, between: [frame.D, rocker.D]}",
}
IDLE = {"c": "{kind: ball, between: [rod.Q, rocker.Q]}"}
INPUTS = "{angle: {of: a}}"
POSES = "{here: {angle: 0 deg}, on: {angle: 20 deg}}"
MEASURE = "{kind: gap, from: frame.zero, to: rocker.tip, along: [1, 0, 0], at: here}"


def scene(
    joints: dict[str, str] | None = None,
    *,
    inputs: str = INPUTS,
    poses: str = POSES,
    measure: str = MEASURE,
    bodies: str = "[crank, rod, rocker]",
    before: str = "",
    after: str = "",
    parts: str = PARTS,
    more: str = "",
) -> str:
    """A four-bar; joints replace those of their names, None takes one out."""
    own = {name: text for name, text in (JOINTS | (joints or {})).items() if text}
    lines = "".join(f"\n      {name}: {text}" for name, text in own.items())
    return f"""
scene: four-bar
parts:{parts}
moves:
  base: {{kind: fix, part: frame}}{before}
  loop:
    kind: close_loop
    bodies: {bodies}
    joints:{lines}
    inputs: {inputs}
    poses: {poses}{more}{after}
measures:
  x: {measure}
study: {{trials: 10}}
"""


FIX_ROD = "\n  held: {kind: fix, part: rod}"
LAID = """
  laid:
    kind: six_plane
    part: rod
    pairs: []"""

WRONG = {
    "cannot close": (
        scene(parts=PARTS.replace("C: {kind: axis, at: [100 mm, 30 mm", "C: {kind: axis, at: [300 mm, 30 mm")),
        "moves.loop.joints.",
        # 301.50 mm of rod where crank and rocker reach over 104.40 + 60 mm
        "got a gap of 137.1 mm at 'b' at the least, 200 mm as they are `placed`",
    ),
    "four revolutes": (
        scene(
            {"b": "{kind: revolute, between: [crank.B, rod.B]}", "c": "{kind: revolute, between: [rod.C, rocker.C]}"}
        ),
        "moves.loop.joints",
        "3 freedoms held twice in the loop of a, b, c, d",
    ),
    "three revolutes and a ball": (
        scene({"c": "{kind: revolute, between: [rod.C, rocker.C]}"}),
        "moves.loop.joints",
        "1 freedom held twice in the loop of a, d, c, b",
    ),
    "no input": (
        scene(inputs="{}", poses="{here: {}}"),
        "moves.loop",
        "got a freedom: 'rocker' turns about [0, 0, 1] through [100, 0, 0] mm",
    ),
    "a joint that is missing": (scene({"d": ""}), "moves.loop", "got a freedom: "),
    "a body that no joint reaches": (
        scene({"c": "", "b": "{kind: ball, between: [frame.E, crank.P]}"}),
        "moves.loop.joints",
        "a joint that holds 'rod'",
    ),
    "two bodies that hang on each other alone": (
        scene({"b": "", "d": ""}),
        "moves.loop",
        "expected a joint that holds 'rod'",
    ),
    "an idle freedom that is read": (
        scene(
            {"c": "{kind: ball, between: [rod.Q, rocker.Q]}"},
            measure="{kind: gap, from: frame.zero, to: rod.side, along: [1, 0, 0], at: here}",
        ),
        "measures.x.to",
        "got 'rod.side', which it leaves free: 'rod' turns about",
    ),
    "the turn of an idle point": (
        scene(IDLE, measure="{kind: orientation_error, of: rod.P, from: frame, at: here}"),
        "measures.x.of",
        "expected a part whose turn the loop holds, got 'rod', which it leaves free: 'rod' turns about",
    ),
    "what an idle part sees": (
        scene(IDLE, measure="{kind: position_error, of: rocker.tip, from: rod, at: here}"),
        "measures.x.from",
        "got 'rod', which it leaves free: 'rod' turns about",
    ),
    "a direction in an idle part": (
        scene(IDLE, measure="{kind: gap, from: rod.P, to: frame.zero, along: [0, 1, 0], at: here}"),
        "measures.x.from",
        "got 'rod', which it leaves free: 'rod' turns about",
    ),
    "a weld to an idle part": (
        scene(
            IDLE,
            parts=PARTS + "\n  flag: {kind: solid, features: {P: {kind: point, at: [50 mm, 0 mm, 9 mm]}}}",
            before="\n  flag stays: {kind: fix, part: flag}",
            after="\n  join: {kind: weld, part: flag, to: [rod]}",
        ),
        "moves.join.to[0]",
        "got 'rod', which it leaves free: 'rod' turns about",
    ),
    "an input that it does not reach": (
        scene(
            inputs="{angle: {of: d}}",
            poses="{here: {angle: 0 deg}, on: {angle: 170 deg}}",
            measure=MEASURE.replace("here", "on"),
        ),
        "moves.loop.poses.on",
        "expected a pose that the loop reaches, got 'on'; it gets as far as angle ",
    ),
    "a path that leaves": (
        scene(
            inputs="{angle: {of: d}}",
            poses="{here: {angle: 0 deg}, on: {angle: 170 deg}, way: {path: [here, on], steps: 10}}",
            measure=MEASURE.replace("at: here", "over: way, take: max"),
        ),
        "moves.loop.poses.on",
        "got 'on'; it gets as far as angle ",
    ),
    "two joints on one pair": (
        scene({"e": "{kind: cylindrical, between: [crank.A, frame.A]}"}),
        "moves.loop.joints.e.between",
        "features that no other joint is between, for 'a' is",
    ),
    "a body that is placed already": (scene(before=FIX_ROD), "moves.loop.bodies", "'rod'"),
    "a body that moves again": (scene(after=FIX_ROD), "moves.held.part", "'rod'"),
    "a clearance below 0": (
        scene({"b": "{kind: ball, between: [crank.P, rod.P], clearance: {diameter: -5 um, float: {kind: random}}}"}),
        "moves.loop.joints.b.clearance.diameter",
        "expected a clearance of 0 or more, got -5 um",
    ),
    "a clearance without a float": (
        scene({"b": "{kind: ball, between: [crank.P, rod.P], clearance: {diameter: 5 um}}"}),
        "moves.loop.joints.b.clearance",
        "float",
    ),
    "a play that floats toward": (
        scene(
            {
                "c": "{kind: cylindrical, between: [rod.C, rocker.C], play: {diameter: 5 um, length: 9 mm, "
                "float: {kind: toward, along: [1, 0, 0]}}}"
            }
        ),
        "moves.loop.joints.c.play.float",
        "toward",
    ),
    "a pose that is not known": (scene(measure=MEASURE.replace("here", "hre")), "measures.x.at", "here"),
    "a path that is not known": (
        scene(measure=MEASURE.replace("at: here", "over: wy, take: max")),
        "measures.x.over",
        "wy",
    ),
    "a pose that is a path": (
        scene(
            poses="{here: {angle: 0 deg}, on: {angle: 9 deg}, way: {path: [here, on], steps: 3}}",
            measure=MEASURE.replace("here", "way"),
        ),
        "measures.x.at",
        "way",
    ),
    "a path through what is not known": (
        scene(poses="{here: {angle: 0 deg}, on: {angle: 9 deg}, way: {path: [here, onn], steps: 3}}"),
        "moves.loop.poses.way.path",
        "poses of here, on (did you mean 'on'?), got 'onn'|'onn'",
    ),
    "a path without steps enough": (
        scene(poses="{here: {angle: 0 deg}, on: {angle: 9 deg}, way: {path: [here, on, here], steps: 1}}"),
        "moves.loop.poses.way.steps",
        "2 or more",
    ),
    "an input of no joint": (scene(inputs="{angle: {of: aa}}"), "moves.loop.inputs.angle.of", "'aa'"),
    "an input of a ball": (
        scene(inputs="{angle: {of: b}}"),
        "moves.loop.inputs.angle.of",
        "expected a joint with an axis, or a swing, got 'b', a ball one",
    ),
    "an input of a cylinder without its motion": (
        scene(inputs="{angle: {of: c}}"),
        "moves.loop.inputs.angle.coordinate",
        "expected turn or slide, of a cylindrical joint, got none",
    ),
    "two inputs of one freedom": (
        scene(inputs="{angle: {of: a}, twice: {of: a}}", poses="{}", measure=MEASURE.replace(", at: here", "")),
        "moves.loop.inputs.twice.of",
        "a freedom that 'angle' does not give",
    ),
    "an input that is a length": (
        scene(poses="{here: {angle: 3 mm}}"),
        "moves.loop.poses.here.angle",
        "expected an angle with its unit, such as \"20 deg\", got '3 mm', which is a length",
    ),
    "a pose without an input": (scene(poses="{here: {}}"), "moves.loop.poses.here", "'angle'"),
    "a pose of what is no input": (scene(poses="{here: {angel: 0 deg}}"), "moves.loop.poses.here.angel", "angle"),
    "lengths for angles": (
        scene(inputs="{angle: {of: a, deviations: {off: {distribution: {kind: normal, mean: 0 mm, sigma: 1 um}}}}}"),
        "moves.loop.inputs.angle.deviations.off.distribution",
        "expected angles, as the input is, got lengths",
    ),
    "a joint of one part": (
        scene({"e": "{kind: ball, between: [rod.P, rod.Q]}"}),
        "moves.loop.joints.e.between",
        "expected features of two parts, got two of 'rod'",
    ),
    "a joint of fixed parts": (
        scene(
            {"e": "{kind: ball, between: [frame.E, other.P]}"},
            parts=PARTS + "\n  other: {kind: solid, features: {P: {kind: point, at: [100 mm, 0 mm, 0 mm]}}}",
            before="\n  other: {kind: fix, part: other}",
        ),
        "moves.loop.joints.e.between",
        "expected a feature of one of the bodies",
    ),
    "a part that is placed nowhere": (
        scene(
            {"d": "{kind: ball, between: [other.P, rocker.Q]}"},
            parts=PARTS + "\n  other: {kind: solid, features: {P: {kind: point, at: [100 mm, 60 mm, 0 mm]}}}",
        ),
        "parts.other",
        "expected a move that places 'other'",
    ),
    "a ball of an axis for a cylinder": (
        scene({"c": "{kind: cylindrical, between: [rod.Q, rocker.C]}"}),
        "moves.loop.joints.c.between",
        "axis",
    ),
    "a universal joint that is not square": (
        scene({"c": "{kind: universal, between: [rod.C, rocker.C]}"}),
        "moves.loop.joints.c",
        "expected axes at right angles where both parts are `placed`, got 0 deg",
    ),
    "a screw without a lead": (
        scene({"a": "{kind: screw, between: [frame.A, crank.A], lead: 0 mm}"}),
        "moves.loop.joints.a.lead",
        "expected a length other than 0, got 0 mm",
    ),
    "the same body twice": (scene(bodies="[crank, rod, rod, rocker]"), "moves.loop.bodies", "'rod' twice"),
    "an unknown body": (
        scene(bodies="[crank, rod, rokcer]"),
        "moves.loop.joints.d.between",
        "expected a feature of one of the bodies crank, rod, rokcer, got frame.D and rocker.D",
    ),
    "an unknown feature": (
        scene({"d": "{kind: revolute, between: [frame.DD, rocker.D]}"}),
        "moves.loop.joints.d.between[0]",
        "D",
    ),
    "a tilt without an output": (
        scene(poses="{here: {tilt: 0 deg, azimuth: 0 deg}}"),
        "moves.loop.poses.here",
        "got a tilt",
    ),
    "a take without a path": (scene(measure=MEASURE.replace("at: here", "take: max")), "measures.x.take", "over"),
}


def assert_refused(answer: tuple[int, str, str], path: Path, place: str, words: str) -> None:
    code, out, err = answer
    lines = [line for line in err.splitlines() if line]
    assert code == 2, out + err
    assert len(lines) == 1, err
    assert "Traceback" not in err
    assert f": {place}" in lines[0], lines[0]
    assert any(each in lines[0] for each in words.split("|")), lines[0]
    assert path.name in lines[0]


@pytest.mark.parametrize("name", WRONG)
def test_check_refuses_in_one_line(name: str, tmp_path: Path, tol3d: Command) -> None:
    text, place, words = WRONG[name]
    path = tmp_path / "wrong.yaml"
    path.write_text(text, "utf-8")
    assert_refused(tol3d("check", str(path)), path, place, words)


@pytest.mark.parametrize(
    "measure",
    [
        MEASURE,
        "{kind: gap, from: frame.zero, to: rod.P, along: [0, 1, 0], at: here}",
        "{kind: gap, from: rod.P, to: frame.zero, along: [100, 30, 0], at: here}",
        "{kind: distance, from: rod.P, to: frame.zero, at: here}",
    ],
    ids=["elsewhere", "a point on its axis", "along its axis", "a distance"],
)
def test_an_idle_freedom_that_nothing_reads_is_allowed_and_named(measure: str, tmp_path: Path, tol3d: Command) -> None:
    path = tmp_path / "idle.yaml"
    path.write_text(scene(IDLE, measure=measure), "utf-8")
    code, out, err = tol3d("check", str(path))
    assert code == 0, err
    assert "1 idle" in out
    assert "'rod' turns about" in out


DRIVE = {
    "beyond the singular curve": (
        drive_text(error("error", "at: far")).replace("tilt: 70 deg, azimuth: 45 deg", "tilt: 80 deg, azimuth: 51 deg"),
        "moves.drive.poses.far",
        "it gets as far as travel 1 ",
    ),
    "a sweep beyond": (
        drive_text(error("error", "over: sweep, take: max")).replace(
            "tilt: 70 deg, azimuth: 45 deg", "tilt: 80 deg, azimuth: 51 deg"
        ),
        "moves.drive.poses.far",
        "tilt 76.16",
    ),
    "a component without an axis": (
        drive_text(error("error", "at: far, component: along")),
        "measures.error.against",
        "the axis from which it tilts",
    ),
    "angles without a lead": (
        drive_text(error("error", "at: far")).replace("        lead: 5 mm\n", ""),
        "moves.drive.inputs.travel 1.deviations.backlash.distribution",
        "`lead`",
    ),
    "a gear that another joint holds": (
        drive_text(error("error", "at: far")).replace("rod 1.top, ring.ball 1", "rod 1.top, gear 2.axis"),
        "moves.drive",
        "",
    ),
    "the spin of a rod": (
        drive_text("  gap: {kind: direction_error, of: rod 1.side, at: far}\n").replace(
            "features: {bottom:",
            "features: {side: {kind: axis, at: [9 mm, 0 mm, 9 mm], axis: [1, 0, 0], length: 9 mm}, bottom:",
        ),
        "measures.gap.of",
        "'rod 1' turns about [0, 0, 1]",
    ),
}


@pytest.mark.parametrize("name", DRIVE)
def test_check_refuses_of_the_drive(name: str, tmp_path: Path, tol3d: Command) -> None:
    text, place, words = DRIVE[name]
    path = tmp_path / "wrong.yaml"
    path.write_text(text, "utf-8")
    assert_refused(tol3d("check", str(path)), path, place, words)


def test_a_clearance_that_is_drawn_below_0_is_no_build(tmp_path: Path) -> None:
    """That trial alone; the others keep their values."""
    clearance = (
        "clearance: {diameter: 5 um, distribution: {kind: normal, mean: 0 um, sigma: 3 um}, float: {kind: random}}"
    )
    made = assembled(scene({"b": f"{{kind: ball, between: [crank.P, rod.P], {clearance}}}"}), tmp_path)
    rows = np.zeros((4, component_count(made.system)))
    rows[:, component_slices(made.system)["clearance of b"]] = np.array([[0.0], [-0.004], [-0.0051], [0.004]])
    answers = made.system.method("exact", made.system.materials("exact")).answers(
        stated(made.system, rows), made.system.measures
    )
    assert answers.status["x"].tolist() == [OK, OK, NO_BUILD, OK]
    assert np.isnan(answers.values["x"][:, 0]).tolist() == [False, False, True, False]


@pytest.mark.parametrize("lean", [0.0, 1e-8, 1e-6])
def test_parts_placed_at_dead_centre_are_told_apart_from_redundant_joints(
    lean: float, tmp_path: Path, tol3d: Command
) -> None:
    """A slider that drives its crank through the dead centre: singular there or nearly so, sound elsewhere."""
    pin, angles = 30.0 * np.array([np.cos(lean), np.sin(lean), 0.0]), {"s": ("slide", "slide")}
    own = replace(slider_crank(), inputs=angles, poses={"here": {"s": 0.0}})
    end = np.array([pin[0] + np.sqrt(100.0**2 - pin[1] ** 2), 0.0, 0.0])
    along = end - pin
    parts = dict(own.parts)
    parts["crank"] = Part(placed(), {**parts["crank"].features, "pin": point(pin)})
    parts["rod"] = Part(
        placed(pin),
        {"big": point((0, 0, 0)), "small": axis(along, np.cross(along, [0, 0, 1.0])), "probe": point(along / 2)},
    )
    parts["slider"] = Part(placed(end), parts["slider"].features)
    parts["frame"] = Part(placed(), {**parts["frame"].features, "guide": axis((100.0, 0, 0), (1, 0, 0), 60.0)})
    path = tmp_path / "dead.yaml"
    path.write_text(replace(own, parts=parts).text([]), "utf-8")
    assert_refused(tol3d("check", str(path)), path, "moves.drive", "in a pose that is not singular")
