"""Draws from tolerance zones against rejection: laws, moments, what lies inside, and the bits of a trial."""

import math
import pickle
from collections.abc import Callable
from functools import cache, partial

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.zone_sets import MOTIONS, REFINED, SETS
from scipy.integrate import dblquad
from scipy.stats import chi2, ks_2samp, qmc

from tol3d.assembly.zones import Confined, Zone, catalogue, normal_in, process_in, uniform_in
from tol3d.statistics.distributions.normal import Normal

Array = NDArray[np.float64]

LAWS: dict[str, Callable[[Zone], Confined]] = {"uniform": uniform_in, "normal": normal_in}
ZONES: dict[str, Callable[..., Zone]] = {
    "rectangle": catalogue.rectangle,
    "round face": catalogue.round_face,
    "rectangle's orientation": catalogue.rectangle_orientation,
    "round face's orientation": catalogue.round_face_orientation,
    "axis": catalogue.axis,
    "axis' orientation": catalogue.axis_orientation,
    "axis at a section": catalogue.axis_section,
    "flat axis": lambda width, *refined: catalogue.flat_axis(width, (3.0, 4.0), *refined),
    "axis along": lambda width, own=0.0, *form: catalogue.axis_along(width, (3.0, 4.0), own or width, *form),
    "flat axis round": lambda width, own=0.0, *form: catalogue.flat_axis_round(width, (3.0, 4.0), own or width, *form),
    "flat axis' orientation": lambda width: catalogue.flat_axis_orientation(width, (3.0, 4.0)),
    "point in a sphere": catalogue.point_in_sphere,
    "point in a disc": catalogue.point_in_disc,
    "point between planes": catalogue.point_between_planes,
    **{f"{a} shifts and {b} turns": partial(catalogue.pattern_motion, shifts=a, turns=b) for a, b in MOTIONS},
}
WIDTH = 0.1
CASES: list[tuple[str, str, float | None]] = [(name, law, None) for name in ZONES for law in LAWS]
CASES += [(name, law, part * WIDTH) for name in REFINED for law in LAWS for part in (0.8, 0.3, 0.1)]
FEW, MANY = 10_000, 1_000_000
RARE = 1e-7  # probability at which a test of one sample fails though the law is right; some hundreds are made


def zone_of(name: str, orientation: float | None) -> Zone:
    return ZONES[name](WIDTH) if orientation is None else ZONES[name](WIDTH, orientation)


def drawn(draw: Confined, count: int, seed: int = 1) -> Array:
    """Components (count, components)."""
    rng = np.random.default_rng(seed)
    return np.stack(draw.deviations(*rng.random((draw.uniforms, count))), axis=1)


@cache
def rejected(name: str, law: str, orientation: float | None, count: int = 2 * FEW) -> Array:
    """Points (count, components) of the same law."""
    return SETS[name].rejected(law, WIDTH, orientation or WIDTH, count, seed=2)


def assert_same_law(name: str, law: str, orientation: float | None, count: int) -> None:
    """Components, their lengths and random sums of them, each by the two-sample test of Kolmogorov and Smirnov."""
    ours = drawn(LAWS[law](zone_of(name, orientation)), count)
    others = rejected(name, law, orientation, count)
    directions = np.random.default_rng(3).standard_normal((3, ours.shape[1]))
    for one, other in zip(seen(ours, directions), seen(others, directions), strict=True):
        assert ks_2samp(one, other, method="asymp").pvalue > RARE


def seen(points: Array, directions: Array) -> list[Array]:
    """Each component, sums along directions, and two lengths: (trials,) each."""
    lengths = [np.abs(points).sum(axis=1), np.sqrt((points[:, -2:] ** 2).sum(axis=1))]
    return [*points.T, *(points @ directions.T).T, *lengths]


@pytest.mark.parametrize(("name", "law", "orientation"), CASES)
def test_draws_have_the_law_that_rejection_has(name: str, law: str, orientation: float | None) -> None:
    assert_same_law(name, law, orientation, 2 * FEW)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "law", "orientation"), CASES)
def test_a_million_draws_have_the_law_that_rejection_has(name: str, law: str, orientation: float | None) -> None:
    assert_same_law(name, law, orientation, MANY)


@pytest.mark.parametrize(("name", "law", "orientation"), CASES)
def test_mean_and_covariance_are_those_of_rejection(name: str, law: str, orientation: float | None) -> None:
    """Each entry within 5 standard errors, taken from the sample's own fourth moments."""
    draw = LAWS[law](zone_of(name, orientation))
    points = rejected(name, law, orientation)
    assert np.abs(points.mean(axis=0) - draw.mean_vector).max() < 5 * (draw.sigmas / math.sqrt(len(points))).max()
    products = points[:, :, None] * points[:, None, :]
    errors = products.std(axis=0) / math.sqrt(len(points))
    assert (np.abs(products.mean(axis=0) - draw.covariance) <= 5 * errors).all()
    assert draw.sigmas**2 == pytest.approx(np.diagonal(draw.covariance), rel=1e-12)
    assert draw.sigma == draw.sigmas[0]


@pytest.mark.parametrize(("name", "law", "orientation"), CASES)
def test_sobol_points_meet_the_covariance_far_nearer_than_chance(
    name: str, law: str, orientation: float | None
) -> None:
    """Closed maps of a fixed number of uniforms keep a net's evenness: 4 times nearer than a standard error of MC."""
    draw = LAWS[law](zone_of(name, orientation))
    uniforms = qmc.Sobol(draw.uniforms, seed=5).random(2**14).T
    points = np.stack(draw.deviations(*uniforms), axis=1)
    products = points[:, :, None] * points[:, None, :]
    errors = products.std(axis=0) / math.sqrt(len(points))
    assert (np.abs(products.mean(axis=0) - draw.covariance) < errors / 4 + 1e-15).all()


@pytest.mark.parametrize(("name", "law", "orientation"), CASES)
def test_all_that_is_drawn_lies_inside_even_from_the_ends_of_uniforms(
    name: str, law: str, orientation: float | None
) -> None:
    zone = zone_of(name, orientation)
    draw = LAWS[law](zone)
    ends = np.array([2.0**-53, 1e-9, 0.25, 0.5, 0.75, 1 - 1e-9, 1 - 2.0**-53])
    corners = np.stack(np.meshgrid(*[ends] * draw.uniforms), axis=-1).reshape(-1, draw.uniforms).T
    for points in (np.stack(draw.deviations(*corners), axis=1), drawn(draw, FEW)):
        shrunk = points / (1 + 1e-12)  # what rounds over the edge
        assert SETS[name].inside(shrunk, WIDTH, orientation or WIDTH).all()
        assert zone.inside(points).all()


@pytest.mark.parametrize(("name", "law", "orientation"), CASES)
def test_a_trial_has_its_bits_whatever_block_it_is_drawn_in(name: str, law: str, orientation: float | None) -> None:
    draw = LAWS[law](zone_of(name, orientation))
    uniforms = np.random.default_rng(6).random((draw.uniforms, 99))
    whole = np.stack(draw.deviations(*uniforms))
    widths = np.random.default_rng(7).uniform(WIDTH, 2 * WIDTH, 99)
    varied = np.stack(draw.deviations_in(widths, None, *uniforms))
    for size in (1, 7, 64):
        parts = [uniforms[:, first : first + size] for first in range(0, 99, size)]
        assert np.hstack([np.stack(draw.deviations(*own)) for own in parts]).tobytes() == whole.tobytes()
        blocks = [
            np.stack(draw.deviations_in(widths[first : first + size], None, *own))
            for first, own in zip(range(0, 99, size), parts, strict=True)
        ]
        assert np.hstack(blocks).tobytes() == varied.tobytes()


@pytest.mark.parametrize("name", ZONES)
@pytest.mark.parametrize("law", LAWS)
def test_a_draw_is_the_same_in_another_process(name: str, law: str) -> None:
    draw = LAWS[law](zone_of(name, None))
    other = pickle.loads(pickle.dumps(draw))
    assert other == draw
    assert drawn(other, 100).tobytes() == drawn(draw, 100).tobytes()


@pytest.mark.parametrize(("name", "law"), [(name, law) for name in REFINED for law in LAWS])
def test_zones_of_each_trial_s_own_widths_are_the_zones_of_these_widths(name: str, law: str) -> None:
    rng = np.random.default_rng(8)
    widths = rng.uniform(0.05, 0.3, 20)
    orientations = rng.uniform(0.001, 1.0, 20) * widths
    draw = LAWS[law](zone_of(name, 0.5 * WIDTH))
    uniforms = rng.random((draw.uniforms, 20))
    found = np.stack(draw.deviations_in(widths, orientations, *uniforms))
    for k, (width, orientation) in enumerate(zip(widths, orientations, strict=True)):
        alone = LAWS[law](ZONES[name](width, orientation)).deviations(*uniforms[:, k : k + 1])
        # tables are good to 1e-9 of the width
        assert found[:, k] == pytest.approx(np.concatenate(alone), abs=2e-9 * width)


@pytest.mark.parametrize(("name", "law", "orientation"), CASES)
def test_moments_and_ends_are_those_of_the_first_component(name: str, law: str, orientation: float | None) -> None:
    draw = LAWS[law](zone_of(name, orientation))
    own = draw.distribution
    assert (own.low, own.high) == pytest.approx((-WIDTH / 2, WIDTH / 2))
    assert (own.mean, own.sigma) == pytest.approx((0.0, draw.sigma))


NORMAL_IN_DISC = math.sqrt(1 - 4.5 / math.expm1(4.5))  # of a normal cut off at 3 sigma of its length
NORMAL_IN_WIDTH = 0.98657840  # of one cut off at 3 sigma
MIDDLES = {  # sigma of the middle in t / 6 by `normal`
    "axis": NORMAL_IN_DISC,
    "axis at a section": NORMAL_IN_DISC,
    "point in a disc": NORMAL_IN_DISC,
    "rectangle": NORMAL_IN_WIDTH,
    "round face": NORMAL_IN_WIDTH,
    "flat axis": NORMAL_IN_WIDTH,
    "axis along": NORMAL_IN_DISC,
    "flat axis round": NORMAL_IN_WIDTH,
    "point between planes": NORMAL_IN_WIDTH,
    "point in a sphere": math.sqrt(chi2.cdf(9, 5) / chi2.cdf(9, 3)),
}


@pytest.mark.parametrize("name", MIDDLES)
def test_by_the_law_normal_a_middle_has_the_sigma_of_a_point_whatever_refines_the_zone(name: str) -> None:
    """An axis and an axis at one section have the same middle, 0.974 t/6; a point in a ball has 0.983 of that."""
    for orientation in (None, 0.8 * WIDTH, 0.1 * WIDTH) if name in REFINED else (None,):
        draw = normal_in(zone_of(name, orientation))
        assert draw.middle_sigma == pytest.approx(MIDDLES[name] * WIDTH / 6, rel=1e-7)
        middles = drawn(draw, 4 * FEW) @ draw.zone.middle
        assert middles.std() == pytest.approx(draw.middle_sigma, rel=5 / math.sqrt(8 * FEW))
    assert MIDDLES["point in a sphere"] / NORMAL_IN_DISC == pytest.approx(0.983, abs=5e-4)


@pytest.mark.parametrize("orientation", [None, 0.8 * WIDTH, 0.3 * WIDTH])
def test_half_differences_of_a_normal_axis_have_the_variance_of_their_stated_law(orientation: float | None) -> None:
    """By adaptive quadrature over the middle's length m and the angle: 3 sigma = ratio, cut off where the disc ends."""
    ratio = 1.0 if orientation is None else orientation / WIDTH

    def square(angle: float, m: float) -> float:
        room = min(ratio, math.sqrt(max(1 - (m * math.sin(angle)) ** 2, 0.0)) - m * math.cos(angle))
        z = max(4.5 * (room / ratio) ** 2, 1e-30)
        length = ratio**2 / 4.5 * (1 - z / math.expm1(z))  # mean square of a Rayleigh length that is cut off
        return float(9 * m * math.exp(-4.5 * m * m) * length / (math.pi / 2))

    expected = dblquad(square, 0, 1, 0, math.pi / 2, epsabs=1e-8)[0] / -math.expm1(-4.5) / 2
    covariance = normal_in(zone_of("axis", orientation)).covariance
    half_difference = np.array([-0.5, 0.0, 0.5, 0.0])
    assert half_difference @ covariance @ half_difference == pytest.approx(expected * (WIDTH / 2) ** 2, rel=1e-6)


def test_a_process_tells_the_sigma_of_the_middle_of_both_ends() -> None:
    draw = process_in(catalogue.axis(WIDTH), Normal(0.0, 0.01))
    assert (draw.sigma, draw.middle_sigma) == pytest.approx((0.01, 0.01 / math.sqrt(2)))
    assert process_in(catalogue.rectangle(WIDTH), Normal(0.0, 0.01)).middle_sigma == pytest.approx(0.01)


@pytest.mark.parametrize("law", LAWS)
def test_an_unequal_profile_lies_about_its_own_middle(law: str) -> None:
    """0.1 wide, 0.08 of it outside the material: from -0.02 to +0.08, whatever the form takes of it."""
    plain, unequal = (LAWS[law](catalogue.rectangle(WIDTH, None, outward, 0.02)) for outward in (None, 0.08))
    assert drawn(unequal, 100) - drawn(plain, 100) == pytest.approx(np.tile([0.03, 0.0, 0.0], (100, 1)), abs=1e-15)
    assert unequal.mean_vector == pytest.approx([0.03, 0.0, 0.0])
    assert (unequal.distribution.low, unequal.distribution.high) == pytest.approx((-0.01, 0.07))
    assert unequal.zone.inside(drawn(unequal, 1000)).all()
    assert unequal.covariance == pytest.approx(plain.covariance)


@pytest.mark.parametrize("law", LAWS)
def test_form_takes_its_part_of_the_width_and_leaves_the_orientation(law: str) -> None:
    """t = 0.1, t_o = 0.06, f = 0.03 is t = 0.07, t_o = 0.06; with f = 0.05 the orientation limits nothing any more."""
    for form, left, orientation in ((0.03, 0.07, 0.06), (0.05, 0.05, None)):
        formed = LAWS[law](catalogue.axis(WIDTH, 0.06, form))
        plain = LAWS[law](catalogue.axis(left, orientation))
        assert drawn(formed, 100) == pytest.approx(drawn(plain, 100), abs=1e-9 * WIDTH)
        assert formed.covariance == pytest.approx(plain.covariance, rel=1e-9)
        wider = np.stack(formed.deviations_in(np.full(3, 0.12), None, *np.full((4, 3), 0.3)))
        grown = LAWS[law](catalogue.axis(0.12 - form, 0.06)).deviations(*np.full((4, 3), 0.3))
        assert wider == pytest.approx(np.stack(grown), abs=1e-9 * WIDTH)


def test_a_process_draws_what_it_is_and_the_zone_judges() -> None:
    """Normal of sigma t/6 for each coordinate of a disc: exp(-4.5) of them lie outside."""
    draw = process_in(catalogue.axis_section(WIDTH), Normal(0.0, WIDTH / 6))
    points = np.stack(draw.deviations(*np.random.default_rng(10).random((2, MANY))), axis=1)
    outside = 1 - draw.zone.inside(points).mean()
    share = math.exp(-4.5)
    assert outside == pytest.approx(share, abs=5 * math.sqrt(share / MANY))
    wide = draw.zone.inside(points, np.full(MANY, 2 * WIDTH)).mean()
    assert 1 - wide == pytest.approx(math.exp(-18), abs=5 * math.sqrt(math.exp(-18) / MANY))
    assert draw.covariance == pytest.approx(np.eye(2) * (WIDTH / 6) ** 2)
    assert draw.distribution == Normal(0.0, WIDTH / 6)


@pytest.mark.parametrize(
    ("zone", "expected"),
    [
        (catalogue.rectangle_orientation(WIDTH), lambda x, y: (0.0, x, y)),
        (catalogue.axis_orientation(WIDTH), lambda x, y: (-x, -y, x, y)),
        (catalogue.axis_section(WIDTH), lambda x, y: (x, y, x, y)),
        (catalogue.flat_axis(WIDTH, (3.0, 4.0)), lambda s, e: (0.6 * s, 0.8 * s, 0.6 * e, 0.8 * e)),
        (catalogue.axis_along(WIDTH, (3.0, 4.0), 0.05), lambda s, t: (0.6 * s - 0.8 * t, 0.8 * s + 0.6 * t, 0.0, 0.0)),
        (catalogue.flat_axis_round(WIDTH, (3.0, 4.0), 0.05), lambda s, e: (0.6 * s, 0.8 * s, 0.6 * e, 0.8 * e)),
        (catalogue.flat_axis_orientation(WIDTH, (3.0, 4.0)), lambda e: (-0.6 * e, -0.8 * e, 0.6 * e, 0.8 * e)),
        (catalogue.point_in_disc(WIDTH), lambda x, y: (x, y, 0.0)),
        (catalogue.point_between_planes(WIDTH, (0.0, 3.0, -4.0)), lambda s: (0.0, 0.6 * s, -0.8 * s)),
    ],
)
def test_what_is_drawn_moves_the_feature_as_the_zone_allows(zone: Zone, expected: Callable[..., object]) -> None:
    values = np.resize((0.7, -0.4, 0.0, 0.0), len(zone.components))
    assert zone.matrix @ values == pytest.approx(np.array(expected(*values[:2])))


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("zone", ZONES)
def test_the_ends_of_a_measure_that_cannot_be_read_beside_the_mean_are_not_known(zone: str, law: str) -> None:
    draw = LAWS[law](ZONES[zone](200.0))
    ends = draw.ends(lambda rows: np.full(len(rows), np.nan), turning=False)
    assert ends.shape == (2, len(draw.mean_vector))
    assert np.isnan(ends).all()
