"""The stack-up of whole trains: closed forms by hand and by a large sample, shares of stages, derivatives.

The table of three_stage_train.yaml, its two bearings left out: what leans is told by test_leaning.py.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from gear_trials import drawn_trials, form_of, gear_columns, measure_of
from oracles.train import robot_lost_motion, table_lost_motion
from places import SCENES
from scene_texts import scene_of

from tol3d import load_scene
from tol3d.gearing.builds.build import build
from tol3d.gearing.engines.gaps import STATUSES, exact_engine
from tol3d.gearing.model import Model, Reading, model_from_scene
from tol3d.gearing.play.play import breakdowns_of
from tol3d.gearing.slopes.sensitivity import sensitivities
from tol3d.gearing.stack_up import stack_of
from tol3d.gearing.summary.train_sections import train_sections
from tol3d.study.system.trials import Trials
from tol3d.study.tallies.tally import merged_terms, pooled_terms

TABLE = (SCENES / "three_stage_train.yaml").read_text(encoding="utf-8")
MANY = 100_000
ARCMIN = 10800 / math.pi  # in a radian
ALPHA = math.radians(20.0)


def without(text: str, *names: str) -> str:
    """A scene less some of its entries, each with the lines that stand below it."""
    kept, dropping = [], False
    for line in text.splitlines(keepends=True):
        if line.startswith("  ") and not line.startswith("   "):
            dropping = line.strip().partition(":")[0] in names
        kept.append("" if dropping and line.startswith("  ") else line)
    return "".join(kept)


def model_of(folder: Path, text: str) -> Model:
    return model_from_scene(scene_of(text, folder))


@pytest.fixture(scope="module")
def upright(tmp_path_factory: pytest.TempPathFactory) -> Model:
    """The table with a shaft that stands upright, its lost motion read at the table too."""
    text = without(TABLE, "lower bearing clearance", "upper bearing clearance")
    text = text.replace(
        "shaft: idler, upper_limit: 24 arcmin}",
        "shaft: idler}\n  at the table: {kind: lost_motion, of: indexing, shaft: table shaft}",
    )
    return model_of(tmp_path_factory.mktemp("upright"), text)


# by hand --------------------------------------------------------------------------------------------------------


def test_the_closed_form_at_the_encoder_follows_by_hand(upright: Model) -> None:
    nominal, mean, variances = table_lost_motion()
    form = form_of(upright, "lost motion")
    assert (form.nominal, form.mean) == pytest.approx((nominal, mean), rel=1e-9)
    assert {share.name: share.variance for share in form.shares} == pytest.approx(variances, rel=1e-9)
    assert form.sigma == pytest.approx(math.sqrt(sum(variances.values())), rel=1e-9)
    assert sum(form.percent(share.name) for share in form.shares) == pytest.approx(100.0)


def test_the_idlers_eccentricity_adds_up_as_vectors_at_the_table(upright: Model) -> None:
    """120 deg between its mates: less than either of equal openings, sqrt(a^2 + b^2 - a b)."""
    working = math.acos(25.5 * math.cos(ALPHA) / 25.75)
    a = 2 * math.sin(working) / (15.5 * math.cos(ALPHA)) * 31 / 60
    b = 2 * math.sin(ALPHA) / (30 * math.cos(ALPHA))
    (share,) = (share for share in form_of(upright, "at the table").shares if share.name == "idler eccentricity")
    assert math.sqrt(share.variance) == pytest.approx(5e-3 * math.sqrt(a * a + b * b - a * b), rel=1e-9)


def test_the_robots_closed_form_is_that_of_its_two_pairs() -> None:
    model = model_from_scene(load_scene(SCENES / "robot_shoulder.yaml"))
    mean, variances = robot_lost_motion()
    for name, lever in (("lost motion", 1.0), ("tip displacement", 763.0)):
        form = form_of(model, name)
        assert form.mean == pytest.approx(lever * mean, rel=1e-9)
        found = {share.name: share.variance for share in form.shares}
        assert found == pytest.approx({own: lever**2 * variance for own, variance in variances.items()}, rel=1e-9)


# by a large sample ----------------------------------------------------------------------------------------------


@cache
def sample_of(text: str, folder: Path) -> tuple[Model, Mapping[str, np.ndarray]]:
    model = model_of(folder, text)
    return model, gear_columns(model, None, drawn_trials(model, 11, 0, MANY))


def agrees(model: Model, columns: Mapping[str, np.ndarray], name: str) -> None:
    """Within four standard errors, the one of sigma from the sample's own fourth moment."""
    form, values = form_of(model, name), columns[f"analytic:{name}"]
    values = values / measure_of(model, name).per_internal
    about = values - values.mean()
    kurtosis = (about**4).mean() / (about**2).mean() ** 2
    assert abs(values.mean() - form.mean) < 4 * form.sigma / math.sqrt(MANY)
    assert abs(values.std() / form.sigma - 1) < 4 * math.sqrt((kurtosis - 1) / (4 * MANY))


@pytest.mark.parametrize("name", ["first normal backlash", "second normal backlash", "lost motion", "at the table"])
def test_a_large_sample_agrees_with_the_closed_form(name: str, upright: Model) -> None:
    agrees(upright, gear_columns(upright, None, drawn_trials(upright, 11, 0, MANY)), name)


VARIANTS = {
    # the marks on the shaft at a quarter of a turn, then against each other
    "marks apart": ("direction: {at: -18 deg}", "direction: {at: 72 deg}"),
    # one that acts in two meshes
    "the idler has a mark too": (
        "of: idler, distribution: {kind: rayleigh, scale: 5 um}",
        "of: idler, direction: {at: 33 deg}, distribution: {kind: constant, value: 15 um}",
    ),
    # a pinion of as many teeth as the idler goes as fast, the other way
    "equal gears turn opposite": ("teeth: 20, module: 1 mm", "teeth: 31, module: 1 mm"),
    "the shaft's run-out has a mark": (
        "of: table shaft, distribution: {kind: rayleigh, scale: 2 um}",
        "of: table shaft, direction: {at: 100 deg}, distribution: {kind: uniform, lower: 4 um, upper: 14 um}",
    ),
    "at one position": (
        "kind: lost_motion, of: indexing, upper_limit: 52 arcmin",
        "kind: lost_motion, of: indexing, over: {at: 77 deg}",
    ),
}


@pytest.mark.parametrize(("old", "new"), VARIANTS.values(), ids=VARIANTS)
def test_marks_that_turn_together_vary_together(old: str, new: str, tmp_path: Path) -> None:
    assert old in TABLE
    text = without(TABLE, "lower bearing clearance", "upper bearing clearance").replace(old, new)
    if "teeth: 31" in new:
        marks = "direction: {at: 33 deg}, distribution: {kind: constant, value: 15 um}"
        for gear, scale in (("pinion", 3), ("idler", 5)):
            law = f"of: {gear}, distribution: {{kind: rayleigh, scale: {scale} um}}"
            assert law in text
            text = text.replace(law, f"of: {gear}, {marks}")
        text = text.replace("25.75 mm", "31.25 mm").replace(", ratio: -10.4", "")
    model, columns = sample_of(text, tmp_path)
    agrees(model, columns, "lost motion")


# bearings -------------------------------------------------------------------------------------------------------

BEARINGS = """
scene: two stages
parts:
  a: {kind: spur_gear, teeth: 20, module: 2 mm, face_width: 6 mm}
  b: {kind: spur_gear, teeth: 30, module: 2 mm, face_width: 6 mm}
  c: {kind: spur_gear, teeth: 25, module: 2 mm, face_width: 6 mm}
  d: {kind: spur_gear, teeth: 40, module: 2 mm, face_width: 6 mm}
  middle: {kind: shaft, carries: {b: {at: 20 mm}, c: {at: 60 mm, facing: backward}}}
  low: {kind: bearing, shaft: middle, at: -20 mm}
tolerances:
  clearance:
    kind: bearing_clearance
    of: low
    direction: {at: 70 deg}
    distribution: {kind: uniform, lower: 4 um, upper: 16 um}
moves:
  first: {kind: mesh, driver: a, driven: b, centre_distance: 50.1 mm}
  second: {kind: mesh, driver: c, driven: d, centre_distance: 65.1 mm, azimuth: 40 deg}
  train: {kind: train, driven: a, output: d}
measures:
  lost motion: {kind: lost_motion, of: train}
"""


def test_one_bearing_acts_in_all_meshes_of_its_shaft(tmp_path: Path) -> None:
    """b leaves a to the shaft's 0 deg; c looks down and sees d at its 40 deg, the shaft's -40 deg: away is 140 deg."""
    (share,) = form_of(model_of(tmp_path, BEARINGS), "lost motion").shares
    expected = 0.0
    for teeth, apart, away, behind in ((20 + 30, 50.1, 0, 25 / 40 / 30), (25 + 40, 65.1, 140, 1 / 40)):
        sin = math.sqrt(1 - (teeth * math.cos(ALPHA) / apart) ** 2)
        expected += sin * math.cos(math.radians(away - 70)) * behind / math.cos(ALPHA)
    assert share.coefficient == pytest.approx(expected, rel=1e-9)
    assert share.mean == pytest.approx(expected * 10e-3, rel=1e-9)
    assert share.variance == pytest.approx(expected**2 * 144e-6 / 12, rel=1e-9)


BEVELS = (
    BEARINGS.replace("  c: {kind: spur_gear", "  c: {kind: bevel_gear")
    .replace("  d: {kind: spur_gear", "  d: {kind: bevel_gear")
    .replace("c: {at: 60 mm", "c: {at: 150 mm")
    .replace("tolerances:", "  high: {kind: bearing, shaft: middle, at: 70 mm}\ntolerances:")
    .replace("{kind: mesh, driver: c, driven: d, centre_distance: 65.1 mm,", "{kind: bevel_mesh, driver: c, driven: d,")
)
"""A bevel gear behind both bearings of its shaft."""


@pytest.mark.parametrize("scene", ["spur", "bevel"])
@pytest.mark.parametrize("angle", [0, 35, 120, 200, 310])
def test_a_bearing_that_moves_its_shaft_anywhere_does_in_each_direction_what_one_with_that_direction_does(
    scene: str, angle: int, tmp_path: Path
) -> None:
    spur = BEARINGS.replace("tolerances:", "  high: {kind: bearing, shaft: middle, at: 90 mm}\ntolerances:")
    text = spur if scene == "spur" else BEVELS
    fixed = model_of(tmp_path, text.replace("70 deg", f"{angle} deg"))
    anywhere = model_of(tmp_path, text.replace("{at: 70 deg}", "random"))
    length, along = 0.012, math.radians(angle)
    by_length = np.array([[length]])
    by_vector = np.array([[length * math.cos(along), length * math.sin(along)]])
    for made, other in (
        (build(fixed, by_length), build(anywhere, by_vector)),
        (exact_engine(fixed).build(by_length), exact_engine(anywhere).build(by_vector)),
    ):
        for name, values in vars(made).items():
            assert vars(other)[name] == pytest.approx(values, abs=1e-14), name
    for mesh in fixed.meshes:
        stacks = [stack_of(model, model.mesh(mesh.name), Reading()) for model in (fixed, anywhere)]
        for told in ("normal_backlash", "aside"):
            first = getattr(stacks[0], told)(by_length, np.zeros(1))
            second = getattr(stacks[1], told)(by_vector, np.zeros(1))
            assert second == pytest.approx(first, abs=1e-14), told


BEVEL = """
scene: a corner
parts:
  p: {{kind: bevel_gear, teeth: 20, module: 2 mm, face_width: 8 mm}}
  w: {{kind: bevel_gear, teeth: 30, module: 2 mm, face_width: 8 mm}}
  motor: {{kind: shaft, carries: {{p: {{at: 50 mm, facing: {facing}}}}}}}
  near: {{kind: bearing, shaft: motor, at: 0 mm}}
  far: {{kind: bearing, shaft: motor, at: 80 mm}}
tolerances:
  p tooth thickness: {{kind: tooth_thickness, of: p, distribution: {{kind: constant, value: -60 um}}}}
  clearance:
    kind: bearing_clearance
    of: far
    direction: {{at: 0 deg}}
    distribution: {{kind: uniform, lower: 4 um, upper: 16 um}}
moves:
  corner: {{kind: bevel_mesh, driver: p, driven: w}}
  train: {{kind: train, driven: motor, output: w}}
measures:
  lost motion: {{kind: lost_motion, of: train, tooth: driven}}
"""


@pytest.mark.parametrize(("facing", "sense"), [("forward", 1), ("backward", -1)])
def test_a_bearing_that_leans_a_bevel_gear_shifts_its_apex_and_closes_the_shaft_angle(
    facing: str, sense: int, tmp_path: Path
) -> None:
    """The bearing at 80 mm goes towards the mesh by c/2, the apex at 50 mm by 5/8 of that; the axis leans by c/2/80 mm.

    Towards the mesh closes by 2 sin(alpha) cos(delta). z leans to the mate: the angle between the axes closes by the
    lean, 2 R_m sin(alpha) each; a gear that faces backward sees its z lean away.
    """
    model = model_of(tmp_path, BEVEL.format(facing=facing))
    delta = math.atan2(20, 30)
    outer = 20 / math.sin(delta)
    mean = outer - 4
    arm = mean * math.cos(delta) * math.cos(ALPHA)
    shifted, leaning = -2 * math.sin(ALPHA) * math.cos(delta) * 5 / 16 / arm, -2 * math.sin(ALPHA) * mean / 160 / arm
    (share,) = (share for share in form_of(model, "lost motion").shares if share.name == "clearance")
    assert share.coefficient == pytest.approx(shifted + sense * leaning, rel=1e-9)
    # by the teeth themselves, over a pitch: the stack-up is for the pitch point, and a shift acts by up to 10 % more or
    # less on the pairs of one mesh
    rows = np.zeros((64, model.component_count))
    rows[:, model.component_slices["p tooth thickness"]] = -0.06
    rows[32:, model.component_slices["clearance"]] = 0.010
    angles = {"corner": np.tile(2 * math.pi / 20 * np.arange(32) / 32, 2)}
    values = gear_columns(model, exact_engine(model), Trials(rows, angles))["geometric:lost motion"] / ARCMIN
    seen = (values[32:].mean() - values[:32].mean()) / 0.010
    assert seen == pytest.approx(share.coefficient, abs=0.1 * abs(shifted))


# stages ---------------------------------------------------------------------------------------------------------


def test_shares_of_stages_add_up_to_all_of_the_variance_and_are_those_of_the_sample() -> None:
    model = model_from_scene(load_scene(SCENES / "three_stage_train.yaml"))
    columns = gear_columns(model, exact_engine(model), drawn_trials(model, 3, 0, 5000))
    half = {name: values[:2000] for name, values in columns.items()}, {name: v[2000:] for name, v in columns.items()}
    first, second = (pooled_terms(breakdowns_of(model), STATUSES, part) for part in half)
    own = train_sections(model, merged_terms(first, second), {})["indexing"]
    factors = {"gearbox": 0.5, "first mesh": 31 / 40, "second mesh": 1.5, "third mesh": 1.0}
    assert {stage["link"]: stage["factor"] for stage in own["stages"]} == pytest.approx(factors)
    for method in ("analytic", "geometric"):
        total = columns[f"{method}:lost motion"]
        for stage in own["stages"]:
            values = columns[f"{method}:lost motion:{stage['link']} [arcmin]"]
            share = 100 * factors[stage["link"]] * np.cov(values, total)[0, 1] / total.var(ddof=1)
            found = stage["methods"][method]
            assert found["share_percent"] == pytest.approx(share, abs=1e-9)
            assert (found["mean"], found["sigma"]) == pytest.approx((values.mean(), values.std(ddof=1)))
            assert (found["sample_min"], found["sample_max"]) == (values.min(), values.max())
        assert sum(stage["methods"][method]["share_percent"] for stage in own["stages"]) == pytest.approx(100.0)
        added = sum(factors[stage["link"]] * stage["methods"][method]["high_3sigma"] for stage in own["stages"])
        assert own["sums"][method]["high_3sigma"] == pytest.approx(added)


# derivatives ----------------------------------------------------------------------------------------------------

STEP = 1e-5  # mm, rad or K; 0.01 um, over which kinks are rare, and 1e-9 of a turn is told to 1e-4


@pytest.mark.parametrize(
    ("scene", "measure"),
    [
        ("three_stage_train", "lost motion"),
        ("three_stage_train", "lost motion of the idler"),
        ("three_stage_train", "lost motion of the table at the stop"),
        ("robot_shoulder", "lost motion"),
        ("robot_shoulder", "tip displacement"),
    ],
)
def test_derivatives_are_those_of_two_simulations(scene: str, measure: str) -> None:
    model = model_from_scene(load_scene(SCENES / f"{scene}.yaml"))
    own, trials = measure_of(model, measure), 4
    model = replace(model, measures=(own,))
    block, engine = drawn_trials(model, 2, 0, trials), exact_engine(model)
    rates = sensitivities(model, engine, block, own)
    count = model.component_count
    steps = STEP * np.eye(count)

    def taken(sign: float) -> np.ndarray:
        rows = (block.deviations[:, None] + sign * steps).reshape(-1, count)
        angles = {mesh: np.repeat(angle, count) for mesh, angle in block.positions.items()}
        values = gear_columns(model, engine, Trials(rows, angles))[f"geometric:{own.name}"]
        return values.reshape(trials, count) / own.per_internal

    differences = (taken(1.0) - taken(-1.0)) / (2 * STEP)
    largest = np.abs(differences).max(axis=1, keepdims=True)
    assert (largest > 0).all()
    assert np.abs(rates - differences).max() < 1e-4 * largest.max()


@pytest.mark.parametrize("teeth", [(18, 22, 33), (20, 31, 60), (25, 40, 25), (17, 29, 71)])
def test_an_idler_straight_between_two_gears_takes_from_one_what_it_gives_to_the_other(
    teeth: tuple[int, int, int], tmp_path: Path
) -> None:
    """Its eccentricity opens one mesh by as much normal backlash as it closes the other; at the last gear's flanks they
    count alike where working angles are: nothing is left of it but rounding, and the closed form stands."""
    first, idler, last = teeth
    parts = "".join(
        f"  {name}: {{kind: spur_gear, teeth: {z}, module: 1 mm, face_width: 8 mm}}\n"
        for name, z in zip(("first", "idler", "last"), teeth, strict=True)
    )
    text = f"""scene: straight
parts:
{parts}tolerances:
  thickness: {{kind: tooth_thickness, of: idler, distribution: {{kind: normal, lower: -60 um, upper: -40 um}}}}
  eccentricity: {{kind: eccentricity, of: idler, distribution: {{kind: rayleigh, scale: 5 um}}}}
moves:
  a: {{kind: mesh, driver: first, driven: idler, centre_distance: {1.002 * (first + idler) / 2:.9f} mm}}
  b: {{kind: mesh, driver: idler, driven: last, centre_distance: {1.002 * (idler + last) / 2:.9f} mm}}
  train: {{kind: train, driven: first, output: last}}
measures:
  lost motion: {{kind: lost_motion, of: train}}
study: {{trials: 50, seed: 1, engine: analytic}}
"""
    form = form_of(model_of(tmp_path, text), "lost motion")
    shares = {share.name: share.variance for share in form.shares}
    assert shares["eccentricity"] <= 1e-12 * shares["thickness"]
    assert form.sigma == pytest.approx(math.sqrt(shares["thickness"]), rel=1e-9)
