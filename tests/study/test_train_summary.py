"""Summaries of a train whose first measure is a tip's, of load paths that bind each other, and of odd swings."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from loose_summaries import typed_run
from of_kind import of_kind
from places import SCENES

from tol3d import load_scene
from tol3d.apps.adjustment.compensation import CompensationQuestion, compensation
from tol3d.errors import SceneError
from tol3d.gearing.model import LostMotion, model_from_scene
from tol3d.gearing.presenting.shown_stage import distributions_of, sums_of, trains_of
from tol3d.gearing.presenting.train_tables import sums_table
from tol3d.simulate import Overrides, run_scene
from tol3d.study.runs.worst import worst_trial

SPLIT = SCENES / "split_train.yaml"
LEVER = 200.0  # mm
ARCMIN = np.pi / 10800
TIP = "tip: {kind: tip_displacement, of: t, arm: arm, point: tip}"
LOST = "lost: {kind: lost_motion, of: t}"
TRAIN = """
scene: two stages
parts:
  motor: {{kind: shaft, carries: {{a: {{}}}}}}
  mid: {{kind: shaft, carries: {{b: {{}}, c: {{at: 30 mm}}}}}}
  out: {{kind: shaft, carries: {{d: {{}}}}}}
  arm: {{kind: arm, shaft: out, points: {{tip: [200 mm, 0 mm, 0 mm]}}}}
  a: {{kind: spur_gear, teeth: 20, module: 1 mm, face_width: 8 mm}}
  b: {{kind: spur_gear, teeth: 40, module: 1 mm, face_width: 8 mm}}
  c: {{kind: spur_gear, teeth: 20, module: 1 mm, face_width: 8 mm}}
  d: {{kind: spur_gear, teeth: 50, module: 1 mm, face_width: 8 mm}}
tolerances:
  ta: {{kind: tooth_thickness, of: a, distribution: {{kind: normal, lower: -50 um, upper: -20 um}}}}
  tc: {{kind: tooth_thickness, of: c, distribution: {{kind: normal, lower: -40 um, upper: -20 um}}}}
moves:
  m1: {{kind: mesh, driver: a, driven: b, centre_distance: 30.02 mm}}
  m2: {{kind: mesh, driver: c, driven: d, centre_distance: 35.02 mm}}
  t: {{kind: train, driven: motor, output: out}}
measures:
  {measures}
study: {{{study}}}
"""


def summary_of(folder: Path, *measures: str, study: str = "trials: 100, seed: 3") -> dict[str, Any]:
    folder.mkdir(exist_ok=True)
    path = folder / "scene.yaml"
    path.write_text(TRAIN.format(measures="\n  ".join(measures), study=study))
    return dict(run_scene(path, out=folder / "run").summary)


def test_the_distribution_of_a_train_told_by_its_tip_is_the_turn_that_moves_the_tip(tmp_path: Path) -> None:
    by_tip, by_turn = (summary_of(tmp_path / "a", TIP), summary_of(tmp_path / "b", LOST))
    train = trains_of(typed_run(by_tip))["t"]
    for method in ("analytic", "geometric"):
        found = distributions_of(train, typed_run(by_tip))[method].high
        # a chord is shorter than its arc by the turn squared over 24: 4e-7 of it at 10 minutes of arc
        assert found == pytest.approx(by_turn["measures"]["lost"][method]["high_3sigma"], rel=1e-6)
    shown = {row.label: row.cells for row in sums_table(train, typed_run(by_tip)).rows}
    assert float(shown["tip of arm, mean + 3 sigma [mm]"][1]) == pytest.approx(
        by_tip["measures"]["tip"]["geometric"]["high_3sigma"], abs=5.1e-5
    )


def test_a_point_is_told_of_its_own_shaft_only(tmp_path: Path) -> None:
    """The stages are those of the first measure, at the shaft between; the arm hangs on the output."""
    summary = summary_of(tmp_path, "lost of mid: {kind: lost_motion, of: t, shaft: mid}", TIP)
    assert (summary["trains"]["t"]["shaft"], summary["trains"]["t"]["lever_mm"]) == ("mid", None)
    at_output = summary_of(tmp_path / "b", LOST, TIP)
    assert at_output["trains"]["t"]["lever_mm"] == LEVER


def test_sums_at_random_positions_are_not_those_of_one_position(tmp_path: Path) -> None:
    summary = summary_of(tmp_path, LOST, "at stop: {kind: lost_motion, of: t, over: {at: 20 deg}}")
    assert sums_of(typed_run(summary).measures["lost"], typed_run(summary))
    assert not sums_of(typed_run(summary).measures["at stop"], typed_run(summary))


def clocked(folder: Path, lower: float, upper: float) -> Path:
    """The split train, one pinion turned on its shaft by so much [arcmin]."""
    text = SPLIT.read_text()
    assert "lower: 1 arcmin, upper: 9 arcmin" in text
    path = folder / "split.yaml"
    path.write_text(text.replace("lower: 1 arcmin, upper: 9 arcmin", f"lower: {lower} arcmin, upper: {upper} arcmin"))
    return path


def test_trials_in_which_ways_bind_are_left_out_of_the_stages_too(tmp_path: Path) -> None:
    run = run_scene(clocked(tmp_path, -38.0, 44.0), overrides=Overrides(trials=300, witness=0), out=tmp_path / "run")
    measure, train = run.summary["measures"]["lost motion"], run.summary["trains"]["stage"]
    bound = run.summary["status"]["interferes"]
    assert 0 < bound == 300 - measure["geometric"]["count"]
    (stage,) = train["stages"]  # the load paths are all that there is: what they leave is the lost motion
    for key in ("mean", "high_3sigma", "sample_min"):
        assert stage["methods"]["geometric"][key] == pytest.approx(measure["geometric"][key], rel=1e-12)


def test_ways_that_bind_in_the_mean_build_are_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"moves\.stage: the parallel load paths .* bind each other at the mean build"):
        run_scene(clocked(tmp_path, 70.0, 90.0), out=tmp_path / "run")


def test_robots_are_as_many_as_the_replicates_share(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(TRAIN.format(measures=LOST, study="trials: 3072, sampler: sobol, replicates: 24"))
    assert compensation(load_scene(path), CompensationQuestion(positions=1)).robots == 1992  # 83 of each of 24


def swung(folder: Path, start: str, end: str, positions: int) -> LostMotion:
    """The kind of the swing's measure with the arm's weight over the axis at 0."""
    text = (SCENES / "robot_shoulder_swing.yaml").read_text("utf-8")
    for old, new in (
        ("[83.4 mm, 445.1 mm, 100 mm]", "[0 mm, 445.1 mm, 100 mm]"),
        ("start: -60 deg, end: 60 deg, positions: 25", f"start: {start}, end: {end}, positions: {positions}"),
    ):
        assert old in text
        text = text.replace(old, new)
    (folder / "swing.yaml").write_text(text, "utf-8")
    model = model_from_scene(load_scene(folder / "swing.yaml"))
    return of_kind(LostMotion, next(measure.kind for measure in model.measures if measure.take == "curve"))


def test_a_load_that_changes_sides_at_an_end_of_a_swing_does_not_on_it(tmp_path: Path) -> None:
    kind = swung(tmp_path, "0 deg", "60 deg", 7)
    assert (kind.changes, any(kind.turned)) == ((), False)


def test_a_swing_from_balance_to_balance_is_none_without_a_load(tmp_path: Path) -> None:
    kind = swung(tmp_path, "-180 deg", "0 deg", 2)
    assert (kind.changes, kind.turned) == ((), (False, False))


def test_a_swing_over_two_balances_changes_flanks_twice(tmp_path: Path) -> None:
    kind = swung(tmp_path, "-30 deg", "210 deg", 9)
    assert np.degrees(kind.changes) == pytest.approx([0.0, 180.0], abs=1e-9)
    assert kind.turned == (False, False, *[True] * 6, False)


def test_without_limits_the_worst_robot_is_the_one_whose_tip_goes_furthest(tmp_path: Path) -> None:
    run = run_scene(
        SCENES / "robot_shoulder_swing.yaml", overrides=Overrides(trials=50, witness=0), out=tmp_path / "run"
    )
    assert worst_trial(run) == int(np.argmax(run.columns()["geometric:tip displacement"]))
