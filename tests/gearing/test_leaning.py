"""Closed form, shares and coefficients of a shaft that leans between its two bearings, without a trial.

The oracle is the shaft by hand (oracles/train.py): a straight line through two points that its bearings move, what it
opens in each mesh and what its lean closes at the tighter end of a face, integrated over the clearances on a grid.
"""

import math
import random
import re
from pathlib import Path

import numpy as np
import pytest
from gear_trials import drawn_trials, form_of, gear_columns, measure_of
from of_kind import known
from oracles.train import at_height, lean, seen_backward, turned
from scene_texts import scene_of

import tol3d
from tol3d.gearing.engines.gaps import exact_engine
from tol3d.gearing.methods.analytic import analytic_values
from tol3d.gearing.model import Model, Reading, model_from_scene
from tol3d.gearing.slopes.coefficients import coefficients_of
from tol3d.gearing.stack_up import stack_of
from tol3d.gearing.stack_up.leaning import leaning_shares
from tol3d.gearing.system import GearSystem
from tol3d.statistics.estimates.variance_shares import RegressorSums, shares
from tol3d.study.effects.regressors import regressor_groups, regressors
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study

ALPHA = math.radians(20.0)
HEIGHTS = (-20.0, 90.0)  # mm; of the bearings
GRID = 1500  # points a clearance; the midpoint rule is 1 / GRID**2 of a sigma off, at a kink a few of them
NET = 1e-3  # of sigma: the rule of leaning.py on these scenes

SCENE = """
scene: two stages
parts:
  a: {kind: spur_gear, teeth: 20, module: 2 mm, face_width: 16 mm}
  b: {kind: spur_gear, teeth: 30, module: 2 mm, face_width: 16 mm}
  c: {kind: spur_gear, teeth: 25, module: 2 mm, face_width: 16 mm}
  d: {kind: spur_gear, teeth: 40, module: 2 mm, face_width: 12 mm}
  middle: {kind: shaft, carries: {b: {at: 20 mm}, c: {at: 60 mm, facing: backward}}}
  low: {kind: bearing, shaft: middle, at: -20 mm}
  high: {kind: bearing, shaft: middle, at: 90 mm}
tolerances:
  a thickness: {kind: tooth_thickness, of: a, distribution: {kind: normal, lower: -60 um, upper: -40 um}}
  d thickness: {kind: tooth_thickness, of: d, distribution: {kind: normal, lower: -60 um, upper: -40 um}}
  d eccentricity: {kind: eccentricity, of: d, distribution: {kind: rayleigh, scale: 3 um}}
  low clearance:
    {kind: bearing_clearance, of: low, direction: LOW, distribution: {kind: uniform, lower: 4 um, upper: 28 um}}
  high clearance:
    {kind: bearing_clearance, of: high, direction: HIGH, distribution: {kind: uniform, lower: 2 um, upper: 44 um}}
moves:
  first: {kind: mesh, driver: a, driven: b, centre_distance: 50.1 mm}
  second: {kind: mesh, driver: c, driven: d, centre_distance: 65.1 mm, azimuth: 40 deg}
  train: {kind: train, driven: a, output: d}
measures:
  first backlash: {kind: normal_backlash, of: first}
  lost motion: {kind: lost_motion, of: train}
"""
DIRECTIONS = {"alike": (70, 70), "apart": (70, 215), "across": (-30, 75)}  # alike: the lean changes its sign
MORE = """
  tilt: {kind: axis_in_plane, of: first, distribution: {kind: normal, lower: -20 um, upper: 14 um}}
  skew: {kind: axis_out_of_plane, of: second, distribution: {kind: triangular, lower: -20 um, mode: 3 um, upper: 6 um}}
"""


def model_of(folder: Path, low: str, high: str, more: str = "") -> Model:
    path = folder / "scene.yaml"
    text = SCENE.replace("LOW", low).replace("HIGH", high).replace("moves:", f"{more.strip(chr(10))}\nmoves:")
    path.write_text(text.replace("\n\n", "\n"), encoding="utf-8")
    return model_from_scene(tol3d.load_scene(path))


def fixed(folder: Path, name: str) -> Model:
    low, high = DIRECTIONS[name]
    return model_of(folder, f"{{at: {low} deg}}", f"{{at: {high} deg}}")


# by hand ------------------------------------------------------------------------------------------------------


def working(teeth: int, apart: float) -> float:
    return math.acos(teeth * math.cos(ALPHA) / apart)


def opened_by_bearings(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Change of the normal backlash of both meshes [mm], (n,), by displacements (n, 2) of the bearings [mm].

    b leaves a to the shaft's 0 deg. c looks down and sees d at its 40 deg, the shaft's -40 deg.
    """
    changes = []
    for height, alpha, width, seen in (
        (20.0, working(50, 50.1), 16.0, lambda vectors: vectors),
        (60.0, working(65, 65.1), 12.0, lambda vectors: -turned(seen_backward(vectors), -40)),
    ):
        away = seen(at_height(low, high, HEIGHTS, height))[:, 0]
        slope = (high - low) / (HEIGHTS[1] - HEIGHTS[0])
        in_plane, across = np.abs(seen(slope)).T
        closed = width * np.maximum(math.sin(alpha) * in_plane, math.cos(alpha) * across)
        changes.append(2 * math.sin(alpha) * away - closed)
    return changes[0], changes[1]


def of_measure(name: str, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """The measure of the changes of both meshes: at d a turn of the first counts by 25/40."""
    if name == "first backlash":
        return first
    return first / (30 * math.cos(ALPHA)) * 25 / 40 + second / (40 * math.cos(ALPHA))


def on_the_grid(directions: tuple[int, int], name: str) -> np.ndarray:
    """The measure's change over both clearances, (GRID, GRID)."""
    nodes = (np.arange(GRID) + 0.5) / GRID
    low, high = (4 + 24 * nodes) * 1e-3 / 2, (2 + 42 * nodes) * 1e-3 / 2
    ways = [np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))]) for angle in directions]
    first = np.repeat(low, GRID)[:, None] * ways[0]
    second = np.tile(high, GRID)[:, None] * ways[1]
    return of_measure(name, *opened_by_bearings(first, second)).reshape(GRID, GRID)


def test_the_hand_s_lean_is_the_oracles() -> None:
    """Closing by both planes told by slopes here, by the rotation vector there."""
    low, high = np.array([[0.004, 0.001]]), np.array([[-0.002, 0.006]])
    slope = ((high - low) / 110)[0]
    assert np.allclose(lean(low, high, HEIGHTS)[0], [-slope[1], slope[0]])


@pytest.mark.parametrize("name", ["lost motion", "first backlash"])
@pytest.mark.parametrize("directions", DIRECTIONS)
def test_mean_and_shares_of_two_bearings_follow_by_hand(directions: str, name: str, tmp_path: Path) -> None:
    """Alone: the variance of means over the other's clearance; what both do together goes to both in equal parts."""
    form = form_of(fixed(tmp_path, directions), name)
    change = on_the_grid(DIRECTIONS[directions], name)
    own = {share.name: share for share in form.shares if share.name in ("low clearance", "high clearance")}
    assert form.leaning == set(own)
    sigma = math.sqrt(change.var())
    assert sum(share.mean for share in own.values()) == pytest.approx(change.mean(), abs=NET * sigma)
    alone = {"low clearance": change.mean(axis=1).var(), "high clearance": change.mean(axis=0).var()}
    together = change.var() - sum(alone.values())
    assert together > (0.01 if directions == "alike" else -1e-12) * change.var()  # a kink that matters
    for own_name, variance in alone.items():
        assert own[own_name].variance == pytest.approx(variance + together / 2, abs=NET * change.var())


def test_the_rest_of_the_closed_form_is_that_of_a_shaft_that_does_not_lean(tmp_path: Path) -> None:
    model = fixed(tmp_path, "alike")
    bare = model_of(tmp_path, "apart, mesh: first", "apart, mesh: first").contributors[:3]
    assert [contributor.name for contributor in bare] == ["a thickness", "d thickness", "d eccentricity"]
    form = form_of(model, "lost motion")
    variances = {share.name: share.variance for share in form.shares}
    cos, sin = math.cos(ALPHA), math.sin(working(65, 65.1))
    thin = cos * 20 / 6 * 1e-3
    assert variances["a thickness"] == pytest.approx((thin / (30 * cos) * 25 / 40) ** 2, rel=1e-9)
    assert variances["d thickness"] == pytest.approx((thin / (40 * cos)) ** 2, rel=1e-9)
    assert variances["d eccentricity"] == pytest.approx((2 * sin * 3e-3 / (40 * cos)) ** 2, rel=1e-9)
    assert form.sigma**2 == pytest.approx(sum(variances.values()), rel=1e-12)
    assert sum(form.percent(own) for own in variances) == pytest.approx(100.0)


def test_a_mesh_read_in_the_middle_of_its_face_does_not_feel_the_lean(tmp_path: Path) -> None:
    """Then all is linear, and exact: 2 sin(alpha_w) of half of each clearance, by its lever at b and its direction."""
    path = tmp_path / "scene.yaml"
    text = SCENE.replace("LOW", "{at: 70 deg}").replace("HIGH", "{at: 215 deg}")
    path.write_text(text.replace("of: first}", "of: first, read_at: mean_section}"), encoding="utf-8")
    form = form_of(model_from_scene(tol3d.load_scene(path)), "first backlash")
    assert form.leaning == frozenset()
    sin = math.sin(working(50, 50.1))
    for name, lever, angle in (("low clearance", 70 / 110, 70), ("high clearance", 40 / 110, 215)):
        (share,) = (share for share in form.shares if share.name == name)
        assert share.coefficient == pytest.approx(sin * lever * math.cos(math.radians(angle)), rel=1e-9)


def test_the_net_agrees_with_the_rule_for_two_tilts_that_do_nothing_else(tmp_path: Path) -> None:
    model_of(tmp_path, "random", "random", MORE.replace("of: second", "of: first"))
    path = tmp_path / "scene.yaml"
    lines = path.read_text("utf-8").splitlines()
    path.write_text("\n".join(line for line in lines if not re.search("clearance|bearing", line)), "utf-8")
    model = model_from_scene(tol3d.load_scene(path))
    form = form_of(model, "first backlash")
    assert form.leaning == frozenset()
    group = [contributor for contributor in model.contributors if contributor.name in ("tilt", "skew")]
    by_rule = {share.name: share for share in form.shares}
    total = sum(by_rule[contributor.name].variance for contributor in group)
    for share in leaning_shares([(1.0, stack_of(model, model.mesh("first"), Reading()))], group, {}):
        assert share.mean == pytest.approx(by_rule[share.name].mean, abs=NET * math.sqrt(total))
        assert share.variance == pytest.approx(by_rule[share.name].variance, abs=NET * total)


# by samples ---------------------------------------------------------------------------------------------------

TRIALS = 60_000
CASES = {
    "two directions": ("{at: 70 deg}", "{at: 215 deg}", ""),
    "the same direction": ("{at: 70 deg}", "{at: 70 deg}", ""),
    "anywhere": ("random", "random", ""),
    "one anywhere, with tilts": ("{at: 10 deg}", "random", MORE),
}


@pytest.mark.parametrize("case", CASES)
def test_a_large_sample_of_either_method_agrees(case: str, tmp_path: Path) -> None:
    """Mean within four standard errors of the sample, sigma too by its own fourth moment, beside what NET allows.

    A share by regression on a deviation and its square is at most what it does alone; what is unexplained lies
    between them, of which the net gives each its part. The geometry sees what the stack-up neglects: 2 % of a sigma.
    """
    model = model_of(tmp_path, *CASES[case])
    columns = gear_columns(model, exact_engine(model), drawn_trials(model, 3, 0, TRIALS))
    for name in ("first backlash", "lost motion"):
        measure, form = measure_of(model, name), form_of(model, name)
        for method, neglected in (("analytic", 0.0), ("geometric", 0.02)):
            values = np.asarray(columns[f"{method}:{name}"]) / measure.per_internal
            about = values - values.mean()
            kurtosis = (about**4).mean() / (about**2).mean() ** 2
            error = 4 / math.sqrt(TRIALS)
            assert abs(values.mean() - form.mean) < (error + NET + neglected) * form.sigma
            assert abs(values.std() / form.sigma - 1) < error * math.sqrt((kurtosis - 1) / 4) + NET + neglected
            sums = RegressorSums.of(regressors(Simulation(GearSystem(model), Study()), measure, columns).T, values)
            found = shares(sums, regressor_groups(Simulation(GearSystem(model), Study()), measure))
            for own in form.shares:
                least = found.share[own.name] - 4 * found.standard_error[own.name] - NET - neglected
                most = found.share[own.name] + 4 * found.standard_error[own.name] + NET + neglected
                assert least < form.percent(own.name) / 100 < most + found.unexplained, own.name


# what check tells ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("case", CASES)
def test_both_methods_have_the_same_coefficients_where_the_shaft_leans(case: str, tmp_path: Path) -> None:
    for name, rows in coefficients_of(model_of(tmp_path, *CASES[case])).items():
        own = {row.name: row for row in rows}
        assert {"low clearance", "high clearance"} <= set(own), name
        for row in rows:
            assert not row.disagrees, (name, row)  # by more than DISAGREES, 5 %
        assert sum(known(row.percent) for row in rows) == pytest.approx(100.0)


def test_a_coefficient_at_the_mean_build_follows_by_hand(tmp_path: Path) -> None:
    """Differences of the shaft by hand about the mean clearances, 16 and 23 um."""
    model = fixed(tmp_path, "across")
    (low, high) = (
        np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))]) for angle in DIRECTIONS["across"]
    )

    def first(by: float, other: float) -> float:
        opened, _ = opened_by_bearings((8e-3 + by / 2) * low[None], (11.5e-3 + other / 2) * high[None])
        return float(opened[0])

    rows = {row.name: row for row in coefficients_of(model)["first backlash"]}
    step = 1e-5
    for name, expected in (
        ("low clearance", (first(step, 0.0) - first(-step, 0.0)) / (2 * step)),
        ("high clearance", (first(0.0, step) - first(0.0, -step)) / (2 * step)),
    ):
        assert rows[name].unit == "µm/µm"
        assert rows[name].stack_up.below == pytest.approx(expected, abs=1e-6)
        assert rows[name].stack_up.above == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("scene", ["three_stage_train", "split_train"])
def test_check_leaves_no_coefficient_empty(tol3d: object, scene: str) -> None:
    code, out, _ = tol3d("check", scene)  # type: ignore[operator]
    assert code == 0
    rows = [line for line in out.splitlines() if "µm/µm" in line or "″/µm" in line or "″/′" in line]
    assert len(rows) > 20
    for row in rows:
        stack_up, geometry, share = row.split()[-3:]
        assert "–" not in (stack_up, geometry)
        assert share != "–" or scene == "split_train"  # of parallel load paths there are no shares without trials


# random shafts ------------------------------------------------------------------------------------------------

SHAFTS = 40
MANY = 60_000


def random_shaft(seed: int) -> str:
    """A shaft on two bearings with one to three gears, each in a mesh; any clearances, some tilts."""
    rng = random.Random(seed)
    gears = range(rng.choice([1, 2, 2, 3]))
    low, high = rng.uniform(-70, 0), rng.uniform(5, 70)
    seats = (
        f"g{k}: {{at: {rng.uniform(-60, 60):.1f} mm, facing: {rng.choice(['forward', 'backward'])}}}" for k in gears
    )
    parts = [f"  shaft: {{kind: shaft, carries: {{{', '.join(seats)}}}}}"]
    parts += [f"  low: {{kind: bearing, shaft: shaft, at: {low:.1f} mm}}"]
    parts += [f"  high: {{kind: bearing, shaft: shaft, at: {high:.1f} mm}}"]
    tolerances, moves, measures = [], [], []
    for k in gears:
        teeth, module, width = (
            (rng.randint(22, 40), rng.randint(22, 50)),
            rng.choice([1.0, 1.5, 2.0]),
            rng.uniform(6, 25),
        )
        for name, own in zip((f"g{k}", f"h{k}"), teeth, strict=True):
            parts.append(
                f"  {name}: {{kind: spur_gear, teeth: {own}, module: {module} mm, face_width: {width:.1f} mm}}"
            )
        roles = "driver: h0, driven: g0" if k == 0 else f"driver: g{k}, driven: h{k}"
        place = f"centre_distance: {module * sum(teeth) / 2 + 0.15:.3f} mm, azimuth: {rng.randint(-180, 180)} deg"
        moves.append(f"  m{k}: {{kind: mesh, {roles}, {place}, working_flank: {rng.choice(['left', 'right'])}}}")
        measures.append(f"  j{k}: {{kind: normal_backlash, of: m{k}}}")
        for kind in ("axis_in_plane", "axis_out_of_plane"):
            if rng.random() < 0.4:
                law = f"{{kind: normal, mean: {rng.uniform(-6, 6):.2f} um, sigma: {rng.uniform(1, 12):.2f} um}}"
                tolerances.append(f"  {kind} {k}: {{kind: {kind}, of: m{k}, distribution: {law}}}")
    for bearing in ("low", "high"):
        direction = rng.choice(["random", "apart", "tooth_force", "{at: 30 deg}", f"{{at: {rng.randint(0, 359)} deg}}"])
        least = rng.uniform(0, 15)
        law = (
            f"{{kind: {rng.choice(['uniform', 'normal'])}, lower: {least} um, upper: {least + rng.uniform(1, 30)} um}}"
        )
        kind = f"kind: bearing_clearance, of: {bearing}, direction: {direction}, mesh: m0"
        tolerances.append(f"  {bearing} clearance: {{{kind}, distribution: {law}}}")
    if len(gears) > 1:
        moves.append(f"  train: {{kind: train, driven: h0, output: h{len(gears) - 1}}}")
        measures.append("  lost motion: {kind: lost_motion, of: train}")
    sections = {"parts": parts, "tolerances": tolerances, "moves": moves, "measures": measures}
    return "\n".join(["scene: shaft", *(line for name, own in sections.items() for line in (f"{name}:", *own)), ""])


@pytest.mark.slow
def test_random_shafts_have_the_closed_form_of_their_samples(tmp_path: Path) -> None:
    """None of some 110 means and as many sigmas is off by 4.5 standard errors (one in 600 such tests), rms near 1.

    The rms of 110 independent ones is within 0.2 of 1 in three standard deviations; those of one shaft depend on each
    other, which widens that by up to the root of their number, 2.
    """
    off = []
    for seed in range(SHAFTS):
        model = model_from_scene(scene_of(random_shaft(seed), tmp_path))
        block = drawn_trials(model, seed, 0, MANY)
        for measure in model.measures:
            form, values = form_of(model, measure.name), analytic_values(model, measure, block)[:, 0]
            about = values - values.mean()
            kurtosis = (about**4).mean() / (about**2).mean() ** 2
            mean = (values.mean() - form.mean) / values.std() * math.sqrt(MANY)
            sigma = (values.std() / form.sigma - 1) * math.sqrt(4 * MANY / (kurtosis - 1))
            off.append((mean, sigma))
            assert sum(form.percent(share.name) for share in form.shares) == pytest.approx(100.0)
    assert np.abs(off).max() < 4.5
    assert np.sqrt(np.mean(np.square(off), axis=0)) == pytest.approx(1.0, abs=0.4)
