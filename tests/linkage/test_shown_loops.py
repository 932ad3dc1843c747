"""Presentation of linkages: their tables, their reach, and their motion."""

import csv
from pathlib import Path

import numpy as np
import pytest
from fixtures import Command
from linkage.drive_scene import drive_text, error
from oracles.spherical_drive import travels
from scene_texts import edited, refusal

from tol3d import Overrides, run_scene
from tol3d.assembly.linkage.loop import ClosedLoop
from tol3d.assembly.linkage.workspace import workspace_of
from tol3d.assembly.system import AssemblySystem
from tol3d.report.motion import motion_of
from tol3d.report.presenter import Mapped, presenter_at
from tol3d.simulate import load, simulation_of
from tol3d.study.trials.simulation import Simulation

MEASURES = error("error", "after: drive, at: middle") + error("worst", "after: drive, over: sweep, take: max")


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("shown") / "drive.yaml"
    place.write_text(drive_text(MEASURES, 200), "utf-8")
    return place


@pytest.fixture(scope="module")
def simulation(scene: Path) -> Simulation:
    return simulation_of(load(scene))


def test_check_tells_freedoms_poses_and_both_tables(tol3d: Command, scene: Path) -> None:
    code, told, _ = tol3d("check", str(scene))
    words = " ".join(told.split())
    assert code == 0
    assert "6 bodies; joints that place them leave 10 freedoms, inputs give 2, joints that shut loops take 6" in words
    assert "2 idle, held as they are" in words
    assert "'rod 1' turns about [0, 0, 1]" in words
    first, second = (f"{own:.6g} mm" for own in travels(np.radians(40.0), np.radians(45.0)))
    assert f"middle {first} {second} 40 45" in words
    assert "inputs by the output (inverse)" in words
    assert "the output by the inputs (forward)" in words


def test_the_workspace_ends_where_the_loop_is_singular(simulation: Simulation) -> None:
    """At 76.1655 deg towards 50.93 and 129.07 deg; condition numbers grow towards the end of every ray."""
    system = simulation.system
    assert isinstance(system, AssemblySystem)
    loop = next(move for move in system.assembly.moves if isinstance(move, ClosedLoop))
    found = workspace_of(loop, 8, 6)
    assert np.degrees(found.reach[1]) == pytest.approx(76.283, abs=2e-3)
    assert np.degrees(found.reach[3]) == pytest.approx(76.283, abs=2e-3)
    assert (np.diff(found.conditions, axis=1)[:, 2:] > 0.0).all()


@pytest.mark.slow
def test_a_map_of_sigma_is_that_of_the_measure(simulation: Simulation, tmp_path: Path) -> None:
    """Without a tilt sigma is 0.70 arc minutes, by the digest; it is drawn, and written as numbers."""
    presenter = presenter_at(simulation.presenter)
    assert isinstance(presenter, Mapped)
    found = presenter.workspace(simulation, "error", lambda text: None)
    rows = list(csv.reader(found.csv().splitlines()))
    assert rows[0][2] == "sigma of error [arcmin], first order"
    at_rest = [float(own[2]) for own in rows[1:] if float(own[1]) == 0.0]
    assert at_rest == pytest.approx([0.70] * len(at_rest), abs=4 * 0.70 / np.sqrt(2 * 2000) + 0.005)
    found.draw(tmp_path / "map.png")
    assert (tmp_path / "map.png").stat().st_size > 20_000


def test_a_loop_whose_output_does_not_tilt_is_mapped_over_its_inputs(tmp_path: Path) -> None:
    """A slider-crank: as well conditioned at either side of the dead centre, for the mechanism is symmetric."""
    own = simulation_of(load("slider_crank"))
    presenter = presenter_at(own.presenter)
    assert isinstance(presenter, Mapped)
    found = presenter.workspace(own, None, lambda text: None)
    rows = np.array([line.split(",") for line in found.csv().splitlines()[1:]], dtype=np.float64)
    assert rows[:, 0] == pytest.approx(np.linspace(-90.0, 90.0, 41))
    assert rows[:, 1] == pytest.approx(rows[::-1, 1], rel=1e-6)
    found.draw(tmp_path / "map.png")
    assert (tmp_path / "map.png").stat().st_size > 10_000


def test_a_build_moves_along_its_path(scene: Path, tmp_path: Path) -> None:
    run = run_scene(scene, overrides=Overrides(trials=50), out=tmp_path / "run")
    display = presenter_at("tol3d.assembly.presenting").display(run, "nominal", magnify=1.0)
    motion = motion_of(display, None, 5)
    assert [shot.title for shot in motion.shots] == ["sweep"]
    moved = [frame.poses["gear 2"][:3, 2] @ motion.frames[0].poses["gear 2"][:3, 2] for frame in motion.frames]
    tilts = np.degrees(np.arccos(np.clip(moved, -1.0, 1.0)))
    assert tilts == pytest.approx([20.0 * k for k in (0, 2, 4, 5, 7)], abs=1e-5)  # twice the tilt of the ring


def test_what_has_no_workspace_is_refused(tol3d: Command, tmp_path: Path) -> None:
    code, _, told = tol3d("workspace", "spur_pair", "--out", str(tmp_path / "none.png"))
    assert code == 2
    assert "expected a scene with a linkage (kind: close_loop), got none" in told


def test_a_pose_beyond_the_range_of_an_input_is_refused(scene: Path, tmp_path: Path) -> None:
    free = "        of: guide 2\n"
    said = refusal(edited(scene.read_text("utf-8"), (free, f"{free}        range: [-60 mm, 60 mm]\n")), tmp_path)
    assert "moves.drive.poses.wide: expected 'travel 2' from -60 mm to 60 mm, got -64.0345 mm" in said
