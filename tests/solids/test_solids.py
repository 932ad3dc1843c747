"""Strips, display meshes, STEP and the cache of solids; flanks held against a rack that knows no involute."""

import dataclasses
import math
import os
import subprocess
import sys
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, NoReturn, cast

import cadquery as cq
import numpy as np
import pytest
import trimesh
from of_kind import known, of_kind

from tol3d.cad.solids import (
    FlankStrips,
    PosedGear,
    cache,
    display_mesh,
    export_step,
    measuring_strips,
    strip_mesh,
    strips,
)
from tol3d.cad.solids.cache import CacheWarning
from tol3d.errors import RunError
from tol3d.gears import LEFT, RIGHT, SpurGear
from tol3d.gears.flank import Flank
from tol3d.numerics.cache_folder import cache_folder

DEG = math.pi / 180
FLANK_BOUND = 1e-5  # mm; 0.01 um

PINION = SpurGear(28, 2.5, 20 * DEG, 20.0, bore=20.0)  # its involute begins at the base circle
GEARS = {
    "from the base circle": PINION,
    "from the fillet": SpurGear(42, 2.5, 20 * DEG, 15.0, profile_shift=0.2),
    "full round": SpurGear(12, 2.5, 25 * DEG, 20.0, profile_shift=0.6),
}
each_gear = pytest.mark.parametrize("gear", GEARS.values(), ids=GEARS.keys())
SMALL = SpurGear(8, 1.0, 20 * DEG, 5.0, profile_shift=0.4)


@pytest.fixture(scope="module")
def shared_cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(autouse=True)
def _cache_of_the_tests(shared_cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TOL3D_CACHE", str(shared_cache))


def rack_contact(
    gear: SpurGear, moved: np.ndarray, flank: Flank, thinner: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Flank points of tooth 0 and outward normals, made by the straight flank of a rack that moved by s [mm].

    The rack's flank stands at the pressure angle; it touches where the normal through the pitch point
    (r, 0) meets it, d = (S/2 - s) cos(alpha) away, and the gear has turned by s/r.
    """
    r, alpha = gear.module * gear.teeth / 2, gear.pressure_angle
    thickness = gear.module * (math.pi / 2 + 2 * gear.profile_shift * math.tan(alpha)) - thinner
    thickness += gear.tooth_thickness_deviation
    d = (thickness / 2 - moved) * math.cos(alpha)
    normal = math.sin(alpha) - 1j * math.cos(alpha)
    back = np.exp(-1j * moved / r)
    points, normals = (r + d * normal) * back, normal * back
    at, outwards = (np.stack([part.real, flank * part.imag], axis=-1) for part in (points, normals))
    return at, outwards


def rack_place(gear: SpurGear, radius: np.ndarray, thinner: float = 0.0) -> np.ndarray:
    """Travel of the rack when it touches at those radii: R^2 = r^2 + 2 r d sin(alpha) + d^2."""
    r, alpha = gear.module * gear.teeth / 2, gear.pressure_angle
    thickness = gear.module * (math.pi / 2 + 2 * gear.profile_shift * math.tan(alpha)) - thinner
    thickness += gear.tooth_thickness_deviation
    root = np.sqrt(np.maximum((r * math.sin(alpha)) ** 2 + radius**2 - r**2, 0.0))
    return thickness / 2 - (root - r * math.sin(alpha)) / math.cos(alpha)


def off_the_rack(gear: SpurGear, points: np.ndarray, flank: Flank, thinner: float = 0.0) -> np.ndarray:
    """Distances [mm] of points (n, 2) from the rack-made flank at the same radii."""
    exact, _ = rack_contact(gear, rack_place(gear, np.hypot(*points.T), thinner), flank, thinner)
    return np.hypot(*(points - exact).T)


# measuring strips -----------------------------------------------------------------------------------


@each_gear
def test_strips_lie_on_the_flank_a_rack_makes(gear: SpurGear) -> None:
    strips = measuring_strips(gear, 120)
    for flank in (RIGHT, LEFT):
        profile = strips.inner[flank][:, :2]
        assert off_the_rack(gear, profile, flank).max() < FLANK_BOUND
        _, normals = rack_contact(gear, rack_place(gear, np.hypot(*profile.T)), flank)
        # The oracle's place is a square root: at the base circle a rounding of 1e-16 becomes 1e-8 of
        # the radius. Elsewhere the cubic spline's slope is off by h^3 P''''/24 / (r_b t) < 1e-5.
        assert np.abs(strips.normals[flank][:, :2] - normals).max() < 1e-5
        assert np.hypot(*profile[-1]) == pytest.approx(gear.tip_radius, abs=1e-6)
    assert 0 < strips.flank_error < FLANK_BOUND
    for end, side in ((strips.inner, -1), (strips.outer, 1)):
        assert np.array_equal(end[flank], np.hstack([profile, np.full((len(profile), 1), side * gear.face_width / 2)]))


def _deviation_of_chords(gear: SpurGear, strips: FlankStrips, flank: Flank) -> np.ndarray:
    """Largest distance of the rack-made flank from each chord, (steps,), from 200 places a chord."""
    ends = rack_place(gear, np.hypot(*strips.inner[flank].T[:2]))
    # uniform in the square root: where the involute has its cusp, roll ~ place and arc ~ roll^2
    places = ends[:-1, None] + np.diff(ends)[:, None] * np.linspace(0, 1, 201)
    curve = rack_contact(gear, places.ravel(), flank)[0].reshape(*places.shape, 2)
    begin, end = strips.inner[flank][:-1, :2], strips.inner[flank][1:, :2]
    along = (end - begin) / np.linalg.norm(end - begin, axis=1, keepdims=True)
    off = curve - begin[:, None]
    return np.abs(off[..., 0] * along[:, None, 1] - off[..., 1] * along[:, None, 0]).max(axis=1)


@each_gear
def test_chord_error_is_not_below_the_true_one_nor_far_above(gear: SpurGear) -> None:
    strips = measuring_strips(gear, 60)
    true = max(_deviation_of_chords(gear, strips, flank).max() for flank in (RIGHT, LEFT))
    # below: the faces' own 1 nm; above: 1 % margin for a maximum between samples
    assert true - 1e-6 <= strips.chord_error <= 1.011 * true + 1e-6
    assert strips.chord_error >= true - strips.flank_error


@each_gear
def test_chord_error_falls_with_order_two(gear: SpurGear) -> None:
    errors = [measuring_strips(gear, steps).chord_error for steps in (30, 60, 120)]
    # exactly 4 where every sagitta is r_b t dt^2/8; 2 % for the faces' own error and the margin
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.02)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.02)


@each_gear
def test_steps_share_one_sagitta(gear: SpurGear) -> None:
    sagittas = _deviation_of_chords(gear, measuring_strips(gear, 60), RIGHT)
    # from the base circle the first chord spans a cusp: 4/81 r_b t^3 instead of r_b t^3/18, 0.89 of the rest
    assert sagittas.min() > 0.88 * sagittas.max()


def test_chord_error_of_the_reference_pair_is_the_closed_form() -> None:
    strips = measuring_strips(PINION, 120)
    # r_b/8 (delta/1.5)^2, delta the step in roll^1.5 (sagitta r_b t dt^2/8)
    delta = (PINION.tip_roll**1.5 - PINION.form_roll**1.5) / 120
    assert strips.chord_error == pytest.approx(PINION.base_radius / 8 * (delta / 1.5) ** 2, rel=0.02)


@each_gear
def test_pulled_strips_are_the_flanks_of_a_thinner_gear(gear: SpurGear) -> None:
    slack, strips = 0.03, measuring_strips(gear, 60)
    for flank in (RIGHT, LEFT):
        vertices, _ = strip_mesh(strips, flank, slack)
        # A parallel of an involute is the same involute of a gear thinner by 2 slack / cos(alpha). At
        # roll slack/r_b it turns back; points within two slacks of that lie beside it and are left out.
        far = strips.parameter > 2 * slack / gear.base_radius
        points = vertices[: len(strips.parameter), :2][far]
        assert off_the_rack(gear, points, flank, 2 * slack / math.cos(gear.pressure_angle)).max() < FLANK_BOUND


def test_strip_triangles_look_out_of_the_tooth_and_cover_the_face() -> None:
    strips = measuring_strips(PINION, 60)
    for flank in (RIGHT, LEFT):
        vertices, triangles = strip_mesh(strips, flank, 0.0)
        assert vertices.shape == (122, 3)
        assert triangles.shape == (120, 3)
        a, b, c = (vertices[triangles[:, k]] for k in range(3))
        area = np.cross(b - a, c - a) / 2
        # right looks down in azimuth: tooth 0 lies on +x, so towards -y; left towards +y
        assert (-flank * area[:, 1] > 0).all()
        # length of an involute: r_b t^2/2; chords are shorter by 8/3 (sagitta/length)^2, under 1e-6 here
        length = PINION.base_radius * PINION.tip_roll**2 / 2
        assert np.linalg.norm(area, axis=1).sum() == pytest.approx(length * PINION.face_width, rel=1e-5)


def test_scale_grows_the_flank_but_not_the_slack() -> None:
    strips, slack, scale = measuring_strips(PINION, 60), 0.03, 1.0005
    grown, _ = strip_mesh(strips, RIGHT, slack, scale)
    # a scaled gear is the gear of the scaled module
    larger = dataclasses.replace(PINION, module=PINION.module * scale, face_width=PINION.face_width * scale, bore=0.0)
    far = strips.parameter > 2 * slack / PINION.base_radius
    points = grown[: len(strips.parameter), :2][far]
    assert off_the_rack(larger, points, RIGHT, 2 * slack / math.cos(PINION.pressure_angle)).max() < FLANK_BOUND
    assert np.abs(grown[:, 2]).max() == pytest.approx(larger.face_width / 2, rel=1e-12)


# display mesh ---------------------------------------------------------------------------------------


def _section(gear: SpurGear) -> float:
    return gear.transverse_area - math.pi * gear.bore**2 / 4


@pytest.mark.slow
@each_gear
@pytest.mark.parametrize("deflection", [0.05, 0.005])
def test_display_mesh_is_closed_and_as_large_as_its_chord_error_allows(gear: SpurGear, deflection: float) -> None:
    found = display_mesh(gear, deflection)
    mesh = trimesh.Trimesh(found.vertices, found.triangles, process=False)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert 0 < found.chord_error <= deflection
    assert mesh.bounds[:, 2] == pytest.approx([-gear.face_width / 2, gear.face_width / 2])
    # between surface and mesh there is at most the chord error over the mesh's walls
    walls = mesh.area_faces[np.abs(mesh.face_normals[:, 2]) < 0.5].sum()
    assert abs(mesh.volume - _section(gear) * gear.face_width) <= 1.01 * found.chord_error * walls


@each_gear
def test_display_vertices_carry_the_side_they_lie_on(gear: SpurGear) -> None:
    found = display_mesh(gear, 0.005)
    radius, angle = np.hypot(*found.vertices[:, :2].T), np.arctan2(found.vertices[:, 1], found.vertices[:, 0])
    on_flanks = (radius > gear.form_radius + 1e-6) & (radius < gear.tip_radius - 1e-6)
    assert (found.side[on_flanks] != 0).all()
    for flank in (RIGHT, LEFT):
        mine = on_flanks & (found.side == flank)
        pitch = 2 * math.pi / gear.teeth
        turned = angle[mine] - pitch * np.round(angle[mine] / pitch)
        points = radius[mine, None] * np.stack([np.cos(turned), np.sin(turned)], axis=-1)
        assert off_the_rack(gear, points, flank).max() < FLANK_BOUND
    assert (found.side == RIGHT).sum() == (found.side == LEFT).sum()


def test_a_thickened_display_mesh_is_the_mesh_of_the_thicker_gear() -> None:
    deviation = -0.08
    found = display_mesh(PINION, 0.005)
    vertices = found.thickened(deviation / (2 * PINION.reference_radius))
    thinner = dataclasses.replace(PINION, tooth_thickness_deviation=deviation)
    mesh = trimesh.Trimesh(vertices, found.triangles, process=False)
    assert mesh.is_watertight
    nominal = trimesh.Trimesh(found.vertices, found.triangles, process=False)
    # chords cut off the same on both (the root arcs grow by 0.1 %), so the volumes differ as the sections do
    change = (thinner.transverse_area - PINION.transverse_area) * PINION.face_width
    assert mesh.volume - nominal.volume == pytest.approx(change, rel=1e-3)
    radius = np.hypot(*vertices[:, :2].T)
    assert np.abs(radius - np.hypot(*found.vertices[:, :2].T)).max() < 1e-12
    first = np.abs(np.arctan2(vertices[:, 1], vertices[:, 0])) < math.pi / PINION.teeth
    flank = first & (found.side == RIGHT) & (radius > PINION.base_radius) & (vertices[:, 2] > 0)
    assert flank.sum() > 3
    assert off_the_rack(thinner, vertices[flank, :2], RIGHT).max() < FLANK_BOUND


# STEP -----------------------------------------------------------------------------------------------


def test_step_assembly_keeps_names_places_and_volumes(tmp_path: Path) -> None:
    angle = 0.3
    pose = np.eye(4)
    pose[:2, :2] = [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    pose[:3, 3] = 12.5, -1.0, 0.25
    wheel = dataclasses.replace(SMALL, teeth=12, tooth_thickness_deviation=-0.03)
    parts = [PosedGear("pair", SMALL, np.eye(4)), PosedGear("große 齿轮 𝛼", wheel, pose)]
    export_step(parts, tmp_path / "pair.step")
    found = cq.Assembly.importStep(str(tmp_path / "pair.step")).objects
    for part in parts:
        place = found[part.name].loc
        assert np.array(place.toTuple()[0]) == pytest.approx(part.world_from_part[:3, 3], abs=1e-9)
        tip = cq.Vertex.makeVertex(1, 0, 0).moved(place).toTuple()
        assert tip == pytest.approx(part.world_from_part[:3, 0] + part.world_from_part[:3, 3], abs=1e-9)
        volume = of_kind(cq.Shape, found[part.name].obj).Volume()
        gear = of_kind(SpurGear, part.gear)
        assert volume == pytest.approx(gear.transverse_area * gear.face_width, rel=1e-6)
    assert len({known(found[part.name].color).toTuple() for part in parts}) == 2
    assert [file.name for file in tmp_path.iterdir()] == ["pair.step"]


def test_step_to_a_folder_that_is_not_there_is_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(RunError, match="nowhere"):
        export_step([PosedGear("a", SMALL, np.eye(4))], tmp_path / "nowhere" / "a.step")


# cache ----------------------------------------------------------------------------------------------


@pytest.fixture
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("TOL3D_CACHE", str(tmp_path / "kept"))
    return tmp_path / "kept"


def _refuse_to_build() -> NoReturn:
    raise AssertionError("built again")


def _same(first: FlankStrips, second: FlankStrips) -> bool:
    pairs = [(first.inner[f], second.inner[f]) for f in (RIGHT, LEFT)]
    pairs += [(first.normals[f], second.normals[f]) for f in (RIGHT, LEFT)] + [(first.parameter, second.parameter)]
    numbers = first.chord_error == second.chord_error and first.flank_error == second.flank_error
    return numbers and all(np.array_equal(one, other) for one, other in pairs)


def test_what_is_kept_is_read_back_bit_for_bit_without_building(
    own_cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    built = measuring_strips(SMALL, 20)
    monkeypatch.setattr(strips, "cad", _refuse_to_build)
    assert _same(built, measuring_strips(SMALL, 20))
    with pytest.raises(AssertionError, match="built again"):
        measuring_strips(SMALL, 21)


@pytest.mark.parametrize("field", dataclasses.fields(SpurGear), ids=lambda field: field.name)
def test_every_field_of_a_gear_is_in_the_key(own_cache: Path, field: dataclasses.Field[Any]) -> None:
    value = getattr(SMALL, field.name)
    # a last-bit change counts; None becomes what it stands for, another description all the same
    changed = math.nextafter(0.38 if value is None else value, math.inf)
    if field.name in ("teeth", "hand"):
        changed = {"teeth": value + 1, "hand": -value}[field.name]
    other = dataclasses.replace(SMALL, **{field.name: cast(Any, changed)})
    built: list[SpurGear] = []

    def build(gear: SpurGear) -> dict[str, np.ndarray]:
        built.append(gear)
        return {"x": np.zeros(1)}

    for gear in (SMALL, other, SMALL, other):
        cache.cached("strips", gear, {"steps": 20}, partial(build, gear))
    assert built == [SMALL, other]


def test_a_changed_builder_makes_old_entries_unreachable(own_cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    measuring_strips(SMALL, 20)
    monkeypatch.setattr(strips, "cad", _refuse_to_build)
    monkeypatch.setattr(cache, "sources_of", lambda module: {module: "another program"})
    with pytest.raises(AssertionError, match="built again"):
        measuring_strips(SMALL, 20)


@pytest.mark.parametrize(
    "damage",
    [
        lambda content: b"",
        lambda content: content[: len(content) // 2],
        lambda content: content[:-1],
        lambda content: content[:900] + bytes([content[900] ^ 1]) + content[901:],
        lambda content: b"not an archive",
    ],
    ids=["empty", "half", "one byte short", "one bit", "noise"],
)
def test_a_damaged_entry_is_built_anew_and_mended(
    own_cache: Path, monkeypatch: pytest.MonkeyPatch, damage: Callable[[bytes], bytes]
) -> None:
    built = measuring_strips(SMALL, 20)
    (entry,) = own_cache.iterdir()
    whole = entry.read_bytes()
    entry.write_bytes(damage(whole))
    assert _same(built, measuring_strips(SMALL, 20))
    monkeypatch.setattr(strips, "cad", _refuse_to_build)
    assert _same(built, measuring_strips(SMALL, 20))


def test_a_folder_that_cannot_be_written_costs_a_warning_only(own_cache: Path) -> None:
    own_cache.write_text("a file where the folder should be")
    with pytest.warns(CacheWarning, match="TOL3D_CACHE"):
        strips = measuring_strips(SMALL, 20)
    assert strips.inner[RIGHT].shape == (21, 3)
    assert own_cache.is_file()


def test_a_disk_that_fills_up_leaves_no_torn_file(own_cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> NoReturn:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.warns(CacheWarning, match="No space left"):
        measuring_strips(SMALL, 20)
    assert list(own_cache.iterdir()) == []


BUILD_TOGETHER = """
import hashlib, math, pathlib, sys, time
from tol3d.gears import SpurGear
from tol3d.cad.solids import measuring_strips
from tol3d.cad.solids.lazy import cad
cad()
mine, other = (pathlib.Path(name) for name in sys.argv[1:3])
mine.touch()
give_up = time.monotonic() + 60
while not other.exists() and time.monotonic() < give_up:
    time.sleep(0.001)
strips = measuring_strips(SpurGear(8, 1.0, math.radians(20), 5.0, profile_shift=0.4), 20)
print(hashlib.sha256(b"".join(strips.inner[f].tobytes() for f in (1, -1))).hexdigest())
"""


@pytest.mark.slow
def test_two_processes_that_build_at_once_end_with_one_whole_entry(own_cache: Path, tmp_path: Path) -> None:
    ready = [str(tmp_path / "first"), str(tmp_path / "second")]
    runs = [
        subprocess.Popen([sys.executable, "-c", BUILD_TOGETHER, *names], stdout=subprocess.PIPE, text=True)
        for names in (ready, ready[::-1])
    ]
    printed = [run.communicate(timeout=120)[0] for run in runs]
    assert [run.returncode for run in runs] == [0, 0]
    assert printed[0] == printed[1] != ""
    assert [entry.suffix for entry in own_cache.iterdir()] == [".npz"]


WARM = """
import math, sys
from tol3d.gears import SpurGear
from tol3d.cad.solids import measuring_strips
measuring_strips(SpurGear(8, 1.0, math.radians(20), 5.0, profile_shift=0.4), 20)
print(sorted({"cadquery", "OCP", "scipy"} & set(sys.modules)))
"""


def test_a_warm_run_loads_no_cad(own_cache: Path) -> None:
    measuring_strips(SMALL, 20)
    warm = subprocess.run([sys.executable, "-c", WARM], capture_output=True, text=True, check=True)
    assert warm.stdout.strip() == "[]"


def test_the_folder_is_the_users_cache_unless_stated(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("TOL3D_CACHE")
    assert cache_folder().name == "tol3d"
    monkeypatch.setenv("TOL3D_CACHE", str(Path("some", "where")))
    assert cache_folder() == Path("some", "where")


@pytest.mark.slow
def test_the_reference_wheel_has_the_chord_error_that_is_promised(own_cache: Path) -> None:
    wheel = SpurGear(110, 2.5, 20 * DEG, 20.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        strips = measuring_strips(wheel, 120)
    assert strips.chord_error == pytest.approx(5.2e-6, rel=0.01)  # r_b/8 (delta/1.5)^2 as above, 1 % margin
