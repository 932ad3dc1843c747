"""The analytic method of cycloid stages, against discs that are moved until they touch and a plain Monte Carlo."""

import math
from dataclasses import fields, replace

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.cycloid_monte_carlo import Units
from oracles.cycloid_monte_carlo import units as monte_carlo
from oracles.deviated_cycloid import Disc, Stage, first_turn
from rv_250 import CRANK_CIRCLE, SHORTENING, nothing, random_deviations, rv_250, stage_of

from tol3d.gearing.cycloid.exact.contact import ContactStage
from tol3d.gearing.cycloid.first_order.linear import LinearStage, Sense
from tol3d.gearing.cycloid.model.profile import DiscProfile
from tol3d.gearing.cycloid.model.stage import Deviated
from tol3d.gearing.cycloid.reducer.neglected import BentStage

Array = NDArray[np.float64]

SECONDS = math.degrees(1.0) * 3600


def scaled(deviated: Deviated, factor: float) -> Deviated:
    return Deviated(*(factor * getattr(deviated, field.name) for field in fields(deviated)))


# one deviation at a time --------------------------------------------------------------------------------------------


def best_crank(pin: int) -> float:
    """Crank at which a pin has the largest lever against discs that turn counter-clockwise."""
    return 2 * math.pi * pin / 40 - math.acos(SHORTENING)


@pytest.mark.parametrize(
    ("field", "index", "per_um"),
    [
        ("pins", (0, 7, 0), 1.5380),
        ("pins", (0, 7, 1), 1.8476),
        ("pin_radii", (0, 7), -2.4040),
        ("lobe_profile", (0, 0, slice(None)), -2.4040),
        ("lobe_pitch", (0, 0, slice(None)), -1.8476),
    ],
)
def test_best_pin_has_the_published_levers(field: str, index: tuple[int | slice, ...], per_um: float) -> None:
    """A pin that is moved into the disc stops it before all others do; one that is moved out is not asked."""
    own = nothing(1, discs=1)
    towards = -1.0 if per_um > 0 else 1.0
    getattr(own, field)[index] = towards * 1e-3
    found = stage_of(rv_250(), discs=1).touches(own, np.array([[best_crank(7)]]))
    assert int(found.places[0, 0]) == 7
    assert found.turns[0, 0] * SECONDS == pytest.approx(-abs(per_um), abs=5e-5)


@pytest.mark.parametrize("angle", [0.0, 1.0, 4.0])
def test_a_displaced_disc_turns_by_its_displacement_along_the_normal_over_the_pitch_radius(angle: float) -> None:
    """At the best pin the normal stands at right angles to the crank, e^(i phi) i; offsets turn with the disc."""
    crank, own = best_crank(7), nothing(1, discs=1)
    world = 1e-3 * np.exp(1j * angle)
    turned = world * np.exp(1j * crank / 39)
    own.disc_offsets[0, 0] = turned.real, turned.imag
    along = float((world * np.conj(1j * np.exp(1j * crank))).real)
    exactly = replace_window(stage_of(rv_250(), discs=1)).touches(own, np.array([[crank]]))
    assert int(exactly.places[0, 0]) == 7
    assert exactly.turns[0, 0] == pytest.approx(-along / 85.8, rel=1e-12)


def replace_window(stage: LinearStage) -> LinearStage:
    """The best pin alone works."""
    return replace(stage, window=0.9999)


@pytest.mark.parametrize("rolling", [0.0, 1.5])
def test_what_turns_a_disc_on_its_carrier_turns_the_carrier_less_the_cranks_part(rolling: float) -> None:
    """Holes all off by q tangentially turn discs by q / R; the sun held takes 1 / (1 + 1.5/39) = 0.96296 of it."""
    own = nothing(1)
    tangential = 1j * np.exp(2j * np.pi * np.arange(3) / 3)
    own.disc_holes[...] = 1e-3 * np.stack([tangential.real, tangential.imag], axis=-1)
    phis = np.linspace(0.0, 3.0, 7)[None]
    stage = stage_of(rv_250(), rolling=rolling)
    without, found = stage.touches(nothing(1), phis), stage.touches(own, phis)
    shift = {0.0: 1.0, 1.5: 0.962963}[rolling] * 1e-3 / CRANK_CIRCLE
    np.testing.assert_allclose(found.turns - without.turns, shift, rtol=1e-6)


def test_a_phase_of_all_cranks_is_another_crank_angle() -> None:
    """Cranks ahead by b have the carrier where it stands at phi + b, b / 39 back."""
    own, ahead = nothing(1), 1e-6
    own.crank_phases[...] = ahead
    stage, phi = stage_of(rv_250(0.0)), np.array([[1.0]])
    assert stage.touches(own, phi).turns[0, 0] == pytest.approx(-ahead / 39, rel=1e-9)


# all of them --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("sense", [1, -1])
def test_rates_times_deviations_and_the_clearance_over_the_lever_are_the_turn(sense: Sense) -> None:
    trials, stage = 40, stage_of(rv_250(), rolling=1.5)
    own = random_deviations(trials, 3, 1e-3)
    phis = np.random.default_rng(4).uniform(0.0, 2 * np.pi * 39, (trials, 1))
    found = stage.touches(own, phis, sense)
    rates = stage.rates(phis[:, 0], found.places[:, 0])
    linear = sum(
        np.einsum(
            "tk,tk->t", getattr(rates, field.name).reshape(trials, -1), getattr(own, field.name).reshape(trials, -1)
        )
        for field in fields(own)
    )
    free = np.array(
        [
            clearance_turn(stage, float(phi), int(place))
            for phi, place in zip(phis[:, 0], found.places[:, 0], strict=True)
        ]
    )
    np.testing.assert_allclose(found.turns[:, 0], free + linear, atol=1e-16)


def clearance_turn(stage: LinearStage, phi: float, place: int) -> float:
    """By hand: 0.02 (cos - sqrt(1 - K^2)) over the lever and 1 + 1.5/39."""
    disc, pin = divmod(place, 40)
    phase = 2 * math.pi * pin / 40 - phi - math.pi * disc
    w = math.sqrt(1 + SHORTENING**2 - 2 * SHORTENING * math.cos(phase))
    gap = 0.02 * ((1 - SHORTENING * math.cos(phase)) / w - math.sqrt(1 - SHORTENING**2))
    return gap / (85.8 * math.sin(phase) / w) / (1 + stage.rolling / 39)


def test_turning_back_is_turning_forth_in_the_mirror() -> None:
    """Pins and lobes mirrored in the x-axis, cranks turning the other way; each disc's lobes count backwards."""
    stage, own = stage_of(rv_250(), discs=1), nothing(30, discs=1)
    rng = np.random.default_rng(8)
    own.pins[...] = rng.normal(0.0, 0.005, own.pins.shape)
    own.lobe_profile[...] = rng.normal(0.0, 0.005, own.lobe_profile.shape)
    own.disc_offsets[...] = rng.normal(0.0, 0.005, own.disc_offsets.shape)
    mirrored = nothing(30, discs=1)
    order = -np.arange(40) % 40
    mirrored.pins[...] = own.pins[:, order] * [1.0, -1.0]
    mirrored.lobe_profile[...] = own.lobe_profile[:, :, ::-1]
    mirrored.disc_offsets[...] = own.disc_offsets * [1.0, -1.0]
    phis = rng.uniform(0.0, 245.0, (30, 2))
    back = stage.touches(own, phis, -1)
    np.testing.assert_allclose(-stage.touches(mirrored, -phis, 1).turns, back.turns, atol=1e-16)


def test_positions_of_all_trials_give_the_same_as_positions_of_each() -> None:
    stage, own = stage_of(rv_250(), rolling=1.5), random_deviations(8, 5, 3e-3)
    phis = np.random.default_rng(6).uniform(0.0, 245.0, (1, 3))
    once, each = stage.touches(own, phis), stage.touches(own, np.repeat(phis, 8, axis=0))
    np.testing.assert_allclose(once.turns, each.turns, atol=1e-18)
    np.testing.assert_array_equal(once.places, each.places)


# against discs that are moved ---------------------------------------------------------------------------------------


def moved_turn(profile: DiscProfile, own: Deviated, phi: float, rolling: float) -> float:
    """The first trial's turn, by moving discs."""
    points = profile.ground.points

    def plane(values: Array) -> NDArray[np.complex128]:
        return np.asarray(values[..., 0] + 1j * values[..., 1])

    around, cranks = np.exp(2j * np.pi * np.arange(40) / 40), np.exp(2j * np.pi * np.arange(3) / 3)
    carrier = CRANK_CIRCLE * cranks + plane(own.carrier_holes[0]) + plane(own.carrier_offsets[0])
    made = Stage((114.5 + plane(own.pins[0])) * around, 5.0 + own.pin_radii[0], carrier, rolling, 39)
    discs = []
    for disc in (0, 1):
        throws = (2.2 * (-1) ** disc + plane(own.crank_errors[0, :, disc])) * np.exp(1j * own.crank_phases[0])
        holes = CRANK_CIRCLE * cranks + plane(own.disc_holes[0, disc]) - plane(own.disc_offsets[0, disc])
        pitch = own.lobe_pitch[0, disc] * SHORTENING / 85.8
        discs.append(Disc(points, -math.pi * disc / 39, holes, throws, pitch, own.lobe_profile[0, disc]))
    phases = [[2 * math.pi * pin / 40 - phi - math.pi * disc for pin in range(40)] for disc in (0, 1)]
    working = [(disc, pin) for disc in (0, 1) for pin in range(40) if lever(phases[disc][pin]) > 0.7]
    return first_turn(made, discs, phi, working)


def lever(phase: float) -> float:
    return math.sin(phase) / math.sqrt(1 + SHORTENING**2 - 2 * SHORTENING * math.cos(phase))


@pytest.mark.parametrize(
    ("seed", "rolling"), [(3, 1.5), *(pytest.param(*own, marks=pytest.mark.slow) for own in ((1, 0.0), (2, 1.5)))]
)
def test_error_falls_with_the_square_of_deviations_and_clearance(seed: int, rolling: float) -> None:
    """Four times smaller at half the size, of 4 um deviations of every kind and 20 um clearance."""
    own, phi = random_deviations(1, seed, 4e-3), 0.7 + seed
    errors = []
    for factor in (1.0, 0.5):
        profile, less = rv_250(0.02 * factor), scaled(own, factor)
        linear = stage_of(profile, rolling=rolling).touches(less, np.array([[phi]]))
        errors.append(float(linear.turns[0, 0]) - moved_turn(profile, less, phi, rolling))
    assert abs(errors[0]) * SECONDS < 0.5
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.15)


def as_drawn(count: int, seed: int, *, displaced_circle: bool = False) -> tuple[Units, Deviated, Array]:
    """Units of the published example by the plain Monte Carlo, their deviations and crank angles."""
    units, own = monte_carlo(count, seed, displaced_circle=displaced_circle), nothing(count)
    drawn = units.drawn
    own.pins[:, :, 0], own.pins[:, :, 1] = 1e-3 * drawn.radial, 1e-3 * drawn.tangential
    for disc in range(2):
        own.lobe_pitch[:, disc], own.lobe_profile[:, disc] = 1e-3 * drawn.pitch[disc], 1e-3 * drawn.profile[disc]
        own.disc_offsets[:, disc] = 1e-3 * coordinates(drawn.discs[disc])
        own.crank_errors[:, :, disc] = 1e-3 * coordinates(drawn.cranks[disc])[:, None]
    return units, own, drawn.crank[:, None]


def coordinates(values: NDArray[np.complex128]) -> Array:
    return np.stack([values.real, values.imag], axis=-1)


def of_first_disc(own: Deviated) -> Deviated:
    """A stage with one disc."""
    by_disc = {name: getattr(own, name)[:, :1] for name in ("lobe_pitch", "lobe_profile", "disc_offsets", "disc_holes")}
    return replace(own, **by_disc, crank_errors=own.crank_errors[:, :, :1])


@pytest.mark.parametrize("displaced", [False, True], ids=["radius", "once per turn"])
def test_turns_are_those_of_a_plain_monte_carlo_unit_by_unit(displaced: bool) -> None:
    units, own, phis = as_drawn(2000, 12, displaced_circle=displaced)
    both = stage_of(rv_250()).touches(own, phis).turns[:, 0] * SECONDS
    first = stage_of(rv_250(), discs=1).touches(of_first_disc(own), phis).turns[:, 0] * SECONDS
    np.testing.assert_allclose(both, units.both, atol=1e-9)
    np.testing.assert_allclose(first, units.first, atol=1e-9)


@pytest.mark.slow
def test_exact_contact_spreads_as_the_plain_monte_carlo_within_what_first_order_neglects() -> None:
    """Unit by unit: two half-ranges of the same units differ by less than the largest of all but 0.1 %, 1.1''."""
    units, own, phis = as_drawn(50_000, 14)
    profile = rv_250()
    exact = ContactStage(profile, 2, 3, CRANK_CIRCLE, 0.0, 0.7).touches(own, phis, (1.0,)).turns[:, 0, 0] * SECONDS
    assert np.quantile(np.abs(exact - units.both), 0.999) < 1.1
    assert half_range(exact) == pytest.approx(half_range(units.both), abs=0.3)
    assert exact.std() == pytest.approx(units.both.std(), abs=0.05)


def half_range(values: Array) -> float:
    low, high = np.quantile(values, [0.00135, 0.99865])
    return float(high - low) / 2


@pytest.mark.slow
def test_the_pins_radius_does_not_matter() -> None:
    """Flanks are equidistant to the path of pin centres, so a pin touches where its centre meets that path."""
    _, own, phis = as_drawn(5000, 15)
    turns = []
    for radius in (4.0, 9.0):
        profile = replace(rv_250(), pin_radius=radius)
        exact = ContactStage(profile, 1, 3, CRANK_CIRCLE, 0.0, 0.7).touches(of_first_disc(own), phis, (1.0,))
        turns.append(exact.turns)
    np.testing.assert_allclose(turns[0], turns[1], atol=1e-13)


@pytest.mark.slow
def test_exact_contact_differs_by_a_tenth_of_an_arc_second_and_by_a_quarter_of_that_at_half_the_size() -> None:
    """Root mean square; of a thousand units one differs by more than 1'', where the shortest levers touch."""
    _, own, phis = as_drawn(20_000, 13)
    off = []
    for factor in (1.0, 0.5):
        profile, less = rv_250(0.02 * factor), scaled(own, factor)
        stage = stage_of(profile)
        exact = ContactStage(profile, 2, 3, CRANK_CIRCLE, 0.0, stage.window).touches(less, phis, (1.0,))
        off.append((exact.turns[:, 0, 0] - stage.touches(less, phis).turns[:, 0]) * SECONDS)
    sizes = [float(np.sqrt(np.mean(own**2))) for own in off]
    assert sizes[0] == pytest.approx(0.096, abs=0.01)
    assert sizes[0] / sizes[1] == pytest.approx(4.0, rel=0.1)
    assert np.quantile(np.abs(off[0]), 0.999) < 1.1


@pytest.mark.slow
def test_what_the_analytic_method_neglects_is_the_bend_of_the_flank() -> None:
    """A hundredth of 0.11'' rms is left where the same pin touches: terms of third order and of lobes."""
    _, both, phis = as_drawn(20_000, 16)
    own, stage = of_first_disc(both), stage_of(rv_250(), discs=1)
    exact = ContactStage(stage.profile, 1, 3, CRANK_CIRCLE, 0.0, 0.7).touches(own, phis, (1.0,))
    linear = stage.touches(own, phis)
    same = exact.places[:, 0, 0] == linear.places[:, 0]
    off = (exact.turns[:, 0, 0] - linear.turns[:, 0])[same] * SECONDS
    bent = BentStage.of(stage).touches(own, phis)
    left = off - (bent.turns[:, 0] - linear.turns[:, 0])[same] * SECONDS
    assert same.mean() > 0.98
    assert float(np.mean(off**2)) ** 0.5 == pytest.approx(0.108, abs=0.01)
    assert float(np.mean(left**2)) ** 0.5 < 0.015
