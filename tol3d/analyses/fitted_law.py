"""A law fitted to trials by their moments, chosen and tested by Anderson and Darling's A².

Laws are the normal one, Pearson III (skewed, one tail), Pearson I (a beta law between two ends), and Pearson VII
(symmetrical with heavy tails, Student's t). The simplest whose A² is not rejected at 5 % is taken, else the one with
the least A². The p-value is by Monte Carlo, for parameters are fitted (Stephens 1974): samples of the fitted law are
fitted again, and it is the share of those with a larger A².
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from scipy import stats

from tol3d.analyses.methods_section import FittedLaw
from tol3d.numerics.arrays import Array
from tol3d.study.runs.summary.values import made

MOST: Final = 2000
"""Trials that are fitted and tested: of more, A² rejects every law that is not the true one."""
REPLICATES: Final = 200
LEVEL: Final = 0.05
LOW, HIGH = 0.00135, 0.99865
LEAST_POWER: Final = 0.7
"""Power of a beta law: with less it has its trials at its ends, which moments do not find."""
BEYOND: Final = 0.25
"""Trials that a law has beyond any of them: those beyond its fitted ends are not infinitely rare."""


@dataclass(frozen=True)
class Moments:
    """Moments of samples, each an array (samples,)."""

    mean: Array
    sigma: Array
    skewness: Array
    kurtosis: Array

    @classmethod
    def of(cls, values: Array) -> "Moments":
        """Moments of samples (samples, n)."""
        mean, sigma = values.mean(axis=1), values.std(axis=1, ddof=1)
        off = (values - mean[:, None]) / sigma[:, None]
        return cls(mean, sigma, (off**3).mean(axis=1), (off**4).mean(axis=1) - 3.0)


@dataclass(frozen=True)
class Kind:
    """A kind of law.

    Args:
        name: in words.
        parameters: their names.
        law: of scipy.stats.
        fit: its arguments (samples,) each of moments; not numbers where these are of no such law.
    """

    name: str
    parameters: tuple[str, ...]
    law: Any
    fit: Callable[[Moments], Sequence[Array]]


def _normal(moments: Moments) -> Sequence[Array]:
    return moments.mean, moments.sigma


def _pearson3(moments: Moments) -> Sequence[Array]:
    return moments.skewness, moments.mean, moments.sigma


def _beta(own: Moments) -> Sequence[Array]:
    """By four moments; Johnson, Kotz and Balakrishnan 1995, chapter 25."""
    square = own.skewness**2
    with np.errstate(all="ignore"):
        total = 3.0 * (own.kurtosis - square + 2.0) / (1.5 * square - own.kurtosis)
        total = np.where((own.kurtosis < 1.5 * square) & (own.kurtosis > square - 2.0), total, np.nan)
        lean = 1.0 / np.sqrt(1.0 + 16.0 * (total + 1.0) / (np.maximum(square, 1e-30) * (total + 2.0) ** 2))
        first, second = (
            total / 2 * (1.0 - np.sign(own.skewness) * lean),
            total / 2 * (1.0 + np.sign(own.skewness) * lean),
        )
        first, second = (np.where(np.minimum(first, second) > LEAST_POWER, each, np.nan) for each in (first, second))
        width = own.sigma / np.sqrt(first * second / (total**2 * (total + 1.0)))
    return first, second, own.mean - width * first / total, width


def _student(moments: Moments) -> Sequence[Array]:
    with np.errstate(all="ignore"):
        freedoms = np.where(moments.kurtosis > 0.0, 4.0 + 6.0 / moments.kurtosis, np.nan)
    return freedoms, moments.mean, moments.sigma * np.sqrt((freedoms - 2.0) / freedoms)


KINDS: Final = (
    Kind("normal", ("mean", "sigma"), stats.norm, _normal),
    Kind("Pearson III", ("skewness", "mean", "sigma"), stats.pearson3, _pearson3),
    Kind("Pearson I", ("a", "b", "low", "width"), stats.beta, _beta),
    Kind("Pearson VII", ("freedoms", "mean", "scale"), stats.t, _student),
)


def fitted(values: Array, seed: int = 1) -> FittedLaw:
    """The law of trials (n,), of which the first MOST are taken.

    Args:
        values: that vary.
        seed: of the samples by which it is tested.
    """
    sample = values[:MOST][None]
    found = []
    for kind in KINDS:
        arguments = kind.fit(Moments.of(sample))
        if not np.isfinite(arguments).all():
            continue
        statistic = float(_distance(kind, sample, arguments)[0])
        own = (statistic, kind, [float(argument[0]) for argument in arguments])
        p_value = _p_value(kind, own[2], statistic, sample.shape[1], seed)
        found.append((*own, p_value))
        if p_value > LEVEL:
            break
    statistic, kind, numbers, p_value = next(
        (own for own in found if own[3] > LEVEL), min(found, key=lambda own: own[0])
    )
    low, high = (float(kind.law.ppf(share, *numbers)) for share in (LOW, HIGH))
    return made(
        FittedLaw,
        name=kind.name,
        parameters=dict(zip(kind.parameters, numbers, strict=True)),
        low=low if math.isfinite(low) else None,
        high=high if math.isfinite(high) else None,
        statistic=statistic,
        p_value=p_value,
        trials=sample.shape[1],
        replicates=REPLICATES,
    )


def _distance(kind: Kind, samples: Array, arguments: Sequence[Array]) -> Array:
    """A² of samples (samples, n) and of laws with arguments (samples,) each; NaN where there is no law."""
    count = samples.shape[1]
    ordered = np.sort(samples, axis=1)
    nearly = BEYOND / count
    below = np.clip(kind.law.cdf(ordered, *(argument[:, None] for argument in arguments)), nearly, 1.0 - nearly)
    weights = (2.0 * np.arange(1, count + 1) - 1.0) / count
    return np.asarray(-count - (weights * (np.log(below) + np.log1p(-below[:, ::-1]))).sum(axis=1))


def _p_value(kind: Kind, numbers: Sequence[float], statistic: float, count: int, seed: int) -> float:
    samples = np.asarray(kind.law.rvs(*numbers, size=(REPLICATES, count), random_state=np.random.default_rng(seed)))
    distances = _distance(kind, samples, kind.fit(Moments.of(samples)))
    known = distances[np.isfinite(distances)]
    return float(np.mean(known >= statistic)) if known.size else 0.0
