"""From a scene's text to the poses of a build: one tolerance at a time, against numbers worked out by hand.

The pair: 20 and 30 teeth, module 2, 20 deg. Its centre distance 50 cos(20 deg) 13/12 mm makes the working pressure
angle that of the triangle 5, 12, 13: sin = 5/13, cos = 12/13.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from fixtures import EngineOf
from gear_trials import drawn_trials
from oracles import brute_force, poses
from oracles.involute_gear import InvoluteGear
from places import SCENES
from scene_texts import scene_of

from tol3d.gearing.builds.build import Build, build
from tol3d.gearing.engines import OK
from tol3d.gearing.meshing.mesh import Meshing
from tol3d.gearing.model import Model, Reading, model_from_scene
from tol3d.gears import LEFT, RIGHT
from tol3d.gears.flank import Flank

SPUR_PAIR = (SCENES / "spur_pair.yaml").read_text("utf-8")

CENTRE_DISTANCE = 50.9000169592  # mm; 50 cos(20 deg) 13/12, to a tenth of a nanometre
DRIVER = "  pinion: {kind: spur_gear, teeth: 20, module: 2 mm, face_width: 20 mm, expansion: 10e-6 1/K}\n"
DRIVEN = "  wheel: {kind: spur_gear, teeth: 30, module: 2 mm, face_width: 16 mm, expansion: 20e-6 1/K}\n"
HOUSING = "  housing: {kind: housing, expansion: 25e-6 1/K}\n"
MESH = f"kind: mesh, driver: pinion, driven: wheel, centre_distance: {CENTRE_DISTANCE} mm"

POSE_BOUND = 1e-9  # mm and 1; the numbers below are written to a picometre or better


def model_of(folder: Path, tolerances: str, *, parts: str = DRIVER + DRIVEN + HOUSING, mesh: str = MESH) -> Model:
    text = (
        f"scene: small\nparts:\n{parts}tolerances:\n{tolerances}moves:\n  gear pair: {{{mesh}}}\n"
        "measures:\n  play: {kind: normal_backlash, of: gear pair}\n"
    )
    return model_from_scene(scene_of(text, folder))


def built(model: Model, count: int = 1) -> Build:
    return build(model, drawn_trials(model, 1, 0, count).deviations)


@dataclass(frozen=True)
class Gear:
    """Effect of one tolerance on one gear.

    Args:
        shift: of its axis in the world of the mesh [um].
        turn: of its axis, rotation vector about the world's x and y [mrad].
        centre: off the axis, in the gear's frame [um].
        thickness: of its teeth [um].
        growth: of its lengths [1e-6].
    """

    shift: tuple[float, float, float] = (0.0, 0.0, 0.0)
    turn: tuple[float, float] = (0.0, 0.0)
    centre: tuple[float, float] = (0.0, 0.0)
    thickness: float = 0.0
    growth: float = 0.0


@dataclass(frozen=True)
class Case:
    """A tolerance as a scene says it, its constant value, and what becomes of both gears."""

    said: str
    value: str
    driver: Gear = Gear()
    driven: Gear = Gear()
    flanks: tuple[str, ...] = ("right", "left")

    @property
    def text(self) -> str:
        return f"  it: {{{self.said}, distribution: {{kind: constant, value: {self.value}}}}}\n"


CLEARANCE = "kind: bearing_clearance, of: "
# 8 um on the diameter are 4 um of the axis; 26 um are 13 um, of which 5 um and 12 um along the sides of the triangle
CASES = {
    "thin driver": Case("kind: tooth_thickness, of: pinion", "-30 um", driver=Gear(thickness=-30.0)),
    "thick driven": Case("kind: tooth_thickness, of: wheel", "12 um", driven=Gear(thickness=12.0)),
    # 6 um (cos 30 deg, sin 30 deg) in the gear's own frame, whatever the mesh
    "eccentric driver": Case(
        "kind: eccentricity, of: pinion, direction: {at: 30 deg}", "6 um", driver=Gear(centre=(5.196152423, 3.0))
    ),
    "eccentric driven": Case(
        "kind: eccentricity, of: wheel, direction: {at: -90 deg}", "6 um", driven=Gear(centre=(0.0, -6.0))
    ),
    # all of the run-out, 8 um (cos 150 deg, sin 150 deg)
    "driver's shaft runs out": Case(
        "kind: run_out, of: pinion, direction: {at: 150 deg}", "8 um", driver=Gear(centre=(-6.928203230, 4.0))
    ),
    "driven's shaft runs out": Case(
        "kind: run_out, of: wheel, direction: {at: 0 deg}", "8 um", driven=Gear(centre=(8.0, 0.0))
    ),
    # the driver is held, the driven axis moves away along +x
    "wide": Case("kind: centre_distance, of: gear pair", "20 um", driven=Gear(shift=(20.0, 0.0, 0.0))),
    "narrow": Case("kind: centre_distance, of: gear pair", "-15 um", driven=Gear(shift=(-15.0, 0.0, 0.0))),
    # away from the mate: the driven lies at +x of the driver, the driver at -x of the driven
    "driver apart": Case(CLEARANCE + "pinion, direction: apart", "8 um", driver=Gear(shift=(-4.0, 0.0, 0.0))),
    "driven apart": Case(CLEARANCE + "wheel, direction: apart", "8 um", driven=Gear(shift=(4.0, 0.0, 0.0))),
    "driver, nothing said": Case(CLEARANCE + "pinion", "8 um", driver=Gear(shift=(-4.0, 0.0, 0.0))),
    "driven, mesh said": Case(CLEARANCE + "wheel, mesh: gear pair", "8 um", driven=Gear(shift=(4.0, 0.0, 0.0))),
    # 4 um (cos 30 deg, sin 30 deg) of the world, for either gear
    "driver at 30 deg": Case(
        CLEARANCE + "pinion, direction: {at: 30 deg}", "8 um", driver=Gear(shift=(3.464101615, 2.0, 0.0))
    ),
    "driven at 30 deg": Case(
        CLEARANCE + "wheel, direction: {at: 30 deg}", "8 um", driven=Gear(shift=(3.464101615, 2.0, 0.0))
    ),
    "driven at 270 deg": Case(
        CLEARANCE + "wheel, direction: {at: 270 deg}", "8 um", driven=Gear(shift=(0.0, -4.0, 0.0))
    ),
    # The force of the driver on the driven acts along the flanks' normal, which leans alpha_w away from the tangent of
    # the pitch circles and always presses the axes apart: sin alpha_w along +x on the driven. A right flank looks
    # clockwise; at the mesh, on the driver's +x side, clockwise is down: -y on the driven. A left flank pushes it up.
    # The driver gets the opposite.
    "force of a right flank on the driven": Case(
        CLEARANCE + "wheel, direction: tooth_force", "26 um", driven=Gear(shift=(5.0, -12.0, 0.0)), flanks=("right",)
    ),
    "force of a left flank on the driven": Case(
        CLEARANCE + "wheel, direction: tooth_force", "26 um", driven=Gear(shift=(5.0, 12.0, 0.0)), flanks=("left",)
    ),
    "force of a right flank on the driver": Case(
        CLEARANCE + "pinion, direction: tooth_force", "26 um", driver=Gear(shift=(-5.0, 12.0, 0.0)), flanks=("right",)
    ),
    "force of a left flank on the driver": Case(
        CLEARANCE + "pinion, direction: tooth_force", "26 um", driver=Gear(shift=(-5.0, -12.0, 0.0)), flanks=("left",)
    ),
    # 8 um over 16 mm, the smaller face width, are 0.5 mrad
    "in plane, a length": Case("kind: axis_in_plane, of: gear pair", "8 um", driven=Gear(turn=(0.0, 0.5))),
    "in plane, an angle": Case("kind: axis_in_plane, of: gear pair", "-0.3 mrad", driven=Gear(turn=(0.0, -0.3))),
    "out of plane, a length": Case("kind: axis_out_of_plane, of: gear pair", "8 um", driven=Gear(turn=(0.5, 0.0))),
    "out of plane, an angle": Case(
        "kind: axis_out_of_plane, of: gear pair", "-0.3 mrad", driven=Gear(turn=(-0.3, 0.0))
    ),
    "driver shifted": Case("kind: axial_shift, of: pinion", "5 um", driver=Gear(shift=(0.0, 0.0, 5.0))),
    "driven shifted": Case("kind: axial_shift, of: wheel", "-7 um", driven=Gear(shift=(0.0, 0.0, -7.0))),
    # 20 K times 10e-6, 20e-6 and 25e-6 1/K; the housing carries the driven axis 500e-6 of 50.9000169592 mm further
    "warm driver": Case("kind: temperature, of: pinion", "20 K", driver=Gear(growth=200.0)),
    "warm driven": Case("kind: temperature, of: [wheel]", "20 K", driven=Gear(growth=400.0)),
    "warm housing": Case("kind: temperature, of: housing", "20 K", driven=Gear(shift=(25.4500084796, 0.0, 0.0))),
    "all cold": Case(
        "kind: temperature, of: [housing, wheel, pinion]",
        "-20 K",
        driver=Gear(growth=-200.0),
        driven=Gear(shift=(-25.4500084796, 0.0, 0.0), growth=-400.0),
    ),
}


def assert_gear(made: Build, index: int, expected: Gear, at: float) -> None:
    """A gear of a build against the expected deviations from its nominal place at x = `at` [mm]."""
    place = np.array(expected.shift) * 1e-3 + (at, 0.0, 0.0)
    shaft = poses.pose(np.array([*expected.turn, 0.0]) * 1e-3, place)
    assert np.abs(made.world_from_shaft[0, index] - shaft).max() <= POSE_BOUND
    assert made.centre[0, index] == pytest.approx(np.array(expected.centre) * 1e-3, abs=POSE_BOUND)
    diameter = 40.0 if at == 0.0 else 60.0  # of the reference circle: half the arc on each flank is a turn of s/d
    assert diameter * made.flank_turn[0, index] == pytest.approx(expected.thickness * 1e-3, abs=POSE_BOUND)
    assert made.flank_offset[0, index] == 0.0
    assert made.scale[0, index] == pytest.approx(1.0 + expected.growth * 1e-6, abs=POSE_BOUND)


@pytest.mark.parametrize("first", ["driver", "driven"])
@pytest.mark.parametrize(("name", "flank"), [(name, flank) for name, case in CASES.items() for flank in case.flanks])
def test_a_tolerance_moves_what_it_says_and_nothing_else(name: str, flank: str, first: str, tmp_path: Path) -> None:
    case = CASES[name]
    parts = HOUSING + (DRIVER + DRIVEN if first == "driver" else DRIVEN + DRIVER)
    mesh = f"{MESH}, working_flank: {flank}, housing: housing"
    model = model_of(tmp_path, case.text, parts=parts, mesh=mesh)
    made = built(model)
    assert_gear(made, model.seat_index["gear pair", "pinion"], case.driver, 0.0)
    assert_gear(made, model.seat_index["gear pair", "wheel"], case.driven, CENTRE_DISTANCE)


def test_a_length_of_the_axes_counts_over_the_smaller_face_width_whichever_gear_has_it(tmp_path: Path) -> None:
    narrow = DRIVER.replace("face_width: 20 mm", "face_width: 10 mm")
    text = CASES["in plane, a length"].text.replace("8 um", "5 um")
    # 5 um over 10 mm
    assert_gear(built(model_of(tmp_path, text, parts=narrow + DRIVEN)), 1, Gear(turn=(0.0, 0.5)), CENTRE_DISTANCE)


def test_a_housing_that_no_mesh_names_moves_nothing(tmp_path: Path) -> None:
    made = built(model_of(tmp_path, CASES["warm housing"].text))
    assert_gear(made, 0, Gear(), 0.0)
    assert_gear(made, 1, Gear(), CENTRE_DISTANCE)


def test_tolerances_of_one_gear_add_up(tmp_path: Path) -> None:
    names: tuple[str, ...] = (
        "wide",
        "driven apart",
        "driven at 270 deg",
        "driven shifted",
        "warm housing",
        "eccentric driven",
    )
    names += ("driven's shaft runs out", "in plane, a length", "warm driven", "thick driven")
    text = "".join(CASES[name].text.replace("  it:", f"  {name.replace(',', '')}:") for name in names)
    made = built(model_of(tmp_path, text, mesh=f"{MESH}, housing: housing"))
    assert_gear(made, 0, Gear(), 0.0)
    # x: 20 + 4 + 25.45; y: -4; z: -7; the centre 6 um down and 8 um out
    whole = Gear((49.4500084796, -4.0, -7.0), turn=(0.0, 0.5), centre=(8.0, -6.0), thickness=12.0, growth=400.0)
    assert_gear(made, 1, whole, CENTRE_DISTANCE)


def test_temperatures_of_one_part_add_up(tmp_path: Path) -> None:
    day, run = CASES["all cold"].text, CASES["warm housing"].text + CASES["warm driver"].text.replace("it:", "too:")
    text = day.replace("it:", "day:") + run.replace("20 K", "35 K")
    made = built(model_of(tmp_path, text, mesh=f"{MESH}, housing: housing"))
    # the pinion and the housing are 35 K - 20 K warmer, 10e-6 and 25e-6 1/K, and the wheel 20 K colder, 20e-6 1/K
    assert_gear(made, 0, Gear(growth=150.0), 0.0)
    assert_gear(made, 1, Gear((19.0875063597, 0.0, 0.0), growth=-400.0), CENTRE_DISTANCE)


# random directions ------------------------------------------------------------------------------------------

TRIALS = 400
# A direction uniform over the circle: cos has mean 0 and variance 1/2, and so has sin; cos^2 has mean 1/2 and
# variance 1/8. Four standard errors of each over the trials.
FIRST_MOMENT, SECOND_MOMENT = 4 * math.sqrt(1 / 2 / TRIALS), 4 * math.sqrt(1 / 8 / TRIALS)


def assert_circle(vectors: np.ndarray, radius: float) -> None:
    """Vectors (n, 2) [mm] all of one length [um], in directions that are uniform."""
    assert np.hypot(*vectors.T) == pytest.approx(np.full(TRIALS, radius * 1e-3), abs=POSE_BOUND)
    unit = vectors / (radius * 1e-3)
    assert np.abs(unit.mean(axis=0)).max() <= FIRST_MOMENT
    assert abs((unit[:, 0] ** 2).mean() - 0.5) <= SECOND_MOMENT
    assert abs((unit[:, 0] * unit[:, 1]).mean()) <= SECOND_MOMENT


@pytest.mark.parametrize("kind", ["eccentricity", "run_out"])
@pytest.mark.parametrize("said", ["", ", direction: random"], ids=["nothing said", "random"])
@pytest.mark.parametrize(("part", "gear"), [("pinion", 0), ("wheel", 1)])
def test_a_random_offset_turns_with_its_gear_by_its_whole_length(
    kind: str, said: str, part: str, gear: int, tmp_path: Path
) -> None:
    made = built(model_of(tmp_path, Case(f"kind: {kind}, of: {part}{said}", "6 um").text), TRIALS)
    assert_circle(made.centre[:, gear], 6.0)
    assert (made.centre[:, 1 - gear] == 0.0).all()
    assert (made.world_from_shaft == built(model_of(tmp_path, "  {}\n")).world_from_shaft).all()


@pytest.mark.parametrize(("part", "gear"), [("pinion", 0), ("wheel", 1)])
def test_a_random_clearance_moves_its_axis_by_half_of_it(part: str, gear: int, tmp_path: Path) -> None:
    made = built(model_of(tmp_path, Case(CLEARANCE + f"{part}, direction: random", "8 um").text), TRIALS)
    nominal = built(model_of(tmp_path, "  {}\n")).world_from_shaft
    moved = made.world_from_shaft[..., :3, 3] - nominal[..., :3, 3]
    assert_circle(moved[:, gear, :2], 4.0)
    assert (moved[:, gear, 2] == 0.0).all()
    assert (moved[:, 1 - gear] == 0.0).all()
    assert (made.world_from_shaft[..., :3, :3] == np.eye(3)).all()
    assert (made.centre == 0.0).all()


def test_each_trial_has_its_own_draw(tmp_path: Path) -> None:
    text = "  it: {kind: centre_distance, of: gear pair, distribution: {kind: uniform, lower: -9 um, upper: 21 um}}\n"
    shift = 1e3 * (built(model_of(tmp_path, text), TRIALS).world_from_shaft[:, 1, 0, 3] - CENTRE_DISTANCE)
    # uniform over 30 um about 6 um: sigma 30/sqrt(12), four standard errors; no gap of 12 mean spacings
    assert abs(shift.mean() - 6.0) <= 4 * 30 / math.sqrt(12 * TRIALS)
    assert np.diff(np.sort([-9.0, *shift, 21.0])).max() <= 12 * 30 / TRIALS


# the working flank ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("said", "flank"), [(", working_flank: right", RIGHT), (", working_flank: left", LEFT), ("", RIGHT)]
)
def test_the_working_flank_of_the_text_is_the_model_s(said: str, flank: Flank, tmp_path: Path) -> None:
    (mesh,) = model_of(tmp_path, "  {}\n", mesh=MESH + said).meshes
    assert mesh.working_flank == flank
    assert (mesh.driver, mesh.driven) == ("pinion", "wheel")


TURNED = 5e-3  # mm at the base circle; a tenth of the backlash
STRIPS = 0.05e-3  # mm; two flanks touch, each a chord error of 0.021 um inside its tooth, and FCL's rounding


@pytest.mark.parametrize(("word", "pushes"), [("left", True), ("right", False)])
def test_a_driver_that_turns_counter_clockwise_pushes_with_its_left_flank(
    word: str, pushes: bool, tmp_path: Path, engine_of: EngineOf
) -> None:
    """Seated, then turned a little further counter-clockwise: only the left flank digs into its mate."""
    model = model_from_scene(scene_of(SPUR_PAIR.replace("working_flank: right", f"working_flank: {word}"), tmp_path))
    angle = np.array([0.3, 11.0, 140.0, 301.0])  # rad, within the long period of 55 turns
    row = np.zeros((len(angle), model.component_count))
    for name, um in (("pinion tooth thickness", -24.5), ("wheel tooth thickness", -26.5), ("bearing clearance", 16.0)):
        row[:, model.component_slices[name]] = um * 1e-3
    seat = Meshing(engine_of(model), model, model.meshes[0], build(model, row), Reading()).seat(angle)
    assert (seat.status == OK).all()
    # the same build by hand; the wheel's axis moves by half of the clearance
    alpha = math.radians(20)
    pinion = InvoluteGear(28, 2.5, alpha, 20.0, thickness_deviation=-24.5e-3)
    wheel = InvoluteGear(110, 2.5, alpha, 20.0, thickness_deviation=-26.5e-3)
    driver, driven = (np.tile(poses.pose(np.zeros(3), [x, 0.0, 0.0]), (4, 1, 1)) for x in (0.0, 172.508))
    mesh = brute_force.Mesh(pinion, wheel, driver, driven, np.zeros((4, 2)), np.zeros((4, 2)))

    def nearest(further: float) -> np.ndarray:
        at = angle + further / pinion.base_radius
        sides = [brute_force.smallest_distance(mesh, at, seat.driven_angle, side) for side in (1, -1)]
        return np.minimum(*sides)

    assert np.abs(nearest(0.0)).max() <= STRIPS
    assert nearest(TURNED) == pytest.approx(np.full(4, -TURNED if pushes else TURNED), abs=STRIPS)
