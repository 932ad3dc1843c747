"""Distributions against scipy.stats, closed forms and numpy; the refusals of what makes no sense."""

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from pydantic import TypeAdapter, ValidationError
from scipy import integrate, stats

from tol3d.errors import SceneError
from tol3d.files import read_file
from tol3d.statistics.distributions import (
    Constant,
    Distribution,
    DistributionSpec,
    Empirical,
    Normal,
    Rayleigh,
    StatedDistribution,
    Triangular,
    TruncatedNormal,
    Uniform,
)
from tol3d.statistics.distributions.empirical import Draws

UNION = TypeAdapter(StatedDistribution)
SAMPLE = np.sort(np.random.default_rng(7).normal(0.01, 0.003, 41))

LAWS: dict[str, Distribution] = {
    "normal": Normal(-0.0245, 0.0055 / 3),
    "truncated_normal": TruncatedNormal(0.01, 0.004, 0.002, 0.015),
    "truncated_normal_tail": TruncatedNormal(0.0, 1.0, 2.5, 4.0),
    "uniform": Uniform(-0.02, 0.05),
    "triangular": Triangular(-0.02, 0.01, 0.05),
    "triangular_mode_at_lower": Triangular(-0.02, -0.02, 0.05),
    "triangular_mode_at_upper": Triangular(-0.02, 0.05, 0.05),
    "rayleigh": Rayleigh(0.0045),
    "empirical": Empirical(SAMPLE),
    "empirical_lengths": Empirical(np.abs(SAMPLE - 0.01)),
    "empirical_as_measured": Empirical(SAMPLE, "as_measured"),
    "constant": Constant(0.003),
}
SCIPY_LAWS = {
    "normal": stats.norm(-0.0245, 0.0055 / 3),
    "truncated_normal": stats.truncnorm(-2.0, 1.25, 0.01, 0.004),
    "truncated_normal_tail": stats.truncnorm(2.5, 4.0),
    "uniform": stats.uniform(-0.02, 0.07),
    "triangular": stats.triang(3 / 7, -0.02, 0.07),
    "triangular_mode_at_lower": stats.triang(0.0, -0.02, 0.07),
    "triangular_mode_at_upper": stats.triang(1.0, -0.02, 0.07),
    "rayleigh": stats.rayleigh(scale=0.0045),
}
VARYING = [name for name in LAWS if name not in ("constant", "empirical_as_measured")]
U = np.concatenate([[1e-9, 1e-4], np.linspace(0.001, 0.999, 199), [1 - 1e-4, 1 - 1e-9]])


def spec_of(**fields: object) -> DistributionSpec:
    spec: DistributionSpec = UNION.validate_python(fields)
    return spec


def law_of(**fields: object) -> Distribution:
    return spec_of(**fields).resolve({})


def refusal(**fields: object) -> dict[str, str]:
    with pytest.raises(ValidationError) as caught:
        spec_of(**fields)
    (error,) = caught.value.errors()
    assert error["type"] == "value_refused"
    assert error["msg"] == "expected {expected}, got {got}".format(**error["ctx"])
    return error["ctx"]


# the laws -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SCIPY_LAWS)
def test_law_equals_scipy_stats(name: str) -> None:
    law, oracle = LAWS[name], SCIPY_LAWS[name]
    # at 1 - 1e-9 a double holds the tail to 1e-7 of itself, and the oracle may round it otherwise
    np.testing.assert_allclose(law.ppf(U), oracle.ppf(U), rtol=1e-7, atol=1e-12)
    x = np.linspace(law.low - law.sigma, law.high + law.sigma, 101)
    np.testing.assert_allclose(law.cdf(x), oracle.cdf(x), rtol=1e-9, atol=1e-12)
    assert law.mean == pytest.approx(oracle.mean(), rel=1e-10)
    assert law.variance == pytest.approx(oracle.var(), rel=1e-9)
    assert law.sigma == pytest.approx(oracle.std(), rel=1e-9)


@pytest.mark.parametrize("name", VARYING)
def test_cdf_inverts_ppf(name: str) -> None:
    # cancellation in the truncated normal's tail leaves ~1e-16 / kept (6e-3)
    np.testing.assert_allclose(LAWS[name].cdf(LAWS[name].ppf(U)), U, rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", LAWS)
@given(u=st.lists(st.floats(2.0**-54, 1 - 2.0**-53), min_size=1, max_size=40), start=st.integers(0, 39))
def test_bits_of_a_draw_depend_on_its_own_uniform_only(name: str, u: list[float], start: int) -> None:
    whole = LAWS[name].ppf(np.array(u))
    assert np.all(np.isfinite(whole))
    np.testing.assert_array_equal(LAWS[name].ppf(np.array(u[start:])), whole[start:])
    np.testing.assert_array_equal(LAWS[name].ppf(np.array(u)[::2]), whole[::2])
    np.testing.assert_array_equal(np.concatenate([LAWS[name].ppf(np.array([one])) for one in u]), whole)


@pytest.mark.parametrize("name", LAWS)
def test_bits_of_long_arrays_equal_those_of_their_pieces(name: str) -> None:
    random = np.random.default_rng(3)
    u = random.uniform(size=20_000)
    cuts = np.sort(random.integers(0, len(u), 40))
    pieces = np.concatenate([LAWS[name].ppf(piece) for piece in np.split(u, cuts)])
    np.testing.assert_array_equal(pieces, LAWS[name].ppf(u))


@pytest.mark.parametrize("name", LAWS)
@given(u=st.lists(st.floats(2.0**-54, 1 - 2.0**-53), min_size=2, max_size=20).map(sorted))
def test_ppf_never_falls(name: str, u: list[float]) -> None:
    # a rounding step of the largest value is no fall
    assert np.all(np.diff(LAWS[name].ppf(np.array(u))) >= -1e-15)


@given(mean=st.floats(-1, 1), sigma=st.floats(0.01, 10), lower=st.floats(-3, 3), width=st.floats(0.01, 6))
def test_truncated_moments_equal_their_integrals(mean: float, sigma: float, lower: float, width: float) -> None:
    law = TruncatedNormal(mean, sigma, mean + lower * sigma, mean + (lower + width) * sigma)
    assume(law.kept >= 1e-3)  # less is refused in a scene
    density = stats.norm(mean, sigma).pdf
    bounds = (law.lower, law.upper)
    whole = integrate.quad(density, *bounds, epsabs=0)[0]
    expected = integrate.quad(lambda x: (x - mean) * density(x), *bounds, epsabs=1e-14 * sigma)[0] / whole + mean
    variance = integrate.quad(lambda x: (x - expected) ** 2 * density(x), *bounds, epsabs=0)[0] / whole
    assert law.mean == pytest.approx(expected, abs=1e-12 * sigma / law.kept)
    # cancellation: a few rounding errors over `kept`, against a variance of width^2/12
    assert law.variance == pytest.approx(variance, rel=1e-9, abs=4e-15 * sigma**2 / law.kept)


@pytest.mark.parametrize(("lower", "upper"), [(-1e8, 1e8), (-0.001, 1e8)])
def test_far_limits_leave_a_normal_as_it_is(lower: float, upper: float) -> None:
    law = TruncatedNormal(0.0, 1e-4, lower, upper)
    assert law.mean == pytest.approx(0.0, abs=1e-18)
    assert law.variance == pytest.approx(1e-8, rel=1e-14)
    np.testing.assert_allclose(law.ppf(U[1:-1]), stats.norm(0, 1e-4).ppf(U[1:-1]), rtol=1e-9, atol=1e-18)


def test_truncated_draws_stay_between_the_limits() -> None:
    law = TruncatedNormal(0.0, 1.0, -0.3, 0.7)
    draws = law.ppf(np.array([2.0**-54, 0.5, 1 - 2.0**-53]))
    assert draws[0] == pytest.approx(-0.3, abs=1e-15)
    assert draws[2] == pytest.approx(0.7, abs=1e-15)
    assert draws.min() >= -0.3
    assert draws.max() <= 0.7


def test_rayleigh_length_in_a_random_direction_is_two_independent_normals() -> None:
    n = 200_000
    random = np.random.default_rng(11)
    length, angle = Rayleigh(2.0).ppf(random.uniform(size=n)), random.uniform(0, 2 * math.pi, n)
    x, y = length * np.cos(angle), length * np.sin(angle)
    # the Kolmogorov distance exceeds 1.95 / sqrt(n) with p = 0.001; the moments stay within 4 standard errors
    assert stats.kstest(x, stats.norm(0, 2).cdf).statistic < 1.95 / math.sqrt(n)
    assert abs(np.mean(x * y)) < 4 * 4.0 / math.sqrt(n)
    assert abs(np.mean((x**2 - 4) * (y**2 - 4))) < 4 * 32.0 / math.sqrt(n)


@given(st.lists(st.floats(-1e3, 1e3).map(lambda x: round(x, 6)), min_size=3, max_size=30).map(sorted))
def test_a_smoothed_sample_keeps_its_mean_and_its_variance_with_n_less_1(values: list[float]) -> None:
    law = Empirical(np.array(values))
    size = max(abs(values[0]), abs(values[-1]))
    assert law.mean == pytest.approx(np.mean(values), abs=1e-12 * size)
    assert law.variance == pytest.approx(np.var(values, ddof=1), rel=1e-9, abs=1e-24 * size**2)
    low, high = law.extremes
    assert low >= 0.0 or values[0] < 0.0
    assert high <= 0.0 or values[-1] > 0.0


@given(st.lists(st.floats(-1e3, 1e3), min_size=2, max_size=30).map(sorted))
def test_values_as_measured_are_drawn_as_often_as_the_others(values: list[float]) -> None:
    law = Empirical(np.array(values), "as_measured")
    u = (np.arange(7 * len(values)) + 0.5) / (7 * len(values))
    np.testing.assert_array_equal(law.ppf(u), np.repeat(values, 7))
    size = max(abs(values[0]), abs(values[-1]))
    assert law.mean == pytest.approx(np.mean(values), abs=1e-12 * size)
    assert law.variance == pytest.approx(np.var(values), rel=1e-9, abs=1e-24 * size**2)


@pytest.mark.parametrize("shift", [-7.0, -2.0, 0.0, 2.5, 9.0])
def test_a_smoothed_sample_is_a_mean_of_uniform_laws(shift: float) -> None:
    """Equal widths sqrt(3/n) s where values have both signs or lie far from 0; of one sign, none reaches over 0.

    Widths of the latter by bisection of the sum of their squares, 3 s^2.
    """
    values = np.sort(np.random.default_rng(4).exponential(2.0, 23) + shift)
    near = np.abs(values) if values[0] * values[-1] > 0.0 else np.full(23, np.inf)
    low, high = 0.0, 100.0
    for _ in range(100):
        middle = (low + high) / 2
        small = np.sum(np.minimum(near, middle) ** 2) < 3 * np.var(values, ddof=1)
        low, high = (middle, high) if small else (low, middle)
    widths = np.minimum(near, low)
    x = np.linspace(values[0] - 3, values[-1] + 3, 1001)
    expected = np.mean([stats.uniform(v - w, 2 * w).cdf(x) for v, w in zip(values, widths, strict=True)], axis=0)
    np.testing.assert_allclose(Empirical(values).cdf(x), expected, atol=1e-12)


@pytest.mark.parametrize("n", [6, 10, 25, 100])
def test_drawn_variance_of_small_samples_is_the_process_own(n: int) -> None:
    """Averaged over 2000 samples sigma^2 smoothed, sigma^2 (n - 1)/n as measured, within 4 standard errors."""
    random, sigma = np.random.default_rng(n), 3.0
    samples = np.sort(random.normal(-20.0, sigma, (2000, n)))
    u = (np.arange(10 * n) + 0.5) / (10 * n)
    laws: tuple[tuple[Draws, float], ...] = (("smoothed", sigma**2), ("as_measured", sigma**2 * (n - 1) / n))
    for draws, expected in laws:
        drawn = np.array([np.var(Empirical(sample, draws).ppf(u)) for sample in samples])
        # the midpoints of 10 n quantiles see the variance to 1e-3 of itself
        assert abs(drawn.mean() - expected) < 4 * drawn.std() / math.sqrt(2000) + 1e-3 * expected


def test_zeros_among_lengths_stay_zeros_and_the_others_stay_lengths() -> None:
    law = Empirical(np.array([0.0, 0.0, 0.0, 1.0, 2.0]))
    np.testing.assert_array_equal(law.ppf(np.array([1e-9, 0.3, 0.6 - 1e-12])), 0.0)
    # s^2 = 0.8, so the squares of both widths have the sum 2.4: 1 and sqrt(1.4)
    assert law.extremes == pytest.approx((0.0, 2 + math.sqrt(1.4)), abs=1e-12)
    assert law.variance == pytest.approx(0.8, rel=1e-12)


def test_empirical_cdf_jumps_where_values_repeat() -> None:
    law = Empirical(np.array([1.0, 2.0, 2.0, 2.0, 5.0]), "as_measured")
    np.testing.assert_array_equal(law.cdf(np.array([0.5, 1.0, 1.5, 2.0, 3.5, 5.0, 6.0])), [0, 0.2, 0.2, 0.8, 0.8, 1, 1])


def test_empirical_law_tends_to_the_law_of_its_sample() -> None:
    n = 100_000
    law = Empirical(np.sort(np.random.default_rng(5).normal(3.0, 2.0, n)))
    assert law.mean == pytest.approx(3.0, abs=4 * 2.0 / math.sqrt(n))
    assert law.sigma == pytest.approx(2.0, abs=4 * 2.0 / math.sqrt(2 * n))


def test_laws_of_other_numbers_are_not_equal() -> None:
    assert Normal(0.0, 1.0) == Normal(0.0, 1.0) != Normal(0.0, 2.0)
    assert Empirical(SAMPLE) != Empirical(2 * SAMPLE)


# low and high -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("fields", "low", "high"),
    [
        ({"kind": "normal", "lower": "-30 um", "upper": "-19 um"}, -0.030, -0.019),
        ({"kind": "normal", "lower": "-30 um", "upper": "-19 um", "sigmas": 2}, -0.030, -0.019),
        ({"kind": "normal", "mean": "10 um", "sigma": "2 um"}, 0.004, 0.016),
        (
            {"kind": "truncated_normal", "mean": "0 um", "sigma": "2 um", "lower": "-1 um", "upper": "3 um"},
            -0.001,
            0.003,
        ),
        ({"kind": "uniform", "lower": "-1 um", "upper": "3 um"}, -0.001, 0.003),
        ({"kind": "triangular", "lower": "-1 um", "mode": "0 um", "upper": "3 um"}, -0.001, 0.003),
        ({"kind": "constant", "value": "3 um"}, 0.003, 0.003),
        # percentiles in closed form: s sqrt(-2 ln(1 - p))
        (
            {"kind": "rayleigh", "scale": "1 um"},
            0.001 * math.sqrt(-2 * math.log(0.99865)),
            0.001 * math.sqrt(-2 * math.log(0.00135)),
        ),
    ],
)
def test_low_and_high_are_the_stated_limits_or_percentiles(fields: dict[str, object], low: float, high: float) -> None:
    law = law_of(**fields)
    assert (law.low, law.high) == pytest.approx((low, high), rel=1e-12)


def test_empirical_low_and_high_are_its_percentiles() -> None:
    """Beyond the outermost value alone: a share p of n values lies w (1 - 2 p n) outside it, w = sqrt(3/n) s."""
    width = math.sqrt(3 / 41) * np.std(SAMPLE, ddof=1)
    apart = np.diff(SAMPLE)[[0, -1]]
    assert all(apart > 2 * 0.00135 * 41 * width)  # the next values have no part in it
    outside = width * (1 - 2 * 0.00135 * 41)
    assert LAWS["empirical"].low == pytest.approx(SAMPLE[0] - outside, rel=1e-12)
    assert LAWS["empirical"].high == pytest.approx(SAMPLE[-1] + outside, rel=1e-12)
    assert (LAWS["empirical_as_measured"].low, LAWS["empirical_as_measured"].high) == (SAMPLE[0], SAMPLE[-1])


@pytest.mark.parametrize(
    ("fields", "radius"),
    [
        ({"kind": "rayleigh", "scale": "4.5 um"}, 4.5e-3 * math.sqrt(-2 * math.log(0.0027))),
        ({"kind": "normal", "mean": "0 um", "sigma": "2 um"}, 6e-3),
        ({"kind": "normal", "lower": "-20 um", "upper": "6 um"}, 20e-3),
        ({"kind": "uniform", "lower": "1 um", "upper": "9 um"}, 9e-3),
        ({"kind": "constant", "value": "-3 um"}, 3e-3),
    ],
)
def test_a_circular_law_ends_at_its_limit_or_where_99_73_percent_stay(fields: dict[str, object], radius: float) -> None:
    # +-3 sigma of a normal hold 0.0026998 outside, not 0.0027: 2e-6 of the radius
    assert law_of(**fields).radius == pytest.approx(radius, rel=1e-5)


def test_the_radius_of_measured_lengths_is_their_quantile() -> None:
    law = Empirical(np.sort(np.random.default_rng(2).rayleigh(3.0, 500)))
    assert law.radius == pytest.approx(law.ppf(np.array([0.9973]))[0], rel=1e-9)


def test_normal_by_limits_has_them_at_the_stated_sigmas() -> None:
    # the paper's pinion: -30 .. -19 um at 3 sigma is -24.5 um, 1.8333 um
    law = law_of(kind="normal", lower="-30 um", upper="-19 um")
    assert (law.mean, law.sigma) == pytest.approx((-0.0245, 0.0055 / 3), rel=1e-12)
    assert law_of(kind="normal", lower="-30 um", upper="-19 um", sigmas=2.0).sigma == pytest.approx(0.00275, rel=1e-12)


@pytest.mark.parametrize(("unit", "factor"), [("um", 1e-3), ("µm", 1e-3), ("arcmin", math.pi / 10800), ("K", 1.0)])
def test_law_is_in_internal_units(unit: str, factor: float) -> None:
    assert law_of(kind="uniform", lower=f"1 {unit}", upper=f"3 {unit}").mean == pytest.approx(2 * factor, rel=1e-15)


# what a scene may not say -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("fields", "field", "expected"),
    [
        ({"kind": "normal", "lower": "-19 um", "upper": "-30 um"}, "lower", "less than upper (-30 um)"),
        ({"kind": "normal", "lower": "1 um", "upper": "1 um"}, "lower", "less than upper (1 um)"),
        ({"kind": "normal", "lower": "-1 um", "upper": "1 um", "sigmas": -3.0}, "sigmas", "a number above 0"),
        ({"kind": "normal", "mean": "0 um", "sigma": "-1 um"}, "sigma", "more than 0"),
        ({"kind": "normal", "mean": "0 um", "sigma": "0 um"}, "sigma", "more than 0"),
        ({"kind": "normal", "mean": "0 um", "sigma": "1 um", "sigmas": 3.0}, "sigmas", "beside lower and upper"),
        ({"kind": "normal"}, "kind", "either lower and upper, or mean and sigma"),
        ({"kind": "normal", "lower": "0 um"}, "kind", "either lower and upper, or mean and sigma"),
        ({"kind": "normal", "mean": "0 um", "sigma": "1 um", "lower": "0 um"}, "kind", "either lower and upper"),
        ({"kind": "uniform", "lower": "3 um", "upper": "-1 um"}, "lower", "less than upper (-1 um)"),
        ({"kind": "uniform", "lower": "1 um", "upper": "1 deg"}, "", "quantities of one dimension"),
        ({"kind": "triangular", "lower": "0 um", "mode": "4 um", "upper": "3 um"}, "mode", "between lower and upper"),
        ({"kind": "triangular", "lower": "3 um", "mode": "2 um", "upper": "1 um"}, "lower", "less than upper"),
        ({"kind": "rayleigh", "scale": "-1 um"}, "scale", "more than 0"),
        ({"kind": "rayleigh", "scale": "0 um"}, "scale", "more than 0"),
        (
            {"kind": "truncated_normal", "mean": "0 um", "sigma": "1 um", "lower": "1 um", "upper": "-1 um"},
            "lower",
            "less than upper",
        ),
        (
            {"kind": "truncated_normal", "mean": "0 um", "sigma": "-1 um", "lower": "-1 um", "upper": "1 um"},
            "sigma",
            "more than 0",
        ),
        (
            {"kind": "truncated_normal", "mean": "0 um", "sigma": "1 um", "lower": "40 um", "upper": "50 um"},
            "lower",
            "at least 0.1% of the normal",
        ),
        ({"kind": "empirical", "file": "a.csv", "column": "x", "unit": "parsec"}, "unit", "one of mm, um"),
        ({"kind": "empirical", "file": " ", "column": "x", "unit": "um"}, "file", "the name of a CSV file"),
    ],
)
def test_nonsense_is_refused_with_field_and_expectation(fields: dict[str, object], field: str, expected: str) -> None:
    context = refusal(**fields)
    assert context["field"] == field
    assert expected in context["expected"]


def test_a_refusal_shows_what_was_written() -> None:
    assert refusal(kind="normal", lower="-19 um", upper="-30 um")["got"] == "'-19 um'"
    assert refusal(kind="normal", lower="0 um")["got"] == "lower"


@pytest.mark.parametrize(
    "fields",
    [
        {"kind": "gauss", "mean": "0 um", "sigma": "1 um"},
        {"kind": "rayleigh"},
        {"kind": "rayleigh", "scale": "1 um", "loc": "1 um"},
        {"kind": "rayleigh", "scale": 4.5},
        {"kind": "normal", "lower": "-1 um", "upper": "1 um", "sigmas": "3"},
        {"kind": "normal", "lower": "-1 um", "upper": "1 um", "sigmas": True},
        {"kind": "normal", "lower": "-1 um", "upper": "1 um", "sigmas": math.inf},
        {"kind": "normal", "lower": "-1 um", "upper": "1 um", "sigmas": math.nan},
    ],
)
def test_malformed_specs_are_refused(fields: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        spec_of(**fields)


def test_quantities_names_every_dimensioned_field() -> None:
    spec = spec_of(kind="normal", mean="1 um", sigma="2 um")
    assert {name: str(q) for name, q in spec.quantities().items()} == {"mean": "1 um", "sigma": "2 um"}
    empirical = spec_of(kind="empirical", file="a.csv", column="x", unit="µm")
    assert {name: str(q) for name, q in empirical.quantities().items()} == {"unit": "1 um"}


def test_every_kind_has_a_json_schema() -> None:
    kinds = UNION.json_schema()["discriminator"]["mapping"]
    assert set(kinds) == {
        "normal",
        "truncated_normal",
        "uniform",
        "triangular",
        "rayleigh",
        "constant",
        "empirical",
        "arcsine",
    }


# the file of an empirical distribution ------------------------------------------------------------


def read(folder: Path, content: str | bytes, column: str = "e", unit: str = "um") -> Empirical:
    data = content if isinstance(content, bytes) else content.encode()
    (folder / "measured.csv").write_bytes(data)
    files = {"measured.csv": read_file(folder / "measured.csv")}
    law = spec_of(kind="empirical", file="measured.csv", column=column, unit=unit).resolve(files)
    assert isinstance(law, Empirical)
    return law


@pytest.mark.parametrize(
    "content",
    [
        "n,e\n1,3.5\n2,-1\n3,2e0\n",
        "n;e\r\n1;3.5\r\n\r\n2;-1\r\n3;2e0",
        "\ufeff e ,n\n 3.5,1\n-1 ,2\n2e0,3\n",
        '"n","e"\n"1, or so","3.5"\n2,-1\n3,2.0\n',
        "n;e\n1;3,5\n2;-1\n3;2,0\n",  # decimal commas, as spreadsheets write them in half of Europe
        "n;e\n1;3,500\n2;-1,000\n3;2,000\n",
        "e;\n3,5;\n-1;\n2,0e0;\n",
        "e\n3,5\n-1\n2\n",  # a column alone needs no separator
        "e\n3,500\n-1,000\n2,00\n",
        "n,e,\n1,3.5,\n2,-1\n3,2,,\n",  # empty cells at the end
    ],
)
def test_a_column_is_read_whatever_the_dialect(tmp_path: Path, content: str) -> None:
    np.testing.assert_allclose(read(tmp_path, content).values, [-1e-3, 2e-3, 3.5e-3], rtol=1e-15)


def test_the_unit_scales_the_column(tmp_path: Path) -> None:
    assert read(tmp_path, "e\n60\n120\n", unit="arcmin").mean == pytest.approx(math.radians(1.5), rel=1e-15)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("n,e\n1,3.5\n2,soft\n", "measured.csv:3: column 'e': expected a number such as 4.5, got 'soft'"),
        ("n;e\n1;3,5\n2;3.5\n", "measured.csv:3: column 'e': expected decimal commas as in line 2, or none"),
        ("n;e\n1;3,5\n2;1.234,5\n", "measured.csv:3: column 'e': expected decimal commas as in line 2"),
        ("n;e\n1;3,5\n2;1,234,5\n", "measured.csv:3: column 'e': expected a number such as 4.5, got '1,234,5'"),
        ("n;e\n1;3;5\n", "measured.csv:2: expected 2 cells, as in the header, got 3"),
        ("n,e\n1,3,5\n2,4,5\n", "measured.csv:2: expected 2 cells, as in the header, got 3; where numbers have"),
        ('n,e\n1,"3,5"\n2,"4,5"\n', "measured.csv:2: column 'e': expected a number such as 4.5, got '3,5'; where"),
        ("e\n12\n1,234\n-5,600\n", "measured.csv:3: column 'e': expected a number such as 4.5, got '1,234', whi"),
        ("e\n1\n3,5,7\n", "measured.csv:3: column 'e': expected a number such as 4.5, got '3,5,7'"),
        ("n,e\n1,3.5\n\n2\n", "measured.csv:4: column 'e': expected a number such as 4.5, got an empty cell"),
        ("e\n1\nnan\n", "measured.csv:3: column 'e': expected a number such as 4.5, got 'nan'"),
        ("e\n1\n1e999\n", "measured.csv:3: column 'e': expected a number such as 4.5, got '1e999'"),
        ("e\n1\n1_0\n", "measured.csv:3: column 'e': expected a number such as 4.5, got '1_0'"),
        ("n,f\n1,2\n", "measured.csv:1: expected one column named 'e' in the header, got 'n', 'f'"),
        ("e,e\n1,2\n", "measured.csv:1: expected one column named 'e' in the header, got 'e', 'e'"),
        ("", "measured.csv:1: expected one column named 'e' in the header, got an empty file"),
        ("e\n1\n", "measured.csv: expected at least two values in column 'e', got 1"),
        ("e\n1\n1e300\n", "measured.csv: expected deviations of less than 1e9"),
        (b"e\n1\n\xff\n", "measured.csv:3: expected UTF-8 text"),
        ('e\n1\n"2', "measured.csv:3: expected comma-separated values"),
    ],
)
def test_a_bad_file_is_refused_with_its_line(tmp_path: Path, content: str | bytes, message: str) -> None:
    with pytest.raises(SceneError) as caught:
        read(tmp_path, content)
    assert message in str(caught.value)


def test_a_missing_or_huge_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"absent\.csv: expected a file, got no such file"):
        read_file(tmp_path / "absent.csv")
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(SceneError, match="got a folder"):
        read_file(tmp_path / "folder.csv")
    with pytest.raises(SceneError, match="expected a file that can be read"):
        read_file(tmp_path / ("n" * 5000))
    (tmp_path / "huge.csv").write_bytes(b"e\n" + b"1\n" * 10_000_001)
    with pytest.raises(SceneError, match="at most 20 MB"):
        read_file(tmp_path / "huge.csv")


# what it costs ------------------------------------------------------------------------------------


def test_reading_a_scene_does_without_scipy_special(tmp_path: Path) -> None:
    code = (
        "import sys; from tol3d.statistics.distributions import StatedDistribution; from pydantic import TypeAdapter\n"
        "read = TypeAdapter(StatedDistribution).validate_python\n"
        "spec = read({'kind': 'truncated_normal', 'mean': '0 um', 'sigma': '1 um', 'lower': '0 um', 'upper': '2 um'})\n"
        "law = spec.resolve(None); print(law.mean, law.variance, law.low, law.high)\n"
        "sys.exit('scipy.special' in sys.modules or 'scipy.stats' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, check=False).returncode == 0
