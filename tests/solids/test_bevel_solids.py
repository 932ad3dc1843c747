"""Measuring strips and display meshes of bevel gears, read off their solids."""

import math
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from tol3d.cad.solids import display_mesh, measuring_strips, strip_mesh
from tol3d.gears import LEFT, RIGHT, BevelGear, pitch_angles

ALPHA = math.radians(20.0)
GEARS = {
    "published": BevelGear(31, 3.5, ALPHA, 9.0, math.radians(45), bore=30.0),
    "below the base cone": BevelGear(17, 2.0, ALPHA, 12.0, pitch_angles(17, 43, math.radians(90))[0], 0.3),
}


@pytest.mark.parametrize("gear", GEARS.values(), ids=GEARS.keys())
def test_strips_lie_on_the_spherical_involute_from_toe_to_heel(gear: BevelGear) -> None:
    strips = measuring_strips(gear, 128)
    for flank in (RIGHT, LEFT):
        for points, distance in (
            (strips.inner[flank], gear.inner_cone_distance),
            (strips.outer[flank], gear.outer_cone_distance),
        ):
            assert np.linalg.norm(points, axis=1) == pytest.approx(distance, abs=1e-9)
            formula = distance * gear.flank_directions(strips.parameter, flank)
            assert np.abs(points - formula).max() < 1e-5  # 0.01 um
        assert np.abs(strips.normals[flank] - gear.flank_normals(strips.parameter, flank)).max() < 1e-5
    assert strips.flank_error < 1e-5


@pytest.mark.parametrize("gear", GEARS.values(), ids=GEARS.keys())
def test_the_stated_chord_error_is_the_largest_sagitta_at_the_heel(gear: BevelGear) -> None:
    for steps in (32, 128):
        strips = measuring_strips(gear, steps)
        middle = (strips.parameter[:-1] + strips.parameter[1:]) / 2
        largest = 0.0
        for flank in (RIGHT, LEFT):
            bulge = gear.outer_cone_distance * gear.flank_directions(middle, flank)
            begin, end = strips.outer[flank][:-1], strips.outer[flank][1:]
            along = (end - begin) / np.linalg.norm(end - begin, axis=1, keepdims=True)
            off = bulge - begin
            largest = max(largest, np.linalg.norm(off - (off * along).sum(1, keepdims=True) * along, axis=1).max())
        # the largest sagitta is not quite in the middle, and the stated one has a margin of 1 %
        assert largest <= strips.chord_error <= 1.15 * largest
    assert measuring_strips(gear, 128).chord_error < 0.035e-3


def test_a_section_s_strip_is_a_piece_of_the_whole_one() -> None:
    gear = GEARS["published"]
    strips = measuring_strips(gear, 32)
    vertices, triangles = strip_mesh(strips, LEFT, 0.0, span=(0.4, 0.6))
    distances = np.linalg.norm(vertices, axis=1)
    assert distances[:33] == pytest.approx(gear.inner_cone_distance + 0.4 * 9.0, abs=1e-9)
    assert distances[33:] == pytest.approx(gear.inner_cone_distance + 0.6 * 9.0, abs=1e-9)
    assert triangles.shape == (64, 3)


def test_triangles_of_a_strip_face_out_of_the_tooth() -> None:
    strips = measuring_strips(GEARS["published"], 32)
    for flank in (RIGHT, LEFT):
        vertices, triangles = strip_mesh(strips, flank, 0.03)
        corners = vertices[triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        outwards = np.tile((strips.normals[flank][:-1] + strips.normals[flank][1:]) / 2, (2, 1))
        assert ((normals * outwards).sum(axis=1) > 0.0).all()


def test_display_meshes_are_closed_and_thicken_with_their_teeth() -> None:
    gear = GEARS["published"]
    shown = display_mesh(gear, 0.005)
    mesh = trimesh.Trimesh(shown.vertices, shown.triangles, process=False)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert shown.chord_error < 0.005
    thicker = trimesh.Trimesh(shown.thickened(1e-3), shown.triangles, process=False)
    # the same gear with teeth thicker by 2e-3 rad of arc, built anew; both are off by their chord errors alike
    deviation = 2e-3 * gear.reference_radius
    other = display_mesh(replace(gear, tooth_thickness_deviation=deviation), 0.005)
    built = trimesh.Trimesh(other.vertices, other.triangles, process=False)
    assert thicker.volume - mesh.volume == pytest.approx(built.volume - mesh.volume, rel=0.02)
    assert built.volume > mesh.volume + 10.0
