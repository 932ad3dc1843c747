"""Draws of a toleranced feature's displacement: from uniforms to its components, by zone and named law."""

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from tol3d.assembly.zones.balls import RingFlat
from tol3d.assembly.zones.centred import Centred
from tol3d.assembly.zones.zone import Ratio, UnitLaw, Zone
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions import DeviationLaw, Distribution
from tol3d.study.system.contributor import Contributor
from tol3d.study.system.draw import JointDraw
from tol3d.study.system.normals import Group, scalars
from tol3d.study.system.steepest import Values, steepest_ends


@dataclass(frozen=True)
class ComponentLaw:
    """Moments and ends of one component that its zone confines [mm]; it is drawn with the others alone."""

    mean: float
    variance: float
    low: float
    high: float

    @property
    def sigma(self) -> float:
        """See DeviationLaw."""
        return math.sqrt(self.variance)


@dataclass(frozen=True)
class ZoneDraw(ABC):
    """A Draw of the components of a displacement [mm] that a zone limits or judges."""

    zone: Zone

    @property
    @abstractmethod
    def distribution(self) -> DeviationLaw:
        """The law of the first component: offset, start x, x, or what is stated along a direction."""

    @property
    @abstractmethod
    def words(self) -> str:
        """See Joint: its law in words."""

    @property
    @abstractmethod
    def uniforms(self) -> int:
        """Number of uniforms per trial."""

    @property
    @abstractmethod
    def mean_vector(self) -> Array:
        """Mean of each component (components,) [mm]."""

    @property
    @abstractmethod
    def covariance(self) -> Array:
        """Covariance (components, components) [mm^2]."""

    @abstractmethod
    def deviations(self, *uniforms: Array) -> tuple[Array, ...]:
        """See Draw: in the zone of the drawing's width."""

    @abstractmethod
    def deviations_in(self, width: Ratio, orientation: Ratio | None, *uniforms: Array) -> tuple[Array, ...]:
        """As `deviations`, in zones of each trial's own width, such as a bonus makes them.

        Args:
            width: t (trials,) [mm].
            orientation: t_o (trials,); None where it stays as stated, or the zone alone limits the orientation.
            uniforms: (trials,) each.
        """

    @abstractmethod
    def furthest(self, gradient: Array) -> Array:
        """The point (components,) [mm] where a draw reaches furthest along a gradient (components,)."""

    @abstractmethod
    def support(self, gradient: Array) -> float:
        """The largest value of gradient · components: the worst case of a linear measure.

        Args:
            gradient: (components,), change of the measure per mm.
        """

    @property
    def components(self) -> tuple[str, ...]:
        """Names of the components."""
        return self.zone.components

    @property
    def matrix(self) -> Array:
        """Components of the feature = matrix (components of the feature, components) @ components."""
        return self.zone.matrix

    @property
    def sigmas(self) -> Array:
        """Standard deviation of each component (components,) [mm]."""
        return np.sqrt(np.diagonal(self.covariance))

    @property
    def sigma(self) -> float:
        """Standard deviation of the first component [mm]."""
        return float(self.sigmas[0])

    @property
    def middle_sigma(self) -> float:
        """See MiddleDraw."""
        return math.sqrt(max(float(self.zone.middle @ self.covariance @ self.zone.middle), 0.0))

    @property
    def width(self) -> float:
        """See Zoned."""
        return self.zone.width

    def sized(self, width: float) -> Self:
        """See Zoned."""
        return replace(self, zone=self.zone.resized(width))

    def scaled(self, factor: float) -> Self:
        """See Scalable."""
        if not 0.0 < factor < math.inf:
            raise InputError(f"expected a factor above 0, got {factor:g}")
        return self.sized(factor * self.width)

    def mean(self, *, turning: bool) -> tuple[float, ...]:
        """See Draw; directions are those of the feature, which does not turn."""
        return tuple(float(value) for value in self.mean_vector)

    def ends(self, values: Values, *, turning: bool) -> Array:
        """See Draw: as far as the components reach along the measure's gradient, and against it."""
        return steepest_ends(values, self.mean_vector, self.sigmas, self.furthest)


@dataclass(frozen=True)
class Confined(ZoneDraw):
    """Draw of a law within the zone.

    Args:
        zone: the zone.
        law: in half widths.
        name: of the law, as in scenes.
    """

    law: UnitLaw
    name: str

    @property
    @override
    def words(self) -> str:
        return f"{self.name} in its zone"

    @cached_property
    def distribution(self) -> ComponentLaw:
        centre, half = self.zone.centre, self.zone.half
        return ComponentLaw(centre, float(self.covariance[0, 0]), centre - half, centre + half)

    @property
    def uniforms(self) -> int:
        return self.law.uniforms

    @property
    def groups(self) -> tuple[Group, ...]:
        """See Smooth."""
        return self.law.groups(self.zone.ratio)

    @property
    def fills(self) -> bool:
        """See Filled: zones are convex, and all laws but a ring's are of all of it."""
        return not isinstance(self.law, RingFlat)

    @cached_property
    def mean_vector(self) -> Array:
        mean = np.zeros(len(self.components))
        mean[0] = self.zone.centre
        return mean

    @cached_property
    def covariance(self) -> Array:
        return self.law.covariance(self.zone.ratio) * self.zone.half**2

    @override
    def deviations(self, *uniforms: Array) -> tuple[Array, ...]:
        return self._drawn(self.zone.half, self.zone.ratio, uniforms)

    def deviations_in(self, width: Ratio, orientation: Ratio | None, *uniforms: Array) -> tuple[Array, ...]:
        return self._drawn(*self.zone.halves(width, orientation), uniforms)

    def _drawn(self, half: Ratio, ratio: Ratio, uniforms: tuple[Array, ...]) -> tuple[Array, ...]:
        first, *others = (half * coordinate for coordinate in self.law.coordinates(ratio, *uniforms))
        return (first if self.zone.centre == 0.0 else first + self.zone.centre, *others)

    def furthest(self, gradient: Array) -> Array:
        return self.zone.furthest(gradient)

    def support(self, gradient: Array) -> float:
        return self.zone.support(gradient)


@dataclass(frozen=True)
class Process(ZoneDraw):
    """Draw of a stated law for each component, independently; the zone only judges, see `Zone.inside`.

    Args:
        zone: the drawing's; neither its width nor its bonus changes a draw.
        laws: one per component.
    """

    laws: tuple[Distribution, ...]

    def __post_init__(self) -> None:
        if len(self.laws) != len(self.components):
            expected = f"one distribution for each of {', '.join(self.components)}"
            raise InputError(f"process: expected {expected}, got {len(self.laws)}")

    @property
    @override
    def words(self) -> str:
        return "its own process"

    @property
    def own_laws(self) -> tuple[Distribution, ...]:
        """See Independent."""
        return self.laws

    @property
    def distribution(self) -> Distribution:
        return self.laws[0]

    @property
    def uniforms(self) -> int:
        return len(self.laws)

    @property
    def groups(self) -> tuple[Group, ...]:
        """See Smooth."""
        return scalars(self.uniforms)

    @cached_property
    def mean_vector(self) -> Array:
        return np.array([law.mean for law in self.laws])

    @cached_property
    def covariance(self) -> Array:
        return np.diag([law.variance for law in self.laws])

    def sized(self, width: float) -> Self:
        """See Zoned.

        Raises:
            InputError: always.
        """
        raise InputError(f"expected a law that fills its zone, got {self.words}; state its limits")

    def scaled(self, factor: float) -> Self:
        """See Scalable: the process; the zone stays that of the drawing."""
        return replace(self, laws=tuple(law.scaled(factor) for law in self.laws))

    def with_law(self, law: Distribution) -> Self:
        """See Lawful: of each component; what spreads about 0 goes on doing so."""
        laws = tuple(own.like(law) if isinstance(own, Centred) else law for own in self.laws)
        return replace(self, laws=laws)

    def beyond(self, *components: Array) -> NDArray[np.bool_]:
        """See Judged: outside the zone of the drawing's width."""
        return ~self.zone.inside(np.stack(components, axis=-1))

    def deviations(self, *uniforms: Array) -> tuple[Array, ...]:
        """See ZoneDraw: whatever the zone is."""
        return tuple(law.ppf(u) for law, u in zip(self.laws, uniforms, strict=True))

    def deviations_in(self, width: Ratio, orientation: Ratio | None, *uniforms: Array) -> tuple[Array, ...]:
        """See ZoneDraw: a process does not know the drawing."""
        return self.deviations(*uniforms)

    def furthest(self, gradient: Array) -> Array:
        """As far along the direction of the steepest change as each law reaches.

        All components at their worst ends at once would be far rarer than the end of one.
        """
        spread = gradient * self.sigmas
        size = math.hypot(*spread)
        along = spread / size if size > 0.0 else np.zeros_like(spread)
        return np.asarray(self.mean_vector + np.abs(along) * (self._worst(along) - self.mean_vector))

    def support(self, gradient: Array) -> float:
        """See ZoneDraw: every law at its own worst end, its limit or 3 sigma where it has none."""
        return float((gradient * self._worst(gradient)).sum())

    def _worst(self, gradient: Array) -> Array:
        return np.array([law.high if own > 0.0 else law.low for law, own in zip(self.laws, gradient, strict=True)])


def laws_told(contributors: Iterable[Contributor]) -> dict[str, Any]:
    """Laws of contributors in words and sigmas of middles [um], by their names, as a summary has them of a measure."""
    drawn = {contributor.name: contributor.draw for contributor in contributors}
    laws = {name: draw.words for name, draw in drawn.items() if isinstance(draw, JointDraw)}
    sigmas = {name: 1e3 * draw.middle_sigma for name, draw in drawn.items() if isinstance(draw, ZoneDraw)}
    return ({"laws": laws} if laws else {}) | ({"law_sigmas_um": sigmas} if sigmas else {})


def uniform_in(zone: Zone) -> Confined:
    """The law `uniform`: every displacement that the zone allows is as likely as any other."""
    return Confined(zone, zone.shape.domain.uniform, "uniform")


def normal_in(zone: Zone) -> Confined:
    """The law `normal`: the middle is normal, cut to the zone, tilts in what it leaves; see Domain.normal."""
    return Confined(zone, zone.shape.domain.normal, "normal")


def ring_in(zone: Zone) -> Confined:
    """The law `ring`: at the edge of a disc, such as `catalogue.axis_section`, at any phase."""
    return Confined(zone, RingFlat(), "ring")


def process_in(zone: Zone, law: Distribution) -> Process:
    """The law `process` with one stated distribution [mm] of every component."""
    return Process(zone, (law,) * len(zone.components))
