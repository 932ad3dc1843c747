"""Reading of measures: by default as the pair is; one tooth where it is in action, with a message where it is not."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from fixtures import Command
from gear_trials import drawn_trials, gear_columns, simulated
from hypothesis import given, settings
from hypothesis import strategies as st
from of_kind import of_kind
from oracles.thinned_pairs import ThinnedPair, random_pair
from places import SCENES
from scene_texts import scene_of

from tol3d import Overrides, load_scene, run_scene
from tol3d.apps.adjustment.compensation import compensation
from tol3d.apps.adjustment.shim import ShimQuestion, shim_plan
from tol3d.cad.solids import measuring_strips
from tol3d.errors import SceneError
from tol3d.gearing.engines import OK, STATUS_TEXT
from tol3d.gearing.engines.fcl import FclEngine
from tol3d.gearing.engines.gaps import exact_engine
from tol3d.gearing.model import Backlash, Model, Reading, model_from_scene
from tol3d.gears import LEFT, RIGHT, SpurPair, one_tooth_acts, one_tooth_share
from tol3d.gears.pair import Owner
from tol3d.study.results.task import contacts_of
from tol3d.study.system.trials import Trials
from tol3d.units import ARCMIN

Teeth = Literal["all", "driver", "driven"]

ALPHA = math.radians(20.0)
ROUNDING = 1e-8  # mm; of the exact engine in the middle of the face; seen: 5e-13 at module 3.5
PLAY = "  play: {kind: normal_backlash, of: pair}"
DEFAULTS = PLAY + "\n  turn: {kind: angular_backlash, of: pair}"
OWNERS: tuple[Owner, ...] = ("driver", "driven")


def unequal(teeth: tuple[int, int], shift: float, thinner: float, degrees: float = 90.0) -> ThinnedPair:
    return ThinnedPair(teeth, (shift, -shift), (9.0, 9.0), (thinner, thinner), 3.5, ALPHA, math.radians(degrees))


UNEQUAL = {
    "12 to 20": unequal((12, 20), 0.4, 0.0425),
    "20 to 40": unequal((20, 40), 0.4, 0.0425),
    "20 to 40 at 80 deg": unequal((20, 40), 0.3, 0.0, 80.0),
    "17 to 43 at 80 deg": unequal((17, 43), 0.3, 0.0, 80.0),
}
"""Pairs on which one driven tooth read up to 202.5, 106.1, 8.2 and 6.5 um."""


def at_positions(model: Model, count: int, seed: int = 0) -> Trials:
    """Trials at the ends and in the middle of a pitch of the driver, and evenly over one somewhere in its turns."""
    pitch = model.meshes[0].pair.pinion.angular_pitch
    even = (np.random.default_rng(seed).integers(0, 1000) + np.arange(count) / count) * pitch
    angles = np.concatenate([[0.0, pitch / 2, pitch], even])
    block = drawn_trials(model, 1, 0, len(angles))
    return Trials(block.deviations, {"pair": angles})


def read_as(model: Model, teeth: Teeth) -> Model:
    """The model, its measures read at other teeth, whether or not these are in action."""
    return replace(
        model,
        measures=tuple(
            replace(m, kind=replace(kind, reading=replace(kind.reading, teeth=teeth)))
            for m in model.measures
            for kind in (of_kind(Backlash, m.kind),)
        ),
    )


def values_of(model: Model, block: Trials) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Normal backlash [mm] and turn [rad], in the order of DEFAULTS, and the status."""
    columns = gear_columns(model, exact_engine(model), block)
    return columns["geometric:play"] / 1000, columns["geometric:turn"] / ARCMIN, columns["status"]


# by default ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", UNEQUAL)
def test_by_default_thinner_teeth_leave_the_closed_form_at_every_position(name: str) -> None:
    pair = UNEQUAL[name]
    model = pair.model(DEFAULTS)
    normal, turn, status = values_of(model, at_positions(model, 240))
    assert set(status) == {STATUS_TEXT[OK]}
    assert np.abs(normal - pair.normal_backlash).max() <= ROUNDING
    assert np.abs(turn - pair.driven_turn).max() * model.meshes[0].pair.wheel.base_radius <= ROUNDING


def test_the_closed_form_of_12_to_20_teeth_is_known() -> None:
    assert UNEQUAL["12 to 20"].normal_backlash == pytest.approx(79.874e-3, abs=5e-7)


def hold_the_defaults(pair: ThinnedPair, positions: int, seed: int) -> None:
    model = pair.model(DEFAULTS)
    normal, turn, status = values_of(model, at_positions(model, positions, seed))
    assert set(status) == {STATUS_TEXT[OK]}
    assert np.abs(normal - pair.normal_backlash).max() <= ROUNDING
    assert np.abs(turn - pair.driven_turn).max() * model.meshes[0].pair.wheel.base_radius <= ROUNDING


@pytest.mark.slow
@given(kind=st.sampled_from(["bevel", "spur"]), seed=st.integers(0, 2**32))
@settings(max_examples=60)
def test_defaults_hold_on_random_pairs(kind: str, seed: int) -> None:
    hold_the_defaults(random_pair(kind, seed), 48, seed)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["bevel", "spur"])
def test_defaults_hold_on_many_random_pairs(kind: str) -> None:
    for seed in range(500):
        hold_the_defaults(random_pair(kind, seed), 400, seed)


# one tooth ----------------------------------------------------------------------------------------


def within_action(model: Model, angles: np.ndarray, owner: Owner) -> np.ndarray:
    """By how many pitches both flanks of one tooth are within the nominal path of contact, (rows,).

    The driver's tooth next to the line of centres is up to half a pitch off it; a driven one stands in a space whose
    walls are up to a pitch off.
    """
    pair = model.meshes[0].pair
    lowest, highest = (azimuth / pair.pinion.angular_pitch for azimuth in pair.active_azimuths)
    place = angles / pair.pinion.angular_pitch
    right = place - np.round(place) if owner == "driver" else place - np.floor(place)
    left = -right if owner == "driver" else 1 - right
    return np.min([right - lowest, highest - right, left - lowest, highest - left], axis=0)


def hold_one_tooth(pair: ThinnedPair, owner: Owner, positions: int, seed: int) -> None:
    """The value of one tooth is the closed form, given where its flanks are in action and only there."""
    model = read_as(pair.model(DEFAULTS), owner)
    block = at_positions(model, positions, seed)
    normal, turn, status = values_of(model, block)
    columns = gear_columns(model, exact_engine(model), block)
    told, turned = (columns[f"status:{name}"] == STATUS_TEXT[OK] for name in ("play", "turn"))
    assert set(status[~told | ~turned]) <= {"out of range"}
    assert np.array_equal(np.isnan(normal), ~told)
    assert np.array_equal(np.isnan(turn), ~turned)
    assert np.abs(normal[told] - pair.normal_backlash).max(initial=0.0) <= ROUNDING
    arm = model.meshes[0].pair.wheel.base_radius
    assert np.abs(turn[turned] - pair.driven_turn).max(initial=0.0) * arm <= ROUNDING
    within = within_action(model, block.positions["pair"], owner)
    # flanks lie at most the backlash from where those without play touch, along the path of contact
    aside = pair.normal_backlash / model.meshes[0].pair.pinion.base_pitch + ROUNDING
    always, never = within > aside, within < -aside
    assert told[always].all()
    assert turned[always].all()
    assert not told[never].any()
    assert not turned[never].any()


@pytest.mark.slow
@given(kind=st.sampled_from(["bevel", "spur"]), seed=st.integers(0, 2**32), owner=st.sampled_from(OWNERS))
@settings(max_examples=60)
def test_one_tooth_is_told_where_it_is_in_action_and_then_right(kind: str, seed: int, owner: Owner) -> None:
    hold_one_tooth(random_pair(kind, seed), owner, 96, seed)


@pytest.mark.slow
@pytest.mark.parametrize("owner", OWNERS)
@pytest.mark.parametrize("kind", ["bevel", "spur"])
def test_one_tooth_of_many_random_pairs(kind: str, owner: Owner) -> None:
    for seed in range(500):
        hold_one_tooth(random_pair(kind, seed), owner, 400, seed)


@given(kind=st.sampled_from(["bevel", "spur"]), seed=st.integers(0, 2**32), owner=st.sampled_from(OWNERS))
@settings(max_examples=40)
def test_the_share_in_action_is_that_of_even_positions(kind: str, seed: int, owner: Owner) -> None:
    pair = random_pair(kind, seed).model(PLAY).meshes[0].pair
    count = 2000
    even = (np.arange(count) + 0.5) / count * pair.pinion.angular_pitch
    # an interval of positions, whose two ends each fall on one of the steps
    assert one_tooth_share(pair, owner) == pytest.approx(one_tooth_acts(pair, even, owner).mean(), abs=2 / count)


def test_the_active_flank_of_a_spur_tooth_ends_on_the_tip_circles() -> None:
    """On the line of action, s from the pitch point towards the driven's base, radii are those of Pythagoras.

    The driver's tooth at the azimuth psi touches where its involute, that passes the pitch point at the azimuth of half
    its working thickness, has gone r_b1 (psi_0 - sigma psi) along that line.
    """
    pair = (
        ThinnedPair((14, 33), (0.4, -0.1), (20.0, 20.0), (0.0, 0.0), 2.0, ALPHA, None, 47.6).model(PLAY).meshes[0].pair
    )
    assert isinstance(pair, SpurPair)
    alpha, radii = pair.working_pressure_angle, pair.working_radii
    working_thickness = (
        2
        * radii[0]
        * (
            pair.pinion.tooth_thickness / (2 * pair.pinion.reference_radius)
            + (math.tan(ALPHA) - ALPHA)
            - (math.tan(alpha) - alpha)
        )
    )
    angles = np.linspace(-0.7, 0.9, 801)
    for owner in OWNERS:
        acts = np.ones(len(angles), dtype=bool)
        for sigma in (RIGHT, LEFT):
            pitch = pair.pinion.angular_pitch
            if owner == "driver":
                psi = sigma * ((angles + pitch / 2) % pitch - pitch / 2)
            else:  # the walls of the space in which the tooth stands that is nearest to the line of centres
                psi = angles % pitch if sigma == RIGHT else pitch - angles % pitch
            along = pair.pinion.base_radius * (working_thickness / (2 * radii[0]) - psi)
            sides = [radius * math.sin(alpha) + sense * along for radius, sense in zip(radii, (1, -1), strict=True)]
            for gear, side in zip((pair.pinion, pair.wheel), sides, strict=True):
                acts &= np.hypot(gear.base_radius, side) <= gear.tip_radius
        assert np.array_equal(one_tooth_acts(pair, angles, owner), acts)
        assert 0 < acts.sum() < len(acts) or owner == "driver"


@pytest.mark.parametrize(
    ("measure", "where"),
    [
        ("kind: normal_backlash, of: pair, tooth: driven", "67.2 % of the positions only"),
        ("kind: angular_backlash, of: pair, tooth: driven, over: {at: 0 deg}", "0 of 1 positions only"),
        (
            "kind: normal_backlash, of: pair, tooth: driven, over: turn, take: curve, positions: 24",
            "12 of 25 positions only",
        ),
        (
            "kind: normal_backlash, of: pair, tooth: driven, over: turn, take: max, positions: 36",
            "24 of 37 positions only",
        ),
        ("kind: lost_motion, of: train, tooth: driven", "67.2 % of the positions only"),
    ],
)
def test_one_tooth_that_is_out_of_action_is_refused_with_how_often(measure: str, where: str) -> None:
    with pytest.raises(SceneError) as refused:
        UNEQUAL["12 to 20"].model(f"  play: {{{measure}}}")
    text = str(refused.value)
    tooth = "both flanks of the tooth of 'driven' next to the line of centres of 'pair' are in action at"
    assert f"measures.play.tooth: expected all, got driven: {tooth} {where}" in text


@pytest.mark.parametrize(
    "measure",
    [
        "kind: normal_backlash, of: pair, tooth: driver",
        "kind: normal_backlash, of: pair, tooth: driven, over: {at: 15 deg}",
        "kind: lost_motion, of: train, tooth: driver",
    ],
)
def test_one_tooth_that_is_in_action_is_read(measure: str) -> None:
    assert UNEQUAL["12 to 20"].model(f"  play: {{{measure}}}").measures


def test_check_says_so_too(tol3d: Command, tmp_path: Path) -> None:
    path = tmp_path / "pair.yaml"
    path.write_text(UNEQUAL["12 to 20"].text("  play: {kind: normal_backlash, of: pair, tooth: driven}"), "utf-8")
    for command in (("check",), ("run", "--engine", "analytic")):
        code, out, err = tol3d(*command, str(path))
        assert (code, out) == (2, "")
        assert f"{path}:" in err
        assert "67.2 % of the positions only" in " ".join(err.split())


def barely_in_action() -> ThinnedPair:
    """20 to 40 teeth, shifted as far as the driven tooth stays in action at all positions."""
    low, high = 0.0, 0.4
    for _ in range(30):
        middle = (low + high) / 2
        share = one_tooth_share(unequal((20, 40), middle, 0.05).model(PLAY).meshes[0].pair, "driven")
        low, high = (middle, high) if share == 1.0 else (low, middle)
    return unequal((20, 40), low, 0.05)


def test_builds_that_take_the_tooth_out_of_action_are_counted_and_tell_nothing(tmp_path: Path) -> None:
    """Thinner teeth lie elsewhere, and so end their action elsewhere: by up to the backlash, 1 % of a pitch."""
    text = barely_in_action().text("  play: {kind: normal_backlash, of: pair, tooth: driven, lower_limit: 60 um}")
    text = text.replace("{kind: constant, value: -0.05 mm}", "{kind: uniform, lower: -0.06 mm, upper: -0.04 mm}")
    path = tmp_path / "pair.yaml"
    path.write_text(text, encoding="utf-8")
    run = run_scene(path, overrides=Overrides(trials=20_000), out=tmp_path / "run")
    out = run.summary["status"]["out of range"]
    assert 0 < out <= 0.02 * run.trials
    assert run.summary["status"]["ok"] == run.trials - out
    model = model_from_scene(load_scene(path))
    block = drawn_trials(model, run.summary["seed"], 0, run.trials)
    columns = gear_columns(model, exact_engine(model), block)
    told = columns["status"] == "ok"
    assert np.count_nonzero(~told) == out
    assert np.isnan(columns["geometric:play"][~told]).all()
    middle = barely_in_action().outer - 4.5
    expected = middle * np.sin(math.cos(ALPHA) * -block.deviations.sum(axis=1) / middle)
    assert np.abs(columns["geometric:play"] / 1000 - expected)[told].max() <= ROUNDING


@pytest.mark.parametrize("teeth", ["all", "driven"])
def test_fcl_reads_as_the_exact_engine_does(teeth: Teeth) -> None:
    """12 to 20 teeth: the same values to the chords, and no value of a tooth out of action.

    FCL's nearest points are its vertices, up to half a step of a flank off: one in 60 of its length, 0.02 pitches.
    """
    pair = UNEQUAL["12 to 20"]
    model = read_as(pair.model(DEFAULTS), teeth)
    strips = {part.name: measuring_strips(part.gear, 60) for part in model.gears}
    block = at_positions(model, 24)
    engine = FclEngine(model, strips)
    columns = gear_columns(model, engine, block)
    told = columns["status"] == STATUS_TEXT[OK]
    if teeth == "all":
        assert told.all()
    else:
        within = within_action(model, block.positions["pair"], teeth)
        assert told[within > 0.03].all()
        assert not told[within < -0.03].any()
        assert 0 < told.sum() < len(told)
    apart = columns["geometric:play"][told] / 1000 - pair.normal_backlash
    assert np.abs(apart).max() <= 4 * engine.chord_error + 5e-5
    turned = (columns["geometric:turn"] / ARCMIN - pair.driven_turn) * model.meshes[0].pair.wheel.base_radius
    assert np.nanmax(np.abs(turned[told])) <= 4 * engine.chord_error + 5e-5


# trains and what is asked of several studies ------------------------------------------------------


@pytest.mark.parametrize("tooth", ["all", *OWNERS, None])
@pytest.mark.parametrize("read_at", ["face", "face_contact", "mean_section", None])
def test_a_train_reads_its_meshes_as_they_are_read_alone(
    read_at: str | None, tooth: str | None, tmp_path: Path
) -> None:
    said = {"read_at": read_at, "tooth": tooth}
    how = "".join(f", {field}: {word}" for field, word in said.items() if word)
    model = robot_model(
        tmp_path,
        f"  spur: {{kind: angular_backlash, of: spur pair{how}}}",
        f"  bevel: {{kind: angular_backlash, of: bevel pair{how}}}",
        f"  lost: {{kind: lost_motion, of: shoulder swing{how}}}",
        f"  tip: {{kind: tip_displacement, of: shoulder swing, arm: arm, point: tip{how}}}",
        "  error: {kind: tip_error, of: shoulder swing, arm: arm, point: tip, start: -60 deg, end: 60 deg, positions: 3"
        f"{how}}}",
    )
    assert contacts_of(simulated(model)) == 2 + 2 * 3  # the train's meshes are not read another time
    columns = gear_columns(model, exact_engine(model), drawn_trials(model, 1, 0, 50))
    reducer = 28 / 110  # a minute at the spur pinion
    assert (columns["status"] == "ok").all()
    lost = columns["geometric:spur"] + columns["geometric:bevel"] + reducer
    assert columns["geometric:lost"] == pytest.approx(lost, rel=1e-12)
    lever = math.hypot(637, 420)
    assert columns["geometric:tip"] == pytest.approx(2 * lever * np.sin(lost / ARCMIN / 2), rel=1e-12)
    readings = [{backlash.reading for _, backlash in measure.kind.backlashes} for measure in model.measures]
    assert readings[2] == readings[3] == readings[4] == readings[0] | readings[1]


def robot_model(folder: Path, *measures: str) -> Model:
    """The shoulder with other measures."""
    text = (SCENES / "robot_shoulder.yaml").read_text(encoding="utf-8")
    return model_from_scene(
        scene_of(text[: text.index("\nmeasures:")] + "\nmeasures:\n" + "\n".join(measures) + "\n", folder)
    )


def test_how_a_train_is_read_is_said(tmp_path: Path) -> None:
    overrides = Overrides(trials=50, witness=0)
    run = run_scene(SCENES / "robot_shoulder.yaml", overrides=overrides, out=tmp_path / "run")
    measure = run.summary["measures"]["lost motion"]
    assert measure["readings"] == {
        "spur pair": {"contact": "face", "gap": "face", "teeth": "driven"},
        "bevel pair": {"contact": "section", "gap": "section", "teeth": "driven"},
    }
    words = "; spur pair: one driven tooth; bevel pair: mean section, one driven tooth"
    assert run.found.measures["lost motion"].words.endswith(f"each trial{words}")


def test_shims_see_no_backlash_that_is_not_there() -> None:
    pair = UNEQUAL["20 to 40"]
    plan = shim_plan(pair.scene(PLAY), ShimQuestion(0.040))
    assert plan.before.minimum == pytest.approx(pair.normal_backlash, abs=ROUNDING)


def test_a_correction_reads_the_train_as_its_measure_does(tmp_path: Path) -> None:
    for tooth in ("driven", "all"):
        measures = f"  lost: {{kind: lost_motion, of: train, read_at: face, tooth: {tooth}}}"
        found = compensation(unequal((30, 31), 0.0, 0.04).scene(measures), overrides=Overrides(trials=50))
        read = [backlash.reading for _, backlash in found.play.measure.kind.backlashes]
        assert read == [Reading("face", "face", tooth)]


def test_a_correction_at_random_positions_is_refused_where_the_tooth_is_out_of_action() -> None:
    scene = UNEQUAL["12 to 20"].scene("  lost: {kind: lost_motion, of: train, tooth: driven, over: {at: 15 deg}}")
    with pytest.raises(SceneError, match=r"moves\.train: expected all, got driven: .* 67\.2 % of the positions only"):
        compensation(scene, overrides=Overrides(trials=50))
