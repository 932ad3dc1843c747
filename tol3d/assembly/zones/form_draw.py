"""Draws of the form that a fit sees: it makes a pin larger and a hole smaller than each section is."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from typing import Self

import numpy as np

from tol3d.assembly.zones.widened import SIZES, SizedBy
from tol3d.assembly.zones.zone_draw import ComponentLaw
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions import Distribution
from tol3d.study.system.dependent import Given
from tol3d.study.system.draw import Draw, Scalar
from tol3d.study.system.normals import scalars
from tol3d.study.system.steepest import Values


@dataclass(frozen=True)
class FittedForm(Scalar):
    """A form that no envelope bounds: it begins at nothing, also where its tolerance is another one."""

    def scaled(self, factor: float) -> Self:
        """See Scalable."""
        return replace(self, distribution=self.distribution.scaled(factor, about=0.0))


@dataclass(frozen=True)
class EnvelopedForm:
    """A share of the form that the limits of size leave in each trial; implements Dependent.

    Args:
        share: law of the share, within 0 to 1.
        name: of that law, as in scenes.
        size: that leaves it, with the envelope of its bonus.
    """

    share: Distribution
    name: str
    size: SizedBy

    uniforms = 1
    components = ("",)
    groups = scalars(1)
    fills = True

    def __post_init__(self) -> None:
        if self.size.bonus.envelope is None:
            raise InputError(f"{self.size.name}: expected a size with an envelope, got one without")

    @property
    def words(self) -> str:
        """See JointDraw."""
        return f"{self.name} within the form that {self.size.name} leaves"

    @property
    def reads(self) -> tuple[str, ...]:
        """See Dependent: the size."""
        return (self.size.name,)

    @property
    def width(self) -> float:
        """See Zoned: the tolerance of form [mm]."""
        assert self.size.bonus.envelope is not None
        return self.size.bonus.envelope.form

    def sized(self, width: float) -> Self:
        """See Zoned."""
        if not 0.0 < width < math.inf:
            raise InputError(f"expected a form above 0 mm, got {width:g} mm")
        assert self.size.bonus.envelope is not None
        bonus = replace(self.size.bonus, envelope=replace(self.size.bonus.envelope, form=width))
        return replace(self, size=replace(self.size, bonus=bonus))

    def scaled(self, factor: float) -> Self:
        """See Scalable."""
        return self.sized(factor * self.width)

    def following(self, name: str, draw: Draw) -> Self:
        """See Following: the size."""
        return replace(self, size=self.size.following(draw)) if name == self.size.name else self

    def most(self, size: Array) -> Array:
        """Largest form (trials,) [mm] at deviations of size (trials,) [mm]."""
        assert self.size.bonus.envelope is not None
        return self.size.bonus.envelope.of(size)

    @cached_property
    def distribution(self) -> ComponentLaw:
        """Over all sizes: share and room are independent."""
        most = self.most(self.size.law.ppf((np.arange(SIZES) + 0.5) / SIZES))
        mean, square = self.share.mean * float(most.mean()), float((most * most).mean())
        high = float(self.most(np.array([self.size.law.low, self.size.law.high])).max()) * self.share.high
        return ComponentLaw(mean, (self.share.variance + self.share.mean**2) * square - mean**2, 0.0, high)

    @property
    def sigma(self) -> float:
        """Standard deviation [mm]."""
        return self.distribution.sigma

    @property
    def covariance(self) -> Array:
        """See JointDraw (1, 1) [mm^2]."""
        return np.array([[self.distribution.variance]])

    def mean(self, *, turning: bool) -> tuple[float]:
        """See Draw."""
        return (self.distribution.mean,)

    def deviations(self, *uniforms: Array) -> tuple[Array]:
        """See Dependent: not asked, for the size is missing."""
        raise TypeError(f"{self.words}: expected the sizes of the trials")

    def deviations_given(self, given: Given, *uniforms: Array) -> tuple[Array]:
        """See Dependent."""
        return (self.share.ppf(uniforms[0]) * self.most(self.size.of(given)),)

    def furthest_given(self, given: Given, slopes: Array) -> Array:
        """See Dependent: all that a size leaves, or none."""
        share = self.share.high if slopes[0] > 0.0 else self.share.low
        return share * self.most(self.size.of(given)[:1])

    def ends(self, values: Values, *, turning: bool) -> Array:
        """See Draw: none, and the most that a size leaves."""
        return np.array([[0.0], [self.distribution.high]])

    def support(self, per_form: float, per_size: float = 0.0) -> float:
        """The largest value of per_form · form + per_size · size, over all sizes and the form that they leave.

        It is linear between the sizes at which the form has none of its room, all of it, or its whole tolerance.
        """
        bonus, law = self.size.bonus, self.size.law
        assert bonus.envelope is not None
        knees = (own for own in (bonus.low, bonus.high, bonus.envelope.knee) if law.low < own < law.high)
        places = np.array([*chain((law.low, law.high), knees)])
        share = self.share.high if per_form > 0.0 else self.share.low
        return float((per_size * places + per_form * share * self.most(places)).max())
