"""Planetary sets whose sun, ring and carrier lie in bores of parts with drawings."""

from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from machine.housed import gearbox_of, system_of, values
from machine.test_shared_bores import LOCATED, PAIRS, POINTS, TABLE
from numpy.typing import NDArray
from oracles.whole_set import WholeSet
from scene_texts import refusal

from tol3d import SceneError, check_scene
from tol3d.gearing.machine.system import MachineSystem
from tol3d.study.system.method import ANALYTIC_METHOD
from tol3d.study.system.regressors import regressor_count
from tol3d.study.system.trials import Trials
from tol3d.study.trials.columns import columns_of

Array = NDArray[np.float64]

SHAFTS = ("sun", "ring", "carrier")
TEETH = (24, 27, 78)
PLANETS = 3
LAW = "distribution: {kind: uniform, lower: -20 um, upper: 20 um}"
BORES = "".join(
    f"\n      {name} bore: {{kind: cylinder, at: [0 mm, 0 mm, {z} mm], axis: [0, 0, 1], length: 10 mm, diameter: 9 mm}}"
    for name, z in (("sun", -40), ("ring", 0), ("carrier", 40))
)
MOVED = "".join(
    f"\n  {name} {axis}: {{kind: plus_minus, of: housing.{name} bore, along: {along}, {LAW}}}"
    for name in SHAFTS
    for axis, along in (("x", [1, 0, 0]), ("y", [0, 1, 0]))
)
OF_SET = f"""
  sun teeth: {{kind: tooth_thickness, of: sun, {LAW}}}
  planet teeth: {{kind: tooth_thickness, of: P, {LAW}}}
  ring teeth: {{kind: tooth_thickness, of: ring, {LAW}}}
  sun run-out: {{kind: eccentricity, of: sun, distribution: {{kind: rayleigh, scale: 3 um}}}}
  ring run-out: {{kind: eccentricity, of: ring, distribution: {{kind: rayleigh, scale: 3 um}}}}
  outwards: {{kind: planet_pin, of: carrier, each: planet, direction: radial, {LAW}}}
  round: {{kind: planet_pin, of: carrier, each: planet, direction: tangential, {LAW}}}"""
PARTS = """
  sun: {{kind: spur_gear, teeth: {}, module: 1 mm, face_width: 12 mm}}
  P: {{kind: spur_gear, teeth: {}, module: 1 mm, face_width: 12 mm}}
  ring: {{kind: internal_gear, teeth: {}, module: 1 mm, face_width: 12 mm, addendum: 0.8}}
  planet: {{kind: planet, gears: [P]}}
  carrier: {{kind: planet_carrier}}"""


def laid(*names: str) -> str:
    return "".join(f"\n  {own} laid: {{kind: shaft_in_bores, shaft: {own}, in: [housing.{own} bore]}}" for own in names)


def scene(
    *,
    roles: tuple[str, str, str] = ("ring", "sun", "carrier"),
    teeth: tuple[int, int, int] = TEETH,
    planets: int = PLANETS,
    tolerances: str = OF_SET + MOVED,
    moves: str = laid(*SHAFTS),
    bores: str = BORES,
    fixed: str = "\n  base: {kind: fix, part: housing}",
    more: str = "",
    over: str = "",
) -> str:
    """Held, driving and driven shaft as `roles`."""
    held, driving, driven = roles
    return f"""scene: a set in a housing
parts:
  housing:
    kind: solid
    features:{bores}{PARTS.format(*teeth)}{more}
tolerances:{tolerances}
moves:{fixed}{moves}
  set: {{kind: planetary, planet: planet, planets: {planets}, carrier: carrier, meshes: {{sun: P, ring: P}},
    held: {held}, input: {driving}, output: {driven}}}
  train: {{kind: train, driven: {driving}, output: {driven}}}
measures:
  lost motion: {{kind: lost_motion, of: train{over}}}
"""


def drawn_at_random(rng: np.random.Generator, count: int, planets: int, size: float = 1.0) -> dict[str, Array]:
    """By column without its unit [mm]."""
    named = {f"{name} {axis}": 0.03 for name in SHAFTS for axis in "xy"}
    named |= {f"{name} run-out.{axis}": 0.006 for name in SHAFTS[:2] for axis in "xy"}
    named |= {f"{way}.planet {k + 1}": 0.01 for way in ("outwards", "round") for k in range(planets)}
    found = {name: size * rng.uniform(-most, most, count) for name, most in named.items()}
    found |= {f"planet teeth.planet {k + 1}": np.full(count, -0.08 * size) for k in range(planets)}
    return found | {f"{name} teeth": rng.uniform(-0.12, -0.08, count) * size for name in ("sun", "ring")}


def searched(
    of: Mapping[str, Array], trial: int, driver: float, roles: tuple[str, str, str], teeth: tuple[int, int, int]
) -> float:
    """Lost motion of the driven shaft [rad] where the driving one stands at an angle [rad]."""
    held, driving, driven = roles
    sun, planet, ring = teeth
    planets = sum(name.startswith("round") for name in of)
    one = {name: float(own[trial]) for name, own in of.items()}
    apart = {"sun": Fraction(1), "ring": Fraction(-sun, ring), "carrier": Fraction(0)}  # turns as the carrier sees them
    rate = {name: (apart[name] - apart[held]) / (apart[driving] - apart[held]) for name in SHAFTS}
    whole = WholeSet(
        module=1.0,
        meshes={"sun": (sun, planet), "ring": (-ring, planet)},
        distance=(sun + planet) / 2,
        planets=planets,
        thicker={"sun": one["sun teeth"], "ring": one["ring teeth"], planet: one["planet teeth.planet 1"]},
        off={name: complex(one[f"{name} x"], one[f"{name} y"]) for name in SHAFTS},
        eccentric={name: complex(one[f"{name} run-out.x"], one[f"{name} run-out.y"]) for name in SHAFTS[:2]},
        pins=tuple(complex(one[f"outwards.planet {k + 1}"], one[f"round.planet {k + 1}"]) for k in range(planets)),
    )
    return whole.play({name: driver * float(own) for name, own in rate.items()}, driven)


def turns_of(system: MachineSystem, turns: Array) -> Array:
    """Angle of the driving shaft [rad]."""
    return np.asarray(system.positions(dict.fromkeys(system.streams, turns))["set"])


# both methods against a search ----------------------------------------------------------------------------------------


def check_against_search(seed: int, count: int, folder: Path) -> float:
    """Largest difference at the pitch radius [mm], and what the bores do by the way."""
    rng = np.random.default_rng(seed)
    roles = [("ring", "sun", "carrier"), ("carrier", "sun", "ring"), ("sun", "ring", "carrier")][seed % 3]
    planets = int(rng.integers(3, 6))
    planet = int(rng.integers(18, 30))
    sun = int(rng.integers(28, 45))
    while (2 * sun + 2 * planet) % planets:
        sun += 1
    teeth = (sun, planet, sun + 2 * planet)
    system = gearbox_of(scene(roles=roles, teeth=teeth, planets=planets), folder)
    of, turns = drawn_at_random(rng, count, planets), rng.random(count)
    still = {name: own * 0 if name.endswith((" x", " y")) else own for name, own in of.items()}
    found = values(system, "exact", of, turns)["lost motion"]
    unmoved = values(system, "exact", still, turns)["lost motion"]
    assert np.abs(found - unmoved).max() > 1e-4  # rad
    angles = turns_of(system, turns)
    wanted = np.array([searched(of, k, angles[k], roles, teeth) for k in range(count)])
    radius = (sun + planet) / 2
    return float(np.abs(found - wanted).max() * radius)


@pytest.mark.parametrize("seed", range(3))
def test_bores_move_a_set_as_a_search_finds(seed: int, tmp_path: Path) -> None:
    assert check_against_search(seed, 4, tmp_path) < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3, 15))
def test_bores_move_random_sets_as_a_search_finds(seed: int, tmp_path: Path) -> None:
    assert check_against_search(seed, 6, tmp_path) < 1e-6


@pytest.mark.parametrize("roles", [("ring", "sun", "carrier"), ("carrier", "sun", "ring")])
def test_first_order_and_exact_differ_by_squares(roles: tuple[str, str, str], tmp_path: Path) -> None:
    """Halve all deviations, and the difference is a quarter."""
    system = gearbox_of(scene(roles=roles), tmp_path)
    rng, count = np.random.default_rng(3), 40
    of, turns = drawn_at_random(rng, count, PLANETS), rng.random(count)
    off = []
    for size in (1.0, 0.5, 0.25):
        sized = {name: size * own for name, own in of.items()}
        exact, analytic = (values(system, method, sized, turns)["lost motion"] for method in ("exact", "analytic"))
        off.append(float(np.sqrt(np.mean((exact - analytic) ** 2))))
    for k in range(2):
        assert off[k] / off[k + 1] == pytest.approx(4.0, rel=0.08)


# housings that change nothing -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_a_set_in_a_true_housing_is_the_set_by_itself(method: str, tmp_path: Path) -> None:
    """Read where the sun stands at 100 degrees, and the carrier so at 100 / 4.25."""
    alone = f"""scene: alone
parts:{PARTS.format(*TEETH)}
tolerances:{OF_SET}
moves:
  set: {{kind: planetary, planet: planet, planets: {PLANETS}, carrier: carrier, meshes: {{sun: P, ring: P}},
    held: ring, input: sun, output: carrier}}
measures:
  lost motion: {{kind: planetary_lost_motion, of: set, over: {{at: {100 / 4.25!r} deg}}}}
"""
    rng, count = np.random.default_rng(8), 30
    of, turns = drawn_at_random(rng, count, PLANETS), rng.random(count)
    of = {name: own for name, own in of.items() if not name.endswith((" x", " y"))}
    housed = gearbox_of(scene(over=", over: {at: 100 deg}"), tmp_path)
    found = values(housed, method, of, turns)["lost motion"]
    wanted = values(system_of(alone, tmp_path), method, of, turns)["lost motion"]
    assert np.ptp(wanted) > 1e-4
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-12)


def test_a_housing_that_stands_askew_as_a_whole_changes_nothing(tmp_path: Path) -> None:
    """Locators move and turn it by up to a millimetre over its length; sun, ring and carrier go along."""
    locators = "".join(f"\n  {pair}: {{kind: locator, of: base, pair: {pair}, {LAW}}}" for pair in PAIRS)
    text = scene(
        tolerances=OF_SET + MOVED + locators,
        bores=BORES + POINTS,
        fixed="\n  set table: {kind: fix, part: table}" + LOCATED,
        more=TABLE,
    )
    system = gearbox_of(text, tmp_path)
    rng, count = np.random.default_rng(2), 20
    of, turns = drawn_at_random(rng, count, PLANETS), rng.random(count)
    askew = of | {pair: rng.uniform(-1, 1, count) for pair in PAIRS}
    for method in ("exact", "analytic"):
        still, moved = (values(system, method, own, turns)["lost motion"] for own in (of, askew))
        np.testing.assert_allclose(moved, still, rtol=0, atol=1e-11)
    acting = {own.name for own in system.acting(system.measures[0])}
    assert acting == {own.name for own in system.contributors} - set(PAIRS)


def test_bores_that_all_lie_aside_alike_change_nothing(tmp_path: Path) -> None:
    """As far as both methods see one line where it lies; the part with the first bore does not go along."""
    system = gearbox_of(scene(), tmp_path)
    rng, count = np.random.default_rng(4), 20
    of, turns = drawn_at_random(rng, count, PLANETS), rng.random(count)
    aside = {axis: rng.uniform(-0.02, 0.02, count) for axis in "xy"}
    alike = of | {f"{name} {axis}": of[f"{name} {axis}"] + aside[axis] for name in SHAFTS for axis in "xy"}
    for method in ("exact", "analytic"):
        still, moved = (values(system, method, own, turns)["lost motion"] for own in (of, alike))
        np.testing.assert_allclose(moved, still, rtol=0, atol=1e-12)


# which bores, and where along the axis --------------------------------------------------------------------------------

TWO = BORES + "\n      far sun bore: {kind: axis, at: [0 mm, 0 mm, -20 mm], axis: [0, 0, 1], length: 9 mm}"
SHAFT = "\n  fast: {kind: shaft, carries: {sun: {at: 30 mm}}}"
IN_TWO = "\n  sun laid: {kind: shaft_in_bores, shaft: fast, in: [housing.sun bore, housing.far sun bore], at: 10 mm}"


def test_a_shaft_in_two_bores_has_its_sun_where_its_line_passes_the_teeth(tmp_path: Path) -> None:
    """Bores at -40 and -20 mm, teeth at 0: the sun lies aside by twice the far bore less the near one."""
    far = f"\n  far x: {{kind: plus_minus, of: housing.far sun bore, along: [1, 0, 0], {LAW}}}"
    text = scene(tolerances=OF_SET + MOVED + far, bores=TWO, moves=IN_TWO + laid("ring", "carrier"), more=SHAFT)
    two = gearbox_of(text.replace("train, driven: sun", "train, driven: fast"), tmp_path)
    one = gearbox_of(scene(), tmp_path)
    rng, count = np.random.default_rng(6), 20
    of, turns = drawn_at_random(rng, count, PLANETS), rng.random(count)
    near, far_x = rng.uniform(-0.01, 0.01, (2, count))
    lies = of | {"sun x": 2 * far_x - near, "sun y": np.zeros(count)}
    bored = of | {"sun x": near, "far x": far_x, "sun y": np.zeros(count)}
    for method in ("exact", "analytic"):
        found, wanted = values(two, method, bored, turns), values(one, method, lies, turns)
        np.testing.assert_allclose(found["lost motion"], wanted["lost motion"], rtol=0, atol=1e-12)


def test_what_lies_in_no_bores_lies_on_the_axis_of_what_does_and_the_check_says_so(tmp_path: Path) -> None:
    """The sun in bores, the ring in its own, the carrier in none: it goes with the sun, whose move comes first."""
    whole, some = gearbox_of(scene(), tmp_path), gearbox_of(scene(moves=laid("sun", "ring")), tmp_path)
    rng, count = np.random.default_rng(7), 20
    of, turns = drawn_at_random(rng, count, PLANETS), rng.random(count)
    along = of | {f"carrier {axis}": of[f"sun {axis}"] for axis in "xy"}
    found, wanted = values(some, "exact", of, turns), values(whole, "exact", along, turns)
    np.testing.assert_allclose(found["lost motion"], wanted["lost motion"], rtol=0, atol=1e-12)
    assert some.gears.model.link("set").remark == "carrier lies in no bores, and so on the axis of sun"
    assert "carrier lies in no bores" in str(check_scene(tmp_path / "scene.yaml"))
    assert not whole.gears.model.link("set").remark


# shares ---------------------------------------------------------------------------------------------------------------


def test_each_bore_has_the_share_that_differences_of_the_lost_motion_give_it(tmp_path: Path) -> None:
    """Its part in a trial is what the lost motion changes by per deviation there, times the deviation."""
    system = gearbox_of(scene(), tmp_path)
    rng, count = np.random.default_rng(9), 400
    of, turns = drawn_at_random(rng, count, PLANETS), rng.random(count)
    names = [column.rpartition(" ")[0] for own in system.contributors for column in own.columns]
    trials = Trials(
        np.stack([of[name] for name in names], axis=1), system.positions(dict.fromkeys(system.streams, turns))
    )
    (measure,) = system.measures

    def read(deviations: Array) -> Array:
        own = system.method(ANALYTIC_METHOD, None).answers(Trials(deviations, trials.positions), [measure])
        return np.asarray(own.values["lost motion"][:, 0] * measure.per_internal)

    rows = {own.name: np.full((regressor_count(own), count), np.nan) for own in system.contributors}
    system.regress(measure, system.contributors, columns_of(system, None, trials, (measure,)), rows)
    spread = np.std(read(trials.deviations))
    for name in (f"{name} {axis}" for name in SHAFTS for axis in "xy"):
        step = np.where(np.array(names) == name, 1e-7, 0.0)  # mm
        slope = (read(trials.deviations + step) - read(trials.deviations - step)) / 2e-7
        part = slope * of[name]
        near = np.abs(rows[name][0] - part) < 1e-6 * spread
        assert near.mean() > 0.99, name  # of the others another contact is met within the step
        assert np.std(part) > 0.1 * spread
        assert name in {own.name for own in system.acting(measure)}


# what is wrong --------------------------------------------------------------------------------------------------------

WRONG: dict[str, tuple[dict[str, str], str, str]] = {
    "axes that are not one line": (
        {"bores": BORES.replace("[0 mm, 0 mm, 40 mm]", "[0 mm, 0.3 mm, 40 mm]")},
        "moves.carrier laid.in",
        "expected bores on the axis on which its train puts 'carrier', got 'housing.carrier bore', 0.3 mm beside it",
    ),
    "a held ring that is not on it": (
        {"bores": BORES.replace("[0 mm, 0 mm, 0 mm]", "[0 mm, 0.3 mm, 0 mm]")},
        "moves.ring laid.in",
        "expected bores on the axis on which its train puts 'ring', got 'housing.ring bore', 0.3 mm beside it",
    ),
    "a planet in bores": (
        {"moves": laid(*SHAFTS).replace("shaft: carrier", "shaft: P")},
        "moves.carrier laid.shaft",
        "expected a shaft that gears or trains turn, or a part on the axis of one, got 'P'",
    ),
}


@pytest.mark.parametrize(("wrong", "place", "words"), WRONG.values(), ids=WRONG)
def test_it_is_refused_with_one_message(wrong: dict[str, Any], place: str, words: str, tmp_path: Path) -> None:
    said = refusal(scene(**wrong), tmp_path)
    assert said.startswith(place), said
    assert "\n" not in said, said
    assert words in said


def test_a_ring_in_a_part_that_its_own_train_turns_is_a_ring_of_reads(tmp_path: Path) -> None:
    """The carrier turns the link, whose bore holds the ring, against the sun's bore."""
    link = """
  link:
    kind: solid
    features:
      pilot: {kind: axis, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 10 mm}
      ring bore: {kind: cylinder, at: [0.5 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 10 mm, diameter: 9 mm}"""
    chain = """
  arm: {kind: open_chain, joints: {elbow: {between: [housing.carrier bore, link.pilot], train: train}},
    poses: {home: {elbow: 0 deg}}}"""
    text = scene(tolerances=OF_SET, moves=chain + laid("sun", "ring").replace("housing.ring", "link.ring"), more=link)
    with pytest.raises(SceneError) as caught:
        gearbox_of(text.replace("at: [0.5 mm", "at: [0 mm"), tmp_path)
    assert "a ring of reads: ring, elbow, its bores" in str(caught.value)
