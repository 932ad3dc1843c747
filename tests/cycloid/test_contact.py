"""First contact of cycloid discs: dense search, identities of finite geometry, the digest's Monte Carlo."""

import math
from dataclasses import replace

import numpy as np
import pytest
from cycloid_stages import CRANK_CIRCLE, PROFILE, SHORTENING, Array, digest_draw, erring, perfect, searched

from tol3d.gearing.cycloid.exact.contact import (
    AsMade,
    bearings,
    contact_shape,
    first_contact,
    leaning,
    linkage,
    pin_centres,
)
from tol3d.gearing.cycloid.model.profile import DiscProfile, Modification
from tol3d.gearing.cycloid.model.stage import Touching

WINDOW = 0.7  # least lever of a working pin over a Zc
SUN_HELD = 1.5  # turns of a planet in space per turn of the carrier: 1 + zs / zp with zp = 2 zs
ARC_SECOND = math.pi / 648_000
ROUNDING = 1e-14  # rad; coordinates of 120 mm are rounded to 1.4e-14 mm, over levers of 60 mm, some times


def around(trials: int, positions: int, seed: int = 7) -> Array:
    """Random crank angles within a turn of the output."""
    return np.random.default_rng(seed).uniform(0, 2 * np.pi * 39, (trials, positions))


@pytest.mark.parametrize("rolling", [0.0, SUN_HELD])
def test_first_contact_is_that_of_a_dense_search(rolling: float) -> None:
    made, phis = erring(2, 2, 0.002, seed=3), around(2, 1)
    found = first_contact(contact_shape(PROFILE, WINDOW, rolling), made, phis)
    for trial, (s, sense) in zip((0, 1), enumerate((1, -1)), strict=True):
        turn, place = searched(made, trial, phis[trial, 0], sense, WINDOW, rolling)
        assert found.places[trial, 0, s] == place
        assert abs(found.turns[trial, 0, s] - turn) * PROFILE.pitch_radius < 1e-8  # mm; the bisection stops at 3e-10


def test_rotated_flanks_touch_where_a_dense_search_finds_them() -> None:
    profile = replace(PROFILE, modification=Modification(-0.02, -0.01, 1e-4))
    made, phis = erring(1, 1, 0.002, seed=4, profile=profile), around(1, 1)
    found = first_contact(contact_shape(profile, WINDOW, 0.0), made, phis)
    turn, place = searched(made, 0, phis[0, 0], -1, WINDOW, 0.0, profile)
    assert (found.places[0, 0, 1], abs(found.turns[0, 0, 1] - turn) < 1e-10) == (place, True)


@pytest.mark.parametrize("phase", [0.08, 0.12])
@pytest.mark.parametrize("outwards", [0.01, 0.06])
def test_a_pin_that_no_turn_reaches_changes_nothing(phase: float, outwards: float) -> None:
    """Near a root, where the flank bends: others stop the disc within 0.1 um, while this one has a gap of 10 um."""
    made, phis = perfect(1, 1), np.array([[phase]])
    made.pins[0, 0, 0] += outwards
    found, without = (first_contact(contact_shape(PROFILE, least, 0.0), made, phis, (-1.0,)) for least in (0.01, 0.7))
    assert (found.turns[0, 0, 0], found.places[0, 0, 0]) == (without.turns[0, 0, 0], without.places[0, 0, 0])
    assert abs(found.turns[0, 0, 0]) * PROFILE.pitch_radius < 1e-4  # mm


def test_a_pin_that_no_turn_clears_leaves_no_contact() -> None:
    """At a root, a fiftieth of the longest lever, it lies 20 um inwards, where the modification leaves 7.2 um."""
    made = perfect(1, 1)
    made.pins[0, 0, 0] -= 0.02
    found = first_contact(contact_shape(PROFILE, 0.01, 0.0), made, np.array([[0.005]]), (-1.0,))
    assert (np.isnan(found.turns[0, 0, 0]), found.places[0, 0, 0]) == (True, -1)


def test_contact_after_many_turns_is_that_of_the_first() -> None:
    """A sun of 41 and planets of 47 teeth stand as before after 41 turns of the output, crank angles of 10 000 rad."""
    made, phis, shape = erring(2, 2, 0.002, seed=3), around(2, 50), contact_shape(PROFILE, WINDOW, 1 + 41 / 47)
    first, last = (first_contact(shape, made, phis + 2 * math.pi * 39 * turns) for turns in (0, -41))
    assert abs(first.turns - last.turns).max() < 1e-13  # rounding of such an angle, 2e-12, over 39 lobes
    assert (first.places == last.places).all()


@pytest.mark.parametrize("tilt", [3e-4, 2e-3])
def test_a_tilted_disc_touches_with_the_section_that_a_dense_search_finds(tilt: float) -> None:
    made, phis, tilts = erring(2, 2, 0.002, seed=15), around(2, 1), np.empty((2, 2, 2))
    for trial, (s, sense) in zip((0, 1), enumerate((1, -1)), strict=True):
        tilts[trial] = tilt * np.array([[0.8, -0.6], [-0.28, 0.96]])
        leaning_one = replace(made, leans=leaning(tilts, 20.0))
        found = first_contact(contact_shape(PROFILE, WINDOW, 0.0), leaning_one, phis)
        turn, place = searched(made, trial, phis[trial, 0], sense, WINDOW, 0.0, tilts=(tilts[trial], 20.0))
        assert found.places[trial, 0, s] == place
        assert abs(found.turns[trial, 0, s] - turn) * PROFILE.pitch_radius < 1e-7  # mm; a tilt shifts by 0.02


@pytest.mark.slow
def test_a_disc_that_leans_along_a_flank_touches_inside_its_width() -> None:
    """A wide disc whose pin lies along the convex flank: inside by curvature, 1e-4 mm before both faces."""
    phi = -0.9  # pin 0 at 52 degrees, on a convex flank
    made = perfect(1, 1)
    thin = np.full((1, 40), 4.8)
    thin[0, 0] = 5.0
    speed = math.sqrt(1 + SHORTENING**2 - 2 * SHORTENING * math.cos(phi))
    normal = (1 - SHORTENING * complex(math.cos(phi), math.sin(phi))) / speed
    along = -1j * normal * complex(math.cos(phi / 39), math.sin(phi / 39))  # tau along the flank, in the disc's frame
    tilts = 3e-3 * np.array([[[along.imag, -along.real]]])
    shape, angles = contact_shape(PROFILE, WINDOW, 0.0), np.array([[phi]])
    stage = replace(made, pin_radii=thin, leans=leaning(tilts, 40.0))
    leans = first_contact(shape, stage, angles, (1.0,)).turns[0, 0, 0]
    flat = first_contact(shape, replace(stage, leans=None), angles, (1.0,)).turns[0, 0, 0]
    turn, place = searched(stage, 0, phi, 1, WINDOW, 0.0, tilts=(tilts[0], 40.0))
    assert place == 0
    assert abs(leans - turn) * PROFILE.pitch_radius < 1e-7
    assert abs(leans - flat) * PROFILE.pitch_radius < 5e-3  # of 0.12 mm that its faces are apart along the flank


def test_a_perfect_unmodified_disc_touches_all_pins_where_it_stands() -> None:
    bare = replace(PROFILE, modification=Modification())
    found = first_contact(contact_shape(bare, 0.01, 0.0, deflection=1e-9), perfect(profile=bare), around(1, 20))
    np.testing.assert_allclose(found.turns, 0.0, atol=ROUNDING / 0.01)
    assert found.near is not None
    phases = 2 * np.pi * (np.arange(40) / 40 + np.array([[0.0], [0.5]])).ravel() - around(1, 20)[0, :, None]
    levers = np.sin(phases) / np.sqrt(1 + SHORTENING**2 - 2 * SHORTENING * np.cos(phases))
    for s, sense in enumerate((1, -1)):
        np.testing.assert_array_equal(found.near[0, :, s], (sense * levers > 0.01).sum(axis=1))


def test_cranks_that_all_lead_by_an_angle_are_cranks_at_another_angle() -> None:
    phis, lead = around(3, 4), 1e-3
    nothing = np.zeros((3, 2, 3, 2))
    own = erring(3, 2, 0.0, seed=0)
    lobes = erring(3, 2, 0.004, seed=5)

    def stage(phase: float) -> AsMade:
        made = linkage(bearings(
            2.2, CRANK_CIRCLE, nothing[:, :, 0], nothing, 0.004 + nothing.swapaxes(1, 2), np.full((3, 3), phase),
            nothing[:, 0], nothing[:, 0, 0],
        ))  # fmt: skip
        return replace(own, linkage=made, lobe_pitch=lobes.lobe_pitch, pins=lobes.pins)

    shape = contact_shape(PROFILE, WINDOW, 0.0)
    leading, later = first_contact(shape, stage(lead), phis), first_contact(shape, stage(0.0), phis + lead)
    # working pins are those of phi, not of phi + lead: few positions have another set, none of these
    np.testing.assert_array_equal(leading.places, later.places)
    np.testing.assert_allclose(leading.turns, later.turns - lead / 39, rtol=0, atol=10 * ROUNDING)


def test_lobes_that_are_all_ahead_let_the_carrier_stay_behind_by_their_angle() -> None:
    made, phis = erring(3, 2, 0.003, seed=8), around(3, 4)
    centred = replace(made, linkage=perfect(3).linkage)
    ahead = replace(centred, lobe_pitch=centred.lobe_pitch + 0.005)
    shape = contact_shape(PROFILE, WINDOW, 0.0)
    expected = first_contact(shape, centred, phis).turns - 0.005 * SHORTENING / 85.8
    np.testing.assert_allclose(first_contact(shape, ahead, phis).turns, expected, rtol=0, atol=10 * ROUNDING)


def test_cranks_roll_on_the_held_sun_so_that_the_output_errs_by_39_over_40_5() -> None:
    made, phis = erring(3, 2, 0.003, seed=9), around(3, 4)
    held = first_contact(contact_shape(PROFILE, WINDOW, SUN_HELD), made, phis)
    free = first_contact(contact_shape(PROFILE, WINDOW, 0.0), made, phis)
    same = held.places == free.places
    assert same.mean() > 0.9
    # the discs roll on by 1.5 turns of 1e-4 rad: other places of the same curves, 1e-3 of the turn
    np.testing.assert_allclose(held.turns[same] / free.turns[same], 39 / 40.5, rtol=3e-3)


def one_at_a_time(shape_deflection: float, made: AsMade, phis: Array) -> list[Touching]:
    """Contacts of each pin alone: the others are made so thin that they touch nothing."""
    shape = contact_shape(PROFILE, WINDOW, 0.0)
    found = []
    for pin in range(40):
        radii = made.pin_radii - 0.2
        radii[:, pin] = made.pin_radii[:, pin] + shape_deflection
        found.append(first_contact(shape, replace(made, pin_radii=radii), phis))
    return found


@pytest.mark.slow
@pytest.mark.parametrize(("scale", "tilt"), [(0.002, 0.0), (0.01, 0.0), (0.002, 4e-3)])
def test_no_pin_that_touches_first_is_screened_out(scale: float, tilt: float) -> None:
    made, phis = erring(400, 1, scale, seed=11), around(400, 20)
    tilts = np.random.default_rng(17).normal(0.0, tilt, (400, 1, 2))
    made = replace(made, leans=leaning(tilts, 40.0))
    found = first_contact(contact_shape(PROFILE, WINDOW, 0.0), made, phis)
    alone = np.array([each.turns for each in one_at_a_time(0.0, made, phis)])
    # a pin that is idle at a position leaves the first of the thin ones: farther away
    np.testing.assert_array_equal(found.turns[..., 0], alone[..., 0].min(axis=0))
    np.testing.assert_array_equal(found.turns[..., 1], alone[..., 1].max(axis=0))


@pytest.mark.slow
def test_pins_within_a_deflection_are_those_that_would_touch_if_they_were_thicker() -> None:
    made, phis = erring(100, 1, 0.003, seed=12), around(100, 10)
    found = first_contact(contact_shape(PROFILE, WINDOW, 0.0, deflection=0.004), made, phis)
    thicker = np.array([each.turns for each in one_at_a_time(0.004, made, phis)])
    assert found.near is not None
    np.testing.assert_array_equal(found.near[..., 0], (thicker[..., 0] <= found.turns[..., 0]).sum(axis=0))
    np.testing.assert_array_equal(found.near[..., 1], (thicker[..., 1] >= found.turns[..., 1]).sum(axis=0))
    assert 2 < found.near.mean() < 10


@pytest.mark.slow
def test_trials_and_positions_have_the_same_bits_alone_and_together() -> None:
    made, phis = erring(50, 2, 0.004, seed=13), around(50, 6)
    shape = contact_shape(PROFILE, WINDOW, SUN_HELD)
    whole = first_contact(shape, made, phis)
    for trial in (0, 17, 49):
        one = slice(trial, trial + 1)
        names = [name for name in made.__dataclass_fields__ if name != "leans"]
        alone = AsMade(*(getattr(made, name)[one] for name in names))
        for position in (0, 5):
            part = first_contact(shape, alone, phis[trial : trial + 1, position : position + 1], (-1.0,))
            np.testing.assert_array_equal(part.turns[0, 0, 0], whole.turns[trial, position, 1])


def half_range(values: Array) -> float:
    """Half of what holds 99.73 % [arc seconds]."""
    low, high = np.quantile(values / ARC_SECOND, [0.00135, 0.99865])
    return float(high - low) / 2


@pytest.mark.slow
@pytest.mark.parametrize(("discs", "sd", "half"), [(1, 12.1, 37.2), (2, None, 35.8)])
def test_the_digests_monte_carlo_is_met_within_its_sampling_error(discs: int, sd: float | None, half: float) -> None:
    trials = 100_000
    turns = first_contact(
        contact_shape(PROFILE, WINDOW, 0.0), digest_draw(trials, discs, seed=21), around(trials, 1), (1.0,)
    ).turns
    # sd: 12 / sqrt(2 n) = 0.03 and the digest's last digit; the half-range of n = 1e5: 135 values in either tail, 0.3
    assert half_range(turns) == pytest.approx(half, abs=0.9)
    if sd is not None:
        assert np.std(turns) / ARC_SECOND == pytest.approx(sd, abs=0.13)
        assert np.mean(turns) / ARC_SECOND == pytest.approx(-7, abs=0.5)  # "about"


def test_eccentricity_of_a_disc_acts_through_the_pitch_radius() -> None:
    """2.4040 arc seconds per micrometre at a pin whose lever is the pitch radius, of a tangential displacement."""
    bare = DiscProfile(40, 114.5, 5.0, 2.2)
    phi = -bare.best_phase  # pin 0 has the largest lever
    radii = np.full((1, 40), 4.8)
    radii[0, 0] = 5.0
    found = []
    for offset in (1e-5, -1e-5):
        moved = offset * np.array([math.cos(phi + math.pi / 2), math.sin(phi + math.pi / 2)])
        nothing = np.zeros((1, 1, 3, 2))
        made = linkage(bearings(
            2.2, CRANK_CIRCLE, moved.reshape(1, 1, 2) @ _rotation(phi / 39), nothing, nothing[:, 0, :, None, :],
            nothing[:, 0, :, 0], nothing[:, 0], nothing[:, 0, 0],
        ))  # fmt: skip
        stage = AsMade(
            made, pin_centres(114.5, np.zeros((1, 40, 2))), radii, np.zeros((1, 1, 39)), np.zeros((1, 1, 39))
        )
        found.append(first_contact(contact_shape(bare, WINDOW, 0.0), stage, np.array([[phi]]), (1.0,)).turns[0, 0, 0])
    assert abs(found[0] - found[1]) / 2e-2 / ARC_SECOND == pytest.approx(2.4040, abs=5e-5)


def _rotation(angle: float) -> Array:
    """Takes row vectors in space to a frame turned by -angle."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, s], [-s, c]])
