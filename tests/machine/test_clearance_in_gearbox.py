"""A clearance of parts in a gearbox: the assembly's own numbers, beside backlashes that it does not change."""

from pathlib import Path

import numpy as np
import pytest
from places import SCENES

from tol3d import Overrides, run_scene
from tol3d.simulate import load, simulation_of
from tol3d.study.system.stated import component_slices
from tol3d.study.trials.draws import drawn

GEARS = (SCENES / "housed_gears.yaml").read_text("utf-8")
FOOT = """  foot:
    kind: solid
    placed: {at: [50 mm, 20 mm, -80 mm]}
    builder: {kind: plate, length: 200 mm, width: 140 mm, thickness: 10 mm}
    features:
      top: {kind: plane, at: [0 mm, 0 mm, 10 mm], normal: [0, 0, 1], extent: [200 mm, 140 mm]}
  guard:
    kind: solid
    placed: {at: [50 mm, 20 mm, -69.7 mm]}
    builder: {kind: plate, length: 60 mm, width: 40 mm, thickness: 4 mm}
    features:
      under: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [60 mm, 40 mm]}
"""
LAW = "distribution: {kind: uniform, lower: -200 um, upper: 200 um}"
ADDED = {
    "  input: {kind: shaft,": FOOT + "  input: {kind: shaft,",
    "moves:\n": f"  guard height: {{kind: plus_minus, of: guard.under, {LAW}}}\n\nmoves:\n"
    "  foot down: {kind: fix, part: foot}\n  guard on:\n    kind: mate\n    part: guard\n"
    "    relations: [{kind: distance, from: guard.under, to: foot.top, distance: 0.3 mm}]\n",
    "measures:\n": "measures:\n  guard over foot: {kind: clearance, from: foot, to: guard, lower_limit: 0 mm}\n",
}


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    text = GEARS
    for old, new in ADDED.items():
        assert text.count(f"\n{old}") == 1 or text.startswith(old), old
        text = text.replace(old, new, 1)
    place = tmp_path_factory.mktemp("gearbox") / "scene.yaml"
    place.write_text(text, "utf-8")
    return place


def test_a_clearance_follows_the_part_that_it_is_of(path: Path) -> None:
    simulation = simulation_of(load(path))
    system = simulation.system
    trials = drawn(simulation, 0, 40)
    height = trials.deviations[:, component_slices(system)["guard height"]][:, 0]
    for method in ("exact", "analytic"):
        found = system.method(method, system.materials(method)).answers(trials, system.measures)
        assert found.values["guard over foot"][:, 0] == pytest.approx(0.3 + height, abs=1e-9)
        assert all((codes == 0).all() for codes in found.status.values())


@pytest.mark.slow
def test_backlashes_are_those_without_the_clearance(path: Path, tmp_path: Path) -> None:
    asked = Overrides(trials=60, witness=5)
    with_it = run_scene(path, overrides=asked, out=tmp_path / "with").summary
    without = run_scene(SCENES / "housed_gears.yaml", overrides=asked, out=tmp_path / "without").summary
    for name, own in without["measures"].items():
        assert with_it["measures"][name]["geometric"] == own["geometric"]
    assert "overlap" in with_it["statuses"]
    assert "overlap" not in without["statuses"]
    assert with_it["measures"]["guard over foot"]["chord_error_um"] == 2.0
    assert with_it["witness"]["measures"]["guard over foot"]["max_abs_difference"] == pytest.approx(0.0, abs=1e-6)


def test_parts_that_overlap_have_the_status(path: Path) -> None:
    simulation = simulation_of(load(path))
    system, trials = simulation.system, drawn(simulation, 0, 2)
    trials.deviations[:, component_slices(system)["guard height"]] = [[-0.4], [0.1]]
    found = system.method("exact", system.materials("exact")).answers(trials, system.measures)
    codes = found.status["guard over foot"]
    assert system.statuses.by_code[codes].tolist() == ["overlap", "ok"]
    assert np.isnan(found.values["guard over foot"][:, 0]).tolist() == [True, False]
