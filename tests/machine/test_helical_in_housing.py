"""Helical gears on shafts in bores: as on bearings of their own, as surfaces searched by brute force, and by hand."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from machine.housed import SHAFTS, gearbox_of, housed_scene, system_of, values
from numpy.typing import NDArray
from oracles.screw_flanks import Placed, ScrewGear, lag
from scene_texts import written
from scipy.spatial.transform import Rotation

from tol3d import Overrides, run_scene
from tol3d.gears import SpurPair

Array = NDArray[np.float64]

METHODS = ("exact", "analytic")
TURN = math.radians(37.0)  # of the line of centres from the x of the housing
PINION_AT, FIRST_BORE, LAST_BORE = -26.0, -30.0, 30.0  # mm, in the housing
ALPHA, BETA = math.radians(20.0), math.radians(30.0)
TEETH, SHIFTS, FACES, THINNER = (23, 67), (0.55, 0.5441135839), (16.0, 11.0), (0.06, 0.08)
THIN = "".join(
    f"\n  {gear} thickness: {{kind: tooth_thickness, of: {gear}, distribution: {{kind: constant, value: -{off} mm}}}}"
    for gear, off in zip(("pinion", "wheel"), THINNER, strict=True)
)
BORES = ("bore 1", "bore 1b", "bore 2", "bore 2b")
LAW = "distribution: {kind: normal, lower: -30 um, upper: 30 um}"
ASIDE = "".join(
    f"\n  {bore} {way}: {{kind: plus_minus, of: housing.{bore}, along: [{along}], {LAW}}}"
    for bore in BORES
    for way, along in (("x", "1, 0, 0"), ("y", "0, 1, 0"))
)
READ = """
  backlash: {kind: normal_backlash, of: stage}
  free turn: {kind: angular_backlash, of: stage, over: {at: 50 deg}}"""


def gears(kind: str = "kind: helical_gear, helix_angle: 30 deg", hands: tuple[str, ...] = ("right", "left")) -> str:
    each = zip(("pinion", "wheel"), TEETH, SHIFTS, FACES, hands or ("", ""), strict=True)
    return "".join(
        f"\n  {gear}: {{{kind}{f', hand: {hand}' if hand else ''}, teeth: {z}, module: 1 mm, profile_shift: {x}, "
        f"face_width: {face} mm, expansion: 11.5e-6 1/K}}"
        for gear, z, x, face, hand in each
    )


def bores(apart: float) -> str:
    """Four bores as those of machine/housed.py, the axes so far apart."""
    x, y = apart * math.cos(TURN), apart * math.sin(TURN)
    places = {"bore 1": (0.0, 0.0, -30), "bore 1b": (0.0, 0.0, 30), "bore 2": (x, y, -30), "bore 2b": (x, y, 30)}
    return "".join(
        f"\n      {name}: {{kind: cylinder, at: [{at[0]!r} mm, {at[1]!r} mm, {at[2]} mm], axis: [0, 0, 1], "
        "length: 9 mm, diameter: 9 mm, hole: true}"
        for name, at in places.items()
    )


def housed(tolerances: str, parts: str = SHAFTS + gears(), apart: float = 53.0) -> str:
    return housed_scene(tolerances=tolerances, features=bores(apart), parts=parts, measures=READ)


def aside(seed: int, count: int, size: float = 0.02) -> dict[str, Array]:
    """Displacements of the bores (count,) [mm], by contributor."""
    rng = np.random.default_rng(seed)
    return {f"{bore} {way}": rng.uniform(-size, size, count) for bore in BORES for way in "xy"}


def thin(count: int) -> dict[str, Array]:
    return {f"{gear} thickness": np.full(count, -off) for gear, off in zip(("pinion", "wheel"), THINNER, strict=True)}


@pytest.mark.parametrize("method", METHODS)
def test_helical_gears_in_bores_read_as_on_bearings_of_their_own(method: str, tmp_path: Path) -> None:
    """A mesh alone, a bearing with twice the clearance where each bore is; the frame of the wheel looks along x."""
    places = {"bore 1": ("first shaft", 0.0), "bore 1b": ("first shaft", 60.0)}
    places |= {"bore 2": ("last shaft", 2.0), "bore 2b": ("last shaft", 62.0)}
    bearings = "".join(
        f"\n  at {bore}: {{kind: bearing, shaft: {shaft}, at: {z} mm}}" for bore, (shaft, z) in places.items()
    )
    its = "".join(
        f"\n  {bore} {way}: {{kind: bearing_clearance, of: at {bore}, direction: {{at: {angle} deg}}, {LAW}}}"
        for bore in BORES
        for way, angle in (("x", 0 if "1" in bore else -37), ("y", 90 if "1" in bore else 53))
    )
    alone = f"""scene: plain
parts:{SHAFTS}{gears()}{bearings}
tolerances:{its}{THIN}
moves:
  stage: {{kind: mesh, driver: pinion, driven: wheel, centre_distance: 53 mm, azimuth: 37 deg}}
measures:{READ}
"""
    count, moved = 60, aside(1, 60)
    turns = np.random.default_rng(2).random(count)
    found = values(gearbox_of(housed(ASIDE + THIN), tmp_path), method, moved | thin(count), turns)
    twice = {name: 2 * own for name, own in moved.items()}
    expected = values(system_of(alone, tmp_path), method, twice | thin(count), turns)
    for name in ("backlash", "free turn"):
        assert np.ptp(expected[name]) > 1e-4
        np.testing.assert_allclose(found[name], expected[name], rtol=0, atol=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_shafts_cross_their_clearances_in_bores_as_without_a_housing(method: str, tmp_path: Path) -> None:
    """Both bearings of the wheel's shaft, with bores that stand where they should."""
    bearings = "".join(
        f"\n  {name}: {{kind: bearing, shaft: last shaft, at: {at} mm}}" for name, at in (("near", 2), ("far", 62))
    )
    play = "direction: reversing, distribution: {kind: uniform, lower: 0 um, upper: 40 um}"
    plays = "".join(
        f"\n  {name} play: {{kind: bearing_clearance, of: {name}, mesh: stage, {play}}}" for name in ("near", "far")
    )
    alone = f"""scene: plain
parts:{SHAFTS}{gears()}{bearings}
tolerances:{plays}{THIN}
moves:
  stage: {{kind: mesh, driver: pinion, driven: wheel, centre_distance: 53 mm, azimuth: 37 deg}}
measures:{READ}
"""
    rng = np.random.default_rng(7)
    drawn = {f"{name} play": rng.uniform(0.0, 0.04, 20) for name in ("near", "far")} | thin(20)
    turns = rng.random(20)
    in_bores = gearbox_of(housed(plays + THIN, SHAFTS + gears() + bearings), tmp_path)
    found, expected = (values(own, method, drawn, turns) for own in (in_bores, system_of(alone, tmp_path)))
    assert np.ptp(expected["free turn"]) > 4 * np.ptp(expected["backlash"]) / pair_of(in_bores).wheel.base_radius
    for name in ("backlash", "free turn"):
        np.testing.assert_allclose(found[name], expected[name], rtol=0, atol=1e-9)


@pytest.mark.parametrize("hands", [("right", "left"), ("left", "right")])
@pytest.mark.parametrize("backward", ["", "4 mm", "6 mm"])
def test_methods_differ_by_what_is_of_second_order(hands: tuple[str, ...], backward: str, tmp_path: Path) -> None:
    """Axes that lean by up to 0.9 mrad: lines end where mates do that stand the backlash apart, f j/tan(beta_b).

    A gear that faces backward, the pinion at 4 mm or the wheel at 6 mm, keeps its hand.
    """
    shafts = SHAFTS.replace(f"at: {backward}", f"at: {backward}, facing: backward") if backward else SHAFTS
    system, count = gearbox_of(housed(ASIDE + THIN, shafts + gears(hands=hands)), tmp_path), 300
    turns = np.random.default_rng(3).random(count)
    exact, linear = (values(system, own, aside(4, count) | thin(count), turns)["backlash"] for own in METHODS)
    assert np.std(exact) > 4e-3
    assert np.sqrt(np.mean((exact - linear) ** 2)) < 0.05e-3
    assert np.abs(exact - linear).max() < 0.25e-3


def placed(screw: ScrewGear, ends: tuple[Array, Array], at: Array) -> Placed:
    """A gear on the straight line through the middles of its bores, where that passes the height of its face."""
    low, high = ends
    slope = (high - low) / (LAST_BORE - FIRST_BORE)
    off = low + slope * (PINION_AT - FIRST_BORE)
    along = np.array([*slope, 1.0]) / math.hypot(*slope, 1.0)
    axis = np.cross([0.0, 0.0, 1.0], along)
    size = float(np.linalg.norm(axis))
    turned = Rotation.from_rotvec(axis / size * math.asin(size) if size else np.zeros(3)).as_matrix()
    return Placed(screw, turned, at + np.array([*off, 0.0]))


def rest(driver: Placed, driven: Placed, turn: float, side: int) -> float:
    """Turn of the driven gear [rad] at which the first pair of a side touches."""
    found = math.pi + math.pi / TEETH[1] - TEETH[0] / TEETH[1] * turn
    first = round(-turn * TEETH[0] / (2 * math.pi))
    for _ in range(3):  # no gear is eccentric: the lag falls by a base arm per turn
        pairs = [(tooth, -tooth if side == 1 else -tooth - 1) for tooth in range(first - 4, first + 5)]
        found -= side * min(lag(driver, driven, (turn, found), side, own) for own in pairs) / driven.gear.base
    return found


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_the_free_turn_in_a_housing_is_that_of_two_surfaces_searched(seed: int, tmp_path: Path) -> None:
    """Screw flanks by the polar equation of the involute, on lines drawn by hand through the bores of the trial."""
    hands = ("right", "left") if seed % 2 else ("left", "right")
    system = gearbox_of(housed(ASIDE + THIN, SHAFTS + gears(hands=hands)), tmp_path)
    moved = aside(20 + seed, 1)
    found = float(values(system, "exact", moved | thin(1), np.zeros(1))["free turn"][0])
    hand = 1 if hands[0] == "right" else -1
    screws = [
        ScrewGear(z, 1.0, ALPHA, BETA, own, face, x, off)
        for z, x, face, off, own in zip(TEETH, SHIFTS, FACES, THINNER, (hand, -hand), strict=True)
    ]
    into = np.array([[math.cos(TURN), math.sin(TURN)], [-math.sin(TURN), math.cos(TURN)]])
    at = {bore: into @ [float(moved[f"{bore} {way}"][0]) for way in "xy"] for bore in BORES}
    driver = placed(screws[0], (at["bore 1"], at["bore 1b"]), np.zeros(3))
    driven = placed(screws[1], (at["bore 2"], at["bore 2b"]), np.array([53.0, 0.0, 0.0]))
    right, left = (rest(driver, driven, math.radians(50.0), side) for side in (1, -1))
    assert screws[1].base * found == pytest.approx(screws[1].base * abs(left - right), abs=2e-6)


def test_without_a_helix_they_are_spur_gears(tmp_path: Path) -> None:
    """No helix at all to the bit; one of 1e-9 rad to what two ways to the least gap of leaning teeth leave."""
    count, moved = 60, aside(5, 60)
    turns = np.random.default_rng(6).random(count)
    spur = gearbox_of(housed(ASIDE + THIN, SHAFTS + gears("kind: spur_gear", ()), apart=46.1), tmp_path)
    for angle, bound in (("0 deg", 0.0), ("1e-9 rad", 1e-9)):
        kind = f"kind: helical_gear, helix_angle: {angle}"
        system = gearbox_of(housed(ASIDE + THIN, SHAFTS + gears(kind), apart=46.1), tmp_path)
        for method in METHODS:
            found, expected = (values(own, method, moved | thin(count), turns)["backlash"] for own in (system, spur))
            np.testing.assert_allclose(found, expected, rtol=0, atol=bound)


def pair_of(system: Any) -> SpurPair:
    pair = system.gears.model.meshes[0].pair
    assert isinstance(pair, SpurPair)
    return pair


@pytest.mark.parametrize("method", METHODS)
def test_a_warm_housing_opens_by_the_transverse_working_angle(method: str, tmp_path: Path) -> None:
    """2 (r_b1 + r_b2) cos(beta_b) (inv alpha_wt' - inv alpha_wt) of a' = a (1 + 23e-6 T), exact of parallel axes."""
    law = "distribution: {kind: uniform, lower: -50 K, upper: 80 K}"
    system = gearbox_of(housed(f"\n  warm: {{kind: temperature, of: housing, {law}}}" + THIN), tmp_path)
    kelvin = np.array([-40.0, 0.0, 70.0])
    found = values(system, method, {"warm": kelvin} | thin(3), np.array([0.1, 0.1, 0.1]))["backlash"]
    alpha_t = math.atan2(math.tan(ALPHA), math.cos(BETA))
    bases = sum(TEETH) / (2 * math.cos(BETA)) * math.cos(alpha_t)
    alpha = np.arccos(bases / (53.0 * (1 + 23e-6 * kelvin)))
    opened = 2 * bases * math.cos(math.asin(math.sin(BETA) * math.cos(ALPHA))) * (np.tan(alpha) - alpha)
    assert np.ptp(opened) > 0.05
    within = 1e-9 if method == "exact" else 0.7e-3  # (a T)² / (a tan(alpha)) of the analytic one
    np.testing.assert_allclose(found - found[1], opened - opened[1], rtol=0, atol=within)


def loss_per_lean() -> float:
    """Mean loss of a flank side [mm] per lean, to either sense alike: along contact lines, less half a pitch's share.

    (b/2) cos(beta_b) + (u2 - u1)/2 sin(beta_b) - p_bn/2 sin(beta_b) cos(beta_b).
    """
    alpha_t = math.atan2(math.tan(ALPHA), math.cos(BETA))
    sine = math.sin(BETA) * math.cos(ALPHA)
    cosine = math.cos(math.asin(sine))
    bases = [z / (2 * math.cos(BETA)) * math.cos(alpha_t) for z in TEETH]
    tips = [z / (2 * math.cos(BETA)) + 1.0 + x for z, x in zip(TEETH, SHIFTS, strict=True)]
    at_pitch = math.tan(math.acos(sum(bases) / 53.0))
    path = sum(base * (math.sqrt((tip / base) ** 2 - 1) - at_pitch) for base, tip in zip(bases, tips, strict=True))
    pitch = math.pi * math.cos(ALPHA)
    return min(FACES) / 2 * cosine + path / 2 * sine - pitch / 2 * sine * cosine


def test_the_closed_form_of_leaning_helical_gears_is_worked_out_by_hand(tmp_path: Path) -> None:
    """Three of four bores anywhere in 40 um, both ends by themselves: a slope is the sum of six discs over 2 x 60 mm.

    Seen along a line each disc has the variance r²/4 and the excess kurtosis -1, so that E|f| is that of a normal law
    times 1 + 1/(6 x 24).
    """
    zone = "zone: {diameter: 40 um}, law: {kind: uniform}"
    positions = "".join(f"\n  {bore}: {{kind: position, of: housing.{bore}, {zone}}}" for bore in BORES[1:])
    path, count = written(housed(positions + THIN), tmp_path), 40_000
    run = run_scene(path, overrides=Overrides(trials=count, engine="analytic", seed=2), out=tmp_path / "run")
    own = run.summary["measures"]["backlash"]
    form, sample = own["analytic_closed_form"], own["analytic"]
    lean = math.sqrt(6 * 20.0**2 / 4) / 120.0 * math.sqrt(2 / math.pi) * (1 + 1 / (6 * 24))  # mrad, um per mm
    straight = sum(THINNER) * math.cos(ALPHA) * 1e3
    assert form["mean"] == pytest.approx(straight - 2 * lean * loss_per_lean(), abs=1e-3 * form["sigma"])
    assert form["mean"] == pytest.approx(sample["mean"], abs=4 * sample["sigma"] / math.sqrt(count))
    # what the position takes, of up to p_bn sin(beta_b) cos(beta_b) f, has a share of the variance that is not in it
    assert form["sigma"] == pytest.approx(sample["sigma"], rel=4 / math.sqrt(2 * count) + 2e-3)
