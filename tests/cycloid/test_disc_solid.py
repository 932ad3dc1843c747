"""The solid of a cycloid disc against pins that are placed step by step, the formula, and closed forms of its area."""

import cmath
import math
from dataclasses import replace

import cadquery as cq
import numpy as np
import pytest
from numpy.typing import NDArray
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.gp import gp_Pnt
from oracles.rolling_disc import Outline, distance, pin_in_disc
from scipy.special import ellipe

from tol3d.cad.solids import display_mesh
from tol3d.gearing.cycloid.model.profile import DiscProfile, Modification
from tol3d.gearing.cycloid.model.shapes import CycloidDisc, DiscHoles, lobe_strips
from tol3d.gearing.cycloid.model.shapes_cad import FLANK_ERROR, disc, knots
from tol3d.parts.named_solid import NamedSolid

RV_250 = DiscProfile(pins=40, pin_circle_radius=114.5, pin_radius=5.0, eccentricity=2.2)
USUAL = replace(RV_250, modification=Modification(-0.02, -0.0128, 2e-5))
TIGHT = DiscProfile(pins=40, pin_circle_radius=114.5, pin_radius=8.9, eccentricity=2.2)  # 0.15 mm short of undercut
SHARP = DiscProfile(pins=40, pin_circle_radius=114.5, pin_radius=3.0, eccentricity=2.7)  # K = 0.943
SMALL = DiscProfile(pins=12, pin_circle_radius=30.0, pin_radius=2.0, eccentricity=1.0)
HOLES = DiscHoles(cranks=3, circle_radius=63.0, crank_diameter=50.0, window_diameter=48.0, bore_diameter=60.0)
ASKED = 1e-5  # mm


@pytest.fixture(scope="module")
def plain() -> NamedSolid:
    return disc(CycloidDisc(20.0, RV_250, HOLES))


def to_face(face: cq.Face, place: complex, z: float = 0.0) -> float:
    vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(place.real, place.imag, z)).Vertex()
    return float(BRepExtrema_DistShapeShape(vertex, face.wrapped).Value())


def face_points(face: cq.Face, count: int) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
    """Parameters and points of a face, at one of its ends and between its knots."""
    surface = BRepAdaptor_Surface(face.wrapped)
    u = np.linspace(surface.FirstUParameter(), surface.LastUParameter(), count)
    points = [surface.Value(at, surface.FirstVParameter()) for at in u.tolist()]
    return u, np.array([complex(point.X(), point.Y()) for point in points])


def worst_of_pins(part: NamedSolid, profile: DiscProfile, lobes: list[int], each: int, clocking: float = 0.0) -> float:
    """Largest gap or overlap of pins that stand about lobes and their faces [mm]."""
    worst = 0.0
    for lobe in lobes:
        for share in (np.arange(each) + 0.37) / each:
            # pin 0 comes to this place of the lobe at this crank angle
            crank = 2 * math.pi * (lobe + share)
            pin = pin_in_disc(profile.pins, profile.pin_circle_radius, profile.eccentricity, 0, crank)
            side = "right" if share < 0.5 else "left"
            found = to_face(part.faces[f"lobe {lobe} {side} flank"], pin * cmath.exp(1j * clocking), 3.0)
            worst = max(worst, abs(found - profile.pin_radius))
    return worst


def test_pins_placed_among_the_lobes_touch_their_faces_within_a_hundredth_of_a_micrometre(plain: NamedSolid) -> None:
    assert worst_of_pins(plain, RV_250, [0, 17, 38], 7) <= FLANK_ERROR < ASKED


def test_a_clocked_disc_has_its_lobes_turned_and_its_holes_where_they_were() -> None:
    part = disc(CycloidDisc(20.0, RV_250, HOLES, -RV_250.lobe_pitch / 2))
    assert worst_of_pins(part, RV_250, [5], 3, -math.pi / 39) <= FLANK_ERROR
    # the middle of a cylinder's side is where its axis is
    assert part.faces["crank hole 1"].Center().toTuple() == pytest.approx((63.0, 0.0, 0.0), abs=1e-6)
    assert part.faces["window 1"].Center().toTuple() == pytest.approx((31.5, 31.5 * math.sqrt(3), 0.0), abs=1e-6)


@pytest.mark.parametrize(
    "profile", [RV_250, USUAL, TIGHT, SHARP, SMALL], ids=["plain", "usual", "tight", "sharp", "small"]
)
def test_faces_of_a_lobe_follow_the_profile_between_their_knots(profile: DiscProfile) -> None:
    """Face to curve, by search, and at one parameter; the 12 samples a knot leave 1 % of the largest error unseen."""
    holes = replace(HOLES, circle_radius=15.0, crank_diameter=8.0, window_diameter=0.0, bore_diameter=0.0)
    part = disc(CycloidDisc(20.0, profile, HOLES if profile is not SMALL else holes))
    turn = profile.modification.rotation
    for lobe, side, rotation in ((0, "right", turn), (profile.lobes // 2, "left", -turn)):
        u, found = face_points(part.faces[f"lobe {lobe} {side} flank"], 12 * len(knots(profile)))
        found = found * cmath.exp(-2j * math.pi * lobe / profile.lobes)
        curve = Outline(profile.ground.points, rotation)
        assert np.abs(found - curve(u)).max() <= FLANK_ERROR
        for place, at in list(zip(found, u, strict=True))[5::97]:
            assert distance(curve, complex(place), at, 0.01) <= FLANK_ERROR


def test_a_flank_takes_about_seventy_knots() -> None:
    assert {name: len(knots(profile)) for name, profile in {"rv": RV_250, "tight": TIGHT, "small": SMALL}.items()} == {
        "rv": pytest.approx(71, abs=2),
        "tight": pytest.approx(82, abs=2),
        "small": pytest.approx(38, abs=2),
    }


def test_volume_is_that_of_the_parallel_of_an_epitrochoid_less_the_holes(plain: NamedSolid) -> None:
    """Inwards by r a curve that turns once loses r times its length and gains pi r^2; the length is an elliptic one."""
    k = 88 / 114.5
    area = math.pi * (114.5**2 + 40 * 2.2**2)
    length = 4 * 114.5 * (1 + k) * ellipe(4 * k / (1 + k) ** 2)
    section = area - 5.0 * length + math.pi * 25 - math.pi * (3 * 25**2 + 3 * 24**2 + 30**2)
    assert plain.solid.isValid()
    x, y = RV_250.points(np.linspace(0.0, 2 * math.pi, 78001)).T
    assert (x[:-1] * y[1:] - x[1:] * y[:-1]).sum() / 2 == pytest.approx(area - 5.0 * length + math.pi * 25, rel=1e-6)
    # OCC integrates along splines to 3e-6
    assert plain.solid.Volume() == pytest.approx(20 * section, rel=5e-6)


def test_every_face_has_its_name(plain: NamedSolid) -> None:
    names = {f"lobe {lobe} {side} flank" for lobe in range(39) for side in ("right", "left")}
    names |= {f"{hole} {number}" for hole in ("crank hole", "window") for number in (1, 2, 3)} | {
        "bore",
        "front",
        "back",
    }
    assert set(plain.faces) == names
    assert set(plain.faces.values()) == set(plain.solid.Faces())
    assert plain.faces["front"].normalAt().toTuple() == pytest.approx((0, 0, 1))


def test_the_display_mesh_is_closed_and_keeps_to_its_chord_error() -> None:
    mesh = display_mesh(CycloidDisc(20.0, RV_250, HOLES), 0.05)
    edges = np.sort(np.concatenate([mesh.triangles[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))]), axis=1)
    assert set(np.unique(edges, axis=0, return_counts=True)[1]) == {2}
    assert mesh.chord_error < 0.06
    radius = np.hypot(*mesh.vertices[:, :2].T)
    outline = mesh.vertices[radius > 100.0, :2]
    assert radius.max() == pytest.approx(111.7, abs=1e-6)
    assert outline.shape[0] > 39 * 2 * 4


# strips ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("profile", [RV_250, USUAL], ids=["plain", "usual"])
def test_strips_lie_on_the_profile_and_leave_it_by_their_chord_error(profile: DiscProfile) -> None:
    strips = lobe_strips(CycloidDisc(20.0, profile, HOLES, 0.01), 48)
    worst = 0.0
    for strip, rotation in (
        (strips.right, profile.modification.rotation),
        (strips.left, -profile.modification.rotation),
    ):
        lies = (strip.points[:, 0] + 1j * strip.points[:, 1]) * np.exp(-1j * (0.01 + rotation))
        x, y = profile.ground.points(strip.parameter).T
        assert np.abs(lies - (x + 1j * y)).max() <= FLANK_ERROR
        curve = Outline(profile.ground.points, 0.01 + rotation)
        corners = strip.points[:, 0] + 1j * strip.points[:, 1]
        chord = np.diff(corners)
        between = np.linspace(strip.parameter[:-1], strip.parameter[1:], 201).T
        off = (
            (curve(between.ravel()).reshape(between.shape) - corners[:-1, None])
            * (chord / np.abs(chord)).conj()[:, None]
        ).imag
        worst = max(worst, float(np.abs(off).max()))
        assert strip.width == 20.0
    assert worst <= strips.chord_error <= 1.03 * worst


def test_halved_steps_leave_a_quarter_of_the_chord_error() -> None:
    coarse, fine = (lobe_strips(CycloidDisc(20.0, RV_250, HOLES), steps).chord_error for steps in (48, 96))
    assert fine == pytest.approx(coarse / 4, rel=0.02)


def test_strips_as_triangles_are_pulled_into_the_disc_and_face_outwards() -> None:
    strips = lobe_strips(CycloidDisc(20.0, RV_250, HOLES), 48)
    for strip, turned in ((strips.right, False), (strips.left, True)):
        vertices, triangles = strip.mesh(0.01)
        a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
        normals = np.cross(b - a, c - a)
        middle = (strip.normals[1:] + strip.normals[:-1]) / 2
        assert ((normals[:48, :2] * middle).sum(axis=1) > 0).all(), turned
        assert np.abs(normals[:, 2]).max() < 1e-9
        pulled = strip.points - vertices[:49, :2]
        assert pulled == pytest.approx(0.01 * strip.normals, abs=1e-12)
        # counter-clockwise: the normal is the direction of the outline, turned clockwise
        along = np.diff(strip.points, axis=0)
        assert (along[:, 0] * middle[:, 1] - along[:, 1] * middle[:, 0] < 0).all()


@pytest.mark.slow
def test_all_lobes_are_true_from_root_to_tip(plain: NamedSolid) -> None:
    assert worst_of_pins(plain, RV_250, list(range(39)), 40) <= FLANK_ERROR
