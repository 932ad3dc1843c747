"""Warm parts of an assembly without gears: gaps, sizes and play by hand, where each length grows by alpha T."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import assembled
from numpy.typing import NDArray
from places import SCENES
from scene_texts import edited, refusal, scene_of, written

from tol3d import Overrides, Run, load_scene, run_scene
from tol3d.errors import SceneError
from tol3d.simulate import simulation_of

STEEL, ALUMINIUM = 12e-6, 23e-6  # 1/K
COUNT = 4000
METHODS = {"analytic": "analytic", "exact": "geometric"}
BAR = (SCENES / "warm_bar.yaml").read_text("utf-8")

PLAY = """scene: a warm bush on a warm pin
parts:
  pin:
    kind: solid
    expansion: 12e-6 1/K
    features:
      face: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], radius: 40 mm}
      pin: {kind: cylinder, at: [7 mm, -5 mm, 10 mm], axis: [0, 0, 1], length: 20 mm, diameter: 29.9 mm}
  bush:
    kind: solid
    expansion: 23e-6 1/K
    features:
      face: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], radius: 40 mm}
      hole: {kind: cylinder, at: [7 mm, -5 mm, 10 mm], axis: [0, 0, 1], length: 20 mm, diameter: 30 mm, hole: true}
tolerances:
  hot: {kind: temperature, of: [bush, pin], distribution: {kind: uniform, lower: -20 K, upper: 80 K}}
  hole size: {kind: size, of: bush.hole, distribution: {kind: constant, value: 0 mm}}
  pin size: {kind: size, of: pin.pin, distribution: {kind: constant, value: 0 mm}}
  shaded: {kind: temperature, of: pin, distribution: {kind: normal, mean: -5 K, sigma: 2 K}}
moves:
  table: {kind: fix, part: pin}
  bush on the pin:
    kind: pin_and_hole
    part: bush
    relations: [{kind: coincident, from: bush.face, to: pin.face}]
    pairs: [{from: bush.hole, to: pin.pin}]
    float: {kind: centred}
measures:
  slack: {kind: slack, of: bush on the pin}
study: {trials: 100, seed: 6}
"""


def run_of(text: str, folder: Path, trials: int = COUNT) -> Run:
    path = written(text, folder)
    return run_scene(path, overrides=Overrides(trials=trials), out=folder / "run")


def column(run: Run, name: str) -> NDArray[np.float64]:
    return np.asarray(run.columns(name)[name], float)


@pytest.mark.parametrize("method", METHODS)
def test_a_warm_bar_takes_the_room_that_its_frame_leaves(method: str, tmp_path: Path) -> None:
    """The wall at -150 mm (1 + s T), the bar's end 300 mm (1 + a (T + C)) and its length off further, the stop at 151.

    Sums of a few numbers of 100 mm: 1e-9 um is far more than their rounding.
    """
    run = run_of(BAR, tmp_path)
    oven, current, length = (column(run, name) for name in ("oven [K]", "current [K]", "bar length [um]"))
    by_hand = 1000 * (301 * (1 + STEEL * oven) - 300 * (1 + ALUMINIUM * (oven + current))) - length
    np.testing.assert_allclose(column(run, f"{METHODS[method]}:gap"), by_hand, atol=1e-8, rtol=0)
    mean = 1000 + 1000 * ((301 * STEEL - 300 * ALUMINIUM) * 30 - 300 * ALUMINIUM * 10)
    variances = (
        (1000 * (301 * STEEL - 300 * ALUMINIUM) * 10) ** 2,
        (1000 * 300 * ALUMINIUM * 20) ** 2 / 12,
        (100 / 3) ** 2,
    )
    own = run.summary["measures"]["gap"]
    assert own["mean_build"][METHODS[method]] == pytest.approx(mean, abs=1e-8)
    assert own[METHODS[method]]["mean"] == pytest.approx(mean, abs=4 * math.sqrt(sum(variances) / COUNT))
    assert own[METHODS[method]]["sigma"] == pytest.approx(math.sqrt(sum(variances)), rel=4 / math.sqrt(2 * COUNT))
    form = own["analytic_closed_form"]
    assert (form["mean"], form["sigma"]) == pytest.approx((mean, math.sqrt(sum(variances))), rel=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_a_bush_that_grows_more_than_its_pin_has_more_play(method: str, tmp_path: Path) -> None:
    """Half the difference of the diameters, each grown by its own coefficient; both grow about the same origin, so that
    their axes part by the difference of what 8.6 mm grow, which a part that is free to move does not mind."""
    run = run_of(PLAY, tmp_path, 300)
    hot, shaded = column(run, "hot [K]"), column(run, "shaded [K]")
    by_hand = 500 * (30 * (1 + ALUMINIUM * hot) - 29.9 * (1 + STEEL * (hot + shaded)))
    np.testing.assert_allclose(column(run, f"{METHODS[method]}:slack"), by_hand, atol=1e-6, rtol=0)


WARM = """scene: a warm plate
parts:
  plate:
    kind: solid
    expansion: 20e-6 1/K
    features:
      base: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, -1], extent: [100 mm, 60 mm]}
      h1: {kind: cylinder, at: [0 mm, 0 mm, 5 mm], axis: [0, 0, 1], length: 10 mm, diameter: 8 mm, hole: true}
      h2: {kind: cylinder, at: [80 mm, 0 mm, 25 mm], axis: [0, 0, 1], length: 10 mm, diameter: 8 mm, hole: true}
      h3: {kind: cylinder, at: [0 mm, 50 mm, 15 mm], axis: [0, 0, 1], length: 10 mm, diameter: 8 mm, hole: true}
      slot: {kind: slot, at: [80 mm, 20 mm, 5 mm], normal: [0, 1, 0], extent: [10 mm, 10 mm], width: 8 mm}
      far: {kind: cylinder, at: [60 mm, 40 mm, 60 mm], axis: [0, 0, 1], length: 10 mm, diameter: 8 mm, hole: true}
tolerances:
  hot: {kind: temperature, of: plate, distribution: {kind: constant, value: 100 K}}
  far: {kind: position, of: plate.far, zone: {diameter: 0.0001 mm}, law: {kind: uniform}, datums: DATUMS}
moves:
  bench: {kind: fix, part: plate}
measures:
  x: {kind: gap, from: plate.h1, to: plate.far, along: [1, 0, 0]}
  y: {kind: gap, from: plate.h1, to: plate.far, along: [0, 1, 0]}
"""
ALL = "{feature: h1-h2-h3, simulator: pattern}"
FLAT = {25: 5, 15: 5}  # depths of holes


@pytest.mark.parametrize("datums", [f"[base, {ALL}]", f"[{ALL}]", "[base, h1, h2]", "[base, h1]"])
def test_a_part_grows_evenly_in_frames_that_growth_shifts_alone(datums: str, tmp_path: Path) -> None:
    """60 and 40 mm grow by 0.002; of a pattern that is the first datum if its holes lie at one depth."""
    text = WARM.replace("DATUMS", datums)
    for depth, one in FLAT.items() if datums == f"[{ALL}]" else ():
        text = text.replace(f"mm, {depth} mm], axis", f"mm, {one} mm], axis")
    made = assembled(text, tmp_path)
    for method in METHODS:
        found = made.drawn(3, method)
        np.testing.assert_allclose(found["x"], 60 * 1.002, atol=1e-4, rtol=0)
        np.testing.assert_allclose(found["y"], 40 * 1.002, atol=1e-4, rtol=0)


@pytest.mark.parametrize(
    ("datums", "named"), [(f"[{ALL}]", "h1-h2-h3"), (f"[{ALL}, base]", "h1-h2-h3 | base"), ("[base, h1, slot]", "base")]
)
def test_a_frame_that_growth_turns_is_refused(datums: str, named: str, tmp_path: Path) -> None:
    """Deeper holes farther out lean a pattern by least squares; a slot 20 mm beside its hole turns by 20 / 80."""
    with pytest.raises(SceneError, match=f"keeps upright, got {re.escape(named)}"):
        simulation_of(scene_of(WARM.replace("DATUMS", datums), tmp_path), Overrides())


def test_gears_and_solid_parts_have_one_temperature() -> None:
    """The same word, of the mechanism whose other kinds the scene has."""
    for name, mechanism in (("warm_bar", "assembly"), ("every_field", "gearing"), ("housed_gears", "machine")):
        scene = load_scene(SCENES / f"{name}.yaml")
        assert any(own.kind == "temperature" for own in scene.tolerances.values())
        assert scene.grammar.vocabulary_of(scene).name == mechanism


def test_a_part_that_does_not_grow_is_refused(tmp_path: Path) -> None:
    said = refusal(edited(BAR, ("    expansion: 23e-6 1/K\n", "")), tmp_path)
    assert [line for line in said.splitlines() if "expansion" in line] == [
        "tolerances.oven.of[1]: expected a part with its coefficient of expansion, got 'bar' without expansion:",
        "tolerances.current.of[0]: expected a part with its coefficient of expansion, got 'bar' without expansion:",
    ]
