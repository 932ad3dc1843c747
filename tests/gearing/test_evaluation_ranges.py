"""Evaluation ranges of slopes and forms: what flanks stand out by at the ends of a range, and dense points of them."""

import math
from pathlib import Path

import numpy as np
import pytest
from gearing import deviating_pair
from numpy.typing import NDArray
from oracles.deviated_flanks import DeviatedGear, DeviatedPair, active_rolls, between
from scene_texts import scene_of

from tol3d.gearing.builds.flank_offsets import FlankPlaces
from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gearing.model import Model, Reading, model_from_scene
from tol3d.gearing.stack_up import stack_of
from tol3d.gears import SpurGear
from tol3d.gears.flank import LEFT, RIGHT, Flank

Array = NDArray[np.float64]

GIVEN = "flanks: each, each: gear, law: {kind: given, right: [10 um], left: [-4 um]}"
BASE = 20 * math.cos(math.radians(20))  # mm
ACTIVE = active_rolls(20, 30, 2.0, 50.2)
TIP = math.sqrt((22 / BASE) ** 2 - 1)


def model_of(folder: Path, *tolerances: str) -> Model:
    lines = "\n".join(f"  deviation {k}: {{{own}}}" for k, own in enumerate(tolerances))
    return deviating_pair.model_of(folder, lines)


def out_um(model: Model, flank: Flank, roll: float, z: float = 0.0) -> float:
    """Protrusion of the pinion's flanks of a side at a place, all tolerances at their given values [um]."""
    deviations = np.concatenate([np.array(own.draw.deviations(), dtype=float) for own in model.contributors])
    seat, at = model.seat_index["pair", "pinion"], (np.array([roll]), np.array([z]))
    rates = FlankPlaces.of(model).rates(model, seat, flank, np.array([3]), at)
    return 1e3 * float(rates[0] @ deviations)


def roll_at(diameter: float) -> float:
    return math.sqrt((diameter / 2 / BASE) ** 2 - 1)


SLOPE, HELIX = f"kind: profile_slope, of: pinion, {GIVEN}", f"kind: helix_slope, of: pinion, {GIVEN}"
FORM = f"kind: profile_form, of: pinion, {GIVEN}"


def test_a_profile_slope_counts_from_the_active_profile_s_begin_to_the_tip(tmp_path: Path) -> None:
    model = model_of(tmp_path, SLOPE)
    assert out_um(model, RIGHT, TIP) == pytest.approx(5.0)
    assert out_um(model, RIGHT, ACTIVE[0]) == pytest.approx(-5.0)
    assert out_um(model, LEFT, TIP) == pytest.approx(-2.0)
    beyond = ACTIVE[0] - 0.1 * (TIP - ACTIVE[0])  # the mean line goes on
    assert out_um(model, RIGHT, beyond) == pytest.approx(-6.0)


def test_a_slope_counts_between_stated_diameters_and_goes_on_beyond_them(tmp_path: Path) -> None:
    model = model_of(tmp_path, f"{SLOPE}, range: [39 mm, 43 mm]")
    assert [out_um(model, RIGHT, roll_at(own)) for own in (39.0, 43.0)] == pytest.approx([-5.0, 5.0])
    more = 5.0 + 10.0 * (TIP - roll_at(43.0)) / (roll_at(43.0) - roll_at(39.0))
    assert out_um(model, RIGHT, TIP) == pytest.approx(more)


def test_a_helix_slope_counts_over_the_face_or_between_stated_heights(tmp_path: Path) -> None:
    whole = model_of(tmp_path, HELIX)
    assert [out_um(whole, RIGHT, 0.3, z) for z in (-6.0, 0.0, 6.0)] == pytest.approx([-5.0, 0.0, 5.0])
    less = model_of(tmp_path, f"{HELIX}, range: [1 mm, 9 mm]")  # from -5 to 3 mm over the middle
    assert [out_um(less, RIGHT, 0.3, z) for z in (-5.0, -1.0, 3.0)] == pytest.approx([-5.0, 0.0, 5.0])


@pytest.mark.parametrize("range_", ["", ", range: [39.5 mm, 42.5 mm]"])
def test_a_barrel_has_its_form_deviation_within_the_range(range_: str, tmp_path: Path) -> None:
    model = model_of(tmp_path, f"{FORM}, shape: barrel{range_}")
    first, last = (roll_at(39.5), roll_at(42.5)) if range_ else (ACTIVE[0], ACTIVE[0] + 0.95 * (TIP - ACTIVE[0]))
    seen = [out_um(model, RIGHT, first + share * (last - first)) for share in np.linspace(0.0, 1.0, 21)]
    assert np.ptp(seen) == pytest.approx(10.0)
    assert seen[::10] == pytest.approx([-20 / 3, 10 / 3, -20 / 3])
    assert float(np.polyfit(np.linspace(-1.0, 1.0, 21), seen, 1)[0]) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("teeth", [20, 60])  # the involute of 60 teeth begins above the base circle, at the root
def test_waves_count_over_the_range_and_slopes_beside_them_over_their_own(teeth: int, tmp_path: Path) -> None:
    apart, base = teeth + 30.2, teeth * math.cos(math.radians(20))
    diameters = (2 * teeth - 0.5, 2 * teeth + 2.5)
    wave = f"{FORM}, shape: wave, waves: 2, range: [{diameters[0]} mm, {diameters[1]} mm]"
    text = deviating_pair.SCENE.format(tolerances=f"  wave: {{{wave}}}\n  slope: {{{SLOPE}}}", flank="right")
    text = text.replace("teeth: 20", f"teeth: {teeth}").replace("50.2 mm", f"{apart} mm")
    model = model_from_scene(scene_of(text, tmp_path))
    first, last = (math.sqrt((own / 2 / base) ** 2 - 1) for own in diameters)
    begin, tip = active_rolls(teeth, 30, 2.0, apart)
    for share in (0.0, 0.1, 0.25, 0.6, 1.0, 1.1):
        roll = first + share * (last - first)
        out = 5.0 * math.cos(4 * math.pi * (share - 0.5)) + 10.0 * ((roll - begin) / (tip - begin) - 0.5)
        assert out_um(model, RIGHT, roll) == pytest.approx(out)


def test_the_smallest_begin_of_all_mates_counts(tmp_path: Path) -> None:
    """An idler between two mates: the one with the longer teeth touches further down."""
    text = deviating_pair.SCENE.format(tolerances=f"  slope: {{{SLOPE}}}", flank="right")
    other = "{kind: mesh, driver: pinion, driven: long, centre_distance: 50.2 mm, azimuth: 150 deg}"
    text = text.replace("moves:", f"moves:\n  other: {other}")
    long = "  long: {kind: spur_gear, teeth: 30, module: 2 mm, face_width: 10 mm, addendum: 1.1, dedendum: 1.25}\n"
    model = model_from_scene(scene_of(text.replace("tolerances:", f"{long}tolerances:"), tmp_path))
    other_tip = math.sqrt(32.2**2 - (1.5 * BASE) ** 2)
    first = (math.sqrt(50.2**2 - (2.5 * BASE) ** 2) - other_tip) / BASE
    assert first < ACTIVE[0]
    assert out_um(model, RIGHT, first) == pytest.approx(-5.0)


@pytest.mark.slow
def test_stated_ranges_are_dense_points_of_their_flanks(tmp_path: Path) -> None:
    """Exact to 1e-3 um; the stack-up to what goes with the curvature of forms."""
    given = "flanks: together, each: gear, law: {kind: given, right: [6 um]}"
    model = model_of(
        tmp_path,
        f"kind: profile_slope, of: pinion, range: [39 mm, 43 mm], {given}",
        f"kind: profile_form, of: pinion, shape: wave, waves: 1, range: [39.5 mm, 42.5 mm], {given}",
        f"kind: helix_slope, of: pinion, range: [1 mm, 9 mm], {given}",
        f"kind: profile_form, of: wheel, shape: barrel, range: [58 mm, 63 mm], {given}",
        f"kind: helix_slope, of: wheel, range: [0.5 mm, 9.5 mm], {given}",
    )

    def pinion(tooth: int, flank: int, roll: Array, z: float) -> Array:
        wave = 0.5 * np.cos(2 * math.pi * between(roll, 20, 2.0, (39.5, 42.5)))
        return np.asarray(6e-3 * (between(roll, 20, 2.0, (39.0, 43.0)) + wave + (z + 1.0) / 8.0))

    def wheel(tooth: int, flank: int, roll: Array, z: float) -> Array:
        return np.asarray(6e-3 * (1 / 3 - 4 * between(roll, 30, 2.0, (58.0, 63.0)) ** 2 + z / 9.0))

    first = [own.gear.form_roll for own in model.gears if isinstance(own.gear, SpurGear)]
    gears = DeviatedGear(20, 2.0, first[0], pinion), DeviatedGear(30, 2.0, first[1], wheel)
    pair = DeviatedPair(*gears, 50.2, (-5.0, 5.0))
    angle = np.linspace(0.0, 2 * math.pi / 20, 7)
    deviations = np.tile([6e-3], (7, len(model.contributors)))
    engine, mesh = ExactEngine(model), model.meshes[0]
    found = engine.read(engine.build(deviations), mesh, Reading(), angle, frozenset(("pinion", "wheel")))
    assert (found.status == 0).all()
    for row, (driver, driven) in enumerate(zip(angle, found.driven_angle, strict=True)):
        assert 1.5e3 * BASE * pair.turn_to_touch(1, driver, driven) == pytest.approx(0.0, abs=2e-3)
        assert 1e3 * (pair.gap(-1, driver, driven) - found.gap[row]) == pytest.approx(0.0, abs=2e-3)
    by_theory = stack_of(model, mesh, Reading()).normal_backlash(deviations, angle, None)
    assert 1e3 * by_theory == pytest.approx(1e3 * found.gap, abs=0.1)
