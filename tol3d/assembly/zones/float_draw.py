"""Draws of where a part with play lies in its room, as shares of the room of each trial."""

from dataclasses import dataclass
from functools import cached_property
from typing import Final, Literal, Self

import numpy as np
from typing_extensions import override

from tol3d.assembly.zones.cross_section import QUARTER_TURN, uniform_lens
from tol3d.assembly.zones.inverse import inverse
from tol3d.assembly.zones.widened import Widened
from tol3d.assembly.zones.zone_draw import ZoneDraw
from tol3d.errors import InputError
from tol3d.numerics.arrays import Array
from tol3d.statistics.distributions import Distribution, Uniform
from tol3d.study.system.dependent import Dependent, Given
from tol3d.study.system.normals import Group, scalars
from tol3d.study.system.steepest import Values

Law = Literal["disc", "interval", "room"]

SHIFT_AND_TURN: Final = ("shift x", "shift y", "shift z", "turn x", "turn y", "turn z")
"""Components of a pose of a room, but where its chain starts."""

SIZES: Final = {"disc": 2, "interval": 1, "room": 7}
"""Components of each law, and uniforms."""
SIGMAS: Final = {"disc": 0.5, "interval": 1 / np.sqrt(3.0), "room": 1 / np.sqrt(3.0)}


@dataclass(frozen=True)
class FloatDraw:
    """Numbers without unit; see model.Floating for what they mean. Implements Draw and Joint.

    Args:
        laws: a point of a disc of radius 1; of -1 to 1; a pose of a room, by a shift and a turn, each of -1 to 1, and
            where its chain starts, alike.
        components: names of all their components.
    """

    laws: tuple[Law, ...]
    components: tuple[str, ...]

    words = "uniform in the play of the trial"
    fills = True

    @property
    def distribution(self) -> Distribution:
        """Distribution of a component, as shown."""
        return Uniform(-1.0, 1.0)

    @property
    def uniforms(self) -> int:
        """One a component."""
        return len(self.components)

    @property
    def groups(self) -> tuple[Group, ...]:
        """See Smooth."""
        kinds = (
            (Group("plane", (own.start, own.start + 1)),) if law == "disc" else scalars(SIZES[law], own.start)
            for law, own in self._blocks
        )
        return tuple(group for kind in kinds for group in kind)

    @cached_property
    def _blocks(self) -> tuple[tuple[Law, slice], ...]:
        found, start = [], 0
        for law in self.laws:
            found.append((law, slice(start, start + SIZES[law])))
            start += SIZES[law]
        return tuple(found)

    @property
    def sigma(self) -> float:
        """The largest of a component."""
        return max(float(SIGMAS[law]) for law in self.laws)

    @property
    def covariance(self) -> Array:
        """See Joint: no component goes with another."""
        return np.diag([float(SIGMAS[law]) ** 2 for law in self.laws for _ in range(SIZES[law])])

    def deviations(self, *uniforms: Array) -> tuple[Array, ...]:
        """See Draw."""
        found: list[Array] = []
        for law, own in self._blocks:
            u = uniforms[own]
            if law == "disc":
                radius, angle = np.sqrt(u[0]), 2 * np.pi * u[1]
                found += [radius * np.cos(angle), radius * np.sin(angle)]
            else:
                found += [2 * own_u - 1 for own_u in u]
        return tuple(found)

    def mean(self, *, turning: bool) -> tuple[float, ...]:
        """See Draw: in the middle of the room."""
        return (0.0,) * len(self.components)

    def ends(self, values: Values, *, turning: bool) -> Array:
        """See Draw: where the room ends both ways along the steepest direction of each law."""
        count = len(self.components)
        found = values(np.concatenate([np.eye(count), -np.eye(count)]))
        slope = found[:count] - found[count:]
        along = np.zeros(count)
        for law, own in self._blocks:
            if law == "room":
                slope[own.stop - 1] = 0.0  # a start is no way
            size = float(np.sqrt(slope[own] @ slope[own]))
            along[own] = slope[own] / size if size > 0.0 else 0.0
        return np.stack([along, -along])


POINTS: Final = 16384
"""Points of a lattice over which a covariance is averaged if the datum feature tilts: to about 1e-3 of it."""
REACHED: Final = 1.0 + 1e-12
"""Radius over that of a circle: on it, but for rounding."""
PRIMES: Final = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37)


@dataclass(frozen=True)
class Leaning:
    """A contributor that tilts the datum feature against the gauge.

    Args:
        name: of the contributor.
        draw: its own.
        matrix: half the difference of the ends (2, components of the contributor), across the axis.
    """

    name: str
    draw: ZoneDraw
    matrix: tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class GaugeShift(Widened):
    """Uniform where the gauge's axis lies within c of both ends of the feature's; c = ±(size - virtual condition) / 2.

    That is a disc of diameter 2 c, which the size widens from nothing, or the lens of two discs where the feature
    leans. Where no room is left the gauge lies in the middle.

    Args:
        zone, confined, size: the disc.
        leaning: what tilts the feature.
    """

    leaning: tuple[Leaning, ...] = ()

    def sized(self, width: float) -> Self:
        """See Zoned.

        Raises:
            InputError: always.
        """
        raise InputError(f"expected a tolerance, got the room of a gauge, which {self.size.name} leaves")

    @property
    @override
    def words(self) -> str:
        return f"uniform in the clearance of its gauge, by {', '.join(self.reads)}"

    @property
    def reads(self) -> tuple[str, ...]:
        """See Dependent: the size, and what tilts."""
        return (self.size.name, *(own.name for own in self.leaning))

    @property
    def groups(self) -> tuple[Group, ...]:
        """See Smooth: of a lens along it and across."""
        return scalars(self.uniforms) if self.leaning else super().groups

    def deviations_given(self, given: Given, *uniforms: Array) -> tuple[Array, ...]:
        """See Dependent: along the half difference and across it, as the middle of an axis lies in its zone."""
        if not self.leaning:
            return super().deviations_given(given, *uniforms)
        u, v = uniforms
        clearance, (x, y), length, share = self._room(given)
        angle = np.arccos(share)
        tail = 2.0 * np.minimum(u, 1.0 - u)
        segment = np.cbrt((angle - np.sin(angle) * np.cos(angle)) * tail / QUARTER_TURN)
        inner = np.minimum(QUARTER_TURN * inverse(uniform_lens, 3)(segment), angle)
        along = np.copysign(np.cos(inner) - np.cos(angle), u - 0.5)
        across = np.sin(inner) * (2.0 * v - 1.0)
        some = np.where(length > 0.0, length, 1.0)
        a, b = np.where(length > 0.0, x, 1.0) / some, np.where(length > 0.0, y, 0.0) / some
        return clearance * (along * a - across * b), clearance * (along * b + across * a)

    def _room(self, given: Given) -> tuple[Array, Array, Array, Array]:
        """Clearance c, half difference (2, trials) and its length [mm], and that length over c, at most 1."""
        clearance = 0.5 * self.size.bonus.of(self.size.of(given))
        x, y = (sum(self._lean(given, k), np.zeros(len(clearance))) for k in (0, 1))
        length = np.hypot(x, y)
        share = np.divide(length, clearance, out=np.ones_like(length), where=clearance > 0.0)
        return clearance, np.stack([x, y]), length, np.minimum(share, 1.0)

    def _lean(self, given: Given, k: int) -> list[Array]:
        return [
            weight * values
            for own in self.leaning
            for weight, values in zip(own.matrix[k], given[own.name], strict=True)
            if weight
        ]

    @cached_property
    def covariance(self) -> Array:
        """See ZoneDraw; over all sizes and tilts."""
        if not self.leaning:
            return self.size.bonus.covariance(self.confined, self.size.law)
        count = 1 + self.uniforms + sum(own.draw.uniforms for own in self.leaning)
        steps = np.sqrt(np.array(PRIMES[:count], dtype=np.float64))
        points = iter(((np.arange(1, POINTS + 1)[:, None] * steps) % 1.0).T)
        given = {self.size.name: self.size.law.ppf(next(points))[None]}
        for own in self.leaning:
            uniforms = [next(points) for _ in range(own.draw.uniforms)]
            draw = own.draw
            found = (
                draw.deviations_given(given, *uniforms) if isinstance(draw, Dependent) else draw.deviations(*uniforms)
            )
            given[own.name] = np.stack(found)
        shifts = np.stack(self.deviations_given(given, *points))
        return np.asarray((shifts[:, None] * shifts[None]).mean(axis=2))

    def furthest_given(self, given: Given, slopes: Array) -> Array:
        """See Dependent: on one of both circles, or where they meet."""
        if not self.leaning:
            return super().furthest_given(given, slopes)
        clearance, half, length, share = self._room(given)
        c, h = float(clearance[0]), half[:, 0]
        size = float(np.hypot(*slopes))
        if c == 0.0 or float(share[0]) >= 1.0 or size == 0.0:
            return np.zeros(2)
        ahead = c * slopes / size
        found = [sign * h + ahead for sign in (-1.0, 1.0) if np.hypot(*(2.0 * sign * h + ahead)) <= c * REACHED]
        if float(length[0]) > 0.0:
            corner = np.sqrt(c * c - float(length[0]) ** 2) * np.array([-h[1], h[0]]) / float(length[0])
            found += [corner, -corner]
        return max(found, key=lambda point: float(point @ slopes))
