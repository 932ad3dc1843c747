"""Builds with play as they are shown: floats stay shares of the room, and trials that do not build are passed over."""

import numpy as np
import pytest
from assembly.plates import hole, pin, two_plates
from scene_texts import scene_of

from tol3d.assembly.presenting.shown_assembly import ShownAssembly, display
from tol3d.simulate import run_scene
from tol3d.study.runs.run import Run
from tol3d.study.trials.overrides import Overrides

# a plate on one pin: its hole has between 0.02 and 0.2 mm more than the pin, or less than nothing in one of 44 trials
SCENE = two_plates(
    {"pin": pin((0, 0, 5), 10)},
    {"hole": hole((0, 0, 5), 10.1)},
    [("hole", "pin")],
    """
  hole size: {kind: size, of: plate.hole, distribution: {kind: normal, mean: 0 mm, sigma: 0.05 mm}}
  pin size: {kind: size, of: base.pin, distribution: {kind: constant, value: 0 mm}}
""",
    """
  shift: {kind: gap, from: base.pin, to: plate.hole, along: [1, 0, 0]}
  slack: {kind: slack, of: on, lower_limit: 0 mm}
""",
    kind="pin_and_hole",
)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    folder = tmp_path_factory.mktemp("play")
    return run_scene(scene_of(SCENE, folder), overrides=Overrides(trials=400, seed=5), out=folder / "run")


def shift(shown: ShownAssembly) -> float:
    return float(shown.placed.frames["plate.hole"][0, 3] - shown.placed.frames["base.pin"][0, 3])


def test_floats_stay_shares_of_a_room_that_is_magnified(run: Run) -> None:
    columns = run.columns("hole size [um]", "geometric:shift", "status")
    trial = int(np.argmax(np.where(columns["status"] == "ok", columns["hole size [um]"], -np.inf)))
    size, plain = columns["hole size [um]"][trial] / 1e3, columns["geometric:shift"][trial] / 1e3
    assert size > 0.1
    found = shift(display(run, trial, magnify=5.0))
    assert found == pytest.approx(plain * (0.1 + 5.0 * size) / (0.1 + size), rel=1e-9)


def test_deviations_are_magnified_as_far_as_parts_go_together(run: Run) -> None:
    columns = run.columns("hole size [um]", "status")
    trial = int(np.argmin(np.where(columns["status"] == "ok", columns["hole size [um]"], np.inf)))
    size = columns["hole size [um]"][trial] / 1e3
    note = next(note for note in display(run, trial, magnify=50.0).notes if "beyond" in note)
    most = 0.1 / -size  # no room is left
    used = float(note.split()[1])
    assert most * (1 - 0.06) < used < most * 1.01
    assert "not 50: beyond that they cannot be assembled" in note


def test_the_worst_trial_that_builds_is_shown(run: Run) -> None:
    columns = run.columns("hole size [um]", "status")
    built = columns["status"] == "ok"
    assert not built.all()  # of these the slack says by how much, and they are worse
    shown = display(run, "worst", magnify=1.0)
    assert shown.label == f"trial-{int(np.argmin(np.where(built, columns['hole size [um]'], np.inf)))}"
    assert any("is worse, and cannot be shown: no build" in note for note in shown.notes)
