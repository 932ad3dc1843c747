"""Whole trains in one world: poses told by hand, teeth that mesh across files, pictures that name their parts."""

import math
from itertools import pairwise
from pathlib import Path

import fcl
import numpy as np
import pytest
import trimesh
from matplotlib.image import imread
from of_kind import known, of_kind
from rendering import renders

from tol3d import Run
from tol3d.cad.solids.posed_gear import ShaftBody
from tol3d.errors import InputError
from tol3d.gearing.presenting.whole_trains import HOUSING_COLOUR, WholeTrain, whole_trains
from tol3d.gearing.shown.display import seated_build
from tol3d.gearing.shown.placed import DISPLAY_DEFLECTION
from tol3d.gears import SpurGear
from tol3d.report import export_run, view_run
from tol3d.simulate import run_scene
from tol3d.study.results.replaying import build_of

TRIAL = 2
DEG = math.pi / 180

SCENE = """
scene: train
parts:
  motor: {kind: shaft}
  input: {kind: shaft, carries: {pinion: {at: 5 mm, phase: 20 deg}}, diameter: 6 mm}
  idler: {kind: spur_gear, teeth: 23, module: 1 mm, face_width: 5 mm, bore: 8 mm}
  pinion: {kind: spur_gear, teeth: 18, module: 1 mm, face_width: 6 mm}
  wheel: {kind: spur_gear, teeth: 31, module: 1 mm, face_width: 5 mm, bore: 12 mm}
  output:
    kind: shaft
    carries: {wheel: {at: 7 mm, facing: backward, phase: 11 deg}, bevel driver: {at: 60 mm, facing: backward}}
  flange: {kind: shaft, carries: {bevel driven: {}}}
  bevel driver: {kind: bevel_gear, teeth: 17, module: 2 mm, face_width: 6 mm}
  bevel driven: {kind: bevel_gear, teeth: 20, module: 2 mm, face_width: 6 mm}
  arm: {kind: arm, shaft: flange, points: {elbow: [0 mm, 90 mm, 60 mm], tip: [50 mm, 90 mm, 60 mm]}}
moves:
  gearbox: {kind: reducer, driver: motor, driven: input, ratio: 12, backlash: 2 arcmin, offset: 30 mm}
  first: {kind: mesh, driver: pinion, driven: idler, centre_distance: 20.52 mm, azimuth: 30 deg, working_flank: left}
  second: {kind: mesh, driver: idler, driven: wheel, centre_distance: 27.03 mm, azimuth: 50 deg, working_flank: right}
  bevels: {kind: bevel_mesh, driver: bevel driver, driven: bevel driven, azimuth: 40 deg, working_flank: right}
  swing: {kind: train, driven: motor, output: flange, gravity: [0, -2, 0]}
tolerances:
  pinion thickness: {kind: tooth_thickness, of: pinion, distribution: {kind: uniform, lower: -60 um, upper: -40 um}}
  wheel thickness: {kind: tooth_thickness, of: wheel, distribution: {kind: uniform, lower: -60 um, upper: -40 um}}
  bevel thickness:
    {kind: tooth_thickness, of: bevel driver, distribution: {kind: uniform, lower: -80 um, upper: -60 um}}
  idler eccentricity: {kind: eccentricity, of: idler, distribution: {kind: rayleigh, scale: 5 um}}
measures:
  first backlash: {kind: normal_backlash, of: first}
  second backlash: {kind: normal_backlash, of: second}
  bevel backlash: {kind: normal_backlash, of: bevels}
  tip: {kind: tip_displacement, of: swing, arm: arm, point: tip}
study: {trials: 4, seed: 5}
"""

MESHES = {"first": ("pinion", "idler"), "second": ("idler", "wheel"), "bevels": ("bevel driver", "bevel driven")}
BODIES = {"motor", "input", "output", "flange", "arm", "gearbox"}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("train")
    (folder / "train.yaml").write_text(SCENE, encoding="utf-8")
    return run_scene(folder / "train.yaml", out=folder / "run")


@pytest.fixture(scope="module")
def train(run: Run) -> WholeTrain:
    (train,) = whole_trains(seated_build(*build_of(run, TRIAL)))
    return train


def turned(azimuth: float) -> np.ndarray:
    cos, sin = math.cos(azimuth), math.sin(azimuth)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


# where things are -----------------------------------------------------------------------------------

PINION = np.array([0.0, 0.0, 30.0 + 5.0])  # the gearbox's offset and the gear's place on its shaft
IDLER = PINION + turned(30 * DEG) @ [20.52, 0.0, 0.0]
WHEEL = IDLER + turned(80 * DEG) @ [27.03, 0.0, 0.0]  # azimuths follow each other
# the output looks back along the world's z, for the wheel on it does; its origin lies 7 mm above the wheel
OUTPUT = WHEEL + np.array([0.0, 0.0, 7.0])
APEX = OUTPUT - np.array([0.0, 0.0, 60.0])
CENTRES = {"pinion": PINION, "idler": IDLER, "wheel": WHEEL, "bevel driver": APEX, "bevel driven": APEX}


@pytest.mark.slow
def test_gears_stand_where_azimuths_offsets_and_facings_put_them(train: WholeTrain) -> None:
    poses = {part.name: part.world_from_gear for part in train.gears}
    assert set(poses) == set(CENTRES)
    for name, centre in CENTRES.items():
        # the idler's eccentricity: beyond 6 scales of 5 um one Rayleigh draw in 10^7 lies
        assert poses[name][:3, 3] == pytest.approx(centre, abs=0.03 if name == "idler" else 1e-9)
        if name != "bevel driven":
            assert poses[name][:3, 2] == pytest.approx([0, 0, 1], abs=1e-9)
    assert poses["bevel driven"][:3, 2] @ poses["bevel driver"][:3, 2] == pytest.approx(0.0, abs=1e-9)


def test_a_gear_and_its_shaft_are_turned_alike(train: WholeTrain) -> None:
    poses = {part.name: part.world_from_gear for part in train.gears}
    bodies = {body.name: body.world_from_part for body in train.bodies}
    over = np.diag([1.0, -1.0, -1.0])
    for gear, shaft, facing, phase in (
        ("pinion", "input", np.eye(3), 20 * DEG),
        ("wheel", "output", over, 11 * DEG),
        ("bevel driver", "output", over, 0.0),
        ("bevel driven", "flange", np.eye(3), 0.0),
    ):
        expected = bodies[shaft][:3, :3] @ facing @ turned(phase)
        assert poses[gear][:3, :3] == pytest.approx(expected, abs=1e-9)


def test_an_arm_stands_at_0_with_the_motor_and_keeps_its_place_on_its_shaft(run: Run, train: WholeTrain) -> None:
    """However the teeth lie to the shaft: they turn the flange by some angle before the motor has turned at all."""
    (nominal,) = whole_trains(seated_build(*build_of(run, "nominal")))
    seen = []
    for one in (nominal, train):
        poses = {body.name: body.world_from_part for body in one.bodies}
        seen.append(np.linalg.inv(poses["flange"]) @ poses["arm"])
    assert seen[0] == pytest.approx(seen[1], abs=1e-9)
    arm = next(body.world_from_part for body in nominal.bodies if body.name == "arm")
    bevel = next(part.world_from_gear for part in nominal.gears if part.name == "bevel driven")
    assert arm[:3, 3] == pytest.approx(APEX, abs=1e-9)
    assert arm[:3, 2] == pytest.approx(bevel[:3, 2], abs=1e-9)
    # both bevel gears' frames at rest have their mesh at azimuth 0: x of the driven one goes towards the driver's z
    driver = next(part.world_from_gear for part in nominal.gears if part.name == "bevel driver")
    assert arm[:3, 0] == pytest.approx(driver[:3, 2], abs=2e-3)  # rad; the sheet's backlash of the gearbox


def test_the_tip_is_where_the_arm_ends(train: WholeTrain) -> None:
    arm = next(body.world_from_part for body in train.bodies if body.name == "arm")
    tip = arm[:3, :3] @ [50.0, 90.0, 60.0] + arm[:3, 3]
    assert train.points.keys() == {"tip of arm"}
    assert train.points["tip of arm"] == pytest.approx(tip, abs=1e-9)
    vertices, _ = train.meshes["arm"]
    radius = next(body.shape.diameter for body in train.bodies if body.name == "arm") * 0.6
    reach = np.linalg.norm(vertices - tip, axis=1)
    assert reach.min() == pytest.approx(radius, rel=1e-2)  # the ball at the tip
    direction, place = known(train.gravity)
    assert direction.tolist() == [0.0, -1.0, 0.0]
    assert place == pytest.approx(tip, abs=1e-9)  # no centre of mass is told


def hierarchy(mesh: trimesh.Trimesh) -> fcl.BVHModel:
    model = fcl.BVHModel()
    model.beginModel(len(mesh.vertices), len(mesh.faces))
    model.addSubModel(np.asarray(mesh.vertices), np.asarray(mesh.faces))
    model.endModel()
    return model


def free_distance(
    first: trimesh.Trimesh, second: trimesh.Trimesh, centre: np.ndarray, axis: np.ndarray, by: float
) -> float:
    """Distance [mm] of two meshes after the second is turned about an axis; at most 0 where they overlap."""
    motion = trimesh.transformations.rotation_matrix(by, axis, centre)
    pair = (
        fcl.CollisionObject(hierarchy(first), fcl.Transform()),
        fcl.CollisionObject(hierarchy(second), fcl.Transform(motion[:3, :3], motion[:3, 3])),
    )
    if fcl.collide(*pair, fcl.CollisionRequest(), fcl.CollisionResult()):
        return -1.0
    return float(fcl.distance(*pair, fcl.DistanceRequest(), fcl.DistanceResult()))


def exported(run: Run, folder: Path) -> dict[str, trimesh.Trimesh]:
    """Parts of a GLB file, in mm."""
    (path,) = export_run(run, TRIAL, "glb", out=folder).files
    scene = trimesh.load_scene(path)
    return {
        name: scene.geometry[scene.graph[name][1]].copy().apply_transform(scene.graph[name][0]).apply_scale(1000)
        for name in scene.graph.nodes_geometry
    }


@pytest.mark.slow
@pytest.mark.parametrize("name", MESHES)
def test_teeth_mesh_in_the_one_world(run: Run, train: WholeTrain, tmp_path: Path, name: str) -> None:
    """Turned back by half of its play the driven gear stands free on both sides by half of the normal backlash.

    Turned the other way it digs in: so the working flanks touched, and the trial's own column says how far the
    others were apart. The idler is one body in two meshes.
    """
    driver, driven = MESHES[name]
    parts, part = exported(run, tmp_path), next(part for part in train.gears if part.name == driven)
    column = {"first": "first backlash", "second": "second backlash", "bevels": "bevel backlash"}[name]
    gap = run.columns(f"geometric:{column}")[f"geometric:{column}"][TRIAL] / 1000
    arm = part.gear.section_arm if name == "bevels" else part.gear.base_radius
    pose = part.world_from_gear
    half = [
        free_distance(parts[driver], parts[driven], pose[:3, 3], pose[:3, 2], sense * gap / 2 / arm)
        for sense in (-1, 1)
    ]
    assert min(half) == -1.0
    if name == "bevels":  # an arm that grows along the face: near the toe the same turn opens less
        assert 0.6 * gap / 2 < max(half) < 1.02 * gap / 2
    else:  # the display meshes' chords, and float32 in GLB: 4 nm at 35 mm
        assert max(half) == pytest.approx(gap / 2, abs=2 * DISPLAY_DEFLECTION + 1e-4)
    assert gap > 0.02


# files ----------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_step_file_holds_every_part_once(run: Run, train: WholeTrain, tmp_path: Path) -> None:
    cadquery = pytest.importorskip("cadquery")
    (path,) = export_run(run, TRIAL, "step", out=tmp_path).files
    assert path.name == f"trial-{TRIAL}.step"
    found = cadquery.Assembly.importStep(str(path))
    parts = {name: node for name, node in found.objects.items() if node.obj is not None}
    assert set(parts) == set(CENTRES) | BODIES
    for part in train.gears:
        solid = parts[part.name].obj.moved(parts[part.name].loc)
        assert solid.isValid()
        # a gear's centre of mass lies on its axis
        centre = np.array(solid.Center().toTuple())
        off = np.cross(centre - part.world_from_gear[:3, 3], part.world_from_gear[:3, 2])
        assert np.linalg.norm(off) < 1e-3
    for name in ("pinion", "idler", "wheel"):
        gear = of_kind(SpurGear, next(part.perturbed for part in train.gears if part.name == name))
        exact = (gear.transverse_area - math.pi * gear.bore**2 / 4) * gear.face_width
        assert parts[name].obj.Volume() == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("ending", ["stl", "ply"])
def test_one_mesh_file_holds_all_parts(run: Run, train: WholeTrain, tmp_path: Path, ending: str) -> None:
    (path,) = export_run(run, TRIAL, ending, out=tmp_path).files
    assert path.name == f"trial-{TRIAL}.{ending}"
    whole = trimesh.load_mesh(path)
    volumes = [trimesh.Trimesh(*mesh, process=False).volume for mesh in train.meshes.values()]
    assert whole.volume == pytest.approx(sum(volumes), rel=1e-4)  # STL keeps single precision
    every = np.concatenate([vertices for vertices, _ in train.meshes.values()])
    assert whole.bounds == pytest.approx(np.stack([every.min(axis=0), every.max(axis=0)]), abs=1e-3)


def test_parts_of_one_shaft_share_a_colour_and_no_two_shafts_do(train: WholeTrain) -> None:
    on = {
        "motor": ["motor"],
        "input": ["input", "pinion"],
        "idler": ["idler"],
        "output": ["output", "wheel", "bevel driver"],
        "flange": ["flange", "bevel driven", "arm"],
    }
    colours = {shaft: {train.colours[part] for part in parts} for shaft, parts in on.items()}
    assert all(len(own) == 1 for own in colours.values())
    assert len(set.union(*colours.values())) == len(on)
    assert train.colours["gearbox"] == HOUSING_COLOUR


# sizes that the scene leaves open -------------------------------------------------------------------


def heights(train: WholeTrain, name: str) -> tuple[float, float]:
    """From where to where a part reaches along the world's z [mm]."""
    z = train.meshes[name][0][:, 2]
    return z.min(), z.max()


def test_shafts_reach_over_their_gears_and_fill_their_bores(train: WholeTrain) -> None:
    bodies = {body.name: body.shape for body in train.bodies}
    assert bodies["input"].diameter == 6.0  # as stated
    assert bodies["output"].diameter == 12.0  # the wheel's bore
    # the input: the pinion's faces at 5 -+ 3 mm, and one diameter more
    assert (of_kind(ShaftBody, bodies["input"]).start, of_kind(ShaftBody, bodies["input"]).end) == pytest.approx(
        (2 - 6, 8 + 6)
    )
    assert of_kind(ShaftBody, bodies["output"]).start == pytest.approx(7 - 2.5 - 12)
    # the flange: three tenths of a pitch diameter; its bevel gear begins nearer to the apex than its pitch cone ends
    middle = bodies["flange"].diameter / 0.3 / 2
    assert 20 - 6 < middle < 20  # mm; half of the face nearer to the apex than the heel's 20 mm
    assert bodies["arm"].diameter == pytest.approx((90 + 50) / 12)


def test_motor_and_gearbox_stand_one_behind_the_other(train: WholeTrain) -> None:
    motor, gearbox, shaft = (heights(train, name) for name in ("motor", "gearbox", "input"))
    assert motor[1] == pytest.approx(gearbox[0], abs=1e-6)
    assert gearbox[1] == pytest.approx(shaft[0], abs=1e-6)
    assert motor[1] - motor[0] == pytest.approx(12.0)  # two diameters of the shaft behind
    for name in ("motor", "gearbox"):
        middle = train.meshes[name][0].mean(axis=0)
        assert middle[:2] == pytest.approx([0.0, 0.0], abs=0.1)


def test_wide_bores_are_filled_by_collars(tmp_path: Path) -> None:
    scene = tmp_path / "wide.yaml"
    scene.write_text(SCENE.replace("diameter: 6 mm", "diameter: 6 mm, start: -8 mm").replace(
        "teeth: 18, module: 1 mm, face_width: 6 mm", "teeth: 18, module: 1 mm, face_width: 6 mm, bore: 9 mm"),
        encoding="utf-8",
    )  # fmt: skip
    (train,) = whole_trains(seated_build(*build_of(run_scene(scene, out=tmp_path / "run"), "nominal")))
    shape = of_kind(ShaftBody, next(body.shape for body in train.bodies if body.name == "input"))
    assert (shape.diameter, shape.start) == (6.0, -8.0)
    assert shape.collars == ((9.0, 2.0, 8.0),)


# pictures -------------------------------------------------------------------------------------------


@pytest.mark.slow
@renders
def test_the_picture_shows_every_shaft_in_its_colour_beside_the_close_ups(
    run: Run, train: WholeTrain, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    picture = tmp_path / "train.png"
    notes = view_run(run, TRIAL, screenshot=picture)
    assert capfd.readouterr().err == ""
    assert notes[-1] == "close up is first, not second, bevels (choose with --mesh)"
    pixels = np.round(255 * imread(picture)[:, : int(0.66 * 1800), :3])
    for colour in set(train.colours.values()):
        wanted = np.array([*bytes.fromhex(colour[1:])])
        # labels are flat: each of its own colour, 60 x 20 pixels and more
        assert (np.abs(pixels - wanted).max(axis=2) < 3).sum() > 500


@pytest.mark.slow
@renders
def test_the_close_ups_are_those_of_the_mesh_that_was_chosen(run: Run, tmp_path: Path) -> None:
    """In the nominal build its gap is nothing but rounding: that is drawn as a point."""
    pictures = {}
    for name in (None, "first", "bevels"):
        notes = view_run(run, "nominal", screenshot=tmp_path / "chosen.png", close_up=name)
        shown = name or "first"
        others = ", ".join(mesh for mesh in MESHES if mesh != shown)
        assert notes[-1] == f"close up is {shown}, not {others} (choose with --mesh)"
        pictures[name] = imread(tmp_path / "chosen.png")[:, int(0.67 * 1800) :]
    assert (pictures[None] == pictures["first"]).all()
    assert (np.abs(pictures["bevels"] - pictures["first"]) > 0.2).mean() > 0.1


def test_a_mesh_that_is_not_there_is_refused_with_the_nearest(run: Run, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"^--mesh: no mesh 'bevel' is shown of this run; did you mean \"bevels\"\?$"):
        view_run(run, TRIAL, screenshot=tmp_path / "none.png", close_up="bevel")


REDUCERS = """
scene: reducers alone
parts:
  motor: {kind: shaft}
  middle: {kind: shaft}
  flange: {kind: shaft}
  arm: {kind: arm, shaft: flange, points: {tip: [300 mm, 0 mm, 60 mm]}}
moves:
  first: {kind: reducer, driver: motor, driven: middle, ratio: 5, backlash: 1 arcmin, offset: 30 mm}
  second: {kind: reducer, driver: middle, driven: flange, ratio: 12, offset: 30 mm}
  swing: {kind: train, driven: motor, output: flange, gravity: [0, -2, 0]}
tolerances:
  play: {kind: reducer_backlash, of: second, distribution: {kind: uniform, lower: 0 arcmin, upper: 1 arcmin}}
measures:
  tip: {kind: tip_displacement, of: swing, arm: arm, point: tip}
study: {trials: 2, seed: 5}
"""


@pytest.mark.slow
@renders
def test_a_train_of_reducers_alone_is_exported_and_seen_without_a_close_up(tmp_path: Path) -> None:
    (tmp_path / "reducers.yaml").write_text(REDUCERS, encoding="utf-8")
    run = run_scene(tmp_path / "reducers.yaml", out=tmp_path / "run")
    (train,) = whole_trains(seated_build(*build_of(run, "nominal")))
    reach = {name: heights(train, name) for name in ("motor", "first", "middle", "second", "flange")}
    behind = list(reach.values())
    for (_, end), (begin, _) in pairwise(behind):  # one behind the other along the one axis
        assert end == pytest.approx(begin, abs=1e-6)
    # the arm is 300 mm long, so 25 mm thick; the flange goes through its hub, 0.7 of that on either side
    assert reach["flange"] == pytest.approx((60 + 60 - 17.5, 60 + 60 + 17.5))
    assert view_run(run, "nominal", screenshot=tmp_path / "reducers.png") == ()
    pixels = np.round(255 * imread(tmp_path / "reducers.png")[..., :3])
    wanted = np.array([*bytes.fromhex(train.colours["arm"][1:])])
    assert (np.abs(pixels - wanted).max(axis=2) < 3).sum() > 500


LONE_PAIR = """
  lone: {kind: spur_gear, teeth: 18, module: 1 mm, face_width: 6 mm}
  mate: {kind: spur_gear, teeth: 28, module: 1 mm, face_width: 6 mm}
moves:
  lone pair: {kind: mesh, driver: lone, driven: mate, centre_distance: 23.02 mm, working_flank: left}"""


@pytest.mark.slow
@renders
def test_trees_of_shafts_that_nothing_connects_are_files_of_their_own(tmp_path: Path) -> None:
    (tmp_path / "two.yaml").write_text(SCENE.replace("\nmoves:", LONE_PAIR), encoding="utf-8")
    run = run_scene(tmp_path / "two.yaml", out=tmp_path / "run")
    files = export_run(run, 0, "glb", out=tmp_path).files
    assert [path.name for path in files] == ["trial-0-motor.glb", "trial-0-lone.glb"]
    held = [set(trimesh.load_scene(path).graph.nodes_geometry) for path in files]
    assert held == [set(CENTRES) | BODIES, {"lone", "mate"}]
    assert view_run(run, 0, screenshot=tmp_path / "two.png") == (
        "close up is first, not lone pair, second, bevels (choose with --mesh)",
        "shown are the shafts downstream of motor, not those of lone",
    )
    assert view_run(run, 0, screenshot=tmp_path / "lone.png", close_up="lone pair") == (
        "close up is lone pair, not first, second, bevels (choose with --mesh)",
        "shown are the shafts downstream of lone, not those of motor",
    )
