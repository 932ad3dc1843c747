"""Whole trains against pairs that are run alone, and against the whole mechanism turned from end to end.

The pairs know nothing of shafts: their deviations are written out by hand for each mesh, with `oracles.train`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gear_trials import drawn_trials, gear_columns
from of_kind import of_kind
from oracles import brute_force, train
from oracles.involute_gear import InvoluteGear
from oracles.poses import pose
from oracles.train import OnShaft, at_height, lean, seen_backward, turned
from places import SCENES

from tol3d import load_scene
from tol3d.gearing.builds.build import build
from tol3d.gearing.engines import Engine
from tol3d.gearing.engines.gaps import exact_engine, fcl_engine
from tol3d.gearing.model import LostMotion, Model, Reading, model_from_scene
from tol3d.gearing.system import strips_of
from tol3d.gears.flank import Flank
from tol3d.study.system.trials import Trials

TRIALS = 200
ARCMIN = 10800 / np.pi  # in a radian
SAME_TURN = 1e-9  # rad; where the exact engine's steps end, 1e-8 mm, at 20 mm and twice
TILTED = 5e-8  # rad; a driver that leans is a driven gear that leans back, but for squares: (3e-4)^2 of 1 mm, at 20 mm


SEARCHED = 1e-6  # rad; the search ends within 6e-6 mm, at 12 mm and twice


def model_of(path: Path) -> Model:
    return model_from_scene(load_scene(path))


def changed(scene: str, folder: Path, *changes: tuple[str, str]) -> Model:
    """A scene of ours with some text replaced everywhere."""
    text = (SCENES / f"{scene}.yaml").read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = folder / f"{scene}.yaml"
    path.write_text(text, encoding="utf-8")
    return model_of(path)


def of(model: Model, block: Trials, name: str) -> np.ndarray:
    """Deviations (n, components) of a contributor [mm or rad]."""
    return block.deviations[:, model.component_slices[name]]


def engines() -> Mapping[str, Callable[[Model], Engine]]:
    return {"exact": exact_engine, "fcl": lambda model: fcl_engine(model, strips_of(model))}


# the robot ------------------------------------------------------------------------------------------------------

SPUR = {name: name for name in ("pinion tooth thickness", "wheel tooth thickness", "centre distance")}
SPUR |= {name: name for name in ("pinion eccentricity", "wheel eccentricity", "reducer run-out")}
SPUR |= {"bearing clearance": "wheel bearing clearance"}
BEVEL = {name: name for name in ("shaft angle", "axes offset", "driver back face", "driven back face")}
BEVEL |= {name: name for name in ("housing face", "end cover")}
BEVEL |= {
    f"{gear} {what}": f"bevel {gear} {what}"
    for gear in ("driver", "driven")
    for what in ("tooth thickness", "eccentricity", "bearing clearance")
}


def alone(
    model: Model,
    pair: Model,
    block: Trials,
    names: Mapping[str, str],
    angle: np.ndarray,
    make: Callable[[Model], Engine],
) -> np.ndarray:
    """Free turn (n,) [rad] of the driven gear of a pair by itself, its deviations those of the train's contributors."""
    pair = replace(pair, profile_steps=model.profile_steps)
    assert set(names) == {contributor.name for contributor in pair.contributors}
    deviations = np.zeros((len(block), pair.component_count))
    for own, other in names.items():
        deviations[:, pair.component_slices[own]] = of(model, block, other)
    found = gear_columns(pair, make(pair), Trials(deviations, {pair.meshes[0].name: angle}))
    assert set(found["status"]) == {"ok"}
    return found["geometric:lost motion"] / ARCMIN


@pytest.mark.parametrize(("engine", "trials"), [("exact", TRIALS), pytest.param("fcl", 20, marks=pytest.mark.slow)])
def test_the_robots_lost_motion_is_that_of_its_pairs_run_alone(engine: str, trials: int, tmp_path: Path) -> None:
    robot, make = model_of(SCENES / "robot_shoulder.yaml"), engines()[engine]
    block = drawn_trials(robot, 1, 0, trials)
    words = {1: "right", -1: "left"}
    flank = words[robot.mesh("spur pair").working_flank]
    one_tooth = ("gear: wheel\n", "gear: wheel\n    tooth: driven\n")  # as the robot reads it
    spur = changed("spur_pair", tmp_path, ("flank: right", f"flank: {flank}"), one_tooth)
    bevel = changed("bevel_pair", tmp_path, ("flank: left", f"flank: {words[robot.mesh('bevel pair').working_flank]}"))
    angle = block.positions["spur pair"]
    free_spur = alone(robot, spur, block, SPUR, angle, make)
    # the wheel stands at pi + pi/110 - 28/110 of the pinion's turn, the bevel driver looks back; what of the pinion's
    # turn its period of 55 turns leaves out are whole turns of both
    spline = np.pi + np.pi / 110 - angle * 28 / 110
    bevel_angle = block.positions["bevel pair"]
    assert np.abs(np.exp(1j * bevel_angle) - np.exp(-1j * spline)).max() < 1e-9
    free_bevel = alone(robot, bevel, block, BEVEL, bevel_angle, make)
    wanted = free_bevel + free_spur * 31 / 31 + np.radians(1 / 60) * (28 / 110) * 31 / 31
    found = gear_columns(robot, make(robot), block)
    assert np.abs(found["geometric:lost motion"] / ARCMIN - wanted).max() < SAME_TURN
    tip = 2 * np.hypot(420, 637) * np.sin(wanted / 2)
    assert np.abs(found["geometric:tip displacement"] - tip).max() < 763 * SAME_TURN


@pytest.mark.parametrize("position", [-60.0, 0.0, 30.0])
def test_a_swing_reads_the_train_where_its_output_stands(position: float, tmp_path: Path) -> None:
    """The arm stands at 0 with the motor; the flange turns against it, for the bevel driver looks back."""
    motor = np.radians(position) * -152 * 110 / 28
    over = f"{{at: {float(motor)!r} rad}}"
    there = f"measures:\n  there: {{kind: lost_motion, of: shoulder swing, tooth: driven, over: {over}}}"
    robot = changed("robot_shoulder_swing", tmp_path, ("\nmeasures:", f"\n{there}"))
    found = gear_columns(robot, exact_engine(robot), drawn_trials(robot, 1, 0, 20))
    swing = next(measure for measure in robot.measures if measure.take == "curve")
    at = round((position + 60) / 5)
    unsigned = replace(of_kind(LostMotion, swing.kind), turned=())
    way = 2 * 763 * np.sin(found["geometric:there"] / ARCMIN / 2)
    robot = replace(robot, measures=(replace(swing, kind=unsigned),))
    whole = gear_columns(robot, exact_engine(robot), drawn_trials(robot, 1, 0, 20))
    assert whole["geometric:tip error over the swing"][:, at] == pytest.approx(way, abs=763 * SAME_TURN)


# the table ------------------------------------------------------------------------------------------------------

PAIR = """
scene: a pair by itself
parts:
  driver:
    {{kind: spur_gear, teeth: {teeth[0]}, module: {module} mm, face_width: {widths[0]} mm, profile_shift: {shift}}}
  driven:
    {{kind: spur_gear, teeth: {teeth[1]}, module: {module} mm, face_width: {widths[1]} mm}}
tolerances:
  driver tooth thickness: {{kind: tooth_thickness, of: driver, distribution: {{kind: normal, mean: 0 um, sigma: 1 um}}}}
  driven tooth thickness: {{kind: tooth_thickness, of: driven, distribution: {{kind: normal, mean: 0 um, sigma: 1 um}}}}
  driver eccentricity: {{kind: eccentricity, of: driver, distribution: {{kind: rayleigh, scale: 1 um}}}}
  driven eccentricity: {{kind: eccentricity, of: driven, distribution: {{kind: rayleigh, scale: 1 um}}}}
  driver axis: {{kind: bearing_clearance, of: driver, direction: random, distribution: {{kind: rayleigh, scale: 1 um}}}}
  driven axis: {{kind: bearing_clearance, of: driven, direction: random, distribution: {{kind: rayleigh, scale: 1 um}}}}
  lean about x: {{kind: axis_out_of_plane, of: pair, distribution: {{kind: normal, mean: 0 mrad, sigma: 1 mrad}}}}
  lean about y: {{kind: axis_in_plane, of: pair, distribution: {{kind: normal, mean: 0 mrad, sigma: 1 mrad}}}}
moves:
  pair: {{kind: mesh, driver: driver, driven: driven, centre_distance: {apart} mm, working_flank: {flank}}}
measures:
  lost motion: {{kind: angular_backlash, of: pair}}
"""


@dataclass(frozen=True)
class Pair:
    """A mesh of three_stage_train.yaml by itself, as numbers: no shaft, no azimuth, no idler.

    Args:
        teeth, module, widths, shift, apart: of the pair.
        flank: sigma of the driver's working one.
        thickness: (n, 2) [mm].
        centres: (n, 2) [mm] of driver and driven, each in its gear's frame, x through tooth 0.
        axes: (n, 2) [mm] of driver and driven, by which each axis left its rest in the mesh's frame.
        leans: (n, 2) [rad] of driver and driven, x and y of the rotation vector there.
    """

    teeth: tuple[int, int]
    module: float
    widths: tuple[float, float]
    shift: float
    apart: float
    flank: Flank
    thickness: np.ndarray
    centres: tuple[np.ndarray, np.ndarray]
    axes: tuple[np.ndarray, np.ndarray]
    leans: tuple[np.ndarray, np.ndarray]

    def model(self, folder: Path) -> Model:
        path = folder / f"{self.teeth[0]}_{self.teeth[1]}.yaml"
        path.write_text(PAIR.format(**vars(self) | {"flank": {1: "right", -1: "left"}[self.flank]}), encoding="utf-8")
        return model_of(path)

    def block(self, model: Model, angle: np.ndarray) -> Trials:
        """Axes take half of a clearance; the driven gear leans by what is between the two."""
        values = {
            "driver tooth thickness": self.thickness[:, :1],
            "driven tooth thickness": self.thickness[:, 1:],
            "driver eccentricity": self.centres[0],
            "driven eccentricity": self.centres[1],
            "driver axis": 2 * self.axes[0],
            "driven axis": 2 * self.axes[1],
            "lean about x": (self.leans[1] - self.leans[0])[:, :1],
            "lean about y": (self.leans[1] - self.leans[0])[:, 1:],
        }
        deviations = np.zeros((len(angle), model.component_count))
        for name, columns in values.items():
            deviations[:, model.component_slices[name]] = columns
        return Trials(deviations, {"pair": angle})

    def searched(self, row: int) -> brute_force.Mesh:
        """One of them for a search of the surfaces."""
        each = zip(self.teeth, self.widths, (self.shift, 0.0), self.thickness[row], strict=True)
        pinion, wheel = (
            InvoluteGear(z, self.module, np.radians(20), b, profile_shift=x, thickness_deviation=s)
            for z, b, x, s in each
        )
        first, second = (
            pose([*leans[row], 0.0], [along + axes[row, 0], axes[row, 1], 0.0])[None]
            for leans, axes, along in zip(self.leans, self.axes, (0.0, self.apart), strict=True)
        )
        centres = [centre[row, None] for centre in self.centres]
        return brute_force.Mesh(pinion, wheel, first, second, centres[0], centres[1])


def table_pairs(model: Model, block: Trials) -> dict[str, Pair]:
    """The three pairs of the table, its shafts' and the idler's deviations turned into each pair's frame by hand."""

    def thickness(*gears: str) -> np.ndarray:
        return np.concatenate([of(model, block, f"{gear} tooth thickness") for gear in gears], axis=1)

    def along_x(name: str) -> np.ndarray:
        return of(model, block, name) * [1.0, 0.0]

    still = np.zeros((len(block), 2))
    flanks = {mesh.name: mesh.working_flank for mesh in model.meshes}
    idler_axis = along_x("idler bearing clearance") / 2  # away from the pinion, which it sees at -x
    idler_centre = of(model, block, "idler eccentricity")
    # bearings at -20 and 20 mm: the lower one moves away from the idler, +x of the shaft, the upper one to 200 deg
    lower = along_x("lower bearing clearance") / 2
    upper = turned(along_x("upper bearing clearance") / 2, 200)
    heights, run_out = (-20.0, 20.0), of(model, block, "table shaft run-out")
    leaning = lean(lower, upper, heights)
    return {
        "first mesh": Pair(
            (20, 31), 1.0, (9, 8), 0.25, 25.75, flanks["first mesh"],
            thickness("pinion", "idler"),
            (of(model, block, "pinion eccentricity"), idler_centre),
            (still, along_x("first centre distance") + idler_axis),
            (still, still),
        ),
        "second mesh": Pair(
            (31, 60), 1.0, (8, 8), 0.0, 45.5, flanks["second mesh"],
            thickness("idler", "table gear"),
            (idler_centre, of(model, block, "table gear eccentricity") + turned(run_out, -7)),
            (turned(idler_axis, -60), along_x("second centre distance") + at_height(lower, upper, heights, 0.0)),
            (still, leaning),
        ),
        "third mesh": Pair(
            (48, 32), 0.8, (5, 5), 0.0, 32.0, flanks["third mesh"],
            thickness("encoder driver", "encoder gear"),
            (of(model, block, "encoder driver eccentricity") + turned(seen_backward(run_out), -11), still),
            (
                turned(seen_backward(at_height(lower, upper, heights, 40.0)), 75),
                along_x("third centre distance"),
            ),
            (turned(seen_backward(leaning), 75), still),
        ),
    }  # fmt: skip


def table_stages(block: Trials, model: Model, seat_of: Callable[[str], train.Seat]) -> list[train.Mesh | train.Reducer]:
    """The table as its drawing has it; the motor goes clockwise and its gearbox turns that round."""
    flanks = {mesh.name: mesh.working_flank for mesh in model.meshes}
    return [
        train.Reducer(-5.2, of(model, block, "gearbox play")[:, 0], drives=1),
        train.Mesh(seat_of("first mesh"), flanks["first mesh"]),
        train.Mesh(
            seat_of("second mesh"), flanks["second mesh"], driven=OnShaft(1, np.radians(7)), azimuth=np.radians(60)
        ),
        train.Mesh(
            seat_of("third mesh"), flanks["third mesh"], driver=OnShaft(-1, np.radians(11)), azimuth=np.radians(-75)
        ),
    ]


RATIOS = {"gearbox": -5.2, "first mesh": -31 / 20, "second mesh": -60 / 31, "third mesh": 32 / 48}
AT_ENCODER = {"gearbox": 20 / 60 * 48 / 32, "first mesh": 31 / 60 * 48 / 32, "second mesh": 48 / 32, "third mesh": 1.0}
"""Turn of the encoder for a turn of what each link drives."""


@cache
def table() -> tuple[Model, Trials]:
    model = model_of(SCENES / "three_stage_train.yaml")
    return model, drawn_trials(model, 5, 0, TRIALS)


@pytest.mark.parametrize(("engine", "trials"), [("exact", TRIALS), pytest.param("fcl", 20, marks=pytest.mark.slow)])
def test_the_tables_lost_motion_is_that_of_its_pairs_run_alone(engine: str, trials: int, tmp_path: Path) -> None:
    (model, drawn), make = table(), engines()[engine]
    block, free = drawn.part(0, trials), {"gearbox": of(model, drawn, "gearbox play")[:trials, 0]}
    for name, pair in table_pairs(model, block).items():
        single = pair.model(tmp_path)
        found = gear_columns(single, make(single), pair.block(single, block.positions[name]))
        assert set(found["status"]) == {"ok"}
        free[name] = found["geometric:lost motion"] / ARCMIN
    found = gear_columns(model, make(model), block)
    allowed = TILTED if engine == "exact" else 0.05e-3 / 12  # FCL: its own 0.05 um, at the encoder's 12 mm
    wanted = sum(AT_ENCODER[name] * own for name, own in free.items())
    assert np.abs(found["geometric:lost motion"] / ARCMIN - wanted).max() < allowed
    idler = free["gearbox"] * 20 / 31 + free["first mesh"]
    assert np.abs(found["geometric:lost motion of the idler"] / ARCMIN - idler).max() < allowed


@pytest.mark.slow
def test_the_tables_pairs_are_those_of_a_search_of_the_surfaces() -> None:
    (model, drawn), trials = table(), 4
    block = drawn.part(0, trials)
    found = gear_columns(model, exact_engine(model), block)
    for name, pair in table_pairs(model, block).items():
        seen = found[f"geometric:lost motion:{name} [arcmin]"] / ARCMIN
        for row in range(trials):
            angle = block.positions[name][row, None]
            (free,) = brute_force.free_turn(pair.searched(row), angle, pair.flank, turn_driver=False)
            assert abs(seen[row] - free) < SEARCHED


# the whole mechanism --------------------------------------------------------------------------------------------


def seats_of_engine(model: Model, block: Trials) -> Callable[[str], train.Seat]:
    """Meshes of the model brought to rest by the exact engine, at driver angles that are told."""
    engine, made = exact_engine(model), build(model, block.deviations)

    def seat_of(name: str) -> train.Seat:
        mesh = model.mesh(name)
        section = mesh.pair.arm_spread > 0
        reading = Reading("section", "section", "driven") if section else Reading()

        def seat(angle: np.ndarray, flank: Flank) -> np.ndarray:
            return engine.read(made, replace(mesh, working_flank=flank), reading, angle).driven_angle

        return seat

    return seat_of


def robot_stages(block: Trials, model: Model, seat_of: Callable[[str], train.Seat]) -> list[train.Mesh | train.Reducer]:
    """The shoulder: what gravity asks of the motor is worked out in test_train_layout.py."""
    flanks = {mesh.name: mesh.working_flank for mesh in model.meshes}
    # a driver that turns counter-clockwise pushes with its left flank, -1
    drives = -flanks["spur pair"]
    return [
        train.Reducer(152, np.full(len(block), np.radians(1 / 60)), drives),
        train.Mesh(seat_of("spur pair"), flanks["spur pair"]),
        train.Mesh(seat_of("bevel pair"), flanks["bevel pair"], driver=OnShaft(-1)),
    ]


def robot_uneven(block: Trials, model: Model) -> dict[str, tuple[np.ndarray, np.ndarray, float]]:
    """By mesh: eccentricities (n,) [mm] of driver and driven gear, and the arm [mm] of the driven one."""

    def length(*names: str) -> np.ndarray:
        return np.hypot(*np.sum([of(model, block, name) for name in names], axis=0).T)

    # the middle of the bevel teeth: 31 teeth of 3.5 mm at 45 deg are 108.5 mm wide, 9 mm of face reach 6.36 mm inwards
    return {
        "spur pair": (
            length("pinion eccentricity", "reducer run-out"),
            length("wheel eccentricity"),
            137.5 * np.cos(np.radians(20)),
        ),
        "bevel pair": (
            length("bevel driver eccentricity"),
            length("bevel driven eccentricity"),
            (108.5 - 9 * np.sqrt(0.5)) / 2 * np.cos(np.radians(20)),
        ),
    }


def table_uneven(block: Trials, model: Model) -> dict[str, tuple[np.ndarray, np.ndarray, float]]:
    """The same of the table."""
    return {
        name: (
            np.hypot(*pair.centres[0].T),
            np.hypot(*pair.centres[1].T),
            pair.teeth[1] * pair.module / 2 * np.cos(np.radians(20)),
        )
        for name, pair in table_pairs(model, block).items()
    }


NOMINAL = {
    "spur pair": (28, 110, np.pi),
    "bevel pair": (31, 31, 0.0),
    "first mesh": (20, 31, np.pi),
    "second mesh": (31, 60, np.pi),
    "third mesh": (48, 32, np.pi),
}
"""Teeth of both gears, and azimuth of the mesh in the driven one's frame: there a space of it stands."""


def nominal_seat(name: str) -> train.Seat:
    """Gears without backlash, as teeth alone turn them."""
    driver, driven, towards = NOMINAL[name]
    return lambda angle, flank: towards + np.pi / driven - angle * driver / driven


@pytest.mark.parametrize(
    ("scene", "stages_of", "uneven", "behind", "most"),
    [
        ("robot_shoulder", robot_stages, robot_uneven, {"planetary reducer": 28 / 110, "spur pair": 1.0}, 1e-7),
        ("three_stage_train", table_stages, table_uneven, AT_ENCODER, 1e-5),
    ],
)
def test_the_whole_mechanism_turns_as_far_as_its_stages_add_up_to(
    scene: str, stages_of: Callable[..., Any], uneven: Callable[..., Any], behind: Mapping[str, float], most: float
) -> None:
    """The sum supposes that each driver stands where nominal gears put it.

    In truth it stands off by some angle on either side, and over that a mesh does not turn evenly: an eccentricity e
    makes the driven gear go faster or slower by e/r_b of the driver's turn, r_b the driven gear's, and its own does by
    that times the ratio.
    """
    model = model_of(SCENES / f"{scene}.yaml")
    drawn = drawn_trials(model, 5, 0, TRIALS)
    held = np.random.default_rng(3).uniform(0.0, 2000 * np.pi, TRIALS)  # a thousand turns of the motor
    nominal = stages_of(drawn, model, nominal_seat)
    nominal[0] = replace(nominal[0], play=np.zeros(TRIALS))
    shafts = [held, *train.rests(nominal, held, 1)]
    meshes = [mesh.name for mesh in model.meshes]
    angles = {
        name: stage.driver_angle(shaft) for name, stage, shaft in zip(meshes, nominal[1:], shafts[1:-1], strict=True)
    }
    block = Trials(drawn.deviations, angles)
    found = gear_columns(model, exact_engine(model), block)["geometric:lost motion"] / ARCMIN

    stages = stages_of(block, model, seats_of_engine(model, block))
    ends = [train.rests(stages, held, side) for side in (1, -1)]
    whole = np.abs(ends[0][-1] - ends[1][-1])
    allowed = np.zeros(TRIALS)
    for k, name in enumerate(meshes):
        driver, driven, arm = uneven(block, model)[name]
        off = sum(np.abs(end[k] - shafts[k + 1]) for end in ends)
        teeth = NOMINAL[name]
        allowed += behind.get(name, 1.0) * off * (driver + driven * teeth[0] / teeth[1]) / arm
    error = np.abs(whole - found)
    assert (error < 1.05 * allowed + SAME_TURN).all()  # squares: backlash 0.1 mm, radii 12 mm
    assert error.max() < most
    assert error.max() > most / 100  # the sum and the whole are two ways


# seven of them --------------------------------------------------------------------------------------------------


def joint(k: int) -> tuple[str, str, str, str]:
    """Parts, tolerances, moves and measures of one of a robot's trains; each has gears of its own."""
    teeth, lever = (17 + k, 30 + 2 * k), 100 + 20 * k
    ratio = 50 + k
    name = f"joint {k}"
    drawn = "distribution: {kind: normal, lower: -40 um, upper: -20 um}"
    offset = "distribution: {kind: rayleigh, scale: 3 um}"
    return (
        f"  motor {k}: {{kind: shaft}}\n"
        f"  pinion {k}: {{kind: spur_gear, teeth: {teeth[0]}, module: 1 mm, face_width: 5 mm}}\n"
        f"  wheel {k}: {{kind: spur_gear, teeth: {teeth[1]}, module: 1 mm, face_width: 5 mm}}\n"
        f"  arm {k}: {{kind: arm, shaft: wheel {k}, points: {{tip: [{lever} mm, 0 mm, 0 mm]}}}}\n",
        f"  pinion {k} thickness: {{kind: tooth_thickness, of: pinion {k}, {drawn}}}\n"
        f"  wheel {k} eccentricity: {{kind: eccentricity, of: wheel {k}, {offset}}}\n",
        f"  reducer {k}:\n"
        f"    {{kind: reducer, driver: motor {k}, driven: pinion {k}, ratio: {ratio}, backlash: {k} arcmin}}\n"
        f"  mesh {k}: {{kind: mesh, driver: pinion {k}, driven: wheel {k}, centre_distance: {sum(teeth) / 2 + 0.05} mm,"
        " working_flank: either}\n"
        f"  {name}: {{kind: train, driven: motor {k}, output: wheel {k}, gravity: [0, {(-1) ** k}, 0]}}\n",
        f"  lost motion {k}: {{kind: lost_motion, of: {name}}}\n"
        f"  tip {k}: {{kind: tip_displacement, of: {name}, arm: arm {k}, point: tip}}\n",
    )


def robot_of(folder: Path, joints: range) -> Model:
    sections = zip(*(joint(k) for k in joints), strict=True)
    heads = ("parts", "tolerances", "moves", "measures")
    text = "scene: joints\n" + "".join(f"{head}:\n{''.join(own)}" for head, own in zip(heads, sections, strict=True))
    path = folder / "joints.yaml"
    path.write_text(text, encoding="utf-8")
    return model_of(path)


def test_seven_trains_in_a_scene_are_what_each_is_alone(tmp_path: Path) -> None:
    trials, robot = 50, robot_of(tmp_path, range(1, 8))
    together = gear_columns(robot, exact_engine(robot), drawn_trials(robot, 1, 0, trials))
    assert set(together["status"]) == {"ok"}
    for k in range(1, 8):
        alone = robot_of(tmp_path, range(k, k + 1))
        found = gear_columns(alone, exact_engine(alone), drawn_trials(alone, 1, 0, trials))
        # gravity up or down turns an arm that lies to the right, and the pinion holds it from the other side
        assert alone.meshes[0].working_flank == robot.mesh(f"mesh {k}").working_flank == (-1) ** (k + 1)
        for name in (f"geometric:lost motion {k}", f"geometric:tip {k}", f"analytic:lost motion {k}"):
            assert np.array_equal(found[name], together[name]), name
        play = found[f"geometric:lost motion {k}:mesh {k} [arcmin]"]
        turn = found[f"geometric:lost motion {k}"]
        assert np.abs(turn - play - k * (17 + k) / (30 + 2 * k)).max() < 1e-9
        assert found[f"geometric:tip {k}"] == pytest.approx((100 + 20 * k) * 2 * np.sin(turn / ARCMIN / 2), abs=1e-12)
