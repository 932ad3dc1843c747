"""The CAD solid of a bevel gear, held against lines of rolled planes and integrals over the sphere."""

import dataclasses
import itertools
import math
from collections.abc import Mapping
from pathlib import Path

import cadquery as cq
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from OCP.BRepAdaptor import BRepAdaptor_Surface
from of_kind import of_kind
from oracles import bevel_brute_force, rolling_plane
from oracles.plain import plain_bevel
from scipy.integrate import quad

from tol3d.errors import GeometryError
from tol3d.gears import LEFT, RIGHT, BevelGear, pitch_angles
from tol3d.gears.flank import Flank
from tol3d.parts.bevel_cones import BACK_RIM, FRONT_RIM, RIM_SHARE
from tol3d.parts.bevel_flank import FLANK_ERROR, flank_intervals, sample_flank
from tol3d.parts.bevel_gear import build
from tol3d.parts.named_solid import to_step
from tol3d.parts.tooth_edges import flank_name

DEG = math.pi / 180
ALPHA = 20 * DEG
FLANK_BOUND = 1e-5  # mm; 0.01 um, what measuring strips are allowed
SIDES = {RIGHT: "right", LEFT: "left"}


def of_pair(teeth: tuple[int, int], degrees: float, which: int, **more: float) -> BevelGear:
    delta = pitch_angles(*teeth, degrees * DEG)[which]
    return BevelGear(teeth[which], 2.5, ALPHA, 10.0, delta, **more)


PAPER = BevelGear(31, 3.5, ALPHA, 9.0, 45 * DEG, bore=30.0)  # root cone just above the base cone
GEARS = {
    "paper": PAPER,
    "17 of 17/43 at 90 deg, root below base": of_pair((17, 43), 90, 0, bore=8.0),
    "43 of 17/43 at 90 deg, no bore": of_pair((17, 43), 90, 1),
    "20 of 20/30 at 60 deg": of_pair((20, 30), 60, 0, profile_shift=0.2, bore=6.0),
    "30 of 20/30 at 60 deg": of_pair((20, 30), 60, 1, profile_shift=-0.2, bore=20.0),
    "25 of 25/25 at 120 deg": of_pair((25, 25), 120, 0),
    "three teeth": BevelGear(3, 2.5, ALPHA, 2.0, 45 * DEG, addendum=0.5),
    "wide face": BevelGear(14, 2.0, 25 * DEG, 15.0, 40 * DEG, profile_shift=0.3),
    "nearly a spur gear": BevelGear(40, 2.0, ALPHA, 10.0, 1.2 * DEG),
    "coarse": BevelGear(24, 20.0, ALPHA, 60.0, 50 * DEG, profile_shift=-0.3, bore=100.0),
    "hardly any room round the bore": BevelGear(31, 3.5, ALPHA, 9.0, 45 * DEG, bore=90.0),
}
SHORT = ("paper", "17 of 17/43 at 90 deg, root below base", "three teeth", "nearly a spur gear")
each_gear = pytest.mark.parametrize(
    "gear",
    [pytest.param(gear, id=name, marks=() if name in SHORT else pytest.mark.slow) for name, gear in GEARS.items()],
)


def cone_angles(gear: BevelGear) -> tuple[float, float, float]:
    """Tip, root and base angle [rad] from the gear's plain numbers."""
    outer = gear.module * gear.teeth / 2 / math.sin(gear.pitch_angle)
    tip = math.atan(gear.module * (gear.addendum + gear.profile_shift) / outer)
    root = math.atan(gear.module * (gear.dedendum - gear.profile_shift) / outer)
    base = math.asin(math.sin(gear.pitch_angle) * math.cos(gear.pressure_angle))
    return gear.pitch_angle + tip, gear.pitch_angle - root, base


def end_corners(gear: BevelGear, which: int) -> list[tuple[float, float]]:
    """Radius and height [mm] of the root and of the blank's rim on front (0) or back cone (1)."""
    outer = gear.module * gear.teeth / 2 / math.sin(gear.pitch_angle)
    distance = (outer - gear.face_width, outer)[which]
    sin, cos = math.sin(gear.pitch_angle), math.cos(gear.pitch_angle)
    depth = distance * math.tan(gear.pitch_angle - cone_angles(gear)[1])
    room = (distance * sin - depth * cos - gear.bore / 2) / cos
    rim = depth + min((FRONT_RIM, BACK_RIM)[which] * gear.module * distance / outer, RIM_SHARE * room)
    return [(distance * sin - below * cos, distance * cos + below * sin) for below in (depth, rim)]


def blank_volume(gear: BevelGear) -> float:
    """Volume [mm^3] below the root cone: frustums of the lines of its meridian section."""
    (root_toe, rim_toe), (root_heel, rim_heel) = (end_corners(gear, which) for which in (0, 1))
    bore = gear.bore / 2
    section = [(bore, rim_toe[1]), rim_toe, root_toe, root_heel, rim_heel, (bore, rim_heel[1])]
    frustums = (
        (z2 - z1) * (r1 * r1 + r1 * r2 + r2 * r2) * math.pi / 3
        for (r1, z1), (r2, z2) in zip(section, section[1:] + section[:1], strict=True)
    )
    return sum(frustums)


def teeth_volume(gear: BevelGear) -> float:
    """Volume [mm^3] above the root cone: (R_e^3 - R_i^3)/3 of the solid angle of the teeth, the ends upright.

    At the polar angle a, front and back cone lie at R/cos(a - delta) from the apex, and a tooth is as wide as the
    lines of its rolled planes stand apart.
    """
    tip, root, base = cone_angles(gear)
    start = plain_bevel(gear).start

    def width(polar: float) -> float:
        if polar <= base:
            return 2 * start
        roll = math.acos(min(1.0, math.cos(polar) / math.cos(base))) / math.sin(base)
        x, y, _ = bevel_brute_force.line(base, roll, 0.0, RIGHT).direction
        return 2 * (start - math.atan2(y, x))

    def ring(polar: float) -> float:
        return width(polar) * math.sin(polar) / math.cos(polar - gear.pitch_angle) ** 3

    corners = [root, base, tip] if root < base else [root, tip]
    parts = (quad(ring, low, high, epsabs=0.0, epsrel=1e-11)[0] for low, high in itertools.pairwise(corners))
    outer = gear.module * gear.teeth / 2 / math.sin(gear.pitch_angle)
    return gear.teeth * (outer**3 - (outer - gear.face_width) ** 3) / 3 * sum(parts)


def expected_faces(gear: BevelGear) -> set[str]:
    """Faces of the gear, from its cones alone."""
    _, root, base = cone_angles(gear)
    kinds = ["flank"] + (["radial"] if root < base else [])
    names = {f"tooth {k} {side} {kind}" for k in range(gear.teeth) for side in ("right", "left") for kind in kinds}
    names |= {f"tooth {k} {kind}" for k in range(gear.teeth) for kind in ("tip", "toe", "heel")}
    names |= {f"space {k} root" for k in range(gear.teeth)} | {"front face", "mounting face"}
    return names | ({"bore"} if gear.bore else set())


def flank_deviation(gear: BevelGear, faces: Mapping[str, cq.Face], tooth: int, flank: Flank, samples: int) -> float:
    """Largest distance [mm] of a flank's face from the lines of the rolled plane, at toe and heel."""
    surface = BRepAdaptor_Surface(faces[flank_name(tooth, flank)].wrapped)
    numbers, worst = plain_bevel(gear), 0.0
    begin, end = numbers.rolls
    rolls = np.linspace(begin, end, samples)
    for reach in numbers.face:
        points = [surface.Value(roll * math.sin(numbers.base_angle), reach).Coord() for roll in rolls.tolist()]
        exact = numbers.flank_points(np.array(reach), rolls, tooth, flank)
        worst = max(worst, float(np.linalg.norm(np.array(points) - exact, axis=1).max()))
    return worst


@pytest.mark.slow
@each_gear
def test_volume_is_the_integral_over_the_teeth_and_the_blank_within_1_ppm(gear: BevelGear) -> None:
    part = build(gear)
    assert part.solid.isValid()
    assert part.solid.ShapeType() == "Solid"
    assert part.solid.Volume() == pytest.approx(teeth_volume(gear) + blank_volume(gear), rel=1e-6)
    # the teeth alone hold it too, as far as the blank can be taken away
    assert part.solid.Volume() - blank_volume(gear) == pytest.approx(teeth_volume(gear), rel=1e-6)


@each_gear
def test_flank_faces_are_true_between_their_spline_points(gear: BevelGear) -> None:
    faces = build(gear).faces
    samples = 12 * flank_intervals(gear) + 1
    for tooth, flank in ((0, RIGHT), (0, LEFT), (gear.teeth // 2, LEFT), (gear.teeth - 1, RIGHT)):
        # the oracle's own digits: 1e-13 of the distance from the apex
        assert flank_deviation(gear, faces, tooth, flank, samples) < FLANK_ERROR + 1e-13 * gear.outer_cone_distance
    assert FLANK_ERROR < FLANK_BOUND


@pytest.mark.parametrize("flank", [RIGHT, LEFT], ids=["right", "left"])
def test_flank_faces_are_drawn_by_a_plane_that_rolls_step_by_step(flank: Flank) -> None:
    gear = GEARS["17 of 17/43 at 90 deg, root below base"]
    surface = BRepAdaptor_Surface(build(gear).faces[flank_name(5, flank)].wrapped)
    _, _, base = cone_angles(gear)
    rolls = np.linspace(0.0, gear.tip_q / math.sin(base), 40)
    drawn = rolling_plane.drawn_directions(base, rolls, flank) * gear.outer_cone_distance
    points = np.array([surface.Value(roll * math.sin(base), gear.outer_cone_distance).Coord() for roll in rolls])
    # the ODE knows no tooth: turned so that both begin together, where the flank leaves the base cone
    turn = (points[0, 0] + 1j * points[0, 1]) / abs(points[0, 0] + 1j * points[0, 1])
    around = (drawn[:, 0] + 1j * drawn[:, 1]) * turn
    assert np.abs(around - (points[:, 0] + 1j * points[:, 1])).max() < FLANK_ERROR
    assert np.abs(drawn[:, 2] - points[:, 2]).max() < FLANK_ERROR


@each_gear
def test_every_face_has_its_name(gear: BevelGear) -> None:
    part = build(gear)
    assert set(part.faces) == expected_faces(gear)
    assert len(set(part.faces.values())) == len(part.faces) == len(part.solid.Faces())
    assert set(part.faces.values()) == set(part.solid.Faces())


@pytest.mark.parametrize("name", ["17 of 17/43 at 90 deg, root below base", "paper"])
def test_names_sit_where_they_say_and_faces_look_outwards(name: str) -> None:
    gear = GEARS[name]
    faces, delta = build(gear).faces, gear.pitch_angle
    tip, root, base = cone_angles(gear)

    def seen_from(face: cq.Face, azimuth: float) -> tuple[np.ndarray, np.ndarray]:
        """Middle and normal there in the meridian frame of that azimuth: outwards, around, along the axis."""
        surface = BRepAdaptor_Surface(face.wrapped)
        u = (surface.FirstUParameter() + surface.LastUParameter()) / 2
        v = (surface.FirstVParameter() + surface.LastVParameter()) / 2
        middle = face.positionAt(u, v)
        vectors = [np.array(vector.toTuple()) for vector in (middle, face.normalAt(middle))]
        turned = [(v[0] + 1j * v[1]) * np.exp(-1j * azimuth) for v in vectors]
        at, normal = (np.array([t.real, t.imag, v[2]]) for t, v in zip(turned, vectors, strict=True))
        return at, normal

    for tooth in (0, 5, gear.teeth - 1):
        middle = 2 * math.pi * tooth / gear.teeth
        for flank, side in SIDES.items():
            for kind in ("flank", "radial") if root < base else ("flank",):
                centre, normal = seen_from(faces[f"tooth {tooth} {side} {kind}"], middle)
                # right is the low-azimuth side, within half a pitch of the tooth's middle
                assert 0 < -flank * math.atan2(centre[1], centre[0]) < math.pi / gear.teeth
                assert -flank * normal[1] > 0.5
                assert normal @ centre == pytest.approx(0.0, abs=1e-9)  # ruled from the apex
        for end, outwards in (("toe", -1), ("heel", 1)):
            centre, normal = seen_from(faces[f"tooth {tooth} {end}"], middle)
            assert math.atan2(centre[1], centre[0]) == pytest.approx(0.0, abs=1e-9)
            assert normal == pytest.approx(outwards * np.array([math.sin(delta), 0, math.cos(delta)]), abs=1e-9)
        centre, normal = seen_from(faces[f"tooth {tooth} tip"], middle)
        assert normal == pytest.approx([math.cos(tip), 0, -math.sin(tip)], abs=1e-9)
        centre, normal = seen_from(faces[f"space {tooth} root"], middle + math.pi / gear.teeth)
        assert normal == pytest.approx([math.cos(root), 0, -math.sin(root)], abs=1e-9)
    for name, along, which in (("front face", -1, 0), ("mounting face", 1, 1)):
        assert faces[name].normalAt().toTuple() == pytest.approx((0, 0, along))
        assert faces[name].Center().z == pytest.approx(end_corners(gear, which)[1][1])
    x, y, z = faces["bore"].positionAt(0.3, 0.1).toTuple()
    normal = faces["bore"].normalAt(cq.Vector(x, y, z)).toTuple()
    assert normal == pytest.approx((-2 * x / gear.bore, -2 * y / gear.bore, 0), abs=1e-6)


@each_gear
def test_teeth_end_on_cones_upright_on_the_pitch_line_and_on_the_tip_cone(gear: BevelGear) -> None:
    part, (tip, _, _) = build(gear), cone_angles(gear)
    outer = gear.module * gear.teeth / 2 / math.sin(gear.pitch_angle)
    for end, distance in (("toe", outer - gear.face_width), ("heel", outer)):
        for edge in part.faces[f"tooth 1 {end}"].Edges():
            x, y, z = np.array([edge.positionAt(t).toTuple() for t in np.linspace(0, 1, 21)]).T
            along = math.sin(gear.pitch_angle) * np.hypot(x, y) + math.cos(gear.pitch_angle) * z
            assert np.abs(along - distance).max() < 2 * FLANK_ERROR + 1e-12 * outer
    for edge in part.faces["tooth 1 tip"].Edges():
        x, y, z = np.array([edge.positionAt(t).toTuple() for t in np.linspace(0, 1, 21)]).T
        assert np.abs(np.arctan2(np.hypot(x, y), z) - tip).max() < 1e-12


def test_parameters_of_a_flank_are_in_plane_angle_and_cone_distance() -> None:
    surface = BRepAdaptor_Surface(build(PAPER).faces["tooth 3 left flank"].wrapped)
    assert surface.FirstUParameter() == pytest.approx(PAPER.form_q, abs=1e-12)
    assert surface.LastUParameter() == pytest.approx(PAPER.tip_q, abs=1e-12)
    base = cone_angles(PAPER)[2]
    for q, reach in ((0.1, 68.0), (0.25, 72.0), (0.4, 76.7)):
        point = np.array(surface.Value(q, reach).Coord())
        assert np.linalg.norm(point) == pytest.approx(reach, abs=FLANK_ERROR)
        assert point[2] == pytest.approx(reach * math.cos(q) * math.cos(base), abs=FLANK_ERROR)


@each_gear
def test_sampled_rays_and_normals_are_those_of_the_rolled_plane(gear: BevelGear) -> None:
    numbers, part = plain_bevel(gear), build(gear)
    rolls = np.linspace(*numbers.rolls, 129)
    for tooth, flank in ((0, RIGHT), (0, LEFT), (2, LEFT)):
        sample = sample_flank(
            part, tooth, flank, np.clip(rolls * math.sin(numbers.base_angle), gear.form_q, gear.tip_q)
        )
        exact = numbers.lines(rolls, tooth, flank)
        assert np.abs(np.linalg.norm(sample.directions, axis=1) - 1).max() < 1e-14
        assert np.abs(sample.directions - exact.direction).max() * gear.outer_cone_distance < 2 * FLANK_ERROR
        # a cubic spline's slope errs by h^3 where the spline errs by h^4; near the base cone it is all but zero
        assert np.abs(sample.normals - exact.outwards).max() < 1e-4
        assert np.abs((sample.normals * sample.directions).sum(axis=1)).max() < 1e-12


def test_blank_has_a_bore_and_flat_faces_where_the_rims_end() -> None:
    part, bore = build(PAPER), PAPER.bore / 2
    (_, front), (_, back) = (end_corners(PAPER, which) for which in (0, 1))
    assert part.faces["front face"].Area() == pytest.approx(math.pi * (front[0] ** 2 - bore**2), rel=1e-9)
    assert part.faces["mounting face"].Area() == pytest.approx(math.pi * (back[0] ** 2 - bore**2), rel=1e-9)
    assert part.faces["bore"].Area() == pytest.approx(2 * math.pi * bore * (back[1] - front[1]), rel=1e-9)
    # the mounting face is the rearmost of the gear
    assert part.solid.BoundingBox().zmax == pytest.approx(back[1], abs=1e-5)


@pytest.mark.parametrize("off", [-1e-6, 0.0, 1e-9, 1e-7, 9e-7, 1.1e-6, 1e-5, 1e-3])
def test_root_cones_hardly_below_the_base_cone_make_a_valid_solid(off: float) -> None:
    """Below a micrometre's thousandth the strip between root and base cone is left out."""
    gear = BevelGear(20, 2.5, ALPHA, 8.0, 35 * DEG)
    root = cone_angles(gear)[2] - off / gear.outer_cone_distance
    depth = math.tan(gear.pitch_angle - root) * gear.outer_cone_distance
    part = build(dataclasses.replace(gear, dedendum=depth / gear.module))
    assert ("tooth 0 left radial" in part.faces) == (off > 1e-6)
    assert len(part.solid.Faces()) == len(part.faces)


@pytest.mark.slow
def test_step_file_comes_back_as_the_same_solid(tmp_path: Path) -> None:
    part = build(PAPER)
    to_step(part, tmp_path / "bevel.step")
    again = of_kind(cq.Shape, cq.importers.importStep(str(tmp_path / "bevel.step")).val())
    assert again.ShapeType() == "Solid"
    assert again.isValid()
    assert again.Volume() == pytest.approx(part.solid.Volume(), rel=1e-9)


@pytest.mark.slow
def test_occ_can_cut_and_triangulate_the_solid() -> None:
    part = build(PAPER)
    half = cq.Solid.makeBox(200, 100, 200, cq.Vector(-100, 0, 0))
    # a plane through the middles of tooth 0 and, on the other side, of a space: half of everything
    assert part.solid.cut(half).Volume() == pytest.approx(part.solid.Volume() / 2, rel=1e-6)
    vertices, triangles = part.solid.tessellate(0.01, 0.3)
    corners = np.array([v.toTuple() for v in vertices])[np.array(triangles)]
    inside = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    assert inside == pytest.approx(part.solid.Volume(), rel=2e-3)


@pytest.mark.slow
@given(
    teeth=st.integers(3, 90),
    alpha=st.floats(14.5, 28.0),
    delta=st.floats(2.0, 82.0),
    face=st.floats(0.05, 0.8),
    shift=st.floats(-0.6, 0.8),
    addendum=st.floats(0.5, 1.2),
    dedendum=st.floats(0.9, 1.5),
    bore=st.floats(0.0, 0.99),
)
@settings(max_examples=60, deadline=None, derandomize=True)
def test_any_gear_that_can_be_made_is_one_true_solid(
    teeth: int, alpha: float, delta: float, face: float, shift: float, addendum: float, dedendum: float, bore: float
) -> None:
    outer = teeth / math.sin(delta * DEG)
    try:
        gear = BevelGear(teeth, 2.0, alpha * DEG, face * outer, delta * DEG, shift, addendum, dedendum)
        gear = dataclasses.replace(gear, bore=bore * gear.inner_root_diameter if bore > 0.05 else 0.0)
    except GeometryError:
        assume(False)
    part = build(gear)
    assert set(part.faces) == expected_faces(gear)
    assert part.solid.Volume() == pytest.approx(teeth_volume(gear) + blank_volume(gear), rel=1e-6)
    for flank in (RIGHT, LEFT):
        assert flank_deviation(gear, part.faces, teeth - 1, flank, 200) < FLANK_BOUND


@pytest.mark.slow
@pytest.mark.parametrize("teeth", [90, 200])
def test_large_wheels_hold_the_same_bounds(teeth: int) -> None:
    gear = BevelGear(teeth, 2.5, ALPHA, 30.0, 75 * DEG, bore=60.0)
    part = build(gear)
    assert part.solid.Volume() == pytest.approx(teeth_volume(gear) + blank_volume(gear), rel=1e-6)
    assert max(flank_deviation(gear, part.faces, k, LEFT, 100) for k in range(0, teeth, 10)) < 2 * FLANK_ERROR
