"""A build that is stated by its deviations and its position is shown as that trial of a run, to the bit."""

import io
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh
from toys.parabola import PARABOLA
from toys.registered import TOYS, known

from tol3d import Overrides, Run, run_scene
from tol3d.report.body import World
from tol3d.report.html.view_model import ViewModel
from tol3d.report.presenter import Display, ShowsBuilds, Which, display_build, presenter_of
from tol3d.simulate import load, replayed, simulation_of
from tol3d.study.system.stated import mean_build, nominal_build
from tol3d.study.system.trials import Trials
from tol3d.study.trials.draws import drawn
from tol3d.study.trials.simulation import Simulation

TRIAL = 3
SLOW = [pytest.param(name, marks=pytest.mark.slow) for name in ("stewart", "rv_250aii", "gearbox_in_housing")]


def _ran(scene: str | Path, folder: Path) -> tuple[Run, Simulation]:
    """A run, and the simulation of its scene, made apart from it."""
    run = run_scene(scene, overrides=Overrides(trials=5, witness=0), out=folder)
    return run, simulation_of(load(scene), Overrides(trials=5, witness=0))


def _same(one: Display, other: Display) -> None:
    assert (one.label, one.notes) == (other.label, other.notes)
    assert [world.name for world in one.worlds] == [world.name for world in other.worlds]
    for first, second in zip(one.worlds, other.worlds, strict=True):
        assert [body.name for body in first.bodies] == [body.name for body in second.bodies]
        for body, again in zip(first.bodies, second.bodies, strict=True):
            np.testing.assert_array_equal(body.world_from_part, again.world_from_part)
            np.testing.assert_array_equal(body.mesh[0], again.mesh[0])
        assert _places(first) == _places(second)


def _places(world: World) -> dict[str, list[float]]:
    return {name: place.tolist() for name, place in {**world.points, **world.marks}.items()}


@pytest.mark.parametrize("magnify", [1.0, 10.0])
@pytest.mark.parametrize("name", ["spur_pair", "door", *SLOW])
def test_a_stated_build_is_shown_as_its_trial(name: str, magnify: float, tmp_path: Path) -> None:
    run, simulation = _ran(name, tmp_path / "run")
    presenter = presenter_of(run.found)
    system = simulation.system
    builds: dict[Which, Trials] = {
        TRIAL: drawn(simulation, TRIAL, 1),
        "nominal": nominal_build(system),
        "mean": mean_build(system, system.measures[0]),
    }
    for which, trials in builds.items():
        label = f"trial-{which}" if which == TRIAL else str(which)
        shown = display_build(replayed(simulation, trials), label, magnify=magnify)
        _same(shown, presenter.display(run, which, magnify=magnify))
    assert np.any(builds[TRIAL].deviations), "it deviates"


def test_a_presenter_without_magnification_of_its_own_is_given_a_build_with_larger_deviations(tmp_path: Path) -> None:
    with known(PARABOLA):
        run, simulation = _ran(TOYS / "parabola" / "spring.yaml", tmp_path / "run")
        presenter = presenter_of(run.found)
        assert not isinstance(presenter, ShowsBuilds)
        build = replayed(simulation, drawn(simulation, TRIAL, 1))
        for magnify in (1.0, 10.0):
            shown = display_build(build, f"trial-{TRIAL}", magnify=magnify)
            _same(shown, presenter.display(run, TRIAL, magnify=magnify))


def _model(name: str, factors: tuple[float, ...] = (1.0,)) -> ViewModel:
    simulation, model = simulation_of(load(name)), ViewModel()
    nominal = replayed(simulation, nominal_build(simulation.system))
    trial = replayed(simulation, drawn(simulation, TRIAL, 1))
    model.add("nominal", [(1.0, display_build(nominal, "nominal"), "as drawn")])
    model.add("trial", [(own, display_build(trial, "trial", magnify=own), f"x {own:g}") for own in factors])
    return model


@pytest.mark.parametrize("name", ["spur_pair", "door"])
def test_a_model_stands_as_its_display_does(name: str) -> None:
    model = _model(name, (1.0, 100.0))
    told = model.told()
    assert [build["name"] for build in told["builds"]] == ["nominal", "trial"]
    assert [[state["words"] for state in build["states"]] for build in told["builds"]] == [
        ["as drawn"],
        ["x 1", "x 100"],
    ]
    scene = trimesh.load_scene(io.BytesIO(model.glb()), file_type="glb")
    simulation = simulation_of(load(name))
    build = replayed(simulation, drawn(simulation, TRIAL, 1))
    for factor, state in zip((1.0, 100.0), told["builds"][1]["states"], strict=True):
        world = display_build(build, "trial", magnify=factor).worlds[0]
        assert [part["name"] for part in told["parts"]] == [body.name for body in world.bodies]
        for body, mesh, pose in zip(world.bodies, state["meshes"], state["poses"], strict=True):
            matrix = np.reshape(pose, (4, 4)).T
            drawn_at = scene.geometry[f"mesh-{mesh}"].vertices @ matrix[:3, :3].T + matrix[:3, 3]
            wanted = body.mesh[0] if body.detail_mesh is None else np.vstack([body.mesh[0], body.detail_mesh[0]])
            size = float(np.ptp(wanted, axis=0).max())
            assert np.abs(drawn_at - wanted).max() < 2e-3 * size  # ALIKE: such shapes are drawn as one
        assert state["names"].keys() == {*world.points, *world.marks}


def test_triangles_of_a_feature_lie_about_its_place() -> None:
    """The box's features are marks on a solid with coloured faces, those of the door symbols."""
    for name, least in (("door", 10), ("bracket_in_box", 16)):
        model, seen = _model(name), 0
        places = {
            label.partition(",")[0]: place for label, place in model.told()["builds"][0]["states"][0]["names"].items()
        }
        state = model.builds[0].states[0]
        for part, mesh, pose in zip(model.parts, state.meshes, state.poses, strict=True):
            vertices, triangles = model.surfaces[mesh]
            matrix = np.reshape(pose, (4, 4)).T
            if part.features:
                assert part.features[-1][1] + part.features[-1][2] == len(triangles)
            for feature, first, count in part.features:
                assert feature.startswith(f"{part.part}.")
                if feature in places:
                    seen += 1
                    used = vertices[np.unique(triangles[first : first + count])]
                    middle = (used.min(axis=0) + used.max(axis=0)) / 2 @ matrix[:3, :3].T + matrix[:3, 3]
                    others = [
                        float(np.linalg.norm(middle - place)) for label, place in places.items() if label != feature
                    ]
                    assert np.linalg.norm(middle - places[feature]) <= min(others)  # parts meet at some
        assert seen >= least


def test_a_model_needs_no_vtk() -> None:
    words = """
import sys
from tol3d.report.html.view_model import ViewModel
from tol3d.report.presenter import display_build
from tol3d.simulate import load, replayed, simulation_of
from tol3d.study.system.stated import nominal_build
simulation, model = simulation_of(load("door")), ViewModel()
build = replayed(simulation, nominal_build(simulation.system))
model.add("nominal", [(1.0, display_build(build, "nominal"), "")])
assert model.glb()[:4] == b"glTF"
print(*{"vtkmodules", "pyvista", "matplotlib", "cadquery"} & {*sys.modules})
"""
    done = subprocess.run([sys.executable, "-c", words], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""
