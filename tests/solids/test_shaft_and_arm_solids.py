"""Plain shafts and arms: their solids against closed forms, their display meshes, STEP and the cache."""

import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

import cadquery as cq
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from of_kind import known, of_kind
from scipy.integrate import quad

from tol3d.cad.solids import ArmBody, PosedBody, ShaftBody, display_mesh, export_step
from tol3d.errors import GeometryError
from tol3d.parts.arm import BALL_SHARE, HUB_HEIGHT, HUB_SHARE, arm
from tol3d.parts.named_solid import NamedSolid, to_step
from tol3d.parts.shaft import chamfer, shaft

ARM_VOLUME = 1e-4  # relative; where a bar leaves the hub OCC trims both by splines: 8e-5 of the shortest arms at most
SHAFT_FACES = {"side", "front", "back", "front chamfer", "back chamfer"}


@pytest.fixture(autouse=True)
def _own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TOL3D_CACHE", str(tmp_path / "cache"))


# closed forms ---------------------------------------------------------------------------------------


def shaft_volume(diameter: float, length: float) -> float:
    """A cylinder between two frustums of 45 degrees."""
    radius, edge = diameter / 2, chamfer(diameter, length)
    small = radius - edge
    frustum = math.pi * edge / 3 * (radius**2 + radius * small + small**2)
    return math.pi * radius**2 * (length - 2 * edge) + 2 * frustum


def hub_volume(diameter: float) -> float:
    return shaft_volume(HUB_SHARE * diameter, HUB_HEIGHT * diameter)


def bar_in_hub(diameter: float) -> float:
    """Volume common to the hub and a bar square to it, from the hub's axis outwards: chords of both sections."""
    bar, hub = diameter / 2, HUB_SHARE * diameter / 2
    return quad(lambda y: 2 * math.sqrt(bar**2 - y**2) * math.sqrt(hub**2 - y**2), -bar, bar, epsabs=1e-10)[0]


def ball_volume(diameter: float) -> float:
    return 4 / 3 * math.pi * (BALL_SHARE * diameter / 2) ** 3


def bar_in_ball(diameter: float) -> float:
    """Volume common to a ball and a bar that begins at its centre: a cylinder and a cap."""
    bar, ball = diameter / 2, BALL_SHARE * diameter / 2
    reach = math.sqrt(ball**2 - bar**2)
    cap = math.pi * (ball - reach) ** 2 * (2 * ball + reach) / 3
    return math.pi * bar**2 * reach + cap


def elbow_overlap(diameter: float) -> float:
    """Volume common to two bars that meet square outside the ball: sections are squares less a disc."""
    bar, ball = diameter / 2, BALL_SHARE * diameter / 2

    def section(z: float) -> float:
        side, disc = math.sqrt(bar**2 - z**2), math.sqrt(ball**2 - z**2)
        if disc >= side * math.sqrt(2):
            return 0.0
        begin = math.sqrt(disc**2 - side**2)
        turn = math.asin(side / disc) - math.asin(begin / disc)
        return side**2 - begin * side - disc**2 * turn / 2  # a strip and what two triangles leave of a sector

    edge = math.sqrt(2 * bar**2 - ball**2)  # where the corner of the square reaches the ball
    return 2 * quad(section, 0.0, edge, epsabs=1e-10)[0]


def straight_arm(reach: float, diameter: float) -> float:
    """Hub, one bar square to it, and a ball."""
    bar = math.pi * diameter**2 / 4 * reach
    hub = hub_volume(diameter) - bar_in_hub(diameter)
    return hub + bar + ball_volume(diameter) - bar_in_ball(diameter)


# solids ---------------------------------------------------------------------------------------------


@given(diameter=st.floats(0.5, 500.0), start=st.floats(-1e3, 1e3), length=st.floats(0.5, 2e3))
@settings(max_examples=25, deadline=None, derandomize=True)
def test_a_shaft_is_a_cylinder_between_two_frustums(diameter: float, start: float, length: float) -> None:
    part = shaft(diameter, start, start + length)
    assert part.solid.isValid()
    assert part.solid.ShapeType() == "Solid"
    assert part.solid.Volume() == pytest.approx(shaft_volume(diameter, length), rel=1e-9)
    box = part.solid.BoundingBox()
    assert (box.zmin, box.zmax) == pytest.approx((start, start + length), abs=1e-6)


def test_faces_of_a_shaft_sit_where_they_say_and_look_outwards() -> None:
    faces = shaft(30.0, -10.0, 50.0).faces
    assert set(faces) == SHAFT_FACES
    assert faces["front"].Center().toTuple() == pytest.approx((0, 0, 50), abs=1e-9)
    assert faces["front"].normalAt().toTuple() == pytest.approx((0, 0, 1))
    assert faces["back"].Center().toTuple() == pytest.approx((0, 0, -10), abs=1e-9)
    assert faces["back"].normalAt().toTuple() == pytest.approx((0, 0, -1))
    # a twentieth of the diameter is taken off each end
    assert faces["side"].Area() == pytest.approx(math.pi * 30 * (60 - 2 * 1.5))
    slant = math.pi * (15 + 13.5) * 1.5 * math.sqrt(2)
    for end, z in (("front", 49.25), ("back", -9.25)):
        assert faces[f"{end} chamfer"].Area() == pytest.approx(slant)
        assert abs(faces[f"{end} chamfer"].Center().z - z) < 0.75


def test_collars_add_their_rings_and_shoulders() -> None:
    plain = shaft(30.0, -30.0, 110.0)
    part = shaft(30.0, -30.0, 110.0, [(60.0, -10.0, 10.0), (40.0, 5.0, 25.0), (20.0, 40.0, 50.0)])
    rings = math.pi / 4 * ((60.0**2 - 30.0**2) * 20 + (40.0**2 - 30.0**2) * 15)
    assert part.solid.isValid()
    assert part.solid.Volume() == pytest.approx(plain.solid.Volume() + rings, rel=1e-9)
    sides = {f"side {number}": length for number, length in enumerate((20 - 1.5, 20, 15, 85 - 1.5), start=1)}
    assert set(part.faces) == SHAFT_FACES - {"side"} | set(sides) | {f"shoulder {number}" for number in (1, 2, 3)}
    for (name, length), wide in zip(sides.items(), (30, 60, 40, 30), strict=True):
        assert part.faces[name].Area() == pytest.approx(math.pi * wide * length)
    assert part.faces["shoulder 2"].Center().z == pytest.approx(10.0)


def test_a_collar_at_the_end_of_a_shaft_is_chamfered() -> None:
    part = shaft(30.0, 0.0, 50.0, [(60.0, 40.0, 50.0)])
    expected = shaft_volume(30.0, 50.0) + math.pi / 4 * (60.0**2 - 30.0**2) * 10
    # the chamfer moves from the shaft to the collar: rings of a triangle's section, by Pappus
    ring = {radius: math.pi * edge**2 * (radius - edge / 3) for radius, edge in ((15.0, 1.5), (30.0, 2.5))}
    assert part.solid.Volume() == pytest.approx(expected + ring[15.0] - ring[30.0], rel=1e-9)


def test_a_collar_beside_its_shaft_is_refused() -> None:
    with pytest.raises(GeometryError, match="leaves the shaft"):
        shaft(30.0, 0.0, 50.0, [(60.0, 40.0, 51.0)])


@pytest.mark.parametrize("lengths", [(0.0, 0.0, 10.0), (-5.0, 0.0, 10.0), (10.0, 5.0, 5.0), (10.0, 5.0, 4.0)])
def test_a_shaft_without_volume_is_refused(lengths: tuple[float, float, float]) -> None:
    with pytest.raises(GeometryError, match="volume"):
        shaft(*lengths)


@given(diameter=st.floats(5.0, 80.0), reach=st.floats(2.0, 30.0), turn=st.floats(0.0, 6.28), z=st.floats(-200, 200))
@settings(max_examples=8, deadline=None, derandomize=True)
def test_a_straight_arm_is_hub_bar_and_ball_less_what_they_share(
    diameter: float, reach: float, turn: float, z: float
) -> None:
    length = reach * diameter
    part = arm([(length * math.cos(turn), length * math.sin(turn), z)], diameter)
    assert part.solid.isValid()
    assert part.solid.Volume() == pytest.approx(straight_arm(length, diameter), rel=ARM_VOLUME)


def test_an_arm_with_a_square_elbow_is_its_pieces_less_what_they_share() -> None:
    part = arm([(0.0, 637.0, 90.0), (420.0, 637.0, 90.0)], 40.0)
    forearm = math.pi * 400 * 420 - 2 * bar_in_ball(40.0) + ball_volume(40.0)
    expected = straight_arm(637.0, 40.0) + forearm - elbow_overlap(40.0)
    assert elbow_overlap(40.0) > 10 * 1e-6 * expected  # so that it is seen
    assert part.solid.Volume() == pytest.approx(expected, rel=1e-6)
    assert part.solid.isValid()
    assert part.solid.ShapeType() == "Solid"


def test_every_face_of_an_arm_has_its_name_and_sits_there() -> None:
    part = arm([(0.0, 637.0, 90.0), (420.0, 637.0, 90.0)], 40.0)
    hub = {f"hub {name}" for name in SHAFT_FACES}
    assert set(part.faces) == hub | {"bar 1", "bar 2", "ball 1", "ball 2"}
    assert len(set(part.faces.values())) == len(part.faces) == len(part.solid.Faces())
    assert part.faces["hub front"].Center().toTuple() == pytest.approx((0, 0, 90 + 26), abs=1e-6)
    assert part.faces["bar 1"].Center().toTuple() == pytest.approx((0, 637 / 2, 90), abs=10)
    assert part.faces["bar 2"].Center().toTuple() == pytest.approx((210, 637, 90), abs=10)
    box = part.faces["ball 2"].BoundingBox()
    assert (box.xmax, box.ymax, box.zmax) == pytest.approx((420 + 24, 637 + 24, 90 + 24), abs=1e-3)


POINTS = {
    "on the axis": [(0.0, 0.0, 90.0)],
    "along the axis, then out": [(0.0, 0.0, 0.0), (0.0, 0.0, 100.0), (30.0, 0.0, 100.0)],
    "straight on": [(100.0, 0.0, 0.0), (300.0, 0.0, 0.0)],
    "there and back": [(100.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, -100.0, 0.0)],
    "a loop": [(100.0, 0.0, 0.0), (100.0, 0.0, 50.0), (0.0, 0.0, 50.0), (0.0, 100.0, 50.0)],
    "the same point twice": [(100.0, 0.0, 0.0), (100.0, 0.0, 0.0), (100.0, 80.0, 0.0)],
    "inside the hub": [(0.0, 5.0, 0.0)],
}
each_arm = pytest.mark.parametrize("points", POINTS.values(), ids=POINTS.keys())


@each_arm
def test_any_arm_is_one_true_solid_of_named_faces(points: Sequence[tuple[float, float, float]]) -> None:
    part = arm(points, 40.0)
    assert part.solid.isValid()
    assert part.solid.ShapeType() == "Solid"
    assert set(part.faces.values()) == set(part.solid.Faces())
    assert len(part.faces) == len(part.solid.Faces())
    # no larger than its pieces together, and no smaller than the hub and its longest bar outside the hub
    spans = [math.dist(a, b) for a, b in zip([(0.0, 0.0, points[0][2]), *points], points, strict=False)]
    bars = math.pi * 400 * np.array(spans)
    assert part.solid.Volume() <= hub_volume(40.0) + bars.sum() + len(points) * ball_volume(40.0)
    assert part.solid.Volume() >= max(hub_volume(40.0), bars.max())


def test_an_arm_of_nothing_is_refused() -> None:
    with pytest.raises(GeometryError, match="points"):
        arm([], 40.0)
    with pytest.raises(GeometryError, match="diameter"):
        arm([(1.0, 0.0, 0.0)], 0.0)


def step_again(part: NamedSolid, path: Path) -> cq.Shape:
    to_step(part, path)
    again = of_kind(cq.Shape, cq.importers.importStep(str(path)).val())
    assert again.ShapeType() == "Solid"
    assert again.isValid()
    return again


def test_a_shaft_s_step_file_comes_back_as_the_same_solid(tmp_path: Path) -> None:
    part = shaft(25.0, -30.0, 110.0)
    assert step_again(part, tmp_path / "shaft.step").Volume() == pytest.approx(part.solid.Volume(), rel=1e-9)


@each_arm
def test_an_arm_s_step_file_comes_back_as_the_same_solid(
    tmp_path: Path, points: list[tuple[float, float, float]]
) -> None:
    part = arm(points, 40.0)
    assert step_again(part, tmp_path / "arm.step").Volume() == pytest.approx(part.solid.Volume(), rel=ARM_VOLUME)


def points_after(bars: list[tuple[float, float, float]]) -> list[tuple[float, float, float]]:
    """Ends of bars by their lengths, azimuths and elevations, one after the other."""
    length, azimuth, elevation = np.transpose(bars)
    level = length * np.cos(elevation)
    ends = np.cumsum(
        np.stack([level * np.cos(azimuth), level * np.sin(azimuth), length * np.sin(elevation)], axis=1), axis=0
    )
    return [(float(x), float(y), float(z)) for x, y, z in ends]


@pytest.mark.slow
@given(
    bars=st.lists(st.tuples(st.floats(40.0, 500.0), st.floats(-3.1, 3.1), st.floats(-1.5, 1.5)), min_size=1, max_size=4)
)
@settings(max_examples=40, deadline=None, derandomize=True)
def test_any_points_give_an_arm_that_comes_back_from_step(
    tmp_path_factory: pytest.TempPathFactory, bars: list[tuple[float, float, float]]
) -> None:
    """Bars of two diameters at least: a ball that nearly touches the hub from inside does not always fuse."""
    part = arm(points_after(bars), 20.0)
    again = step_again(part, tmp_path_factory.mktemp("step") / "arm.step")
    assert again.Volume() == pytest.approx(part.solid.Volume(), rel=ARM_VOLUME)


# display meshes -------------------------------------------------------------------------------------


def mesh_of(body: ShaftBody | ArmBody, deflection: float) -> tuple[trimesh.Trimesh, float]:
    found = display_mesh(body, deflection)
    assert (found.side == 0).all()
    return trimesh.Trimesh(found.vertices, found.triangles, process=False), found.chord_error


@pytest.mark.parametrize("deflection", [0.5, 0.05])
def test_a_shaft_s_mesh_lies_on_it_and_leaves_it_by_its_chord_error(deflection: float) -> None:
    mesh, chord_error = mesh_of(ShaftBody(60.0, -30.0, 110.0), deflection)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    radius = np.hypot(*mesh.vertices[:, :2].T)
    assert radius.max() == pytest.approx(30.0, abs=1e-9)
    assert mesh.bounds[:, 2] == pytest.approx([-30.0, 110.0], abs=1e-9)
    # middles of the chords of the side, from the mesh itself
    side = mesh.edges_unique[(radius[mesh.edges_unique] > 30.0 - 1e-9).all(axis=1)]
    middles = mesh.vertices[side].mean(axis=1)
    sagitta = 30.0 - np.hypot(*middles[:, :2].T).min()
    assert 0.0 < sagitta <= chord_error <= deflection
    assert 0 < shaft_volume(60.0, 140.0) - mesh.volume <= 1.01 * chord_error * mesh.area


@pytest.mark.slow
@each_arm
def test_an_arm_s_mesh_is_closed_and_as_large_as_its_chord_error_allows(
    points: list[tuple[float, float, float]],
) -> None:
    mesh, chord_error = mesh_of(ArmBody(tuple(points), 40.0), 0.2)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert 0.0 < chord_error < 0.5  # OCC keeps to what it is asked for within a factor of about two
    assert abs(mesh.volume - arm(points, 40.0).solid.Volume()) <= 1.1 * chord_error * mesh.area


def test_a_body_s_mesh_is_kept_and_read_back_without_cad(monkeypatch: pytest.MonkeyPatch) -> None:
    body = ShaftBody(60.0, -30.0, 110.0)
    built = display_mesh(body, 0.2)

    def refuse() -> NoReturn:
        raise AssertionError("built again")

    monkeypatch.setattr(sys.modules["tol3d.cad.solids.display_mesh"], "cad", refuse)
    again = display_mesh(body, 0.2)
    assert np.array_equal(built.vertices, again.vertices)
    assert np.array_equal(built.triangles, again.triangles)
    for other in (ShaftBody(60.0, -30.0, 111.0), ArmBody(((60.0, -30.0, 110.0),), 20.0)):
        with pytest.raises(AssertionError, match="built again"):
            display_mesh(other, 0.2)


def test_a_step_assembly_takes_shafts_and_arms_at_their_poses(tmp_path: Path) -> None:
    pose = np.eye(4)
    pose[:3, :3] = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    pose[:3, 3] = 5.0, 6.0, 7.0
    parts = [
        PosedBody("shaft", ShaftBody(25.0, -30.0, 110.0), np.eye(4)),
        PosedBody("arm", ArmBody(((0.0, 300.0, 90.0),), 40.0), pose),
    ]
    export_step(parts, tmp_path / "both.step", ("#336699", "#993366"))
    found = cq.Assembly.importStep(str(tmp_path / "both.step")).objects
    assert of_kind(cq.Shape, found["shaft"].obj).Volume() == pytest.approx(shaft_volume(25.0, 140.0), rel=1e-9)
    assert of_kind(cq.Shape, found["arm"].obj).Volume() == pytest.approx(straight_arm(300.0, 40.0), rel=ARM_VOLUME)
    tip = cq.Vertex.makeVertex(0, 300, 90).moved(found["arm"].loc).toTuple()
    assert tip == pytest.approx(pose[:3, :3] @ [0, 300, 90] + pose[:3, 3], abs=1e-9)
    colours = [np.round(255 * np.array(known(found[name].color).toTuple()[:3])).tolist() for name in ("shaft", "arm")]
    assert colours == [[0x33, 0x66, 0x99], [0x99, 0x33, 0x66]]
