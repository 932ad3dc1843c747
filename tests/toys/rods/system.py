"""All that a study asks of a rod."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.scene import Scene
from tol3d.statistics.distributions import Distribution
from tol3d.study.system.closed_form import ClosedForm, Share
from tol3d.study.system.dependent import Given
from tol3d.study.system.draw import Draw, Scalar, Values
from tol3d.study.system.measure import Measure
from tol3d.study.system.plain import PlainContributor, PlainSystem, measures_of
from tol3d.study.system.trials import Trials
from toys.rods.grammar import LengthToleranceSpec, MarkSpec, RodSpec, TipSpec

Array = NDArray[np.float64]

GAIN = 10.0
UNIT = 0.01  # mm


@dataclass(frozen=True)
class Scaled:
    """A Draw of a law about 0, times what it reads: factor(the one component of another contributor).

    Args:
        distribution: about 0, with limits at ±as much.
        other: the contributor that is read.
        offset, gain: factor = offset + gain * its deviation.
        mean_square: of the factor.
        most: the largest factor.
    """

    distribution: Distribution
    other: str
    offset: float
    gain: float
    mean_square: float
    most: float

    uniforms = 1
    components = ("",)

    @property
    def reads(self) -> tuple[str, ...]:
        return (self.other,)

    @property
    def sigma(self) -> float:
        return self.distribution.sigma * float(np.sqrt(self.mean_square))

    def deviations(self, *uniforms: Array) -> tuple[Array, ...]:
        raise AssertionError("a study asks deviations_given")

    def deviations_given(self, given: Given, *uniforms: Array) -> tuple[Array, ...]:
        assert tuple(given) == self.reads
        return (self._factor(given) * self.distribution.ppf(uniforms[0]),)

    def furthest_given(self, given: Given, slopes: Array) -> Array:
        return np.asarray(np.abs(self._factor(given)) * self.distribution.high * np.sign(slopes))

    def mean(self, *, turning: bool) -> tuple[float]:
        return (0.0,)

    def ends(self, values: Values, *, turning: bool) -> Array:
        return self.most * np.array([[self.distribution.low], [self.distribution.high]])

    def _factor(self, given: Given) -> Array:
        (own,) = given[self.other]
        return np.asarray(self.offset + self.gain * own)


@dataclass(frozen=True)
class RodsSystem(PlainSystem):
    """Implements System; both methods add up."""

    length: float = 0.0

    def analytic(self, trials: Trials, measure: Measure) -> Array:
        return np.asarray(self.length + trials.deviations.sum(axis=1))

    exact = analytic

    def closed_form(self, measure: Measure) -> ClosedForm | None:
        shares = tuple(
            Share(own.name, 1.0, own.draw.mean(turning=False)[0], own.draw.sigma**2) for own in self.contributors
        )
        mean, variance = sum(share.mean for share in shares), sum(share.variance for share in shares)
        return ClosedForm(self.length, self.length + mean, variance**0.5, shares)


def rods_system(scene: Scene) -> RodsSystem:
    """System of a scene of a rod."""
    ((_, rod),) = scene.of(RodSpec).items()
    laws = {name: spec.distribution.resolve(scene.files) for name, spec in scene.distributed.items()}

    def draw(name: str) -> Draw:
        spec, law = scene.tolerances[name], laws[name]
        if isinstance(spec, TipSpec):
            own = laws[spec.length]
            square = (1.0 + GAIN * own.mean) ** 2 + GAIN**2 * own.variance
            return Scaled(law, spec.length, 1.0, GAIN, square, 1.0 + GAIN * own.high)
        if isinstance(spec, MarkSpec):
            tip = draw(spec.tip)
            most = abs(tip.ends(lambda rows: rows[:, 0], turning=False)[1, 0])
            return Scaled(law, spec.tip, 0.0, 1.0 / UNIT, tip.sigma**2 / UNIT**2, most / UNIT)
        assert isinstance(spec, LengthToleranceSpec)
        return Scalar(law)

    contributors = tuple(
        PlainContributor(name, spec.kind, draw(name), description=spec.description)
        for name, spec in scene.distributed.items()
    )
    return RodsSystem(scene.scene, contributors, measures_of(scene), rod.length.internal)
