"""The CAD solid, strips and display mesh of an internal gear against the external gear whose teeth fill its spaces.

A shaper cutter of as many teeth as the ring leaves its own flanks behind: they are those of the rack that would cut it,
which knows no involute, no base circle and no internal gear.
"""

import dataclasses
import functools
import math
from collections.abc import Iterator
from pathlib import Path

import cadquery as cq
import numpy as np
import pytest
import trimesh
from OCP.BRepAdaptor import BRepAdaptor_Surface

from tol3d.cad.solids import display_mesh, measuring_strips, strip_mesh
from tol3d.gears import LEFT, RIGHT, InternalGear
from tol3d.gears.flank import Flank
from tol3d.parts import internal_gear
from tol3d.parts.internal_gear import build_tooth
from tol3d.parts.tooth_edges import flank_intervals, flank_name

DEG = math.pi / 180
build = functools.cache(internal_gear.build)
FLANK_BOUND = 1e-6  # mm; 1 nm

RING = InternalGear(79, 1.0, 20 * DEG, 10.0)
GEARS = {
    "ring of a reducer": RING,
    "full round": InternalGear(45, 2.5, 25 * DEG, 20.0, profile_shift=0.2, dedendum=1.4),
    "thin, wide rim": InternalGear(
        60,
        0.5,
        20 * DEG,
        4.0,
        profile_shift=-0.4,
        root_fillet=0.05,
        outer_diameter=40.0,
        tooth_thickness_deviation=-0.02,
    ),
}
each_gear = pytest.mark.parametrize("gear", GEARS.values(), ids=GEARS.keys())


@pytest.fixture(autouse=True, scope="module")
def _cache_of_the_tests(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:  # later modules of the same process have the user's cache again
        patch.setenv("TOL3D_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


def rack_flank(gear: InternalGear, radius: np.ndarray, flank: Flank) -> np.ndarray:
    """Points of tooth 0 at given radii: the flank of the cutter's tooth in the space beside it.

    The straight flank of a rack at the pressure angle touches where the normal through the pitch point (r, 0) meets it,
    a distance d away, R^2 = r^2 + 2 r d sin(alpha) + d^2; it has moved by s = S/2 - d/cos(alpha), the cutter turned by
    s/r.
    """
    r, alpha = gear.module * gear.teeth / 2, gear.pressure_angle
    nominal = gear.module * (math.pi / 2 + 2 * gear.profile_shift * math.tan(alpha))
    cutter = math.pi * gear.module - nominal - gear.tooth_thickness_deviation
    d = -r * math.sin(alpha) + np.sqrt((r * math.sin(alpha)) ** 2 + radius**2 - r**2)
    contact = (r + d * math.sin(alpha)) - 1j * d * math.cos(alpha)
    right = contact * np.exp(-1j * (cutter / 2 - d / math.cos(alpha)) / r)  # low flank of the cutter's tooth on +x
    of_left = right * np.exp(1j * math.pi / gear.teeth)  # the space above tooth 0 begins with that tooth's left flank
    return np.stack([of_left.real, -flank * of_left.imag], axis=-1)


def section_area(gear: InternalGear, points_each: int) -> float:
    """Area [mm^2] between the rim and a polygon of rack flanks and chords of fillets, tip and root circles."""

    def arc(centre: tuple[float, float], begin: np.ndarray, end: np.ndarray) -> np.ndarray:
        first, last = (np.arctan2(*(point - centre)[::-1]) for point in (begin, end))
        angle = first + math.remainder(last - first, 2 * math.pi) * np.linspace(0, 1, points_each)
        return np.array(centre) + math.dist(begin, centre) * np.stack([np.cos(angle), np.sin(angle)], axis=-1)

    radii = np.linspace(gear.tip_radius, gear.form_radius, points_each)
    right, left = rack_flank(gear, radii, RIGHT), rack_flank(gear, radii, LEFT)
    pitch = 2 * math.pi / gear.teeth
    turn = np.array([[math.cos(pitch), math.sin(pitch)], [-math.sin(pitch), math.cos(pitch)]])
    parts = [
        arc(gear.fillet_centre(RIGHT), np.array(gear.fillet_bottom(RIGHT)), right[-1]),
        right[::-1],
        arc((0.0, 0.0), right[0], left[0]),
        left,
        arc(gear.fillet_centre(LEFT), left[-1], np.array(gear.fillet_bottom(LEFT))),
        arc((0.0, 0.0), np.array(gear.fillet_bottom(LEFT)), np.array(gear.fillet_bottom(RIGHT)) @ turn),
    ]
    x, y = np.concatenate(parts).T
    hollow = gear.teeth * float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])) / 2
    return math.pi * gear.rim_diameter**2 / 4 - hollow


def flank_deviation(gear: InternalGear, faces: dict[str, cq.Face], tooth: int, flank: Flank) -> float:
    """Largest distance [mm] of a flank's face from the rack's flank, at all three of its heights."""
    surface = BRepAdaptor_Surface(faces[flank_name(tooth, flank)].wrapped)
    worst = 0.0
    for v in np.linspace(surface.FirstVParameter(), surface.LastVParameter(), 3):
        rolls = np.linspace(gear.tip_roll, gear.form_roll, 12 * flank_intervals(gear) + 1)
        points = [surface.Value(u, v) for u in rolls]
        found = np.array([p.X() + 1j * p.Y() for p in points]) * np.exp(-2j * math.pi * tooth / gear.teeth)
        exact = rack_flank(gear, np.abs(found), flank)
        worst = max(worst, np.hypot(found.real - exact[:, 0], found.imag - exact[:, 1]).max())
    return worst


@each_gear
def test_the_solid_is_true_to_the_involute_within_1_nm_and_has_the_volume_of_its_section(gear: InternalGear) -> None:
    part = build(gear)
    assert part.solid.isValid()
    assert part.solid.ShapeType() == "Solid"
    assert part.solid.Volume() == pytest.approx(gear.transverse_area * gear.face_width, rel=1e-6)
    coarse, fine = section_area(gear, 501), section_area(gear, 1001)
    # chords: one Richardson step leaves order 4
    assert (4 * fine - coarse) / 3 == pytest.approx(gear.transverse_area, rel=1e-9)
    box = part.solid.BoundingBox()
    assert (box.zmin, box.zmax) == pytest.approx((-gear.face_width / 2, gear.face_width / 2), abs=1e-6)
    assert (box.xmax - box.xmin) == pytest.approx(gear.rim_diameter, abs=1e-5)
    for tooth, flank in ((0, RIGHT), (0, LEFT), (gear.teeth // 2, LEFT), (gear.teeth - 1, RIGHT)):
        assert flank_deviation(gear, dict(part.faces), tooth, flank) < FLANK_BOUND


@each_gear
def test_fillets_touch_flank_and_root_circle_in_the_space(gear: InternalGear) -> None:
    for flank in (RIGHT, LEFT):
        centre = np.array(gear.fillet_centre(flank))
        assert np.hypot(*centre) == pytest.approx(gear.root_radius - gear.fillet_radius, rel=1e-12)
        line = rack_flank(gear, np.linspace(gear.tip_radius, gear.root_radius, 20001), flank)
        spacing = np.hypot(*np.diff(line, axis=0).T).max()
        distance = np.hypot(*(line - centre).T).min()
        # beside a tangent point a distance grows by spacing^2/(2 radius)
        assert gear.fillet_radius - 1e-9 <= distance <= gear.fillet_radius + spacing**2 / gear.fillet_radius


def test_every_face_has_its_name_and_looks_out_of_the_teeth() -> None:
    part = build(RING)
    kinds = [f"{side} {kind}" for side in ("right", "left") for kind in ("flank", "fillet")] + ["tip"]
    names = {f"tooth {k} {kind}" for k in range(79) for kind in kinds} | {f"space {k} root" for k in range(79)}
    assert set(part.faces) == names | {"rim", "front", "back"}
    assert len(part.solid.Faces()) == len(part.faces)
    for tooth in (0, 5, 78):
        middle = 2 * math.pi * tooth / 79
        for flank, side in ((RIGHT, "right"), (LEFT, "left")):
            face = part.faces[f"tooth {tooth} {side} flank"]
            x, y, _ = face.Center().toTuple()
            # right is the low-azimuth side, within half a pitch of the tooth's middle, and looks there and inwards
            assert 0 < -flank * np.angle((x + 1j * y) * np.exp(-1j * middle)) < math.pi / 79
            nx, ny, nz = face.normalAt().toTuple()
            seen = (nx + 1j * ny) * np.exp(-1j * np.angle(x + 1j * y))
            assert -flank * seen.imag > 0
            assert seen.real < 0
            assert nz == pytest.approx(0.0, abs=1e-12)
        x, y, _ = part.faces[f"space {tooth} root"].Center().toTuple()
        assert math.remainder(math.atan2(y, x) - middle, 2 * math.pi) == pytest.approx(math.pi / 79, abs=1e-9)


def test_one_tooth_alone_has_the_flanks_of_the_whole() -> None:
    gear = GEARS["full round"]
    whole, tooth = build(gear).faces, build_tooth(gear).faces
    for flank in (RIGHT, LEFT):
        first, other = (BRepAdaptor_Surface(faces[flank_name(0, flank)].wrapped) for faces in (whole, tooth))
        for u in np.linspace(gear.tip_roll, gear.form_roll, 7):
            assert first.Value(u, 1.0).Distance(other.Value(u, 1.0)) == 0.0


@pytest.mark.parametrize("gear", [GEARS["full round"], pytest.param(RING, marks=pytest.mark.slow)])
def test_strips_lie_on_the_flanks_with_normals_towards_the_space(gear: InternalGear) -> None:
    """A chord of the hollow, which is convex, lies in the space: by its sagitta, a quarter of it at half the step."""
    errors = []
    for steps in (40, 80):
        strips = measuring_strips(gear, steps)
        assert strips.flank_error < FLANK_BOUND
        assert strips.parameter[0] == gear.tip_roll
        assert strips.parameter[-1] == gear.form_roll
        for flank in (RIGHT, LEFT):
            points, normals = strips.inner[flank][:, :2], strips.normals[flank][:, :2]
            radius = np.hypot(*points.T)
            assert np.abs(points - rack_flank(gear, radius, flank)).max() < FLANK_BOUND
            step = 1e-4 * gear.module
            ahead, back = (rack_flank(gear, radius[1:-1] + sign * step, flank) for sign in (1, -1))
            along = (ahead - back) / np.hypot(*(ahead - back).T)[:, None]
            assert np.abs((along * normals[1:-1]).sum(axis=1)).max() < 1e-6  # order 2 of the step over the curvature
            assert (flank * normals[:, 1] < 0).all()  # out of the tooth, into the space beside it
            middle = (points[1:] + points[:-1]) / 2
            off = middle - rack_flank(gear, np.hypot(*middle.T), flank)
            apart = (off * (normals[1:] + normals[:-1]) / 2).sum(axis=1)
            assert (apart > 0).all()
            assert apart.max() < 1.001 * strips.chord_error
            assert (strips.outer[flank][:, 2] == gear.face_width / 2).all()
        errors.append(strips.chord_error)
        vertices, triangles = strip_mesh(strips, RIGHT, 0.0)
        a, b, c = (vertices[triangles[:, k]] for k in range(3))
        outwards = (np.cross(b - a, c - a)[:, :2] * np.repeat(strips.normals[RIGHT][:1, :2], len(a), axis=0)).sum(
            axis=1
        )
        assert (outwards > 0).all()
    assert errors[1] == pytest.approx(errors[0] / 4, rel=0.02)


def test_the_display_mesh_is_watertight_and_thickens_with_the_teeth() -> None:
    deflection = 0.01
    mesh = display_mesh(RING, deflection)
    solid = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    assert solid.is_watertight
    assert solid.is_winding_consistent
    area = RING.transverse_area
    # the polygon leaves the outline by at most the deflection, along all of it
    outline = math.pi * RING.rim_diameter + 79 * 2 * 2.6 + 2 * math.pi * RING.tip_radius
    assert abs(solid.volume - area * 10.0) < deflection * outline * 10.0
    thicker = dataclasses.replace(RING, tooth_thickness_deviation=0.1)
    grown = trimesh.Trimesh(mesh.thickened(0.1 / (2 * 39.5)), mesh.triangles, process=False)
    assert grown.volume - solid.volume == pytest.approx((thicker.transverse_area - area) * 10.0, rel=0.05)


@pytest.mark.slow
def test_a_step_file_comes_back(tmp_path: Path) -> None:
    part = build(GEARS["full round"])
    part.solid.exportStep(str(tmp_path / "ring.step"))
    again = cq.importers.importStep(str(tmp_path / "ring.step")).val()
    assert isinstance(again, cq.Shape)
    assert again.isValid()
    assert again.Volume() == pytest.approx(part.solid.Volume(), rel=1e-9)
