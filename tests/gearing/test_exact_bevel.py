"""The exact engine on bevel gears: against a search of the surfaces, against closed forms, against itself."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from of_kind import of_kind
from oracles import bevel_brute_force, search
from oracles.bevel_brute_force import BevelMesh
from oracles.poses import world_from_gears
from oracles.random_builds import Builds, Spread, random_builds, searched_bevels
from sets import covering

from tol3d.gearing.engines import OK, OUT_OF_RANGE, MeshReading
from tol3d.gearing.engines.exact import ExactEngine
from tol3d.gearing.engines.gaps import Gaps
from tol3d.gearing.meshing.mesh import Meshing
from tol3d.gearing.meshing.seats import measure_backlash, read_backlash
from tol3d.gearing.model import Backlash, Reading
from tol3d.gears import LEFT, RIGHT, BevelGear, BevelPair, driver_teeth_at_one_tooth, pitch_angles
from tol3d.gears.flank import Flank, opposite

Teeth = Literal["all", "driver", "driven"]

ALPHA = math.radians(20.0)
SEARCH_BOUND = 5e-6  # mm, as promised; seen: 6e-7 at seats, 1.3e-6 of gaps, which is GAP_SLANT
GAP_SLANT = 0.16**3 / (2 * 34.0**2)  # mm, 1.8e-6: a gap g beyond an end of the mate is g (g/R)^2/2 less
TIE_BOUND = 6e-6  # mm; where contact at toe and heel is a tie; seen: 5e-6, once in thousands
SECTION_BOUND = 1e-7  # mm; seen: 3e-8, a free turn of eccentric gears
READINGS = {
    "mean_section": Reading("section", "section"),
    "face_contact": Reading("face", "section"),
    "face": Reading("face", "face"),
}
TEETH = ("all", "driver", "driven")
BOTH_FLANKS = (pytest.param(RIGHT, id="right"), pytest.param(LEFT, id="left"))
FLANKS = pytest.mark.parametrize("flank", BOTH_FLANKS)
BOTH_GEARS = frozenset(("pinion", "wheel"))


def pair_of(
    teeth: tuple[int, int], module: float, degrees: float, faces: tuple[float, float], shift: float = 0.0
) -> BevelPair:
    angles = pitch_angles(*teeth, math.radians(degrees))
    pinion, wheel = (
        BevelGear(z, module, ALPHA, face, delta, profile_shift=x)
        for z, face, delta, x in zip(teeth, faces, angles, (shift, -shift), strict=True)
    )
    pair = BevelPair(pinion, wheel, math.radians(degrees))
    pair.refuse_interference()
    return pair


PAIRS = {
    "31 to 31": pair_of((31, 31), 3.5, 90.0, (9.0, 9.0)),
    "17 to 43": pair_of((17, 43), 2.0, 90.0, (12.0, 11.0), 0.3),
    "60 deg": pair_of((20, 31), 2.5, 60.0, (14.0, 14.0)),
    "110 deg": pair_of((23, 29), 3.0, 110.0, (12.0, 13.0)),
}
SPREADS = {"usual": Spread(tilt=0.4e-3, shift=0.02, offset=0.002), "wide": Spread(growth=4e-4, offset=0.0)}
THINNER = 0.06  # mm; what 50 um and 1 mrad of both gears close


def read(builds: Builds, reading: Reading) -> MeshReading:
    return ExactEngine(builds.model).read(builds.made, builds.mesh, reading, builds.driver_angle, BOTH_GEARS)


def meshing_of(builds: Builds, reading: Reading) -> Meshing:
    return Meshing(ExactEngine(builds.model), builds.model, builds.mesh, builds.made, reading)


def in_range(builds: Builds, reading: Reading) -> Builds:
    """Those that are read; nothing but the end of the range may keep one from it."""
    status = read(builds, reading).status
    assert set(status) <= {OK, OUT_OF_RANGE}
    rows = np.flatnonzero(status == OK)
    return replace(builds, made=builds.made.rows(rows), driver_angle=builds.driver_angle[rows])


def one_build(builds: Builds, reading: Reading, place: str) -> Iterator[BevelMesh]:
    """Each build as the search sees it: whole, or its driver cut down to the middle section."""
    middle = of_kind(BevelPair, builds.mesh.pair).mean_cone_distance
    for row, mesh in enumerate(searched_bevels(builds)):
        at = middle * builds.made.scale[row, 0]
        yield mesh.between(at, at) if getattr(reading, place) == "section" else mesh


def smallest(
    meshes: Iterable[BevelMesh], builds: Builds, reading: Reading, driver: np.ndarray, driven: np.ndarray, flank: Flank
) -> np.ndarray:
    """Smallest distances of one side by the search [mm], of those teeth that the reading looks at."""
    found, pitch = [], builds.mesh.pair.pinion.angular_pitch
    for row, mesh in enumerate(meshes):
        own = slice(row, row + 1)
        teeth, distance, _ = search.bevel_distances(mesh, driver[own], driven[own], flank)
        if reading.teeth != "all":
            # who is looked at is decided where the driver is held
            wanted = driver_teeth_at_one_tooth(builds.driver_angle[own], pitch, flank, reading.teeth)
            distance = np.where(teeth == wanted, distance, np.inf)
        found.append(distance.min())
    return np.array(found)


def check_against_search(builds: Builds, reading: Reading) -> None:
    builds = in_range(builds, reading)
    seen, flank = read(builds, reading), builds.mesh.working_flank
    driver, driven, other = builds.driver_angle, seen.driven_angle, opposite(builds.mesh.working_flank)

    def distances(place: str, first: np.ndarray, second: np.ndarray, side: Flank) -> np.ndarray:
        return smallest(one_build(builds, reading, place), builds, reading, first, second, side)

    assert np.abs(distances("contact", driver, driven, flank)).max(initial=0.0) <= SEARCH_BOUND
    apart = np.abs(distances("gap", driver, driven, other) - seen.gap)
    assert (apart <= SEARCH_BOUND).all()
    # a right flank opens as either gear turns counter-clockwise about its own axis
    turned = distances("contact", driver, driven - other * seen.driven_turn, other)
    assert np.abs(turned).max(initial=0.0) <= TIE_BOUND
    turned = distances("contact", driver - other * seen.driver_turn, driven, other)
    assert np.abs(turned).max(initial=0.0) <= TIE_BOUND


@pytest.mark.slow
@covering(name=PAIRS, spread=SPREADS, reading=READINGS)
def test_seats_gaps_and_free_turns_agree_with_a_search_of_the_surfaces(name: str, spread: str, reading: str) -> None:
    for flank in (RIGHT, LEFT):
        builds = random_builds(PAIRS[name], flank, 2, 11, spread=SPREADS[spread], thinner=THINNER)
        check_against_search(builds, READINGS[reading])


@pytest.mark.slow
@pytest.mark.parametrize("teeth", TEETH)
@pytest.mark.parametrize("reading", READINGS)
@pytest.mark.parametrize("name", PAIRS)
@FLANKS
def test_a_thousand_poses_agree_with_a_search_of_the_surfaces(
    name: str, reading: str, teeth: Teeth, flank: Flank
) -> None:
    own = replace(READINGS[reading], teeth=teeth)
    for spread in SPREADS.values():
        check_against_search(random_builds(PAIRS[name], flank, 8, 40, spread=spread, thinner=THINNER), own)


@pytest.mark.slow
def test_the_search_and_the_brute_force_find_the_same_distances() -> None:
    builds = random_builds(PAIRS["17 to 43"], LEFT, 3, 5, spread=SPREADS["usual"], thinner=THINNER)
    driven = builds.mesh.pair.driven_angle(builds.driver_angle)
    for row, mesh in enumerate(searched_bevels(builds)):
        angles = builds.driver_angle[row : row + 1], driven[row : row + 1]
        plain = bevel_brute_force.distances(mesh, *angles, LEFT)
        ours = search.bevel_distances(mesh, *angles, LEFT)
        assert np.array_equal(plain[0], ours[0])
        # the older one stops 0.13 um up the flank, which tells on edges far from the mesh
        assert np.abs(plain[1].min() - ours[1].min()) < 1e-8
        assert np.abs(plain[1] - ours[1]).max() < 1e-6


# by hand --------------------------------------------------------------------------------------------------------------


def undisturbed(pair: BevelPair, flank: Flank, turned: tuple[float, float], offset: float) -> Builds:
    """Gears in their places, thinner by arcs at the mean radius or along the normals [mm]."""
    builds = random_builds(pair, flank, 50, 3, spread=Spread(*[0.0] * 7), thinner=0.0)
    radii = np.array([pair.pinion.mean_radius, pair.wheel.mean_radius])
    made = replace(
        builds.made, flank_turn=np.tile(np.array(turned) / (2 * radii), (50, 1)), flank_offset=np.full((50, 2), offset)
    )
    return replace(builds, made=made)


@pytest.mark.parametrize("name", PAIRS)
@FLANKS
def test_thinner_cones_leave_a_gap_proportional_to_the_cone_distance(name: str, flank: Flank) -> None:
    pair = PAIRS[name]
    builds = undisturbed(pair, flank, (-0.08, -0.05), 0.0)
    angle = sum(
        math.sin(gear.base_angle) * thinner / gear.mean_radius
        for gear, thinner in ((pair.pinion, 0.08), (pair.wheel, 0.05))
    )
    for reading, radius in (("mean_section", pair.mean_cone_distance), ("face", pair.face[0])):
        seen = read(builds, READINGS[reading])
        # the gap over R is a great circle's arc; the two faces of a slant at the toe see its foot GAP_SLANT apart
        bound = 1e-11 if reading == "mean_section" else GAP_SLANT
        assert np.abs(seen.gap - radius * math.sin(angle)).max() <= bound
        assert np.abs(seen.driven_turn * math.sin(pair.wheel.base_angle) - angle).max() < 1e-12
        assert np.abs(seen.driver_turn * math.sin(pair.pinion.base_angle) - angle).max() < 1e-11


# by itself ------------------------------------------------------------------------------------------------------------


@given(
    name=st.sampled_from(sorted(PAIRS)),
    flank=st.sampled_from([RIGHT, LEFT]),
    seed=st.integers(0, 2**32),
    reading=st.sampled_from(sorted(READINGS)),
    teeth=st.sampled_from(TEETH),
    spread=st.sampled_from(sorted(SPREADS)),
)
@settings(max_examples=60)
def test_reading_at_once_equals_reading_by_gaps(
    name: str, flank: Flank, seed: int, reading: str, teeth: Teeth, spread: str
) -> None:
    pair, own = PAIRS[name], replace(READINGS[reading], teeth=teeth)
    builds = random_builds(pair, flank, 100, seed, spread=SPREADS[spread], thinner=THINNER)
    seen, meshing = read(builds, own), meshing_of(builds, own)
    seat = meshing.seat(builds.driver_angle)
    told = seen.status != OUT_OF_RANGE
    assert np.array_equal(seen.status[told], seat.status[told])
    kinds = {
        "normal_backlash": (Backlash("normal_backlash", "mesh", "wheel", own), 1.0),
        "driven turn": (Backlash("angular_backlash", "mesh", "wheel", own), pair.wheel.base_radius),
        "driver turn": (Backlash("angular_backlash", "mesh", "pinion", own), pair.pinion.base_radius),
    }
    for what, (kind, arm) in kinds.items():
        at_once, by_gaps = read_backlash(kind, builds.mesh, seen), measure_backlash(kind, meshing, seat)
        assert np.array_equal(np.isnan(at_once)[told], np.isnan(by_gaps)[told]), what
        apart = arm * np.abs(at_once - by_gaps)[told & ~np.isnan(at_once)]
        assert apart.max(initial=0.0) <= (SECTION_BOUND if own.contact == "section" else TIE_BOUND), what
        if what != "normal_backlash" and len(apart):
            assert np.quantile(apart, 0.95) <= 1e-7, what


@pytest.mark.parametrize("name", PAIRS)
@FLANKS
def test_nearest_points_lie_on_both_flanks_and_are_apart_by_the_gap(name: str, flank: Flank) -> None:
    pair = PAIRS[name]
    spread = replace(SPREADS["usual"], offset=0.0)
    builds = random_builds(pair, flank, 30, 9, spread=spread, thinner=THINNER)
    seen, engine = read(builds, READINGS["face"]), ExactEngine(builds.model)
    teeth, near = pair.candidate_teeth(builds.driver_angle, flank)
    gaps = engine.gaps(builds.made, builds.mesh, flank, (builds.driver_angle, seen.driven_angle), teeth, near)
    apart = ((gaps.driven_point - gaps.driver_point) * gaps.normal).sum(axis=-1)
    assert apart[near] == pytest.approx(gaps.value[near], abs=1e-13)
    assert np.linalg.norm(gaps.normal[near], axis=-1) == pytest.approx(1.0, abs=1e-14)
    mates = pair.mating_teeth(teeth, flank)
    for row, mesh in enumerate(searched_bevels(builds)):
        driver = world_from_gears(mesh.driver_shaft, builds.driver_angle[row : row + 1], mesh.driver_centre)[0]
        driven = world_from_gears(mesh.driven_shaft, seen.driven_angle[row : row + 1], mesh.driven_centre)[0]
        for k in np.flatnonzero(near[row]):
            sides = (
                (mesh.driver, driver, gaps.driver_point[row, k], teeth[row, k]),
                (mesh.driven, driven, gaps.driven_point[row, k], mates[row, k]),
            )
            for gear, world, point, tooth in sides:
                own = world[:3, :3].T @ (point - world[:3, 3])
                assert abs(gear.signed_distance(own[None], np.array([tooth]), flank)[0]) < 1e-9


@pytest.mark.parametrize("of_driver", [True, False], ids=["driver turns", "driven turns"])
@FLANKS
def test_a_gap_s_derivative_by_a_turn_is_its_central_difference(flank: Flank, of_driver: bool) -> None:
    pair = PAIRS["31 to 31"]
    spread = replace(SPREADS["usual"], offset=0.0)
    builds = random_builds(pair, flank, 100, 31, spread=spread, thinner=THINNER)
    engine, step = ExactEngine(builds.model), 1e-5  # rad
    angles = (builds.driver_angle, read(builds, READINGS["face"]).driven_angle)
    teeth, near = pair.candidate_teeth(angles[0], flank)

    def gaps(sign: int) -> Gaps:
        turn = sign * step * np.array([of_driver, not of_driver])
        return engine.gaps(builds.made, builds.mesh, flank, (angles[0] + turn[0], angles[1] + turn[1]), teeth, near)

    quotient = (gaps(1).value - gaps(-1).value) / (2 * step)
    rate = gaps(0).per_turn(*builds.made.axis(0 if of_driver else 1), of_driver=of_driver)
    apart = np.abs(rate - quotient)[near] / (pair.pinion if of_driver else pair.wheel).base_radius
    # where the other end of the face takes over within the step the quotient mixes both arms, 12 % apart
    assert np.quantile(apart, 0.95) < 1e-6
    assert apart.max() < 0.07


@pytest.mark.parametrize("name", PAIRS)
def test_beyond_reach_there_is_a_status_and_no_number_and_within_it_the_right_one(name: str) -> None:
    pair, angle = PAIRS[name], 2 * np.pi * np.arange(12) / 12
    reach = 0.15 * pair.pinion.base_pitch * math.sin(pair.working_pressure_angle)
    directions = np.stack([np.cos(angle), np.sin(angle), np.where(np.arange(12) % 2, 0.5, -0.5)], axis=1)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    still = random_builds(pair, RIGHT, 12, 2, spread=Spread(*[0.0] * 7), thinner=0.3)
    for share in (1.01, 0.98):
        shafts = still.made.world_from_shaft.copy()
        shafts[:, 1, :3, 3] += share * reach * directions
        builds = replace(still, made=replace(still.made, world_from_shaft=shafts))
        if share > 1.0:
            seen = read(builds, READINGS["face"])
            assert (seen.status == OUT_OF_RANGE).all()
            assert np.isnan(seen.gap).all()
            assert np.isnan(seen.driven_angle).all()
            continue
        seen = read(builds, READINGS["face_contact"])
        told = np.flatnonzero(seen.status == OK)
        meshes = list(searched_bevels(builds))
        for row in told:
            own = slice(row, row + 1)
            _, distance, _ = search.bevel_distances(
                meshes[row], builds.driver_angle[own], seen.driven_angle[own], RIGHT
            )
            assert abs(distance.min()) <= SEARCH_BOUND


@pytest.mark.parametrize("centre", [0.1, 0.3, 0.6])
def test_gears_far_off_their_axes_have_a_status_or_the_right_number(centre: float) -> None:
    pair = PAIRS["17 to 43"]
    spread = Spread(0.0, 0.0, centre=centre, turned=0.0, offset=0.0)
    builds = in_range(random_builds(pair, RIGHT, 20, 1, spread=spread, thinner=centre), READINGS["face"])
    seen = read(builds, READINGS["face"])
    whole = one_build(builds, READINGS["face"], "contact")
    found = smallest(whole, builds, READINGS["face"], builds.driver_angle, seen.driven_angle, RIGHT)
    assert np.abs(found).max(initial=0.0) <= SEARCH_BOUND


@pytest.mark.slow
@covering(flank=BOTH_FLANKS, name=PAIRS)
def test_every_candidate_pair_s_gap_is_that_of_the_search(name: str, flank: Flank) -> None:
    pair = PAIRS[name]
    builds = in_range(
        random_builds(pair, flank, 20, 3, spread=replace(SPREADS["wide"], growth=0.0), thinner=THINNER),
        READINGS["face"],
    )
    seen = read(builds, READINGS["face"])
    angles = builds.driver_angle, seen.driven_angle
    teeth, near = pair.candidate_teeth(builds.driver_angle, flank)
    gaps = ExactEngine(builds.model).gaps(builds.made, builds.mesh, flank, angles, teeth, near).value
    for row, mesh in enumerate(searched_bevels(builds)):
        numbers, distance, _ = search.bevel_distances(mesh, angles[0][row : row + 1], angles[1][row : row + 1], flank)
        for k in np.flatnonzero(near[row]):
            found = distance[0, numbers[0] == teeth[row, k]][0]
            # a pair whose flanks both end short of each other is told by a bound; a tip edge's overlap by its depth
            assert gaps[row, k] <= found + SEARCH_BOUND
            if gaps[row, k] < 0.05:
                assert gaps[row, k] == pytest.approx(found, abs=SEARCH_BOUND)
