"""The stack-up against the paper's own table, against exact derivatives, and against its closed form."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gear_trials import drawn_trials
from of_kind import of_kind
from places import SPUR_PAIR

from tol3d import Overrides, Scene, load_scene, run_scene
from tol3d.gearing.methods.analytic import analytic_values
from tol3d.gearing.model import (
    AxisOffset,
    AxisTilt,
    Backlash,
    Contributor,
    Measure,
    Model,
    Planar,
    Positions,
    Reading,
    Scalar,
    Temperature,
    model_from_scene,
)
from tol3d.gearing.stack_up import analytic_backlash, closed_form, stack_of
from tol3d.gears import SpurGear, SpurPair
from tol3d.statistics.distributions import Normal, Rayleigh, Uniform

SIN, COS = math.sin(math.radians(20)), math.cos(math.radians(20))


@pytest.fixture(scope="module")
def model() -> Model:
    return model_from_scene(load_scene(SPUR_PAIR))


def with_contributors(model: Model, *contributors: Contributor) -> Model:
    return replace(model, contributors=contributors)


def test_closed_form_is_the_paper_s_table_with_its_inputs(model: Model) -> None:
    # Jiang et al. 2024, section 2.1: means and variances of the table, Tables 1 and 2, in um
    mean = (19 + 30) / 2 * COS + (21 + 32) / 2 * COS + (2 + 30) / 2 * SIN
    variance = {
        "pinion tooth thickness": 11**2 * COS**2 / 36,
        "wheel tooth thickness": 11**2 * COS**2 / 36,
        "centre distance": 4 / 9 * 20**2 * SIN**2,
        "wheel eccentricity": 31**2 * SIN**2 / 9,
        "bearing clearance": 28**2 * SIN**2 / 36,
        "pinion eccentricity": 27**2 * SIN**2 / 9,
        "reducer run-out": 8**2 * SIN**2 / 9,
    }
    form = closed_form(model, model.measures[0])
    assert form is not None
    assert form.mean * 1000 == pytest.approx(mean, abs=1e-9)
    assert mean == pytest.approx(53.397, abs=5e-4)
    assert form.sigma * 1000 == pytest.approx(math.sqrt(sum(variance.values())), abs=1e-9)
    assert form.sigma * 1000 == pytest.approx(7.216, abs=5e-4)
    for name, own in variance.items():
        assert form.percent(name) == pytest.approx(100 * own / sum(variance.values()), abs=1e-9)


def test_lost_motion_of_the_paper_s_mean(model: Model) -> None:
    # 0.12195 j_n / d degrees, j_n in um, d = 275 mm; the constant is printed to five digits
    form = closed_form(model, model.measures[1])
    assert form is not None
    assert math.degrees(form.mean) == pytest.approx(0.12195 * 53.3966 / 275, rel=1e-4)
    assert math.degrees(form.mean) * 3600 == pytest.approx(85.24, abs=0.01)


@pytest.mark.parametrize("direction", [None, 0.3])
@pytest.mark.parametrize("over", ["random", "at"])
@pytest.mark.parametrize("wheel_teeth", [110, 28])
def test_closed_form_is_what_the_sample_tends_to(
    model: Model, direction: float | None, over: str, wheel_teeth: int
) -> None:
    """Mean and sigma of 40 000 drawn rows within 4.5 standard errors of the closed form."""
    trials = 40_000
    pinion, wheel = (of_kind(SpurGear, part.gear) for part in model.gears)
    pair = SpurPair(pinion, replace(wheel, teeth=wheel_teeth), 35.0 + 1.25 * wheel_teeth)
    model = replace(model, meshes=(replace(model.meshes[0], pair=pair),))
    contributors = [
        replace(c, draw=replace(c.draw, direction=direction)) if isinstance(c.draw, Planar) else c
        for c in model.contributors
    ]
    free = Planar(Uniform(0.01, 0.03), direction)
    clearance = Contributor("free clearance", "", AxisOffset("pinion", factor=0.5), free, "um")
    tilts = (
        Contributor("in", "", AxisTilt("wheel", (0.0, 1.0, 0.0)), Scalar(Normal(0.0, 3e-4)), "mrad"),
        Contributor("out", "", AxisTilt("wheel", (1.0, 0.0, 0.0)), Scalar(Uniform(-2e-4, 3e-4)), "mrad"),
    )
    changed = with_contributors(model, *contributors, clearance, *tilts)
    positions = Positions("random", 55, 1) if over == "random" else Positions("at", 1, 1, 0.7)
    measure = Measure("j", model.measures[0].kind, positions, "value")
    form = closed_form(changed, measure)
    values = analytic_values(changed, measure, drawn_trials(changed, 5, 0, trials))[:, 0]
    assert form is not None
    assert values.mean() == pytest.approx(form.mean, abs=4.5 * form.sigma / math.sqrt(trials))
    # var of a sample's sigma is sigma^2/(2n) for a normal; uniform-like parts only make it smaller
    assert values.std() == pytest.approx(form.sigma, rel=4.5 / math.sqrt(2 * trials))


def test_tilt_loss_is_half_normal(model: Model) -> None:
    sigma = 2e-4
    tilt = Contributor("in", "", AxisTilt("wheel", (0.0, 1.0, 0.0)), Scalar(Normal(0.0, sigma)), "mrad")
    form = closed_form(with_contributors(model, tilt), model.measures[0])
    scale = 20 * SIN * sigma
    assert form is not None
    # |x| of a normal: mean sqrt(2/pi), variance 1 - 2/pi; the midpoint rule's error is a 1e-3 of them
    assert form.mean == pytest.approx(-scale * math.sqrt(2 / math.pi), rel=1e-3)
    assert form.sigma == pytest.approx(scale * math.sqrt(1 - 2 / math.pi), rel=2e-3)


@pytest.mark.parametrize("centre_distance", [172.3, 172.5, 173.1])
def test_linear_coefficients_are_the_derivatives_of_the_exact_backlash(model: Model, centre_distance: float) -> None:
    """Central differences of the exact pair, with the working pressure angle of its centre distance."""
    pair = replace(of_kind(SpurPair, model.meshes[0].pair), centre_distance=centre_distance)
    mesh = replace(model.meshes[0], pair=pair)
    shifted = replace(model, meshes=(mesh,))
    stack = stack_of(shifted, mesh, Reading())
    step = 1e-4

    def backlash(*, distance: float = 0.0, thickness: float = 0.0) -> float:
        wheel = replace(pair.wheel, tooth_thickness_deviation=thickness)
        return replace(pair, wheel=wheel, centre_distance=pair.centre_distance + distance).normal_backlash

    terms = {term.contributor.name: term for term in stack.terms}
    by_distance = (backlash(distance=step) - backlash(distance=-step)) / (2 * step)
    by_thickness = (backlash(thickness=step) - backlash(thickness=-step)) / (2 * step)
    # the third derivative times step^2/6 is under 1e-9
    assert terms["centre distance"].coefficient == pytest.approx(by_distance, abs=1e-8)
    assert terms["bearing clearance"].coefficient == pytest.approx(by_distance / 2, abs=1e-8)
    assert terms["wheel eccentricity"].coefficient == pytest.approx(by_distance, abs=1e-8)
    assert terms["wheel tooth thickness"].coefficient == pytest.approx(by_thickness, abs=1e-8)


def test_one_material_only_scales(model: Model) -> None:
    """Gears and housing of one material, 100 K warmer: the backlash grows by its own strain, no more."""
    steel = 11.5e-6
    gears = tuple(replace(part, expansion=steel) for part in model.gears)
    mesh = replace(model.meshes[0], housing="housing")
    housing = type("H", (), {"name": "housing", "expansion": steel})()
    warm = Contributor("t", "", Temperature(("pinion", "wheel", "housing")), Scalar(Uniform(0.0, 100.0)), "K")
    changed = replace(model, gears=gears, housings=(housing,), meshes=(mesh,), contributors=(warm,))
    value = analytic_backlash(changed, of_kind(Backlash, model.measures[0].kind), np.array([[100.0]]), np.zeros(1))[0]
    assert abs(value - mesh.pair.normal_backlash) < 1e-12


def test_aluminium_housing_opens_steel_gears(model: Model) -> None:
    # 2 sin(alpha_w) a (alpha_h - alpha_g) dT for 20 K: 27.14 um, more than any tolerance of the scene
    gears = tuple(replace(part, expansion=11.5e-6) for part in model.gears)
    mesh = replace(model.meshes[0], housing="housing")
    housing = type("H", (), {"name": "housing", "expansion": 23.0e-6})()
    warm = Contributor("t", "", Temperature(("pinion", "wheel", "housing")), Scalar(Uniform(0.0, 20.0)), "K")
    changed = replace(model, gears=gears, housings=(housing,), meshes=(mesh,), contributors=(warm,))
    value = analytic_backlash(changed, of_kind(Backlash, model.measures[0].kind), np.array([[20.0]]), np.zeros(1))[0]
    assert value == pytest.approx(2 * SIN * 172.5 * 11.5e-6 * 20, rel=1e-9)


def test_backlash_kinds_are_one_number_in_three_units(model: Model) -> None:
    row, angle = np.zeros((1, model.component_count)) - 0.01, np.array([0.3])
    normal, arc, turn, driver_turn = (
        analytic_backlash(model, kind, row, angle)[0]
        for kind in (
            Backlash("normal_backlash", "gear pair", "wheel"),
            Backlash("circumferential_backlash", "gear pair", "wheel"),
            Backlash("angular_backlash", "gear pair", "wheel"),
            Backlash("angular_backlash", "gear pair", "pinion"),
        )
    )
    assert arc == pytest.approx(normal / COS, rel=1e-12)
    assert turn == pytest.approx(normal / (137.5 * COS), rel=1e-12)
    assert driver_turn / turn == pytest.approx(110 / 28, rel=1e-12)


def test_rayleigh_length_in_a_random_direction_is_two_normals() -> None:
    drawn = Planar(Rayleigh(2.0), None)
    u = (np.arange(400) + 0.5) / 400
    grid = np.array([(a, b) for a in u for b in u])
    x, y = drawn.deviations(*grid.T)
    # midpoint rule over the unit square: the unbounded tail costs 0.5 %
    assert x.std() == pytest.approx(2.0, rel=5e-3)
    assert y.std() == pytest.approx(2.0, rel=5e-3)
    assert (x**4).mean() / x.var() ** 2 == pytest.approx(3.0, rel=2e-2)


@pytest.mark.parametrize(
    ("kind", "read_at", "loss"),
    [
        ("normal_backlash", "face", 1.0),
        ("normal_backlash", "face_contact", 0.5),
        ("normal_backlash", "mean_section", 0.0),
        ("circumferential_backlash", "face_contact", 1.0),  # from contact to contact, both over the face
        ("circumferential_backlash", "mean_section", 0.0),
    ],
)
def test_a_tilt_costs_half_its_loss_on_each_flank_side_that_is_read_over_the_face(
    kind: str, read_at: str, loss: float, tmp_path: Path
) -> None:
    """20 um of in-plane tilt over 20 mm of face close 20 um sin(20 deg), on both methods."""
    gear = {"kind": "spur_gear", "module": "2.5 mm", "face_width": "20 mm"}
    law = {"kind": "constant", "value": "20 um"}
    thin = {"kind": "tooth_thickness", "of": "wheel", "distribution": {"kind": "constant", "value": "-60 um"}}
    scene = Scene.model_validate(
        {
            "scene": "tilt",
            "parts": {"pinion": {**gear, "teeth": 28}, "wheel": {**gear, "teeth": 110}},
            "tolerances": {"thin": thin, "tilt": {"kind": "axis_in_plane", "of": "pair", "distribution": law}},
            "moves": {"pair": {"kind": "mesh", "driver": "pinion", "driven": "wheel", "centre_distance": "172.5 mm"}},
            "measures": {"play": {"kind": kind, "of": "pair", "read_at": read_at}},
        }
    )
    play = run_scene(scene, overrides=Overrides(trials=3), out=tmp_path / "run").summary["measures"]["play"]
    expected = 60 * math.cos(math.radians(20)) - loss * 20 * math.sin(math.radians(20))
    if kind == "circumferential_backlash":
        expected /= math.cos(math.radians(20))
    assert play["analytic"]["mean"] == pytest.approx(expected, abs=1e-9)
    assert play["geometric"]["mean"] == pytest.approx(expected, abs=0.1)
