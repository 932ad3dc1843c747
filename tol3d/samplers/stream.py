"""A stream: one uniform a trial, and what every sampler offers for it."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Stream:
    """One uniform of every trial: a component of a contributor, or a position of the system.

    Args:
        name: of the contributor, or of what has the position.
        component: which of its uniforms.
        dimension: its place among all streams of the model, from 0.
    """

    name: str
    component: str
    dimension: int


class Sampler(Protocol):
    """Draws uniforms; a value depends on the sampler's own fields, the stream and the trial, never on the block."""

    def uniforms(self, stream: Stream, first: int, count: int) -> Array:
        """Uniforms of trials first ... first + count - 1, shape (count,), inside (0, 1)."""
        ...
