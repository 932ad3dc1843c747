"""The motor's compensation when the load changes side, against the paper's section 4 and what follows by hand."""

import math
import re
import tomllib
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from fixtures import Command
from gear_trials import drawn_trials, gear_columns
from matplotlib.patches import StepPatch
from of_kind import known, of_kind
from places import SCENES
from rich.console import Console

from tol3d import Overrides, load_scene, run_scene
from tol3d.apps.adjustment.compensation import Compensation, CompensationQuestion, compensation
from tol3d.apps.adjustment.compensation_picture import compensation_figure
from tol3d.apps.adjustment.compensation_table import Spread, compensation_report
from tol3d.apps.adjustment.robots import STATES, left_of_the_mean
from tol3d.errors import InputError
from tol3d.gearing import CLOSED_FORM, train_play
from tol3d.gearing.engines.gaps import exact_engine
from tol3d.gearing.grammar.tolerances.gears import ShimSpec
from tol3d.gears.flank import opposite
from tol3d.report.number import tip_mm
from tol3d.units import ARCMIN

SWING = SCENES / "robot_shoulder_swing.yaml"
ROBOT, SHIMMED, TABLE = (
    SCENES / f"{name}.yaml" for name in ("robot_shoulder", "robot_shoulder_shimmed", "three_stage_train")
)
LEVER = 763.0  # mm
RATIO = 152 * 110 / 28  # turns of the motor per turn of the flange
DATA_SHEET = 28 / 110  # arcmin; the reducer's 1′, behind the spur pair
CENTRE = 3.5 * 31 - 9 * math.sin(math.pi / 4)  # mm; the bevel's diameter in the middle of its face, 102.136
ALPHA = math.radians(20.0)
ROUNDING = 1e-11  # arcmin; of some hundred minutes that are added up
TURNING = re.compile(r"  .*kind: (eccentricity|run_out).*\n")
NOT_LINEAR = re.compile(r"  .*kind: (axes_offset|shaft_angle|mounting_face|shim|bearing_clearance).*\n")


@cache
def of(path: Path, robots: int | None = None, positions: int = 16, seed: int | None = None) -> Compensation:
    return compensation(load_scene(path), CompensationQuestion(None, positions, robots), Overrides(seed=seed))


def changed(folder: Path, *changes: tuple[str | re.Pattern[str], str], scene: Path = SHIMMED) -> Path:
    """A scene with some text replaced."""
    text = scene.read_text("utf-8")
    for old, new in changes:
        replaced = re.sub(old, new, text) if isinstance(old, re.Pattern) else text.replace(old, new)
        assert replaced != text, old
        text = replaced
    path = folder / "changed.yaml"
    path.write_text(text, "utf-8")
    return path


# the paper's section 4 ----------------------------------------------------------------------------


def degrees(normal_backlash: float, diameter: float) -> float:
    """The paper's lost motion of a pair, of um and mm: 2 j_t/(1000 d) 180/pi, j_n = j_t cos 20 deg."""
    return 0.12195 * normal_backlash / diameter


PRINTED = {ROBOT: (90.0, 108.0, 78.49, (9 * 60 + 59, 2.217)), SHIMMED: (43.0, 61.0, 44.97, (6 * 60 + 37, 1.47))}
"""Bevel pair, mean and high [um]; the motor's correction [deg]; sum of highs [arcsec] and at the tip [mm]."""


@pytest.mark.parametrize("scene", PRINTED)
def test_the_papers_formula_gives_its_printed_correction(scene: Path) -> None:
    mean, _, printed, _ = PRINTED[scene]
    correction = RATIO * (degrees(54, 275) + degrees(mean, 102.1))  # i0 i1 Δφ_1m + i0 i1 i2 Δφ_2m
    assert correction == pytest.approx(printed, abs=0.005)


@pytest.mark.parametrize("scene", PRINTED)
def test_the_correction_of_published_means_is_the_papers_to_its_printed_digits(scene: Path) -> None:
    mean, _, printed, _ = PRINTED[scene]
    motor = known(of(scene).corrections["paper, 3DCS"].motor) / 60
    assert motor == pytest.approx(RATIO * (degrees(54, 275) + degrees(mean, 102.1)), rel=1e-5)
    assert f"{motor:.2f}" == f"{printed:.2f}"


@pytest.mark.parametrize("scene", PRINTED)
def test_sums_of_published_highs_are_the_papers(scene: Path) -> None:
    mean, high, _, (before, tip) = PRINTED[scene]
    correction = of(scene).corrections["paper, 3DCS"]
    assert 60 * known(correction.before) == pytest.approx(before, abs=0.5)
    assert tip_mm(correction.before, LEVER) == pytest.approx(tip, abs=0.005)
    assert (3600 * degrees(75 - 54, 275), 3600 * degrees(high - mean, 102.1)) == pytest.approx((34, 77), abs=0.6)
    assert 60 * known(correction.left) == pytest.approx(2 * 60 + 6, abs=0.5)
    assert tip_mm(correction.left, LEVER) == pytest.approx(0.47, abs=0.005)


def test_the_closed_forms_correction_follows_by_hand() -> None:
    """Means of spur_pair.yaml and bevel_pair_shimmed.yaml, whose closed forms have tests of their own [um]."""
    sin, cos = math.sin(ALPHA), math.cos(ALPHA)
    spur = (19 + 30) / 2 * cos + (21 + 32) / 2 * cos + 16 * sin
    bevel = 2 * 42.5 * cos + math.sqrt(0.5) * sin * 2 * 20 - 2 * math.sqrt(2) * sin * 48
    arms = 137.5e3 * cos, CENTRE / 2 * 1e3 * cos
    found = of(SHIMMED).corrections[CLOSED_FORM]
    means = {"spur pair": spur / arms[0] * ARCMIN, "bevel pair": bevel / arms[1] * ARCMIN}
    assert found.means == pytest.approx(means, rel=1e-9)
    assert found.motor == pytest.approx(RATIO * sum(means.values()), rel=1e-9)


def test_a_methods_correction_is_that_of_the_stage_means_of_a_run(tmp_path: Path) -> None:
    run = run_scene(SHIMMED, overrides=Overrides(trials=100, witness=0), out=tmp_path / "run")
    stages = run.summary["trains"]["shoulder swing"]["stages"]
    for method, turns in (("analytic", (RATIO, RATIO)), ("geometric", (RATIO, RATIO))):
        means = [stage["methods"][method]["mean"] for stage in stages if stage["link"] != "planetary reducer"]
        assert of(SHIMMED, 100).corrections[method].motor == pytest.approx(np.dot(means, turns), rel=1e-12)


# what is left -------------------------------------------------------------------------------------


def test_uncompensated_robots_are_the_trials_of_the_study() -> None:
    own = of(SHIMMED, 100)
    columns = gear_columns(own.play.model, exact_engine(own.play.model), drawn_trials(own.play.model, 1, 0, 100))
    for method, remaining in own.remaining.items():
        assert remaining.angles["before"] == pytest.approx(columns[f"{method}:lost motion"], rel=1e-12)
        assert remaining.tips["before"] == pytest.approx(columns[f"{method}:tip displacement"], rel=1e-12)


def test_a_scenes_own_swing_is_that_of_its_trials() -> None:
    own = of(SWING, 100)
    columns = gear_columns(own.play.model, exact_engine(own.play.model), drawn_trials(own.play.model, 1, 0, 100))
    assert known(own.swing).output == pytest.approx(np.radians(np.linspace(-60, 60, 25)))
    for method, curves in known(own.swing).curves.items():
        assert curves["before"] == pytest.approx(columns[f"{method}:tip error over the swing"], rel=1e-12)


def test_without_a_swing_in_the_scene_it_goes_as_far_to_both_sides_of_where_the_load_changes() -> None:
    shown = np.degrees(known(of(ROBOT, 50).swing).output)
    change = math.degrees(math.atan2(83.4, 445.1))
    assert (shown[0], shown[-1], len(shown)) == pytest.approx((change - 60, change + 60, 25))


@pytest.mark.parametrize("method", ["analytic", "geometric"])
def test_the_batchs_mean_moves_the_errors_and_leaves_their_spread(method: str) -> None:
    angles = of(SHIMMED).remaining[method].angles
    shift = angles["before"] - angles["batch"]
    assert np.ptp(shift) < ROUNDING
    assert Spread(angles["batch"]).moments.sigma == pytest.approx(Spread(angles["before"]).moments.sigma, rel=1e-12)
    assert angles["batch"].mean() == pytest.approx(DATA_SHEET, abs=ROUNDING)  # left out of the correction


def test_the_own_mean_leaves_what_is_left_out_where_nothing_turns(tmp_path: Path) -> None:
    own = of(changed(tmp_path, (TURNING, "")), 200)
    left, before = own.remaining["analytic"].angles["robot"], own.remaining["analytic"].angles["before"]
    assert left == pytest.approx(DATA_SHEET, abs=ROUNDING)
    assert before.std() > 1e9 * np.ptp(left)
    # where in its pitch a tooth stands: cones that are shifted by 48 um are touched elsewhere as they turn
    seen = own.remaining["geometric"].angles
    assert 0 < seen["robot"].std() < 0.01 * seen["before"].std()
    assert own.form_sigmas["robot"] == 0.0


def test_the_own_mean_is_exact_in_3d_where_tooth_thickness_alone_varies(tmp_path: Path) -> None:
    """Flanks that are conjugate have the same play at every position; the robot's own is all there is."""
    own = of(changed(tmp_path, (TURNING, ""), (NOT_LINEAR, "")), 100)
    left = own.remaining["geometric"].angles["robot"]
    assert left == pytest.approx(DATA_SHEET, abs=1e-9 * ARCMIN)  # rad; where the exact engine's steps end
    assert own.remaining["geometric"].angles["before"].std() > 0.2  # arcmin


def turning_variance(positions: int) -> float:
    """Variance of what turns with gears, less the own mean of so many positions [rad^2], by hand from the scales.

    The long period is 14 turns of the spline shaft (28 and 110 teeth meet again after 55 turns of the pinion).
    """
    spur, bevel = 2 * math.tan(ALPHA) / 137.5e3, 2 * math.tan(ALPHA) * math.sqrt(0.5) / (CENTRE / 2 * 1e3)
    pinion = spur**2 * ((27 / 6) ** 2 + (8 / 6) ** 2) * (1 + left_of_the_mean(55, positions))
    wheel = spur**2 * (31 / 6) ** 2 * (1 + left_of_the_mean(14, positions))
    return pinion + wheel + bevel**2 * 2 * 4.714045**2 * (1 + left_of_the_mean(14, positions))


@pytest.mark.slow
@pytest.mark.parametrize("positions", [1, 3, 14, 16, 55])
def test_the_own_mean_leaves_what_turns_with_gears_and_its_own_error(positions: int) -> None:
    own, sigma = of(SHIMMED, None, positions), math.sqrt(turning_variance(positions))
    assert own.form_sigmas["robot"] == pytest.approx(sigma * ARCMIN, rel=1e-6)
    for method, more in (("analytic", 0.0), ("geometric", 0.01)):  # 3D: squares, and where in its pitch a tooth stands
        moments = Spread(own.remaining[method].angles["robot"]).moments
        tips = Spread(own.remaining[method].tips["robot"]).moments
        assert moments.count == 2000
        assert abs(moments.sigma - sigma * ARCMIN) < 4 * moments.sigma_se + more * sigma * ARCMIN
        assert abs(tips.sigma - sigma * LEVER) < 4 * tips.sigma_se + more * sigma * LEVER
        assert abs(moments.mean - DATA_SHEET) < 4 * moments.mean_se


@pytest.mark.parametrize(("turns", "positions"), [(1, 1), (1, 16), (14, 14), (14, 16), (55, 16), (3, 7)])
def test_what_an_own_mean_leaves_of_a_wave_follows_by_quadrature(turns: int, positions: int) -> None:
    """Variances of cos(2 pi h s + phase) in each P-th of 0 ... 1, averaged over the phase."""
    s = (np.arange(positions)[:, None] + (np.arange(2000) + 0.5) / 2000) / positions
    phases = 2 * np.pi * np.arange(8) / 8
    waves = np.cos(2 * np.pi * turns * s[None] + phases[:, None, None])
    of_the_mean = waves.var(axis=2).sum(axis=1).mean() / positions**2
    assert left_of_the_mean(turns, positions) == pytest.approx(of_the_mean / 0.5, abs=1e-5)  # midpoints: (h/2000)^2


def test_a_reducer_with_a_distribution_is_compensated(tmp_path: Path) -> None:
    law = "{kind: uniform, lower: 0 arcmin, upper: 1 arcmin}"
    play = f"  reducer play: {{kind: reducer_backlash, of: planetary reducer, distribution: {law}}}\n\n"
    path = changed(tmp_path, (", ratio: 152, backlash: 1 arcmin", ", ratio: 152"), ("\nmoves:", f"{play}moves:"))
    own, without = of(path), of(SHIMMED)
    assert (own.left_out, [stage.link for stage in without.left_out]) == ((), ["planetary reducer"])
    form = own.corrections[CLOSED_FORM]
    assert form.means["planetary reducer"] == pytest.approx(0.5, rel=1e-12)
    assert form.motor == pytest.approx(known(without.corrections[CLOSED_FORM].motor) + 152 * 0.5, rel=1e-12)
    more = DATA_SHEET * 3 * math.sqrt(1 / 12)  # high - mean of the uniform, instead of the whole maximum
    assert known(form.left) - known(without.corrections[CLOSED_FORM].left) == pytest.approx(more - DATA_SHEET, rel=1e-9)
    # what a robot has of it stays as it is, and its own mean knows it
    left = own.remaining["geometric"].angles["robot"]
    assert left == pytest.approx(without.remaining["geometric"].angles["robot"] - DATA_SHEET, abs=ROUNDING)


# draws --------------------------------------------------------------------------------------------


def test_the_same_seed_gives_the_same_bits_and_another_one_others() -> None:
    first, again, other = of(SHIMMED, 50), of.__wrapped__(SHIMMED, 50), of(SHIMMED, 50, seed=2)
    for state in STATES:
        one, same, new = (own.remaining["geometric"].tips[state] for own in (first, again, other))
        assert np.array_equal(one, same)
        assert not np.any(one == new)


def test_a_robot_depends_neither_on_their_number_nor_on_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = of(SHIMMED, 50).remaining["geometric"].angles
    fewer = of(SHIMMED, 20).remaining["geometric"].angles
    monkeypatch.setattr(train_play, "ROWS_AT_ONCE", 17 * 7)
    in_pieces = of.__wrapped__(SHIMMED, 50).remaining["geometric"].angles
    for state in ("before", "robot"):
        assert np.array_equal(whole[state][:20], fewer[state])
        assert np.array_equal(whole[state], in_pieces[state])


def test_robots_that_interfere_are_counted_and_left_out_of_both_methods(tmp_path: Path) -> None:
    """Shims of 80 um leave a mean of 12 um, with a sigma of 6.7 um and the least of 17 positions."""
    tight = of(changed(tmp_path, ("value: 0.048 mm", "value: 0.08 mm")), 400)
    assert 10 < tight.failed < 200
    for method in ("analytic", "geometric"):
        angles = tight.remaining[method].angles
        assert {len(angles[state]) for state in STATES} == {400 - tight.failed}
        assert not np.isnan(angles["robot"]).any()
        assert len(known(tight.swing).curves[method]["robot"]) <= 400 - tight.failed
    assert f"{tight.failed} of them could not be assembled and are left out" in " ".join(shown(tight).split())


def test_an_analytic_study_has_the_analytic_method_alone(tmp_path: Path) -> None:
    own = of(changed(tmp_path, ("engine: exact, witness: 10,", "engine: analytic,")), 100)
    assert (own.method, list(own.remaining), list(known(own.swing).curves)) == ("analytic", ["analytic"], ["analytic"])
    same = of(SHIMMED, 100).remaining["analytic"].angles
    assert all(own.remaining["analytic"].angles[state] == pytest.approx(same[state], rel=1e-12) for state in STATES)
    assert "3D simulation" not in shown(own)


@pytest.mark.slow
def test_fcl_leaves_what_the_exact_engine_leaves(tmp_path: Path) -> None:
    own = of(changed(tmp_path, ("engine: exact, witness: 10,", "engine: fcl,")), 20, 4)
    exact = of(SHIMMED, 20, 4)
    for state in STATES:  # 1.2 um at the tip is what the witness of a run finds, and a mean has as much
        difference = own.remaining["geometric"].tips[state] - exact.remaining["geometric"].tips[state]
        assert np.abs(difference).max() < 2 * 2.4e-3  # mm; the chord error of its strips there


# over the swing -----------------------------------------------------------------------------------


def test_the_load_changes_side_where_the_arms_weight_passes_over_the_axis() -> None:
    (jump,) = known(of(ROBOT, 50).swing).jumps
    assert jump == pytest.approx(math.atan2(83.4, 445.1), abs=1e-6)


def test_the_other_flanks_work_behind_the_jump(tmp_path: Path) -> None:
    own = of(ROBOT, 50)
    flanks = {mesh.name: (mesh.working_flank, opposite(mesh.working_flank)) for mesh in own.play.model.meshes}
    assert known(own.swing).flanks == flanks  # the model's are those at 0 deg, before the jump at 10.6 deg
    over_the_other_side = changed(tmp_path, ("[83.4 mm, 445.1", "[-83.4 mm, 445.1"), scene=ROBOT)
    mirrored = of(over_the_other_side, 50)  # at 0 deg the jump lies behind
    assert known(mirrored.swing).jumps == pytest.approx([-angle for angle in known(own.swing).jumps], abs=1e-6)
    assert known(mirrored.swing).flanks == known(own.swing).flanks
    now = {mesh.name: mesh.working_flank for mesh in mirrored.play.model.meshes}
    assert now == {name: behind for name, (_, behind) in flanks.items()}


def test_gravity_that_pulls_up_has_the_other_flanks_work(tmp_path: Path) -> None:
    up = known(of(changed(tmp_path, ("gravity: [0, -1, 0]", "gravity: [0, 1, 0]"), scene=ROBOT), 50).swing)
    down = known(of(ROBOT, 50).swing)
    assert up.jumps == pytest.approx(down.jumps, abs=1e-6)
    assert up.flanks == {name: (behind, before) for name, (before, behind) in down.flanks.items()}


def test_the_tip_is_right_before_the_jump_and_turned_back_behind_it() -> None:
    own = of(SHIMMED, 100)
    before, batch, robot = (known(own.swing).curves["geometric"][state] for state in STATES)
    behind = np.degrees(known(own.swing).output) > 10.62
    for curve in (before, batch, robot):
        assert np.all(curve[:, ~behind] == 0.0)
    back = known(own.corrections["geometric"].motor) / RATIO / ARCMIN
    by_hand = 2 * LEVER * np.sin(np.arcsin(before / (2 * LEVER)) - back / 2)  # of the chord
    assert batch[:, behind] == pytest.approx(by_hand[:, behind], abs=1e-12)
    # what the motor does not know: each robot's own mean, over the same swing less spread than the batch's
    assert np.all(robot[:, behind].std(axis=0) < 0.7 * batch[:, behind].std(axis=0))


def test_without_a_change_of_side_there_is_no_swing(tmp_path: Path) -> None:
    assert of(changed(tmp_path, ("end: 60 deg", "end: 0 deg"), scene=SWING), 20).swing is None


# what is asked, and shown -------------------------------------------------------------------------


def test_a_train_without_an_arm_is_told_in_angles() -> None:
    own = of(TABLE, 100)
    assert (own.units, own.lever, own.swing) == (("arcmin",), None, None)
    assert not own.remaining["geometric"].tips
    lost = own.remaining["geometric"].angles["before"]
    columns = gear_columns(own.play.model, exact_engine(own.play.model), drawn_trials(own.play.model, 5, 0, 100))
    assert lost == pytest.approx(columns["geometric:lost motion"], rel=1e-12)
    assert [stage.link for stage in own.compensated] == ["gearbox", "first mesh", "second mesh", "third mesh"]
    assert own.corrections["geometric"].motor == pytest.approx(10.4 * lost.mean(), rel=1e-9)
    assert "tip" not in shown(own)


def shown(*found: Compensation) -> str:
    """The tables as plain text of 80 columns."""
    console = Console(width=80, color_system=None)
    with console.capture() as captured:
        console.print(compensation_report(found))
    return captured.get()


def test_scenes_stand_side_by_side() -> None:
    text = shown(of(ROBOT), of(SHIMMED))
    assert text.count("worst") == text.count("no worst case") == 1  # what is summed is mean + 3 sigma of each stage
    lines = [re.split(r"\s{2,}", line.strip()) for line in text.splitlines()]
    assert ["Δφ_c", "robot_shoulder", "robot_shoulder_shimmed"] in lines
    assert ["paper, 3DCS", "78.49°", "44.97°"] in lines
    assert ["compensated", "2′06.2″", "2′06.2″"] in lines
    assert ["– of the tip [mm]", "0.4668", "0.4668"] in lines
    assert ["at the output's angle", "10.61°", "10.61°"] in lines
    assert ["spur pair: flank of the driver", "right → left", "right → left"] in lines
    spreads = [Spread(of(scene).remaining["geometric"].tips["before"]).moments for scene in (ROBOT, SHIMMED)]
    assert ["mean", *(f"{own.mean:.4f} ±{own.mean_se:.4f}" for own in spreads)] in lines


def test_rows_of_the_picture_share_their_scale_and_hold_every_robot() -> None:
    figure = compensation_figure([of(ROBOT), of(SHIMMED)])
    left, right = figure.axes[::2], figure.axes[1::2]
    assert left[0].get_xlim() == left[1].get_xlim()
    assert right[0].get_ylim() == right[1].get_ylim()
    for axes in left:
        shares = [of_kind(StepPatch, patch).get_data()[0] for patch in axes.patches]
        assert [values.sum() for values in shares] == pytest.approx([100.0] * 6)  # filled and outlined, a state each


@pytest.fixture
def compensate(tol3d: Command) -> Command:
    """Runs `tol3d compensate ARGUMENTS`, as `tol3d` does, blanks in stderr as one."""

    def command(*arguments: str) -> tuple[int, str, str]:
        code, out, err = tol3d("compensate", *arguments)
        return code, out, " ".join(err.split())

    return command


@pytest.mark.slow
def test_the_command_prints_the_tables_and_draws_the_picture(compensate: Command, tmp_path: Path) -> None:
    picture = tmp_path / "compensation.png"
    arguments = ("--trials", "30", "--positions", "4", "--train", "shoulder swing", "--out", str(picture))
    code, out, _ = compensate("robot_shoulder", str(SHIMMED), *arguments)
    assert code == 0
    assert out.count("30 robots, seed 1; each robot's own mean at 4 positions") == 2
    assert picture.read_bytes().startswith(b"\x89PNG")


REFUSED = {
    "no train": (("spur_pair",), "expected a move of kind train, whose motor is corrected, got none"),
    "another train": (("robot_shoulder", "--train", "shoulder swng"), 'did you mean "shoulder swing"'),
    "one robot": (("robot_shoulder", "--trials", "1"), "--trials"),
    "no positions": (("robot_shoulder", "--positions", "0"), "--positions"),
    "another picture": (("robot_shoulder", "--trials", "9", "--out", "c.jpg"), "expected a picture ending in"),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_cannot_be_answered_gets_one_message_and_exit_code_2(compensate: Command, what: str) -> None:
    arguments, words = REFUSED[what]
    code, out, err = compensate(*arguments)
    assert (code, out) == (2, "")
    assert words in err


def test_a_train_whose_output_is_held_has_nothing_to_compensate(tmp_path: Path) -> None:
    path = changed(
        tmp_path,
        (re.compile(r"  (lost motion|tip displacement): \{kind.*\n"), ""),
        (re.compile(r"published:(.|\n)*"), ""),
        ("output: shoulder flange", "output: shoulder flange, held: shoulder flange"),
    )
    with pytest.raises(InputError, match="nothing to compensate: there is no link between 'shoulder flange'"):
        of(path)


# the scene ----------------------------------------------------------------------------------------


def test_the_shimmed_robot_meets_its_expected_numbers(tmp_path: Path) -> None:
    expected = tomllib.loads((SCENES / "robot_shoulder_shimmed.expected.toml").read_text("utf-8"))
    trials = expected.pop("trials")
    run = run_scene(SHIMMED, overrides=Overrides(trials=trials, witness=0), out=tmp_path / "run").summary
    assert run["status"]["ok"] == trials
    assert list(expected) == list(run["measures"])
    for name, own in expected.items():
        found = run["measures"][name]
        curve = found["take"] == "curve"
        samples = found["curve"] if curve else found
        for method, bound in (("analytic", 1e-5), ("geometric", 3e-5)):  # printed digits; where the engine's steps end
            for key, value in (("mean_build", found["mean_build"][method]), *samples[method].items()):
                wanted = own["mean_build"][method] if key == "mean_build" else own[method].get(key)
                if wanted is not None:
                    ends = [value[0], value[-1]] if curve else value
                    assert ends == pytest.approx(wanted, abs=bound), (name, method, key)


def test_the_shimmed_robot_is_the_robot_with_two_shims() -> None:
    robot, shimmed = load_scene(ROBOT), load_scene(SHIMMED)
    assert (robot.parts, robot.moves, robot.measures, robot.study) == (
        shimmed.parts,
        shimmed.moves,
        shimmed.measures,
        shimmed.study,
    )
    pair = load_scene(SCENES / "bevel_pair_shimmed.yaml").distributed
    more = {name: spec for name, spec in shimmed.distributed.items() if name not in robot.tolerances}
    assert dict(robot.tolerances) == {name: shimmed.tolerances[name] for name in robot.tolerances}
    assert [
        (of_kind(ShimSpec, spec).of, of_kind(ShimSpec, spec).side, spec.distribution) for spec in more.values()
    ] == [
        (f"bevel {gear}", of_kind(ShimSpec, pair[f"{gear} shim"]).side, pair[f"{gear} shim"].distribution)
        for gear in ("driver", "driven")
    ]
