"""Derivatives of measures through the contact: against differences of the measures themselves and closed forms."""

import math
from dataclasses import replace
from typing import Literal

import numpy as np
import pytest
from of_kind import of_kind
from oracles.far_builds import PAIRS, Acting, contributors, far_block, far_model, model_of, pair_of
from scipy.spatial.transform import Rotation
from sets import covering

from tol3d.gearing.builds.build import build
from tol3d.gearing.builds.rates import build_rates, left_jacobian
from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gearing.meshing.seats import geometric_values, seated
from tol3d.gearing.model import (
    AxesOffset,
    AxisOffset,
    AxisTilt,
    Backlash,
    Effect,
    Measure,
    Model,
    Positions,
    Reading,
    ToothThickness,
    TurningOffset,
)
from tol3d.gearing.slopes.coefficients import Coefficient, Slopes, mean_slopes
from tol3d.gearing.slopes.sensitivity import peak_weights, sensitivities, taken_rates
from tol3d.gears import LEFT, RIGHT
from tol3d.gears.flank import Flank
from tol3d.statistics.distributions import Constant
from tol3d.study.system.positions import Take
from tol3d.study.system.stated import stated
from tol3d.study.system.taken import taken
from tol3d.study.system.trials import Trials

Over = Literal["random", "at", "turn", "long_period", "swing"]

ALPHA = math.radians(20.0)
SINE = math.sin(ALPHA)
STEPS = {"um": 1e-4, "mrad": 1e-5, "K": 0.1}  # mm, rad, K of a central difference
# mm of the gap by one step of a difference; relative to that gap changes are compared, one scale for all units
GAP_OF_STEP = {"um": 1e-4, "mrad": 1e-5 * 20.0, "K": 0.1 * 2e-4}
AT_RANDOM = Positions("random", 1, 1)


def of_steps(model: Model, lengths: dict[str, float]) -> np.ndarray:
    return np.array([lengths[c.unit] for c in model.contributors for _ in c.draw.components])


def differences(model: Model, engine: ExactEngine, block: Trials, measure: Measure, share: float) -> np.ndarray:
    """Central differences of a measure over a share of each component's step, for the whole of it; on the last axis."""
    alone = replace(model, measures=(measure,))

    def values(component: int, step: float) -> np.ndarray:
        moved = block.deviations.copy()
        moved[:, component] += step
        seats = seated(alone, engine, Trials(moved, block.positions))
        return taken(measure, geometric_values(measure, seats))

    steps = share * of_steps(model, STEPS)
    return np.stack([(values(k, h) - values(k, -h)) / (2 * share) for k, h in enumerate(steps)], axis=-1)


def worst_error(model: Model, engine: ExactEngine, block: Trials, measure: Measure, share: float = 1.0) -> float:
    """Largest error of a derivative, in gap for gap; one tooth may be out of action, which all have to tell."""
    told = sensitivities(model, engine, block, measure) * of_steps(model, STEPS)
    expected = differences(model, engine, block, measure, share)
    assert told.shape == expected.shape
    acts = np.isfinite(expected).all(axis=-1)
    assert np.array_equal(np.isfinite(told).all(axis=-1), acts)
    assert acts.all() or (of_kind(Backlash, measure.kind).reading.teeth != "all" and acts.any())
    lever = 1 / 10.0 if measure.kind.is_angle else 1.0  # rad by a gap of 1 mm on base circles of 15 mm and more
    return float((np.abs(told - expected)[acts] / (lever * of_steps(model, GAP_OF_STEP))).max())


KINDS = {
    "normal, face": Backlash("normal_backlash", "mesh", "wheel"),
    "normal, contact over the face": Backlash("normal_backlash", "mesh", "wheel", Reading("face", "section", "driven")),
    "normal, mean section": Backlash("normal_backlash", "mesh", "wheel", Reading("section", "section", "driver")),
    "circumferential": Backlash("circumferential_backlash", "mesh", "wheel"),
    "angular of the driven": Backlash("angular_backlash", "mesh", "wheel", Reading("section", "section", "all")),
    "angular of the driver": Backlash("angular_backlash", "mesh", "pinion"),
}
DIFFERENCES_BOUND = 1e-6  # of a gap's change; the central difference itself is off by 1e-7 or so
# Where the driven's face ends the exact engine tells the normal of the driven's flank instead of the driver's: off by
# the slope of the gap along the face, 0.02 on these builds.
FACE_BOUND = 0.03
# A seed of builds without a kink within the step of a difference, and without a contact of two edges (a tip edge on
# the end of a face or of the section, up to 1 in 17 builds), where the engine's normal is that of one flank too.
SMOOTH = 9


@covering(name=PAIRS, kind=KINDS, flank=[pytest.param(LEFT, id="left"), pytest.param(RIGHT, id="right")])
def test_derivatives_far_from_nominal_are_those_of_central_differences(name: str, kind: str, flank: Flank) -> None:
    model, engine = far_model(name, flank)
    measure = Measure("play", KINDS[kind], AT_RANDOM, "value")
    bound = DIFFERENCES_BOUND if "face" not in vars(KINDS[kind].reading).values() else FACE_BOUND
    assert worst_error(model, engine, far_block(model, 5, SMOOTH), measure) <= bound


@pytest.mark.slow
@covering(name=PAIRS, kind=KINDS)
def test_derivatives_of_any_builds_keep_within_the_bound_of_faces(name: str, kind: str) -> None:
    """Edges and all; in steps of 0.01 um, which no kink comes near here."""
    model, engine = far_model(name, LEFT)
    measure = Measure("play", KINDS[kind], AT_RANDOM, "value")
    for seed in range(5, 13):
        assert worst_error(model, engine, far_block(model, 5, seed), measure, share=0.1) <= FACE_BOUND


@pytest.mark.parametrize("over", ["turn", "long_period"])
@pytest.mark.parametrize("take", ["curve", "min", "max", "range"])
@pytest.mark.parametrize("name", ["spur", "bevel 17/43"])
def test_what_is_taken_over_a_turn_has_the_derivatives_of_central_differences(
    name: str, take: Take, over: Over
) -> None:
    model, engine = far_model(name, LEFT)
    measure = Measure("play", KINDS["normal, mean section"], Positions(over, 1, 9), take)
    # a parabola's place moves by steps over its bend of some 10 um: 1e-4 of a step of 0.1 um, and by its square less
    assert worst_error(model, engine, far_block(model, 2, SMOOTH), measure, share=0.1) <= 5 * DIFFERENCES_BOUND


# the rates of poses, without any contact ----------------------------------------------------------------------------


def test_the_left_jacobian_turns_a_rotation_vectors_rate_into_an_angular_velocity() -> None:
    rng = np.random.default_rng(1)
    vectors = np.concatenate([rng.uniform(-1.5, 1.5, (20, 3)), rng.uniform(-1e-4, 1e-4, (5, 3)), np.zeros((1, 3))])
    for vector, jacobian in zip(vectors, left_jacobian(vectors), strict=True):
        rates = rng.uniform(-1.0, 1.0, 3)
        after, before = (Rotation.from_rotvec(vector + h * rates) for h in (1e-5, -1e-5))
        velocity = (after * before.inv()).as_rotvec() / 2e-5
        assert jacobian @ rates == pytest.approx(velocity, abs=1e-9)  # h^2 and rounding of 1e-16 / h


@pytest.mark.parametrize("name", ["spur", "bevel 17/43"])
def test_the_rates_of_builds_with_large_tilts_are_those_of_central_differences(name: str) -> None:
    model, _ = far_model(name, LEFT)
    deviations = np.random.default_rng(2).uniform(-0.4, 0.4, (7, model.component_count))
    made = build(model, deviations)
    rates = build_rates(model, made, deviations)
    h = 1e-5
    for k in range(model.component_count):
        after, before = (build(model, deviations + step * np.eye(model.component_count)[k]) for step in (h, -h))
        turned = np.einsum("tgij,tgkj->tgik", after.world_from_shaft, before.world_from_shaft)[..., :3, :3]
        turned -= np.einsum("tgi,tgj->tgij", after.world_from_shaft[..., :3, 3], before.world_from_shaft[..., :3, 3])
        spin = Rotation.from_matrix(turned.reshape(-1, 3, 3)).as_rotvec().reshape(len(deviations), -1, 3)
        moved = after.world_from_shaft[..., :3, 3] - before.world_from_shaft[..., :3, 3]
        assert rates.turn[:, :, k] == pytest.approx(spin / (2 * h), abs=1e-8)
        assert rates.origin[:, :, k] == pytest.approx(moved / (2 * h), abs=1e-7)
        for field in ("centre", "flank_turn", "flank_offset", "scale"):
            difference = (getattr(after, field) - getattr(before, field)) / (2 * h)
            assert getattr(rates, field)[:, :, k] == pytest.approx(difference, abs=1e-9)


# what is taken of curves, without any gears -----------------------------------------------------------------------


def curves(count: int, positions: int) -> np.ndarray:
    """Random curves: most bend at their extremes, straight ones and those highest at an end are among them."""
    rng = np.random.default_rng(positions)
    curve = rng.normal(size=(count, positions))
    curve[: count // 4] = np.linspace(0.0, 1.0, positions) * rng.uniform(-1.0, 1.0, (count // 4, 1))
    curve[count // 4 : count // 2] += 3.0 * np.linspace(0.0, 1.0, positions) ** 2
    return curve


@pytest.mark.parametrize("closed", [True, False])
@pytest.mark.parametrize("positions", [2, 3, 9])
def test_the_weights_of_a_peak_give_the_peak(positions: int, closed: bool) -> None:
    over = Positions("long_period", 1, positions) if closed else Positions("turn", 1, positions - 1)
    values = curves(200, positions)
    expected = taken(Measure("top", KINDS["normal, face"], over, "max"), values)
    assert (peak_weights(values, closed=closed) * values).sum(axis=1) == pytest.approx(expected, abs=1e-13)


@pytest.mark.parametrize("over", [Positions("long_period", 1, 9), Positions("turn", 1, 8)], ids=["closed", "open"])
@pytest.mark.parametrize("take", ["min", "max", "range"])
def test_an_extreme_changes_as_its_parabola_does(take: Take, over: Positions) -> None:
    measure = Measure("extreme", KINDS["normal, face"], over, take)
    values = curves(200, 9)[50:]  # extremes of straight lines are kinks
    rates = np.random.default_rng(8).normal(size=(*values.shape, 2))
    told = taken_rates(measure, values, rates)
    for k, h in ((0, 1e-6), (1, 1e-6)):
        after, before = (taken(measure, values + step * rates[..., k]) for step in (h, -h))
        # where a sample overtakes another within a step the difference is that of two slopes: none does here
        assert told[:, k] == pytest.approx((after - before) / (2 * h), abs=1e-5)


# closed forms -----------------------------------------------------------------------------------------------------


def slopes_at(name: str, effects: list[Acting], thinner: float, angles: np.ndarray, kind: Backlash) -> np.ndarray:
    """Derivatives by some effects, (angles, components), all at 0 but for teeth thinned by an offset [mm]."""
    thin: list[Acting] = [(ToothThickness("pinion", turn=0.0, offset=1.0), "um", False)]
    model = model_of(pair_of(name), LEFT, contributors(thin + effects))
    deviations = np.zeros((len(angles), model.component_count))
    deviations[:, 0] = -thinner
    measure = Measure("play", kind, AT_RANDOM, "value")
    return sensitivities(model, ExactEngine(model), Trials(deviations, {"mesh": angles}), measure)[:, 1:]


SPUR_ANGLES = np.linspace(0.0, 6.0, 7)


def test_a_spur_pair_opens_by_2_sin_alpha_w_per_centre_distance_and_closes_by_cos_alpha_per_thickness() -> None:
    pair = pair_of("spur")
    wheel = pair.wheel
    thickness = ToothThickness("wheel", turn=0.5 / wheel.thickness_radius)
    effects: list[Acting] = [
        (AxisOffset("wheel"), "um", False),
        (thickness, "um", False),
        (AxisOffset("wheel"), "um", True),
    ]
    told = slopes_at("spur", effects, 0.02, SPUR_ANGLES, KINDS["normal, mean section"])
    opening = 2 * math.sin(math.acos(43 * math.cos(ALPHA) / 43.59))  # of the working pressure angle
    expected = [opening, -math.cos(ALPHA), opening, 0.0]
    assert told == pytest.approx(np.broadcast_to(expected, told.shape), abs=1e-9)


def test_an_angle_changes_by_the_gap_over_the_base_radius() -> None:
    effects: list[Acting] = [(AxisOffset("wheel"), "um", False)]
    pair = pair_of("spur")
    opening = 2 * math.sin(math.acos(43 * math.cos(ALPHA) / 43.59))
    for gear, kind in ((pair.wheel, "angular of the driven"), (pair.pinion, "angular of the driver")):
        backlash = replace(KINDS[kind], reading=Reading("section", "section", "all"))
        told = slopes_at("spur", effects, 0.02, SPUR_ANGLES, backlash)
        assert told[:, 0] == pytest.approx(opening / (gear.reference_diameter * math.cos(ALPHA) / 2), rel=1e-8)


PHASES = np.array([(k + 0.37) / 8 for k in range(8)]) * 2 * math.pi / 31  # of a pitch, as in test_bevel_agreement
ONE_TOOTH = Backlash("normal_backlash", "mesh", "wheel", Reading("section", "section", "driven"))


@pytest.mark.parametrize(
    ("effect", "expected"),
    [
        (AxisOffset("pinion", (0.0, 0.0, 1.0)), 0.4358),
        (AxisOffset("wheel", (0.0, 0.0, 1.0)), 0.5311),
        (AxisOffset("pinion", (-1.0, 0.0, 0.0)), 0.5311),
        (AxisOffset("wheel", (-1.0, 0.0, 0.0)), 0.4358),
        (AxisTilt("wheel", (0.0, -1.0, 0.0), per_length=1 / (31 * 3.5 / 2 * math.sqrt(2) - 4.5)), 0.6840),
        (AxesOffset("wheel", "mesh"), 0.0),
    ],
    ids=["pinion's axis", "wheel's axis", "pinion apart", "wheel apart", "shaft angle", "axes offset"],
)
def test_one_tooth_of_a_bevel_pair_opens_as_an_exact_solver_found(effect: Effect, expected: float) -> None:
    """The numbers and their bound are those of tests/gearing/test_bevel_agreement.py."""
    told = slopes_at("bevel 31/31", [(effect, "um", False)], 0.085, PHASES, ONE_TOOTH)
    assert told.mean() == pytest.approx(expected, abs=0.001)


# contributors -----------------------------------------------------------------------------------------------------


def test_an_eccentricity_opens_most_where_it_points_away_from_the_mesh() -> None:
    effects: list[Acting] = [(TurningOffset("pinion"), "um", True)]
    told = slopes_at("spur", effects, 0.02, SPUR_ANGLES, KINDS["normal, mean section"])
    expected = 2 * math.sin(math.acos(43 * math.cos(ALPHA) / 43.59))
    assert np.hypot(told[:, 0], told[:, 1]) == pytest.approx(expected, abs=1e-9)
    along = np.arctan2(told[:, 1], told[:, 0])
    assert np.cos(along - (math.pi - SPUR_ANGLES)) == pytest.approx(1.0, abs=1e-12)


def test_builds_that_do_not_seat_have_no_derivatives_and_the_others_keep_theirs() -> None:
    model, engine = far_model("spur", LEFT)
    block = far_block(model, 3, 5)
    thick = block.deviations.copy()
    thick[1, 0] = 1.0
    measure = Measure("play", KINDS["normal, face"], AT_RANDOM, "value")
    told = sensitivities(model, engine, Trials(thick, block.positions), measure)
    assert np.isnan(told[1]).all()
    assert np.array_equal(told[[0, 2]], sensitivities(model, engine, block, measure)[[0, 2]])


def test_a_tilt_closes_the_gap_of_a_face_on_both_sides_and_an_offset_has_one_slope() -> None:
    effects: list[Acting] = [
        (AxisTilt("wheel", (0.0, 1.0, 0.0)), "mrad", False),
        (AxisTilt("wheel", (1.0, 0.0, 0.0)), "mrad", False),
        (AxisOffset("wheel"), "um", False),
    ]
    pair = pair_of("spur")
    angle = math.acos(43 * math.cos(ALPHA) / 43.59)
    model = model_of(pair, LEFT, contributors(effects, Constant(0.0)))
    readings = (Reading("face", "face"), 2), (Reading("face", "section"), 1), (Reading("section", "section"), 0)
    for reading, sides in readings:
        backlash = Backlash("normal_backlash", "mesh", "wheel", replace(reading, teeth="all"))
        measure = Measure("play", backlash, AT_RANDOM, "value")
        in_plane, across, apart = mean_slopes(model, ExactEngine(model), measure)
        for slope, lever in ((in_plane, math.sin(angle)), (across, math.cos(angle))):
            # b/2 on each side that is read over the face; contact and gap drift by 1e-5 of it at the tilt of 1e-5 rad
            assert (slope.below, slope.above) == pytest.approx((sides * 4 * lever, -sides * 4 * lever), abs=5e-3)
        assert (apart.below, apart.above) == pytest.approx((2 * math.sin(angle),) * 2, abs=5e-5)  # they bend a little


def test_slopes_at_a_mean_build_take_the_direction_in_which_the_measure_grows_most() -> None:
    effects: list[Acting] = [
        (AxisOffset("wheel", factor=0.5), "um", True),
        (ToothThickness("wheel", 0.0, 0.5), "um", False),
    ]
    model = model_of(pair_of("spur"), LEFT, contributors(effects, Constant(0.0)))
    measure = Measure("play", KINDS["normal, mean section"], AT_RANDOM, "value")
    offset, thickness = mean_slopes(model, ExactEngine(model), measure)
    assert offset.direction == pytest.approx(0.0, abs=1e-4)
    assert offset.above == pytest.approx(math.sin(math.acos(43 * math.cos(ALPHA) / 43.59)), abs=1e-4)
    assert thickness.direction is None
    assert thickness.above == pytest.approx(-1.0, abs=1e-6)
    assert stated(model, np.zeros((1, 3))).positions["mesh"].tolist() == [0.0]


@pytest.mark.parametrize(("above", "expected"), [(0.96, False), (1.04, False), (0.94, True), (1.06, True)])
def test_a_coefficient_is_marked_where_a_slope_of_the_geometry_is_off_by_more_than_a_twentieth(
    above: float, expected: bool
) -> None:
    assert Coefficient("size", "um/um", Slopes(1.0, 1.0), Slopes(1.0, above), 40.0).disagrees == expected
