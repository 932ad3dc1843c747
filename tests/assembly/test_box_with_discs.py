"""Problem 3: two discs in a box, one on the floor and a wall, the other on it and on the other wall."""

import math
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from assembly_trials import assembled, normal
from numpy.polynomial.hermite_e import hermegauss
from numpy.typing import NDArray

from tol3d.assembly.model.statuses import NO_CONTACT, OK
from tol3d.assembly.placing import method as placing
from tol3d.assembly.system import AssemblySystem
from tol3d.assembly.torsors import method as torsors
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]
Codes = NDArray[np.int8]

NOMINAL = np.array([80.0, 50.0, 20.0, 20.0])  # H, W, r1, r2 [mm]
LIMITS = np.array([0.5, 0.2, 0.05, 0.05])
COLUMNS = np.array([1.0, 1.0, 2.0, 2.0])  # of the scene: diameters


def wall(at: tuple[float, float], out: tuple[float, float]) -> str:
    x, y = at
    return f"{{kind: plane, at: [{x} mm, {y} mm, 0 mm], normal: [{out[0]}, {out[1]}, 0], extent: [20 mm, 10 mm]}}"


def text(pressed: str) -> str:
    disc = "{kind: cylinder, at: [0 mm, 0 mm, 0 mm], axis: [0, 0, 1], length: 8 mm, diameter: 40 mm}"
    sigmas = [normal(float(own)) for own in LIMITS * COLUMNS / 3.0]
    return f"""
scene: two discs in a box
parts:
  box:
    kind: solid
    features:
      floor: {wall((25, 0), (0, 1))}
      lid: {wall((25, 80), (0, -1))}
      left: {wall((0, 20), (1, 0))}
      right: {wall((50, 60), (-1, 0))}
  lower: {{kind: solid, placed: {{at: [20 mm, 20 mm, 0 mm]}}, features: {{rim: {disc}}}}}
  upper: {{kind: solid, placed: {{at: [31 mm, 57 mm, 0 mm]}}, features: {{rim: {disc}}}}}
tolerances:
  height: {{kind: plus_minus, of: box.lid, along: [0, 1, 0], distribution: {sigmas[0]}}}
  width: {{kind: plus_minus, of: box.right, along: [1, 0, 0], distribution: {sigmas[1]}}}
  lower disc: {{kind: size, of: lower.rim, distribution: {sigmas[2]}}}
  upper disc: {{kind: size, of: upper.rim, distribution: {sigmas[3]}}}
moves:
  table: {{kind: fix, part: box}}
  first:
    kind: touch
    part: lower
    {pressed}
    contacts: [{{from: lower.rim, to: box.floor}}, {{from: lower.rim, to: box.left}}]
  second:
    kind: touch
    part: upper
    {pressed.replace("-0.1", "0")}
    contacts: [{{from: upper.rim, to: lower.rim}}, {{from: upper.rim, to: box.right}}]
measures:
  gap: {{kind: surface_gap, from: upper.rim, to: box.lid}}
  lean: {{kind: contact_angle, from: lower.rim, to: upper.rim, along: [1, 0, 0]}}
  play: {{kind: surface_gap, from: upper.rim, to: box.left}}
"""


def gap(height: Array, width: Array, first: Array, second: Array) -> Array:
    total = first + second
    return np.asarray(height - total - np.sqrt(total**2 - (width - total) ** 2))


@pytest.fixture(scope="module")
def system(tmp_path_factory: pytest.TempPathFactory) -> AssemblySystem:
    return assembled(text("pressed: [-0.1, -1, 0]"), tmp_path_factory.mktemp("box")).system


def built(system: AssemblySystem, deviations: Array, name: str = "gap") -> tuple[Array, Codes]:
    return placing.values(system.assembly, deviations * COLUMNS, [name])[name]


def test_single_builds(system: AssemblySystem) -> None:
    deviations = np.vstack([np.zeros(4), np.random.default_rng(2).uniform(-4, 4, size=(200, 4)) * LIMITS])
    found, codes = built(system, deviations)
    assert (codes == OK).all()
    assert found[0] == pytest.approx(1.2701665, abs=1e-7)
    height, width, first, second = (NOMINAL + deviations).T
    np.testing.assert_allclose(found, gap(height, width, first, second), rtol=0.0, atol=1e-9)
    cosine = (width - first - second) / (first + second)
    np.testing.assert_allclose(built(system, deviations, "lean")[0], np.arccos(cosine), rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(built(system, deviations, "play")[0], width - 2 * second, rtol=0.0, atol=1e-9)


def test_rates_and_linear_limits(system: AssemblySystem) -> None:
    total, width = NOMINAL[2] + NOMINAL[3], NOMINAL[1]
    root = math.sqrt(total**2 - (width - total) ** 2)
    by_total = -1.0 - width / root  # root^2 = 2 S W - W^2
    rates = np.array([1.0, (width - total) / root, by_total, by_total])
    assert rates == pytest.approx([1.0, 0.2581989, -2.2909944, -2.2909944], abs=1e-7)
    slopes = torsors.slopes(system.assembly, "gap", np.zeros(4), LIMITS)
    assert slopes.coefficients * COLUMNS == pytest.approx(rates, abs=1e-9)
    assert np.abs(rates) @ LIMITS == pytest.approx(0.780739, abs=1e-6)
    form = system.closed_form(system.measures[0])
    assert form is not None
    assert 3.0 * form.sigma == pytest.approx(math.sqrt(((rates * LIMITS) ** 2).sum()), abs=1e-9)
    assert 3.0 * form.sigma == pytest.approx(0.528119, abs=1e-6)


def test_worst_cases(system: AssemblySystem) -> None:
    corners = np.array(list(product((-1.0, 1.0), repeat=4))) * LIMITS
    found, codes = built(system, corners)
    assert (codes == OK).all()
    expected = gap(*(NOMINAL + corners).T)
    assert (found.min(), found.max()) == pytest.approx((expected.min(), expected.max()), abs=1e-9)
    assert (found.min(), found.max()) == pytest.approx((0.490875, 2.052367), abs=1e-6)


def quadrature() -> tuple[Array, Array]:
    nodes, weights = hermegauss(8)
    places = np.array(list(product(nodes, repeat=4))) * LIMITS / 3.0
    return places, np.array([math.prod(own) for own in product(weights / weights.sum(), repeat=4)])


def test_moments(system: AssemblySystem, tmp_path: Path) -> None:
    """Mean and sigma by quadrature over builds; the mean of what is not linear by trials, of which it is far from 0."""
    deviations, weights = quadrature()
    exact = gap(*(NOMINAL + deviations).T)
    mean = float(weights @ exact)
    sigma = float(weights @ (exact - mean) ** 2) ** 0.5
    assert (mean, sigma) == pytest.approx((1.270240, 0.176040), abs=1e-6)
    found, _ = built(system, deviations)
    own = float(weights @ found)
    assert (own, float(weights @ (found - own) ** 2) ** 0.5) == pytest.approx((mean, sigma), abs=1e-9)
    count = 20_000
    trials = drawn(assembled(text(""), tmp_path).simulation, 0, count).deviations
    values, codes = placing.values(system.assembly, trials, ["gap"])["gap"]
    assert (codes == OK).all()
    bent = values - torsors.values(system.assembly, trials, ["gap"])["gap"]
    error = bent.std() / math.sqrt(count)
    assert bent.mean() == pytest.approx(mean - gap(*NOMINAL), abs=4 * error)
    assert bent.mean() > 10 * error  # the linear mean is that of the nominal box
    assert values.std() == pytest.approx(sigma, rel=4 / math.sqrt(2 * count))


def test_a_disc_that_no_longer_leans_has_no_contact(system: AssemblySystem, tmp_path: Path) -> None:
    """S >= W: the upper disc would have to be pulled to the right wall; 2 S < W: it falls through beside the lower."""
    widths = np.array([-9.9, -9.999, -10.001, -10.5, -20.0, 29.9, 29.999, 30.001, 40.0])
    deviations = np.zeros((len(widths), 4))
    deviations[:, 1] = widths
    leans, reaches = 50.0 + widths > 40.0, 50.0 + widths < 80.0
    found, codes = built(system, deviations)
    assert codes.tolist() == np.where(leans & reaches, OK, NO_CONTACT).tolist()
    assert np.isnan(found).tolist() == (codes != OK).tolist()
    exact = gap(*(NOMINAL + deviations[leans & reaches]).T)
    np.testing.assert_allclose(found[leans & reaches], exact, rtol=0.0, atol=1e-9)
    # where nothing says what presses the disc, it is still between both
    free = assembled(text(""), tmp_path).system
    found, codes = built(free, deviations)
    assert codes.tolist() == np.where(reaches, OK, NO_CONTACT).tolist()
    np.testing.assert_allclose(found[reaches], gap(*(NOMINAL + deviations[reaches]).T), rtol=0.0, atol=1e-9)
