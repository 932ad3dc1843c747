"""scenes/helical_gearbox.yaml by hand: backlashes and lost motion from its drawing, trial by trial and in moments.

Helical gears of joints.
"""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from machine.arm_by_hand import AXES, POSES, TOOL, arm_scene, errors, system_of, tool_by_hand
from machine.box_by_hand import number
from machine.helical_box_by_hand import (
    ALPHA,
    APART,
    FIRST,
    GEARS,
    GROOVES,
    IRON,
    PER_FIRST,
    PER_SECOND,
    SAID,
    SECOND,
    SLIDING,
    SPAN,
    STAGES,
    STEEL,
    Stage,
    by_involutes,
    limits,
    lost_motion,
    nominal,
    own_draws,
    to_first_order,
)
from machine.housed import gearbox_of, values
from machine.mean_lean import mean_size
from numpy.typing import NDArray
from places import ROOT, SCENES

from tol3d import Overrides, Run, run_scene
from tol3d.study.system.trials import Trials

Array = NDArray[np.float64]

SCENE = SCENES / "helical_gearbox.yaml"
TEXT = SCENE.read_text("utf-8")
TRIALS = 4_000
ARCMIN = 60 * 180 / math.pi
MIDDLE = ("middle", "far middle")
BORES = {"first stage": ("far input", *MIDDLE), "second stage": (*MIDDLE, "output", "far output")}
"""Toleranced bores of the shafts of each stage."""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """With more trials than the scene asks for."""
    out = tmp_path_factory.mktemp("box") / "run"
    return run_scene(SCENE, overrides=Overrides(trials=TRIALS, seed=5, witness=0), out=out)


def bare(text: str = TEXT) -> str:
    """Without tolerances."""
    before, _, after = text.partition("\ntolerances:\n")
    return f"{before}\nmoves:\n{after.partition(chr(10) + 'moves:' + chr(10))[2]}"


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_a_public_gearbox_is_free_of_backlash_by_its_shifts(method: str, tmp_path: Path) -> None:
    """Sums of profile shifts as printed, 0.462830 and 0.301479: less than 0.005 um, and no overlap is told."""
    assert FIRST.driver.shift + FIRST.driven.shift == pytest.approx(0.462830, abs=1e-9)
    assert SECOND.driver.shift + SECOND.driven.shift == pytest.approx(0.301479, abs=1e-9)
    found = values(gearbox_of(bare(), tmp_path), method, {}, np.array([0.3]))
    for name, stage in STAGES.items():
        assert abs(found[name][0]) < 0.005e-3
        assert found[name][0] == pytest.approx(nominal(stage), abs=1e-9)


@pytest.mark.parametrize("measure", STAGES)
def test_backlashes_follow_from_the_columns_of_the_run(measure: str, run: Run) -> None:
    """The analytic method is the same sum; the exact one is that of involutes but where contact lines end at the mates.

    Lines of both flanks end where mates do that stand j apart: f j/tan(beta_b) of some 0.1 mrad, 0.25 mm and 10 deg.
    """
    columns = run.columns()
    summed, rolled = (1000 * own(columns, STAGES[measure]) for own in (to_first_order, by_involutes))
    np.testing.assert_allclose(columns[f"analytic:{measure}"], summed, rtol=0, atol=1e-6)
    off = columns[f"geometric:{measure}"] - rolled
    assert np.abs(off).max() < 0.3
    assert math.sqrt(np.mean(off**2)) < 0.03
    assert np.ptp(summed) > 50


def test_lost_motion_is_that_of_both_stages_over_the_ratio(run: Run) -> None:
    """j_bn/(r_b cos(beta_b)) of each, the first one times 23/34; c |kappa_in - kappa_out| of shafts that slide."""
    columns = run.columns()
    summed, rolled = (
        ARCMIN * lost_motion(columns, own(columns, FIRST), own(columns, SECOND))
        for own in (to_first_order, by_involutes)
    )
    np.testing.assert_allclose(columns["analytic:lost motion"], summed, rtol=0, atol=1e-9)
    # the arm of two eccentric gears is another by e/a
    np.testing.assert_allclose(columns["geometric:lost motion"], rolled, rtol=0, atol=0.03)


@pytest.mark.parametrize(("measure", "lost"), [("first normal backlash", 2.4583), ("second normal backlash", 4.2680)])
def test_the_closed_form_has_the_exact_mean(measure: str, lost: float, run: Run) -> None:
    """Thinner teeth, warmth, and what leaning shafts lose: both flanks E|f| times the mean end of a contact line."""
    stage = STAGES[measure]
    radii = [number(SAID["tolerances"][f"{own} bore position"]["zone"]["diameter"]) / 2 for own in BORES[stage.name]]
    rings = [limits(f"{far}{shaft} bearing clearance") for shaft in stage.shafts for far in ("", "far ")]
    half = 0.5 / SPAN
    lean = mean_size([(half, radius) for radius in (*radii, *radii)], [(half, *own) for own in rings])
    assert 2 * lean * stage.mean_line_end() == pytest.approx(lost / 1000, abs=1e-7)
    warm = stage.opening * APART * (30 * IRON - 45 * STEEL)
    thin = -math.cos(ALPHA) * sum(sum(gear.thickness) / 2 for gear in (stage.driver, stage.driven))
    form = run.summary["measures"][measure]["analytic_closed_form"]
    expected = 1000 * (nominal(stage) + thin + warm) - lost
    assert form["mean"] == pytest.approx(expected, abs=1e-3 * form["sigma"])


def test_a_bearing_that_lets_its_shaft_slide_has_the_share_of_that(run: Run) -> None:
    """By its play, and by its clearance across: half of it, 198/276 at the gear, is seen by the first stage."""
    columns = run.columns()
    across = np.hypot(*(columns[f"input bearing clearance.{way} [um]"] / 1000 for way in "xy"))
    slid = SLIDING["input"] * 2 * np.sqrt(GROOVES**2 - (GROOVES - across / 2) ** 2)
    radial = PER_FIRST * FIRST.opening * (198 / 276) / 2 * columns["input bearing clearance.x [um]"] / 1000
    share = 100 * ARCMIN**2 * (slid.var() + radial.var()) / columns["analytic:lost motion"].var()
    assert share > 4.0
    rows = {row["name"]: row for row in run.summary["measures"]["lost motion"]["contributors"]}
    assert rows["input bearing clearance"]["analytic_percent"] == pytest.approx(share, abs=0.7)  # leans, and chance


def test_means_and_sigmas_are_those_of_other_draws(run: Run) -> None:
    """100 000 builds of the same drawing, drawn and assembled without the program."""
    count = 100_000
    columns = own_draws(count, 11)
    drawn = {name: 1000 * to_first_order(columns, stage) for name, stage in STAGES.items()}
    drawn["lost motion"] = ARCMIN * lost_motion(columns, *(own / 1000 for own in drawn.values()))
    for name, own in drawn.items():
        summary = run.summary["measures"][name]["analytic"]
        assert summary["mean"] == pytest.approx(own.mean(), abs=4 * own.std() * math.sqrt(1 / TRIALS + 1 / count))
        assert summary["sigma"] == pytest.approx(own.std(), rel=4 * math.sqrt((1 / TRIALS + 1 / count) / 2))
        if name == "lost motion":  # a play by grooves is no share of a clearance
            continue
        form = run.summary["measures"][name]["analytic_closed_form"]
        assert form["mean"] == pytest.approx(own.mean(), abs=4 * own.std() / math.sqrt(count))
        # of a mean position: what the position takes of leaning teeth has no share in it
        assert form["sigma"] == pytest.approx(own.std(), rel=4 / math.sqrt(2 * count) + 2e-3)


@pytest.mark.parametrize("stage", STAGES.values(), ids=lambda own: own.name)
def test_parallel_shafts_and_warm_gears_have_the_involute_s_backlash(stage: Stage, tmp_path: Path) -> None:
    """Both bores of each shaft lie off alike, nothing is eccentric: exact in the transverse section."""
    system, count = gearbox_of(TEXT, tmp_path), 40
    draws = np.random.default_rng(3)
    own: dict[str, Array] = {}
    for shaft in ("middle", "output"):
        off = {way: draws.uniform(-0.015, 0.015, count) for way in "xy"}
        for position in (f"{shaft} bore position", f"far {shaft} bore position"):
            own |= {f"{position}.{end} {way}": off[way] for end in ("start", "end") for way in "xy"}
    for gear in GEARS:
        own[f"{gear.name} tooth thickness"] = draws.uniform(*gear.thickness, count)
    own |= {"housing temperature": draws.uniform(-20, 60, count), "gear temperature": draws.uniform(-20, 70, count)}
    name = next(name for name, each in STAGES.items() if each is stage)
    found = 1000 * values(system, "exact", own, np.full(count, 0.4))[name]
    columns = {key: np.zeros(count) for key in own_draws(1, 0)}
    for key, each in own.items():
        columns |= {f"{key} [K]": each} if "temperature" in key else {f"{key} [um]": 1000 * each}
    np.testing.assert_allclose(found, 1000 * by_involutes(columns, stage), rtol=0, atol=1e-6)


def test_lost_motion_is_the_same_from_either_flank_and_moves_with_the_position(tmp_path: Path) -> None:
    """Both rests of the teeth are those of both senses of the motor; where it stands, eccentric gears decide."""
    systems = [
        gearbox_of(TEXT.replace("output: output}", f"output: output, turns: {sense}}}"), tmp_path)
        for sense in ("counter_clockwise", "clockwise")
    ]
    count, draws = 40, np.random.default_rng(8)
    own = {f"{gear.name} tooth thickness": np.full(count, -0.1) for gear in GEARS}
    for gear in GEARS:
        own |= {f"{gear.name} eccentricity.{way}": draws.normal(0.0, 0.009, count) for way in "xy"}
    for bore in ("far input", "middle", "far middle", "output", "far output"):
        own |= {
            f"{bore} bore position.{end} {way}": draws.uniform(-0.02, 0.02, count)
            for end in ("start", "end")
            for way in "xy"
        }
    flanks = [[mesh.working_flank for mesh in system.gears.model.meshes] for system in systems]
    assert flanks[0] == [-flank for flank in flanks[1]]
    one, other = (values(system, "exact", own, np.full(count, 0.2)) for system in systems)
    for name in ("lost motion at 0 deg", "lost motion at 100 deg"):
        np.testing.assert_allclose(one[name], other[name], rtol=0, atol=1e-9)
    moved = one["lost motion at 0 deg"] - one["lost motion at 100 deg"]
    assert np.std(moved) > 1e-5


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_hands_of_the_middle_shaft_decide_what_its_play_costs(method: str, tmp_path: Path) -> None:
    """70 um turn the output by 7.8" where both gears on it are left-handed, by 53.2" with the second one mirrored."""
    mirrored = TEXT
    for z, hand, other in (("23", "left", "right"), ("34", "right", "left")):
        helix = f"teeth: {z}, module: 6.5 mm, helix_angle: 10 deg, hand: "
        mirrored = mirrored.replace(f"{helix}{hand}", f"{helix}{other}")
    thin = {f"{gear.name} tooth thickness": np.full(2, -0.1) for gear in GEARS}
    play = {"middle axial play": np.array([0.0, 0.07])}
    for text, seconds in ((TEXT, 7.81), (mirrored, 53.19)):
        found = values(gearbox_of(text, tmp_path), method, thin | play, np.full(2, 0.2))["lost motion"]
        assert 60 * ARCMIN * np.diff(found)[0] == pytest.approx(seconds, abs=0.005)


def test_the_page_has_the_numbers_worked_out_here() -> None:
    page = (ROOT / "docs" / "gearboxes.md").read_text("utf-8").partition("## A helical gearbox")[2]
    lines = dict(
        re.findall(r"^\| (first stage|second stage|input|middle|output|together)\b.*\| \**([0-9.″′]+)", page, re.M)
    )
    plays = {"input": 0.168365, "middle": 0.070, "output": 0.065}  # mm; the first one of 2 000 000 own draws
    parts = {"first stage": PER_FIRST * 0.194984, "second stage": PER_SECOND * 0.244779}
    parts |= {shaft: SLIDING[shaft] * play for shaft, play in plays.items()}
    parts["together"] = sum(parts.values())
    assert lines.keys() == parts.keys()
    for name, own in parts.items():
        minutes, _, seconds = lines[name].rstrip("″").rpartition("′")
        assert 60 * int(minutes or 0) + float(seconds) == pytest.approx(60 * ARCMIN * own, abs=0.06)


def test_a_joint_behind_helical_gears_turns_by_half_of_what_they_leave_free(tmp_path: Path) -> None:
    """Stages of 19/57 at 18 deg: j_bn/(r_b cos(beta_b)) of involutes of the transverse section, and matrices."""
    text = arm_scene(bores=False, measures=errors())
    for gear, hand in (("19", "right"), ("57", "left")):
        helical = f"kind: helical_gear, helix_angle: 18 deg, hand: {hand}, teeth: {gear}"
        text = text.replace(f"kind: spur_gear, teeth: {gear}", helical)
    system = system_of(text.replace("centre_distance: 38 mm", "centre_distance: 40 mm"), tmp_path)
    thick = np.array([-0.03, -0.045, -0.06])
    rows = np.zeros((1, 10))
    rows[0, [0, 3, 6]], rows[0, 9] = thick, 1.0
    trials = Trials(rows, {f"stage {k}": np.zeros(1) for k in (1, 2, 3)})
    found = system.method("exact", system.materials("exact")).answers(trials, system.measures)
    beta, alpha = math.radians(18.0), math.radians(20.0)
    alpha_t = math.atan2(math.tan(alpha), math.cos(beta))
    base = [z / (2 * math.cos(beta)) * math.cos(alpha_t) for z in (19, 57)]
    working = math.acos(sum(base) / 40.0)
    opened = 2 * sum(base) * (math.tan(working) - working - math.tan(alpha_t) + alpha_t)
    cosine = math.cos(math.asin(math.sin(beta) * math.cos(alpha)))
    play = (opened - thick * math.cos(alpha) / cosine) / base[1]
    for pose, inputs in POSES.items():
        turns = np.radians(inputs) + np.array([1.0, -1.0, -1.0]) / 2 * play  # the first one's flank is drawn
        by_hand = tool_by_hand(AXES, TOOL, turns.tolist()) - tool_by_hand(AXES, TOOL, np.radians(inputs).tolist())
        assert [found.values[f"{way} {pose}"][0, 0] for way in "xyz"] == pytest.approx(by_hand, abs=1e-8)
