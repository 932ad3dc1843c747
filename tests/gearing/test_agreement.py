"""FCL on the solids' flanks against the stack-up, the exact closed form and a brute-force search of the surfaces."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pytest
from fixtures import EngineOf
from gear_trials import drawn_trials, gear_columns
from of_kind import of_kind
from oracles import brute_force, exact_eccentric
from oracles.plain import plain_spur
from oracles.poses import world_from_gears
from oracles.thickness import thickness_of
from scipy.spatial.transform import Rotation

from tol3d.gearing.builds.build import Build, build
from tol3d.gearing.engines import INTERFERES, OK
from tol3d.gearing.engines.gaps import Gaps
from tol3d.gearing.meshing.mesh import Meshing
from tol3d.gearing.meshing.seats import measure_backlash
from tol3d.gearing.model import (
    Backlash,
    Contributor,
    GearPart,
    Mesh,
    Model,
    Reading,
    Scalar,
    Temperature,
    TurningOffset,
)
from tol3d.gearing.model.model import Housing
from tol3d.gearing.stack_up import analytic_backlash, closed_form
from tol3d.gears import LEFT, RIGHT, SpurGear, SpurPair
from tol3d.gears.flank import Flank
from tol3d.statistics.distributions import Uniform

ALPHA = math.radians(20.0)
STACK_UP_BOUND = 0.15e-3  # mm; 0.05 um of squares in the first order, 0.1 um of the strips
EXACT_BOUND = 0.12e-3  # mm; the strips alone: four chord errors (two flanks touch, two are measured) of 0.024 um
BRUTE_FORCE_BOUND = 0.10e-3  # mm, the same for the pairs below, of modules up to 2.5
FREE_OF_CHORDS = 0.005e-3  # mm; FCL's own rounding and the oracle's zooms: on flanks the strips can only read too much
PAPER_MEAN, PAPER_SIGMA = 53.397e-3, 7.216e-3  # mm; closed form of the stack-up on the paper's Tables 1 and 2


def with_flank(model: Model, flank: Flank) -> Model:
    return replace(model, meshes=tuple(replace(mesh, working_flank=flank) for mesh in model.meshes))


# the paper's pair, row by row -------------------------------------------------------------------------


@dataclass(frozen=True)
class Rows:
    """Both methods of 2000 trials on one working flank [mm]."""

    model: Model
    deviations: np.ndarray
    driver_angle: np.ndarray
    made: Build
    geometric: np.ndarray
    status: np.ndarray

    @property
    def kind(self) -> Backlash:
        return of_kind(Backlash, self.model.measures[0].kind)

    def analytic(self, deviations: np.ndarray | None = None, driver_angle: np.ndarray | None = None) -> np.ndarray:
        deviations = self.deviations if deviations is None else deviations
        return analytic_backlash(
            self.model, self.kind, deviations, self.driver_angle if driver_angle is None else driver_angle
        )


@pytest.fixture(scope="module", params=[RIGHT, LEFT], ids=["right", "left"])
def rows(request: pytest.FixtureRequest, paper_model: Model, engine_of: EngineOf) -> Rows:
    model = with_flank(paper_model, request.param)
    mesh = model.meshes[0]
    block = drawn_trials(model, 1, 0, 2000)
    angle = block.positions[mesh.name]
    made, engine = build(model, block.deviations), engine_of(model)
    meshing = Meshing(engine, model, mesh, made, Reading())
    seat = meshing.seat(angle)
    values = measure_backlash(of_kind(Backlash, model.measures[0].kind), meshing, seat)
    return Rows(model, block.deviations, angle, made, values, seat.status)


def test_every_row_agrees_with_the_stack_up_to_0_15_um(rows: Rows) -> None:
    assert (rows.status == OK).all()
    assert len(rows.geometric) == 2000
    assert np.abs(rows.geometric - rows.analytic()).max() <= STACK_UP_BOUND


def test_every_row_agrees_with_the_exact_eccentric_pair_to_0_12_um(rows: Rows) -> None:
    exact = exact_rows(rows)
    assert np.abs(rows.geometric - exact).max() <= EXACT_BOUND
    assert (rows.geometric - exact).min() > -FREE_OF_CHORDS
    assert np.abs(rows.analytic() - exact).max() <= STACK_UP_BOUND - EXACT_BOUND + 0.03e-3


def exact_rows(rows: Rows) -> np.ndarray:
    mesh, made = rows.model.meshes[0], rows.made
    return exact_eccentric.normal_backlash(
        plain_spur(mesh.pair.pinion),
        plain_spur(mesh.pair.wheel),
        thickness_of(rows.model, made).sum(axis=1),
        made.world_from_shaft[:, 1, :2, 3] - made.world_from_shaft[:, 0, :2, 3],
        (made.centre[:, 0], made.centre[:, 1]),
        rows.driver_angle,
        mesh.working_flank,
    )


def test_the_exact_eccentric_pair_agrees_with_brute_force_to_1e_8_mm(rows: Rows) -> None:
    few, mesh = slice(0, 10), rows.model.meshes[0]
    gears = (mesh.pair.pinion, mesh.pair.wheel)
    pinion, wheel = (plain_spur(gear, thickness_of(rows.model, rows.made)[few, k]) for k, gear in enumerate(gears))
    shafts, centres = rows.made.world_from_shaft[few], rows.made.centre[few]
    searched = brute_force.Mesh(pinion, wheel, shafts[:, 0], shafts[:, 1], centres[:, 0], centres[:, 1])
    found = brute_force.normal_backlash(searched, rows.driver_angle[few], mesh.working_flank)
    assert np.abs(found - exact_rows(rows)[few]).max() < 1e-8


def test_sample_mean_and_sigma_lie_within_four_standard_errors_of_the_closed_form(rows: Rows) -> None:
    form = closed_form(rows.model, rows.model.measures[0])
    assert form is not None
    assert form.mean == pytest.approx(PAPER_MEAN, abs=0.0005e-3)
    assert form.sigma == pytest.approx(PAPER_SIGMA, abs=0.0005e-3)
    n = len(rows.geometric)
    for sample in (rows.geometric, rows.analytic()):
        assert abs(sample.mean() - form.mean) <= 4 * form.sigma / np.sqrt(n)
        # the terms are normal but for the eccentricities' cosines, which are normal too (Rayleigh x uniform)
        assert abs(sample.std(ddof=1) - form.sigma) <= 4 * form.sigma / np.sqrt(2 * (n - 1))


# a wrong phase convention must not pass ------------------------------------------------------------------


def turned_offsets(rows: Rows, angle: np.ndarray | float, part: str | None = None) -> np.ndarray:
    """The deviations with every eccentricity and run-out (of one part, or of all) turned by an angle [rad]."""
    wrong, slices = rows.deviations.copy(), rows.model.component_slices
    for contributor in rows.model.contributors:
        if isinstance(contributor.effect, TurningOffset) and part in (None, contributor.effect.part):
            own = slices[contributor.name]
            wrong[:, own] = exact_eccentric.turned(rows.deviations[:, own], np.broadcast_to(angle, len(wrong)))
    return wrong


def wrong_phases(rows: Rows) -> dict[str, np.ndarray]:
    """The analytic column under conventions that are wrong."""
    mesh = rows.model.meshes[0]
    back = {mesh.driver: rows.driver_angle, mesh.driven: mesh.pair.driven_angle(rows.driver_angle)}
    return {
        "every phase a quarter turn off": rows.analytic(turned_offsets(rows, np.pi / 2)),
        "phases the other way round": rows.analytic(turned_offsets(rows, np.pi)),
        "driver's turn forgotten": rows.analytic(turned_offsets(rows, -back[mesh.driver], mesh.driver)),
        "driven's turn forgotten": rows.analytic(turned_offsets(rows, -back[mesh.driven], mesh.driven)),
        "driver's turn reversed": rows.analytic(turned_offsets(rows, -2 * back[mesh.driver], mesh.driver)),
        "driven's turn reversed": rows.analytic(turned_offsets(rows, -2 * back[mesh.driven], mesh.driven)),
    }


def test_a_wrong_phase_convention_breaks_the_row_bound_a_hundredfold_and_keeps_sigma(rows: Rows) -> None:
    right = rows.analytic()
    for name, wrong in wrong_phases(rows).items():
        assert np.abs(rows.geometric - wrong).max() > 100 * STACK_UP_BOUND, name
        # a histogram would not show it: both sigmas have a standard error of 1.6 %
        assert wrong.std() == pytest.approx(right.std(), rel=4 * 1 / np.sqrt(2 * len(wrong))), name


# tilts, shifts, faces that overlap in part ------------------------------------------------------------------


@dataclass(frozen=True)
class Posed:
    """Random builds of a pair: the driven axis tilted and shifted, gears eccentric and thinner, as model and oracle."""

    model: Model
    made: Build
    driver_angle: np.ndarray
    searched: brute_force.Mesh

    @property
    def mesh(self) -> Mesh:
        return self.model.meshes[0]


@dataclass(frozen=True)
class Case:
    """A pair and how far its thickness must be off for backlash to be left at a tilt of 1 mrad."""

    pinion: SpurGear
    wheel: SpurGear
    opened: float  # mm over the zero-backlash centre distance
    thinner: float  # mm a gear
    growth: tuple[float, float] = (1.0, 1.0)


CASES = {
    "paper": Case(SpurGear(28, 2.5, ALPHA, 20.0), SpurGear(110, 2.5, ALPHA, 20.0), 0.0, 0.05),
    "wide": Case(SpurGear(20, 2.0, ALPHA, 100.0), SpurGear(31, 2.0, ALPHA, 80.0), 0.0, 0.15),
    "shifted": Case(
        SpurGear(14, 2.0, ALPHA, 12.0, profile_shift=0.4),
        SpurGear(31, 2.0, ALPHA, 20.0, profile_shift=-0.1),
        0.05,
        0.05,
    ),
    "warm": Case(
        SpurGear(20, 2.0, ALPHA, 20.0), SpurGear(31, 2.0, ALPHA, 20.0), 0.0, 0.07, growth=(1 + 4e-4, 1 - 3e-4)
    ),
}
LARGEST_TILT = 1e-3  # rad


def posed(case: Case, count: int, seed: int, flank: Flank) -> Posed:
    """Builds with tilts about any transverse axis up to 1 mrad, shifts of 30 um, faces up to 30 % past each other."""
    rng = np.random.default_rng(seed)
    gears = (case.pinion, case.wheel)
    distance = SpurPair(*gears, 10 * sum(g.tip_radius for g in gears)).zero_backlash_centre_distance + case.opened
    mesh = Mesh("mesh", "pinion", "wheel", SpurPair(*gears, distance), flank)
    model = Model("posed", (GearPart("pinion", gears[0]), GearPart("wheel", gears[1])), (), (), (mesh,), ())
    tilt, about = rng.uniform(0.0, LARGEST_TILT, count), rng.uniform(0.0, 2 * np.pi, count)
    width = min(gear.face_width for gear in gears)
    shafts = np.tile(np.eye(4), (count, 2, 1, 1))
    shafts[:, 1, :3, :3] = Rotation.from_rotvec(np.c_[tilt * np.cos(about), tilt * np.sin(about), 0 * tilt]).as_matrix()
    shafts[:, 1, :3, 3] = rng.uniform(-1, 1, (count, 3)) * (0.03, 0.03, 0.3 * width) + (distance, 0.0, 0.0)
    centre = rng.uniform(-0.01, 0.01, (count, 2, 2))
    thickness = rng.uniform(-0.005, 0.005, (count, 2)) - case.thinner
    half_turns = thickness / np.array([gear.reference_diameter for gear in gears])
    still = np.zeros((count, 2, 3))  # the start of the turn does not know the tilts, nor need it
    made = Build(shafts, centre, still, half_turns, np.zeros((count, 2)), np.tile(case.growth, (count, 1)))
    driver_angle = rng.uniform(0.0, 2 * np.pi * mesh.pair.long_period_turns, count)
    pinion, wheel = (plain_spur(gear, thickness[:, k], case.growth[k]) for k, gear in enumerate(gears))
    searched = brute_force.Mesh(pinion, wheel, shafts[:, 0], shafts[:, 1], centre[:, 0], centre[:, 1])
    return Posed(model, made, driver_angle, searched)


def assert_agree(measured: np.ndarray, found: np.ndarray, chord_error: float) -> None:
    """The strips lie inside the teeth, so FCL reads too much, by four chord errors at most, at tip edges too."""
    error = measured - found
    assert np.abs(error).max() <= BRUTE_FORCE_BOUND
    assert error.min() >= -FREE_OF_CHORDS
    assert error.max() <= 4 * chord_error + FREE_OF_CHORDS


def check_normal_backlash(case: Case, count: int, seed: int, flank: Flank, engine_of: EngineOf) -> None:
    poses = posed(case, count, seed, flank)
    engine = engine_of(poses.model)
    meshing = Meshing(engine, poses.model, poses.mesh, poses.made, Reading())
    seat = meshing.seat(poses.driver_angle)
    assert (seat.status == OK).all()
    kind = Backlash("normal_backlash", "mesh", "wheel")
    measured = measure_backlash(kind, meshing, seat)
    found = brute_force.normal_backlash(poses.searched, poses.driver_angle, flank)
    assert_agree(measured, found, engine.chord_error)


@pytest.mark.slow
@pytest.mark.parametrize("flank", [RIGHT, LEFT], ids=["right", "left"])
@pytest.mark.parametrize("name", CASES)
def test_tilted_and_shifted_gears_agree_with_brute_force_to_0_1_um(
    name: str, flank: Flank, engine_of: EngineOf
) -> None:
    check_normal_backlash(CASES[name], 6, 5 + flank, flank, engine_of)


@pytest.mark.slow
@pytest.mark.parametrize("flank", [RIGHT, LEFT], ids=["right", "left"])
@pytest.mark.parametrize("name", CASES)
def test_two_hundred_poses_agree_with_brute_force_to_0_1_um(name: str, flank: Flank, engine_of: EngineOf) -> None:
    check_normal_backlash(CASES[name], 200, 50 + flank, flank, engine_of)


@pytest.mark.parametrize("flank", [RIGHT, LEFT], ids=["right", "left"])
def test_free_turns_of_either_gear_agree_with_brute_force(flank: Flank, engine_of: EngineOf) -> None:
    poses = posed(CASES["paper"], 5, 11, flank)
    mesh, engine = poses.mesh, engine_of(poses.model)
    meshing = Meshing(engine, poses.model, mesh, poses.made, Reading())
    seat = meshing.seat(poses.driver_angle)
    for name, gear in (("pinion", mesh.pair.pinion), ("wheel", mesh.pair.wheel)):
        kind = Backlash("angular_backlash", "mesh", name)
        measured = measure_backlash(kind, meshing, seat)
        found = brute_force.free_turn(poses.searched, poses.driver_angle, flank, turn_driver=name == "pinion")
        assert_agree(measured * gear.base_radius, found * gear.base_radius, engine.chord_error)
    arc = measure_backlash(Backlash("circumferential_backlash", "mesh", "wheel"), meshing, seat)
    # an arc at the working circle of the driven gear: r_b / cos alpha_w
    assert_agree(
        arc * np.cos(mesh.pair.working_pressure_angle), found * mesh.pair.wheel.base_radius, engine.chord_error
    )


def test_first_contact_lies_on_the_flank_of_a_tooth_that_the_search_finds_touching(engine_of: EngineOf) -> None:
    poses = posed(CASES["paper"], 6, 21, RIGHT)
    searched = poses.searched
    engine = engine_of(poses.model)
    meshing = Meshing(engine, poses.model, poses.mesh, poses.made, Reading())
    seat = meshing.seat(poses.driver_angle)
    start = brute_force.tooth_in_space(searched, poses.driver_angle)
    touching = brute_force.turn_until_contact(searched, poses.driver_angle, start, RIGHT)
    # the strips lie inside the teeth, so the wheel goes on by two chord errors at most
    further = -(seat.driven_angle - touching[1]) * searched.driven.base_radius
    assert further.min() > -FREE_OF_CHORDS
    assert further.max() < 2 * engine.chord_error + FREE_OF_CHORDS
    point, tooth = seat.contact
    teeth, distance, _ = brute_force.distances(searched, *touching, RIGHT)
    # two pairs that touch within the chord errors of each other are both right
    assert distance[teeth == tooth[:, None]].max() < 2 * engine.chord_error + FREE_OF_CHORDS
    world_from_driver = world_from_gears(searched.driver_shaft, poses.driver_angle, searched.driver_centre)
    own = (np.linalg.inv(world_from_driver) @ np.c_[point, np.ones(len(point))][..., None])[:, :3, 0]
    off = searched.driver.signed_distance(own[:, None, None, None], tooth.reshape(-1, 1, 1, 1), RIGHT)
    assert np.abs(off).max() < engine.chord_error + FREE_OF_CHORDS


@pytest.mark.parametrize("side", [RIGHT, LEFT], ids=["right", "left"])
@pytest.mark.parametrize("of_driver", [True, False], ids=["driver turns", "driven turns"])
def test_a_gap_s_derivative_by_a_turn_is_its_difference_quotient(
    of_driver: bool, side: Flank, engine_of: EngineOf
) -> None:
    poses = posed(CASES["paper"], 6, 31, RIGHT)
    mesh, engine = poses.mesh, engine_of(poses.model)
    seat = Meshing(engine, poses.model, mesh, poses.made, Reading()).seat(poses.driver_angle)
    angles = (poses.driver_angle, seat.driven_angle)
    teeth, wanted = mesh.pair.candidate_teeth(poses.driver_angle, side)
    step = np.array([1e-6, 0.0] if of_driver else [0.0, 1e-6])  # rad; 0.1 um, over which a gap bends by 1e-9 mm

    def gaps(sign: int) -> Gaps:
        at = (angles[0] + sign * step[0], angles[1] + sign * step[1])
        return engine.gaps(poses.made, mesh, side, at, teeth, wanted)

    quotient = (gaps(1).value - gaps(-1).value)[wanted] / 2e-6
    axis = poses.made.axis(0 if of_driver else 1)
    rate = gaps(0).per_turn(*axis, of_driver=of_driver)[wanted]
    base_radius = (mesh.pair.pinion if of_driver else mesh.pair.wheel).base_radius
    # on a strip's edge the nearest point slides and the normal turns by half a step's angle, 0.005 rad
    assert rate == pytest.approx(quotient, rel=0.005)
    # a tilt of 1 mrad and a tip edge change the lever by less than 3 %
    assert rate == pytest.approx(np.full(len(rate), side * base_radius), rel=0.03)


# temperature ------------------------------------------------------------------------------------------------


def warm_model(expansions: tuple[float, float, float]) -> Model:
    """The paper's pair, opened by 0.1 mm, in a housing; one temperature for all."""
    pair = SpurPair(CASES["paper"].pinion, CASES["paper"].wheel, 172.6)
    everything = Temperature(("pinion", "wheel", "box"))
    contributor = Contributor("temperature", "temperature", everything, Scalar(Uniform(-40.0, 60.0)), "K")
    return Model(
        "warm",
        (GearPart("pinion", pair.pinion, expansions[0]), GearPart("wheel", pair.wheel, expansions[1])),
        (Housing("box", expansions[2]),),
        (contributor,),
        (Mesh("mesh", "pinion", "wheel", pair, RIGHT, "box"),),
        (),
    )


@pytest.mark.parametrize("kelvin", [-40.0, 20.0, 60.0])
def test_gears_of_one_material_in_a_housing_of_another_are_a_scaled_pair(kelvin: float, engine_of: EngineOf) -> None:
    steel, aluminium = 11.5e-6, 23.5e-6
    model = warm_model((steel, steel, aluminium))
    made = build(model, np.full((6, 1), kelvin))
    angle = np.linspace(0.0, 30.0, 6)
    engine, mesh = engine_of(model), model.meshes[0]
    meshing = Meshing(engine, model, mesh, made, Reading())
    seat = meshing.seat(angle)
    measured = measure_backlash(Backlash("normal_backlash", "mesh", "wheel"), meshing, seat)
    grown, opened = 1 + steel * kelvin, 1 + aluminium * kelvin
    # in lengths measured with the gears' own steel the axes stand at a (1 + housing)/(1 + gears)
    exact = grown * replace(of_kind(SpurPair, mesh.pair), centre_distance=172.6 * opened / grown).normal_backlash
    assert np.abs(measured - exact).max() <= BRUTE_FORCE_BOUND
    stack = analytic_backlash(model, Backlash("normal_backlash", "mesh", "wheel"), np.full((1, 1), kelvin), angle[:1])
    # first order: at 60 K the axes part by 0.12 mm, the square of which is worth da^2/(a tan alpha_w) = 0.24 um
    assert stack[0] == pytest.approx(exact, abs=0.3e-3)


def test_a_warm_pinion_in_a_cold_house_closes_until_it_interferes(engine_of: EngineOf) -> None:
    model = warm_model((11.5e-6, 0.0, 0.0))
    made = build(model, np.array([[0.0], [100.0], [3000.0]]))
    engine, mesh = engine_of(model), model.meshes[0]
    meshing = Meshing(engine, model, mesh, made, Reading())
    seat = meshing.seat(np.zeros(3))
    assert list(seat.status) == [OK, OK, INTERFERES]
    values = measure_backlash(Backlash("normal_backlash", "mesh", "wheel"), meshing, seat)
    assert values[1] < values[0]
    assert np.isnan(values[2])


# the same bits ------------------------------------------------------------------------------------------------


def assert_same_bits(first: Mapping[str, np.ndarray], second: Mapping[str, np.ndarray]) -> None:
    assert first.keys() == second.keys()
    for name in first:
        assert np.ascontiguousarray(first[name]).tobytes() == np.ascontiguousarray(second[name]).tobytes(), name


def test_a_trial_alone_has_the_bits_of_the_same_trial_among_many(paper_model: Model, engine_of: EngineOf) -> None:
    together = gear_columns(paper_model, engine_of(paper_model), drawn_trials(paper_model, 1, 0, 60))
    fresh = engine_of(paper_model)
    for trial in (0, 1, 31, 59):
        alone = gear_columns(paper_model, fresh, drawn_trials(paper_model, 1, trial, 1))
        assert_same_bits(alone, {name: column[trial : trial + 1] for name, column in together.items()})


@pytest.mark.parametrize("size", [1, 7, 59])
def test_columns_do_not_depend_on_how_trials_are_cut_into_blocks(
    size: int, paper_model: Model, engine_of: EngineOf
) -> None:
    engine = engine_of(paper_model)
    whole = gear_columns(paper_model, engine, drawn_trials(paper_model, 3, 0, 60))
    parts = [
        gear_columns(paper_model, engine, drawn_trials(paper_model, 3, first, min(size, 60 - first)))
        for first in range(0, 60, size)
    ]
    assert_same_bits(whole, {name: np.concatenate([part[name] for part in parts]) for name in whole})
