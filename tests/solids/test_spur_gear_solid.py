"""The CAD solid of a spur gear, held against a rack that never heard of involutes or base circles."""

import dataclasses
import math
from pathlib import Path

import cadquery as cq
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from OCP.BRepAdaptor import BRepAdaptor_Surface
from of_kind import of_kind

from tol3d.errors import GeometryError
from tol3d.gears import LEFT, RIGHT, SpurGear
from tol3d.gears.flank import Flank
from tol3d.parts.named_solid import NamedEdge, extruded, to_step
from tol3d.parts.spur_gear import build
from tol3d.parts.tooth_edges import FLANK_ERROR, flank_intervals, flank_name

DEG = math.pi / 180
FLANK_BOUND = 1e-5  # mm; 0.01 um, what measuring strips are allowed
SIDES = {RIGHT: "right", LEFT: "left"}

PINION = SpurGear(28, 2.5, 20 * DEG, 20.0, bore=20.0)  # radial line under the base circle
GEARS = {
    "radial line and bore": PINION,
    "fillet on the involute": SpurGear(42, 2.5, 20 * DEG, 20.0),
    "full round": SpurGear(12, 2.5, 25 * DEG, 20.0, profile_shift=0.6),
    "stated full round": SpurGear(
        15, 1.0, 20 * DEG, 5.0, root_fillet=SpurGear(15, 1.0, 20 * DEG, 5.0).full_round_fillet
    ),
    "three teeth": SpurGear(3, 2.5, 20 * DEG, 20.0, profile_shift=0.3, addendum=0.5),
    "thin fillet, thin teeth": SpurGear(17, 0.3, 14.5 * DEG, 2.0, root_fillet=0.02, tooth_thickness_deviation=-0.05),
    "coarse, negative shift": SpurGear(24, 20.0, 20 * DEG, 150.0, profile_shift=-0.3, bore=100.0),
}
each_gear = pytest.mark.parametrize("gear", GEARS.values(), ids=GEARS.keys())


def rack_flank(gear: SpurGear, radius: np.ndarray, flank: Flank) -> np.ndarray:
    """Points of tooth 0 at given radii, from the straight flank of the rack that would cut it.

    The rack's flank stands at the pressure angle and moves along the pitch line x = r while the gear
    turns; they touch where the normal through the pitch point (r, 0) meets it, a distance d away.
    The foot has the radius R with R^2 = r^2 + 2 r d sin(alpha) + d^2; solved for d it says how far
    the rack has moved, s = S/2 - d/cos(alpha), and so how far the gear has turned, s/r.
    """
    r, alpha = gear.module * gear.teeth / 2, gear.pressure_angle
    thickness = gear.module * (math.pi / 2 + 2 * gear.profile_shift * math.tan(alpha)) + gear.tooth_thickness_deviation
    # at the base circle the root vanishes and rounding may carry it below zero
    d = -r * math.sin(alpha) + np.sqrt(np.maximum((r * math.sin(alpha)) ** 2 + radius**2 - r**2, 0.0))
    contact = (r + d * math.sin(alpha)) - 1j * d * math.cos(alpha)
    right = contact * np.exp(-1j * (thickness / 2 - d / math.cos(alpha)) / r)
    return np.stack([right.real, flank * right.imag], axis=-1)


def azimuths(points: np.ndarray, centre: tuple[float, float]) -> np.ndarray:
    return np.arctan2(points[:, 1] - centre[1], points[:, 0] - centre[0])


def polygon_area(gear: SpurGear, points_each: int) -> float:
    """Shoelace area of one pitch from rack flanks and chords of the fillet, tip and root circles, times z."""

    def arc(centre: tuple[float, float], begin: np.ndarray, end: np.ndarray) -> np.ndarray:
        first, last = azimuths(np.array([begin, end]), centre)
        angle = first + math.remainder(last - first, 2 * math.pi) * np.linspace(0, 1, points_each)
        return np.array(centre) + math.dist(begin, centre) * np.stack([np.cos(angle), np.sin(angle)], axis=-1)

    radii = np.hypot(*gear.flank_points(np.linspace(gear.form_roll, gear.tip_roll, points_each), RIGHT).T)
    right, left = rack_flank(gear, radii, RIGHT), rack_flank(gear, radii, LEFT)
    pitch = 2 * math.pi / gear.teeth
    turn = np.array([[math.cos(pitch), math.sin(pitch)], [-math.sin(pitch), math.cos(pitch)]])
    parts = [
        arc(gear.fillet_centre(RIGHT), np.array(gear.fillet_bottom(RIGHT)), np.array(gear.fillet_top(RIGHT))),
        right,
        arc((0.0, 0.0), right[-1], left[-1]),
        left[::-1],
        arc(gear.fillet_centre(LEFT), np.array(gear.fillet_top(LEFT)), np.array(gear.fillet_bottom(LEFT))),
        arc((0.0, 0.0), np.array(gear.fillet_bottom(LEFT)), np.array(gear.fillet_bottom(RIGHT)) @ turn),
    ]
    x, y = np.concatenate(parts).T
    return gear.teeth * float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])) / 2


def expected_faces(gear: SpurGear) -> set[str]:
    """Faces of the section, from its radii alone."""
    reach = math.hypot(gear.base_radius, gear.fillet_radius)  # centre of a fillet that touches at the base circle
    kinds = ["flank", "fillet"] + (["radial"] if gear.root_radius + gear.fillet_radius < reach else [])
    names = {f"tooth {k} {side} {kind}" for k in range(gear.teeth) for side in ("right", "left") for kind in kinds}
    names |= {f"tooth {k} tip" for k in range(gear.teeth)} | {"front", "back"}
    if gear.fillet_radius < gear.full_round_fillet - 1e-6:
        names |= {f"space {k} root" for k in range(gear.teeth)}
    return names | ({"bore"} if gear.bore else set())


def flank_deviation(gear: SpurGear, faces: dict[str, cq.Face], tooth: int, flank: Flank, samples: int) -> float:
    """Largest distance [mm] of a flank's face from the rack's flank, at all three of its heights."""
    surface = BRepAdaptor_Surface(faces[flank_name(tooth, flank)].wrapped)
    worst = 0.0
    for v in np.linspace(surface.FirstVParameter(), surface.LastVParameter(), 3):
        points = [surface.Value(u, v) for u in np.linspace(gear.form_roll, gear.tip_roll, samples)]
        found = np.array([p.X() + 1j * p.Y() for p in points]) * np.exp(-2j * math.pi * tooth / gear.teeth)
        exact = rack_flank(gear, np.abs(found), flank)
        worst = max(worst, np.hypot(found.real - exact[:, 0], found.imag - exact[:, 1]).max())
    return worst


@each_gear
def test_volume_is_the_exact_section_times_the_width_within_1_ppm(gear: SpurGear) -> None:
    part = build(gear)
    section = gear.transverse_area - math.pi * gear.bore**2 / 4
    assert part.solid.isValid()
    assert part.solid.ShapeType() == "Solid"
    assert part.solid.Volume() == pytest.approx(section * gear.face_width, rel=1e-6)
    box = part.solid.BoundingBox()
    assert (box.zmin, box.zmax) == pytest.approx((-gear.face_width / 2, gear.face_width / 2), abs=1e-6)


@each_gear
def test_section_area_is_that_of_a_polygon_cut_by_a_rack(gear: SpurGear) -> None:
    # chords make the polygon's error fall by 4 at each halving: one Richardson step leaves order 4
    coarse, fine = polygon_area(gear, 501), polygon_area(gear, 1001)
    assert (4 * fine - coarse) / 3 == pytest.approx(gear.transverse_area, rel=1e-9)


@each_gear
def test_fillets_touch_flank_and_root_circle(gear: SpurGear) -> None:
    radius = gear.fillet_radius
    for flank in (RIGHT, LEFT):
        centre = np.array(gear.fillet_centre(flank))
        assert np.hypot(*centre) == pytest.approx(gear.root_radius + radius, rel=1e-12)
        along = np.linspace(0.0, 1.0, 20001)[:, None]
        first = rack_flank(gear, np.array([gear.base_radius]), flank)[0]
        above = rack_flank(gear, np.linspace(gear.base_radius, gear.tip_radius, 20001), flank)
        below = first * (gear.root_radius / gear.base_radius + along * (1 - gear.root_radius / gear.base_radius))
        line = np.concatenate([below, above]) if gear.root_radius < gear.base_radius else above
        # points 20 000 to the line: beside a tangent point a distance grows by spacing^2/(2 radius)
        spacing = np.hypot(*np.diff(line, axis=0).T).max()
        distance = np.hypot(*(line - centre).T).min()
        assert radius - 1e-9 <= distance <= radius + spacing**2 / radius


@each_gear
def test_flank_faces_are_true_between_their_spline_points(gear: SpurGear) -> None:
    faces = build(gear).faces
    samples = 12 * flank_intervals(gear) + 1
    for tooth, flank in ((0, RIGHT), (0, LEFT), (gear.teeth // 2, LEFT), (gear.teeth - 1, RIGHT)):
        # the rack oracle itself loses digits where radii are large: 1e-13 of them
        assert flank_deviation(gear, faces, tooth, flank, samples) < FLANK_ERROR + 1e-13 * gear.tip_radius
    assert FLANK_ERROR < FLANK_BOUND


@each_gear
def test_every_face_has_its_name(gear: SpurGear) -> None:
    part = build(gear)
    assert set(part.faces) == expected_faces(gear)
    assert len(set(part.faces.values())) == len(part.faces) == len(part.solid.Faces())


def test_names_sit_where_they_say_and_faces_look_outwards() -> None:
    gear, faces = PINION, build(PINION).faces
    for tooth in (0, 5, 27):
        middle = 2 * math.pi * tooth / gear.teeth
        for flank, side in SIDES.items():
            for kind in ("flank", "radial", "fillet"):
                face = faces[f"tooth {tooth} {side} {kind}"]
                x, y, _ = face.Center().toTuple()
                turned = (x + 1j * y) * np.exp(-1j * middle)
                # right is the low-azimuth side, within half a pitch of the tooth's middle
                assert 0 < -flank * np.angle(turned) < math.pi / gear.teeth
                nx, ny, nz = face.normalAt().toTuple()
                assert -flank * ((nx + 1j * ny) * np.exp(-1j * np.angle(x + 1j * y))).imag > 0
                assert nz == pytest.approx(0.0, abs=1e-12)
        x, y, _ = faces[f"tooth {tooth} tip"].Center().toTuple()
        assert math.remainder(math.atan2(y, x) - middle, 2 * math.pi) == pytest.approx(0.0, abs=1e-9)
        x, y, _ = faces[f"space {tooth} root"].Center().toTuple()
        assert math.remainder(math.atan2(y, x) - middle, 2 * math.pi) == pytest.approx(math.pi / gear.teeth, abs=1e-9)
    assert faces["front"].normalAt().toTuple() == pytest.approx((0, 0, 1))
    assert faces["front"].Center().z == pytest.approx(gear.face_width / 2)
    assert faces["back"].normalAt().toTuple() == pytest.approx((0, 0, -1))
    x, y, _ = faces["bore"].positionAt(0.3, 0.1).toTuple()
    nx, ny, _ = faces["bore"].normalAt(cq.Vector(x, y, 0)).toTuple()
    assert (nx, ny) == pytest.approx((-x / 10, -y / 10), abs=1e-6)


def test_u_parameter_of_a_flank_is_the_roll_angle() -> None:
    surface = BRepAdaptor_Surface(build(PINION).faces["tooth 3 left flank"].wrapped)
    assert surface.FirstUParameter() == pytest.approx(PINION.form_roll, abs=1e-12)
    assert surface.LastUParameter() == pytest.approx(PINION.tip_roll, abs=1e-12)
    for roll in (0.05, 0.2, 0.411):
        point = surface.Value(roll, surface.FirstVParameter())
        # roll = tan(alpha_y), so R = r_b sqrt(1 + roll^2)
        assert math.hypot(point.X(), point.Y()) == pytest.approx(PINION.base_radius * math.hypot(1, roll), abs=1e-6)


def test_a_thicker_tooth_grows_by_its_deviation() -> None:
    thicker = dataclasses.replace(PINION, tooth_thickness_deviation=0.08)
    radius = np.array([PINION.reference_radius])
    for flank in (RIGHT, LEFT):
        arcs = []
        for gear in (PINION, thicker):
            surface = BRepAdaptor_Surface(build(gear).faces[flank_name(0, flank)].wrapped)
            point = surface.Value(math.tan(gear.pressure_angle), surface.FirstVParameter())
            arcs.append(math.atan2(point.Y(), point.X()) * radius[0])
        # half on each flank; 0.01 um is the flank's own allowance
        assert -flank * (arcs[1] - arcs[0]) == pytest.approx(0.04, abs=FLANK_BOUND)


def test_step_file_comes_back_as_the_same_solid(tmp_path: Path) -> None:
    part = build(PINION)
    to_step(part, tmp_path / "pinion.step")
    again = of_kind(cq.Shape, cq.importers.importStep(str(tmp_path / "pinion.step")).val())
    assert again.ShapeType() == "Solid"
    assert again.isValid()
    assert again.Volume() == pytest.approx(part.solid.Volume(), rel=1e-9)
    assert [file.name for file in tmp_path.iterdir()] == ["pinion.step"]


def test_an_outline_that_crosses_itself_is_refused() -> None:
    corners = [(0, 0), (2, 2), (2, 0), (0, 2)]
    points = [cq.Vector(x, y, -0.5) for x, y in corners]
    edges = [cq.Edge.makeLine(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]
    with pytest.raises(GeometryError):
        extruded([NamedEdge(str(k), edge) for k, edge in enumerate(edges)], [], 1.0)


@pytest.mark.slow
@given(
    teeth=st.integers(3, 120),
    angle=st.floats(14.5, 30.0),
    shift=st.floats(-0.6, 1.0),
    addendum=st.floats(0.5, 1.2),
    dedendum=st.floats(0.9, 1.5),
    fillet=st.none() | st.floats(0.05, 1.0),
    deviation=st.floats(-0.1, 0.1),
)
@settings(max_examples=60, deadline=None, derandomize=True)
def test_any_gear_that_can_be_made_is_one_true_solid(
    teeth: int, angle: float, shift: float, addendum: float, dedendum: float, fillet: float | None, deviation: float
) -> None:
    try:
        gear = SpurGear(teeth, 2.0, angle * DEG, 10.0, shift, addendum, dedendum, None, 0.0, deviation)
        if fillet is not None:
            gear = dataclasses.replace(gear, root_fillet=fillet * gear.full_round_fillet)
    except GeometryError:
        assume(False)
    part = build(gear)
    assert set(part.faces) == expected_faces(gear)
    assert part.solid.Volume() == pytest.approx(gear.transverse_area * gear.face_width, rel=1e-6)
    coarse, fine = polygon_area(gear, 501), polygon_area(gear, 1001)
    assert (4 * fine - coarse) / 3 == pytest.approx(gear.transverse_area, rel=1e-8)
    for flank in (RIGHT, LEFT):
        assert flank_deviation(gear, part.faces, teeth - 1, flank, 200) < FLANK_BOUND


@pytest.mark.slow
@pytest.mark.parametrize("teeth", [110, 200])
def test_large_wheels_hold_the_same_bounds(teeth: int) -> None:
    gear = SpurGear(teeth, 2.5, 20 * DEG, 20.0, bore=60.0)
    part = build(gear)
    section = gear.transverse_area - math.pi * gear.bore**2 / 4
    assert part.solid.Volume() == pytest.approx(section * gear.face_width, rel=1e-6)
    assert max(flank_deviation(gear, part.faces, k, LEFT, 100) for k in range(0, teeth, 10)) < FLANK_ERROR
