"""Presentation of assemblies: symbols are closed and as large as stated, features lie where the trial has them."""

import math
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
import trimesh
from assembly.datum_plate import plate
from assembly_trials import constant
from numpy.typing import NDArray
from places import SCENES

from tol3d.assembly.mechanism import ASSEMBLY
from tol3d.assembly.model import Axis, Cone, Plane, Point, RoundPlane, Shape, Slot
from tol3d.assembly.presenting import PRESENTER
from tol3d.assembly.presenting.symbols import SIDES, rod, symbol
from tol3d.assembly.summary_types import AssemblyMeasureSummary
from tol3d.errors import InputError
from tol3d.report import export_run
from tol3d.report.page import page
from tol3d.scene.entry import kind_of
from tol3d.simulate import Overrides, load, run_scene, simulation_of
from tol3d.study.runs.summary.kinds import default_kinds

Array = NDArray[np.float64]

OFF = {"b1": 0.3, "b2": -0.2, "c": 0.25, "ex": 0.05, "ey": -0.1}
POLYGON = SIDES / 2 * math.sin(2 * math.pi / SIDES)  # area of the regular polygon in a circle of radius 1


def frusta(radii: Array, heights: Array) -> float:
    """Volume of a pile of frusta of polygons."""
    a, b = radii[:-1], radii[1:]
    return float(POLYGON / 3 * (np.diff(heights) * (a**2 + a * b + b**2)).sum())


def ball(radius: float) -> float:
    latitudes = np.linspace(-math.pi / 2, math.pi / 2, SIDES // 2 + 1)
    return frusta(radius * np.cos(latitudes), radius * np.sin(latitudes))


def zone(radius: float) -> float:
    """Volume of a ball between 45 degrees of latitude, less the cones from its middle that end there."""
    latitudes = np.linspace(-math.pi / 4, math.pi / 4, SIDES // 4 + 1)
    cones = 2 * POLYGON / 3 * radius**3 * math.sqrt(0.5) ** 3
    return frusta(radius * np.cos(latitudes), radius * np.sin(latitudes)) - cones


@pytest.mark.parametrize(
    ("shape", "volume"),
    [
        (Point(), 4 / 3 * 2.0**3),
        (Plane((40.0, 30.0)), 40 * 30 * 2.0),
        (Slot((40.0, 30.0), 6.0, inner=False), 40 * 30 * 6.0),
        (Slot((40.0, 30.0), 6.0), 2 * 40 * 30 * 2.0),
        (RoundPlane(15.0), POLYGON * 15**2 * 2),
        (Axis(20.0), POLYGON * 0.5**2 * 20),
        (Axis(20.0, 10.0), POLYGON * 5**2 * 20),
        (Axis(20.0, 10.0, inner=True), POLYGON * (7**2 - 5**2) * 20),
        (Cone(20.0, diameters=(6.0, 0.0)), POLYGON * 3**2 * 20 / 3),
        (Cone(20.0, inner=True, diameters=(8.0, 12.0)), POLYGON * 20 * (6**2 + 6 * 8 + 8**2 - 4**2 - 4 * 6 - 6**2) / 3),
        (Point(10.0), ball(5.0)),
        (Point(10.0, inner=True), zone(7.0) - zone(5.0)),
    ],
)
def test_symbols_are_closed_and_look_outward(shape: Shape, volume: float) -> None:
    vertices, triangles = symbol(shape, 2.0)
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume == pytest.approx(volume, rel=1e-9)  # negative where faces look inward


def test_a_rod_runs_from_point_to_point() -> None:
    start, end = np.array([1.0, 2.0, 3.0]), np.array([4.0, -2.0, 8.0])
    mesh = trimesh.Trimesh(*rod(start, end, 0.5), process=False)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(POLYGON * 0.25 * math.sqrt(50), rel=1e-9)
    assert mesh.center_mass == pytest.approx((start + end) / 2, abs=1e-9)


@pytest.mark.parametrize("magnify", [1.0, 3.0])
def test_features_lie_where_the_trial_has_them(tmp_path: Path, magnify: float) -> None:
    scene = tmp_path / "plate.yaml"
    scene.write_text(plate({name: constant(own) for name, own in OFF.items()}), encoding="utf-8")
    run = run_scene(scene, overrides=Overrides(trials=3), out=tmp_path / "run")
    shown = PRESENTER.display(run, 1, magnify=magnify)
    (world,) = shown.worlds
    places = world.points
    assert places["plate.b1, 2nd datum"] == pytest.approx((20, magnify * 0.3, 0), abs=1e-12)
    assert places["plate.hole"] == pytest.approx((150 + magnify * 0.05, 60 - magnify * 0.1, 0), abs=1e-12)
    assert bool(shown.notes) == (magnify != 1.0)
    (body,) = world.bodies
    vertices, triangles = body.mesh
    assert trimesh.Trimesh(vertices, triangles, process=False).is_watertight
    with pytest.raises(InputError, match="trial-1: a STEP file holds solids, and plate has none: give"):
        export_run(run, 1, "step", out=tmp_path / "files")
    assert not (tmp_path / "files").exists()


def test_check_lists_features_with_their_datum_frames_and_moves(tmp_path: Path) -> None:
    scene = tmp_path / "plate.yaml"
    text = plate({name: constant(own) for name, own in OFF.items()})
    text = text.replace("of: plate.hole, along: [1, 0, 0]", "of: plate.hole, datums: [floor, b1-b2], along: [1, 0, 0]")
    text = text.replace("of: plate.hole, along: [0, 1, 0]", "of: plate.hole, datums: [floor, b1-b2], along: [0, 1, 0]")
    scene.write_text(text, encoding="utf-8")
    shown = page(*PRESENTER.check(simulation_of(load(scene), Overrides()))).csv()
    assert 'plate.hole,"axis, 10 mm long, along z","150, 60, 0","floor, b1-b2"' in shown
    assert 'plate.floor,"plane 200 × 100 mm, facing -z","100, 50, 0",its part' in shown
    assert "machine,fixed,plate," in shown


@pytest.mark.slow
def test_check_shows_what_floats() -> None:
    shown = page(*PRESENTER.check(simulation_of(load(SCENES / "hole_and_slot.yaml"), Overrides()))).csv()
    assert '"slot 10.06 mm wide, 14 × 8 mm, across y"' in shown
    assert '"base.pin 1 in plate.hole, base.pin 2 in plate.slot; 3 freedoms, random"' in shown
    assert "float of plate on the pins" in shown


def test_summaries_know_every_measure() -> None:
    (own,) = (kind for kind in default_kinds().every_measure if issubclass(kind, AssemblyMeasureSummary))
    assert set(get_args(own.model_fields["kind"].annotation)) == {kind_of(spec) for spec in ASSEMBLY.measures}
