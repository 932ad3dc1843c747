"""Internal pairs by the exact engine: against a closed form on parallel axes, and against a search in any pose."""

import math
from dataclasses import replace
from typing import Literal

import numpy as np
import pytest
from fixtures import EngineOf
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from oracles import ring_search
from oracles.random_builds import Builds, Spread, random_builds, within_reach_of
from oracles.ring_pairs import RingPair

from tol3d.errors import GeometryError
from tol3d.gearing.engines import INTERFERES, NO_CONTACT, OK, OUT_OF_RANGE
from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gearing.engines.gaps import MeshReading
from tol3d.gearing.meshing.mesh import Meshing
from tol3d.gearing.meshing.seats import measure_backlash, read_backlash
from tol3d.gearing.model import Backlash, Reading
from tol3d.gears import LEFT, RIGHT, Flank, InternalGear, InternalPair, SpurGear, one_tooth_share

ALPHA = math.radians(20)
CLOSED_FORM_BOUND = 1e-9  # mm; seen: 1e-12 but for eccentric gears, whose turn is followed to 1e-11
GENERAL_BOUND = 5e-9  # mm; the last step of the general search is a parabola: seen 2e-9
SEARCH_BOUND = 5e-6  # mm; seen: 4e-8
BOTH = frozenset({"pinion", "wheel"})
PARALLEL = Spread(tilt=0.0, shift=0.03, centre=0.02, turned=0.02, offset=0.0)


def pair_of(inner: SpurGear, ring: InternalGear, *, ring_drives: bool = False, opened: float = 0.0) -> InternalPair:
    """The pair with its axes nearer by so much than without backlash [mm]."""
    pinion, wheel = (ring, inner) if ring_drives else (inner, ring)
    near = InternalPair(pinion, wheel, (ring.teeth - inner.teeth) * inner.module / 2)
    if math.isnan(near.zero_backlash_centre_distance):
        raise GeometryError("no distance leaves backlash")
    pair = replace(near, centre_distance=near.zero_backlash_centre_distance - opened)
    pair.refuse_interference()
    return pair


def planet(*, ring_drives: bool) -> InternalPair:
    """27 teeth in 79, module 1."""
    return pair_of(
        SpurGear(27, 1.0, ALPHA, 10.0), InternalGear(79, 1.0, ALPHA, 9.0, addendum=0.8), ring_drives=ring_drives
    )


PAIRS = {
    "planet": planet(ring_drives=False),
    "driving ring": planet(ring_drives=True),
    "shifted": pair_of(
        SpurGear(22, 1.5, ALPHA, 14.0, profile_shift=0.3),
        InternalGear(66, 1.5, ALPHA, 12.0, profile_shift=-0.25, addendum=0.9),
        opened=0.02,
    ),
    "wide": pair_of(SpurGear(40, 2.0, ALPHA, 50.0), InternalGear(60, 2.0, ALPHA, 60.0, addendum=0.7)),
}


def covering_slowly(quick: str) -> pytest.MarkDecorator:
    """All pairs, those but one as slow tests."""
    slow = [pytest.param(name, marks=() if name == quick else pytest.mark.slow) for name in PAIRS]
    return pytest.mark.parametrize("name", slow)


FLANKS = pytest.mark.parametrize("flank", [pytest.param(RIGHT, id="right"), pytest.param(LEFT, id="left")])


@st.composite
def internal_pairs(draw: st.DrawFn) -> InternalPair:
    """Any pair that a scene would accept."""
    module, alpha = draw(st.floats(0.5, 6.0)), math.radians(draw(st.floats(18.0, 27.0)))
    teeth = draw(st.integers(16, 80))
    try:
        inner = SpurGear(teeth, module, alpha, draw(st.floats(5.0, 60.0)), draw(st.floats(-0.1, 0.5)))
        ring = InternalGear(
            teeth + draw(st.integers(10, 90)),
            module,
            alpha,
            draw(st.floats(5.0, 60.0)),
            draw(st.floats(-0.5, 0.2)),
            addendum=draw(st.floats(0.6, 0.9)),
        )
        return pair_of(inner, ring, ring_drives=draw(st.booleans()), opened=draw(st.floats(0.0, 0.05)) * module)
    except GeometryError:
        assume(False)
        raise


def read(builds: Builds, reading: Reading | None = None) -> MeshReading:
    engine = ExactEngine(builds.model)
    return engine.read(builds.made, builds.mesh, reading or Reading(), builds.driver_angle, BOTH)


def internal_pair(builds: Builds) -> InternalPair:
    pair = builds.mesh.pair
    assert isinstance(pair, InternalPair)
    return pair


def by_vectors(builds: Builds) -> RingPair:
    """The same pair for the closed form, inner gear first."""
    pair, made = internal_pair(builds), builds.made
    gears = (pair.inner, pair.ring)
    seats = (1, 0) if pair.ring_drives else (0, 1)
    thickness = [
        gear.tooth_thickness + 2 * gear.reference_radius * made.flank_turn[:, seat]
        for gear, seat in zip(gears, seats, strict=True)
    ]
    return RingPair(
        (pair.inner.teeth, pair.ring.teeth),
        pair.ring.module,
        pair.ring.pressure_angle,
        (thickness[0], thickness[1]),
        (made.world_from_shaft[:, seats[0], :2, 3], made.world_from_shaft[:, seats[1], :2, 3]),
        (made.centre[:, seats[0]], made.centre[:, seats[1]]),
    )


def closed_form(builds: Builds) -> tuple[np.ndarray, np.ndarray]:
    """Turn of the driven gear at rest [rad] and the backlash [mm]."""
    pair, oracle = internal_pair(builds), by_vectors(builds)
    side = builds.mesh.driven_flank if pair.ring_drives else builds.mesh.working_flank
    driver = builds.driver_angle
    middle = pair.driven_angle(driver)
    driven = oracle.seated(side, driver, middle, ring_drives=pair.ring_drives)
    both = (driven, driver) if pair.ring_drives else (driver, driven)
    return driven, oracle.gap(-side, *both)


# closed form ----------------------------------------------------------------------------------------------------------


@given(pair=internal_pairs(), flank=st.sampled_from([RIGHT, LEFT]), seed=st.integers(0, 2**32))
@settings(max_examples=40)
def test_parallel_eccentric_gears_leave_the_backlash_of_the_closed_form(
    pair: InternalPair, flank: Flank, seed: int
) -> None:
    builds = random_builds(pair, flank, 60, seed, spread=within_reach_of(pair, PARALLEL), thinner=0.05)
    (driven, expected), seen = closed_form(builds), read(builds)
    assert (seen.status[expected > 0.0] == OK).all()
    assert (seen.status[expected < -2e-6] == INTERFERES).all()
    assert np.abs(seen.gap - expected).max() <= CLOSED_FORM_BOUND
    assert np.abs(seen.driven_angle - driven).max() * pair.wheel.base_radius <= CLOSED_FORM_BOUND


@pytest.mark.parametrize("name", PAIRS)
@FLANKS
def test_the_general_kernel_continues_the_shortcut_for_parallel_axes(name: str, flank: Flank) -> None:
    builds = random_builds(PAIRS[name], flank, 300, 8, spread=PARALLEL, thinner=0.1)
    shafts = builds.made.world_from_shaft.copy()
    shafts[:, 1, 0, 2], shafts[:, 1, 2, 0] = 0.8e-12, -0.8e-12
    tilted = replace(builds, made=replace(builds.made, world_from_shaft=shafts))
    for reading in (Reading(), Reading("section", "section")):
        straight, general = read(builds, reading), read(tilted, reading)
        assert np.array_equal(straight.status, general.status)
        assert np.abs(straight.gap - general.gap).max() <= GENERAL_BOUND
        pair = builds.mesh.pair
        for turn, arm in (("driven_turn", pair.wheel.base_radius), ("driver_turn", pair.pinion.base_radius)):
            apart = getattr(straight, turn) - getattr(general, turn)
            assert np.abs(apart).max() * arm <= GENERAL_BOUND


@given(pair=internal_pairs(), flank=st.sampled_from([RIGHT, LEFT]), seed=st.integers(0, 2**32))
@settings(max_examples=20)
def test_a_concentric_gear_s_free_turn_is_the_gap_over_its_base_radius(
    pair: InternalPair, flank: Flank, seed: int
) -> None:
    spread = replace(within_reach_of(pair, PARALLEL), centre=0.0)
    builds = random_builds(pair, flank, 50, seed, spread=spread, thinner=0.1)
    seen, (_, expected) = read(builds), closed_form(builds)
    free = seen.status == OK
    assume(free.any())
    for turn, gear in ((seen.driven_turn, pair.wheel), (seen.driver_turn, pair.pinion)):
        assert np.abs(turn * gear.base_radius - expected)[free].max() <= CLOSED_FORM_BOUND


def test_moving_the_axes_apart_closes_an_internal_pair_by_two_sin_alpha() -> None:
    pair = PAIRS["planet"]
    builds = random_builds(pair, RIGHT, 3, 1, spread=Spread(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), thinner=0.1)
    shafts = builds.made.world_from_shaft.copy()
    shafts[:, 1, 0, 3] -= np.array([-1e-4, 0.0, 1e-4])  # the ring's axis lies at -x
    gap = read(replace(builds, made=replace(builds.made, world_from_shaft=shafts))).gap
    # of third order in 1e-4 mm over 26 mm
    assert (gap[2] - gap[0]) / 2e-4 == pytest.approx(-2 * math.sin(ALPHA), abs=1e-8)


# search of the surfaces -----------------------------------------------------------------------------------------------

SPREADS = {
    "tilted": Spread(past=0.3, tilt=0.8e-3, shift=0.03),
    "warm": Spread(past=0.3, growth=2e-4, offset=0.0, tilt=0.6e-3, shift=0.02),
}


def toothed(builds: Builds, row: int, seat: int, angle: float) -> ring_search.ToothedGear:
    """A gear of a build for the search."""
    pair, made = internal_pair(builds), builds.made
    gear = (pair.pinion, pair.wheel)[seat]
    return ring_search.ToothedGear(
        teeth=gear.teeth,
        module=gear.module,
        pressure_angle=gear.pressure_angle,
        thickness=gear.tooth_thickness + 2 * gear.reference_radius * float(made.flank_turn[row, seat]),
        tip=gear.tip_radius,
        root=gear.form_radius,
        width=gear.face_width,
        inside=isinstance(gear, InternalGear),
        offset=float(made.flank_offset[row, seat]),
        growth=float(made.scale[row, seat]),
        world_from_gear=made.rows(np.array([row])).world_from_gear(seat, np.array([angle]))[0],
    )


def searched(builds: Builds, row: int, turns: tuple[float, float], flank: Flank) -> float:
    """Distance of the driver's flanks of one side from those that face them [mm]."""
    driver, driven = (toothed(builds, row, seat, turn) for seat, turn in enumerate(turns))
    return ring_search.distance(driver, driven, right=flank == RIGHT)


def check_against_search(builds: Builds) -> None:
    seen, engine, pair = read(builds), ExactEngine(builds.model), builds.mesh.pair
    rows = np.flatnonzero(seen.status == OK)
    assert set(seen.status) <= {OK, OUT_OF_RANGE}
    for flank in (RIGHT, LEFT):
        # in the middle of the play both sides are apart: no distance is near 0, where a search finds no way
        middle = seen.driven_angle + builds.mesh.driven_flank * seen.driven_turn / 2
        teeth, near = pair.candidate_teeth(builds.driver_angle, flank)
        angles = (builds.driver_angle, middle)
        gaps = engine.gaps(builds.made, builds.mesh, flank, angles, teeth, near).smallest()
        for row in rows:
            turns = (float(builds.driver_angle[row]), float(middle[row]))
            assert searched(builds, int(row), turns, flank) == pytest.approx(gaps[row], abs=SEARCH_BOUND)


@pytest.mark.slow
@covering_slowly("driving ring")
def test_gaps_agree_with_a_search_of_the_surfaces_of_all_teeth(name: str) -> None:
    spread = SPREADS["warm" if name == "driving ring" else "tilted"]
    builds = random_builds(PAIRS[name], RIGHT, 1, 3, spread=spread, thinner=0.15)
    assert (read(builds).status == OK).all()
    check_against_search(builds)


@pytest.mark.slow
@pytest.mark.parametrize("name", PAIRS)
@pytest.mark.parametrize("spread", SPREADS)
@FLANKS
def test_more_gaps_agree_with_that_search(name: str, spread: str, flank: Flank) -> None:
    builds = random_builds(PAIRS[name], flank, 3, 5, spread=SPREADS[spread], thinner=0.15)
    assert (read(builds).status == OK).all()
    check_against_search(builds)


@pytest.mark.slow
@pytest.mark.parametrize("name", PAIRS)
@pytest.mark.parametrize("tip", ["driver", "driven"])
def test_tip_edges_that_touch_agree_with_that_search(name: str, tip: str) -> None:
    """Gears that grow apart have other base pitches: a tip meets its mate before the path of contact, or after it."""
    spread = Spread(tilt=0.0, shift=0.02, growth=3e-4, turned=0.01, offset=0.0)
    builds = random_builds(PAIRS[name], RIGHT, 400, 3, spread=spread, thinner=0.15)
    seen, engine, pair, made = read(builds), ExactEngine(builds.model), internal_pair(builds), builds.made
    arm = pair.wheel.base_radius
    opened = seen.driven_angle + builds.mesh.driven_flank * 0.02 / arm  # 0.02 mm, for a distance of 0 has no direction
    teeth, near = pair.candidate_teeth(builds.driver_angle, RIGHT)
    gaps = engine.gaps(made, builds.mesh, RIGHT, (builds.driver_angle, opened), teeth, near)
    first, rows = np.argmin(np.where(np.isnan(gaps.value), np.inf, gaps.value), axis=1), np.arange(400)
    seat, angle, points = (
        (0, builds.driver_angle, gaps.driver_point) if tip == "driver" else (1, opened, gaps.driven_point)
    )
    off = points[rows, first] - made.centre_of(seat, angle)
    gear = (pair.pinion, pair.wheel)[seat]
    at_tip = np.abs(np.hypot(off[:, 0], off[:, 1]) / made.scale[:, seat] - gear.tip_radius) < 1e-6
    found = np.flatnonzero(at_tip & gaps.at_end[rows, first] & (seen.status == OK))
    assert len(found) >= 5
    for row in found[:5]:
        turns = (float(builds.driver_angle[row]), float(opened[row]))
        expected = searched(builds, int(row), turns, RIGHT)
        assert gaps.value[row, first[row]] == pytest.approx(expected, abs=SEARCH_BOUND)


def seats(builds: Builds, reading: Reading) -> Meshing:
    return Meshing(ExactEngine(builds.model), builds.model, builds.mesh, builds.made, reading)


@pytest.mark.slow
@pytest.mark.parametrize("name", PAIRS)
@FLANKS
@pytest.mark.parametrize("reading", [Reading(), Reading("section", "section")], ids=["face", "section"])
def test_reading_at_once_equals_reading_by_gaps(name: str, flank: Flank, reading: Reading) -> None:
    builds = random_builds(PAIRS[name], flank, 100, 4, spread=SPREADS["warm"], thinner=0.15)
    seen, meshing = read(builds, reading), seats(builds, reading)
    seat = meshing.seat(builds.driver_angle)
    in_range = seen.status != OUT_OF_RANGE
    assert in_range.sum() > 50
    assert np.array_equal(seen.status[in_range], seat.status[in_range])
    pair = builds.mesh.pair
    arms = {"wheel": pair.wheel.base_radius, "pinion": pair.pinion.base_radius}
    kinds = [Backlash("normal_backlash", "mesh", "wheel", reading)]
    kinds += [Backlash("angular_backlash", "mesh", gear, reading) for gear in arms]
    for kind in kinds:
        at_once, by_gaps = read_backlash(kind, builds.mesh, seen), measure_backlash(kind, meshing, seat)
        arm = 1.0 if kind.quantity == "normal_backlash" else arms[kind.gear]
        # across partly overlapping faces the normal at the end of a face is not the flank's
        assert np.abs(at_once - by_gaps)[in_range].max() * arm <= (2e-8 if reading.contact == "section" else 1e-6)


# FCL, statuses, readings of one tooth ---------------------------------------------------------------------------------


@covering_slowly("driving ring")
def test_fcl_finds_the_same_within_its_chord_error(name: str, engine_of: EngineOf) -> None:
    builds = random_builds(PAIRS[name], LEFT, 6, 3, spread=SPREADS["warm"], thinner=0.12)
    engine, seen = engine_of(builds.model), read(builds)
    seat = Meshing(engine, builds.model, builds.mesh, builds.made, Reading()).seat(builds.driver_angle)
    assert np.array_equal(seat.status, seen.status)
    # chords lie in the gear's tooth and out of the ring's: a sagitta of each at most at the contact, and at the gap
    bound = 4 * engine.chord_error
    assert np.abs(seat.non_working.smallest() - seen.gap).max() <= bound
    arm = builds.mesh.pair.wheel.base_radius
    assert np.abs(seat.driven_angle - seen.driven_angle).max() * arm <= bound / 2


def test_builds_that_fail_say_how() -> None:
    pair = PAIRS["planet"]
    builds = random_builds(pair, RIGHT, 4, 1, spread=Spread(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), thinner=0.02)
    shafts, turn = builds.made.world_from_shaft.copy(), builds.made.flank_turn.copy()
    turn[1] = 0.02 / (2 * pair.inner.reference_radius)  # teeth too thick for their spaces
    shafts[2, 1, 2, 3] = 9.6  # faces beside each other
    shafts[3, 1, 1, 3] = 0.3  # farther than candidate teeth are known
    made = replace(builds.made, world_from_shaft=shafts, flank_turn=turn)
    seen = read(replace(builds, made=made))
    assert seen.status.tolist() == [OK, INTERFERES, NO_CONTACT, OUT_OF_RANGE]
    assert np.isnan(seen.gap).tolist() == [False, False, True, True]
    assert seen.gap[1] < 0.0


SMALL = Spread(tilt=0.0, shift=0.01, centre=0.005, turned=0.01, offset=0.0)


@pytest.mark.parametrize("name", PAIRS)
@pytest.mark.parametrize("teeth", ["driver", "driven"])
def test_one_tooth_in_its_space_has_the_closed_form_where_it_acts(
    name: str, teeth: Literal["driver", "driven"]
) -> None:
    pair, reading = PAIRS[name], Reading(teeth=teeth)
    builds = random_builds(pair, RIGHT, 300, 6, spread=SMALL, thinner=0.1)
    seen, (_, expected) = read(builds, reading), closed_form(builds)
    share = one_tooth_share(pair, teeth)
    acts = seen.status == OK
    # a share of positions, four standard errors; deviations move the ends of the path by 0.02 mm/sin(alpha) each
    assert abs(acts.mean() - share) <= 4 * math.sqrt(max(share * (1 - share), 0.003) / 300) + 0.05
    assert np.abs(seen.gap - expected)[acts].max(initial=0.0) <= CLOSED_FORM_BOUND
