"""A ring on a shaft in bores: its mesh lies where the bores are, on both methods."""

import math
from pathlib import Path

import numpy as np
import pytest
from places import SCENES

from tol3d import Overrides, load_scene, run_scene
from tol3d.errors import SceneError
from tol3d.study.trials.overrides import simulation_of

APART = 51.9  # mm; 18 teeth in 70 of module 2
MOVES = [
    ("spur_gear, teeth: 45", "internal_gear, teeth: 70"),
    ("face_width: 16 mm, bore: 20 mm", "face_width: 16 mm, addendum: 0.8"),
    ("[102.9 mm, 37.8 mm", f"[52.5 mm, {APART} mm"),
    ("ratio: 6.25", "ratio: -9.7222"),
]


def text_of(*more: tuple[str, str]) -> str:
    text = (SCENES / "housed_gears.yaml").read_text("utf-8")
    for old, new in (*MOVES, *more):
        assert old in text
        text = text.replace(old, new)
    return text


@pytest.mark.slow
def test_a_ring_meshes_where_its_bores_lie(tmp_path: Path) -> None:
    path = tmp_path / "ring.yaml"
    path.write_text(text_of(), "utf-8")
    run = run_scene(path, overrides=Overrides(trials=60, witness=0), out=tmp_path / "run")
    assert run.summary["status"]["ok"] == 60
    measure = run.summary["measures"]["second normal backlash"]
    base = 52 * math.cos(math.radians(20))
    apart = [math.tan(angle) - angle for angle in (math.radians(20), math.acos(base / APART))]
    assert measure["nominal"]["geometric"] == pytest.approx(2e3 * base * (apart[0] - apart[1]), abs=1e-5)
    columns = run.columns()
    for name, bound in (
        ("second normal backlash", 0.15),
        ("lost motion", 0.01),
    ):  # um, arcmin: squares, seen 0.084, 0.005
        apart_by = columns[f"geometric:{name}"] - columns[f"analytic:{name}"]
        assert np.abs(apart_by).max() < bound


def test_an_azimuth_that_points_to_the_ring_s_axis_is_refused(tmp_path: Path) -> None:
    """The teeth meet on the other side of the inner gear than the ring's axis, which lies at 90 deg."""
    stage = "second stage: {kind: mesh, driver: second pinion, driven: second wheel"
    for azimuth, right in (("-90 deg", True), ("90 deg", False)):
        path = tmp_path / "ring.yaml"
        path.write_text(text_of((stage, f"{stage}, azimuth: {azimuth}")), "utf-8")
        if right:
            assert simulation_of(load_scene(path), Overrides()).system.name == "gears in a machined housing"
        else:
            with pytest.raises(SceneError, match=r"azimuth: expected -90 deg, as the bores lie"):
                simulation_of(load_scene(path), Overrides())
