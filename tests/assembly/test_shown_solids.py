"""Presentation and export of parts with solids: at their poses in the trial, their features on them."""

import math
import sys
from pathlib import Path
from typing import NoReturn

import cadquery as cq
import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray
from of_kind import of_kind
from rendering import renders
from scene_texts import scene_of

from tol3d.assembly.model import Axis, Plane, RoundPlane, Slot
from tol3d.assembly.presenting import PRESENTER
from tol3d.assembly.presenting.shown_assembly import OPACITY, RIGID
from tol3d.assembly.presenting.symbols import MOST_NAMED, SIDES, WALL, mark
from tol3d.assembly.presenting.tables import drawing_blocks
from tol3d.assembly.system import AssemblySystem
from tol3d.errors import InputError
from tol3d.report import export_run, view_run
from tol3d.report.page import page
from tol3d.simulate import Overrides, run_scene, simulation_of
from tol3d.study.runs.run import Run

Array = NDArray[np.float64]

POLYGON = SIDES / 2 * math.sin(2 * math.pi / SIDES)  # area of the regular polygon in a circle of radius 1

# all numbers are constants: the top stands 0.3 mm high, the pin 0.2 mm aside along x; what lies on them goes along
SCENE = """
scene: a turned cover
parts:
  base:
    kind: solid
    builder:
      {kind: plate, length: 120 mm, width: 80 mm, thickness: 20 mm,
       pins: {pin: {at: [30 mm, 10 mm], diameter: 10 mm, height: 8 mm}}}
    features:
      top: {kind: plane, at: [0 mm, 0 mm, 20 mm], normal: [0, 0, 1], extent: [120 mm, 80 mm]}
      pin: {kind: cylinder, at: [30 mm, 10 mm, 24 mm], axis: [0, 0, 1], length: 8 mm, diameter: 10 mm}
      side: {kind: plane, at: [0 mm, -40 mm, 10 mm], normal: [0, -1, 0], extent: [120 mm, 20 mm]}
  cover:
    kind: solid
    placed: {at: [30 mm, 10 mm, 20 mm], x: [0, 1, 0]}
    builder:
      {kind: plate, length: 60 mm, width: 40 mm, thickness: 8 mm, holes: {hole: {at: [0 mm, 0 mm], diameter: 10.5 mm}}}
    features:
      under: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [60 mm, 40 mm]}
      hole: {kind: cylinder, at: [0 mm, 0 mm, 4 mm], axis: [0, 0, 1], length: 8 mm, diameter: 10.5 mm, hole: true}
  gauge:
    kind: solid
    features: {tip: {kind: point, at: [0 mm, 0 mm, 60 mm]}}
tolerances:
  top height: {kind: plus_minus, of: base.top, distribution: {kind: constant, value: 0.3 mm}}
  pin aside:
    kind: plus_minus
    of: base.pin
    datums: [top, side]
    along: [1, 0, 0]
    distribution: {kind: constant, value: 0.2 mm}
moves:
  table: {kind: fix, part: base}
  stand: {kind: fix, part: gauge}
  cover on:
    kind: mate
    part: cover
    relations:
      - {kind: coincident, from: cover.under, to: base.top}
      - {kind: coaxial, from: cover.hole, to: base.pin}
measures:
  apart: {kind: distance, from: gauge.tip, to: cover.hole}
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("turned")
    (folder / "turned.yaml").write_text(SCENE, encoding="utf-8")
    return run_scene(folder / "turned.yaml", overrides=Overrides(trials=3), out=folder / "run")


def bounds(surface: tuple[Array, NDArray[np.int64]]) -> Array:
    """Lowest and highest x, y, z (2, 3)."""
    return np.stack([surface[0].min(axis=0), surface[0].max(axis=0)])


@pytest.mark.parametrize("magnify", [1.0, 5.0])
def test_solids_stand_at_their_poses(run: Run, magnify: float) -> None:
    """The cover is turned by 90 degrees, so 60 mm lie along y; the pin takes it along x, the top along z."""
    shown = PRESENTER.display(run, 1, magnify=magnify)
    (world,) = shown.worlds
    base, cover, gauge = world.bodies
    x, z = 30 + 0.2 * magnify, 20 + 0.3 * magnify
    assert bounds(base.mesh) == pytest.approx(np.array([(-60, -40, 0), (60, 40, 28)]), abs=1e-9)
    assert bounds(cover.mesh) == pytest.approx(np.array([(x - 20, -20, z), (x + 20, 40, z + 8)]), abs=1e-9)
    assert cover.mesh[0].shape[0] > 8  # with its hole
    assert trimesh.Trimesh(*cover.mesh, process=False).is_watertight
    assert [body.opacity for body in world.bodies] == [OPACITY, OPACITY, 1.0]
    assert gauge.posed is None
    assert RIGID in shown.notes


@pytest.mark.parametrize("magnify", [1.0, 5.0])
def test_features_on_solids_show_how_they_deviate(run: Run, magnify: float) -> None:
    """The solid of the base stays; the marks of its top and pin are displaced, astride of where these are."""
    (world,) = PRESENTER.display(run, 1, magnify=magnify).worlds
    base = world.bodies[0]
    assert base.detail_mesh is not None
    vertices, _ = base.detail_mesh
    half = WALL * 1.0 / 2  # symbols are as thick as 1/120 of the largest extent, 120 mm
    top = 20 + 0.3 * magnify
    rim = vertices[(np.abs(vertices[:, 2] - top) < 0.5) & (np.abs(vertices[:, 0]) > 50) & (vertices[:, 1] > -39.5)]
    low, high = np.unique(rim[:, 2].round(6))
    assert (low, high) == pytest.approx((top - half, top + half), abs=1e-6)
    # a datum frame on the top goes up with it, and the pin in that frame
    pin = vertices[(vertices[:, 2] > top + 3.5)]
    assert (pin[:, 0].min() + pin[:, 0].max()) / 2 == pytest.approx(30 + 0.2 * magnify, abs=1e-9)
    assert np.ptp(pin[:, 0]) == pytest.approx(10 + 2 * half, abs=1e-9)
    # the cover and its hole go along, its hole's mark astride of it from its bottom to its top
    cover = world.bodies[1]
    assert cover.detail_mesh is not None
    low, high = bounds(cover.detail_mesh)
    assert (low[2], high[2]) == pytest.approx((top - half, top + 8), abs=1e-9)
    tube = cover.detail_mesh[0][cover.detail_mesh[0][:, 2] > top + 1]
    assert (tube.min(axis=0) + tube.max(axis=0))[:2] / 2 == pytest.approx((30 + 0.2 * magnify, 10), abs=1e-9)
    assert world.points["base.pin"] == pytest.approx((30 + 0.2 * magnify, 10, 24 + 0.3 * magnify), abs=1e-9)
    assert set(world.points) == {
        "base.top, 1st datum", "base.side, 2nd datum", "base.pin", "cover.under", "cover.hole", "gauge.tip",
    }  # fmt: skip


def test_a_step_file_has_solids_by_name_at_their_poses(run: Run, tmp_path: Path) -> None:
    """Volumes by hand: a plate with a pin on it, a plate with a hole."""
    exported = export_run(run, 1, "step", out=tmp_path)
    assert exported.notes == (RIGID, "no solid, so not in the STEP file: gauge")
    (path,) = exported.files
    found = cq.Assembly.importStep(str(path)).objects
    base, cover = (of_kind(cq.Shape, found[name].obj) for name in ("base", "cover"))
    assert "gauge" not in found
    assert base.Volume() == pytest.approx(120 * 80 * 20 + np.pi * 5**2 * 8, rel=1e-9)
    assert cover.Volume() == pytest.approx((60 * 40 - np.pi * 5.25**2) * 8, rel=1e-9)
    box = cover.moved(found["cover"].loc).BoundingBox()
    assert (box.xmin, box.ymin, box.zmin) == pytest.approx((10.2, -20, 20.3), abs=1e-6)
    assert (box.xmax, box.ymax, box.zmax) == pytest.approx((50.2, 40, 28.3), abs=1e-6)


def test_files_of_triangles_hold_solids_without_marks_and_symbols_of_parts_without(run: Run, tmp_path: Path) -> None:
    (path,) = export_run(run, 1, "glb", magnify=5.0, out=tmp_path).files
    scene = of_kind(trimesh.Scene, trimesh.load(path))
    parts = {name: own.copy().apply_transform(scene.graph.get(name)[0]) for name, own in scene.geometry.items()}
    assert set(parts) == {"base", "cover", "gauge"}
    assert 1e3 * parts["base"].bounds == pytest.approx(np.array([(-60, -40, 0), (60, 40, 28)]), abs=1e-4)
    assert 1e3 * parts["cover"].bounds == pytest.approx(np.array([(11, -20, 21.5), (51, 40, 29.5)]), abs=1e-4)


def test_a_run_without_any_solid_has_no_step_file(tmp_path: Path) -> None:
    of_solids = ("builder:", "kind: plate", "pins:")
    bare = [line for line in SCENE.splitlines() if not any(word in line for word in of_solids)]
    scene = tmp_path / "bare.yaml"
    scene.write_text("\n".join(bare), encoding="utf-8")
    run = run_scene(scene, overrides=Overrides(trials=2), out=tmp_path / "run")
    with pytest.raises(InputError, match="a STEP file holds solids, and base, cover, gauge have none: give parts a"):
        export_run(run, 1, "step", out=tmp_path / "files")
    assert not (tmp_path / "files").exists()


def test_pictures_name_what_is_measured_and_datums_first(tmp_path: Path) -> None:
    """Twenty points stand first in the scene, and are left out of the picture all the same."""
    points = "".join(f"      p{k}: {{kind: point, at: [{k} mm, 0 mm, 20 mm]}}\n" for k in range(20))
    scene = tmp_path / "many.yaml"
    scene.write_text(SCENE.replace("    features:\n      top:", f"    features:\n{points}      top:"), encoding="utf-8")
    run = run_scene(scene, overrides=Overrides(trials=2), out=tmp_path / "run")
    shown = PRESENTER.display(run, "nominal", magnify=1.0)
    (world,) = shown.worlds
    assert len(world.points) == MOST_NAMED
    assert list(world.points)[:5] == [
        "cover.hole", "gauge.tip", "base.top, 1st datum", "base.side, 2nd datum", "base.pin",
    ]  # fmt: skip
    (note,) = shown.view(None).notes
    assert note.startswith("named are 16 features, those that measures read and datums before others; not base.p11, ")
    assert note.endswith(" and 6 more")  # 26 features less 16 named and 4 listed


@pytest.mark.parametrize(
    ("shape", "volume"),
    [
        (Plane((40.0, 30.0)), (40 * 30 - 36 * 26) * 2 * WALL),
        (Slot((40.0, 30.0), 6.0), 2 * (40 * 30 - 36 * 26) * 2 * WALL),
        (RoundPlane(15.0), POLYGON * (15**2 - 13**2) * 2 * WALL),
        (Axis(20.0, 10.0), POLYGON * (5 + WALL) ** 2 * 20),
        (Axis(20.0, 10.0, inner=True), POLYGON * ((5 + WALL) ** 2 - (5 - WALL) ** 2) * 20),
        (Axis(20.0), POLYGON * 0.5**2 * 20),
    ],
)
def test_marks_are_closed_and_as_large_as_stated(shape: Axis | Plane | RoundPlane, volume: float) -> None:
    """2 mm wide, and 2 mm times WALL thick across the surface."""
    mesh = trimesh.Trimesh(*mark(shape, 2.0), process=False)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume == pytest.approx(volume, rel=1e-9)


@pytest.mark.slow
@renders
def test_a_picture_is_written(run: Run, tmp_path: Path) -> None:
    notes = view_run(run, 1, screenshot=tmp_path / "turned.png", magnify=5.0)
    assert (tmp_path / "turned.png").stat().st_size > 10_000
    assert notes == ("deviations 5 times as large; parts are placed by them", RIGID)


def test_check_lists_solids_and_loads_no_cad_for_what_it_has_seen(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    system = simulation_of(scene_of(SCENE, tmp_path), Overrides()).system
    assert isinstance(system, AssemblySystem)
    expected = [
        ("base", "plate", "120 × 80 × 28", "-60, -40, 0", "60, 40, 28"),
        ("cover", "plate", "60 × 40 × 8", "-30, -20, 0", "30, 20, 8"),
    ]
    assert [(row.label, *row.cells) for row in page(*drawing_blocks(system)).tables[0].rows] == expected

    def refuse() -> NoReturn:
        raise AssertionError("built again")

    monkeypatch.setattr(sys.modules["tol3d.cad.solids.display_mesh"], "cad", refuse)
    assert [(row.label, *row.cells) for row in page(*drawing_blocks(system)).tables[0].rows] == expected
