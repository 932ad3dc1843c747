"""A spur pair whose contact is read over the face and whose gap in its middle: tilts cost it on the working side only.

Each flank side is a plane along the face, so a turn of the axis by y about the line across both axes and x about the
line of centres opens or closes it by the offset of an end of the face: half a face times |sin(alpha_w) y + cos(alpha_w)
x| on the side of the driver's right flanks, times |sin(alpha_w) y - cos(alpha_w) x| on the other.
"""

import math
from pathlib import Path

import numpy as np
import pytest

from tol3d import Run, run_scene

HALF_FACE = 6.0  # mm
ALPHA = math.acos(1.8 * 77 / 2 * math.cos(math.radians(20)) / 71.5)  # working pressure angle
THIN = "{kind: constant, value: -60 um}"


def scene(flank: str, read_at: str, laws: tuple[str, str], trials: int, folder: Path) -> Run:
    """Run a 25/52 pair whose axes lean by so much over the face [um]: in their plane, and out of it."""
    text = f"""
scene: leaning pair
parts:
  a: {{kind: spur_gear, teeth: 25, module: 1.8 mm, profile_shift: 0.8, face_width: {2 * HALF_FACE} mm}}
  b: {{kind: spur_gear, teeth: 52, module: 1.8 mm, profile_shift: 0.49, face_width: {2 * HALF_FACE} mm}}
tolerances:
  thinned: {{kind: tooth_thickness, of: a, distribution: {THIN}}}
  in plane: {{kind: axis_in_plane, of: pair, distribution: {laws[0]}}}
  out of plane: {{kind: axis_out_of_plane, of: pair, distribution: {laws[1]}}}
moves:
  pair: {{kind: mesh, driver: a, driven: b, centre_distance: 71.5 mm, working_flank: {flank}}}
measures:
  play: {{kind: normal_backlash, of: pair, read_at: {read_at}}}
study: {{trials: {trials}, seed: 3}}
"""
    folder.mkdir(exist_ok=True)
    (folder / "scene.yaml").write_text(text, "utf-8")
    return run_scene(folder / "scene.yaml", out=folder / "run")


def constants(*lengths: float) -> tuple[str, str]:
    first, second = (f"{{kind: constant, value: {length} um}}" for length in lengths)
    return first, second


def ends(run: Run) -> tuple[float, float]:
    own = run.summary["measures"]["play"]
    return own["analytic"]["mean"], own["geometric"]["mean"]


def lost(flank: str, in_plane: float, out_of_plane: float) -> float:
    """By hand: f_delta and f_beta are deviations over the face width, so half a face has half of them."""
    a, b = math.sin(ALPHA) * in_plane / 2, math.cos(ALPHA) * out_of_plane / 2
    return abs(a + b) if flank == "right" else abs(a - b)


@pytest.mark.parametrize("flank", ["left", "right"])
@pytest.mark.parametrize(("in_plane", "out_of_plane"), [(8.0, 4.0), (8.0, -4.0), (-3.0, 5.0), (0.0, 6.0), (9.0, 0.0)])
def test_two_tilts_cost_the_working_side_the_way_of_the_end_of_its_face(
    flank: str, in_plane: float, out_of_plane: float, tmp_path: Path
) -> None:
    straight = ends(scene(flank, "face_contact", constants(0.0, 0.0), 2, tmp_path / "straight"))
    leaning = ends(scene(flank, "face_contact", constants(in_plane, out_of_plane), 2, tmp_path / "leaning"))
    expected = lost(flank, in_plane, out_of_plane)
    assert straight[0] - leaning[0] == pytest.approx(expected, abs=1e-9)
    # the contact is where a pair of teeth is, up to a base pitch away from the pitch point: 5 mm of tilts of 1e-3
    assert straight[1] - leaning[1] == pytest.approx(expected, abs=0.02)


def test_the_closed_form_is_that_of_the_sample(tmp_path: Path) -> None:
    """Two normal laws of 8 and 4 um add up on one side: |N(0, s)| with s the root of the sum of squares."""
    laws = ("{kind: normal, lower: -24 um, upper: 24 um}", "{kind: normal, lower: -12 um, upper: 12 um}")
    own = scene("left", "face_contact", laws, 20_000, tmp_path / "random").summary["measures"]["play"]
    spread = math.hypot(math.sin(ALPHA) * 8 / 2, math.cos(ALPHA) * 4 / 2)
    sigma = spread * math.sqrt(1 - 2 / math.pi)
    straight = ends(scene("left", "face_contact", constants(0.0, 0.0), 2, tmp_path / "straight"))[0]
    form = own["analytic_closed_form"]
    assert form["sigma"] == pytest.approx(sigma, rel=1e-3)  # the net's
    assert form["mean"] == pytest.approx(straight - spread * math.sqrt(2 / math.pi), abs=1e-3 * sigma)
    for method in ("analytic", "geometric"):
        assert own[method]["mean"] == pytest.approx(form["mean"], abs=4 * own[method]["mean_se"] + 0.02)
        assert own[method]["sigma"] == pytest.approx(sigma, abs=4 * own[method]["sigma_se"] + 0.02)
    assert not own["agreement"]["explanation"]["faults"]
    shares = np.array([c["analytic_percent"] for c in own["contributors"] if c["name"] != "thinned"])
    assert shares.sum() == pytest.approx(100.0, abs=0.5)
