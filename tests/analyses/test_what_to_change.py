"""Proposed changes: closed forms of a normal sum, and scenes changed as proposed and simulated again."""

import json
import math
import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scene_texts import scene_of
from scipy.stats import norm
from toys.parabola import PARABOLA
from toys.registered import TOYS, known

import tol3d
from tol3d import InputError, Overrides
from tol3d.analyses.changes_of_run import MOST_BUILDS, changes_of_run, not_ok
from tol3d.analyses.compared_builds import drawn_builds
from tol3d.analyses.response import Response, response_of
from tol3d.analyses.shown_changes import (
    changes_charts,
    changes_lines,
    changes_of_one,
    changes_report,
    contributions_table,
)
from tol3d.analyses.stated_changes import changed as changed_response
from tol3d.analyses.stated_changes import factor_of
from tol3d.analyses.subject import keep, sections_of
from tol3d.analyses.what_to_change import Changes, ChangesQuestion, changes_of, contributions_of
from tol3d.report.chart_figure import save_charts
from tol3d.report.page import page
from tol3d.report.sheet import as_text
from tol3d.scene import Scene
from tol3d.scene.bundled import bundled_scenes
from tol3d.simulate import load, simulation_of
from tol3d.statistics.distributions.normal import Normal
from tol3d.study.system.draw import Each, Scalar
from tol3d.study.system.plain import PlainContributor, PlainMeasure, PlainSystem
from tol3d.study.trials.simulation import Simulation
from tol3d.study.trials.study import Study
from tol3d.units import Quantity

Array = NDArray[np.float64]

TIGHT = {"measures.normal backlash.lower_limit": "48 um", "measures.normal backlash.upper_limit": "75 um"}

SLOPES, MEANS, SIGMAS = np.array([2.0, -1.0, 0.5]), np.array([0.3, 0.0, 1.0]), np.array([1.0, 3.0, 2.0])
SIGMA = float(np.linalg.norm(SLOPES * SIGMAS))
MEAN = float(SLOPES @ MEANS)


@dataclass(frozen=True)
class Formula(PlainSystem):
    """A measure that is a function of deviations (n, components)."""

    value: Callable[[Array], Array] = len  # type: ignore[assignment]

    def analytic(self, trials: Any, measure: Any) -> Array:
        return self.value(trials.deviations)

    def exact(self, trials: Any, measure: Any) -> Array:
        return self.value(trials.deviations)


def formula(value: Callable[[Array], Array], lower: float | None, upper: float | None, trials: int = 4000) -> Response:
    contributors = tuple(
        PlainContributor(f"x{k}", "x", Scalar(Normal(float(mean), float(sigma))), "um", 1.0)
        for k, (mean, sigma) in enumerate(zip(MEANS, SIGMAS, strict=True))
    )
    measure = PlainMeasure("value", "value", lower, upper, unit="um", per_internal=1.0)
    return response_of(Simulation(Formula("formula", contributors, (measure,), value), Study(trials=trials)))


def moves(own: Any) -> list[Any]:
    """Proposals of one nominal, by their steps."""
    return [each for each in own.proposals if len(each.steps) == 1 and each.steps[0].change is not None]


def halves(own: Any) -> list[Any]:
    """Proposals of one tolerance half as wide."""
    return [each for each in own.proposals if len(each.steps) == 1 and each.steps[0].change is None]


def asked(response: Response, builds: int = 4000, accepted: float = 2700.0) -> Any:
    return changes_of(response, ChangesQuestion("value", accepted, builds)).measures["value"]


def linear(x: Array) -> Array:
    return x @ SLOPES


def test_the_mean_of_a_sum_is_centred_by_each_nominal_by_shift_over_slope() -> None:
    """Exactly, for slopes of a sum are known and what the draws are off their means is taken out."""
    steps = {own.steps[0].contributor: own.steps[0] for own in moves(asked(formula(linear, -4.0, 12.0)))}
    assert {name: own.change for name, own in steps.items()} == pytest.approx(
        dict(zip(("x0", "x1", "x2"), (4.0 - MEAN) / SLOPES, strict=True)), rel=1e-6
    )
    assert {own.nominal for own in steps.values()} == {"nominal"}


def test_after_a_change_a_sum_is_as_its_closed_form_says() -> None:
    """Mean, sigma and Ppk within four standard errors of 20 000 builds; the true share lies in its interval."""
    own = asked(formula(linear, -4.0, 12.0, 20_000), 20_000)
    for moved in moves(own):
        assert moved.after.mean == pytest.approx(4.0, abs=4 * SIGMA / math.sqrt(20_000))
        assert moved.after.sigma == pytest.approx(SIGMA, rel=4 / math.sqrt(40_000))
        assert moved.after.ppk == pytest.approx(8.0 / (3 * SIGMA), rel=0.03)
        low, high = moved.after.out_ppm_95
        assert low < 2e6 * norm.sf(8.0 / SIGMA) < high
    for half in halves(own):
        narrow = np.where(half.steps[0].contributor == np.array(["x0", "x1", "x2"]), 0.5, 1.0) * SLOPES * SIGMAS
        assert half.after.sigma == pytest.approx(float(np.linalg.norm(narrow)), rel=4 / math.sqrt(40_000))
    assert [half.steps[0].contributor for half in halves(own)] == ["x1", "x0", "x2"]  # 9, 4 and 1 of the variance of 14
    assert halves(own)[0].steps[0].becomes == "normal -4.5 … 4.5 µm"


def test_one_limit_is_reached_for_the_ppk_asked_for() -> None:
    """By the least shift, and no row says less than that."""
    for ppk in (1.0, 1.33, 1.67):
        response = formula(linear, None, 4.0, 20_000)
        own = changes_of(response, ChangesQuestion("value", builds=20_000, ppk=ppk)).measures["value"]
        assert len(moves(own)) == 3
        for moved, slope in zip(sorted(moves(own), key=lambda each: each.steps[0].contributor), SLOPES, strict=True):
            assert moved.steps[0].change * slope == pytest.approx(4.0 - MEAN - 3 * ppk * SIGMA, rel=0.03)
            assert moved.after.ppk == pytest.approx(ppk, rel=1e-2)


def test_a_limit_below_asks_for_the_opposite_shift() -> None:
    above = {own.steps[0].contributor: own.steps[0].change for own in moves(asked(formula(linear, None, 4.0)))}
    below = moves(asked(formula(lambda x: -linear(x), -4.0, None)))
    assert len(above) == 3
    assert {own.steps[0].contributor: own.steps[0].change for own in below} == pytest.approx(above)


def test_the_best_row_is_told_first() -> None:
    """Of shares out of limits, then of Ppk; below a verdict as in the table."""
    own = asked(formula(linear, -4.0, 12.0))
    worth = [(each.after.out_ppm, -each.after.ppk) for each in own.proposals]
    assert worth == sorted(worth)
    assert own.now.out_ppm > worth[0][0]


def test_changes_together_reach_what_none_does_alone() -> None:
    """Of the middle 1 off: x1 halved leaves a sigma of 2.70, moved too Ppk 0.99; x0 beside it 2.06 and 1.29."""
    own = changes_of(formula(linear, -6.9, 8.9), ChangesQuestion("value", builds=5000, ppk=1.2)).measures["value"]
    best, *others = own.proposals
    assert len(best.steps) > 1
    assert best.reaches(1.2)
    assert not any(each.reaches(1.2) for each in others)
    halved = {step.contributor for step in best.steps if step.change is None}
    narrow = np.where([name in halved for name in ("x0", "x1", "x2")], 0.5, 1.0)
    assert best.after.sigma == pytest.approx(float(np.linalg.norm(narrow * SLOPES * SIGMAS)), rel=4 / math.sqrt(10_000))


def with_another(own: Callable[[Array], Array], lower: float | None, upper: float | None) -> Response:
    """The sum within -4 … 12, and beside it another measure of the same deviations."""
    response = formula(linear, -4.0, 12.0)
    system: Any = response.simulation.system
    beside = PlainMeasure("beside", "value", lower, upper, unit="um", per_internal=1.0)
    two = Two("two", system.contributors, (*system.measures, beside), linear, own)
    return response_of(Simulation(two, Study(trials=4000)))


@dataclass(frozen=True)
class Two(Formula):
    """With a second measure."""

    other: Callable[[Array], Array] = len  # type: ignore[assignment]

    def analytic(self, trials: Any, measure: Any) -> Array:
        return (self.value if measure.name == "value" else self.other)(trials.deviations)

    def exact(self, trials: Any, measure: Any) -> Array:
        return self.analytic(trials, measure)


def test_no_nominal_is_offered_that_harms_another_measure_with_limits() -> None:
    """x1 moves the other one, of sigma 3, by as much, away from where its Ppk is 1.1; the others do not move it."""
    limited = asked(with_another(lambda x: x[:, 1], -10.0, 10.0))
    assert {own.steps[0].contributor for own in moves(limited)} == {"x0", "x2"}
    wide = asked(with_another(lambda x: x[:, 1], -30.0, 30.0))
    assert {own.steps[0].contributor for own in moves(wide)} == {"x0", "x1", "x2"}


def test_what_a_change_does_to_measures_without_limits_stands_beside_it() -> None:
    """4 off by x1 of slope -1: the other one, thrice x1, moves by -3 times the shift; by x0 not at all."""
    own = asked(with_another(lambda x: 3 * x[:, 1], None, None))
    beside = {each.steps[0].contributor: each.beside for each in moves(own)}
    (other,) = beside["x1"]
    assert beside["x0"] == []
    assert other.after.mean - other.now.mean == pytest.approx(-3 * (4.0 - MEAN), rel=1e-6)


def test_a_magnitude_is_made_less_by_no_shift() -> None:
    """The length of two deviations of mean 0 lies beyond its limit: only less spread helps, of both alike."""
    own = asked(formula(lambda x: np.hypot(x[:, 1], 3 * SIGMAS[0] * (x[:, 0] - MEANS[0])), None, 8.0))
    assert own.now.out_ppm > 10_000
    assert moves(own) == []
    one, other = halves(own)
    assert {one.steps[0].contributor, other.steps[0].contributor} == {"x0", "x1"}
    assert one.after.sigma == pytest.approx(other.after.sigma, rel=0.05)


def test_a_mean_off_nominal_is_told_by_contributor() -> None:
    """x0 + x1² / 10 + x2: means of 0.6 and 0.5 by the first order, 0.9 by the second, of the variance 9."""
    own = asked(formula(lambda x: linear(x) - x[:, 1] * SLOPES[1] + 0.1 * x[:, 1] ** 2, None, 2.0))
    taken = {each.contributor: (each.first_order, each.second_order) for each in own.taken}
    assert own.nominal == pytest.approx(0.0, abs=1e-12)
    assert taken["x0"] == pytest.approx((0.6, 0.0), abs=1e-6)
    assert taken["x1"] == pytest.approx((0.0, 0.9), abs=1e-6)
    assert taken["x2"] == pytest.approx((0.5, 0.0), abs=1e-6)
    assert abs(own.taken_together) < 4 * own.taken_error


def test_the_mean_of_several_equal_components_moves_their_least_one_once() -> None:
    """A measure: the least of three gaps, all 0.7 at the mean build, and half of another deviation."""
    contributors = (
        PlainContributor("g", "x", Each(Normal(0.7, 0.2), ("1", "2", "3")), "um", 1.0),
        PlainContributor("x", "x", Scalar(Normal(1.0, 0.1)), "um", 1.0),
    )
    measure = PlainMeasure("value", "value", None, 1.0, unit="um", per_internal=1.0)
    system = Formula("least", contributors, (measure,), lambda x: x[:, :3].min(axis=1) + 0.5 * x[:, 3])
    taken = {each.contributor: each.first_order for each in asked(response_of(Simulation(system, Study(4000)))).taken}
    assert taken == pytest.approx({"g": 0.7, "x": 0.5}, abs=1e-6)


def test_a_nominal_that_moves_nothing_in_one_direction_moves_no_mean() -> None:
    """|x1| changes by x1 as often one way as the other."""
    own = asked(formula(lambda x: np.abs(x[:, 1]) + 0.8 * x[:, 0], None, 4.0))
    assert [each.steps[0].contributor for each in moves(own)] == ["x0"]
    assert halves(own)[0].steps[0].contributor == "x1"


def test_failed_builds_are_out_and_no_shift_mends_them() -> None:
    own = asked(formula(lambda x: np.where(x[:, 1] > 6.0, np.nan, linear(x)), None, 40.0))
    failed = 1e6 * norm.sf(2.0)
    low, high = own.now.out_ppm_95
    assert low < failed < high
    assert moves(own) == []
    (best, *_) = halves(own)
    assert (best.steps[0].contributor, best.after.out_ppm) == ("x1", pytest.approx(1e6 * norm.sf(4.0), abs=500))


STAGE = """
scene: stage of three planets, whose least play stops the carrier
default_law: {kind: normal, sigmas: 3}
parts:
  sun: {kind: spur_gear, teeth: 17, module: 4 mm, face_width: 50 mm}
  wheel: {kind: spur_gear, teeth: 22, module: 4 mm, face_width: 50 mm}
  ring: {kind: internal_gear, teeth: 61, module: 4 mm, face_width: 50 mm}
  planet: {kind: planet, gears: [wheel]}
  carrier: {kind: planet_carrier}
tolerances:
  planets: {kind: tooth_thickness, of: wheel, distribution: -125 / -85 um}
  sun teeth: {kind: tooth_thickness, of: sun, distribution: -130 / -85 um}
moves:
  set:
    kind: planetary
    planet: planet
    planets: 3
    carrier: carrier
    meshes: {sun: wheel, ring: wheel}
    centre_distance: 78 mm
    held: ring
    input: sun
    output: carrier
measures:
  play: {kind: planetary_lost_motion, of: set, upper_limit: 6.5 arcmin}
study: {trials: 4000, seed: 3}
"""


def test_the_spread_of_three_planets_moves_the_mean_as_a_run_without_that_spread(tmp_path: Path) -> None:
    """By 3/4 sigma, for signs, of the 0.846 of the least of three normals; each planet by itself said 3/2."""
    scene = scene_of(STAGE, tmp_path)
    alike = scene.with_({"tolerances.planets.distribution": "-105.001 / -104.999 um"})
    responses = [response_of(simulation_of(each)) for each in (scene, alike)]
    means = [response.values(*response.drawn(4000)).values.mean() for response in responses]
    own = changes_of(responses[0], ChangesQuestion("play", builds=4000)).measures["play"]
    taken = {each.contributor: each.second_order for each in own.taken}
    assert taken["planets"] == pytest.approx((means[0] - means[1]) * 0.75 / 0.846, rel=0.02)  # 1.3 % standard error
    assert taken["sun teeth"] == pytest.approx(0.0, abs=1e-3)


# scenes changed as it says --------------------------------------------------------------------------


@pytest.fixture(scope="module")
def spur() -> Scene:
    """The spur pair with limits that it leaves on both sides."""
    study = {"study.trials": 3000, "study.witness": 0}
    return load("spur_pair").with_({**TIGHT, **study})


@pytest.fixture(scope="module")
def changes(spur: Scene) -> Changes:
    return changes_of(response_of(simulation_of(spur)), ChangesQuestion(builds=3000))


def simulated(scene: Scene) -> tuple[float, float]:
    response = response_of(simulation_of(scene)).of("normal backlash")
    values = response.values(*response.drawn(3000)).values[:, 0]
    return float(values.mean()), float(values.std(ddof=1))


def with_law(scene: Scene, name: str, shift: float, width: float) -> Scene:
    """With the limits of a normal law moved [um] and narrowed."""
    law: Any = scene.distributed[name].distribution
    lower, upper = (1e3 * own.internal for own in (law.lower, law.upper))
    middle, half = (lower + upper) / 2 + shift, width * (upper - lower) / 2
    own = f"tolerances.{name}.distribution"
    return scene.with_({f"{own}.lower": f"{middle - half!r} um", f"{own}.upper": f"{middle + half!r} um"})


def test_a_scene_changed_as_it_says_has_what_was_said(spur: Scene, changes: Changes) -> None:
    """The same draws, so that only rounding is left; by every nominal and normal tolerance that is told."""
    own = changes.measures["normal backlash"]
    assert moves(own)
    assert halves(own)
    for moved in moves(own):
        (step,) = moved.steps
        mean, sigma = simulated(with_law(spur, step.contributor, step.change, 1.0))
        assert (mean, sigma) == pytest.approx((moved.after.mean, moved.after.sigma), rel=1e-6)
        assert mean == pytest.approx(61.5, abs=0.6)  # standard error 0.13
        assert step.nominal == ("E_sns and E_sni" if "thickness" in step.contributor else "nominal")
        assert [each.measure for each in moved.beside] == ["lost motion"]
    for half in halves(own):
        if (name := half.steps[0].contributor).endswith(("thickness", "distance", "clearance")):
            assert simulated(with_law(spur, name, 0.0, 0.5)) == pytest.approx(
                (half.after.mean, half.after.sigma), rel=1e-6
            )


def changed(scene: Scene, name: str, shift: float, factor: float) -> Scene | None:
    """With a tolerance's law moved [um] and so many times as wide, as one would write it; None of others."""
    entry = scene.tolerances[name].model_dump(mode="json")
    law, own = entry.get("distribution") or {}, f"tolerances.{name}"
    if "lower" in law and "upper" in law and law["lower"] is not None:
        lower, upper = (1e3 * Quantity.parse(law[key]).internal for key in ("lower", "upper"))
        middle, half = (lower + upper) / 2 + shift, factor * (upper - lower) / 2
        fields = {"lower": middle - half, "upper": middle + half}
    elif law.get("sigma") is not None:
        mean, sigma = (1e3 * Quantity.parse(law[key]).internal for key in ("mean", "sigma"))
        fields = {"mean": mean + shift, "sigma": factor * sigma}
    elif "diameter" in (entry.get("zone") or {}) and entry.get("law") == {"kind": "uniform"} and not shift:
        diameter = 1e3 * Quantity.parse(entry["zone"]["diameter"]).internal
        return scene.with_({f"{own}.zone.diameter": f"{factor * diameter!r} um"})
    else:
        return None
    return scene.with_({f"{own}.distribution.{key}": f"{value!r} um" for key, value in fields.items()})


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "least"), [("door", 11), ("four_pads", 5), ("gearbox_in_housing", 2), ("every_planetary_field", 1)]
)
def test_other_scenes_changed_as_it_says_have_what_was_said(name: str, least: int) -> None:
    _changed_as_it_says(name, least, 1000)


def test_an_assembly_changed_as_it_says_has_what_was_said() -> None:
    _changed_as_it_says("clutch", 2, 4000)


def _changed_as_it_says(name: str, least: int, builds: int) -> None:
    """The same draws: means and sigmas within rounding, and the same share out of limits; so many changes at least.

    Of nominals that move a mean and whose law can be moved, and of halved laws and zones.
    """
    scene = load(name)
    found = changes_of(response_of(simulation_of(scene)), ChangesQuestion(builds=builds, accepted_ppm=1000.0))
    held = 0
    for measure, own in found.measures.items():
        single = [(each.steps[0], each.after) for each in own.proposals if len(each.steps) == 1]
        for step, after in single:
            contributor, shift, factor = step.contributor, step.change or 0.0, 0.5 if step.change is None else 1.0
            if contributor not in scene.tolerances or (other := changed(scene, contributor, shift, factor)) is None:
                continue
            response = response_of(simulation_of(other)).of(measure)
            built = response.values(*drawn_builds(response, builds))
            values = built.values[built.seated[:, 0], 0]
            got = (float(values.mean()), float(values.std(ddof=1)))
            assert got == pytest.approx((after.mean, after.sigma), rel=1e-5, abs=1e-4)
            lower, upper = (-math.inf if own.lower_limit is None else own.lower_limit), own.upper_limit
            inside = (values >= lower) & (values <= (math.inf if upper is None else upper))
            assert 1e6 * (1 - inside.sum() / builds) == pytest.approx(after.out_ppm, abs=1e6 / builds + 1e-6)
            held += 1
    assert held >= least


def test_no_clearance_is_asked_to_be_less_than_nothing() -> None:
    """The bearing clearance of 2 to 30 um acts by half: it cannot take 30 um out of the backlash."""
    scene = load("spur_pair").with_({"measures.normal backlash.upper_limit": "25 um"})
    own = changes_of(response_of(simulation_of(scene)), ChangesQuestion(builds=500)).measures["normal backlash"]
    assert moves(own)
    assert "bearing clearance" not in [each.steps[0].contributor for each in moves(own)]


PLATE = """
scene: a plate
parts:
  plate:
    kind: solid
    features:
      pin: {kind: point, at: [50 mm, 0 mm, 10 mm], normal: [0, 0, 1]}
  table: {kind: solid, features: {top: {kind: plane, at: [0 mm, 0 mm, 0 mm], normal: [0, 0, 1], extent: [1 mm, 1 mm]}}}
tolerances:
  x: {kind: plus_minus, of: plate.pin, along: [1, 0, 0], distribution: {kind: normal, lower: LOW um, upper: HIGH um}}
  y: {kind: plus_minus, of: plate.pin, along: [0, 1, 0], distribution: {kind: normal, lower: -30 um, upper: 30 um}}
moves:
  table fixed: {kind: fix, part: table}
  plate fixed: {kind: fix, part: plate}
measures:
  place: {MEASURE, upper_limit: LIMIT um}
study: {trials: 2000, seed: 1}
"""


def plate(folder: Path, low: float, high: float, limit: float, measure: str) -> Any:
    text = PLATE.replace("LOW", str(low)).replace("HIGH", str(high)).replace("LIMIT", str(limit))
    scene = scene_of(text.replace("MEASURE", measure), folder)
    return changes_of(response_of(simulation_of(scene)), ChangesQuestion("place", builds=2000)).measures["place"]


ERROR = "kind: position_error, of: plate.pin, from: table, component: size"


def test_the_size_of_an_error_is_made_less_by_no_nominal_but_by_both_tolerances(tmp_path: Path) -> None:
    """Rayleigh of 10 um: 4.39 % beyond 25 um; both of 5 um: exp(-12.5), 4 ppm."""
    own = plate(tmp_path, -30.0, 30.0, 25.0, ERROR)
    low, high = own.now.out_ppm_95
    assert low < 1e6 * math.exp(-3.125) < high
    assert moves(own) == []
    both, *single = own.proposals
    assert {step.contributor for step in both.steps} == {"x", "y"}
    assert (both.after.out_ppm, both.reaches(1.33)) == (0.0, True)
    assert {each.steps[0].contributor for each in single} == {"x", "y"}


def test_a_tolerance_off_its_middle_is_moved_and_an_inspected_position_is_not(tmp_path: Path) -> None:
    """x of 0 to 60 um: where it is drawn moves the error of the place; of an inspection it moves the true place too."""
    (moved,) = moves(plate(tmp_path, 0.0, 60.0, 40.0, ERROR))
    (step,) = moved.steps
    assert (step.contributor, step.nominal) == ("x", "position")
    assert step.change == pytest.approx(-30.0, abs=6.0)
    inspected = plate(tmp_path, 0.0, 60.0, 80.0, "kind: inspected_position, of: plate.pin, across: [0, 0, 1]")
    assert inspected.now.out_ppm > 100_000
    assert moves(inspected) == []
    assert halves(inspected)


def test_a_length_that_begins_at_nothing_is_halved_there_as_what_if_does() -> None:
    """0 to 40 um in a random direction becomes 0 to 20 um."""
    law = {"kind": "uniform", "lower": "0 um", "upper": "40 um"}
    scene = load("spur_pair").with_({"tolerances.wheel eccentricity.distribution": law, **TIGHT})
    response = response_of(simulation_of(scene))
    own = changes_of(response, ChangesQuestion("normal backlash", builds=1000)).measures["normal backlash"]
    (half,) = (each.steps[0] for each in halves(own) if each.steps[0].contributor == "wheel eccentricity")
    assert half.becomes == "uniform 0 … 20 µm"
    other = changed_response(response, [factor_of(response, "wheel eccentricity=0.5")])
    assert other.drawn_by("wheel eccentricity").distribution.high == pytest.approx(0.02)


def test_what_made_a_cover_worse_is_no_longer_told() -> None:
    """A perpendicularity has no nominal to be moved; the first row is better than the cover as it is."""
    limits = {f"measures.hole offset.{end}_limit": f"{sign}0.1 mm" for end, sign in (("lower", "-"), ("upper", ""))}
    response = response_of(simulation_of(load("cover_on_base").with_(limits)))
    own = changes_of(response, ChangesQuestion("hole offset", builds=2000)).measures["hole offset"]
    assert moves(own) == []
    assert (own.proposals[0].after.out_ppm or 0.0) < (own.now.out_ppm or 0.0)
    one, other = (each.after.sigma for each in halves(own))
    assert one == pytest.approx(other, rel=4 * 0.8 / math.sqrt(2000))  # both holes are 0.2 mm wide


# below a verdict ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def run(spur: Scene, tmp_path_factory: pytest.TempPathFactory) -> Any:
    return tol3d.run_scene(spur, out=tmp_path_factory.mktemp("changes") / "run")


def test_a_run_is_told_what_the_command_says(run: Any, spur: Scene, changes: Changes) -> None:
    """By the first of the same builds, so that it differs by sampling alone: four standard errors of the mean."""
    found = changes_of_run(run, simulation_of(spur))
    assert found is not None
    assert not_ok(run) == ["normal backlash"]
    brief, whole = found.measures["normal backlash"], changes.measures["normal backlash"]
    assert brief.builds == MOST_BUILDS
    assert {each.steps[0].contributor for each in moves(brief)} == {each.steps[0].contributor for each in moves(whole)}
    for each in moves(brief):
        assert each.after.mean == pytest.approx(61.5, abs=4 * each.after.sigma / math.sqrt(MOST_BUILDS))
    assert halves(brief)[0].steps == halves(whole)[0].steps


def test_a_run_whose_builds_take_long_is_told_what_to_ask(run: Any, spur: Scene) -> None:
    """By a stated cost of a second a build a tenth of the run is 300 builds, too few for one change."""
    simulation = simulation_of(spur)
    slow = {name: replace(own, contacts_per_minute=60) for name, own in simulation.system.methods.items()}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(type(simulation.system), "methods", slow)
        found = changes_of_run(run, simulation)
    assert found is not None
    assert (dict(found.measures), found.further, found.evaluations) == ({}, ["normal backlash"], 0)
    said = as_text(page(*changes_lines(found, "runs/pair")), 100)
    assert said.strip() == "tol3d changes runs/pair asks what to change"


def test_a_run_keeps_what_was_found(run: Any, changes: Changes) -> None:
    keep(run, "changes", changes)
    assert sections_of(run)["changes"] == changes


def test_nothing_is_said_where_all_is_ok(tmp_path: Path) -> None:
    run = tol3d.run_scene("spur_pair", out=tmp_path / "run", overrides=Overrides(trials=2000, witness=0))
    assert changes_of_run(run, simulation_of(load("spur_pair"))) is None
    none = changes_of(response_of(simulation_of(load("spur_pair"))))
    assert not none.measures
    assert "nothing: no measure is out of its limits" in as_text(changes_report("pair", none), 100)


def test_it_prints_what_it_found(changes: Changes) -> None:
    text = as_text(changes_report("pair", changes), 140)
    own = changes.measures["normal backlash"]
    best, half = own.proposals[0], halves(own)[0]
    lines = text.splitlines()
    row = next(line for line in lines if line.startswith(best.steps[0].contributor))
    assert f"{best.steps[0].change:.4g}".replace("-", "−") in row
    row = next(line for line in lines if line.startswith(f"half {half.steps[0].contributor}"))
    assert half.steps[0].becomes in row
    assert f"{half.after.sigma:.3f}" in row
    narrow = as_text(changes_report("pair", changes), 80).splitlines()
    assert next(k for k, line in enumerate(narrow) if line.startswith("  move ")) < 5
    assert max(map(len, narrow)) <= 80
    assert len(narrow) < 60
    brief = as_text(page(*changes_lines(changes, "runs/pair")), 140)
    assert "tol3d changes runs/pair" in brief
    assert "or halve " in brief
    assert len(brief.splitlines()) < 12


def test_contributions_of_all_measures_as_numbers() -> None:
    table = contributions_table(contributions_of(formula(linear, None, None)))
    rows = [row.split(",") for row in table.csv().splitlines()]
    assert [row[2] for row in rows[1:]] == ["x0", "x1", "x2"]
    assert [float(row[4]) for row in rows[1:]] == pytest.approx(SLOPES, rel=1e-6)
    assert [float(row[5]) for row in rows[1:]] == pytest.approx([400 / 14, 900 / 14, 100 / 14], rel=1e-6)
    assert [float(row[7]) for row in rows[1:]] == pytest.approx(np.abs(SLOPES) * SIGMAS, rel=1e-6)


def test_what_cannot_be_asked_is_refused() -> None:
    with pytest.raises(InputError, match=r"expected a limit \(lower_limit, upper_limit\) of any measure"):
        changes_of(formula(linear, None, None))
    with pytest.raises(InputError, match="got 'valu'"):
        changes_of(formula(linear, None, 1.0), ChangesQuestion("valu"))


def test_a_curve_is_told_by_its_ends() -> None:
    """The spring's profile has an upper limit: its highest value is asked for, of a run that names the curve."""
    with known(PARABOLA):
        response = response_of(simulation_of(load(TOYS / "parabola" / "spring.yaml")))
        assert list(changes_of(response, ChangesQuestion(builds=200), bad=["profile"]).measures) == ["profile, highest"]


def test_a_picture_shows_every_change(changes: Changes, tmp_path: Path) -> None:
    own = changes.measures["normal backlash"]
    words = [each for each, _, _ in changes_of_one(own)]
    assert words[0] == "as it is"
    assert len(words) == 1 + len(own.proposals)
    save_charts(changes_charts("pair", changes), tmp_path / "changes.png")
    assert (tmp_path / "changes.png").stat().st_size > 10_000


def test_the_command_keeps_what_it_finds(run: Any, tol3d: Any, tmp_path: Path) -> None:
    """The fixture `run` is left as it is: a copy of it is asked."""
    copy = tmp_path / "run"
    shutil.copytree(run.path, copy)
    code, out, _ = tol3d("changes", str(copy), "--builds", "100", "--csv", str(tmp_path / "c.csv"))
    assert code == 0
    assert "normal backlash · limits 48 µm to 75 µm · 100 builds each" in out
    assert json.loads((copy / "analyses" / "changes.json").read_text("utf-8"))["ppk"] == 1.33
    assert (tmp_path / "c.csv").read_text("utf-8").count("\n") == 1 + 2 * 7  # two measures, seven contributors
    assert tol3d("changes", "spur_pair", "--measure", "lost motion")[0] == 2


def test_a_mechanism_from_outside() -> None:
    """The bundled spring: its height is a parabola of x, whose curvature takes the mean off."""
    with known(PARABOLA):
        response = response_of(simulation_of(load(TOYS / "parabola" / "spring.yaml")))
        found = changes_of(response, ChangesQuestion("room", builds=500)).measures["room"]
        assert found.tried
        whole = changes_of(response, ChangesQuestion(builds=500))
        assert set(whole.measures) <= set(response.names)
        assert as_text(changes_report("spring", whole), 120)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(bundled_scenes()))
def test_every_bundled_scene_is_told_or_refused(name: str) -> None:
    response = response_of(simulation_of(load(name)))
    if all((own.lower_limit, own.upper_limit) == (None, None) for own in response.measures):
        with pytest.raises(InputError, match="expected a limit"):
            changes_of(response, ChangesQuestion(builds=100))
        return
    found = changes_of(response, ChangesQuestion(builds=100))
    assert as_text(changes_report(name, found), 120)
