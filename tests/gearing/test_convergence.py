"""Orders of the approximations: strips with their steps, extremes with their positions."""

from dataclasses import replace
from typing import Literal

import numpy as np
import pytest
from fixtures import EngineOf
from gear_trials import drawn_trials, gear_columns
from of_kind import known, of_kind
from oracles import exact_eccentric
from oracles.involute_gear import InvoluteGear
from oracles.thickness import thickness_of
from places import SCENES

from tol3d import load_scene
from tol3d.gearing.builds.build import build
from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gearing.meshing.mesh import Meshing
from tol3d.gearing.meshing.seats import geometric_values, measure_backlash, read_backlash, seated
from tol3d.gearing.model import Backlash, Measure, Model, Positions, Reading, model_from_scene
from tol3d.gears import LEFT, RIGHT
from tol3d.gears.flank import Flank
from tol3d.study.system.positions import Take
from tol3d.study.system.taken import taken
from tol3d.study.system.trials import Trials

Over = Literal["random", "at", "turn", "long_period", "swing"]

DENSITIES = (60, 80, 120, 160)
TRIALS = 200  # the mean error of so many has a standard error of 3 %, and the same trials serve every density

# of a sine's amplitude at 24 positions a turn, halfway between two: 1 - cos d - sin^2(d)(1 + cos h)/(4 cos d), d = h/2
LARGEST_PARABOLA_ERROR = 1.1e-4


def exact_of(model: Model, block: Trials, angle: np.ndarray) -> np.ndarray:
    """Normal backlash [mm] of a block's trials by the closed form, (trials,) at driver angles (trials,)."""
    mesh, made = model.meshes[0], build(model, block.deviations)
    pinion, wheel = (
        InvoluteGear(gear.teeth, gear.module, gear.pressure_angle, gear.face_width)
        for gear in (mesh.pair.pinion, mesh.pair.wheel)
    )
    axis = made.world_from_shaft[:, 1, :2, 3] - made.world_from_shaft[:, 0, :2, 3]
    centres = (made.centre[:, 0], made.centre[:, 1])
    thickness = thickness_of(model, made).sum(axis=1)
    return exact_eccentric.normal_backlash(pinion, wheel, thickness, axis, centres, angle, mesh.working_flank)


@pytest.mark.slow
@pytest.mark.parametrize("flank", [RIGHT, LEFT], ids=["right", "left"])
def test_mean_error_of_the_strips_falls_with_the_square_of_the_step(
    flank: Flank, paper_model: Model, engine_of: EngineOf
) -> None:
    model = replace(paper_model, meshes=(replace(paper_model.meshes[0], working_flank=flank),))
    mesh, block = model.meshes[0], drawn_trials(model, 5, 0, TRIALS)
    angle, made = block.positions[mesh.name], build(model, block.deviations)
    exact = exact_of(model, block, angle)
    errors, chords = [], []
    for steps in DENSITIES:
        engine = engine_of(model, steps)
        meshing = Meshing(engine, model, mesh, made, Reading())
        values = measure_backlash(of_kind(Backlash, model.measures[0].kind), meshing, meshing.seat(angle))
        errors.append(np.mean(values - exact))
        chords.append(engine.chord_error)
    order = -np.polyfit(np.log(DENSITIES), np.log(errors), 1)[0]
    assert 1.7 < order < 2.3
    # two contacts, each between two strips that lie inside their teeth by a chord error at most
    assert all(0 < error < 4 * chord for error, chord in zip(errors, chords, strict=True))
    assert -np.polyfit(np.log(DENSITIES), np.log(chords), 1)[0] == pytest.approx(2.0, abs=0.02)


# strips against the exact engine -----------------------------------------------------------------------------


FCL_NOISE = 0.002e-3  # mm; a section is a strip 2 um wide, over which a bevel pair's gap grows by 1e-6 mm


def errors_of_fcl(scene: str, trials: int, densities: tuple[int, ...], engine_of: EngineOf) -> np.ndarray:
    """FCL's normal backlash less the exact engine's [mm], (densities, trials)."""
    model = model_from_scene(load_scene(SCENES / scene))
    mesh, kind = model.meshes[0], next(m.kind for m in model.measures if m.kind.quantity == "normal_backlash")
    block = drawn_trials(model, 6, 0, trials)
    angle, made = block.positions[mesh.name], build(model, block.deviations)
    exact = read_backlash(kind, mesh, ExactEngine(model).read(made, mesh, kind.reading, angle))
    errors = []
    for steps in densities:
        meshing = Meshing(engine_of(model, steps), model, mesh, made, kind.reading)
        errors.append(measure_backlash(kind, meshing, meshing.seat(angle)) - exact)
    return np.array(errors)


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["spur_pair.yaml", "bevel_pair.yaml"])
def test_fcl_converges_to_the_exact_engine_with_the_square_of_the_step(scene: str, engine_of: EngineOf) -> None:
    densities = (60, 120, 240, 480)
    errors = errors_of_fcl(scene, 400, densities, engine_of)
    rms = np.sqrt((errors**2).mean(axis=1))  # seen: 0.070, 0.018, 0.0047, 0.0012 um; bevel 0.22, 0.054, 0.012, 0.0023
    assert -np.polyfit(np.log(densities[:3]), np.log(rms[:3]), 1)[0] == pytest.approx(2.0, abs=0.2)
    assert rms[3] <= rms[2] / 4 * 1.1 + FCL_NOISE
    # strips lie inside the teeth: each single trial reads too much
    assert errors.min() >= -FCL_NOISE
    assert (errors.max(axis=1) <= 4 * rms).all()


# extremes over positions ------------------------------------------------------------------------------------


def extreme(take: Take, over: Over, count: int, turns: int = 1) -> Measure:
    kind = Backlash("normal_backlash", "gear pair", "wheel")
    return Measure("extreme", kind, Positions(over, turns, count), take)


def sine(count: int, phase: np.ndarray) -> np.ndarray:
    return np.sin(2 * np.pi * np.arange(count) / count + phase[:, None])


def test_extremes_of_a_sine_are_off_by_1e_4_at_24_positions_and_by_order_4() -> None:
    phase = np.linspace(0.0, 2 * np.pi, 1001)
    worst = []
    for count in (12, 24, 48):
        values = sine(count, phase)
        highest, lowest = (taken(extreme(take, "long_period", count), values) for take in ("max", "min"))
        worst.append(max(np.abs(highest - 1).max(), np.abs(lowest + 1).max()))
        assert taken(extreme("range", "long_period", count), values) == pytest.approx(highest - lowest, rel=1e-15)
    assert worst[1] <= LARGEST_PARABOLA_ERROR
    assert np.log2(worst[0] / worst[1]) == pytest.approx(4.0, abs=0.15)
    assert np.log2(worst[1] / worst[2]) == pytest.approx(4.0, abs=0.05)


def dense_extremes(model: Model, block: Trials, turns: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Smallest and largest exact backlash of each trial over so many turns of the driver, from 0, ends included."""
    angles = np.linspace(0.0, 2 * np.pi * turns, count)
    repeated = Trials(np.repeat(block.deviations, count, axis=0), {})
    exact = exact_of(model, repeated, np.tile(angles, len(block))).reshape(-1, count)
    return exact.min(axis=1), exact.max(axis=1)


@pytest.mark.parametrize(
    ("over", "turns", "scan"), [("turn", 1, 721), pytest.param("long_period", 55, 4000, marks=pytest.mark.slow)]
)
def test_extremes_over_positions_agree_with_a_dense_scan(
    over: Over, turns: int, scan: int, paper_model: Model, engine_of: EngineOf
) -> None:
    takes: tuple[Take, ...] = ("min", "max", "range")
    measures = tuple(replace(extreme(take, over, 24 * turns, turns), name=take) for take in takes)
    model = replace(paper_model, measures=measures)
    block = drawn_trials(model, 9, 0, 12)
    lowest, highest = dense_extremes(model, block, turns, scan)
    columns = gear_columns(model, engine_of(model), block)
    # 0.12 um of the strips or 0.05 um of squares in the stack-up; the parabola's 1e-4 is under 0.01 um of 30 um
    for take, expected in (("min", lowest), ("max", highest), ("range", highest - lowest)):
        assert np.abs(columns[f"geometric:{take}"] - 1000 * expected).max() <= 0.13, take
        assert np.abs(columns[f"analytic:{take}"] - 1000 * expected).max() <= 0.06, take


def test_a_curve_is_the_values_at_its_positions(paper_model: Model, engine_of: EngineOf) -> None:
    curve = extreme("curve", "turn", 8)
    model = replace(paper_model, measures=(curve,))
    block, engine = drawn_trials(model, 2, 0, 3), engine_of(model)
    values = geometric_values(curve, seated(model, engine, block))
    assert np.array_equal(taken(curve, values), values)
    for k, angle in enumerate(known(curve.positions.fixed)):
        exact = exact_of(model, block, np.full(3, angle))
        assert np.abs(values[:, k] - exact).max() < 0.12e-3
