"""Laws of a deviation: their words in scenes and their meaning, one file each."""

from tol3d.distributions.base import DeviationLaw, Distribution, DistributionSpec
from tol3d.distributions.constant import Constant
from tol3d.distributions.empirical import Empirical
from tol3d.distributions.normal import Normal
from tol3d.distributions.rayleigh import Rayleigh
from tol3d.distributions.stated import StatedDistribution
from tol3d.distributions.triangular import Triangular
from tol3d.distributions.truncated_normal import TruncatedNormal
from tol3d.distributions.uniform import Uniform

__all__ = [
    "Constant",
    "DeviationLaw",
    "Distribution",
    "DistributionSpec",
    "Empirical",
    "Normal",
    "Rayleigh",
    "StatedDistribution",
    "Triangular",
    "TruncatedNormal",
    "Uniform",
]
