"""Laws of a deviation: their words in scenes and their meaning, one file each."""

from tol3d.statistics.distributions.base import (
    HIGH_PROBABILITY,
    LOW_PROBABILITY,
    DeviationLaw,
    Distribution,
    DistributionSpec,
)
from tol3d.statistics.distributions.constant import Constant, ConstantSpec
from tol3d.statistics.distributions.empirical import Empirical
from tol3d.statistics.distributions.normal import Normal, NormalSpec
from tol3d.statistics.distributions.rayleigh import Rayleigh
from tol3d.statistics.distributions.stated import StatedDistribution
from tol3d.statistics.distributions.triangular import Triangular, TriangularSpec
from tol3d.statistics.distributions.truncated_normal import TruncatedNormal, TruncatedNormalSpec
from tol3d.statistics.distributions.uniform import Uniform, UniformSpec

__all__ = [
    "HIGH_PROBABILITY",
    "LOW_PROBABILITY",
    "Constant",
    "ConstantSpec",
    "DeviationLaw",
    "Distribution",
    "DistributionSpec",
    "Empirical",
    "Normal",
    "NormalSpec",
    "Rayleigh",
    "StatedDistribution",
    "Triangular",
    "TriangularSpec",
    "TruncatedNormal",
    "TruncatedNormalSpec",
    "Uniform",
    "UniformSpec",
]
