"""A gearbox whose housing cannot be put in its place has that status, and no backlash."""

from pathlib import Path

import numpy as np
import pytest
from machine.housed import FOUR_BORES, gearbox_of, housed_scene
from machine.test_shared_bores import LOCATED, POINTS, TABLE
from scene_texts import written

from tol3d import Overrides, open_run, replay, run_scene
from tol3d.study.system.trials import Trials

HEIGHTS = "distribution: {kind: uniform, lower: -130 mm, upper: 130 mm}"
"""Heights of one of two side locators 120 mm apart: beyond 120 mm no turn reaches it, in 10 of 130 trials."""


def text() -> str:
    locator = f"\n  far: {{kind: locator, of: base, pair: secondary 1, {HEIGHTS}}}"
    thick = "\n  t: {kind: tooth_thickness, of: pinion, distribution: {kind: uniform, lower: -30 um, upper: -10 um}}"
    return housed_scene(
        tolerances=locator + thick,
        features=FOUR_BORES + POINTS,
        fixed="\n  set: {kind: fix, part: table}" + LOCATED,
        more=TABLE,
    )


def test_a_housing_out_of_reach_is_a_status_of_its_gears(tmp_path: Path) -> None:
    system = gearbox_of(text(), tmp_path)
    rows = np.array([[0.0, -0.02], [125.0, -0.02], [-5.0, -0.02]])
    trials = Trials(rows, system.positions(dict.fromkeys(system.streams, np.zeros(3))))
    found = system.method("exact", {}).answers(trials, system.measures)
    texts = [system.statuses.texts[code] for code in found.status["backlash"]]
    assert texts == ["ok", "singular", "ok"]
    values = found.values["backlash"][:, 0]
    assert np.isnan(values[1])
    assert values[0] == pytest.approx(values[2], abs=1e-9)  # a housing that stands askew, and gears that do not care


def test_a_run_counts_them_and_leaves_them_out_of_means(tmp_path: Path) -> None:
    path = written(text(), tmp_path)
    count = 4000
    run = run_scene(path, overrides=Overrides(trials=count, seed=3), out=tmp_path / "run")
    counts = run.summary["status"]
    share = 10 / 130
    assert counts["singular"] == pytest.approx(share * count, abs=4 * np.sqrt(share * (1 - share) * count))
    assert counts["ok"] + counts["singular"] == count
    columns = run.columns()
    failed = np.array(columns["status"]) == "singular"
    assert np.array_equal(failed, np.abs(columns["far [um]"]) > 120e3)
    assert np.isnan(columns["geometric:backlash"][failed]).all()
    assert run.summary["measures"]["backlash"]["geometric"]["mean"] == pytest.approx(
        columns["geometric:backlash"][~failed].mean()
    )
    broken = int(np.flatnonzero(failed)[0])
    assert replay(open_run(tmp_path / "run"), broken).status == "singular"
