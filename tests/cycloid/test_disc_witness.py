"""FCL as the witness of a reducer's run, and as its engine: off by no more than it says."""

from pathlib import Path

import pytest
from places import SCENES

from tol3d import Overrides, load_scene, run_scene
from tol3d.gearing.cycloid.from_scene import rv_system
from tol3d.gearing.cycloid.system import RVSystem


@pytest.fixture(scope="module")
def system() -> RVSystem:
    return rv_system(load_scene(SCENES / "rv_250aii.yaml"))


def test_a_chord_error_counts_over_the_least_lever_of_a_working_pin(system: RVSystem) -> None:
    """0.7 of 85.8 mm; the cranks roll on the held sun, 1.5 turns a turn: 40.5 over 39."""
    measures = {measure.name: measure for measure in system.measures}
    one = 1e-3 / (0.7 * 85.8 * 40.5 / 39)
    for name, count in (("transmission error", 1), ("over a turn", 2), ("lost motion", 2)):
        measure = measures[name]
        assert system.chord_bound(measure, 1e-3) == pytest.approx(count * one * measure.per_internal)


@pytest.mark.slow
def test_the_witness_of_a_run_is_off_by_its_chord_error_at_most(tmp_path: Path) -> None:
    overrides = Overrides(trials=40, witness=10)
    found = run_scene(SCENES / "rv_250aii.yaml", out=tmp_path / "run", overrides=overrides).summary["witness"]
    assert set(found["measures"]) == {"transmission error", "lost motion"}  # a curve of 200 positions takes too long
    assert 0.1 < found["chord_error_um"] < 0.2
    for own in found["measures"].values():
        assert 0.0 < own["max_abs_difference"] <= own["expected_at_most"] + own["allowance"]
