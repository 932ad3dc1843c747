"""Solids, strips and meshes of helical gears against the screw involute, point by point."""

import math
from pathlib import Path

import cadquery as cq
import numpy as np
import pytest

from tol3d.cad.solids import FlankStrips
from tol3d.cad.solids.spur_cad import build, sample_flanks, tessellate
from tol3d.cad.solids.strips import strip_mesh
from tol3d.cad.solids.swept_cad import RuledFace
from tol3d.gears import LEFT, LEFT_HAND, RIGHT, InternalGear, SpurGear
from tol3d.numerics.arrays import Array
from tol3d.parts import internal_gear
from tol3d.parts.twisted_solid import TWIST_ERROR

ALPHA = math.radians(20.0)
PINION = SpurGear(17, 1.0, ALPHA, 16.0, profile_shift=0.3, helix_angle=math.radians(30.0), bore=6.0)
SLANTED = SpurGear(24, 2.0, ALPHA, 20.0, helix_angle=math.radians(15.0), hand=LEFT_HAND)
RING = InternalGear(
    41, 1.5, ALPHA, 14.0, profile_shift=-0.2, addendum=0.9, helix_angle=math.radians(22.0), hand=LEFT_HAND
)
GEARS: dict[str, SpurGear | InternalGear] = {"30 deg, right": PINION, "15 deg, left": SLANTED, "ring": RING}
MEASURING = 1e-5  # mm; a tenth of the chord error of 128 steps


def string_azimuth(gear: SpurGear | InternalGear, roll: Array, z: Array, flank: int, tooth: int = 0) -> Array:
    """Azimuth at which the string leaves the base circle; that of a ring unwinds the other way."""
    turned = gear.twist * z + 2 * math.pi * tooth / gear.teeth
    return np.asarray(flank * (gear.iso_sign * roll - gear.base_half_angle) + turned)


def screw(gear: SpurGear | InternalGear, roll: Array, z: Array, flank: int, tooth: int = 0) -> Array:
    """Points (n, 3) of a flank by the string unwound from the base circle, which the helix turns."""
    phi, string = string_azimuth(gear, roll, z, flank, tooth), gear.iso_sign * flank * roll
    cos, sin = np.cos(phi), np.sin(phi)
    return np.stack([gear.base_radius * (cos + string * sin), gear.base_radius * (sin - string * cos), z], axis=-1)


@pytest.mark.parametrize("name", GEARS)
def test_flank_faces_are_screw_involutes_to_a_hundredth_of_a_micrometre(name: str) -> None:
    gear = GEARS[name]
    part = build(gear)
    roll, z = (own.ravel() for own in np.meshgrid(
        np.linspace(gear.form_roll, gear.tip_roll, 23), np.linspace(-gear.face_width / 2, gear.face_width / 2, 31)
    ))  # fmt: skip
    for tooth, flank, side in ((0, RIGHT, "right"), (5, LEFT, "left")):
        face = RuledFace(part.faces[f"tooth {tooth} {side} flank"])
        off = face.places(roll, z) - screw(gear, roll, z, flank, tooth)
        assert np.abs(off).max() < MEASURING
        phi = string_azimuth(gear, roll, z, flank, tooth)
        cos_b, sin_b = gear.base_helix_cosine, math.sin(gear.base_helix_angle)
        outwards = np.stack(
            [cos_b * flank * np.sin(phi), -cos_b * flank * np.cos(phi), np.full(len(phi), flank * gear.hand * sin_b)],
            axis=-1,
        )
        # near its base circle the spline's second derivative is rounded
        inside = roll > min(gear.form_roll, gear.tip_roll) + 0.05
        assert np.abs(face.place_normals(roll, z) - outwards)[inside].max() < 1e-5


@pytest.mark.parametrize("name", GEARS)
def test_a_twisted_solid_holds_its_section_times_its_width(name: str) -> None:
    gear = GEARS[name]
    part = build(gear)
    assert part.solid.isValid()
    expected = (gear.transverse_area - math.pi * gear.bore**2 / 4) * gear.face_width
    assert part.solid.Volume() == pytest.approx(expected, rel=3e-5)  # OCC integrates splines to so much
    assert {"front", "back", "tooth 3 tip"} <= set(part.faces)
    assert ("bore" in part.faces) == (gear.bore > 0.0)
    assert ("rim" in part.faces) == isinstance(gear, InternalGear)
    assert part.faces["front"].normalAt().z == pytest.approx(1.0, abs=1e-9)
    assert part.faces["back"].normalAt().z == pytest.approx(-1.0, abs=1e-9)


@pytest.mark.parametrize("flank", [RIGHT, LEFT])
@pytest.mark.parametrize("name", GEARS)
def test_strips_lie_within_their_chord_error_inside_the_flank(name: str, flank: int) -> None:
    """The middle of every triangle, and of its sides, against the signed distance of screw flanks in closed form.

    Chords of a ring's hollow flanks lie in its spaces.
    """
    gear, errors = GEARS[name], []
    for steps in (32, 64):
        arrays = sample_flanks(gear, steps)
        ends = {
            key: {side: arrays[key][index] for index, side in enumerate((RIGHT, LEFT))}
            for key in ("inner", "outer", "normals")
        }
        strips = FlankStrips(
            np.asarray(arrays["parameter"], dtype=float),
            **ends,
            chord_error=float(arrays["chord_error"]),
            flank_error=0.0,
        )
        assert float(arrays["flank_error"]) < MEASURING
        vertices, triangles = strip_mesh(strips, RIGHT if flank == RIGHT else LEFT, 0.0)
        corners = vertices[triangles]
        weights = np.array([[1, 1, 1], [1, 1, 0], [0, 1, 1], [1, 0, 1], [4, 1, 1], [1, 4, 1]], dtype=float)
        points = np.einsum("wc,tcx->twx", weights / weights.sum(axis=1, keepdims=True), corners).reshape(-1, 3)
        gap = gear.iso_sign * distance(gear, points, flank)
        assert gap.max() < 1e-6  # inside the tooth, or on the flank
        assert -gap.min() < 1.02 * strips.chord_error + 1e-7
        assert -gap.min() > 0.5 * strips.chord_error
        errors.append(strips.chord_error)
        area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        turned = (area * ends["normals"][RIGHT if flank == RIGHT else LEFT].mean(axis=0)).sum(axis=-1)
        assert (turned > 0.0).all()  # outwards
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def distance(gear: SpurGear | InternalGear, points: Array, flank: int) -> Array:
    """r_b cos(beta_b) [-sigma (theta - kappa z) - eta_b + s inv alpha_R] [mm], positive outside the tooth."""
    radius, theta = np.hypot(points[:, 0], points[:, 1]), np.arctan2(points[:, 1], points[:, 0])
    tangent = np.sqrt(np.maximum((radius / gear.base_radius) ** 2 - 1, 0.0))
    inv = tangent - np.arctan(tangent)
    in_section = -flank * (theta - gear.twist * points[:, 2]) - gear.base_half_angle + gear.iso_sign * inv
    return np.asarray(gear.section_arm * in_section)


@pytest.mark.parametrize("name", GEARS)
def test_a_display_mesh_is_closed_and_follows_the_helix(name: str) -> None:
    gear = GEARS[name]
    coarse, fine = (tessellate(gear, deflection) for deflection in (0.05, 0.01))
    assert len(fine["vertices"]) > 1.5 * len(coarse["vertices"])
    triangles, vertices = fine["triangles"], fine["vertices"]
    edges = np.concatenate([triangles[:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
    there, back = ({tuple(edge) for edge in own.tolist()} for own in (edges, edges[:, ::-1]))
    assert there == back
    assert len(there) == len(edges)
    volume = (
        np.einsum("ti,ti->", vertices[triangles[:, 0]], np.cross(vertices[triangles[:, 1]], vertices[triangles[:, 2]]))
        / 6
    )
    expected = (gear.transverse_area - math.pi * gear.bore**2 / 4) * gear.face_width
    assert volume == pytest.approx(expected, rel=5e-3)
    height = vertices[:, 2]
    top, bottom = (vertices[height == end] for end in (height.max(), height.min()))
    angle = gear.twist * gear.face_width
    rotation = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    assert np.abs(bottom[:, :2] @ rotation - top[:, :2]).max() < 1e-9


@pytest.mark.slow
def test_a_step_file_of_a_ring_comes_back(tmp_path: Path) -> None:
    part = build(RING)
    part.solid.exportStep(str(tmp_path / "ring.step"))
    again = cq.importers.importStep(str(tmp_path / "ring.step")).val()
    assert isinstance(again, cq.Shape)
    assert again.isValid()
    assert again.Volume() == pytest.approx(part.solid.Volume(), rel=1e-8)


def test_one_tooth_of_a_ring_has_the_flanks_of_the_whole() -> None:
    whole, tooth = build(RING).faces, internal_gear.build_tooth(RING).faces
    for side in ("right", "left"):
        first, other = (RuledFace(faces[f"tooth 0 {side} flank"]) for faces in (whole, tooth))
        roll = np.linspace(RING.tip_roll, RING.form_roll, 7)
        for z in (-7.0, 1.0, 7.0):
            places = [own.places(roll, np.full(7, z)) for own in (first, other)]
            assert np.abs(places[0] - places[1]).max() < 2 * TWIST_ERROR
