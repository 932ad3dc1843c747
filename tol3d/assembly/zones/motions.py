"""The domain of the motion of a pattern: |shift| + |turn| <= 1, a turn as the way of what it moves farthest."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import betaincinv, gammainc, gammaincinv
from typing_extensions import override

from tol3d.assembly.zones.cross_section import SIGMAS
from tol3d.assembly.zones.inverse import NODES, WEIGHTS
from tol3d.assembly.zones.zone import Domain, Ratio, UnitLaw
from tol3d.numerics.arrays import Array
from tol3d.study.system.normals import Group, scalars

KEPT = 0.5 * SIGMAS**2  # half the square of the largest length, in sigmas
OFF = 1e-9  # of the largest shift, over which a density is not integrated: there it has a pole of no mass


@dataclass(frozen=True)
class Motions(Domain):
    """Coordinates: the shift, then the turn times its lever, each a vector of up to three.

    Args:
        shifts: directions in which the pattern may shift, 1 to 3.
        turns: directions about which it may turn, 0 to 3.
    """

    shifts: int
    turns: int

    @property
    def coordinates(self) -> int:
        """Number of both."""
        return self.shifts + self.turns

    @property
    def uniform(self) -> UnitLaw:
        return UniformMotions(self.shifts, self.turns)

    @property
    def normal(self) -> UnitLaw:
        return NormalMotions(self.shifts, self.turns)

    def furthest(self, gradient: Array, half: float, orientation_half: float) -> Array:
        """See Domain: all shift or all turn."""
        shift, turn = gradient[: self.shifts], gradient[self.shifts :]
        sizes = math.hypot(*shift), math.hypot(*turn)
        along = shift / (sizes[0] or 1.0), turn / (sizes[1] or 1.0)
        if max(sizes) == 0.0:
            return np.asarray(half * np.eye(1, self.coordinates)[0])
        kept = (1.0, 0.0) if sizes[0] >= sizes[1] else (0.0, 1.0)
        return np.asarray(half * np.concatenate([part * own for part, own in zip(kept, along, strict=True)]))

    def excess(self, coordinates: Array, half: Ratio, orientation_half: Ratio) -> Array:
        squares = coordinates * coordinates
        lengths = (np.sqrt(own.sum(axis=1)) for own in (squares[:, : self.shifts], squares[:, self.shifts :]))
        return np.asarray(sum(lengths) - half)


@dataclass(frozen=True)
class LawOfMotions(UnitLaw):
    """Both lengths, each in a uniform direction."""

    shifts: int
    turns: int

    @property
    def uniforms(self) -> int:
        """One a coordinate."""
        return self.shifts + self.turns

    @override
    def groups(self, ratio: Ratio) -> tuple[Group, ...]:
        return (*_group(self.shifts, 0), *_group(self.turns, self.shifts))

    def coordinates(self, ratio: Ratio, *uniforms: Array) -> tuple[Array, ...]:
        """See UnitLaw: the length of each, then its direction; a length alone has both signs."""
        of_shift, of_turn = uniforms[: self.shifts], uniforms[self.shifts :]
        shift = self.shift(_tail(of_shift))
        found = _directed(shift, of_shift)
        if self.turns:
            found += _directed(self.turn(np.maximum(1.0 - shift, 0.0), _tail(of_turn)), of_turn)
        return found

    def shift(self, share: Array) -> Array:
        """Length of the shift (trials,), of the share of trials with a smaller one."""
        raise NotImplementedError

    def turn(self, room: Array, share: Array) -> Array:
        """Length of the turn (trials,) within a room (trials,) likewise."""
        raise NotImplementedError

    def squares(self) -> tuple[float, float]:
        """Mean squares of both lengths."""
        raise NotImplementedError

    def covariance(self, ratio: float) -> Array:
        """See UnitLaw: no direction is special, and none goes with another."""
        shift, turn = self.squares()
        return np.diag([shift / self.shifts] * self.shifts + [turn / max(self.turns, 1)] * self.turns)


@dataclass(frozen=True)
class UniformMotions(LawOfMotions):
    """Uniform: the shift's length by a beta distribution, proportional to s^(a-1) (1 - s)^b of a shifts and b turns."""

    def shift(self, share: Array) -> Array:
        return np.asarray(betaincinv(self.shifts, self.turns + 1.0, share))

    def turn(self, room: Array, share: Array) -> Array:
        return np.asarray(room * share ** (1.0 / self.turns))

    def squares(self) -> tuple[float, float]:
        a, b = self.shifts, self.turns
        whole = (a + b + 1.0) * (a + b + 2.0)
        return a * (a + 1.0) / whole, b * (b + 1.0) / whole


@dataclass(frozen=True)
class NormalMotions(LawOfMotions):
    """Normal: each coordinate has sigma 1/3; the shift first, cut off at 1, then the turn in what it leaves."""

    def shift(self, share: Array) -> Array:
        return _cut_length(self.shifts, np.ones_like(share), share)

    def turn(self, room: Array, share: Array) -> Array:
        return _cut_length(self.turns, room, share)

    def squares(self) -> tuple[float, float]:
        """See LawOfMotions: of the turn by Gauss-Legendre over the shift."""
        shift = float(_cut_square(self.shifts, np.ones(1))[0])
        if not self.turns:
            return shift, 0.0
        mass = WEIGHTS * NODES ** (self.shifts - 1.0) * np.exp(-KEPT * NODES**2)
        room = np.maximum(1.0 - NODES, OFF)
        return shift, float(mass @ _cut_square(self.turns, room) / mass.sum())


def _cut_length(count: int, limit: Array, share: Array) -> Array:
    """Length of so many normals of sigma 1/3, truncated at limits (trials,), of shares (trials,) with a smaller one."""
    half = 0.5 * count
    below = share * gammainc(half, KEPT * limit * limit)
    return np.asarray(np.minimum(np.sqrt(gammaincinv(half, below) / KEPT), limit))


def _cut_square(count: int, limit: Array) -> Array:
    """Mean square of that length."""
    half, square = 0.5 * count, KEPT * limit * limit
    return np.asarray(half * gammainc(half + 1.0, square) / gammainc(half, square) / KEPT)


def _group(count: int, first: int) -> tuple[Group, ...]:
    if count < 2:
        return scalars(count, first)
    return (Group("plane" if count == 2 else "space", tuple(range(first, first + count))),)


def _tail(uniforms: tuple[Array, ...]) -> Array:
    """The share of trials with a smaller length; of one coordinate, which has both signs, by both tails."""
    return np.abs(2.0 * uniforms[0] - 1.0) if len(uniforms) == 1 else uniforms[0]


def _directed(length: Array, uniforms: tuple[Array, ...]) -> tuple[Array, ...]:
    """Coordinates of a length by the uniforms of its direction: a sign, an angle, or azimuth and height."""
    if len(uniforms) == 1:
        return (np.copysign(length, uniforms[0] - 0.5),)
    angle = 2.0 * math.pi * uniforms[1]
    if len(uniforms) == 2:
        return length * np.cos(angle), length * np.sin(angle)
    z = 2.0 * uniforms[2] - 1.0
    across = length * np.sqrt(1.0 - z * z)
    return across * np.cos(angle), across * np.sin(angle), length * z
