"""Gears in a housing read as gears whose axes deviate by tolerances of their own, trial by trial."""

import math
from pathlib import Path

import numpy as np
import pytest
from machine.housed import ALONG, APART, GEARS, LAID, SHAFTS, gearbox_of, housed_scene, plain_scene, system_of, values
from numpy.typing import NDArray

from tol3d import Overrides, run_scene
from tol3d.gears import SpurPair
from tol3d.study.system.stated import mean_deviations, stated
from tol3d.study.system.system import System

Array = NDArray[np.float64]

SAME = 1e-9  # mm: a thousandth of a nanometre
THICK = "\n  thickness: {kind: tooth_thickness, of: pinion, distribution: {kind: normal, lower: -60 um, upper: -30 um}}"
LAW = "distribution: {kind: normal, lower: -30 um, upper: 30 um}"
METHODS = ("exact", "analytic")
ALONE = """
  first in bores: {kind: shaft_in_bores, shaft: pinion, in: [housing.bore 1]}
  last in bores: {kind: shaft_in_bores, shaft: wheel, in: [housing.bore 2]}
  stage: {kind: mesh, driver: pinion, driven: wheel}"""
LAID_AT = LAID.replace("housing.bore 1b]", "housing.bore 1b], at: 34 mm")
DIRECTION = f"[{ALONG[0]!r}, {ALONG[1]!r}, 0]"


def turns(count: int) -> Array:
    return np.random.default_rng(5).random(count)


def spread(seed: int, count: int = 60, size: float = 0.03) -> Array:
    return np.random.default_rng(seed).uniform(-size, size, count)


def both(housed: System, plain: System, method: str, mine: dict[str, Array], its: dict[str, Array]) -> None:
    """The same backlashes; the wheel of the plain scene lies at another azimuth, which a gear without eccentricity
    does not see."""
    count = len(next(iter(mine.values())))
    found, expected = values(housed, method, mine, turns(count)), values(plain, method, its, turns(count))
    assert np.ptp(expected["backlash"]) > 1e-3  # the deviations do something
    np.testing.assert_allclose(found["backlash"], expected["backlash"], rtol=0, atol=SAME)


def test_a_bore_s_dimension_is_a_centre_distance_trial_by_trial(tmp_path: Path) -> None:
    """The same name and law, and so the same draws: two whole runs."""
    housed, plain = tmp_path / "housed.yaml", tmp_path / "plain.yaml"
    f = f"\n  f: {{kind: plus_minus, of: housing.bore 2, along: {DIRECTION}, {LAW}}}"
    housed.write_text(housed_scene(tolerances=f + THICK, parts=GEARS, moves=ALONE), "utf-8")
    f = f"\n  f: {{kind: centre_distance, of: stage, {LAW}}}"
    plain.write_text(plain_scene(tolerances=f + THICK, parts=GEARS), "utf-8")
    runs = [
        run_scene(path, overrides=Overrides(trials=2000, seed=7), out=tmp_path / path.stem).columns()
        for path in (housed, plain)
    ]
    assert np.array_equal(runs[0]["f [um]"], runs[1]["f [um]"])
    for method in ("analytic", "geometric"):
        name = f"{method}:backlash"
        np.testing.assert_allclose(runs[0][name], runs[1][name], rtol=0, atol=1e-6, err_msg=name)  # um


@pytest.mark.parametrize("method", METHODS)
def test_a_bore_s_position_in_a_flat_zone_is_a_centre_distance(method: str, tmp_path: Path) -> None:
    """Law `process` with the distribution of the centre distance; both ends of the bore lie aside alike."""
    zone = f"zone: {{width: 100 um, along: {DIRECTION}}}, law: {{kind: process, {LAW}}}"
    position = f"\n  f: {{kind: position, of: housing.bore 2, datums: [floor, side, front], {zone}}}"
    housed = gearbox_of(housed_scene(tolerances=position, parts=GEARS, moves=ALONE), tmp_path)
    plain = system_of(
        plain_scene(tolerances=f"\n  f: {{kind: centre_distance, of: stage, {LAW}}}", parts=GEARS), tmp_path
    )
    aside = spread(1)
    both(housed, plain, method, {"f.start": aside, "f.end": aside}, {"f": aside})


@pytest.mark.parametrize("method", METHODS)
def test_bores_that_lie_aside_tilt_a_shaft_as_bearings_with_clearance_do(method: str, tmp_path: Path) -> None:
    """Each bore where a bearing is, and half of its clearance away; both shafts, in any direction."""
    bores = {"bore 1": -34.0, "bore 1b": 26.0, "bore 2": -32.0, "bore 2b": 28.0}  # along the shafts
    shafts = dict(zip(bores, ("first shaft",) * 2 + ("last shaft",) * 2, strict=True))
    angles = dict(zip(bores, (20.0, 100.0, -75.0, 230.0), strict=True))  # from the first axis's x, in the world
    along = math.degrees(math.atan2(ALONG[1], ALONG[0]))
    mine = "".join(
        f"\n  of {bore}: {{kind: plus_minus, of: housing.{bore}, "
        f"along: [{math.cos(math.radians(angle))}, {math.sin(math.radians(angle))}, 0], {LAW}}}"
        for bore, angle in angles.items()
    )
    housed = gearbox_of(housed_scene(tolerances=mine, moves=LAID_AT), tmp_path)
    for own, bore in zip(
        (point for shaft in housed.bores.shafts for point in ((shaft, 0), (shaft, 1))), bores, strict=True
    ):
        assert own[0].along(own[0].bores[own[1]]) == pytest.approx(bores[bore])
    bearings = "".join(
        f"\n  in {bore}: {{kind: bearing, shaft: {shafts[bore]}, at: {z} mm}}" for bore, z in bores.items()
    )
    # the x of the first shaft is the world's; the mesh of the plain scene lies at azimuth 0, and so does its wheel's x
    seen = {bore: angle - along if bore.startswith("bore 2") else angle for bore, angle in angles.items()}
    its = "".join(
        f"\n  of {bore}: {{kind: bearing_clearance, of: in {bore}, direction: {{at: {angle} deg}}, {LAW}}}"
        for bore, angle in seen.items()
    )
    text = plain_scene(tolerances=its, parts=SHAFTS + GEARS + bearings, mesh=f", azimuth: {along} deg")
    plain = system_of(text, tmp_path)
    deviations = {f"of {bore}": spread(k) for k, bore in enumerate(bores)}
    both(housed, plain, method, deviations, {name: 2 * own for name, own in deviations.items()})


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("datums", ["", ", datums: [floor, side, front]", ", datums: [floor, bore 1]"])
def test_a_warm_housing_moves_its_bores_as_it_opens_a_centre_distance(method: str, datums: str, tmp_path: Path) -> None:
    """a alpha (T - 20 degC), whatever the datums to which the bores are toleranced; the gears grow by themselves."""
    law = "distribution: {kind: uniform, lower: -50 K, upper: 80 K}"
    warm = f"\n  warm: {{kind: temperature, of: [housing, pinion, wheel], {law}}}"
    zone = "zone: {diameter: 10 um}, law: {kind: uniform}"
    positions = "".join(
        f"\n  of {bore}: {{kind: position, of: housing.{bore}{datums}, {zone}}}" for bore in ("bore 2", "bore 2b")
    )
    housed = gearbox_of(housed_scene(tolerances=warm + positions), tmp_path)
    old = "\n  housing: {kind: housing, expansion: 23e-6 1/K}"
    plain = system_of(plain_scene(tolerances=warm, parts=SHAFTS + GEARS + old, mesh=", housing: housing"), tmp_path)
    kelvin = 1000 * spread(3)
    both(housed, plain, method, {"warm": kelvin}, {"warm": kelvin})
    assert housed.closed_form(housed.measures[0]) is not None


@pytest.mark.parametrize("leans", [False, True])
def test_one_temperature_of_gears_and_housing_is_one_variable_in_the_closed_form(leans: bool, tmp_path: Path) -> None:
    """Its effects by the bores and by the gears are added before squaring; leaning shafts change nothing in it."""
    law = "distribution: {kind: normal, mean: 20 K, sigma: 8 K}"
    warm = f"\n  warm: {{kind: temperature, of: [housing, pinion, wheel], {law}}}"
    lean = "\n  lean: {kind: position, of: housing.bore 2b, zone: {diameter: 1e-6 um}, law: {kind: uniform}}"
    housed = gearbox_of(housed_scene(tolerances=warm + (lean if leans else "")), tmp_path)
    old = "\n  housing: {kind: housing, expansion: 23e-6 1/K}"
    parts = SHAFTS + GEARS + old
    plain = system_of(plain_scene(tolerances=warm, parts=parts, mesh=", housing: housing"), tmp_path)
    found, expected = (own.closed_form(own.measures[0]) for own in (housed, plain))
    assert found is not None
    assert expected is not None
    assert found.mean == pytest.approx(expected.mean, rel=1e-4 if leans else 1e-9)
    assert found.sigma == pytest.approx(expected.sigma, rel=1e-3 if leans else 1e-9)


def test_the_centre_distance_follows_from_the_bores(tmp_path: Path) -> None:
    housed = gearbox_of(housed_scene(tolerances=THICK), tmp_path)
    (mesh,) = housed.gears.model.meshes
    assert isinstance(mesh.pair, SpurPair)
    assert mesh.pair.centre_distance == pytest.approx(APART, abs=1e-12)
    assert np.degrees(mesh.azimuth) == pytest.approx(np.degrees(np.arctan2(45.0, 60.1)), abs=1e-9)


def test_the_closed_form_has_the_means_of_all_bores(tmp_path: Path) -> None:
    """Four bores whose means differ, gears off the middle: the mean is the 3D backlash of the build at all means.

    Read in the middle of the faces a backlash is linear in them but for 0.05 mm squared over 75 mm.
    """
    means = {"1": (10.0, -20.0), "1b": (35.0, 5.0), "2": (-15.0, 40.0), "2b": (60.0, 25.0)}
    tolerances = "".join(
        f"\n  {name} {axis}: {{kind: plus_minus, of: housing.bore {name}, along: {along}, "
        f"distribution: {{kind: normal, mean: {mean} um, sigma: 3 um}}}}"
        for name, both_means in means.items()
        for axis, along, mean in zip("xy", ([1, 0, 0], [0, 1, 0]), both_means, strict=True)
    )
    measures = "\n  backlash: {kind: normal_backlash, of: stage, read_at: mean_section}"
    housed = gearbox_of(housed_scene(tolerances=THICK + tolerances, measures=measures, moves=LAID_AT), tmp_path)
    measure = housed.measures[0]
    form = housed.closed_form(measure)
    assert form is not None
    trials = stated(housed, mean_deviations(housed, measure.positions))
    for name, within in (("exact", 1e-4), ("analytic", 1e-9)):
        method = housed.method(name, housed.materials(name))
        value = float(method.answers(trials, (measure,)).values[measure.name][0, 0])
        assert form.mean == pytest.approx(value, abs=within), name
    assert abs(form.mean - form.nominal) > 5e-3


@pytest.mark.parametrize("method", METHODS)
def test_a_housing_without_a_tolerance_of_its_own_leaves_the_gears_theirs(method: str, tmp_path: Path) -> None:
    """No column moves its bores: nothing of the assembly is drawn."""
    housed = gearbox_of(housed_scene(tolerances=THICK), tmp_path)
    plain = system_of(plain_scene(tolerances=THICK), tmp_path)
    mine = {"thickness": spread(9) - 0.045}
    both(housed, plain, method, mine, mine)
    for own, its in zip(housed.measures, plain.measures, strict=True):
        form, expected = housed.closed_form(own), plain.closed_form(its)
        assert form is not None
        assert expected is not None
        assert (form.mean, form.sigma) == pytest.approx((expected.mean, expected.sigma), rel=1e-12)
