"""Pitch deviations of a gear's teeth as a named law draws them: a pattern round the gear, and how far it fills limits.

What is drawn is the index deviation F of each flank [mm]: the arc at the reference circle by which the flank lies ahead
of its place, counter-clockwise about the gear's z. The mean over the teeth of a flank side is removed: it is a turn of
the gear, or tooth thickness. The single pitch deviation of a tooth is f_k = F_k - F_(k-1); round the gear they sum to
zero whatever F is.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import ClassVar, Final, Self

import numpy as np
from typing_extensions import override

from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions import Distribution, standard_normal
from tol3d.statistics.distributions.empirical import Piecewise
from tol3d.study.system.normals import Group, scalars, shifted
from tol3d.study.system.steepest import Values

NET: Final = 4096
"""Patterns over which the covariance of a law is averaged; each counts once for every tooth, as no tooth is special."""
QUANTILES: Final = 1001


class Pattern(ABC):
    """A law of how index deviations go round a gear, up to their size. Frozen data."""

    @property
    @abstractmethod
    def words(self) -> str:
        """It in words."""

    @abstractmethod
    def uniforms(self, teeth: int) -> int:
        """Number of uniforms per pattern."""

    def groups(self, teeth: int) -> tuple[Group, ...]:
        """Groups of the uniforms, see Smooth; by default each by itself."""
        return scalars(self.uniforms(teeth))

    @abstractmethod
    def drawn(self, uniforms: Sequence[Array]) -> list[Array]:
        """Index deviations, each tooth (trials,), in any unit and from any place, of uniforms (trials,) each."""


@dataclass(frozen=True)
class RandomWalk(Pattern):
    """Independent normal single pitches, on condition that they sum to zero."""

    words = "random walk of pitches"

    def uniforms(self, teeth: int) -> int:
        """See Pattern: one a pitch."""
        return teeth

    def drawn(self, uniforms: Sequence[Array]) -> list[Array]:
        """See Pattern: normals less their mean are normals on condition that the sum is zero."""
        singles = centred([standard_normal.ppf(u) for u in uniforms])
        walked = [singles[0]]
        for single in singles[1:]:
            walked.append(walked[-1] + single)
        return walked


@dataclass(frozen=True)
class RunOutAndRandom(Pattern):
    """One wave round the gear, of any phase, and independent normals.

    Args:
        run_out: the wave's part of the variance, 0 to 1.
    """

    run_out: float

    @property
    @override
    def words(self) -> str:
        return f"{100 * self.run_out:g} % run-out, rest random"

    def uniforms(self, teeth: int) -> int:
        """See Pattern: a phase, and one a tooth."""
        return 1 + teeth

    @override
    def groups(self, teeth: int) -> tuple[Group, ...]:
        return Group("phase", (0,)), *scalars(teeth, 1)

    @override
    def drawn(self, uniforms: Sequence[Array]) -> list[Array]:
        phase, *others = uniforms
        wave, noise = math.sqrt(2 * self.run_out), math.sqrt(1 - self.run_out)
        return [
            wave * np.cos(2 * math.pi * (phase + k / len(others))) + noise * standard_normal.ppf(u)
            for k, u in enumerate(others)
        ]


@dataclass(frozen=True)
class PitchLimits:
    """Limits of pitch deviations [mm].

    Args:
        single: of the size of each single pitch deviation.
        cumulative: of the largest index deviation less the smallest.
    """

    single: float
    cumulative: float

    def used(self, index: Sequence[Array]) -> Array:
        """Utilisation of the limits by index deviations, each (trials,): 1 where either limit is reached."""
        highest, lowest = np.maximum.reduce(index), np.minimum.reduce(index)
        single = np.abs(index[0] - index[-1])
        for before, own in pairwise(index):
            single = np.maximum(single, np.abs(own - before))
        return np.asarray(np.maximum(single / self.single, (highest - lowest) / self.cumulative))


@dataclass(frozen=True, eq=False)
class PitchDraw:
    """A Draw of the index deviations of one or both flank sides of a gear: a pattern that fills its limits so far.

    Args:
        teeth: of the gear.
        sides: names of the flank sides that are drawn each for itself; "" for one pattern of whole teeth.
        pattern: how they go round.
        limits: of each side.
        fill: least and most of the limits that a side takes up, uniform in between.
    """

    teeth: int
    sides: tuple[str, ...]
    pattern: Pattern
    limits: PitchLimits
    fill: tuple[float, float]

    @property
    def words(self) -> str:
        """See JointDraw."""
        least, most = (f"{100 * share:g}" for share in self.fill)
        return f"{self.pattern.words}, {least} to {most} % of limits, each of {self.teeth}"

    def scaled(self, factor: float) -> Self:
        """See Scalable: both limits."""
        if not 0.0 < factor < math.inf:
            raise InputError(f"expected a factor above 0, got {factor:g}")
        limits = PitchLimits(factor * self.limits.single, factor * self.limits.cumulative)
        return replace(self, limits=limits)

    @property
    def components(self) -> tuple[str, ...]:
        """One a flank, or a tooth."""
        return tooth_names(self.teeth, self.sides)

    @property
    def _side_uniforms(self) -> int:
        return 1 + self.pattern.uniforms(self.teeth)

    @property
    def uniforms(self) -> int:
        """See Draw: of each side how full its limits are, and its pattern."""
        return len(self.sides) * self._side_uniforms

    @property
    def groups(self) -> tuple[Group, ...]:
        """See Smooth."""
        one = (*scalars(1), *shifted(self.pattern.groups(self.teeth), 1))
        return tuple(own for k in range(len(self.sides)) for own in shifted(one, k * self._side_uniforms))

    def deviations(self, *uniforms: Array) -> tuple[Array, ...]:
        """See Draw."""
        count, found = self._side_uniforms, list[Array]()
        for side in range(len(self.sides)):
            full, *others = uniforms[side * count : (side + 1) * count]
            least, most = self.fill
            index = centred(self.pattern.drawn(others))
            scale = (least + (most - least) * full) / self.limits.used(index)
            found += [scale * own for own in index]
        return tuple(found)

    def mean(self, *, turning: bool) -> tuple[float, ...]:
        """See Draw: 0, for no tooth is special."""
        return (0.0,) * len(self.components)

    @cached_property
    def _net(self) -> Array:
        """Index deviations of one side, (NET, teeth) [mm]; the same for every study."""
        generator = np.random.Generator(np.random.Philox(key=self.teeth))
        uniforms = 1.0 - generator.random((self._side_uniforms, NET))  # in (0, 1]
        one = replace(self, sides=("",))
        return np.stack(one.deviations(*np.minimum(uniforms, 1 - 1e-12)), axis=-1)

    @cached_property
    def covariance(self) -> Array:
        """See JointDraw: by a net of patterns, to about 1 % of the variance; sides are independent."""
        seen = np.abs(np.fft.rfft(self._net, axis=1)) ** 2
        along = np.fft.irfft(seen.mean(axis=0), n=self.teeth) / self.teeth  # by how many teeth two lie apart
        apart = (np.arange(self.teeth)[:, None] - np.arange(self.teeth)) % self.teeth
        return np.kron(np.eye(len(self.sides)), along[apart])

    @property
    def sigma(self) -> float:
        """See Draw."""
        return math.sqrt(float(self.covariance[0, 0]))

    @cached_property
    def distribution(self) -> Distribution:
        """The law of one component, by the same net."""
        shares = np.linspace(0.0, 1.0, QUANTILES)
        return Piecewise(shares, np.quantile(self._net.ravel(), shares))

    def ends(self, values: Values, *, turning: bool) -> Array:
        """See Draw: the pattern along the steepest direction, and its opposite, as full as limits get."""
        step, count = self.sigma, len(self.components)
        found = values(step * np.concatenate([np.eye(count), -np.eye(count)]))
        slopes = found[:count] - found[count:]
        ends = [self._full(slopes[k * self.teeth : (k + 1) * self.teeth]) for k in range(len(self.sides))]
        end = np.concatenate(ends)
        return np.stack([end, -end])

    def _full(self, slopes: Array) -> Array:
        along = slopes - slopes.mean()
        used = float(self.limits.used([np.array([value]) for value in along])[0])
        return along * (self.fill[1] / used) if used > 0.0 else np.zeros(self.teeth)


@dataclass(frozen=True, eq=False)
class GivenDraw:
    """Deviations of an actual gear, such as a measured one: the same in every trial.

    Args:
        names: of the components.
        given: each of them [mm].
        whence: their source, in words.
    """

    names: tuple[str, ...]
    given: tuple[float, ...]
    whence: str = "given"

    uniforms = 0
    groups: ClassVar[tuple[Group, ...]] = ()
    sigma = 0.0

    @property
    def words(self) -> str:
        """See JointDraw."""
        return f"{self.whence}, each of {len(self.names)}"

    @property
    def components(self) -> tuple[str, ...]:
        """The names."""
        return self.names

    @property
    def covariance(self) -> Array:
        """See JointDraw: none."""
        return np.zeros((len(self.names), len(self.names)))

    @property
    def distribution(self) -> Distribution:
        """Distribution of the given values, as a sample."""
        return Piecewise(np.linspace(0.0, 1.0, 2 * len(self.given)), np.sort(np.array([*self.given, *self.given])))

    def deviations(self, *uniforms: Array) -> tuple[Array, ...]:
        """See Draw: of every trial."""
        return tuple(np.asarray(value) for value in self.given)

    def mean(self, *, turning: bool) -> tuple[float, ...]:
        """See Draw."""
        return self.given

    def ends(self, values: Values, *, turning: bool) -> Array:
        """See Draw: both where they are."""
        return np.array([self.given, self.given])


def centred(values: Sequence[Array]) -> list[Array]:
    """Values (trials,) less their mean in each trial, added up one after the other: the same bits for any trials."""
    total = values[0]
    for value in values[1:]:
        total = total + value
    return [value - total / len(values) for value in values]


def tooth_names(teeth: int, sides: Sequence[str]) -> tuple[str, ...]:
    """Names of components by side and tooth.

    >>> tooth_names(2, ("right", "left"))
    ('right 0', 'right 1', 'left 0', 'left 1')
    """
    width = len(str(teeth - 1))
    return tuple(f"{side} {tooth:0{width}d}".strip() for side in sides for tooth in range(teeth))
