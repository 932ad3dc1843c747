"""Monte Carlo: a uniform depends on (seed, name, component, trial index) and on nothing else.

Not on the number of trials, on blocks or workers, nor on the other streams.
"""

import hashlib
import unicodedata
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tol3d.numerics.arrays import Array
from tol3d.statistics.samplers.stream import Counts, Stream, one_by_one

Words = NDArray[np.uint64]

WORDS_PER_COUNTER = 4  # Philox4x64 makes four 64-bit words for each counter value; a trial uses the first
DRAW_BITS = 52  # k + 1/2 of a 53-bit k would not be a double, and the largest k would round to u = 1


@dataclass(frozen=True)
class MonteCarlo:
    """Independent uniforms."""

    seed: int

    def uniforms(self, stream: Stream, first: int, count: int) -> Array:
        """Uniforms of trials first ... first + count - 1, shape (count,), inside (0, 1)."""
        return uniforms(self.seed, stream.name, stream.component, first, count)

    def uniforms_of(self, stream: Stream, trials: Counts) -> Array:
        """Uniforms of these trials (trials,), wherever they are."""
        return one_by_one(self, stream, trials)


def stream_key(seed: int, name: str, *identity: str) -> int:
    """Philox key of one stream: the first 128 bits of SHA-256 over seed, NFC name and the rest of its identity."""
    text = "\0".join((str(seed), unicodedata.normalize("NFC", name), *identity))
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:16], "little")


def uniforms(seed: int, name: str, component: str, first: int, count: int) -> Array:
    """Uniforms of trials first ... first + count - 1, shape (count,), inside (0, 1).

    Counter value i serves trial i: k is the upper 52 bits of its first word.
    Source of the generator: Salmon et al., Parallel random numbers: as easy as 1, 2, 3 (SC 2011).
    """
    generator = np.random.Philox(key=stream_key(seed, name, component), counter=first)
    words = np.asarray(generator.random_raw(WORDS_PER_COUNTER * count)[::WORDS_PER_COUNTER], dtype=np.uint64)
    return inside_unit(words >> np.uint64(64 - DRAW_BITS))


def inside_unit(integers: Words) -> Array:
    """u = (k + 1/2) 2^-52 of 52-bit integers k."""
    return (integers.astype(np.float64) + 0.5) * 2.0**-DRAW_BITS


def random_words(count: int, seed: int, name: str, *identity: str) -> Words:
    """Random 64-bit words, keyed."""
    words = np.random.Philox(key=stream_key(seed, name, *identity)).random_raw(count)
    return np.asarray(words, dtype=np.uint64)
