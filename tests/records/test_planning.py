"""Expected accuracy of a rig, against identifying many of its measurements; and the commands around it."""

import csv
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fixtures import Command
from records.rigged import PAIR, REFERENCE, identified_by, scene_in

from tol3d.apps.records.findings import Settings
from tol3d.apps.records.pair import ARCSEC, RigPair, Specimen
from tol3d.apps.records.planning import plan_rig, row_variance
from tol3d.apps.records.rig import Rig, measured

FIGURES = (
    "e1",
    "theta1",
    "e2",
    "theta2",
    "jc",
    "j0",
    "jmin eccentric",
    "jmax eccentric",
    "jmin eccentric at",
    "jmax eccentric at",
)
RIG = Rig(samples=100, noise=0.5 * ARCSEC, encoder1=6 * ARCSEC, encoder2=4 * ARCSEC)


def test_the_plan_is_what_identifying_finds() -> None:
    """Both take the same columns; identifying estimates the noise, of 800 rows to 1/sqrt(1600): five times that."""
    for turns in (2.0, 4.0):
        plan = plan_rig(REFERENCE, RIG, [turns])[0]
        found = identified_by(REFERENCE, replace(RIG, turns=turns))
        for name in FIGURES:
            assert found.figures[name].half_width == pytest.approx(plan.figures[name].half_width, rel=0.14), name
        for name, own in found.encoders.items():  # whatever its phase: within the two axes of its ellipse
            assert own.half_width == pytest.approx(plan.figures[name].half_width, rel=0.4), name


@pytest.mark.slow
@pytest.mark.parametrize("drift", [False, True])
def test_the_plan_is_the_scatter_of_many_measurements(drift: bool) -> None:
    """150 measurements: a standard deviation is known to 1/sqrt(300) = 6 %; four times that."""
    rig = replace(RIG, turns=3.0, resolution=0.4 * ARCSEC)
    plan = plan_rig(REFERENCE, rig, [3.0], drift=drift)[0]
    found = [identified_by(REFERENCE, replace(rig, seed=seed), Settings(drift=drift)).figures for seed in range(150)]
    for name in FIGURES:
        scatter = float(np.std([own[name].value for own in found], ddof=1))
        assert 1.96 * scatter == pytest.approx(plan.figures[name].half_width, rel=0.24), name


def test_half_widths_fall_with_the_root_of_the_rows_and_with_the_noise() -> None:
    once = plan_rig(REFERENCE, RIG, [16.0])[0].figures
    four = plan_rig(REFERENCE, replace(RIG, repeats=4), [16.0])[0].figures
    twice = plan_rig(REFERENCE, replace(RIG, noise=1.0 * ARCSEC), [16.0])[0].figures
    for name in FIGURES:
        assert once[name].half_width / four[name].half_width == pytest.approx(2.0, rel=0.01)
        assert twice[name].half_width / once[name].half_width == pytest.approx(2.0, rel=1e-9)


def test_over_the_long_period_half_widths_are_those_of_orthogonal_columns() -> None:
    """j_c is a difference of two means: sigma sqrt(1/n + 1/n); e by both sides' amplitudes, r_b2/(2 sin alpha) apart.

    A side's sine has the variance 2 sigma^2/n; e = r_b2 |A_b - A_d|/(2 sin alpha), so sigma_e is r_b2 sigma
    sqrt(4/n)/(2 sin alpha).
    """
    n, sigma = 1600, math.sqrt(row_variance(PAIR, RIG))
    found = plan_rig(REFERENCE, RIG, [16.0])[0].figures
    assert found["jc"].half_width == pytest.approx(1.961 * sigma * math.sqrt(2 / n), rel=0.001)
    arm = PAIR.driven_base_radius / (2 * math.sin(PAIR.working_angle))
    assert found["e1"].half_width == pytest.approx(1.961 * arm * sigma * math.sqrt(4 / n), rel=0.002)
    assert found["e2"].half_width == pytest.approx(1.961 * arm * sigma * math.sqrt(4 / n), rel=0.002)


def test_one_turn_does_not_suffice() -> None:
    one, two = plan_rig(REFERENCE, RIG, [1.0, 2.0])
    assert not one.suffices
    assert one.figures == {}
    assert two.suffices


def test_nearly_equal_gears_need_many_turns() -> None:
    """z 27/28: driver and driven part by 13 degrees a turn."""
    pair = RigPair(27, 28, 27.0 * math.cos(0.35), 28.0 * math.cos(0.35), 55.0)
    plans = plan_rig(Specimen(pair, 0.02, 0.0, 0.02, 0.0, 0.1), RIG, [2.0, 28.0])
    assert [own.suffices for own in plans] == [False, True]


# the rig ------------------------------------------------------------------------------------------


def test_a_rig_without_errors_reads_the_exact_play() -> None:
    """By the identity TE_d + j = TE_b + j_0 and the reference's backlash at phi1 = 0 of 267.037 arcsec."""
    clean = Rig(turns=1, samples=8, noise=0.0, zeroed=False)
    drive, back = measured(REFERENCE, clean, "drive"), measured(REFERENCE, replace(clean, zeroed=True), "back")
    assert drive.phi1[0] == 0.0
    assert back.phi2[0] == 0.0
    plain = measured(REFERENCE, clean, "back")
    assert plain.phi1[0] > 0.0  # sides are sampled at other places


def test_encoders_step_by_their_resolution() -> None:
    rows = measured(REFERENCE, Rig(turns=1, samples=50, resolution=2 * ARCSEC), "drive")
    steps = rows.phi2 / (2 * ARCSEC)
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)


def test_the_same_seed_gives_the_same_rows_and_another_one_others() -> None:
    rig = Rig(turns=1, samples=50)
    first, again = measured(REFERENCE, rig, "back"), measured(REFERENCE, rig, "back")
    assert (first.phi2 == again.phi2).all()
    assert (first.phi2 != measured(REFERENCE, replace(rig, seed=2), "back").phi2).any()


# commands -----------------------------------------------------------------------------------------


def test_the_rig_s_files_are_identified(tol3d: Command, tmp_path: Path) -> None:
    scene = str(scene_in(tmp_path))
    said = ("--e1", "18 um", "--theta1", "40 deg", "--e2", "27 um", "--theta2", "-65 deg", "--backlash", "60 um")
    passes = ("--turns", "3", "--samples", "90", "--repeats", "2", "--torque", "1 N m", "--torque", "2 N m")
    errors = ("--winding", "20 arcsec", "--encoder1", "6 arcsec", "--tooth-mesh", "2 arcsec", "--wrapped")
    code, out, err = tol3d("rig", scene, *said, *passes, *errors, "--out", str(tmp_path / "rig"))
    assert (code, err) == (0, "")
    files = [tmp_path / "rig" / f"{side}.csv" for side in ("drive", "back")]
    assert out.split() == [str(path) for path in files]
    first, header = files[0].read_text("utf-8").splitlines()[:2]
    assert first == "# synthetic: written by tol3d rig, seed 1"
    assert header == "phi1 [deg],phi2 [deg],torque [N m],repeat"
    code, out, _ = tol3d("identify", "--drive", str(files[0]), "--back", str(files[1]), "--scene", scene)
    assert code == 0
    assert "540 rows in 2 passes, 2.99 turns" in out
    assert "winding" in out


def test_a_torque_without_a_pass_is_refused(tol3d: Command, tmp_path: Path) -> None:
    torques = ("--torque", "1 N m", "--torque", "2 N m")
    code, said, err = tol3d("rig", str(scene_in(tmp_path)), *torques, "--out", str(tmp_path / "out"))
    assert (code, said) == (2, "")
    assert err == "--repeats: expected at least 2, one pass for each --torque, got 1\n"


@pytest.mark.parametrize("name", ["drive.csv", "back.csv"])
def test_measured_files_are_not_replaced_by_synthetic_ones(tol3d: Command, tmp_path: Path, name: str) -> None:
    scene, out = str(scene_in(tmp_path)), tmp_path / "rig"
    arguments = ("rig", scene, "--turns", "1", "--samples", "20", "--backlash", "60 um", "--out", str(out))
    assert [tol3d(*arguments)[0] for _ in range(2)] == [0, 0]  # its own are
    other = "back.csv" if name == "drive.csv" else "drive.csv"
    (out / name).write_text("phi1 [deg],phi2 [deg]\n0,0\n", encoding="utf-8")
    before = (out / other).read_bytes()
    code, said, err = tol3d(*arguments, "--seed", "2")
    assert (code, said) == (2, "")
    assert f"{name}: is there and not written by `tol3d rig`" in err
    assert (out / name).read_text("utf-8") == "phi1 [deg],phi2 [deg]\n0,0\n"
    assert (out / other).read_bytes() == before


def test_the_plan_is_printed_and_written(tol3d: Command, tmp_path: Path) -> None:
    table = tmp_path / "plan.csv"
    arguments = ("plan-rig", str(scene_in(tmp_path)), "--turns", "1,2,16", "--e1", "18 um", "--e2", "27 um")
    code, out, err = tol3d(*arguments, "--out", str(table))
    assert (code, err) == (0, "")
    assert "1 turn does not tell the driver's part from the driven gear's" in " ".join(out.split())
    with table.open(encoding="utf-8") as file:
        rows = {row[0]: row[2:] for row in csv.reader(file)}
    least = rows["least of the eccentricities alone [±″]"]
    assert least[0] == "–"
    assert 0 < float(least[2]) < float(least[1]) < 0.2


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--turns", "2;4"), "--turns: expected numbers from 0.1 to 10000 between commas, such as 2,4,16, got '2;4'"),
        (("--noise", "0.5"), "--noise: expected an angle with its unit"),
        (("--noise", "1e999 arcsec"), "--noise: expected an angle with its unit"),  # not finite
        (("--noise", "1 arcsec" + 99 * " " + "wrong"), "--noise: expected an angle with its unit"),
        (("--noise", "-1 arcsec"), "--noise: expected 0 or more, got '-1 arcsec'"),
        (("--resolution", "-1 urad"), "--resolution: expected 0 or more, got '-1 urad'"),
        (("--e1", "3 arcsec"), "--e1: expected a length with its unit"),
    ],
)
def test_a_wrong_option_gets_one_message(tol3d: Command, tmp_path: Path, options: tuple[str, str], words: str) -> None:
    code, out, err = tol3d("plan-rig", str(scene_in(tmp_path)), *options)
    assert (code, out) == (2, "")
    assert words in err
