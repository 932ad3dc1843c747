"""Scenes of very many tolerances or teeth: what they take goes with their number, not with its square."""

import math
import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gear_trials import drawn_trials, simulated
from places import SPUR_PAIR
from scene_texts import written

from tol3d import load_scene
from tol3d.cad.solids import spur_cad
from tol3d.cad.solids.spur_cad import sample_flanks
from tol3d.gearing.builds.build import build
from tol3d.gearing.engines.exact.compiled_displacements import compiled_displacements
from tol3d.gearing.model import Model, model_from_scene
from tol3d.gearing.system import GearSystem
from tol3d.gears import SpurGear
from tol3d.simulate import Execution, run_scene
from tol3d.statistics.estimates import IndependentSums, independent_shares
from tol3d.statistics.estimates.variance_shares import plain_products
from tol3d.statistics.samplers.replicates import SamplerKind
from tol3d.study.effects.regressors import regressor_set
from tol3d.study.results.task import Task, block_trials, task_of
from tol3d.study.results.versions import installed_versions
from tol3d.study.runs.checkpoint import Checkpoint
from tol3d.study.system.outcome import ANALYTIC, GEOMETRIC, METHODS
from tol3d.study.tallies.regression import target_sums
from tol3d.study.tallies.tally import PILOT_TRIALS, Tally, grids_of
from tol3d.study.trials.draws import drawn, drawn_ones
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study

HEAD = """scene: many
parts:
  pinion: {kind: spur_gear, teeth: 28, module: 2.5 mm, pressure_angle: 20 deg, face_width: 20 mm}
  wheel:  {kind: spur_gear, teeth: 110, module: 2.5 mm, pressure_angle: 20 deg, face_width: 20 mm}
moves: {gear pair: {kind: mesh, driver: pinion, driven: wheel, centre_distance: 172.5 mm, working_flank: right}}
measures: {normal backlash: {kind: normal_backlash, of: gear pair}}
tolerances:
  thick: {kind: tooth_thickness, of: pinion, distribution: {kind: normal, lower: -90 um, upper: -79 um}}
"""
SMALL = "{kind: centre_distance, of: gear pair, distribution: {kind: normal, lower: -0.2 um, upper: 0.2 um}}"
LARGE = "{kind: centre_distance, of: gear pair, distribution: {kind: normal, lower: -3 um, upper: 3 um}}"
TURNING = "{kind: eccentricity, of: wheel, distribution: {kind: rayleigh, scale: 0.1 um}}"


def scene_of(folder: Path, tolerances: int, trials: int = 1000) -> Path:
    """A pair with so many tolerances more; each hundredth moves it most, each third is eccentric."""
    kinds = (LARGE if k % 100 == 7 else TURNING if k % 3 == 0 else SMALL for k in range(tolerances))
    lines = "".join(f"  t{k}: {kind}\n" for k, kind in enumerate(kinds))
    path = folder / f"many {tolerances}.yaml"
    path.write_text(f"{HEAD}{lines}study: {{trials: {trials}, seed: 1, engine: exact, witness: 0}}\n", "utf-8")
    return path


def model_of(folder: Path, tolerances: int) -> Model:
    return model_from_scene(load_scene(scene_of(folder, tolerances)))


@pytest.mark.slow
def test_a_block_holds_no_more_draws_however_many_a_trial_has(tmp_path: Path, paper_model: Model) -> None:
    assert block_trials(simulated(paper_model)) == 65_536  # ordinary scenes keep theirs, and with them their bits
    for tolerances in (200, 1500):
        model = model_of(tmp_path, tolerances)
        assert block_trials(simulated(model)) * model.component_count <= 2**22
        assert block_trials(simulated(model)) * model.component_count > 2**20


@pytest.mark.slow
def test_statistics_of_many_tolerances_grow_with_their_number(tmp_path: Path) -> None:
    sizes = {}
    for tolerances in (300, 1500):
        model = model_of(tmp_path, tolerances)
        simulation = simulated(model)
        pilot = Task(simulation, None, {}, str(tolerances), False, installed_versions(simulation.requires))
        grids = grids_of(simulation.system, pilot.columns(0, PILOT_TRIALS))
        columns = pilot.columns(0, 200)
        Tally.of(simulation, grids, columns)  # what is found once, and kept
        tracemalloc.start()
        kept = Tally.of(simulation, grids, columns)
        sizes[tolerances] = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert kept.measures["normal backlash"].geometric_regressors is not None
    assert sizes[1500] < 6 * sizes[300]  # products of all pairs would be 25 times as many


@pytest.mark.slow
def test_each_of_very_many_contributors_has_its_share(tmp_path: Path) -> None:
    run = run_scene(scene_of(tmp_path, 320, trials=2000), out=tmp_path / "run", execution=Execution(keep_trials=False))
    model = model_of(tmp_path, 320)
    measure = model.measures[0]
    system = GearSystem(model)
    assert len(system.acting(measure)) == 321
    told = {each["name"]: each for each in run.summary["measures"]["normal backlash"]["contributors"]}
    assert len(told) == 321
    # by hand: thickness 11 um / 6 cos 20 deg; centre distances 6 um / 6 and 0.4 um / 6, times 2 sin 20 deg
    thick, large, small = ((11 / 6 * math.cos(0.349066)) ** 2, (2 * 0.34202) ** 2, (0.4 / 6 * 2 * 0.34202) ** 2)
    turning = (2 * 0.34202 * 0.1) ** 2
    counts = {"turning": sum(k % 3 == 0 and k % 100 != 7 for k in range(320))}
    counts["small"] = 320 - 4 - counts["turning"]
    total = thick + 4 * large + counts["small"] * small + counts["turning"] * turning
    for name, own in (("thick", thick), ("t107", large)):
        assert told[name]["analytic_percent"] == pytest.approx(100 * own / total, rel=0.01)
    off = []
    for name, each in told.items():
        kind = thick if name == "thick" else large if name in {"t7", "t107", "t207", "t307"} else None
        own = kind or (turning if int(name[1:]) % 3 == 0 else small)
        off.append((each["geometric_percent"] - 100 * own / total) / each["geometric_percent_se"])
    assert max(map(abs, off)) < 5.0  # standard errors of 2000 trials
    # no bias adds up: each of 642 regressors explains 1 / 2000 by chance, in all 32 %
    assert abs(sum(each["geometric_percent"] for each in told.values()) - 100.0) < 5 * 100 * math.sqrt(2 * 642) / 2000
    assert any("321 tolerances act" in warning for warning in run.summary["warnings"])


def test_few_contributors_are_all_regressed_on(paper_model: Model) -> None:
    measure = paper_model.measures[0]
    system = GearSystem(paper_model)
    own = regressor_set(Simulation(system, Study()), measure).of(measure)
    assert own.names == tuple(each.name for each in system.acting(measure))
    assert own.picked is None


def test_displacements_found_one_contributor_at_a_time_build_as_build_does(tmp_path: Path) -> None:
    for model in (model_of(tmp_path, 20), model_from_scene(load_scene(SPUR_PAIR.with_name("three_stage_train.yaml")))):
        block = drawn_trials(model, 3, 0, 50)
        made, expected = compiled_displacements(model).build(block.deviations), build(model, block.deviations)
        for name, values in vars(expected).items():
            if values is None:  # what these gears do not have
                assert vars(made)[name] is None, name
                continue
            assert np.abs(vars(made)[name] - values).max() < 1e-12, name


@pytest.mark.parametrize(
    "gear",
    [
        SpurGear(28, 2.5, math.radians(20), 20.0, bore=20.0),
        SpurGear(42, 2.5, math.radians(20), 15.0, profile_shift=0.2),
        SpurGear(12, 2.5, math.radians(25), 20.0, profile_shift=0.6),
    ],
    ids=["from the base circle", "from the fillet", "full round"],
)
def test_strips_of_one_tooth_alone_are_those_of_the_whole_gear(gear: SpurGear, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = sample_flanks(gear, 30)
    monkeypatch.setattr(spur_cad, "MOST_TEETH", 0)
    alone = sample_flanks(gear, 30)
    assert whole.keys() == alone.keys()
    assert all(np.array_equal(whole[name], alone[name]) for name in whole)


def test_a_gear_of_ten_thousand_teeth_has_a_witness(tmp_path: Path) -> None:
    """Built whole it took five minutes and some gigabytes; a clock or a meter of memory is not asked, a tooth is."""
    text = HEAD.replace("teeth: 110", "teeth: 10000").replace("172.5 mm", "12535 mm")
    path = written(f"{text}study: {{trials: 50, seed: 1, engine: exact, witness: 5}}\n", tmp_path)
    run = run_scene(path, out=tmp_path / "run")
    own = run.summary["witness"]["measures"]["normal backlash"]
    assert 0 < own["max_abs_difference"] <= own["expected_at_most"] + own["allowance"]
    assert own["compared"] == 5


def test_statistics_of_very_many_contributors_are_kept_and_gone_on_from(tmp_path: Path) -> None:
    simulation = simulated(model_of(tmp_path, 140))
    task = task_of(simulation, "many", keep_trials=False)
    first, second = (task.statistics(at, task.columns(at, 100)) for at in (0, 100))
    checkpoint = Checkpoint(tmp_path / "checkpoint", Tally)
    checkpoint.write(1, first)
    blocks, again = checkpoint.read() or (0, None)
    assert blocks == 1
    assert again is not None
    expected, found = (own.merge(second).measures["normal backlash"].geometric_regressors for own in (first, again))
    assert isinstance(expected, IndependentSums)
    assert isinstance(found, IndependentSums)
    for mine, its in zip(independent_shares(found)[:2], independent_shares(expected)[:2], strict=True):
        assert np.array_equal(mine, its)


@pytest.mark.parametrize(
    ("sampler", "tolerances"), [("monte_carlo", 3), ("monte_carlo", 300), ("sobol", 3), ("latin_hypercube", 3)]
)
def test_trials_drawn_wherever_they_are_have_the_bits_of_those_drawn_in_a_row(
    sampler: SamplerKind, tolerances: int, tmp_path: Path
) -> None:
    simulation = simulated(model_of(tmp_path, tolerances))
    simulation = replace(simulation, study=replace(simulation.study, sampler=sampler, trials=1024, replicates=16))
    wanted = [700, 3, 3, 1023, 0]
    row, ones = drawn(simulation, 0, 1024), drawn_ones(simulation, wanted)
    assert np.array_equal(ones.deviations, row.deviations[wanted])
    for name, values in row.positions.items():
        assert np.array_equal(ones.positions[name], values[wanted])


def test_measures_that_lack_trials_are_regressed_on_those_that_they_have(tmp_path: Path) -> None:
    """A build fails where a normal value is beyond its 5 %: the sums are those of a block of the others alone."""
    simulation = simulated(model_of(tmp_path, 140))
    system, random = simulation.system, np.random.default_rng(1)
    columns = task_of(simulation, "lacking", keep_trials=False).columns(0, 200)
    good = random.random(200) > 0.05
    measures, name = system.measures, system.measures[0].name
    values = {(method, own.name): columns[f"{method}:{own.name}"].copy() for own in measures for method in METHODS}
    values[GEOMETRIC, name][~good] = np.nan
    found, _ = target_sums(Simulation(system, Study()), columns, values, plain_products)
    others = {key: own[good] for key, own in columns.items()}
    expected, _ = target_sums(
        Simulation(system, Study()), others, {key: own[good] for key, own in values.items()}, plain_products
    )
    mine, its = found[GEOMETRIC, name], expected[GEOMETRIC, name]
    assert isinstance(mine, IndependentSums)
    assert isinstance(its, IndependentSums)
    assert mine.count == its.count == np.count_nonzero(good)
    assert mine.across == pytest.approx(its.across, rel=1e-9, abs=1e-9)
    assert found[ANALYTIC, name].count == 200
