"""An idler with one tooth that lies ahead: each mesh of it is tighter where that tooth passes it, and nowhere else."""

import math
from pathlib import Path

import numpy as np
import pytest
from oracles.deviated_flanks import active_rolls

from tol3d import run_scene

TOOTH, AHEAD = 7, 20.0  # um
TEETH = {"a": 20, "b": 30, "c": 25}
APART = {"a": 50.2, "c": 55.2}  # mm, from the idler's axis
TOWARDS = {"a": 180.0, "c": 115.0}  # deg, azimuths of its mates about the idler
COS = math.cos(math.radians(20))

SCENE = """
scene: idler
parts:
  a: {kind: spur_gear, teeth: 20, module: 2 mm, face_width: 12 mm}
  b: {kind: spur_gear, teeth: 30, module: 2 mm, face_width: 10 mm}
  c: {kind: spur_gear, teeth: 25, module: 2 mm, face_width: 10 mm}
tolerances:
  pitch: {kind: pitch_deviation, of: b, flanks: together, law: {kind: given, right: [ARCS]}}
moves:
  ab: {kind: mesh, driver: a, driven: b, centre_distance: 50.2 mm}
  bc: {kind: mesh, driver: b, driven: c, centre_distance: 55.2 mm, azimuth: 115 deg}
  train: {kind: train, driven: a, output: c}
measures:
  lost: {kind: lost_motion, of: train}
study: {trials: 400, seed: 1, engine: exact, witness: 0}
"""


def path_deg(mate: str) -> tuple[float, float]:
    """Azimuths of the idler's tooth off the line of centres [deg] between which its left flank touches a mate.

    Its string from the base circle is r_b (alpha_w + half a base tooth + azimuth).
    """
    bases = (30 + TEETH[mate]) * COS
    rolls = active_rolls(30, TEETH[mate], 2.0, APART[mate])
    half = math.pi / 60 + math.tan(math.radians(20)) - math.radians(20)
    low, high = (math.degrees(roll - math.sqrt((APART[mate] / bases) ** 2 - 1) - half) for roll in rolls)
    # a working angle is atan of its tangent; strings count from where the tangent touches
    turn = math.degrees(math.sqrt((APART[mate] / bases) ** 2 - 1) - math.acos(bases / APART[mate]))
    return low + turn, high + turn


def test_a_tooth_of_an_idler_acts_in_both_meshes_where_it_passes_them(tmp_path: Path) -> None:
    """Counter-clockwise ahead, its left flank stands out by 20 um cos(alpha); each mesh loses that, at the output.

    Where its right flank alone would touch it stands back by as much, and the mesh has all of its play.
    """
    arcs = ", ".join("20 um" if tooth == TOOTH else "0 um" for tooth in range(30))
    (tmp_path / "idler.yaml").write_text(SCENE.replace("ARCS", arcs), "utf-8")
    columns = run_scene(tmp_path / "idler.yaml", out=tmp_path / "run").columns()
    driver = columns["position:ab [deg]"]
    tooth = 180.0 + 180.0 / 30 - driver * 20 / 30 + TOOTH * 360.0 / 30  # of b, half a pitch off the line of centres
    inside, clear = np.zeros(len(driver), dtype=bool), np.ones(len(driver), dtype=bool)
    for mate, towards in TOWARDS.items():
        off = (tooth - towards + 180.0) % 360.0 - 180.0
        low, high = path_deg(mate)
        alone = -low - 12.0, -high + 12.0  # of right flanks, whose path is the mirrored one; a pitch is 12 deg
        inside |= (off > low) & (off < high) & ~((off > alone[0]) & (off < alone[1]))
        for end in (low, high, *alone):  # edges beyond the path, and the turn by the backlash
            clear &= np.abs(off - end) > 1.4
    assert min((inside & clear).sum(), (~inside & clear).sum()) > 12
    lost = math.degrees(AHEAD * 1e-3 * COS / (25 * COS)) * 60  # arcmin at c
    for method in ("analytic", "geometric"):
        values = columns[f"{method}:lost"]
        full = float(np.median(values[~inside & clear]))
        assert values[~inside & clear] == pytest.approx(full, abs=2e-3)
        assert values[inside & clear] == pytest.approx(full - lost, abs=5e-3)
