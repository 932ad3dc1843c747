"""Pins with play: problems 11a, 11b and 13, where floats lie in their rooms, what is refused."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from assembly.plates_with_pins import pinned_plates
from assembly_trials import Assembled, assembled
from numpy.typing import NDArray
from places import SCENES
from scene_texts import Edit, edited, refusal
from scipy.optimize import brentq
from scipy.stats import norm

from tol3d.assembly.model.statuses import NO_BUILD
from tol3d.assembly.placing import method as placing
from tol3d.assembly.placing import play_move
from tol3d.assembly.placing.chords import ray, way_along
from tol3d.assembly.placing.play_move import Engaging
from tol3d.assembly.placing.poses import Codes
from tol3d.assembly.placing.world import World
from tol3d.assembly.torsors import method as torsors
from tol3d.contact.seat import Place, Seated, seated
from tol3d.simulate import Overrides, load, run_scene, simulation_of
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]

METHODS = ("exact", "analytic")
PLATE = (SCENES / "hole_and_slot.yaml").read_text("utf-8")


@pytest.mark.parametrize("method", [pytest.param("exact", marks=pytest.mark.slow), "analytic"])
def test_hole_and_slot(method: str) -> None:
    """Problem 13: the disc of a hole and the width of a slot, area and not radius uniform, of each trial's sizes."""
    count = 20_000
    whole = load(SCENES / "hole_and_slot.yaml")
    scene = whole.model_copy(update={"measures": {name: whole.measures[name] for name in ("corner x", "corner y")}})
    found = Assembled(simulation_of(scene, Overrides())).drawn(count, method)
    first, second = (c**2 + (0.01**2 + 0.004**2) / 4 for c in (0.05, 0.03))
    x, y, length = 300.0, 80.0, 120.0
    variances = {
        "corner x": first / 4 * (1 + (y / length) ** 2) + second / 3 * (y / length) ** 2,
        "corner y": first / 4 * (1 - x / length) ** 2 + second / 3 * (x / length) ** 2,
    }
    assert [round(math.sqrt(own), 6) for own in variances.values()] == [0.032417, 0.057948]
    for name, variance in variances.items():
        assert found[name].std() == pytest.approx(math.sqrt(variance), rel=4 / math.sqrt(2 * count))
    common = -first / 4 * (y / length) * (1 - x / length) * -1 - second / 3 * x * y / length**2
    correlation = common / math.sqrt(variances["corner x"] * variances["corner y"])
    assert correlation == pytest.approx(-0.61131, abs=2e-5)
    both = np.corrcoef(found["corner x"], found["corner y"])[0, 1]
    assert both == pytest.approx(correlation, abs=4 * (1 - correlation**2) / math.sqrt(count))
    assert np.abs(found["corner y"]).max() < abs(1 - x / length) * 0.08 + x / length * 0.06  # of sizes 5 sigma off


def test_over_play_only_what_a_measure_reads_is_placed_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """The plate and the key once, the plate for both measures of its corner, the key for both of its own.

    Each is centred once, for its own float and for both pushes.
    """
    simulation = simulation_of(load(SCENES / "hole_and_slot.yaml"))
    trials, system = drawn(simulation, 0, 3), simulation.system
    method = system.method("exact", system.materials("exact"))
    method.answers(trials, system.measures)  # plans
    placed, pushes = list[str](), list[bool]()

    def counted(self: Engaging, world: World) -> tuple[World, Codes]:
        placed.append(self.move.name)
        return as_it_is(self, world)

    def seat(*given: Any, **named: Any) -> Seated:
        pushes.append(named.get("pushes", False))
        return seated(*given, **named)

    as_it_is = Engaging.placed
    monkeypatch.setattr(Engaging, "placed", counted)
    monkeypatch.setattr(play_move, "seated", seat)
    method.answers(trials, system.measures)
    assert sorted(placed) == ["key in its way"] * 3 + ["plate on the pins"] * 3
    assert sorted(pushes) == [False] * 2 + [True] * 4


def test_a_fit_of_size_and_size_goes_together_in_any_coordinates(tmp_path: Path) -> None:
    """A pin in a hole as large, drawn askew: its slack is 0, and by rounding of the poses below it."""
    z, x = [-0.017, 0.918, 0.397], [0.939, 0.151, -0.308]
    axis = f"axis: {z}, length: 20 mm, diameter: 10 mm"
    face = f"kind: plane, at: [0 mm, 0 mm, 0 mm], along: {x}, extent: [60 mm, 60 mm], normal"
    size = "distribution: {kind: constant, value: 0 um}"
    text = f"""scene: size and size
parts:
  plate:
    kind: solid
    features:
      top: {{{face}: {z}}}
      hole: {{kind: cylinder, at: [310.1 mm, -73.7 mm, 212.9 mm], {axis}, hole: true}}
  shaft:
    kind: solid
    features:
      face: {{{face}: {[-own for own in z]}}}
      pin: {{kind: cylinder, at: [310.1 mm, -73.7 mm, 212.9 mm], {axis}}}
tolerances:
  hole size: {{kind: size, of: plate.hole, {size}}}
  pin size: {{kind: size, of: shaft.pin, {size}}}
moves:
  bench: {{kind: fix, part: plate}}
  in:
    kind: pin_and_hole
    part: shaft
    relations: [{{kind: coincident, from: shaft.face, to: plate.top}}]
    pairs: [{{from: shaft.pin, to: plate.hole}}]
    float: {{kind: random}}
measures:
  aside: {{kind: gap, from: plate.hole, to: shaft.pin, along: {x}}}
  slack: {{kind: slack, of: in}}
"""
    found = assembled(text, tmp_path).drawn(3)
    assert found["slack"] == pytest.approx(0.0, abs=1e-9)
    assert found["aside"] == pytest.approx(0.0, abs=1e-9)


def key(width: float, floating: str) -> str:
    """The key of the shipped scene, alone, of exact sizes."""
    text = PLATE.replace("width: 20.03 mm", f"width: {width} mm").replace("sigma: 2 um", "sigma: 1e-6 um")
    return text.replace("{kind: toward, along: [0, 1, 0], at: key.tip}", floating)


def test_a_tongue_leans_in_its_slot_until_its_corners_touch(tmp_path: Path) -> None:
    """Problem 11a: w cos(th) + l sin(th) = W."""
    made = assembled(key(20.3, "{kind: toward, along: [0, 1, 0], at: key.tip}"), tmp_path)
    tilt = brentq(lambda th: 20 * math.cos(th) + 30 * math.sin(th) - 20.3, 0, 0.1, xtol=1e-15)
    assert tilt == pytest.approx(10.03372663e-3, abs=1e-11)
    assert made.nominal["tilt"] == pytest.approx(tilt, abs=1e-9)
    assert made.nominal["tip"] == pytest.approx(150 * math.sin(tilt), abs=1e-7)
    other = assembled(key(20.3, "{kind: toward, along: [0, -1, 0], at: key.tip}"), tmp_path)
    assert other.nominal["tip"] == pytest.approx(-150 * math.sin(tilt), abs=1e-7)
    assert assembled(key(20.3, "{kind: centred}"), tmp_path).nominal["tip"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_what_is_drawn_aside_of_its_slot_is_centred_in_it(tmp_path: Path, method: str) -> None:
    """The key stands 0.3 mm aside on the drawing and the plate 0.2 mm; first order sees 120 mm as 0.1 mm longer."""
    text = key(20.03, "{kind: centred}").replace("float: {kind: random} ", "float: {kind: centred} ")
    aside = text.replace("  key:\n", "  key:\n    placed: {at: [0 mm, 0.3 mm, 0 mm]}\n", 1)
    aside = aside.replace("  plate:\n", "  plate:\n    placed: {at: [0.1 mm, -0.2 mm, 0 mm]}\n", 1)
    for name, values in assembled(text, tmp_path).drawn(3, method).items():
        within = 0.1 / 120 * 1.5 * np.abs(values).max() if method == "analytic" and "most" in name else 0.0
        assert assembled(aside, tmp_path).drawn(3, method)[name] == pytest.approx(values, abs=within + 1e-9), name


@pytest.mark.parametrize("method", METHODS)
def test_measures_over_the_whole_play(tmp_path: Path, method: str) -> None:
    """Problem 13 at nominal sizes: |1 - x/L| c1 + x/L c2 along y, sqrt(1 + (y/L)^2) c1 + y/L c2 along x; no float."""
    more = "".join(
        f"  {axis} {which}: {{kind: gap, from: base.corner, to: plate.corner, along: {along}, over_play: {which}}}\n"
        for axis, along in (("x", [1, 0, 0]), ("y", [0, 1, 0]))
        for which in ("least", "largest")
    )
    made = assembled(key(20.03, "{kind: centred}").replace("\nstudy:", f"{more}\nstudy:"), tmp_path)
    rows = drawn(made.simulation, 0, 50).deviations
    for contributor, own in made.slices:
        if contributor.kind == "size":
            rows[:, own] = 0.0
    names = ["x least", "x largest", "y least", "y largest", "tilt at least"]
    if method == "exact":
        found = {name: own for name, (own, _) in placing.values(made.system.assembly, rows, names).items()}
    else:
        found = dict(torsors.values(made.system.assembly, rows, names))
    x, y = math.hypot(1, 80 / 120) * 0.05 + 80 / 120 * 0.03, (300 / 120 - 1) * 0.05 + 300 / 120 * 0.03
    lean = -brentq(lambda th: 20 * math.cos(th) + 30 * math.sin(th) - 20.03, 0, 0.1, xtol=1e-15)
    for name, expected in zip(names, (-x, x, -y, y, lean), strict=True):
        # turns of 1e-3 shorten 300 mm by 2e-4; what they do to the directions of offsets is of second order too
        assert found[name] == pytest.approx(np.full(50, expected), abs=3e-4), name
        assert np.ptp(found[name]) < 1e-7, name


BORE = """
scene: a pin in a bore
parts:
  body:
    kind: solid
    features:
      bore: {kind: cylinder, at: [0 mm, 0 mm, 20 mm], axis: [0, 0, 1], length: 40 mm, diameter: 10.1 mm, hole: true}
      mark: {kind: point, at: [0 mm, 0 mm, 120 mm]}
  shaft:
    kind: solid
    features:
      pin: {kind: cylinder, at: [0 mm, 0 mm, 60 mm], axis: [0, 0, 1], length: 120 mm, diameter: 10 mm}
      tip: {kind: point, at: [0 mm, 0 mm, 120 mm]}
tolerances:
  bore size: {kind: size, of: body.bore, distribution: {kind: constant, value: 0 mm}}
  pin size: {kind: size, of: shaft.pin, distribution: {kind: constant, value: 0 mm}}
moves:
  body: {kind: fix, part: body}
  in: {kind: pin_and_hole, part: shaft, pairs: [{from: shaft.pin, to: body.bore}], float: {kind: random}}
measures:
  x: {kind: gap, from: body.mark, to: shaft.tip, along: [1, 0, 0]}
  y: {kind: gap, from: body.mark, to: shaft.tip, along: [0, 1, 0]}
""".replace("  body: {kind: fix", "  set: {kind: fix")


@pytest.mark.parametrize("kind", ["pin_and_hole", "pattern"])
@pytest.mark.parametrize("method", METHODS)
def test_a_pin_in_a_bore(tmp_path: Path, method: str, kind: str) -> None:
    """Problem 11b: both ends anywhere in their discs; 100 from the middle sigma (c/2) sqrt(1/2 + 2 d^2/l^2), and within
    c (1 + 2 d/l - 1/2 + 1/2). A pattern of one pin has the same room of four freedoms, and is as uniform in it."""
    count, c, d, length = 40_000 if kind == "pin_and_hole" else 20_000, 0.05, 100.0, 40.0
    found = assembled(BORE.replace("pin_and_hole", kind), tmp_path).drawn(count, method)
    sigma = c / 2 * math.sqrt(0.5 + 2 * d**2 / length**2)
    assert sigma == pytest.approx(0.0901388, abs=1e-7)
    for own in found.values():
        assert own.std() == pytest.approx(sigma, rel=4 / math.sqrt(2 * count))
    reach = 2 * c * d / length
    largest = np.hypot(found["x"], found["y"]).max()
    assert reach == pytest.approx(0.25)
    assert 0.85 * reach < largest < reach + 1e-6


def leaning(floating: str, spread: str) -> str:
    """The plate on its pins, whose hole leans by a stated amount."""
    text = PLATE.replace("float: {kind: random} ", f"float: {floating} ")
    lean = f"of: plate.hole, zone: {{diameter: 0.2 mm}}, datums: [bottom], law: {spread}"
    return text.replace("\nmoves:\n", f"  lean: {{kind: perpendicularity, {lean}}}\n\nmoves:\n")


@pytest.mark.parametrize("method", [pytest.param("exact", marks=pytest.mark.slow), "analytic"])
def test_a_hole_that_leans_leaves_a_lens(tmp_path: Path, method: str) -> None:
    """Uniform by area in the lens of two discs 2a apart: second moments by rejection from the box about it."""
    half = 0.03
    law = f"{{kind: process, distribution: {{kind: constant, value: {half * 1e3} um}}}}"
    made = assembled(leaning("{kind: random}", law), tmp_path)
    rows = drawn(made.simulation, 0, 15_000).deviations
    for contributor, own in made.slices:
        if contributor.kind == "size":
            rows[:, own] = 0.0
    names = ["corner x", "corner y"]
    x, y = (
        torsors.values(made.system.assembly, rows, names)[name]
        if method == "analytic"
        else placing.values(made.system.assembly, rows, names)[name][0]
        for name in names
    )
    # the middle of the hole, from the corner: y of the slot's middle has its own interval of 0.03
    lean = next(rows[0, own] for contributor, own in made.slices if contributor.name == "lean")
    assert np.abs(lean).max() > 0.0
    box = np.random.default_rng(3).uniform(-0.05, 0.05, (2_000_000, 2))
    ends = np.array([-lean[:2], -lean[-2:]]) if len(lean) == 4 else np.array([lean, -lean])
    inside = (np.linalg.norm(box[:, None] - ends[None], axis=2) <= 0.05).all(axis=1)
    lens = box[inside]
    across = np.random.default_rng(4).uniform(-0.03, 0.03, len(lens))
    turn = (across - lens[:, 1]) / 120
    corner = np.stack([lens[:, 0] - 80 * turn, lens[:, 1] + 300 * turn], axis=1)
    for found, other in ((x, corner[:, 0]), (y, corner[:, 1])):
        errors = 4 / math.sqrt(2 * len(found)) + 4 / math.sqrt(2 * len(lens))
        assert found.std() == pytest.approx(other.std(), rel=errors)
        assert np.abs(found).max() < np.abs(other).max() + 1e-3


def four(floating: str, tmp_path: Path) -> Assembled:
    at = ((-30.0, -20.0), (30.0, -20.0), (30.0, 20.0), (-30.0, 20.0))
    return assembled(pinned_plates(at, 10.2, 10.0, floating), tmp_path)


THREE = np.array([(-10.0, 5.0), (70.0, -20.0), (30.0, 60.0)])
"""Pins off the middle."""


def anywhere(rng: np.random.Generator, off: Array, clearances: Array, reach: float) -> Array:
    """Poses x, y, turn * reach (n, 3) anywhere in the room of THREE with holes off by some, by rejection."""
    half = np.array([0.13, 0.13, 0.16])
    box = rng.uniform(-half, half, (2_000_000, 3))
    for (a, b), (u, v), clearance in zip(THREE, off, clearances, strict=True):
        turn = box[:, 2] / reach
        box = box[np.hypot(box[:, 0] - turn * b + u, box[:, 1] + turn * a + v) <= clearance]
    assert (np.abs(box) < 0.98 * half).all()
    return box


@pytest.mark.parametrize("method", METHODS)
def test_a_random_pattern_is_uniform_in_its_room(tmp_path: Path, method: str) -> None:
    """Moments up to the second against rejection, in a room that no symmetry helps: one pin tight, two off."""
    count, reach = 6000, 60.0
    made = assembled(pinned_plates(THREE.tolist(), 10.2, 10.0, "{kind: random}"), tmp_path)
    rows = drawn(made.simulation, 0, count).deviations
    floats = next(own for contributor, own in made.slices if contributor.kind == "float")
    rows[:, : floats.start] = 0.0
    columns = {contributor.name: own.start for contributor, own in made.slices}
    for name, value in {"pin 1 x": 0.06, "hole 0 y": 0.03, "pin 2 size": 0.1, "hole 1 size": 0.02}.items():
        rows[:, columns[name]] = value
    assembly, names = made.system.assembly, ["x", "y", "turn"]
    if method == "exact":
        found = {name: own for name, (own, _) in placing.values(assembly, rows, names).items()}
    else:
        found = dict(torsors.values(assembly, rows, names))
    turn = (found["y"] - found["turn"] + 0.03) / 110  # from hole 0, which lies too high, to the edge
    poses = np.column_stack([found["x"], found["y"] - 100 * turn, turn * reach])
    expected = anywhere(
        np.random.default_rng(5), np.array([(0, 0.03), (-0.06, 0), (0, 0)]), np.array([0.1, 0.11, 0.05]), reach
    )
    assert len(expected) > 10 * count
    sigmas, error = expected.std(axis=0), 4 * math.sqrt(1.1 / count)
    assert np.abs(poses.mean(axis=0) - expected.mean(axis=0)) == pytest.approx(0, abs=(error * sigmas).max())
    its, own = (np.cov(each.T) / np.outer(sigmas, sigmas) for each in (expected, poses))
    assert own == pytest.approx(its, abs=math.sqrt(2) * error)
    share = np.max([np.hypot(poses[:, 0] - turn * b + u, poses[:, 1] + turn * a + v) / c for (a, b), (u, v), c in zip(
        THREE, [(0, 0.03), (-0.06, 0), (0, 0)], [0.1, 0.11, 0.05], strict=True)], axis=0)  # fmt: skip
    assert share.max() < 1 + (1e-9 if method == "analytic" else 5e-3)  # half of squared turns of 3e-3, 70 mm off


def test_where_a_ray_is_stated_no_chord_is_swept() -> None:
    """A pin in a hole of radius 2 mm: two of three trials state 0.3 of the way along x, one is swept to there."""
    asked: list[int] = []

    def way(place: Place, along: Array) -> Array:
        asked.append(along.shape[1])
        return way_along(place, along)

    offsets, rows = np.zeros((1, 2, 3)), np.eye(2)[None, :, :, None] * np.ones(3)
    uniforms = np.array([[np.nan, 0.9, np.nan], [np.nan, 0.5, np.nan], [0.65, 0.65, 0.65], [0.5, 0.5, 0.5]])
    along, share = ray(Place(offsets, np.full((1, 3), 2.0), rows), np.eye(2), uniforms, way)
    np.testing.assert_allclose(along, [[1.0, 1.0, 1.0], [0.0, 0.0, 0.0]], atol=1e-12)
    np.testing.assert_allclose(share, [0.3, 0.3, 0.3], atol=1e-12)
    assert {*asked} == {1}


@pytest.mark.parametrize("method", METHODS)
def test_a_pattern_pushed_along_x_goes_by_the_smallest_clearance(tmp_path: Path, method: str) -> None:
    made = four("{kind: toward, along: [1, 0, 0], at: upper.edge}", tmp_path)
    rows = np.zeros((3, made.system.assembly.width))
    sizes = {contributor.name: own.start for contributor, own in made.slices if contributor.kind == "size"}
    rows[1, sizes["pin 2 size"]] = 0.05
    rows[2, sizes["pin 2 size"]] = 0.25  # does not go in
    found = (
        {name: own for name, (own, _) in placing.values(made.system.assembly, rows, ["x", "y", "slack"]).items()}
        if method == "exact"
        else torsors.values(made.system.assembly, rows, ["x", "y", "slack"])
    )
    assert found["x"][0] == pytest.approx(0.1, abs=1e-9)
    assert 0.075 < found["x"][1] <= 0.1  # the others let it turn about the tight one
    assert found["slack"] == pytest.approx([0.1, 0.075, -0.025], abs=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_a_weight_off_the_middle_lowers_each_hole_by_the_clearance_of_its_pin(tmp_path: Path, method: str) -> None:
    """Pins at 60 and 120 mm, the weight at 100: it sinks by (20 c1 + 40 c2) / 60, for both pins carry some of it."""
    at = ((60.0, 0.0), (120.0, 0.0))
    hung = assembled(pinned_plates(at, 10.2, 10.0, "{kind: toward, along: [0, -1, 0], at: upper.edge}"), tmp_path)
    rows = np.zeros((2, hung.system.assembly.width))
    rows[1, next(own.start for contributor, own in hung.slices if contributor.name == "pin 1 size")] = 0.05
    if method == "exact":
        found, _ = placing.values(hung.system.assembly, rows, ["y"])["y"]
    else:
        found = torsors.values(hung.system.assembly, rows, ["y"])["y"]
    assert found == pytest.approx([-0.1, -(20 * 0.1 + 40 * 0.075) / 60], abs=1e-8)


@pytest.mark.parametrize("method", METHODS)
def test_a_plate_hangs_on_two_pins_as_low_as_both_clearances_let_it(tmp_path: Path, method: str) -> None:
    """Problem 11c: clearances c = 0.1, the pins e too far apart, the weight midway: -sqrt(c² - e²/4); the mean and
    sigma of e in N(0, 0.04) by quadrature, no build beyond 2c."""
    at = ((60.0, 0.0), (140.0, 0.0))  # the upper edge is midway
    hung = assembled(pinned_plates(at, 10.2, 10.0, "{kind: toward, along: [0, -1, 0], at: upper.edge}"), tmp_path)
    nodes, weights = np.polynomial.hermite_e.hermegauss(60)
    apart = np.append(0.04 * nodes[np.abs(nodes) < 4.9], [0.12, 0.201])
    rows = np.zeros((len(apart), hung.system.assembly.width))
    rows[:, next(own.start for contributor, own in hung.slices if contributor.name == "pin 1 x")] = apart
    if method == "exact":
        found, codes = placing.values(hung.system.assembly, rows, ["y"])["y"]
        assert codes[-1] == NO_BUILD
        assert not codes[:-1].any()
    else:
        found = torsors.values(hung.system.assembly, rows, ["y"])["y"]
    np.testing.assert_allclose(found[:-1], -np.sqrt(0.01 - apart[:-1] ** 2 / 4), rtol=0, atol=1e-9)
    assert found[-2] == pytest.approx(-0.08, abs=1e-9)
    share = weights[np.abs(nodes) < 4.9] / math.sqrt(2 * math.pi)
    mean = share @ found[:-2]
    assert mean == pytest.approx(-0.0979326, abs=2e-7)
    assert math.sqrt(share @ (found[:-2] - mean) ** 2) == pytest.approx(0.0030360, abs=2e-6)
    assert 2 * norm.sf(0.2 / 0.04) == pytest.approx(5.733e-7, rel=1e-3)


def test_the_pair_that_does_not_go_in_is_named(tmp_path: Path) -> None:
    made = four("{kind: centred}", tmp_path)
    rows = np.zeros((2, made.system.assembly.width))
    sizes = {contributor.name: own.start for contributor, own in made.slices if contributor.kind == "size"}
    rows[1, sizes["hole 2 size"]] = -0.3
    found, columns = placing.answers(made.system.assembly, rows, ["slack", "x"])
    assert columns["tightest:together"][1] == "lower.pin 2 in upper.hole 2"
    assert columns["reason:x"].tolist() == ["", "lower.pin 2 in upper.hole 2"]
    assert "reason:slack" not in columns  # it has its value all the same
    assert found["slack"][0] == pytest.approx([0.1, -0.05], abs=1e-9)
    assert np.isnan(found["x"][0]).tolist() == [False, True]


def test_the_pair_is_named_whose_clearance_adds_most_to_the_slack(tmp_path: Path) -> None:
    """Its multipliers sum to the slope of the slack by its clearance; no symmetry, and slopes 1 % apart."""
    made = assembled(pinned_plates(THREE.tolist(), 10.1, 10.0), tmp_path)
    rows = drawn(made.simulation, 0, 30).deviations
    values, columns = placing.answers(made.system.assembly, rows, ["slack"])
    slack, told = values["slack"][0], columns["tightest:together"]
    slopes = []
    for k in range(len(THREE)):
        (column,) = (own.start for contributor, own in made.slices if contributor.name == f"hole {k} size")
        wider = rows.copy()
        wider[:, column] += 2e-5
        slopes.append((placing.values(made.system.assembly, wider, ["slack"])["slack"][0] - slack) / 1e-5)
    np.testing.assert_allclose(np.sum(slopes, axis=0), 1.0, atol=1e-3)
    _, middle, largest = np.sort(slopes, axis=0)
    clear = largest - middle > 0.01
    assert clear.sum() > 10
    names = np.array([f"lower.pin {k} in upper.hole {k}" for k in range(len(THREE))])
    np.testing.assert_array_equal(told[clear], names[np.argmax(slopes, axis=0)][clear])
    assert len(np.unique(told[clear])) == len(THREE)


def test_of_two_pairs_that_hold_each_other_the_first_is_named_whatever_the_rounding(tmp_path: Path) -> None:
    """Two pins push a plate as hard, or one alone is tight: a change of 1e-14 mm names no other (one in thirty did)."""
    made = Assembled(simulation_of(load(SCENES / "two_plates.yaml"), Overrides()))
    rows = drawn(made.simulation, 0, 2000).deviations
    found = [
        placing.answers(made.system.assembly, own, ["edge"])[1]
        for own in (rows, rows + 1e-14 * np.random.default_rng(1).uniform(-1, 1, rows.shape))
    ]
    for name in ("tightest:plate on plate", "reason:edge"):
        np.testing.assert_array_equal(found[0][name], found[1][name])
    assert (found[0]["reason:edge"] != "").sum() > 50
    apart = assembled(pinned_plates(((-20.0, 5.0), (60.0, 5.0)), 10.2, 10.0), tmp_path)
    columns = {contributor.name: own.start for contributor, own in apart.slices}
    tight = np.zeros((4, apart.system.assembly.width))
    tight[:, columns["hole 1 x"]] = [0.05, -0.05, 0.3, -0.3]
    told = placing.answers(apart.system.assembly, tight, ["x"])[1]
    assert set(told["tightest:together"]) == {"lower.pin 0 in upper.hole 0"}
    assert told["reason:x"].tolist() == ["", "", *2 * ["lower.pin 0 in upper.hole 0"]]


def test_a_run_names_the_pair_that_most_often_does_not_go_in(tmp_path: Path) -> None:
    """In its warning, with its share of the builds that failed; all pairs with their counts in its summary."""
    run = run_scene(SCENES / "two_plates.yaml", overrides=Overrides(trials=2000), out=tmp_path / "run")
    columns, found = run.columns("reason:edge", "status:edge"), run.summary
    failed = columns["status:edge"] == "no build"
    names, counts = np.unique(columns["reason:edge"][failed], return_counts=True)
    summary = found["measures"]["edge"]
    assert summary["reasons"] == dict(zip(names.tolist(), counts.tolist(), strict=True))
    assert (columns["reason:edge"][~failed] == "").all()
    assert counts.sum() == failed.sum() == summary["status"]["no build"] > 50
    (warning,) = (own for own in found["warnings"] if own.startswith("edge: ") and "% of 2000 builds could not" in own)
    most = f"{100 * counts.max() / counts.sum():.3g} % of them by {names[counts.argmax()]}"
    assert f" could not be assembled ({counts.sum()} do not fit together; {most}); mean" in warning


FIXED = "  set 1: {kind: fix, part: plate}\n  set 2: {kind: fix, part: key}\n"

WRONG: dict[str, tuple[Sequence[tuple[str, str]], str]] = {
    "no size": (
        [
            ("  slot size: {kind: size", "  #"),
            (" of: plate.slot, distribution: {kind: normal, mean: 0 um, sigma: 10 um}}\n", "\n"),
        ],
        "moves.plate on the pins.pairs[1].from: expected a size tolerance of 'plate.slot', because the play "
        "depends on it, got none; a size that does not vary "
        "is {kind: size, ..., distribution: {kind: constant, value: 0 mm}}",
    ),
    "smaller than its pin": (
        [("diameter: 10.1 mm", "diameter: 9.9 mm")],
        "moves.plate on the pins.pairs[0]: expected a size of 'plate.hole' above that of 'base.pin 1' at the mean, got "
        "100 um under it; nothing could be assembled",
    ),
    "two holes": (
        [("{from: plate.hole, to: base.pin 1}", "{from: plate.hole, to: base.keyway}")],
        "moves.plate on the pins.pairs[0]: expected a pin or tab and a hole or slot, got two holes or slots, "
        "'plate.hole' and 'base.keyway'",
    ),
    "a plane": (
        [("{from: plate.hole, to: base.pin 1}", "{from: plate.hole, to: base.top}")],
        "moves.plate on the pins.pairs[0]: expected a pin or tab and a hole or slot, got 'base.top', which is a plane",
    ),
    "slot first": (
        [("{from: plate.hole, to: base.pin 1}", "{from: plate.slot, to: base.pin 1}")],
        "moves.plate on the pins.pairs[0]: expected a pin in a hole first, which holds both shifts, got a slot; put it "
        "second, or take a pattern",
    ),
    "no float": (
        [("    float: {kind: random} ", "    # ")],
        "moves.plate on the pins.float: expected the position of the part within its play (no default): "
        "{kind: centred}, {kind: random} or {kind: toward, along: …, at: …}, got none",
    ),
    "float as a word": (
        [("float: {kind: random} ", "float: random ")],
        "moves.plate on the pins.float: expected the position of the part within its play, such as {kind: random}, "
        "got 'random'",
    ),
    "outside": (
        [("hole: {kind: cylinder, at: [0 mm, 0 mm, 4 mm]", "hole: {kind: cylinder, at: [0 mm, 0 mm, 40 mm]")],
        "moves.plate on the pins.pairs[0]: expected features that share a stretch nominally, got 'base.pin 1' outside "
        "'plate.hole'; place the parts, or say whose ends count as `over`",
    ),
    "askew": (
        [
            (
                "hole: {kind: cylinder, at: [0 mm, 0 mm, 4 mm], axis: [0, 0, 1]",
                "hole: {kind: cylinder, at: [0 mm, 0 mm, 4 mm], axis: [0, 0.1, 1]",
            )
        ],
        "moves.plate on the pins.pairs[0]: expected a pin nominally along the axis of its hole, got "
        "'base.pin 1' at an angle",
    ),
    "pushed where it is held": (
        [("along: [0, 1, 0], at: key.tip", "along: [0, 0, 1], at: key.tip")],
        "moves.key in its way: key.tip does not move along its direction: it is held there",
    ),
    "play of nothing": (
        [(PLATE[PLATE.index("  plate on the pins:\n") : PLATE.index("\nmeasures:")], FIXED)],
        "measures.corner y at most.over_play: expected a move of kind pin_and_hole or pattern, which leaves play, got "
        "none; leave it out",
    ),
    "slack of another move": (
        [("measures:\n", "measures:\n  room: {kind: slack, of: table}\n")],
        "measures.room.of: expected the name of a move with play, got 'table', which is a fixed part; known here: "
        "plate on the pins, key in its way",
    ),
}


@pytest.mark.parametrize(("edits", "said"), WRONG.values(), ids=WRONG)
def test_what_is_wrong_is_said_once(edits: Sequence[Edit], said: str, tmp_path: Path) -> None:
    assert refusal(edited(PLATE, *edits), tmp_path).splitlines()[0] == said
