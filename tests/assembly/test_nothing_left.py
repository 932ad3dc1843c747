"""Parts that relations hold altogether: pins, bolts and later datums find nothing free, and crash nothing."""

from pathlib import Path

import numpy as np
import pytest
from assembly_trials import assembled

from tol3d.errors import SceneError
from tol3d.study.trials.draws import drawn

METHODS = ("exact", "analytic")

HELD = """
scene: pins that nothing is left for
parts:
  a:
    kind: solid
    features:
      face: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [100 mm, 60 mm]}
      side: {kind: plane, at: [0 mm, -30 mm, 5 mm], normal: [0, -1, 0], extent: [100 mm, 10 mm]}
      end: {kind: plane, at: [-50 mm, 0 mm, 5 mm], normal: [-1, 0, 0], extent: [60 mm, 10 mm], along: [0, 1, 0]}
      hole: {kind: cylinder, at: [20 mm, 10 mm, 5 mm], axis: [0, 0, 1], length: 10 mm, diameter: 8 mm, hole: true}
      other: {kind: cylinder, at: [-31 mm, 4 mm, 5 mm], axis: [0, 0, 1], length: 10 mm, diameter: 9 mm, hole: true}
  b:
    kind: solid
    features:
      face: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], extent: [100 mm, 60 mm]}
      side: {kind: plane, at: [0 mm, -30 mm, 5 mm], normal: [0, 1, 0], extent: [100 mm, 10 mm]}
      end: {kind: plane, at: [-50 mm, 0 mm, 5 mm], normal: [1, 0, 0], extent: [60 mm, 10 mm], along: [0, 1, 0]}
      pin: {kind: cylinder, at: [20 mm, 10 mm, 5 mm], axis: [0, 0, 1], length: 10 mm, diameter: 7.8 mm}
      second: {kind: cylinder, at: [-31 mm, 4 mm, 5 mm], axis: [0, 0, 1], length: 10 mm, diameter: 8.86 mm}
tolerances:
  hole: {kind: size, of: a.hole, distribution: {kind: uniform, lower: -50 um, upper: 50 um}}
  pin: {kind: size, of: b.pin, distribution: {kind: uniform, lower: -80 um, upper: 20 um}}
  off: {kind: plus_minus, of: a.hole, along: [1, 0, 0], distribution: {kind: normal, mean: 40 um, sigma: 15 um}}
  other: {kind: size, of: a.other, distribution: {kind: constant, value: 10 um}}
  second: {kind: size, of: b.second, distribution: {kind: constant, value: 0 mm}}
moves:
  bench: {kind: fix, part: b}
  join:
    kind: pattern
    part: a
    relations:
      - {kind: coincident, from: a.face, to: b.face}
      - {kind: coincident, from: a.side, to: b.side}
      - {kind: coincident, from: a.end, to: b.end}
    pairs: [{from: a.hole, to: b.pin}, {from: a.other, to: b.second}]
    float: {kind: random}
measures:
  slack: {kind: slack, of: join}
  far: {kind: gap, from: b.pin, to: a.hole, along: [1, 0, 0], over_play: largest}
study: {trials: 100, seed: 1}
"""
ONE_PAIR = "[{from: a.hole, to: b.pin}]"
BOLT = "[{from: a.hole, to: b.pin, bolt: {diameter: 7 mm, distribution: {kind: uniform, lower: 5 um, upper: 60 um}}}]"
TWO_PAIRS = "[{from: a.hole, to: b.pin}, {from: a.other, to: b.second}]"
SECOND = "  second: {kind: size, of: b.second, distribution: {kind: constant, value: 0 mm}}\n"
"""Read by nothing where the second pair is left out."""


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    "edits",
    [(), (("{kind: random}", "{kind: centred}"),), (("kind: pattern", "kind: pin_and_hole"), (TWO_PAIRS, ONE_PAIR))],
    ids=["random", "centred", "pin and hole"],
)
def test_the_slack_of_a_part_that_relations_hold_is_that_of_its_pose(
    method: str, edits: tuple[tuple[str, str], ...], tmp_path: Path
) -> None:
    """Half the clearance less how far the hole is off its pin, or the other pair's, which does not vary."""
    text = HELD
    for old, new in edits:
        assert old in text
        text = text.replace(old, new)
    made = assembled(text, tmp_path)
    trials = drawn(made.simulation, 0, 100)
    hole, pin, off = (trials.deviations[:, own][:, 0] for _, own in made.slices[:3])
    expected = 0.1 + (hole - pin) / 2.0 - np.abs(off)
    if TWO_PAIRS in text:
        expected = np.minimum(expected, 0.075)
        assert 10 < np.sum(expected == 0.075) < 90
    system = made.system
    answers = system.method(method, system.materials(method)).answers(trials, system.measures)
    slack = answers.values["slack"][:, 0]
    assert slack == pytest.approx(np.where(np.isnan(slack), np.nan, expected), abs=1e-9, nan_ok=True)
    assert answers.values["far"][:, 0] == pytest.approx(off, abs=1e-9)
    if method == "exact":
        assert answers.status["slack"].tolist() == [0] * 100


@pytest.mark.parametrize("method", METHODS)
def test_bolts_take_their_places_in_a_part_that_relations_hold(method: str, tmp_path: Path) -> None:
    """A bolt goes through both holes that are off each other: halfway where both are as large, else nearer to one."""
    text = HELD.replace(TWO_PAIRS, BOLT).replace("diameter: 7.8 mm}", "diameter: 7.9 mm, hole: true}")
    made = assembled(text, tmp_path)
    trials = drawn(made.simulation, 0, 100)
    deviations = {own.name: trials.deviations[:, columns][:, 0] for own, columns in made.slices}
    bolts = [name for name in deviations if name not in ("hole", "pin", "off", "other", "second")]
    bolt = next(deviations[name] for name in bolts if deviations[name].min() >= 0.005 - 1e-12)
    rooms = (1.0 + deviations["hole"] - bolt) / 2.0, (0.9 + deviations["pin"] - bolt) / 2.0
    apart = np.abs(deviations["off"])
    # both slacks alike where the bolt can be between the axes; in the smaller hole's axis else
    expected = np.minimum((rooms[0] + rooms[1] - apart) / 2.0, np.minimum(*rooms))
    assert made.values(trials, method)["slack"] == pytest.approx(expected, abs=1e-7)


def test_a_float_towards_something_is_refused_where_nothing_moves(tmp_path: Path) -> None:
    text = HELD.replace("{kind: random}", "{kind: toward, at: a.hole, along: [1, 0, 0]}")
    with pytest.raises(SceneError, match=r"moves\.join: a\.hole does not move along its direction: it is held there"):
        assembled(text, tmp_path)


@pytest.mark.parametrize(
    "datums",
    [
        "[A, {feature: h1-h2, simulator: pattern}, {feature: h3-h4, simulator: pattern}]",
        "[{feature: h1-h2, simulator: pattern}, A, {feature: h3-h4, simulator: pattern}]",
        "[{feature: h1-h2, simulator: pattern}, {feature: h3-h4, simulator: pattern}]",
    ],
)
def test_a_pattern_after_datums_that_hold_all_that_it_could_take_is_refused(datums: str, tmp_path: Path) -> None:
    hole = "kind: cylinder, axis: [0, 0, 1], length: 10 mm, diameter: 7 mm, hole: true"
    places = {"h1": (-30, -12), "h2": (30, -12), "h3": (25, 17), "h4": (-22, 17)}
    holes = "".join(f"      {name}: {{{hole}, at: [{x} mm, {y} mm, 5 mm]}}\n" for name, (x, y) in places.items())
    text = f"""
scene: pattern datum after six freedoms
parts:
  plate:
    kind: solid
    features:
      A: {{kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [100 mm, 60 mm]}}
{holes}      f: {{{hole}, at: [3 mm, 5 mm, 5 mm]}}
moves: {{a: {{kind: fix, part: plate}}}}
measures:
  m: {{kind: inspected_position, of: plate.f, datums: {datums}}}
"""
    with pytest.raises(
        SceneError, match=r"h3-plate\.h4 takes no freedom: datums before it hold all that it could take"
    ):
        assembled(text, tmp_path)
