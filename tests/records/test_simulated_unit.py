"""A scene's build on the rig by the exact engine, against flanks that touch by a root finder of its own."""

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest
from fixtures import Command
from scipy.optimize import brentq

from tol3d import load_scene, run_scene
from tol3d.apps.records.csv_file import Block
from tol3d.apps.records.findings import Settings
from tol3d.apps.records.identification import identified
from tol3d.apps.records.pair import ARCSEC, Side
from tol3d.apps.records.reading import Senses, passes_of
from tol3d.apps.records.rig import Rig, measured
from tol3d.apps.records.scene_mesh import SceneMesh, SimulatedUnit
from tol3d.simulate import simulation_of

SIDES: tuple[Side, ...] = ("drive", "back")
ALPHA = math.radians(20)
RB1, RB2 = 27 * math.cos(ALPHA), 48 * math.cos(ALPHA)
ROUNDING = 1e-9  # rad; the engine's contacts are found to 1e-10 mm over arms of 45 mm, and lie on the flanks

PAIR = """
scene: eccentric pair
parts:
  driver: {kind: spur_gear, teeth: 27, module: 2 mm, pressure_angle: 20 deg, face_width: 20 mm}
  driven: {kind: spur_gear, teeth: 48, module: 2 mm, pressure_angle: 20 deg, face_width: 20 mm}
tolerances:
  thinner teeth: {kind: tooth_thickness, of: driven, distribution: {kind: normal, lower: -90 um, upper: -50 um}}
  e1: {kind: eccentricity, of: driver, direction: {at: 40 deg}, distribution: {kind: constant, value: 18 um}}
  e2: {kind: eccentricity, of: driven, direction: {at: 115 deg}, distribution: {kind: constant, value: 27 um}}
MORE
moves:
  pair: {kind: mesh, driver: driver, driven: driven, centre_distance: 75 mm, working_flank: FLANK}
measures:
  drive TE: {kind: transmission_error, of: pair, flank: drive, over: turn, take: curve, positions: 432}
  back TE: {kind: transmission_error, of: pair, flank: back, over: turn, take: curve, positions: 432}
study: {trials: 4, seed: 3}
"""

PITCHES = """
  pitches of the driver:
    kind: pitch_deviation
    of: driver
    flanks: each
    limits: {iso_class: 6}
    law: {kind: random_walk, fill: [0.7, 1]}
"""

HOUSING = """
scene: eccentric pair in a housing
parts:
  housing:
    kind: solid
    expansion: 23e-6 1/K
    features:
      bore 1: {kind: cylinder, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 60 mm, diameter: 20 mm, hole: true}
      bore 2: {kind: cylinder, at: [75 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 60 mm, diameter: 20 mm, hole: true}
  input: {kind: shaft, diameter: 10 mm, start: -40 mm, end: 40 mm, carries: {driver: {at: 0 mm}}}
  output: {kind: shaft, diameter: 10 mm, start: -40 mm, end: 40 mm, carries: {driven: {at: 0 mm}}}
  driver: {kind: spur_gear, teeth: 27, module: 2 mm, pressure_angle: 20 deg, face_width: 20 mm, bore: 10 mm}
  driven: {kind: spur_gear, teeth: 48, module: 2 mm, pressure_angle: 20 deg, face_width: 20 mm, bore: 10 mm}
tolerances:
  warm housing: {kind: temperature, of: housing, distribution: {kind: constant, value: 60 K}}
  thinner teeth: {kind: tooth_thickness, of: driven, distribution: {kind: constant, value: -60 um}}
  e2: {kind: eccentricity, of: driven, direction: {at: 115 deg}, distribution: {kind: constant, value: 27 um}}
moves:
  base: {kind: fix, part: housing}
  input in its bore: {kind: shaft_in_bores, shaft: input, in: [housing.bore 1]}
  output in its bore: {kind: shaft_in_bores, shaft: output, in: [housing.bore 2]}
  pair: {kind: mesh, driver: driver, driven: driven, working_flank: left}
  train: {kind: train, driven: input, output: output}
measures:
  backlash: {kind: angular_backlash, of: pair, gear: driven}
study: {trials: 3, seed: 3}
"""


def scene_file(folder: Path, text: str, *, flank: str = "left", more: str = "") -> Path:
    path = folder / "own.yaml"
    path.write_text(text.replace("FLANK", flank).replace("MORE", more), encoding="utf-8")
    return path


def unit_of(path: Path, trial: int | None = None) -> SimulatedUnit:
    return SceneMesh.of(simulation_of(load_scene(path)), None).unit(trial)


def touching(phi1: float, side: Side, centres: tuple[complex, complex], thinning: float, distance: float) -> float:
    """phi2 by two strings over base circles, solved by bisection; 0 where the drive flanks rest without deviations.

    Args:
        phi1: driver's turn in its own sense [rad].
        side: which flanks touch.
        centres: of driver and driven gear off their axes at phi1 = phi2 = 0 [mm], x along the line of centres, y such
            that the driver turns towards it.
        thinning: of a tooth on the reference circle [mm].
        distance: of the axes [mm].
    """
    sense = -1.0 if side == "drive" else 1.0
    nominal = math.tan(ALPHA) - ALPHA
    ahead = thinning * math.cos(ALPHA) if side == "back" else 0.0

    def apart(phi2: float) -> float:
        line = distance + centres[1] * np.exp(-1j * phi2) - centres[0] * np.exp(1j * phi1)
        working = math.acos((RB1 + RB2) / abs(line))
        lean = math.tan(working) - working - nominal
        return float(RB2 * (phi2 + np.angle(line)) - RB1 * (phi1 - np.angle(line)) - sense * (RB1 + RB2) * lean - ahead)

    return float(brentq(apart, phi1 * RB1 / RB2 - 0.1, phi1 * RB1 / RB2 + 0.1, xtol=1e-14))


def placed(radius: float, azimuth: float) -> complex:
    return complex(radius * np.exp(1j * azimuth))


@pytest.mark.parametrize("flank", ["left", "right"])
def test_the_exact_engine_s_flanks_touch_where_strings_over_base_circles_do(tmp_path: Path, flank: str) -> None:
    """Azimuths of 40 and 115 deg count about +z from tooth 0, the driven gear's x axis faces away from the driver but
    for half a pitch; with a right working flank all turns the other way: mirrored at the line of centres.

    The driven gear stands half the play beside its nominal place at phi2 = 0, and its centre with it.
    """
    turned = 1.0 if flank == "left" else -1.0
    unit = unit_of(scene_file(tmp_path, PAIR, flank=flank))
    half = 0.070 / 2 / 48  # of the angular play without eccentricities, mean thinning 70 um: s = j cos(alpha)/r_b2
    wheel = math.pi + math.pi / 48 + math.radians(115)  # of its centre about +z, nominally
    centres = placed(0.018, turned * math.radians(40)), placed(0.027, turned * wheel + half)
    for side in SIDES:
        for phi1 in (0.0, 1.3, 40.0, 99.0):
            expected = touching(phi1, side, centres, 0.070, 75.0)
            assert float(unit.driven_angle(np.array([phi1]), side)[0]) == pytest.approx(expected, abs=ROUNDING)


def test_gears_in_a_housing_stand_where_its_warm_bores_put_them(tmp_path: Path) -> None:
    """Aluminium at 60 K, the gears cold: a = 75 (1 + 23e-6 60) = 75.1035 mm; the play opens with it."""
    unit = unit_of(scene_file(tmp_path, HOUSING))
    distance = 75 * (1 + 23e-6 * 60)
    assert unit.pair.centre_distance == pytest.approx(distance, abs=1e-9)
    wide = math.acos((RB1 + RB2) / distance)
    opened = 2 * (RB1 + RB2) * ((math.tan(wide) - wide) - (math.tan(ALPHA) - ALPHA))
    assert unit.specimen.constant_part == pytest.approx((0.060 * math.cos(ALPHA) + opened) / RB2, abs=1e-9)
    at = np.array([0.0, 1.3, 40.0, 99.0])
    found = unit.driven_angle(at, "back") - unit.driven_angle(at, "drive")
    # strings count phi2 from the drive flank at the nominal distance, half the play of thinner teeth off the middle
    wheel = placed(0.027, math.pi + math.pi / 48 + math.radians(115) + 0.060 / 2 / 48)
    for phi1, play in zip(at, found, strict=True):
        back, drive = (touching(float(phi1), side, (0j, wheel), 0.060, distance) for side in ("back", "drive"))
        assert float(play) == pytest.approx(back - drive, abs=ROUNDING)


@pytest.mark.slow
def test_a_trial_is_that_of_the_scene_s_study(tmp_path: Path) -> None:
    """TE of trial 2 of a run, tooth by tooth; what the rig adds is where the encoders stand."""
    path = scene_file(tmp_path, PAIR, more=PITCHES)
    kept = run_scene(path, out=tmp_path / "run").columns("geometric:drive TE", "geometric:back TE")
    unit = unit_of(path, 2)
    phi1 = np.arange(433) * 2 * math.pi / 432
    for side in SIDES:
        error = unit.driven_angle(phi1, side) - phi1 * 27 / 48
        np.testing.assert_allclose(error - error[0], kept[f"geometric:{side} TE"][2] * 60 * ARCSEC, atol=ROUNDING)
    with_teeth = Rig(turns=1, samples=432, noise=0.0)
    smooth = scene_file(tmp_path, PAIR)
    apart = measured(unit, with_teeth, "drive").phi2 - measured(unit_of(smooth, 2), with_teeth, "drive").phi2
    spectrum = 2 * np.abs(np.fft.rfft(apart)) / 432 / ARCSEC
    assert spectrum[2:14].max() > 1.0  # pitches walk over the turn; single teeth step


def test_what_cannot_be_measured_is_refused(tol3d: Command, tmp_path: Path) -> None:
    scene = str(scene_file(tmp_path, PAIR))
    jammed = tmp_path / "jammed.yaml"
    text = Path(scene).read_text("utf-8")  # 45 um off centre take up to 2 sin(20 deg) 45 um = 31 um of 24
    jammed.write_text(text.replace("lower: -90 um, upper: -50 um", "lower: -28 um, upper: -24 um"), encoding="utf-8")
    for arguments, words in (
        ((scene, "--trial", "4"), "--trial: expected 0 … 3, which the scene's study has, got 4"),
        ((scene, "--engine", "exact", "--e1", "3 um"), "--e1: of --engine closed_form only"),
        ((str(jammed), "--engine", "exact"), "pair: this build cannot be turned: interferes at phi1 = "),
    ):
        out = tmp_path / "out"
        code, said, err = tol3d("rig", *arguments, "--out", str(out))
        assert (code, said) == (2, "")
        assert words in err
        assert err.count("\n") == 1
        assert not out.exists()


def test_the_closed_form_says_that_it_leaves_teeth_out(tol3d: Command, tmp_path: Path) -> None:
    for more, said in (
        ("", ""),
        (PITCHES, "warning: single teeth deviate, which the closed form leaves out; --engine"),
    ):
        scene = str(scene_file(tmp_path, PAIR, more=more))
        code, _, err = tol3d("rig", scene, "--turns", "1", "--out", str(tmp_path / "out"))
        assert code == 0
        assert err.startswith(said)
        assert bool(err) == bool(said)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("more", "positions", "flank"),
    [("", 1, "left"), ("", 1, "right"), (PITCHES, 72, "left")],
    ids=["eccentric", "right flank", "with pitch deviations"],
)
def test_the_scene_of_an_identified_unit_lies_over_the_measured_curve(
    tol3d: Command, tmp_path: Path, more: str, positions: int, flank: str
) -> None:
    """A trial by the exact engine, read by encoders of 6 and 4 arcsec; identified; simulated.

    Ten rows a side lie about each position: a mean of both scatters by sigma sqrt(2/10), of 1152 positions by less than
    five times that. Positions of a scene count about +z, those of the curve in the driver's own sense. The written
    scene has no teeth that deviate: where the driver's pitches do, the curves part tooth by tooth, and lie over each
    other on the mean of a turn.
    """
    scene = str(scene_file(tmp_path, PAIR, more=more, flank=flank))
    errors = ("--encoder1", "6 arcsec", "--encoder2", "4 arcsec", "--engine", "exact", "--trial", "1")
    assert tol3d("rig", scene, *errors, "--out", str(tmp_path))[0] == 0
    files = ("--drive", str(tmp_path / "drive.csv"), "--back", str(tmp_path / "back.csv"))
    out = tmp_path / "identified"
    assert tol3d("identify", *files, "--scene", scene, "--out", str(out))[0] == 0
    with (out / "backlash.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))[:-1]  # the last is the first again
    seen = np.array([float(row["measured [arcsec]"]) for row in rows])
    run = run_scene(out / "identified.yaml", out=tmp_path / "run")
    simulated = 60 * run.columns("geometric:backlash curve")["geometric:backlash curve"][0]
    if flank == "right":
        simulated = simulated[-np.arange(len(simulated))]  # at -phi1 about +z
    kept = json.loads((out / "identified.json").read_text("utf-8"))
    apart = (simulated - seen).reshape(-1, positions).mean(axis=1)
    sigma = math.hypot(1, 27 / 48) * 0.5  # of a row, by both encoders' noise
    assert np.abs(apart).max() < 5 * sigma * math.sqrt(2 / (10 * positions)) + 2 * kept["figures"]["j0"]["half_width"]
    assert np.ptp(simulated) > 250.0
    assert (np.std(simulated - seen) > 5.0) == bool(more)


@pytest.mark.slow
@pytest.mark.parametrize(("turns", "widest"), [(16.25, 0.3), (16.0, 90.0)])
def test_teeth_that_deviate_close_after_the_long_period(tmp_path: Path, turns: float, widest: float) -> None:
    """Pitches of class 6 on both gears, four trials by the exact engine; encoders that neither drift nor slip.

    At the same places noise alone is left, 1.96 (0.57 arcsec) sqrt(2/180) of a side; across the end of the period the
    cumulative pitches of other teeth, up to 20 um over 45 mm, stand against each other.
    """
    more = PITCHES + PITCHES.replace("of the driver", "of the driven gear").replace("of: driver", "of: driven")
    mesh = SceneMesh.of(simulation_of(load_scene(scene_file(tmp_path, PAIR, more=more))), None)
    for trial in range(4):
        unit, read = mesh.unit(trial), {}
        for side in SIDES:
            rows = measured(unit, Rig(turns=turns, encoder1=6 * ARCSEC, seed=trial), side)
            block = Block(0, rows.phi1, rows.phi2, None, None)
            read[side] = tuple(passes_of(unit.pair, Path(f"{side}.csv"), [block], Senses(1, 1)))
        found = identified(unit.pair, read, Senses(1, 1), Settings(encoder_error=1.0))
        assert not [text for text in found.warnings if "close" in text]
        for own in found.closure.values():
            assert abs(own.value) < 2.0 * own.half_width
            assert own.half_width / ARCSEC < widest
