"""Differences of the methods of parts, of gears in a housing and of transmission errors: explained, or warned of.

What is wrong in an analytic method is put in by scaling the deviations of one contributor that it sees. Without it, no
shipped scene is warned of.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import pytest
from places import SCENES
from shipped import shipped

from tol3d import Overrides, load_scene
from tol3d.assembly.methods import TorsorMethod
from tol3d.gearing.machine.methods import MachineMethod
from tol3d.gearing.methods.analytic import AnalyticMethod
from tol3d.simulate import simulation_of
from tol3d.study.results.agreement.differences import explanations
from tol3d.study.results.agreement.explanation import Explanation, faults
from tol3d.study.system.stated import component_slices
from tol3d.study.system.trials import Trials
from tol3d.study.tallies.tally import PILOT_TRIALS, Tally, grids_of
from tol3d.study.trials.columns import columns_of
from tol3d.study.trials.draws import drawn

LONG = (
    *("every_assembly_field", "hole_and_slot", "gearbox_in_housing", "helical_gearbox", "housed_gears"),
    *("bolted_cover", "box_with_discs"),
)
METHODS: Mapping[str, Any] = {
    "door": TorsorMethod,
    "cover_on_base": TorsorMethod,
    "housed_gears": MachineMethod,
    "two_sided_te": AnalyticMethod,
}


def explained(scene: str, trials: int) -> Mapping[str, Explanation]:
    """Explanations of the differences of a scene's first trials, without its files."""
    simulation = simulation_of(load_scene(SCENES / f"{scene}.yaml"), Overrides(trials=trials))
    system = simulation.system
    method = system.method("exact", system.materials("exact"))
    columns = columns_of(system, method, drawn(simulation, 0, trials))
    grids = grids_of(system, {name: column[:PILOT_TRIALS] for name, column in columns.items()})
    return explanations(simulation, method, Tally.of(simulation, grids, columns))


@contextmanager
def scaled(patch: pytest.MonkeyPatch, scene: str, name: str, factor: float) -> Iterator[None]:
    """The analytic method of a scene sees other deviations of one contributor."""
    simulation = simulation_of(load_scene(SCENES / f"{scene}.yaml"), Overrides())
    own, kind = component_slices(simulation.system)[name], METHODS[scene]
    right: Any = kind.answers

    def wrong(self: Any, trials: Trials, measures: Any) -> Any:
        if getattr(self, "exact", False):  # of gears in a housing both methods are of one kind
            return right(self, trials, measures)
        deviations = trials.deviations.copy()
        deviations[:, own] *= factor
        return right(self, replace(trials, deviations=deviations), measures)

    with patch.context() as other:
        other.setattr(kind, "answers", wrong)
        yield


@pytest.mark.parametrize(
    "scene",
    [
        pytest.param(own, marks=pytest.mark.slow) if own in LONG else own
        for own in (*shipped("assembly"), *shipped("machine"))
        if own != "robot_arm"  # which takes minutes; test_assembly_scenes.py asks it of fewer trials
    ],
)
def test_no_shipped_scene_of_parts_is_warned_of(scene: str) -> None:
    found = explained(scene, 1000)
    assert list(faults(found)) == []
    assert [name for name, own in found.items() if own.undecided] == []


@pytest.mark.parametrize(
    ("scene", "measure", "name", "factor"),
    [
        ("door", "upper gap", "body upper hinge x", -1.0),
        ("door", "upper gap", "door lower hinge x", 1.03),
        ("cover_on_base", "flush", "cover thickness", 1.03),
        ("cover_on_base", "hole offset", "base hole position", -1.0),
        pytest.param("housed_gears", "lost motion", "far middle bore position", -1.0, marks=pytest.mark.slow),
        pytest.param("housed_gears", "lost motion", "middle bore position", 1.05, marks=pytest.mark.slow),
        pytest.param("two_sided_te", "drive TE", "wheel eccentricity", 1.03, marks=pytest.mark.slow),
        pytest.param("two_sided_te", "back TE", "pinion eccentricity", 0.97, marks=pytest.mark.slow),
    ],
)
def test_a_wrong_effect_of_a_contributor_is_named(
    scene: str, measure: str, name: str, factor: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    with scaled(monkeypatch, scene, name, factor):
        found = explained(scene, 1000)[measure]
    assert [part.contributor for part in found.linear if not part.by] == [name]
    assert any(f"the two methods disagree on {name}:" in fault for fault in found.faults)
