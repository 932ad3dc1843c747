"""Monte Carlo's uniforms, compiled: Philox4x64-10, one counter a trial, of which only the first word is kept.

Source: Salmon et al., Parallel random numbers: as easy as 1, 2, 3 (SC 2011). The bits are those of monte_carlo.py.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.numerics.compiled import FULL, high_product, kernel, part
from tol3d.statistics.samplers.monte_carlo import DRAW_BITS, stream_key
from tol3d.statistics.samplers.stream import Counts, Stream

MULTIPLIERS = np.uint64(0xD2E7470EE14C6C93), np.uint64(0xCA5A826395121157)
WEYL = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xBB67AE8584CAA73B)
ROUNDS = 10
LOW = np.uint64(2**64 - 1)
SHIFT = np.uint64(64 - DRAW_BITS)
STEP = 2.0**-DRAW_BITS


@dataclass(frozen=True)
class QuickMonteCarlo:
    """MonteCarlo, compiled."""

    seed: int

    def uniforms(self, stream: Stream, first: int, count: int) -> Array:
        """Uniforms of trials first ... first + count - 1, shape (count,), inside (0, 1)."""
        return quick_uniforms(self.seed, stream.name, stream.component, first, count)

    def uniforms_of(self, stream: Stream, trials: Counts) -> Array:
        """Uniforms of these trials (trials,), wherever they are."""
        values = np.empty(len(trials))
        _draw_each(_words(stream_key(self.seed, stream.name, stream.component)), trials.astype(np.uint64) + 1, values)
        return values


def quick_uniforms(seed: int, name: str, component: str, first: int, count: int) -> Array:
    """Same values as monte_carlo.uniforms, bit for bit."""
    values = np.empty(count)
    _draw(_words(stream_key(seed, name, component)), np.array([first + 1], dtype=np.uint64), values)
    return values


def _words(key: int) -> NDArray[np.uint64]:
    return np.array([key & int(LOW), key >> 64], dtype=np.uint64)


@part
def first_word(counter: Any, key: Any) -> Any:
    """The first of the four words of a counter."""
    a, b, c, d = counter, np.uint64(0), np.uint64(0), np.uint64(0)
    k, m = key[0], key[1]
    for _ in range(ROUNDS):
        high, low = high_product(MULTIPLIERS[0], a), MULTIPLIERS[0] * a
        its_high, its_low = high_product(MULTIPLIERS[1], c), MULTIPLIERS[1] * c
        a, b, c, d = its_high ^ b ^ k, its_low, high ^ d ^ m, low
        k, m = k + WEYL[0], m + WEYL[1]
    return a


@kernel(arrays="uint64[::1], uint64[::1], float64[::1]", level=FULL)
def _draw(key: Any, first: Any, values: Any) -> None:
    """Uniforms of consecutive counters from `first` on."""
    for i in range(len(values)):
        word = first_word(first[0] + np.uint64(i), key)
        values[i] = (float(word >> SHIFT) + 0.5) * STEP


@kernel(arrays="uint64[::1], uint64[::1], float64[::1]", level=FULL)
def _draw_each(key: Any, counters: Any, values: Any) -> None:
    """Uniforms of counters wherever they are."""
    for i in range(len(values)):
        values[i] = (float(first_word(counters[i], key) >> SHIFT) + 0.5) * STEP
