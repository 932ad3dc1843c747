"""Load paths that part and join in any way, and shafts in the midst of them, against HiGHS.

What a train leaves free is a linear programme: shafts turn by small angles, each link lets its driven shaft differ by
its play from what its teeth or its data sheet ask for, one shaft is held and another one is turned to its ends.
"""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from gear_trials import drawn_trials
from numpy.typing import NDArray
from places import SCENES
from scene_texts import scene_of
from scipy.optimize import linprog

from tol3d import Overrides, SceneError, load_scene, run_scene
from tol3d.gearing.engines.gaps import exact_engine
from tol3d.gearing.meshing.seats import geometric_values, seated
from tol3d.gearing.methods.analytic import analytic_play
from tol3d.gearing.model import LostMotion, model_from_scene
from tol3d.gearing.model.measure import ParallelStage
from tol3d.gearing.model.mesh_measures import reader_like
from tol3d.gearing.model.networks import Network, network_path
from tol3d.gearing.model.train_measures import network_stage
from tol3d.gearing.slopes.sensitivity import sensitivities
from tol3d.study.system.trials import Trials

Array = NDArray[np.float64]
SPLIT = (SCENES / "split_train.yaml").read_text("utf-8")
ARCMIN = 10800 / math.pi  # in a radian
SAME = 1e-12  # rad


@dataclass(frozen=True)
class Row:
    """One link: lower <= weights . angles <= upper."""

    weights: Mapping[str, float]
    lower: float
    upper: float


def free(rows: Sequence[Row], shafts: Sequence[str], read: str, held: str) -> float | None:
    """Free turn by HiGHS [rad]; None where the links bind."""
    matrix = np.array([[row.weights.get(shaft, 0.0) for shaft in shafts] for row in rows])
    both = np.vstack([matrix, -matrix])
    room = np.array([row.upper for row in rows] + [-row.lower for row in rows])
    bounds = [(0.0, 0.0) if shaft == held else (None, None) for shaft in shafts]
    turn = np.array([float(shaft == read) for shaft in shafts])
    ends = []
    for sense in (1.0, -1.0):
        solved = linprog(sense * turn, A_ub=both, b_ub=1e3 * room, bounds=bounds, method="highs")
        if solved.status == 2:
            return None
        assert solved.status == 0
        ends.append(sense * solved.fun * 1e-3)
    return ends[1] - ends[0]


# reducers between shafts, at random ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Random:
    """A random scene of reducers, and what is held and read."""

    text: str
    shafts: Sequence[str]
    links: Sequence[tuple[str, str, float]]  # driver, driven, ratio
    read: str
    held: str


def random_scene(rng: np.random.Generator) -> Random:
    """Every shaft is driven by one before it, some by several; ratios are powers of two, so that they fit."""
    count = int(rng.integers(4, 8))
    shafts = [f"s{k}" for k in range(count)]
    turns = [float(rng.choice([-1, 1]) * 2.0 ** rng.integers(-2, 3)) for _ in shafts]
    pairs = [(int(rng.integers(k)), k) for k in range(1, count)]
    pairs += [tuple(sorted(rng.choice(count, 2, replace=False).tolist())) for _ in range(int(rng.integers(2, 5)))]
    links = [(shafts[i], shafts[k], turns[i] / turns[k]) for i, k in pairs]
    read, held = (shafts[k] for k in rng.choice(count, 2, replace=False))
    output = shafts[-1]
    lines = ["scene: random", "parts:", *(f"  {shaft}: {{kind: shaft}}" for shaft in shafts), "tolerances:"]
    law = "{kind: uniform, lower: 1 arcmin, upper: 9 arcmin}"
    lines += [f"  play {n}: {{kind: reducer_backlash, of: link {n}, distribution: {law}}}" for n in range(len(links))]
    lines.append("moves:")
    for n, (driver, driven, ratio) in enumerate(links):
        lines.append(f"  link {n}: {{kind: reducer, driver: {driver}, driven: {driven}, ratio: {ratio}}}")
    lines.append(f"  train: {{kind: train, driven: s0, output: {output}, held: {held}}}")
    lines += ["measures:", f"  lost motion: {{kind: lost_motion, of: train, shaft: {read}}}"]
    return Random("\n".join(lines) + "\n", shafts, links, read, held)


@pytest.mark.parametrize("seed", [*range(15), *(pytest.param(k, marks=pytest.mark.slow) for k in range(15, 60))])
def test_any_reducers_leave_what_the_programme_says(seed: int, tmp_path: Path) -> None:
    own = random_scene(np.random.default_rng(seed))
    model = model_from_scene(scene_of(own.text, tmp_path))
    trials = drawn_trials(model, 4, 0, 3)
    found = analytic_play(model, model.measures[0], trials).free()[:, 0]
    for k, plays in enumerate(trials.deviations):
        rows = [
            Row({driven: 1.0, driver: -1 / ratio}, -play / 2, play / 2)
            for (driver, driven, ratio), play in zip(own.links, plays, strict=True)
        ]
        assert found[k] == pytest.approx(free(rows, own.shafts, own.read, own.held), rel=0, abs=SAME)


@pytest.mark.slow
def test_random_scenes_have_networks_and_closed_ones(tmp_path: Path) -> None:
    """Else the test above would say little."""
    kinds = []
    for seed in range(60):
        own = random_scene(np.random.default_rng(seed))
        kind = model_from_scene(scene_of(own.text, tmp_path)).measures[0].kind
        assert isinstance(kind, LostMotion)
        parallel = [stage for stage in kind.stages if isinstance(stage, ParallelStage)]
        kinds.append("net" if any(stage.loops for stage in parallel) else "closed" if parallel else "series")
    assert min(kinds.count(kind) for kind in ("net", "closed", "series")) >= 3


# gears ---------------------------------------------------------------------------------------------------------------

RADII = {"sun": 18.0, "left wheel": 42.0, "right wheel": 42.0, "left pinion": 19.0, "right pinion": 19.0, "bull": 41.0}
MESHES = (
    ("input", "sun", "left", "left wheel"),
    ("input", "sun", "right", "right wheel"),
    ("left", "left pinion", "output", "bull"),
    ("right", "right pinion", "output", "bull"),
)
SHAFTS = ("input", "left", "right", "output")


def split_text(*changes: tuple[str, str], thickness_alone: bool = False) -> str:
    text = SPLIT
    if thickness_alone:
        start, end = text.index("tolerances:"), text.index("moves:")
        entries = re.findall(r"^  [a-z ]+:.*?(?=^  [a-z]|^$)", text[start:end], re.DOTALL | re.MULTILINE)
        kept = [entry for entry in entries if re.search("kind: (tooth_thickness|clocking)", entry)]
        assert len(kept) == 8
        text = text[:start] + "tolerances:\n" + "".join(kept) + "\n" + text[end:]
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


READ = {
    "in the midst": ("of: stage, upper_limit: 13 arcmin", "of: stage, shaft: left"),
    "held in the midst": ("output: output, ratio: 5.0351", "output: output, held: right"),
}


def by_programme(columns: Mapping[str, Array], trial: int, read: str, held: str) -> float | None:
    """Arcs along the lines of action: r_b (turn + clocking) of both gears within half the gap."""

    def um(name: str) -> float:
        return float(columns[f"{name} tooth thickness [um]"][trial]) * 1e-3

    sits = {f"{side} pinion": float(columns[f"{side} clocking [arcmin]"][trial]) / ARCMIN for side in ("left", "right")}
    rows = []
    for driver, first, driven, last in MESHES:
        half = -(um(first) + um(last)) / 2
        middle = -sum(RADII[gear] * sits.get(gear, 0.0) for gear in (first, last))
        rows.append(Row({driver: RADII[first], driven: RADII[last]}, middle - half, middle + half))
    return free(rows, SHAFTS, read, held)


@pytest.mark.parametrize(
    ("what", "read", "held"), [("in the midst", "left", "input"), ("held in the midst", "output", "right")]
)
def test_a_shaft_between_load_paths_is_held_by_all_of_them(what: str, read: str, held: str, tmp_path: Path) -> None:
    """Thick teeth and clocking alone, which both methods take as they are."""
    (tmp_path / "scene.yaml").write_text(split_text(READ[what], thickness_alone=True), "utf-8")
    run = run_scene(tmp_path / "scene.yaml", overrides=Overrides(trials=60, witness=0), out=tmp_path / "run")
    columns = run.columns()
    for trial in range(60):
        wanted = by_programme(columns, trial, read, held)
        assert wanted is not None
        for method, off in (("analytic", 1e-9), ("geometric", 1e-6)):
            assert columns[f"{method}:lost motion"][trial] == pytest.approx(wanted * ARCMIN, rel=0, abs=off)


def test_walks_leave_what_the_closed_method_does_where_that_holds(tmp_path: Path) -> None:
    """The split train at its output, all tolerances, on the analytic method."""
    model = model_from_scene(load_scene(SCENES / "split_train.yaml"))
    measure = next(own for own in model.measures if own.name == "lost motion")
    assert isinstance(measure.kind, LostMotion)
    (element,) = network_path(model.layout.links, "input", "output")
    assert isinstance(element, Network)
    assert (len(element.walks), len(element.loops)) == (2, 1)
    stage = network_stage(model, element, "output", reader_like(measure.kind))
    trials = drawn_trials(model, 4, 0, 500)
    closed = analytic_play(model, measure, trials).free()
    other = replace(measure, kind=replace(measure.kind, stages=(stage,)))
    np.testing.assert_allclose(analytic_play(model, other, trials).free(), closed, rtol=0, atol=SAME)


@pytest.mark.slow
def test_both_methods_agree_in_the_midst_and_what_differs_is_explained(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(split_text(READ["in the midst"]), "utf-8")
    run = run_scene(tmp_path / "scene.yaml", overrides=Overrides(trials=300, witness=0), out=tmp_path / "run")
    agreement = run.summary["measures"]["lost motion"]["agreement"]
    assert agreement["rms_difference"] < 0.01  # arcmin, of 13
    assert agreement["explanation"]["faults"] == []
    assert run.summary["trains"]["stage"]["stages"][0]["ways"] == 2


@pytest.mark.slow
def test_derivatives_in_the_midst_are_those_of_two_simulations(tmp_path: Path) -> None:
    model = model_from_scene(scene_of(split_text(READ["in the midst"]), tmp_path))
    measure = next(own for own in model.measures if own.name == "lost motion")
    trials, engine, step = drawn_trials(model, 4, 0, 8), exact_engine(model), 1e-5
    found = sensitivities(model, engine, trials, measure)
    alone = replace(model, measures=(measure,))
    differences = np.empty_like(found)
    for k in range(model.component_count):
        both = []
        for sign in (1.0, -1.0):
            moved = trials.deviations.copy()
            moved[:, k] += sign * step
            seats = seated(alone, engine, Trials(moved, trials.positions))
            both.append(geometric_values(measure, seats)[:, 0])
        differences[:, k] = (both[0] - both[1]) / (2 * step)
    np.testing.assert_allclose(found, differences, rtol=0, atol=2e-5)  # rad/mm of up to 0.05; contacts end at 1e-8 mm


@pytest.mark.slow
def test_a_loop_that_cannot_be_closed_binds_whatever_is_read(tmp_path: Path) -> None:
    """One pinion 40 arcmin ahead of its wheel: more than the loop leaves, which is twice the play of some 12."""
    text = split_text(READ["in the midst"]).replace(
        "lower: 1 arcmin, upper: 9 arcmin", "lower: -200 arcmin, upper: 200 arcmin"
    )
    (tmp_path / "scene.yaml").write_text(text, "utf-8")
    run = run_scene(tmp_path / "scene.yaml", overrides=Overrides(trials=200, witness=0), out=tmp_path / "run")
    counts = run.summary["measures"]["lost motion"]["status"]
    columns, jammed = run.columns(), np.asarray(run.frame()["status:lost motion"]) == "interferes"
    assert 50 < jammed.sum() == counts["interferes"] < 150
    assert (columns["geometric:lost motion"][jammed] < 0.0).all()
    assert (columns["geometric:lost motion"][~jammed] > 0.0).all()


def test_too_many_load_paths_are_refused(tmp_path: Path) -> None:
    """Six pairs of parallel reducers that share a bypass: 13 choose ... more than two thousand walks."""
    shafts = [f"s{k}" for k in range(13)]
    lines = ["scene: ladder", "parts:", *(f"  {shaft}: {{kind: shaft}}" for shaft in shafts), "moves:"]
    for k, shaft in enumerate(shafts):
        for other in shafts[k + 1 :]:
            lines.append(f"  {shaft} {other}: {{kind: reducer, driver: {shaft}, driven: {other}, ratio: 1}}")
    lines += ["  train: {kind: train, driven: s0, output: s12}", "measures:", "  lost: {kind: lost_motion, of: train}"]
    with pytest.raises(SceneError, match="more than 2000 load paths lead to 's12'"):
        model_from_scene(scene_of("\n".join(lines) + "\n", tmp_path))
