"""Standard normals in place of uniforms: the same draws as smooth maps, as reliability methods need them.

A draw's uniforms are scalars, or lengths with directions. A scalar u is Φ(z) of one normal; a length and an angle in a
plane come from two normals, a length and a direction of space from three, so that no direction is special and nothing
jumps where an angle begins anew. A draw that does not state its groups has no such map.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final, Literal, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammainc, ndtr

Array = NDArray[np.float64]

GroupKind = Literal["scalar", "phase", "plane", "space"]

NORMALS: Final = {"scalar": 1, "phase": 2, "plane": 2, "space": 3}
"""Number of normals that stand for the uniforms of a group."""
UNIFORMS: Final = {"scalar": 1, "phase": 1, "plane": 2, "space": 3}
LEAST: Final = np.finfo(np.float64).tiny
MOST: Final = 1.0 - 2.0**-53
"""Uniforms stay between these, for laws without limits."""


@dataclass(frozen=True)
class Group:
    """Uniforms of a draw that belong together.

    Args:
        kind: scalar; phase, an angle; plane, a length and its angle; space, a length, its azimuth and its height.
        places: of these among the draw's uniforms, in that order.
    """

    kind: GroupKind
    places: tuple[int, ...]


class Drawn(Protocol):
    """A Draw, as far as it is asked here."""

    @property
    def uniforms(self) -> int:
        """See Draw."""
        ...


class Smooth(Drawn, Protocol):
    """A Draw that states the groups of its uniforms."""

    @property
    def groups(self) -> tuple[Group, ...]:
        """All of its uniforms, each once."""
        ...


def scalars(count: int, first: int = 0) -> tuple[Group, ...]:
    """Uniforms, each by itself."""
    return tuple(Group("scalar", (first + k,)) for k in range(count))


def shifted(groups: Sequence[Group], first: int) -> tuple[Group, ...]:
    """The same of uniforms that stand behind others."""
    return tuple(Group(group.kind, tuple(first + place for place in group.places)) for group in groups)


def groups_of(draw: Drawn) -> tuple[Group, ...] | None:
    """Groups of a draw's uniforms; None if it does not state them."""
    found: tuple[Group, ...] | None = getattr(draw, "groups", None)  # isinstance of a protocol takes long
    return found


def normal_count(draw: Drawn) -> int:
    """Number of standard normals for a draw; that of its uniforms if it does not state their groups."""
    groups = groups_of(draw)
    return draw.uniforms if groups is None else sum(NORMALS[group.kind] for group in groups)


def uniforms_of(draw: Drawn, normals: Sequence[Array]) -> list[Array]:
    """The uniforms (n,) of a draw, of as many standard normals (n,) as `normal_count` says."""
    groups = groups_of(draw) or scalars(draw.uniforms)
    found: list[Array] = [np.zeros(0)] * draw.uniforms
    first = 0
    for group in groups:
        count = NORMALS[group.kind]
        for place, uniform in zip(group.places, _uniforms(group.kind, normals[first : first + count]), strict=True):
            found[place] = np.clip(uniform, LEAST, MOST)
        first += count
    return found


def _uniforms(kind: GroupKind, z: Sequence[Array]) -> Iterator[Array]:
    if kind == "scalar":
        yield ndtr(z[0])
        return
    square = sum((own * own for own in z), np.zeros(1))
    if kind == "space":
        size = np.sqrt(square)
        yield gammainc(1.5, square / 2)
        yield np.arctan2(z[1], z[0]) / (2 * math.pi) % 1.0
        yield (z[2] / np.where(size > 0.0, size, 1.0) + 1.0) / 2
        return
    if kind == "plane":
        yield -np.expm1(-square / 2)
    yield np.arctan2(z[1], z[0]) / (2 * math.pi) % 1.0
