"""Problem 2: a roller between the flat of a hub and a ring; its contact angle is acos((a + c) / (e - c))."""

import math
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from numpy.polynomial.hermite_e import hermegauss
from numpy.typing import NDArray
from places import SCENES
from scipy.stats import norm

from tol3d.assembly.model.statuses import NO_CONTACT, OK
from tol3d.assembly.placing import method as placing
from tol3d.assembly.system import AssemblySystem
from tol3d.assembly.torsors import method as torsors
from tol3d.errors import SceneError
from tol3d.simulate import Overrides, load, run_scene, simulation_of
from tol3d.study.trials.draws import drawn

Array = NDArray[np.float64]
Codes = NDArray[np.int8]

SCENE = SCENES / "clutch.yaml"
NOMINAL = np.array([27.645, 11.43, 50.8])  # a, c, e: half height of the hub, radii of roller and ring [mm]
LIMITS = np.array([0.05, 0.01, 0.0125])
SIGMAS = LIMITS / 3.0
COLUMNS = np.array([1.0, 2.0, 2.0])  # of the scene: diameters of roller and ring
ANGLE = "contact angle"


def angle(a: Array, c: Array, e: Array) -> Array:
    """[deg]"""
    return np.asarray(np.degrees(np.arccos((a + c) / (e - c))))


def system() -> AssemblySystem:
    made = simulation_of(load(SCENE), Overrides()).system
    assert isinstance(made, AssemblySystem)
    return made


def built(deviations: Array) -> tuple[Array, Codes]:
    """Contact angles [deg] and codes for deviations of a, c, e (trials, 3) [mm]."""
    values, codes = placing.values(system().assembly, deviations * COLUMNS, [ANGLE])[ANGLE]
    return np.degrees(values), codes


def quadrature() -> tuple[Array, Array]:
    """Deviations of a, c, e (nodes, 3) [mm] and their weights."""
    nodes, weights = hermegauss(12)
    places = np.array(list(product(nodes, repeat=3)))
    return places * SIGMAS, np.array([math.prod(own) for own in product(weights / weights.sum(), repeat=3)])


def moments(values: Array, weights: Array) -> tuple[float, float, float, float]:
    """Mean, sigma, skewness, kurtosis."""
    mean = float(weights @ values)
    central = [float(weights @ (values - mean) ** k) for k in (2, 3, 4)]
    return mean, central[0] ** 0.5, central[1] / central[0] ** 1.5, central[2] / central[0] ** 2


def test_single_builds() -> None:
    rng = np.random.default_rng(1)
    deviations = np.vstack([np.zeros(3), rng.uniform(-4.0, 4.0, size=(200, 3)) * LIMITS])
    found, codes = built(deviations)
    assert (codes == OK).all()
    assert found[0] == pytest.approx(7.0183898, abs=1e-7)
    np.testing.assert_allclose(found, angle(*(NOMINAL + deviations).T), rtol=0.0, atol=1e-9)


def test_rates_shares_and_linear_limits() -> None:
    a, c, e = NOMINAL
    cos = (a + c) / (e - c)
    by_cos = -math.degrees(1.0) / math.sqrt(1.0 - cos**2)
    rates = by_cos * np.array([1.0 / (e - c), (1.0 + cos) / (e - c), -cos / (e - c)])
    assert rates == pytest.approx([-11.910473, -23.731700, 11.821227], abs=1e-6)
    made = system()
    slopes = torsors.slopes(made.assembly, ANGLE, np.zeros(3), SIGMAS * COLUMNS)
    assert np.degrees(slopes.coefficients) * COLUMNS == pytest.approx(rates, abs=1e-9)
    form = made.closed_form(made.measures[0])
    assert form is not None
    variances = (rates * SIGMAS) ** 2
    assert math.degrees(form.sigma) == pytest.approx(variances.sum() ** 0.5, abs=1e-9)
    assert math.degrees(form.sigma) == pytest.approx(0.2192924, abs=1e-7)
    shares = [100.0 * own.variance / form.sigma**2 for own in form.shares]
    assert shares == pytest.approx(100.0 * variances / variances.sum(), abs=1e-7)
    assert shares == pytest.approx([81.94, 13.01, 5.04], abs=0.006)
    assert np.abs(rates) @ LIMITS == pytest.approx(0.980606, abs=1e-6)


def test_worst_cases() -> None:
    corners = np.array(list(product((-1.0, 1.0), repeat=3))) * LIMITS
    found, codes = built(corners)
    assert (codes == OK).all()
    expected = angle(*(NOMINAL + corners).T)
    assert (found.min(), found.max()) == pytest.approx((expected.min(), expected.max()), abs=1e-9)
    assert (found.min(), found.max()) == pytest.approx((5.957365, 7.938469), abs=1e-6)


def test_moments_by_quadrature_over_builds() -> None:
    deviations, weights = quadrature()
    found, codes = built(deviations)
    assert (codes == OK).all()
    expected = moments(angle(*(NOMINAL + deviations).T), weights)
    assert expected == pytest.approx((7.014956, 0.219670, -0.09439, 3.02390), abs=6e-6)
    assert moments(found, weights) == pytest.approx(expected, abs=1e-8)


def share_below(limit: float) -> float:
    """Fraction of contact angles below a limit [deg]: the hub's height alone is normal for given radii."""
    nodes, weights = hermegauss(40)
    share, cos = 0.0, math.cos(math.radians(limit))
    for (x, u), (y, v) in product(zip(nodes, weights / weights.sum(), strict=True), repeat=2):
        c, e = NOMINAL[1] + SIGMAS[1] * x, NOMINAL[2] + SIGMAS[2] * y
        share += u * v * norm.sf(((e - c) * cos - c - NOMINAL[0]) / SIGMAS[0])
    return share


@pytest.mark.slow
def test_a_million_trials_have_the_exact_moments_and_shares_and_not_the_linear_ones() -> None:
    simulation, count = simulation_of(load(SCENE), Overrides()), 1_000_000
    made = system().assembly
    pieces = []
    for first in range(0, count, 100_000):
        values, codes = placing.values(made, drawn(simulation, first, 100_000).deviations, [ANGLE])[ANGLE]
        assert (codes == OK).all()
        pieces.append(np.degrees(values))
    found = np.concatenate(pieces)
    deviations, weights = quadrature()
    mean, sigma, skewness, kurtosis = moments(angle(*(NOMINAL + deviations).T), weights)
    own = moments(found, np.full(count, 1.0 / count))
    assert own[0] == pytest.approx(mean, abs=4 * sigma / math.sqrt(count))
    assert abs(7.0183898 - own[0]) > 10 * sigma / math.sqrt(count)  # the linear mean is not it
    assert own[1] == pytest.approx(sigma, abs=4 * sigma * math.sqrt((kurtosis - 1) / 4 / count))
    assert own[2] == pytest.approx(skewness, abs=4 * math.sqrt(6.5 / count))
    assert own[3] == pytest.approx(kurtosis, abs=4 * math.sqrt(26 / count))
    below, above = share_below(6.4184), 1.0 - share_below(7.6184)
    assert 1e6 * below == pytest.approx(4406, abs=1.0)
    assert 1e6 * above == pytest.approx(2166, abs=1.0)
    for share, seen in ((below, found < 6.4184), (above, found > 7.6184)):
        assert seen.mean() == pytest.approx(share, abs=4 * math.sqrt(share * (1 - share) / count))
        assert abs(seen.mean() - 3109e-6) > 10 * math.sqrt(share * (1 - share) / count)  # by the linear one


def test_a_roller_that_is_too_large_for_its_room_has_no_contact() -> None:
    """Contact is lost where a + c = e - c, and no sooner: 1e-6 mm before it the angle is that of the formula."""
    a, c, e = NOMINAL
    limit = e - 2 * c - a
    deviations = np.array([[limit - 1e-6, 0, 0], [limit + 1e-6, 0, 0], [0, 0.5, 0], [0, 0, -0.5], [0.2, 0.04, 0]])
    found, codes = built(deviations)
    assert codes.tolist() == [OK, NO_CONTACT, NO_CONTACT, NO_CONTACT, OK]
    assert np.isnan(found).tolist() == [False, True, True, True, False]
    np.testing.assert_allclose(found[[0, 4]], angle(*(NOMINAL + deviations[[0, 4]]).T), rtol=1e-8)


def test_the_roller_stays_on_its_side_however_far_it_goes() -> None:
    """Angles from 0.1 to 40 deg; that of the mirrored contact would be the same, its place would not."""
    a, c, e = NOMINAL
    limit = e - 2 * c - a
    deviations = np.zeros((500, 3))
    deviations[:, 0] = np.linspace(-9.0, limit - 1e-4, 500)
    angles, codes = built(deviations)
    assert (codes == OK).all()
    assert angles.min() < 0.2
    assert angles.max() > 39.0
    found = placing.placed(system().assembly, deviations * COLUMNS)["roller"][:, 0, 3]
    expected = np.sqrt((e - c) ** 2 - (a + deviations[:, 0] + c) ** 2)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9)


def test_wide_tolerances_count_what_has_no_contact_and_leave_it_out_of_the_mean(tmp_path: Path) -> None:
    path, count = tmp_path / "wide.yaml", 4000
    text = SCENE.read_text("utf-8").replace("lower: -50 um, upper: 50 um", "lower: -500 um, upper: 500 um")
    path.write_text(text[: text.index("published:")], "utf-8")
    deviations = drawn(simulation_of(load(path), Overrides()), 0, count).deviations / COLUMNS
    a, c, e = (NOMINAL + deviations).T
    touches = a + c <= e - c
    assert 100 < count - touches.sum() < 300  # P(N > 1.77 sigma) = 3.9 %
    run = run_scene(path, overrides=Overrides(trials=count), out=tmp_path / "run")
    own = run.summary["measures"][ANGLE]
    assert run.summary["status"] == {"ok": int(touches.sum()), "no contact": int((~touches).sum())} | {
        name: 0 for name in run.summary["status"] if name not in ("ok", "no contact")
    }
    assert own["geometric"]["mean"] == pytest.approx(60.0 * angle(a[touches], c[touches], e[touches]).mean(), abs=1e-6)


def test_a_roller_that_is_pressed_out_of_the_wedge_has_no_contact(tmp_path: Path) -> None:
    for direction, expected in (("[1, 0, 0]", OK), ("[1, -20, 0]", OK), ("[-1, 0, 0]", NO_CONTACT)):
        path = tmp_path / "pressed.yaml"
        path.write_text(SCENE.read_text("utf-8").replace("pressed: [1, 0, 0]", f"pressed: {direction}"), "utf-8")
        if expected == OK:
            assert simulation_of(load(path), Overrides())
        else:
            with pytest.raises(SceneError, match=r"moves\.wedge: roller has no contact even without deviations"):
                simulation_of(load(path), Overrides())
