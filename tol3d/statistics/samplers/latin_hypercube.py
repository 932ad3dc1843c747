"""Latin hypercube: each stream of a replicate of n trials has one value in each n-th of (0, 1).

Which trial gets which n-th is a keyed permutation by index alone, so that no table of n entries is kept and any trial
is as near as the first. Source of the sampling: McKay, Beckman, Conover, Technometrics 21 (1979).
"""

from dataclasses import dataclass

import numpy as np

from tol3d.numerics.arrays import Array
from tol3d.statistics.samplers.monte_carlo import Words, random_words, uniforms
from tol3d.statistics.samplers.replicates import Piece, pieces
from tol3d.statistics.samplers.stream import Counts, Stream, one_by_one

ROUNDS = 8  # of the Feistel network; four are enough for large domains (Luby and Rackoff 1988), small ones need more
PLACE_BITS = 48  # stratum and place inside it together; five bits fewer than a double's, so that rounding keeps both


@dataclass(frozen=True)
class LatinHypercube:
    """One value in each of `size` strata, at random inside it; replicates and streams are permuted independently.

    Args:
        seed: of the permutations and of the places inside the strata.
        size: points of a replicate; values depend on it.
    """

    seed: int
    size: int

    def uniforms(self, stream: Stream, first: int, count: int) -> Array:
        """Uniforms of trials first ... first + count - 1, shape (count,), inside (0, 1)."""
        parts = [self._strata(stream, piece) for piece in pieces(self.size, first, count)]
        stratum = np.concatenate([np.empty(0), *parts])
        steps = 2.0 ** (PLACE_BITS - self.size.bit_length())
        inside = uniforms(self.seed, stream.name, stream.component, first, count)
        place = (np.floor(inside * steps) + 0.5) / steps
        return (stratum + place) / self.size

    def uniforms_of(self, stream: Stream, trials: Counts) -> Array:
        """Uniforms of these trials (trials,), wherever they are."""
        return one_by_one(self, stream, trials)

    def _strata(self, stream: Stream, piece: Piece) -> Array:
        identity = ("latin hypercube", str(piece.replicate), str(self.size))
        keys = random_words(ROUNDS, self.seed, stream.name, stream.component, *identity)
        index = np.arange(piece.index, piece.index + piece.count, dtype=np.uint64)
        return permuted(index, self.size, keys).astype(np.float64)


def permuted(index: Words, size: int, keys: Words) -> Words:
    """Images of indices by a keyed permutation of 0 ... size - 1, same shape.

    A Feistel network permutes the next even power of two; what falls outside goes through it again until it is inside.
    Source: Black and Rogaway, Ciphers with arbitrary finite domains (CT-RSA 2002), 4.
    """
    half_bits = max(1, ((size - 1).bit_length() + 1) // 2)
    found = _feistel(index, half_bits, keys)
    while len(outside := np.flatnonzero(found >= np.uint64(size))):
        found[outside] = _feistel(found[outside], half_bits, keys)
    return found


def _feistel(index: Words, half_bits: int, keys: Words) -> Words:
    """A balanced Feistel network on words of 2 half_bits bits, one round for each key."""
    half = np.uint64(half_bits)
    left, right = index >> half, index & ((np.uint64(1) << half) - np.uint64(1))
    for key in keys:
        left, right = right, left ^ (_mixed(right + key) >> np.uint64(64 - half_bits))
    return (left << half) | right


def _mixed(words: Words) -> Words:
    """A 64-bit hash: the finaliser of SplitMix64 (Steele, Lea, Flood, OOPSLA 2014)."""
    words = (words ^ (words >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    words = (words ^ (words >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return words ^ (words >> np.uint64(31))
