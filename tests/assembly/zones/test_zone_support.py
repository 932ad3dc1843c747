"""Support of zones: against linear programmes over their half spaces, and over drawn points."""

import itertools
import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.zone_sets import REFINED, SETS, facets
from scipy.optimize import linprog

from tol3d.assembly.zones import Process, catalogue, normal_in, uniform_in
from tol3d.assembly.zones.zone import Zone
from tol3d.statistics.distributions import Distribution
from tol3d.statistics.distributions.normal import Normal
from tol3d.statistics.distributions.uniform import Uniform

Array = NDArray[np.float64]

WIDTH = 0.1
NANO = 1e-6  # mm; the programme's own tolerance is 1e-7 of its unit
SIDES = 720  # shrinks a polygon's largest radius by 1e-5
COUNT = 100_000


def zone_of(name: str, orientation: float) -> Zone:
    if name == "flat axis":
        return catalogue.flat_axis(WIDTH, (1.0, 0.0), orientation)
    if name in ("axis along", "flat axis round"):
        of_this = catalogue.axis_along if name == "axis along" else catalogue.flat_axis_round
        return of_this(WIDTH, (1.0, 0.0), orientation)
    made: dict[str, Callable[[float, float], Zone]] = {
        "rectangle": catalogue.rectangle,
        "round face": catalogue.round_face,
        "axis": catalogue.axis,
    }
    return made[name](WIDTH, orientation)


@pytest.mark.parametrize("name", REFINED)
@pytest.mark.parametrize("part", [1.0, 0.7, 0.2, 0.01])
def test_the_support_of_a_refined_zone_is_that_of_a_linear_programme(name: str, part: float) -> None:
    """The support of round limits lies between those of polygons around them and of these shrunk into them."""
    zone = zone_of(name, part * WIDTH)
    half_spaces, limits = facets(name, WIDTH, part * WIDTH, SIDES)
    width = half_spaces.shape[1]
    gradients = np.random.default_rng(1).standard_normal((12, width)) * 10 ** np.linspace(-1, 1, width)
    couples = [np.array([1.0, 0.5, -1.0, -0.5][:width]), np.eye(width)[0], np.eye(width)[-1]]
    for gradient in [*gradients, *couples]:
        program = linprog(-gradient, A_ub=half_spaces, b_ub=limits / NANO, bounds=(None, None))
        assert program.status == 0
        around = -program.fun * NANO
        found = zone.support(gradient)
        assert around * math.cos(math.pi / SIDES) - 1e-12 <= found <= around + 1e-12
        point = zone.furthest(gradient)
        assert gradient @ point == pytest.approx(found)
        assert SETS[name].inside(point[None] / (1 + 1e-12), WIDTH, part * WIDTH).all()


@pytest.mark.parametrize(
    ("zone", "gradient", "expected"),
    [
        # t/2 |c_w|, or (t - t_o)/2 |c_w| + t_o/2 max(|c_x|, |c_y|)
        (catalogue.rectangle(0.1, 0.04), (3.0, -1.0, 2.0), 0.15),
        (catalogue.rectangle(0.1, 0.04), (3.0, -1.0, 5.0), 0.03 * 3 + 0.02 * 5),
        (catalogue.round_face(0.1, 0.04), (3.0, -3.0, 4.0), 0.03 * 3 + 0.02 * 5),
        (catalogue.rectangle_orientation(0.1), (1.0, -7.0), 0.35),
        (catalogue.round_face_orientation(0.1), (6.0, -8.0), 0.5),
        # t/2 (|c_1| + |c_2|)
        (catalogue.axis(0.1), (3.0, 4.0, -5.0, 12.0), 0.05 * (5 + 13)),
        (catalogue.axis_orientation(0.1), (3.0, -4.0), 0.25),
        (catalogue.axis_section(0.1), (3.0, -4.0), 0.25),
        (catalogue.flat_axis(0.1, (1.0, 0.0)), (3.0, -4.0), 0.35),
        (catalogue.flat_axis(0.1, (1.0, 0.0), 0.04), (-3.0, 4.0), 0.03 + 0.02 * 7),
        (catalogue.point_in_sphere(0.1), (3.0, -4.0, 12.0), 0.65),
        (catalogue.point_in_disc(0.1), (3.0, -4.0), 0.25),
        (catalogue.point_between_planes(0.1), (-3.0,), 0.15),
        (catalogue.pattern_motion(0.1, 2, 1), (3.0, -4.0, 4.5), 0.25),  # all shift, or all turn
        (catalogue.pattern_motion(0.1, 1, 3), (5.0, 2.0, 3.0, -6.0), 0.35),
        (catalogue.rectangle(0.1, None, 0.08), (3.0, 0.0, 0.0), 0.24),
        (catalogue.rectangle(0.1, None, 0.08), (-3.0, 0.0, 0.0), 0.06),
        (catalogue.rectangle(0.1, 0.04, None, 0.02), (3.0, -1.0, 5.0), 0.02 * 3 + 0.02 * 5),
    ],
)
def test_supports_have_the_stated_closed_forms(zone: Zone, gradient: tuple[float, ...], expected: float) -> None:
    assert zone.support(np.array(gradient)) == pytest.approx(expected, rel=1e-12)
    for law in (uniform_in, normal_in):
        assert law(zone).support(np.array(gradient)) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("name", REFINED)
def test_what_is_drawn_stays_within_the_support_and_comes_near_it(name: str) -> None:
    """A fiftieth of the support's range or less is left of a hundred thousand draws: the sets have four dimensions."""
    draw = uniform_in(zone_of(name, 0.5 * WIDTH))
    rng = np.random.default_rng(2)
    points = np.stack(draw.deviations(*rng.random((draw.uniforms, COUNT))), axis=1)
    for gradient in rng.standard_normal((10, points.shape[1])):
        most, reach = float((points @ gradient).max()), draw.support(gradient)
        assert 0.9 * reach < most <= reach


@pytest.mark.parametrize("name", REFINED)
def test_ends_are_where_a_measure_is_least_and_largest(name: str) -> None:
    draw = normal_in(zone_of(name, 0.5 * WIDTH))
    gradient = np.random.default_rng(3).standard_normal(len(draw.components))
    high, low = draw.ends(lambda rows: 7.0 + rows @ gradient, turning=False)
    assert high @ gradient == pytest.approx(draw.support(gradient))
    assert low @ gradient == pytest.approx(-draw.support(-gradient))


def test_a_zone_of_no_width_has_its_middle_alone() -> None:
    draw = uniform_in(catalogue.axis(0.0))
    assert np.abs(np.stack(draw.deviations(*np.full((4, 5), 0.3)))).max() == 0.0
    assert draw.support(np.ones(4)) == 0.0
    assert draw.sigma == 0.0
    assert draw.ends(lambda rows: rows.sum(axis=1), turning=False) == pytest.approx(np.zeros((2, 4)))
    assert (draw.distribution.low, draw.distribution.sigma, draw.distribution.high) == (0.0, 0.0, 0.0)
    widened = np.stack(draw.deviations_in(np.array([0.0, 0.1]), None, *np.full((4, 2), 0.3)))
    assert (np.abs(widened).max(axis=0) > 0.0).tolist() == [False, True]


def test_the_support_of_a_process_is_the_worst_corner_of_its_laws() -> None:
    laws: tuple[Distribution, ...] = (Uniform(-0.1, 0.3), Normal(0.01, 0.02), Uniform(0.1, 0.2))
    draw = Process(catalogue.rectangle(WIDTH), laws)
    boxes = np.array(list(itertools.product((-0.1, 0.3), (-0.05, 0.07), (0.1, 0.2))))
    for gradient in np.random.default_rng(4).standard_normal((10, 3)):
        assert draw.support(gradient) == pytest.approx((boxes @ gradient).max(), abs=1e-6)  # 3 sigma at 99.865 %


def test_the_ends_of_a_process_lie_in_the_steepest_direction_as_far_as_each_law_reaches() -> None:
    """Three normals act as one of sigma = the root of the squares' sum, whose ends lie 3 of it away."""
    draw = Process(catalogue.rectangle(WIDTH), (Normal(0.0, 0.01), Normal(0.1, 0.02), Normal(0.0, 0.03)))
    gradient = np.array([3.0, -2.0, 1.0])
    high, low = draw.ends(lambda rows: rows @ gradient, turning=False) @ gradient
    sigma = math.sqrt(0.03**2 + 0.04**2 + 0.03**2)
    assert (high, low) == pytest.approx((-0.2 + 3 * sigma, -0.2 - 3 * sigma), abs=1e-5)
