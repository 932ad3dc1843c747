"""Scenes whose bearings have play: where builds of their columns rest, by HiGHS, and what pure play does by hand."""

from pathlib import Path

import numpy as np
import pytest
from oracles.playing_reducer import PlayingReducer
from places import SCENES

from tol3d import Overrides, run_scene

ARCMIN = np.degrees(1.0) * 60
TEXT = (SCENES / "rv_bearing_play.yaml").read_text("utf-8")
MORE = """
  disc holes: {kind: disc_hole, of: disc, each: hole, distribution: {kind: rayleigh, scale: 0.5 um}}
  cranks: {kind: crank_eccentricity, of: crankshaft, each: crank, distribution: {kind: rayleigh, scale: 0.5 um}}
  holes: {kind: carrier_hole, of: carrier, each: hole, distribution: {kind: rayleigh, scale: 0.5 um}}
  phases: {kind: crank_phase, of: crankshaft, each: crank, distribution: {kind: normal, lower: -15 arcsec, upper: 15 arcsec}}
"""
BACK = "\n  back: {kind: cycloid_transmission_error, of: reducer, flank: back, over: random}\n\nstudy:"


@pytest.mark.slow
def test_two_hundred_builds_of_a_scene_rest_where_highs_finds_them(tmp_path: Path) -> None:
    """Of each by turns with the torque back and on, by both roads."""
    text = TEXT.replace("\nmoves:", f"{MORE}\nmoves:").replace("\nstudy:", BACK)
    path = tmp_path / "scene.yaml"
    path.write_text(text, "utf-8")
    columns = run_scene(path, overrides=Overrides(trials=200), out=tmp_path / "run").columns()
    for sense, measure in ((-1, "transmission error"), (1, "back")):
        trials = np.arange(200)[(1 - sense) // 2 :: 2]
        expected = np.array([PlayingReducer(columns, trial).turned(sense) for trial in trials])
        exact, analytic = (columns[f"{road}:{measure}"][trials] / ARCMIN for road in ("geometric", "analytic"))
        # teeth are met at the middle of a bearing and along a straight line from there: (5 um)^2 / 63 mm of a planet
        np.testing.assert_allclose(exact, expected, rtol=0, atol=1e-9)
        assert np.abs(analytic - expected).max() < 5e-6  # an arc second: pins near the window's edge
