"""Draws that read other contributors of the same trial, such as a zone that a size widens.

They are drawn after those; their uniforms stay their own, so that a trial is a pure function of its index.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.study.system.draw import Draw
from tol3d.study.system.faults import UnfitError
from tol3d.study.system.remembered import Remembered

Given = Mapping[str, Array]
"""Components (components, trials) [mm, rad or K] of the contributors that a draw reads, by their names."""


class Named(Protocol):
    """The part of a contributor on which the order of drawing depends."""

    @property
    def name(self) -> str:
        """See Contributor."""
        ...

    @property
    def draw(self) -> Draw:
        """See Contributor."""
        ...


@dataclass(frozen=True, eq=False)
class DrawnAs:
    """A contributor by its name, and how it is drawn: as its system says, or by another tolerance."""

    name: str
    draw: Draw


Own = TypeVar("Own", bound=Named)


@runtime_checkable
class Dependent(Protocol, metaclass=Remembered):
    """A Draw that reads contributors drawn before it; studies ask `deviations_given` of it, not `deviations`.

    `mean`, `sigma`, `ends` and a covariance are over all that those contributors may be.
    """

    @property
    def reads(self) -> tuple[str, ...]:
        """Names of the contributors whose deviations it reads."""
        ...

    def deviations_given(self, given: Given, *uniforms: Array) -> tuple[Array, ...]:
        """See Draw.deviations; each trial by the contributors that it reads."""
        ...

    def furthest_given(self, given: Given, slopes: Array) -> Array:
        """The components (components,) of a draw that lies furthest along slopes (components,), of one trial."""
        ...


@runtime_checkable
class DependentlyJudged(Protocol, metaclass=Remembered):
    """A Draw that a drawing judges by other contributors of the same trial, and does not confine."""

    @property
    def reads(self) -> tuple[str, ...]:
        """Names of the contributors by which it is judged."""
        ...

    def beyond_given(self, given: Given, *components: Array) -> NDArray[np.bool_]:
        """See Judged.beyond."""
        ...


def reads_of(contributor: Named) -> tuple[str, ...]:
    """Names of the contributors that one reads; of most none."""
    draw = contributor.draw
    return draw.reads if isinstance(draw, Dependent) else ()


def in_draw_order(contributors: Sequence[Own]) -> tuple[Own, ...]:
    """Contributors so that each comes after those that it reads; else in the order given.

    Raises:
        UnfitError: one reads an unknown contributor, or contributors read each other in a ring.
    """
    if not any(reads_of(contributor) for contributor in contributors):
        return tuple(contributors)
    waiting = {contributor.name: contributor for contributor in contributors}
    for own in contributors:
        if unknown := [name for name in reads_of(own) if name not in waiting]:
            raise UnfitError(f"contributor {own.name!r} reads {unknown[0]!r}, which is no contributor")
    ordered: list[Own] = []
    while waiting:
        ready = {name: own for name, own in waiting.items() if not any(read in waiting for read in reads_of(own))}
        if not ready:
            raise UnfitError(f"contributors read each other in a ring: {', '.join(map(repr, waiting))}")
        ordered += ready.values()
        waiting = {name: own for name, own in waiting.items() if name not in ready}
    return tuple(ordered)
