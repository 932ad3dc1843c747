"""Studies of assemblies: workers, samplers, replays, shares, failed builds, as of any system."""

import math
from pathlib import Path

import numpy as np
import pytest
from assembly.datum_plate import SIGMAS, covariance, plate
from assembly_trials import constant, normal
from places import SCENES

from tol3d.simulate import Execution, Overrides, load, replay, run_scene, simulation_of
from tol3d.study.runs.run import Run
from tol3d.study.trials.draws import drawn

COLUMNS = ("geometric:position", "analytic:position", "status:position", "hole x [um]")


def ran(folder: Path, name: str, text: str, trials: int = 3_000, workers: int = 1, **study: object) -> Run:
    scene = folder / f"{name}.yaml"
    scene.write_text(text, encoding="utf-8")
    overrides = Overrides(trials=trials, **study)  # type: ignore[arg-type]  # seed, sampler: as the study has them
    return run_scene(scene, overrides=overrides, out=folder / name, execution=Execution(workers=workers))


@pytest.fixture(scope="module")
def normals() -> str:
    return plate({name: normal(own) for name, own in SIGMAS.items()})


def test_workers_change_no_bit(tmp_path: Path, normals: str) -> None:
    alone, together = (ran(tmp_path, f"by {workers}", normals, workers=workers) for workers in (1, 2))
    for name in COLUMNS:
        assert np.array_equal(alone.columns(name)[name], together.columns(name)[name])
    assert alone.summary["measures"] == together.summary["measures"]


def test_a_trial_can_be_replayed(tmp_path: Path, normals: str) -> None:
    run = ran(tmp_path, "run", normals)
    for trial in (0, 17, 2999):
        again = replay(run, trial)
        assert again.geometric["position"] == run.columns("geometric:position")["geometric:position"][trial]
        assert again.analytic["position"] == run.columns("analytic:position")["analytic:position"][trial]


def test_sobol_points_know_the_sigma_sooner(tmp_path: Path, normals: str) -> None:
    text = normals.replace(
        "measures:\n", "measures:\n  across: {kind: gap, from: plate.b1, to: plate.hole, along: [0, 1, 0]}\n"
    )
    sigma = math.hypot(SIGMAS["b1"], SIGMAS["ey"])
    off = {}
    for sampler in ("monte_carlo", "sobol"):
        run = ran(tmp_path, sampler, text, trials=4096, sampler=sampler)
        off[sampler] = abs(run.summary["measures"]["across"]["geometric"]["sigma"] / (1e3 * sigma) - 1)
    assert off["sobol"] < 2e-3 < 4 / math.sqrt(2 * 4096)


def test_shares_of_what_takes_a_size_are_its_total_effects(tmp_path: Path, normals: str) -> None:
    """Of position = 2 |(dx, dy)|: what drawing one deviation again changes, by 200 000 pairs of numpy alone."""
    run = ran(tmp_path, "run", normals, trials=40_000)
    found = {own["name"]: own for own in run.summary["measures"]["position"]["contributors"]}
    rows = np.array([[-1 / 16, 1 / 16, -1, 1, 0], [-0.1875, -0.8125, 0, 0, 1]])
    sigmas = np.array(list(SIGMAS.values()))[:, None]
    assert np.allclose(rows * sigmas.T**2 @ rows.T, covariance())
    generator = np.random.default_rng(11)
    plain, other = (sigmas * generator.standard_normal((5, 200_000)) for _ in range(2))
    size = np.hypot(*rows @ plain)
    steps = [size - np.hypot(*rows @ _with_row(plain, other, k)) for k in range(5)]
    effects = [50 * np.mean(own**2) / np.var(size) for own in steps]
    names = ("b1 off", "b2 off", "c off", "hole x", "hole y")
    for name, own in zip(names, effects, strict=True):
        assert abs(found[name]["geometric_percent"] - own) < 5 * found[name]["geometric_percent_se"] + 0.2, name
        assert found[name]["geometric_percent_se"] < 5.0


def _with_row(plain: np.ndarray, other: np.ndarray, k: int) -> np.ndarray:
    return np.where(np.arange(len(plain))[:, None] == k, other, plain)


def test_constants_build_and_have_no_shares(tmp_path: Path) -> None:
    run = ran(tmp_path, "run", plate({name: constant(0.01) for name in SIGMAS}), trials=100)
    found = run.summary["measures"]["position"]
    assert found["geometric"]["sigma"] == pytest.approx(0.0, abs=1e-9)


def test_bits_of_a_trial_do_not_depend_on_its_neighbours() -> None:
    simulation = simulation_of(load(SCENES / "door.yaml"), Overrides())
    many = drawn(simulation, 0, 300)
    method = simulation.system.method("exact", simulation.system.materials("exact"))
    whole = method.answers(many, simulation.system.measures).values
    for trial in (0, 17, 299):
        alone = method.answers(drawn(simulation, trial, 1), simulation.system.measures).values
        assert all(np.array_equal(own[0], whole[name][trial]) for name, own in alone.items())


def test_shares_do_not_depend_on_the_order_of_measures(tmp_path: Path) -> None:
    """Sizes are regressed on squares, linear measures on the deviations: each by its own rows."""
    position = "  position: {kind: inspected_position, of: plate.hole}\n"
    across = "  across: {kind: gap, from: plate.b1, to: plate.hole, along: [1, 0, 0]}\n"
    text = plate({name: constant(0.0) for name in SIGMAS})
    head = text[: text.index("tolerances:")]
    zone = "  zone: {kind: position, of: plate.hole, zone: {diameter: 0.2 mm}, law: {kind: uniform}}\n"
    shares = {}
    for order, measures in (("first", position + across), ("last", across + position)):
        made = f"{head}tolerances:\n{zone}moves:\n  machine: {{kind: fix, part: plate}}\nmeasures:\n{measures}"
        found = ran(tmp_path, order, made).summary["measures"]
        shares[order] = {name: own["contributors"][0]["geometric_percent"] for name, own in found.items()}
    assert shares["first"] == pytest.approx(shares["last"], abs=1e-9)
    assert shares["first"]["across"] == pytest.approx(100, abs=1e-6)
    assert shares["first"]["position"] > 50


def test_a_measure_that_nothing_moves_is_told_of_once(tmp_path: Path) -> None:
    text = plate({name: constant(0.01) for name in SIGMAS})
    text += "  still: {kind: point_plane, from: plate.floor, to: plate.b1}\n"
    assert ran(tmp_path, "run", text).summary["warnings"] == ["still: no tolerance acts on it"]
