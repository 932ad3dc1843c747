"""Two meshes on one shaft vary together, a housing that moves as a whole changes nothing, and moments by hand."""

import math
from pathlib import Path

import numpy as np
import pytest
from machine.housed import FOUR_BORES, gearbox_of, housed_scene, values
from numpy.typing import NDArray
from scene_texts import written

from tol3d import Overrides, run_scene

Array = NDArray[np.float64]

IDLER = """
  pinion: {kind: spur_gear, teeth: 20, module: 2.5 mm, face_width: 20 mm}
  idler: {kind: spur_gear, teeth: 40, module: 2.5 mm, face_width: 18 mm}
  wheel: {kind: spur_gear, teeth: 30, module: 2.5 mm, face_width: 20 mm}"""
LOCATED = """
  base:
    kind: three_two_one
    part: housing
    primary: [{from: housing.p1, to: table.top}, {from: housing.p2, to: table.top}, {from: housing.p3, to: table.top}]
    secondary: [{from: housing.p4, to: table.back}, {from: housing.p5, to: table.back}]
    tertiary: [{from: housing.p6, to: table.left}]"""
TABLE = """
  table:
    kind: solid
    features:
      top: {kind: plane, at: [0 mm, 0 mm, -40 mm], normal: [0, 0, 1], extent: [400 mm, 400 mm]}
      back: {kind: plane, at: [0 mm, -50 mm, 0 mm], normal: [0, 1, 0], extent: [400 mm, 400 mm]}
      left: {kind: plane, at: [-60 mm, 0 mm, 0 mm], normal: [1, 0, 0], extent: [400 mm, 400 mm]}"""
POINTS = """
      p1: {kind: point, at: [-50 mm, -40 mm, -40 mm]}
      p2: {kind: point, at: [90 mm, -40 mm, -40 mm]}
      p3: {kind: point, at: [20 mm, 60 mm, -40 mm]}
      p4: {kind: point, at: [-40 mm, -50 mm, 0 mm]}
      p5: {kind: point, at: [80 mm, -50 mm, 0 mm]}
      p6: {kind: point, at: [-60 mm, 0 mm, 10 mm]}"""
LAW = "distribution: {kind: uniform, lower: -30 um, upper: 30 um}"
PAIRS = ("primary 1", "primary 2", "primary 3", "secondary 1", "secondary 2", "tertiary 1")


def three_bores(angle: float) -> str:
    """Bores of pinion, idler and wheel; the wheel at an angle [deg] from the line of the first two."""
    x, y = 75.2 + 87.7 * math.cos(math.radians(angle)), 87.7 * math.sin(math.radians(angle))
    places = {"bore 1": (0.0, 0.0), "bore 2": (75.2, 0.0), "bore 3": (x, y)}
    return "".join(
        f"\n      {name}: {{kind: cylinder, at: [{x!r} mm, {y!r} mm, 0 mm], axis: [0, 0, 1], length: 40 mm, "
        "diameter: 30 mm, hole: true}"
        for name, (x, y) in places.items()
    )


@pytest.mark.parametrize("angle", [0.0, 60.0, 130.0])
def test_meshes_that_share_a_bore_vary_together_as_worked_out_by_hand(angle: float, tmp_path: Path) -> None:
    """The bore of the idler anywhere in Ø t, both ends alike independent: its middle has t²/32 along any axis, since an
    end uniform in a disc of t/2 has t²/16. It opens the first mesh along u, from pinion to idler, and closes the second
    along v, from idler to wheel, 2 sin(alpha_w) each: the covariance is -4 sin sin (u . v) t²/32."""
    t, count = 0.06, 20_000
    moves = """
  a: {kind: shaft_in_bores, shaft: pinion, in: [housing.bore 1]}
  b: {kind: shaft_in_bores, shaft: idler, in: [housing.bore 2]}
  c: {kind: shaft_in_bores, shaft: wheel, in: [housing.bore 3]}
  first: {kind: mesh, driver: pinion, driven: idler}
  second: {kind: mesh, driver: idler, driven: wheel}"""
    read = "read_at: mean_section"  # where the leaning of an axis is not seen
    measures = f"""
  one: {{kind: normal_backlash, of: first, {read}}}
  two: {{kind: normal_backlash, of: second, {read}}}"""
    position = "\n  p: {kind: position, of: housing.bore 2, zone: {diameter: 60 um}, law: {kind: uniform}}"
    path = tmp_path / "scene.yaml"
    path.write_text(
        housed_scene(tolerances=position, features=three_bores(angle), parts=IDLER, moves=moves, measures=measures),
        "utf-8",
    )
    run = run_scene(path, overrides=Overrides(trials=count, seed=4), out=tmp_path / "run")
    # working pressure angles: a cos(alpha_w) = m (z1 + z2) / 2 cos(20 deg)
    sines = [
        math.sqrt(1 - (1.25 * teeth * math.cos(math.radians(20)) / apart) ** 2)
        for teeth, apart in ((60, 75.2), (70, 87.7))
    ]
    expected = -4 * sines[0] * sines[1] * math.cos(math.radians(angle)) * t**2 / 32
    variances = [4 * sine**2 * t**2 / 32 for sine in sines]
    # of products of two variables of which each is bounded; 4 standard errors of a covariance of normals are more
    error = 4 * math.sqrt((variances[0] * variances[1] + expected**2) / count)
    columns = run.columns()
    for method in ("analytic", "geometric"):
        one, two = columns[f"{method}:one"] / 1000, columns[f"{method}:two"] / 1000
        assert abs(np.cov(one, two)[0, 1] - expected) < error + 2e-3 * abs(expected)  # and what is of second order
        for own, variance in ((one, variances[0]), (two, variances[1])):
            assert own.var() == pytest.approx(variance, rel=4 * math.sqrt(2 / count) + 2e-3)
    for name, variance in zip(("one", "two"), variances, strict=True):
        form = run.summary["measures"][name]["analytic_closed_form"]
        assert form["sigma"] == pytest.approx(1000 * math.sqrt(variance), rel=1e-6)


@pytest.mark.parametrize("method", ["exact", "analytic"])
def test_a_housing_that_stands_askew_as_a_whole_changes_no_backlash(method: str, tmp_path: Path) -> None:
    """Locators move and turn it by up to a millimetre over its length; both axes go along."""
    locators = "".join(
        f"\n  {pair}: {{kind: locator, of: base, pair: {pair}, {LAW.replace('30 um', '1 mm')}}}" for pair in PAIRS
    )
    f = f"\n  f: {{kind: plus_minus, of: housing.bore 2b, along: [0, 1, 0], {LAW}}}"
    scene = housed_scene(
        tolerances=f + locators,
        features=FOUR_BORES + POINTS,
        fixed="\n  set: {kind: fix, part: table}" + LOCATED,
        more=TABLE,
    )
    system = gearbox_of(scene, tmp_path)
    draws = np.random.default_rng(2)
    count = 40
    turns, own = draws.random(count), draws.uniform(-0.03, 0.03, count)
    still = values(system, method, {"f": own}, turns)["backlash"]
    drawn = {"f": own} | {pair: draws.uniform(-1, 1, count) for pair in PAIRS}
    moved = values(system, method, drawn, turns)["backlash"]
    assert np.ptp(still) > 1e-3
    np.testing.assert_allclose(moved, still, rtol=0, atol=1e-9)
    assert [each.name for each in system.acting(system.measures[0])] == ["f"]


@pytest.mark.parametrize("placed", ["{at: [10 mm, -20 mm, 5 mm], z: [1, 2, 2], x: [2, 1, -2]}", "{z: [0, 0, -1]}"])
def test_where_a_housing_stands_does_not_matter(placed: str, tmp_path: Path) -> None:
    f = f"\n  f: {{kind: plus_minus, of: housing.bore 2b, along: [0.6, 0.8, 0], {LAW}}}"
    draws = np.random.default_rng(3)
    turns, own = draws.random(30), draws.uniform(-0.03, 0.03, 30)
    plain = gearbox_of(housed_scene(tolerances=f), tmp_path)
    other = gearbox_of(housed_scene(tolerances=f, placed=placed), tmp_path)
    for method in ("exact", "analytic"):
        found, expected = (values(system, method, {"f": own}, turns)["backlash"] for system in (other, plain))
        # azimuths count from another x, so that other points of the teeth touch where an axis leans
        np.testing.assert_allclose(found, expected, rtol=0, atol=5e-7)


def test_the_closed_form_of_leaning_shafts_is_that_of_the_sample(tmp_path: Path) -> None:
    """Bores whose ends lie aside by themselves lean the shafts: no sum, so its moments are integrated."""
    zone = "zone: {diameter: 60 um}, law: {kind: uniform}"
    positions = "".join(
        f"\n  of {bore}: {{kind: position, of: housing.{bore}, {zone}}}" for bore in ("bore 1b", "bore 2", "bore 2b")
    )
    path = written(housed_scene(tolerances=positions), tmp_path)
    count = 40_000
    run = run_scene(path, overrides=Overrides(trials=count, engine="analytic", seed=2), out=tmp_path / "run")
    own = run.summary["measures"]["backlash"]
    form, sample = own["analytic_closed_form"], own["analytic"]
    assert form["mean"] == pytest.approx(sample["mean"], abs=4 * sample["sigma"] / math.sqrt(count))
    assert form["sigma"] == pytest.approx(sample["sigma"], rel=4 / math.sqrt(2 * count))
    assert form["mean"] < own["nominal"]["analytic"] - 0.5  # the leaning takes something on the mean
    assert sum(form["share_percent"].values()) == pytest.approx(100.0) if "share_percent" in form else True
