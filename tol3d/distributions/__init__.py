"""Laws of a deviation: what a scene writes of them and what that means, one file each."""

from typing import Annotated

from pydantic import Field

from tol3d.distributions.base import Distribution, DistributionSpec
from tol3d.distributions.constant import Constant, ConstantSpec
from tol3d.distributions.empirical import Empirical, EmpiricalSpec
from tol3d.distributions.normal import Normal, NormalSpec
from tol3d.distributions.rayleigh import Rayleigh, RayleighSpec
from tol3d.distributions.triangular import Triangular, TriangularSpec
from tol3d.distributions.truncated_normal import TruncatedNormal, TruncatedNormalSpec
from tol3d.distributions.uniform import Uniform, UniformSpec

DistributionUnion = Annotated[
    NormalSpec | TruncatedNormalSpec | UniformSpec | TriangularSpec | RayleighSpec | ConstantSpec | EmpiricalSpec,
    Field(discriminator="kind"),
]

__all__ = [
    "Constant",
    "Distribution",
    "DistributionSpec",
    "DistributionUnion",
    "Empirical",
    "Normal",
    "Rayleigh",
    "Triangular",
    "TruncatedNormal",
    "Uniform",
]
