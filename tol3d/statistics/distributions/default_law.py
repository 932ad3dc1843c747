"""Default law of a deviation for which a drawing states limits alone."""

from abc import ABC, abstractmethod
from typing import Annotated, Literal

from pydantic import Field
from typing_extensions import override

from tol3d.statistics.distributions.base import DistributionSpec
from tol3d.statistics.distributions.normal import NormalSpec
from tol3d.statistics.distributions.triangular import TriangularSpec
from tol3d.statistics.distributions.truncated_normal import TruncatedNormalSpec
from tol3d.statistics.distributions.uniform import UniformSpec
from tol3d.strict import Strict
from tol3d.units import Quantity


class LimitLaw(Strict, ABC):
    """A kind of law that is determined by limits, symmetric about their middle."""

    kind: str

    @abstractmethod
    def between(self, lower: Quantity, upper: Quantity) -> DistributionSpec:
        """The law between these limits, as a scene states it."""


class NormalBetween(LimitLaw):
    """Normal, with its limits at a number of sigmas; not cut at them."""

    kind: Literal["normal"]
    sigmas: float = Field(default=3.0, gt=0.0, description="standard deviations from the middle to either limit")

    @override
    def between(self, lower: Quantity, upper: Quantity) -> DistributionSpec:
        return NormalSpec(kind="normal", lower=lower, upper=upper, sigmas=self.sigmas)


class TruncatedNormalBetween(LimitLaw):
    """Normal, cut at its limits."""

    kind: Literal["truncated_normal"]
    sigmas: float = Field(default=3.0, gt=0.0, description="standard deviations from the middle to either limit")

    @override
    def between(self, lower: Quantity, upper: Quantity) -> DistributionSpec:
        sigma = lower.like((upper.internal - lower.internal) / (2 * self.sigmas))
        return TruncatedNormalSpec(
            kind="truncated_normal", mean=_middle(lower, upper), sigma=sigma, lower=lower, upper=upper
        )


class UniformBetween(LimitLaw):
    """Equally likely everywhere between the limits."""

    kind: Literal["uniform"]

    @override
    def between(self, lower: Quantity, upper: Quantity) -> DistributionSpec:
        return UniformSpec(kind="uniform", lower=lower, upper=upper)


class TriangularBetween(LimitLaw):
    """Most likely in the middle of the limits, with density 0 at them."""

    kind: Literal["triangular"]

    @override
    def between(self, lower: Quantity, upper: Quantity) -> DistributionSpec:
        return TriangularSpec(kind="triangular", lower=lower, mode=_middle(lower, upper), upper=upper)


StatedLimitLaw = Annotated[
    NormalBetween | TruncatedNormalBetween | UniformBetween | TriangularBetween, Field(discriminator="kind")
]
"""As a scene states one: `{kind: normal, sigmas: 3}`."""


def _middle(lower: Quantity, upper: Quantity) -> Quantity:
    return lower.like((lower.internal + upper.internal) / 2)
