"""First-order slopes of everything that acts, against central differences of the finite method at random poses."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from assembly_trials import assembled
from linkage.linked_bodies import Array, Linkage, Study, study_of
from linkage.mechanisms import ALL
from linkage.plays import with_plays
from linkage.random_loops import open_chain

from tol3d.study.system.stated import component_count, component_slices, stated

STEPS = {"mm": 1e-3, "µm": 1e-3, "um": 1e-3, "1": 0.05}  # mm, shares of a radius of some 0.02 mm; all others rad
ANGLE = 1e-5
REACHES = {
    "slider crank": {"angle": 3.0},
    "four-bar": {"angle": 3.0},
    "rssr": {"angle": 0.8},
    "stewart": {f"length {k}": 15.0 for k in range(6)},
    "delta": {f"angle {k}": 0.3 for k in range(3)},
    "swash on swing": {"turn 0": 20.0, "turn 1": 2.0},
    "swash on universal": {"turn 0": 20.0, "turn 1": 2.0},
    "planet": {"tilt x": 0.8, "tilt y": 0.8},
}
"""Random range of inputs, either way [mm or rad]."""


def at_random(linkage: Linkage, reaches: dict[str, float], count: int, seed: int) -> Linkage:
    rng = np.random.default_rng(seed)
    poses = {
        f"pose {k}": {name: float(reach * rng.uniform(-1, 1)) for name, reach in reaches.items()} for k in range(count)
    }
    return replace(linkage, poses=poses)


def steps_of(system: Any) -> Array:
    """Step of each deviation, either way (components,)."""
    found = np.empty(component_count(system))
    slices = component_slices(system)
    for own in system.contributors:
        found[slices[own.name]] = STEPS.get(own.unit, ANGLE)
    return found


def slopes(study: Study, where: str) -> tuple[Array, Array]:
    """Slopes of all probes by each deviation (components, probes, 3): of the finite method, and to first order."""
    steps = steps_of(study.system)
    rows = np.diag(steps)
    there = study.seen(np.concatenate([rows, -rows]), where)
    count = len(steps)
    finite = (there[:count] - there[count:]) / (2 * steps[:, None, None])
    linear = study.seen(np.concatenate([rows, 0 * rows[:1]]), where, "analytic")
    return finite, (linear[:-1] - linear[-1]) / steps[:, None, None]


def assert_same(finite: Array, linear: Array) -> None:
    """To 1e-6 of the largest of a deviation, or of a share of the loop where one acts on nothing."""
    off = np.abs(finite - linear).max(axis=(1, 2))
    size = np.abs(linear).max(axis=(1, 2))
    acts = size > 1e-6
    assert acts.mean() > 0.5
    assert (off[acts] < 1e-6 * np.maximum(size[acts], 1e-2)).all()
    assert (off[~acts] < 1e-8).all()


@pytest.mark.parametrize("plays", [False, True], ids=["", "with play"])
@pytest.mark.parametrize(
    ("name", "count"),
    [(name, 1 if name in ("stewart", "delta") else 2) for name in ALL]
    + [pytest.param(name, 7, marks=pytest.mark.slow) for name in ALL],
)
def test_slopes_at_random_poses(name: str, count: int, plays: bool, tmp_path: Path) -> None:
    """All linkages at 28 poses by default, at 112 more among the slow tests."""
    linkage = ALL[name]()
    if plays:
        linkage = with_plays(linkage)[0]
    linkage = at_random(linkage, REACHES[name], count, seed=count)
    study = study_of(linkage, tmp_path)
    for where in linkage.poses:
        assert_same(*slopes(study, where))


def test_slopes_of_a_row_of_all_kinds_of_joints(tmp_path: Path) -> None:
    linkage = with_plays(open_chain())[0]
    study = study_of(linkage, tmp_path)
    for where in linkage.poses:
        assert_same(*slopes(study, where))


INPUT = """
          zero: {distribution: {kind: normal, lower: -5 um, upper: 5 um}}
          lead: {distribution: {kind: normal, lower: -23 um, upper: 23 um}, per: 300 mm}
          backlash: {distribution: {kind: uniform, lower: -0.5 arcmin, upper: 0.5 arcmin}}
          turn error: {distribution: {kind: normal, lower: -0.5 arcmin, upper: 0.5 arcmin}, per: 100 mm}"""


@pytest.mark.parametrize("order", ["frame.way, car.way", "car.way, frame.way"])
def test_deviations_of_an_input_by_its_way_and_by_its_lead(order: str, tmp_path: Path) -> None:
    """A slide of 12 mm by a screw of 5 mm: lead 12/300, an angle 5/2π, an angle per 100 mm 5/2π 12/100.

    Of -30 mm: -30/300 and -5/2π 30/100, for the car stands at s (1 + e/300). A path across 0 is as much longer as one
    of its length on one side. It counts from where the parts are placed, here 100 mm.
    """
    text = f"""
scene: one slide
parts:
  frame:
    kind: solid
    features:
      zero: {{kind: point, at: [0 mm, 0 mm, 0 mm]}}
      way: {{kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [1, 0, 0], length: 20 mm}}
  car:
    kind: solid
    features:
      way: {{kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [1, 0, 0], length: 20 mm}}
      nose: {{kind: point, at: [3 mm, 0 mm, 0 mm]}}
moves:
  base: {{kind: fix, part: frame}}
  slide:
    kind: close_loop
    bodies: [car]
    joints: {{way: {{kind: prismatic, between: [{order}]}}}}
    inputs:
      travel:
        of: way
        lead: 5 mm
        as_placed: 100 mm
        deviations: {INPUT}
    poses:
      ahead: {{travel: 112 mm}}
      home: {{travel: 100 mm}}
      behind: {{travel: 70 mm}}
      across: {{path: [behind, ahead], steps: 4}}
measures:
  ahead: {{kind: gap, from: frame.zero, to: car.nose, along: [1, 0, 0], at: ahead}}
  home: {{kind: gap, from: frame.zero, to: car.nose, along: [1, 0, 0], at: home}}
  behind: {{kind: gap, from: frame.zero, to: car.nose, along: [1, 0, 0], at: behind}}
  stroke: {{kind: gap, from: frame.zero, to: car.nose, along: [1, 0, 0], over: across, take: range}}
  least: {{kind: gap, from: frame.zero, to: car.nose, along: [1, 0, 0], over: across, take: min}}
study: {{trials: 10}}
"""
    made = assembled(text, tmp_path)
    slices = component_slices(made.system)
    by = 5.0 / (2 * np.pi)
    sense = 1.0 if order.startswith("frame") else -1.0
    rows = np.zeros((5, component_count(made.system)))
    for k, name in enumerate(("zero", "lead", "backlash", "turn error")):
        rows[k, slices[f"{name} of travel"]] = 1e-3 * (k + 1)

    def way(nominal: float) -> Array:
        shares = [1.0, nominal / 300, by, by * nominal / 100, 0.0]
        return np.asarray(nominal + 1e-3 * np.array([1, 2, 3, 4, 0]) * np.array(shares))

    expected = {name: 3.0 + sense * way(at) for name, at in (("ahead", 12.0), ("home", 0.0), ("behind", -30.0))}
    expected["stroke"] = way(12.0) - way(-30.0)
    expected["least"] = expected["behind" if sense > 0 else "ahead"]
    for method in ("exact", "analytic"):
        answers = made.system.method(method, made.system.materials(method))
        read = answers.answers(stated(made.system, rows), made.system.measures).values
        found = {name: own[:, 0] for name, own in read.items() if own.shape[1] == 1}
        found |= {"stroke": np.ptp(read["stroke"], axis=1), "least": read["least"].min(axis=1)}
        for name, values in expected.items():
            assert found[name] == pytest.approx(values, abs=1e-12), (method, name)


def test_the_error_of_an_angle_has_the_sign_of_the_turn(tmp_path: Path) -> None:
    """An arm of 50 mm, turned by t about z, with a mean error of 0.2 mrad a radian: 50 sin t + 50 cos(t) t 0.2e-3."""
    text = """
scene: one arm
parts:
  frame:
    kind: solid
    features:
      zero: {kind: point, at: [0 mm, 0 mm, 0 mm]}
      axis: {kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 20 mm}
  arm:
    kind: solid
    features:
      axis: {kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 20 mm}
      tip: {kind: point, at: [50 mm, 0 mm, 0 mm]}
moves:
  base: {kind: fix, part: frame}
  turn:
    kind: close_loop
    bodies: [arm]
    joints: {hinge: {kind: revolute, between: [frame.axis, arm.axis]}}
    inputs:
      t:
        of: hinge
        deviations:
          scale: {distribution: {kind: normal, mean: 0.2 mrad, sigma: 0.01 mrad}, per: 1 rad}
    poses: {left: {t: 40 deg}, right: {t: -70 deg}}
measures:
  left: {kind: gap, from: frame.zero, to: arm.tip, along: [0, 1, 0], at: left}
  right: {kind: gap, from: frame.zero, to: arm.tip, along: [0, 1, 0], at: right}
study: {trials: 10}
"""
    made = assembled(text, tmp_path)
    trials = stated(made.system, np.array([[0.2e-3]]))
    for method in ("exact", "analytic"):
        found = made.values(trials, method)
        for name, t in (("left", np.radians(40)), ("right", np.radians(-70))):
            second_order = 50 * (t * 0.2e-3) ** 2 / 2
            expected = 50 * (np.sin(t) + np.cos(t) * t * 0.2e-3)
            assert found[name][0] == pytest.approx(expected, abs=1.01 * second_order), (method, name)
