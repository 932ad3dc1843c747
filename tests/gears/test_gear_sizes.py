"""Gears from module 0.05 to 20 mm: what FCL reads grows with them, and its chords explain what it reads too much."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fixtures import strips_of
from gear_trials import drawn_trials, gear_columns, simulated
from oracles import brute_force
from oracles.involute_gear import InvoluteGear
from scene_texts import scene_of, written
from sets import covering

from tol3d.gearing.builds.build import Build
from tol3d.gearing.engines.fcl import FclEngine
from tol3d.gearing.engines.gaps import exact_engine
from tol3d.gearing.model import GearPart, Mesh, Model, model_from_scene
from tol3d.gears import LEFT, RIGHT, Flank, SpurGear, SpurPair
from tol3d.simulate import run_scene, simulation_of
from tol3d.study.results.witness import witness_summary, witness_warnings

MODULES = (0.05, 0.1, 0.3, 1.0, 2.5, 10.0, 20.0)
ALPHA = np.radians(20.0)
LEFT_OVER = 0.02e-3
"""modules; besides chords, as the witness allows: 0.05 um at module 2.5."""
EXACT = 1e-9  # of a module; Newton's last step, and the rounding of lengths of a hundred modules

SPUR = """scene: spur
parts:
  driver: {{kind: spur_gear, teeth: {z1}, module: {m} mm, pressure_angle: 20 deg, face_width: {w} mm, {x1}}}
  driven: {{kind: spur_gear, teeth: {z2}, module: {m} mm, pressure_angle: 20 deg, face_width: {w} mm, {x2}}}
moves: {{pair: {{kind: mesh, driver: driver, driven: driven, working_flank: right, centre_distance: {a} mm}}}}
measures:
  backlash: {{kind: normal_backlash, of: pair}}
  turn: {{kind: angular_backlash, of: pair, gear: driven}}
study: {{trials: {n}, seed: 1, engine: exact, witness: 40}}
tolerances:
  runs out: {{kind: eccentricity, of: driver, distribution: {{kind: rayleigh, scale: {e} um}}}}
"""
BEVEL = """scene: bevel
parts:
  driver: {{kind: bevel_gear, teeth: {z1}, module: {m} mm, pressure_angle: 20 deg, face_width: {w} mm, {x1}}}
  driven: {{kind: bevel_gear, teeth: {z2}, module: {m} mm, pressure_angle: 20 deg, face_width: {w} mm, {x2}}}
moves: {{pair: {{kind: bevel_mesh, driver: driver, driven: driven, working_flank: right}}}}
measures:
  backlash: {{kind: normal_backlash, of: pair, read_at: mean_section, tooth: all}}
  whole: {{kind: normal_backlash, of: pair, read_at: face, tooth: all}}
study: {{trials: {n}, seed: 1, engine: exact, witness: 40}}
tolerances:
  face: {{kind: mounting_face, of: driver, distribution: {{kind: normal, lower: -{e} um, upper: {e} um}}}}
  runs out: {{kind: eccentricity, of: driver, distribution: {{kind: rayleigh, scale: {e} um}}}}
"""
SHIFTS = {"spur": (0.3, 0.1), "bevel": (0.2, -0.2)}
THINNED = (
    "  thin {of}: {{kind: tooth_thickness, of: {of}, distribution: {{kind: normal, mean: -{t} um, sigma: {s} um}}}}\n"
)


def model_of(folder: Path, text: str, module: float, teeth: tuple[int, int], grade: float, trials: int = 40) -> Model:
    """A pair whose deviations are those of module `grade` [mm]: thinned by 0.02 of it, eccentric by 0.002."""
    width = 6 * module
    distance = (sum(teeth) / 2 + 0.39) * module  # 0.01 modules less than the shifts add up to
    shifts = {k: f"profile_shift: {x}" for k, x in zip(("x1", "x2"), SHIFTS[text.split()[1]], strict=True)}
    numbers = {"z1": teeth[0], "z2": teeth[1], "m": module, "w": width, "a": round(distance, 9), "e": 2 * grade}
    scene = text.format(**numbers, **shifts, n=trials)
    for gear in ("driver", "driven"):
        scene += THINNED.format(of=gear, t=20 * grade, s=grade)
    return model_from_scene(scene_of(scene, folder))


@dataclass(frozen=True)
class Both:
    """Readings of both engines for the same trials [modules, rad], (trials,) each by measure."""

    fcl: dict[str, np.ndarray]
    exact: dict[str, np.ndarray]
    chord_error: float  # modules


def both(model: Model, module: float, trials: int = 40) -> Both:
    engine = FclEngine(model, {part.name: strips_of(part.gear, model.profile_steps) for part in model.gears})
    block = drawn_trials(model, 1, 0, trials)
    columns = [gear_columns(model, each, block) for each in (engine, exact_engine(model))]
    assert all((each["status"] == "ok").all() for each in columns)
    per_um = 1 / (1000 * module)

    def values(each: Mapping[str, Any]) -> dict[str, np.ndarray]:
        return {
            measure.name: each[f"geometric:{measure.name}"] * (per_um if measure.unit == "um" else 1.0)
            for measure in model.measures
        }

    return Both(values(columns[0]), values(columns[1]), engine.chord_error / module)


@covering(pair=[(SPUR, (12, 20)), (SPUR, (28, 110)), (BEVEL, (14, 25))], module=MODULES)
def test_chords_explain_what_fcl_reads_of_gears_of_any_size(
    tmp_path: Path, pair: tuple[str, tuple[int, int]], module: float
) -> None:
    text, teeth = pair
    seen = both(model_of(tmp_path, text, module, teeth, module), module)
    for name in ("backlash", "whole") if text == BEVEL else ("backlash",):
        error = seen.fcl[name] - seen.exact[name]
        assert error.min() >= -LEFT_OVER / 4  # strips lie inside the teeth; FCL's rounding
        assert error.max() <= 4 * seen.chord_error + LEFT_OVER / 4
        # chords of 120 steps: a spur flank's is r_b t dt^2/8
        assert 1e-6 < seen.chord_error < 2e-5


@pytest.mark.slow
@pytest.mark.parametrize(("text", "teeth"), [(SPUR, (12, 20)), pytest.param(BEVEL, (14, 25), marks=pytest.mark.slow)])
def test_gears_alike_in_all_but_their_size_read_alike(tmp_path: Path, text: str, teeth: tuple[int, int]) -> None:
    reference = both(model_of(tmp_path, text, 2.5, teeth, 2.5), 2.5)
    for module in MODULES:
        seen = both(model_of(tmp_path, text, module, teeth, module), module)
        for name, values in reference.exact.items():
            # a turn [arcmin] of each module of backlash
            scale = np.abs(values).max() / np.abs(reference.exact["backlash"]).max() if name == "turn" else 1.0
            assert np.abs(seen.exact[name] - values).max() <= EXACT * scale * 100, (module, name)
            # what the solid modeller rounds to, 1e-7 mm, is 2e-6 modules at 0.05
            assert np.abs(seen.fcl[name] - reference.fcl[name]).max() <= (2e-6 + 1e-7 / module) * scale, (module, name)


@pytest.mark.parametrize("module", [0.05, 0.1, 20.0])
@pytest.mark.parametrize(("text", "teeth"), [(SPUR, (17, 43)), (BEVEL, (17, 43))])
def test_deviations_need_not_go_with_the_module(
    tmp_path: Path, text: str, teeth: tuple[int, int], module: float
) -> None:
    grade = 5 * module if module < 1 else module / 10  # small gears are made coarser, large ones finer
    seen = both(model_of(tmp_path, text, module, teeth, grade), module)
    for name in ("backlash", "whole") if text == BEVEL else ("backlash",):
        error = seen.fcl[name] - seen.exact[name]
        assert error.min() >= -LEFT_OVER
        assert error.max() <= 4 * seen.chord_error + LEFT_OVER


# edges ------------------------------------------------------------------------------------------------------------


@cache
def pair_gaps(module: float, flank: Flank) -> tuple[np.ndarray, np.ndarray, float]:
    """Gaps of tooth pairs on and beside the path of contact: by FCL and by brute force [modules]; the chord error.

    Beside it a tip edge is nearest, whose normal lies up to half a radian off the gap.
    """
    pinion, wheel = gears = (
        SpurGear(12, module, ALPHA, 6 * module, profile_shift=0.4),
        SpurGear(20, module, ALPHA, 6 * module, profile_shift=-0.4),
    )
    distance = 16 * module
    mesh = Mesh("mesh", "pinion", "wheel", SpurPair(pinion, wheel, distance), RIGHT)
    parts = (GearPart("pinion", pinion), GearPart("wheel", wheel))
    model = Model("edges", parts, (), (), (mesh,), ())
    count, thinner = 50, 0.02 * module
    shafts = np.tile(np.eye(4), (count, 2, 1, 1))
    shafts[:, 1, 0, 3] = distance
    turned = np.tile([-thinner / gear.reference_diameter for gear in gears], (count, 1))
    none = np.zeros((count, 2))
    made = Build(shafts, np.zeros((count, 2, 2)), np.zeros((count, 2, 3)), turned, none, np.ones((count, 2)))
    driver = np.random.default_rng(5).uniform(0.0, 2 * np.pi, count)
    driven = np.asarray(mesh.pair.driven_angle(driver))
    first, second = (
        InvoluteGear(g.teeth, g.module, g.pressure_angle, g.face_width, g.profile_shift, g.addendum, -thinner)
        for g in gears
    )
    searched = brute_force.Mesh(first, second, shafts[:, 0], shafts[:, 1], np.zeros((count, 2)), np.zeros((count, 2)))
    teeth, found, mates = brute_force.distances(searched, driver, driven, flank)
    teeth = teeth.astype(int)
    wanted = (found < 0.15 * module) & ((mesh.pair.mating_teeth(teeth, flank) - mates) % gears[1].teeth == 0)
    engine = FclEngine(model, {part.name: strips_of(part.gear, 120) for part in model.gears})
    seen = engine.gaps(made, mesh, flank, (driver, driven), teeth, wanted).value
    return seen[wanted] / module, found[wanted] / module, engine.chord_error / module


@pytest.mark.parametrize("flank", [RIGHT, LEFT])
@pytest.mark.parametrize("module", [0.05, 2.5, 20.0])
def test_tip_edges_are_read_as_right_as_flanks(module: float, flank: Flank) -> None:
    seen, found, chord_error = pair_gaps(module, flank)
    assert np.count_nonzero(found > 0.021) >= 8  # beyond the path of contact: on it there is 0.02 cos 20 deg, 0.019
    error = seen - found
    assert error.min() >= -LEFT_OVER / 2
    assert error.max() <= 2 * chord_error + LEFT_OVER / 4


ONE_TOOTH = """scene: tip edges
parts:
  driver: {{kind: bevel_gear, teeth: 12, module: 3.5 mm, pressure_angle: 20 deg, profile_shift: 0.4, {face}}}
  driven: {{kind: bevel_gear, teeth: 20, module: 3.5 mm, pressure_angle: 20 deg, profile_shift: -0.4, {face}}}
tolerances:
  a: {{kind: tooth_thickness, of: driver, distribution: {{kind: normal, mean: -42.5 um, sigma: 2 um}}}}
  b: {{kind: tooth_thickness, of: driven, distribution: {{kind: normal, mean: -42.5 um, sigma: 2 um}}}}
moves: {{pair: {{kind: bevel_mesh, driver: driver, driven: driven, working_flank: right}}}}
measures: {{one tooth: {{kind: normal_backlash, of: pair, read_at: mean_section, tooth: {tooth}}}}}
study: {{trials: 300, seed: 1, engine: exact, witness: 100}}
"""


@pytest.mark.parametrize("tooth", ["driver", "all"])
def test_a_witness_of_edges_is_content(tmp_path: Path, tooth: str) -> None:
    """A pair so far shifted that tips reach far down their mates' flanks."""
    model = simulation_of(scene_of(ONE_TOOTH.format(tooth=tooth, face="face_width: 10 mm"), tmp_path))
    witness = witness_summary(model, model.system.method("exact", None), model.study.trials)
    own = witness["measures"]["one tooth"]
    assert own["compared"] > 10
    assert own["allowance"] == pytest.approx(1e3 * LEFT_OVER * 3.5)
    assert own["max_abs_difference"] < own["expected_at_most"] < 0.2
    assert witness_warnings(model, witness) == []


def test_a_small_gear_s_witness_warns_of_little(tmp_path: Path) -> None:
    """At module 0.05 chords explain 0.0025 um: 0.1 um further apart, 2 sin 20 deg of it more backlash, is told."""
    model = model_of(tmp_path, SPUR, 0.05, (12, 20), 0.05)
    apart = model_of(tmp_path, SPUR.replace("{a}", "0.8196"), 0.05, (12, 20), 0.05)
    simulation, other_simulation = simulated(model, witness=40), simulated(apart, witness=40)
    method = simulation.system.method("exact", None)
    witness = witness_summary(simulation, method, 40)
    assert witness_warnings(simulation, witness) == []
    own = witness["measures"]["backlash"]
    assert own["expected_at_most"] + own["allowance"] < 0.005
    other = witness_summary(other_simulation, method, 40)
    assert witness_warnings(other_simulation, other)


def test_each_mesh_of_a_train_has_the_bound_of_its_own_gears(tmp_path: Path) -> None:
    scene = (
        "scene: two sizes\n"
        "parts:\n"
        "  a: {kind: spur_gear, teeth: 20, module: 0.3 mm, pressure_angle: 20 deg, face_width: 3 mm}\n"
        "  b: {kind: spur_gear, teeth: 40, module: 0.3 mm, pressure_angle: 20 deg, face_width: 3 mm}\n"
        "  c: {kind: spur_gear, teeth: 20, module: 3 mm, pressure_angle: 20 deg, face_width: 30 mm}\n"
        "  d: {kind: spur_gear, teeth: 40, module: 3 mm, pressure_angle: 20 deg, face_width: 30 mm}\n"
        "tolerances:\n"
        "  one: {kind: tooth_thickness, of: a, distribution: {kind: normal, mean: -9 um, sigma: 1 um}}\n"
        "  two: {kind: tooth_thickness, of: c, distribution: {kind: normal, mean: -90 um, sigma: 10 um}}\n"
        "moves:\n"
        "  small: {kind: mesh, driver: a, driven: b, centre_distance: 9 mm, working_flank: right}\n"
        "  large: {kind: mesh, driver: c, driven: d, centre_distance: 90 mm, working_flank: right}\n"
        "measures:\n"
        "  small gap: {kind: normal_backlash, of: small}\n"
        "  large gap: {kind: normal_backlash, of: large}\n"
        "study: {trials: 30, seed: 1, engine: exact, witness: 30}\n"
    )
    path = written(scene, tmp_path)
    run = run_scene(path, out=tmp_path / "run")
    small, large = (run.summary["witness"]["measures"][name] for name in ("small gap", "large gap"))
    assert run.summary["witness"]["chord_error_um"] * 4 == pytest.approx(large["expected_at_most"])
    assert small["expected_at_most"] == pytest.approx(large["expected_at_most"] / 10, rel=1e-3)
    for own in (small, large):
        assert 0 < own["max_abs_difference"] <= own["expected_at_most"] + own["allowance"]
    assert not [each for each in run.summary["warnings"] if "witness" in each]
