"""A stream: one uniform a trial, and the interface of every sampler for it."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array


@dataclass(frozen=True)
class Stream:
    """One uniform of every trial: a component of a contributor, or a position of the system.

    Args:
        name: of the contributor, or of the owner of the position.
        component: which of its uniforms.
        dimension: its place among all streams of the model, from 0.
    """

    name: str
    component: str
    dimension: int


Counts = NDArray[np.int64]


class Sampler(Protocol):
    """Draws uniforms; a value depends on the sampler's own fields, the stream and the trial, never on the block."""

    def uniforms(self, stream: Stream, first: int, count: int) -> Array:
        """Uniforms of trials first ... first + count - 1, shape (count,), inside (0, 1)."""
        ...

    def uniforms_of(self, stream: Stream, trials: Counts) -> Array:
        """Uniforms of these trials (trials,), wherever they are."""
        ...


def one_by_one(sampler: Sampler, stream: Stream, trials: Counts) -> Array:
    """Uniforms of trials (trials,), each drawn alone."""
    return np.concatenate([np.empty(0), *(sampler.uniforms(stream, trial, 1) for trial in trials.tolist())])
