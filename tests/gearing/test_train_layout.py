"""Layout of the shafts of trains, their turns, and the flanks that work: each worked out by hand.

Gears of module 2 mm, so that z teeth roll on a circle of radius z mm.
"""

import itertools
import math
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from gear_trials import drawn_trials
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from scipy.stats import kstest

from tol3d import load_scene
from tol3d.gearing.builds.build import build
from tol3d.gearing.model import Model, model_from_scene
from tol3d.gearing.shafts import Carried
from tol3d.study.system.stated import nominal_build

LEFT, RIGHT = -1, 1
SAME_PLACE = 1e-9  # mm; some hundred times the rounding of a metre
EAST, NORTH, UP = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
WEST, SOUTH, DOWN = (-1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)


def gear(teeth: int, kind: str = "spur_gear") -> str:
    return f"{{kind: {kind}, teeth: {teeth}, module: 2 mm, face_width: 6 mm}}"


def model_of(folder: Path, parts: Mapping[str, str], moves: Mapping[str, str], tolerances: str = "") -> Model:
    """A scene of these parts and moves; its measure is of the first mesh."""
    mesh = next(name for name, move in moves.items() if "mesh," in move)
    first = next(name for name, part in parts.items() if "_gear" in part)
    path = folder / "scene.yaml"
    path.write_text(
        "scene: a train\nparts:\n"
        + "".join(f"  {name}: {part}\n" for name, part in parts.items())
        + "tolerances:\n"
        + f"  thickness: {{kind: tooth_thickness, of: {first}, distribution: {{kind: constant, value: -40 um}}}}\n"
        + tolerances
        + "moves:\n"
        + "".join(f"  {name}: {move}\n" for name, move in moves.items())
        + f"measures:\n  backlash: {{kind: normal_backlash, of: {mesh}}}\n",
        encoding="utf-8",
    )
    return model_from_scene(load_scene(path))


# trains and where their shafts lie ------------------------------------------------------------------------------

TRAINS: dict[str, tuple[dict[str, str], dict[str, str]]] = {
    "chain": (
        {
            "a": gear(20),
            "b": gear(30),
            "c": gear(25),
            "d": gear(40),
            "middle": "{kind: shaft, carries: {b: {at: -5 mm, phase: 3 deg}, c: {at: 25 mm, phase: -20 deg}}}",
            "end": "{kind: shaft, carries: {d: {at: 4 mm, phase: 50 deg}}}",
        },
        {
            "first": "{kind: mesh, driver: a, driven: b, centre_distance: 50 mm, azimuth: 90 deg}",
            "second": "{kind: mesh, driver: c, driven: d, centre_distance: 65 mm, azimuth: -30 deg}",
        },
    ),
    "backward": (
        {
            "a": gear(20),
            "b": gear(30),
            "c": gear(25),
            "d": gear(40),
            "middle": "{kind: shaft, carries: {b: {}, c: {at: 25 mm, facing: backward, phase: 10 deg}}}",
            "end": "{kind: shaft, carries: {d: {at: 4 mm, facing: backward, phase: -35 deg}}}",
        },
        {
            "first": "{kind: mesh, driver: a, driven: b, centre_distance: 50 mm}",
            "second": "{kind: mesh, driver: c, driven: d, centre_distance: 65 mm, azimuth: 90 deg}",
        },
    ),
    "idler": (
        {"a": gear(20), "i": gear(31), "b": gear(44), "motor": "{kind: shaft}"},
        {
            "gearbox": "{kind: reducer, driver: motor, driven: a, ratio: -2.5, offset: 40 mm}",
            "first": "{kind: mesh, driver: a, driven: i, centre_distance: 51 mm, azimuth: 30 deg}",
            "second": "{kind: mesh, driver: i, driven: b, centre_distance: 75 mm, azimuth: 60 deg}",
        },
    ),
    "bevel forward": (
        {
            "p": gear(20, "bevel_gear"),
            "w": gear(30, "bevel_gear"),
            "motor": "{kind: shaft, carries: {p: {at: 50 mm, phase: 8 deg}}}",
        },
        {"corner": "{kind: bevel_mesh, driver: p, driven: w, azimuth: 90 deg}"},
    ),
    "bevel backward": (
        {
            "p": gear(20, "bevel_gear"),
            "w": gear(30, "bevel_gear"),
            "motor": "{kind: shaft, carries: {p: {at: 420 mm, facing: backward, phase: 8 deg}}}",
            "end": "{kind: shaft, carries: {w: {at: 100 mm, facing: backward, phase: 77 deg}}}",
        },
        {"corner": "{kind: bevel_mesh, driver: p, driven: w}"},
    ),
    "bevel at 60 deg": (
        {
            "p": gear(20, "bevel_gear"),
            "w": gear(30, "bevel_gear"),
            "s": gear(26),
            "t": gear(39),
            "end": "{kind: shaft, carries: {w: {at: 10 mm}, s: {at: 70 mm, facing: backward}}}",
        },
        {
            "corner": "{kind: bevel_mesh, driver: p, driven: w, shaft_angle: 60 deg, azimuth: 180 deg}",
            "after": "{kind: mesh, driver: s, driven: t, centre_distance: 65 mm, azimuth: 90 deg}",
        },
    ),
}

S60, C60 = math.sin(math.radians(60)), math.cos(math.radians(60))
PLACES: dict[str, dict[str, tuple[tuple[float, float, float], ...]]] = {
    # the frame of each shaft in the world: origin, x, z. A driven shaft at 0 has its x where the driver's mate is, away
    "chain": {
        "a": ((0, 0, 0), EAST, UP),
        "middle": ((0, 50, 5), NORTH, UP),  # b in the plane of a
        # c sees d at -30 deg of the middle's x, which points north: at 60 deg
        "end": ((65 * C60, 50 + 65 * S60, 5 + 25 - 4), (C60, S60, 0), UP),
    },
    "backward": {
        "middle": ((50, 0, 0), EAST, UP),
        # c looks down, so that 90 deg is the south; d looks down too, backward on a shaft that looks up
        "end": ((50, -65, 25 - 4), SOUTH, UP),
    },
    "idler": {
        "motor": ((0, 0, 0), EAST, UP),
        "a": ((0, 0, 40), EAST, UP),
        "i": ((51 * S60, 51 * C60, 40), (S60, C60, 0), UP),
        "b": ((51 * S60, 51 * C60 + 75, 40), NORTH, UP),  # 30 and 60 deg on
    },
    # the driven bevel gear's x is its mate's axis at 90 deg: both see the mesh on their +x
    "bevel forward": {"w": ((0, 0, 50), UP, NORTH)},
    "bevel backward": {"end": ((100, 0, 420), DOWN, WEST)},
    "bevel at 60 deg": {
        "end": ((10 * S60, 0, -10 * C60), (C60, 0, S60), (-S60, 0, C60)),
        # s stands 70 mm along that, its x with the shaft's, its z against it: 90 deg is against the shaft's y
        "t": ((-60 * S60, -65.0, 60 * C60), SOUTH, (S60, 0, -C60)),
    },
}
RATIOS: dict[str, dict[str, Fraction]] = {
    # turns of each shaft for one of the first, about their own z
    "chain": {"middle": Fraction(-20, 30), "end": Fraction(20, 30) * Fraction(25, 40)},
    # meshes of parallel gears turn opposite; gears that look down turn opposite to their shafts: both of the second
    "backward": {"middle": Fraction(-20, 30), "end": Fraction(20, 30) * Fraction(25, 40)},
    "idler": {"a": Fraction(-2, 5), "i": Fraction(2, 5) * Fraction(20, 31), "b": -Fraction(2, 5) * Fraction(20, 44)},
    # both look at their heels: seen so they turn opposite
    "bevel forward": {"w": Fraction(-20, 30)},
    "bevel backward": {"end": Fraction(-20, 30)},
    "bevel at 60 deg": {"end": Fraction(-20, 30), "t": -Fraction(20, 30) * Fraction(26, 39)},
}
ROOTS = {"chain": "a", "backward": "a", "idler": "motor", "bevel forward": "motor", "bevel backward": "motor"} | {
    "bevel at 60 deg": "p"
}


@pytest.fixture
def train(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[str, Model]:
    return request.param, model_of(tmp_path, *TRAINS[request.param])


every_train = pytest.mark.parametrize("train", TRAINS, indirect=True)


@every_train
def test_shafts_lie_where_their_gears_have_to_be(train: tuple[str, Model]) -> None:
    name, model = train
    for shaft, (origin, x, z) in PLACES[name].items():
        pose = model.layout.world_from_shaft[shaft]
        assert pose[:3, 3] == pytest.approx(origin, abs=SAME_PLACE), shaft
        assert pose[:3, 0] == pytest.approx(x, abs=1e-12), shaft
        assert pose[:3, 2] == pytest.approx(z, abs=1e-12), shaft


@every_train
def test_shafts_turn_by_their_teeth(train: tuple[str, Model]) -> None:
    name, model = train
    for shaft, rate in RATIOS[name].items():
        assert model.layout.shaft_turn[shaft].rate == rate
        assert model.layout.ratio(ROOTS[name], shaft) == 1 / rate


@every_train
@pytest.mark.parametrize("motor", [0.0, 1.234, -50.0])
def test_a_gear_stands_alike_on_its_shaft_and_in_each_of_its_meshes(train: tuple[str, Model], motor: float) -> None:
    stands_alike(train[1], motor)


def stands_alike(model: Model, motor: float) -> None:
    layout, made = model.layout, build(model, nominal_build(model).deviations)
    for mesh in model.meshes:
        angle = layout.mesh_turn[mesh.name].at(motor)
        turns = {mesh.driver: angle, mesh.driven: float(mesh.pair.driven_angle(np.array([angle]))[0])}
        for gear_name, turn in turns.items():
            seat = model.seat_index[mesh.name, gear_name]
            in_mesh = layout.world_from_mesh[mesh.name] @ made.world_from_gear(seat, np.array([turn]))[0]
            assert in_mesh == pytest.approx(on_shaft(model, gear_name, motor), abs=1e-9)


def on_shaft(model: Model, gear_name: str, motor: float) -> np.ndarray:
    """World pose of a gear by its shaft's turn, as the scene says how it sits."""
    sitting = {own.gear: (shaft.name, own) for shaft in model.shafts for own in shaft.carries}
    shaft, own = sitting.get(gear_name, (gear_name, Carried(gear_name)))
    turned = np.eye(4)
    turned[:3, :3] = Rotation.from_euler("z", model.layout.shaft_turn[shaft].at(motor)).as_matrix()
    sits = np.eye(4)
    facing = Rotation.from_euler("x", 180 if own.backward else 0, degrees=True)
    sits[:3, :3] = (facing * Rotation.from_euler("z", own.phase)).as_matrix()
    sits[2, 3] = own.at
    return model.layout.world_from_shaft[shaft] @ turned @ sits


@every_train
@pytest.mark.parametrize("motor", [0.0, 1.234])
def test_teeth_stand_in_the_spaces_of_their_mates_and_pitch_circles_touch(
    train: tuple[str, Model], motor: float
) -> None:
    teeth_fit(train[1], motor)


def teeth_fit(model: Model, motor: float) -> None:
    for mesh in model.meshes:
        driver, driven = (on_shaft(model, own, motor) for own in (mesh.driver, mesh.driven))
        teeth = (mesh.pair.pinion.teeth, mesh.pair.wheel.teeth)
        point = pitch_point(driver, driven, teeth)
        for pose, count in zip((driver, driven), teeth, strict=True):
            arm = point - pose[:3, 3]
            assert np.linalg.norm(arm - (arm @ pose[:3, 2]) * pose[:3, 2]) == pytest.approx(count, abs=SAME_PLACE)
        along = np.cross(driver[:3, 2], point - driver[:3, 3])
        places = [tooth_along(pose, count, point, along) for pose, count in zip((driver, driven), teeth, strict=True)]
        assert (places[0] - places[1]) % 1.0 == pytest.approx(0.5, abs=1e-9)


angles_deg = st.floats(-360.0, 360.0)


@st.composite
def random_trains(draw: st.DrawFn) -> tuple[dict[str, str], dict[str, str]]:
    """Two to five stages, spur and bevel, gears anyhow on their shafts."""
    parts, moves = {}, {}
    carried: list[list[str]] = [[]]
    for k in range(draw(st.integers(2, 5))):
        first, second = draw(st.integers(20, 45)), draw(st.integers(20, 45))
        carried.append([])
        if draw(st.booleans()):
            kind, move = "spur_gear", f"{{kind: mesh, centre_distance: {first + second} mm"
        else:
            kind, move = "bevel_gear", f"{{kind: bevel_mesh, shaft_angle: {draw(st.floats(50.0, 110.0))} deg"
        for shaft, name, teeth in ((k, f"driver {k}", first), (k + 1, f"driven {k}", second)):
            parts[name] = gear(teeth, kind)
            facing = draw(st.sampled_from(["forward", "backward"]))
            at, phase = draw(st.floats(-500.0, 500.0)), draw(angles_deg)
            carried[shaft].append(f"{name}: {{at: {at} mm, facing: {facing}, phase: {phase} deg}}")
        moves[f"mesh {k}"] = f"{move}, driver: driver {k}, driven: driven {k}, azimuth: {draw(angles_deg)} deg}}"
    shafts = {f"shaft {k}": f"{{kind: shaft, carries: {{{', '.join(gears)}}}}}" for k, gears in enumerate(carried)}
    return parts | shafts, moves


@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(train=random_trains(), motor=st.floats(-100.0, 100.0))
def test_whatever_sits_anyhow_on_shafts_meshes(
    train: tuple[dict[str, str], dict[str, str]], motor: float, tmp_path: Path
) -> None:
    model = model_of(tmp_path, *train)
    stands_alike(model, motor)
    teeth_fit(model, motor)


def pitch_point(driver: np.ndarray, driven: np.ndarray, teeth: tuple[int, int]) -> np.ndarray:
    """Contact point of pitch circles of radii z mm: between parallel axes, or off a common apex at the outer cone."""
    apart = driven[:3, 3] - driver[:3, 3]
    if np.linalg.norm(apart) > 1.0:
        return driver[:3, 3] + apart * teeth[0] / sum(teeth)
    assert np.linalg.norm(apart) < SAME_PLACE
    # the pitch line's distances from both axes are as the teeth: each unit axis counts by the other's
    line = teeth[1] * driver[:3, 2] + teeth[0] * driven[:3, 2]
    line /= np.linalg.norm(line)
    cone = teeth[0] / np.linalg.norm(np.cross(line, driver[:3, 2]))
    return driver[:3, 3] + cone * line


def tooth_along(pose: np.ndarray, teeth: int, point: np.ndarray, along: np.ndarray) -> float:
    """Distance of the middle of a tooth from a point at the pitch circle [pitches], along a direction there."""
    x, y, _ = pose[:3, :3].T @ (point - pose[:3, 3])
    behind = math.atan2(y, x) * teeth / (2 * math.pi)
    return -behind * math.copysign(1.0, along @ np.cross(pose[:3, 2], point - pose[:3, 3]))


# long periods ---------------------------------------------------------------------------------------------------


@every_train
def test_the_long_period_is_the_shortest_after_which_every_mesh_stands_as_before(train: tuple[str, Model]) -> None:
    name, model = train
    rates = RATIOS[name] | {ROOTS[name]: Fraction(1)}
    periods = []
    for mesh in model.meshes:
        shaft = model.layout.carrying[mesh.driver][0]
        first, second = mesh.pair.pinion.teeth, mesh.pair.wheel.teeth
        periods.append((abs(rates[shaft]), second // math.gcd(first, second)))
    (rate, period), *_ = periods
    # whole long periods of the first mesh, one after the other, until all others are whole too
    shortest = next(
        turns
        for count in itertools.count(1)
        if all((turns := count * period / rate) * r / p == int(turns * r / p) for r, p in periods)
    )
    (drive,) = model.layout.drives
    assert drive.turns == shortest


@every_train
def test_all_meshes_of_a_trial_stand_at_one_turn_of_the_motor(train: tuple[str, Model]) -> None:
    _, model = train
    (drive,), angles = model.layout.drives, drawn_trials(model, 7, 0, 50).positions
    first, *others = model.meshes
    turning = model.layout.mesh_turn[first.name]
    period = first.pair.long_period_turns / abs(turning.rate)  # of the motor
    for trial in range(50):
        start = (angles[first.name][trial] - turning.offset) / float(turning.rate)
        fits = [
            all(
                whole(
                    angles[mesh.name][trial] - model.layout.mesh_turn[mesh.name].at(motor), mesh.pair.long_period_turns
                )
                for mesh in others
            )
            for motor in start + 2 * math.pi * float(period) * np.arange(int(drive.turns / period))
        ]
        assert sum(fits) == 1


def whole(angle: float, turns: int) -> bool:
    """True if an angle [rad] is a whole number of so many turns."""
    share = angle / (2 * math.pi * turns)
    return abs(share - round(share)) < 1e-9


# which flanks work ----------------------------------------------------------------------------------------------

PAIR = {"a": gear(20), "b": gear(30)}
WITH_IDLER = {"a": gear(20), "i": gear(25), "b": gear(30)}
ONE = {"first": "{kind: mesh, driver: a, driven: b, centre_distance: 50 mm, working_flank: either}"}
TWO = {
    "first": "{kind: mesh, driver: a, driven: i, centre_distance: 45 mm, working_flank: either}",
    "second": "{kind: mesh, driver: i, driven: b, centre_distance: 55 mm, working_flank: either}",
}


def arm(x: float, y: float = 0.0, on: str = "b") -> dict[str, str]:
    points = f"{{tip: [{x} mm, {y} mm, 0 mm]}}"
    return {"arm": f"{{kind: arm, shaft: {on}, points: {points}}}"}


def swing(
    gravity: str = "[0, -1, 0]", motor: str = "a", output: str = "b", turns: str = "counter_clockwise"
) -> dict[str, str]:
    pulled = f", gravity: {gravity}" if gravity else ""
    return {"swing": f"{{kind: train, driven: {motor}, output: {output}, turns: {turns}{pulled}}}"}


FLANKS = {
    # the arm falls clockwise; b is held by being pushed counter-clockwise, which a does that turns clockwise: by its
    # right flanks
    "arm to the right": (PAIR | arm(100), ONE | swing(), {"first": RIGHT}),
    "arm to the left": (PAIR | arm(-100), ONE | swing(), {"first": LEFT}),
    "gravity upwards": (PAIR | arm(100), ONE | swing("[0, 2, 0]"), {"first": LEFT}),
    "gravity to the right, arm upwards": (PAIR | arm(0, 100), ONE | swing("[1, 0, 0]"), {"first": RIGHT}),
    # the idler does to b what a did, and a, which turns opposite to it, pushes by the other flanks
    "an idler": (WITH_IDLER | arm(100), TWO | swing(), {"first": LEFT, "second": RIGHT}),
    # b's frame has its z down: it sees gravity along its +y, the arm falls counter-clockwise, a pushes b clockwise
    "the driver backward": (
        PAIR | arm(100) | {"motor": "{kind: shaft, carries: {a: {facing: backward}}}"},
        ONE | swing(motor="motor"),
        {"first": LEFT},
    ),
    # both gears face backward, their shafts look up: the shaft of b has to be pushed counter-clockwise, which is b's
    # clockwise and a's counter-clockwise, seen from where they look
    "both backward": (
        PAIR
        | arm(100, on="end")
        | {
            "motor": "{kind: shaft, carries: {a: {facing: backward}}}",
            "end": "{kind: shaft, carries: {b: {facing: backward}}}",
        },
        ONE | swing(motor="motor", output="end"),
        {"first": LEFT},
    ),
    # without a load the motor pushes; counter-clockwise it does so by left flanks, and so does what goes clockwise by
    # right ones
    "no gravity": (WITH_IDLER | arm(100), TWO | swing(""), {"first": LEFT, "second": RIGHT}),
    "no gravity, the motor clockwise": (
        WITH_IDLER | arm(100), TWO | swing("", turns="clockwise"), {"first": RIGHT, "second": LEFT},
    ),
    "no arm": (PAIR, ONE | swing(turns="clockwise"), {"first": RIGHT}),
    "arm along gravity": (PAIR | arm(0, -100), ONE | swing(), {"first": LEFT}),
    "a reducer that turns round": (
        PAIR | {"motor": "{kind: shaft}"},
        {"gearbox": "{kind: reducer, driver: motor, driven: a, ratio: -7}"} | ONE | swing("", motor="motor"),
        {"first": RIGHT},
    ),
}  # fmt: skip


@pytest.mark.parametrize(("parts", "moves", "flanks"), FLANKS.values(), ids=FLANKS)
def test_the_load_decides_which_flanks_work(
    parts: dict[str, str], moves: dict[str, str], flanks: dict[str, int], tmp_path: Path
) -> None:
    model = model_of(tmp_path, parts, moves)
    assert {mesh.name: mesh.working_flank for mesh in model.meshes} == flanks


# bearings -------------------------------------------------------------------------------------------------------

BEARINGS = {
    "a": gear(20),
    "b": gear(30),
    "c": gear(25),
    "d": gear(40),
    "middle": "{kind: shaft, carries: {b: {at: 20 mm}, c: {at: 60 mm, facing: backward}}}",
    "low": "{kind: bearing, shaft: middle, at: -20 mm}",
}
TWO_BEARINGS = BEARINGS | {"high": "{kind: bearing, shaft: middle, at: 60 mm}"}
MESHES = {
    "first": "{kind: mesh, driver: a, driven: b, centre_distance: 50 mm}",
    "second": "{kind: mesh, driver: c, driven: d, centre_distance: 65 mm, azimuth: 40 deg}",
}


def clearance(name: str, bearing: str, direction: str) -> str:
    law = "{kind: uniform, lower: 0 um, upper: 50 um}"
    return f"  {name}: {{kind: bearing_clearance, of: {bearing}, direction: {direction}, distribution: {law}}}\n"


def axes(
    model: Model, deviations: Mapping[str, list[float]], mesh: str, gear_name: str
) -> tuple[np.ndarray, np.ndarray]:
    """Displacement [mm] of a gear's axis in mid-face, in its shaft's frame at rest, and its direction."""
    row = nominal_build(model).deviations.copy()
    rest = build(model, row)
    for name, values in deviations.items():
        row[0, model.component_slices[name]] = values
    seat, pose = model.seat_index[mesh, gear_name], model.layout.world_from_mesh[mesh]
    (point, direction), (origin, _) = build(model, row).axis(seat), rest.axis(seat)
    shaft = model.layout.world_from_shaft[model.layout.carrying[gear_name][0]][:3, :3]
    return shaft.T @ pose[:3, :3] @ (point - origin)[0], shaft.T @ pose[:3, :3] @ direction[0]


def test_two_bearings_move_a_gear_between_them_by_the_mean_and_lean_it_by_the_difference(tmp_path: Path) -> None:
    tolerances = clearance("p", "low", "{at: 90 deg}") + clearance("q", "high", "{at: 0 deg}")
    model = model_of(tmp_path, TWO_BEARINGS, MESHES, tolerances)
    drawn = {"p": [0.030], "q": [0.050]}  # the axis moves by half of it: 15 um north below, 25 um east above
    moved, direction = axes(model, drawn, "first", "b")
    assert moved == pytest.approx([0.0125, 0.0075, 0.0], abs=1e-12)
    assert direction == pytest.approx([0.025 / 80, -0.015 / 80, 1.0], abs=1e-7)  # squares of the lean
    # the upper gear sits in its bearing's plane, and looks down
    moved, direction = axes(model, drawn, "second", "c")
    assert moved == pytest.approx([0.025, 0.0, 0.0], abs=1e-12)
    assert direction == pytest.approx([-0.025 / 80, 0.015 / 80, -1.0], abs=1e-7)


def test_one_bearing_moves_all_of_its_shaft(tmp_path: Path) -> None:
    model = model_of(tmp_path, BEARINGS, MESHES, clearance("p", "low", "{at: 90 deg}"))
    for mesh, own, up in (("first", "b", 1.0), ("second", "c", -1.0)):
        moved, direction = axes(model, {"p": [0.030]}, mesh, own)
        assert moved == pytest.approx([0.0, 0.015, 0.0], abs=1e-12)
        assert direction == pytest.approx([0.0, 0.0, up], abs=1e-12)


def test_a_clearance_of_random_direction_moves_gears_that_face_either_way_alike(tmp_path: Path) -> None:
    model = model_of(tmp_path, BEARINGS, MESHES, clearance("p", "low", "random"))
    for mesh, own in (("first", "b"), ("second", "c")):
        moved, _ = axes(model, {"p": [0.030, 0.010]}, mesh, own)
        assert moved == pytest.approx([0.015, 0.005, 0.0], abs=1e-12)


@pytest.mark.parametrize(("mesh", "away"), [("first", (1.0, 0.0)), ("second", None)])
def test_apart_is_away_from_the_mate_in_the_named_mesh(
    mesh: str, away: tuple[float, float] | None, tmp_path: Path
) -> None:
    law = "{kind: uniform, lower: 0 um, upper: 50 um}"
    words = f"  p: {{kind: bearing_clearance, of: low, mesh: {mesh}, direction: apart, distribution: {law}}}\n"
    model = model_of(tmp_path, BEARINGS, MESHES, words)
    # b sees a at -x and leaves it to +x; c looks down and sees d at its 40 deg, the shaft's -40 deg: away is 140 deg
    wanted = away or (math.cos(math.radians(140)), math.sin(math.radians(140)))
    moved, _ = axes(model, {"p": [0.030]}, "first", "b")
    assert moved == pytest.approx([0.015 * wanted[0], 0.015 * wanted[1], 0.0], abs=1e-12)


@pytest.mark.parametrize(("mesh", "force"), [("first", 270 + 20), ("second", -(40 + 90 + 20))])
def test_tooth_force_pushes_a_shaft_as_the_mate_pushes_its_gear(mesh: str, force: float, tmp_path: Path) -> None:
    """By right flanks the driver turns clockwise: b, east of a, is pushed south, and away by 20 deg of that.

    c drives and d pushes it back: as c sees it, d at 40 deg, counter-clockwise and away; the shaft sees that mirrored.
    """
    law = "{kind: uniform, lower: 0 um, upper: 50 um}"
    words = f"  p: {{kind: bearing_clearance, of: low, mesh: {mesh}, direction: tooth_force, distribution: {law}}}\n"
    model = model_of(tmp_path, BEARINGS, MESHES, words)
    moved, _ = axes(model, {"p": [0.030]}, "first", "b")
    toward = math.radians(force)
    assert moved == pytest.approx([0.015 * math.cos(toward), 0.015 * math.sin(toward), 0.0], abs=1e-12)


# branches of ratios that never meet again -----------------------------------------------------------------------


def test_meshes_stand_anywhere_although_the_branches_of_a_train_meet_again_after_ages(tmp_path: Path) -> None:
    """Ratios of data sheets, in many digits: some 1e22 turns of the motor, more than a draw has bits."""
    parts, moves = {"motor": "{kind: shaft}"}, {}
    for name, ratio, teeth in (("p", 5.123456789, 31), ("q", 0.987654321, 37), ("r", 2.718281829, 41)):
        parts |= {f"{name} driver": gear(20), f"{name} driven": gear(teeth)}
        moves[f"{name} reducer"] = f"{{kind: reducer, driver: motor, driven: {name} driver, ratio: {ratio}}}"
        apart = f"centre_distance: {20 + teeth} mm"
        moves[name] = f"{{kind: mesh, driver: {name} driver, driven: {name} driven, {apart}}}"
    model, count = model_of(tmp_path, parts, moves), 20_000
    (drive,) = model.layout.drives
    assert drive.turns > 1e20
    angles = drawn_trials(model, 1, 0, count).positions
    shares = [angles[mesh.name] / (2 * math.pi * mesh.pair.long_period_turns) % 1.0 for mesh in model.meshes]
    for share in shares:
        assert kstest(share, "uniform").pvalue > 1e-3
    # one tells nothing of the others: a correlation of n pairs of uniforms has the sigma 1/sqrt(n)
    others = np.asarray(np.corrcoef(shares))[np.triu_indices(3, 1)]
    assert np.abs(others).max() < 4 / math.sqrt(count)
