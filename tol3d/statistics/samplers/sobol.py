"""Sobol' points, scrambled: far more even than random ones in few dimensions at a time.

In Gray-code order point i is the XOR of the points 2^k over the bits k of i, so that scipy need be asked for those
alone and any point is as near as the first. Every replicate has a scramble of its own, keyed for each stream.
Sources: Joe and Kuo, Constructing Sobol sequences with better two-dimensional projections, SIAM J. Sci. Comput. 30
(2008); Matousek, On the L2-discrepancy for anchored boxes, J. Complexity 14 (1998).
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy

from tol3d.numerics.arrays import Array
from tol3d.statistics.samplers.monte_carlo import DRAW_BITS, Words, inside_unit, random_words
from tol3d.statistics.samplers.replicates import Piece, pieces
from tol3d.statistics.samplers.stream import Counts, Stream, one_by_one

SCIPY_BITS = 32  # of scipy's points: exact for the first 2^32; its fast_forward fails with more (seen in 1.17)
TABLE_BITS = 12  # a table of 2^12 points, 32 kB, serves the low bits of the index
TABLES_KEPT = 512  # 16 MB; streams times the replicates that one block meets
ALL_DIGITS = 2**DRAW_BITS - 1


@dataclass(frozen=True)
class Sobol:
    """Scrambled Sobol' points: left matrix scramble and digital shift.

    Within a replicate the streams are not independent of each other, and a stream's place among the others matters.

    Args:
        seed: of the scrambles.
        size: points of a replicate; a power of two is what they are even in.
        dimensions: number of streams.
    """

    seed: int
    size: int
    dimensions: int

    def uniforms(self, stream: Stream, first: int, count: int) -> Array:
        """Uniforms of trials first ... first + count - 1, shape (count,), inside (0, 1)."""
        parts = [self._points(stream, piece) for piece in pieces(self.size, first, count)]
        return inside_unit(np.concatenate([np.empty(0, dtype=np.uint64), *parts]))

    def uniforms_of(self, stream: Stream, trials: Counts) -> Array:
        """Uniforms of these trials (trials,), wherever they are."""
        return one_by_one(self, stream, trials)

    def _points(self, stream: Stream, piece: Piece) -> Words:
        return _scrambled(self, stream, piece.replicate).points(piece.index, piece.count)


@dataclass(frozen=True, eq=False)
class LinearPoints:
    """Points that are XOR-linear in their index, but for a shift.

    Args:
        jumps: (bits,) points 2^0, 2^1, 2^2 ... without the shift, as integers of DRAW_BITS binary digits.
        shift: point 0.
        table: (2^b,) the first points, without the shift.
    """

    jumps: Words
    shift: int
    table: Words

    @classmethod
    def of(cls, jumps: Words, shift: int = 0) -> "LinearPoints":
        """Points with a table for the low bits of the index, doubled from point 0 on."""
        table = np.zeros(1, dtype=np.uint64)
        for jump in jumps[:TABLE_BITS]:
            table = np.concatenate([table, table ^ jump])
        return cls(jumps, shift, table)

    def points(self, first: int, count: int) -> Words:
        """Points first ... first + count - 1, shape (count,)."""
        found = np.empty(count, dtype=np.uint64)
        for page in pieces(len(self.table), first, count):
            start = page.replicate * len(self.table) + page.index - first
            low = self.table[page.index : page.index + page.count]
            np.bitwise_xor(low, self._page_start(page.replicate), out=found[start : start + page.count])
        return found

    def _page_start(self, page: int) -> np.uint64:
        start = self.shift
        for jump in self.jumps[TABLE_BITS:]:
            start ^= int(jump) if page & 1 else 0
            page >>= 1
        return np.uint64(start)


@lru_cache(maxsize=TABLES_KEPT)
def _scrambled(sampler: Sobol, stream: Stream, replicate: int) -> LinearPoints:
    jumps = plain_jumps(sampler.dimensions, max(1, (sampler.size - 1).bit_length()))[:, stream.dimension]
    words = random_words(DRAW_BITS + 1, sampler.seed, stream.name, stream.component, "sobol", str(replicate))
    return LinearPoints.of(matrix_scrambled(jumps, words[:DRAW_BITS]), int(words[DRAW_BITS]) & ALL_DIGITS)


@lru_cache(maxsize=4)
def plain_jumps(dimensions: int, bits: int) -> Words:
    """Sobol' points 2^0 ... 2^(bits - 1), unscrambled, (bits, dimensions), as integers of DRAW_BITS binary digits."""
    engine = scipy.stats.qmc.Sobol(dimensions, scramble=False, bits=SCIPY_BITS)
    points = np.empty((bits, dimensions))
    reached = 0
    for k in range(bits):
        engine.fast_forward(2**k - reached)
        points[k] = engine.random(1)[0]
        reached = 2**k + 1
    return (points * 2.0**DRAW_BITS).astype(np.uint64)


def matrix_scrambled(jumps: Words, words: Words) -> Words:
    """Points times a random lower triangular binary matrix with ones on its diagonal: Matousek's linear scramble.

    Each binary digit becomes the sum modulo 2 of itself and of random ones among those that stand before it.

    Args:
        jumps: (n,) integers of DRAW_BITS digits.
        words: (DRAW_BITS,) random words; word p chooses for the digit of value 2^p.
    """
    value = np.uint64(1) << np.arange(DRAW_BITS, dtype=np.uint64)
    before = np.uint64(ALL_DIGITS) & ~((value << np.uint64(1)) - np.uint64(1))
    digits = _parity(((words & before) | value) & jumps[:, None])
    scrambled: Words = np.bitwise_or.reduce(digits << np.arange(DRAW_BITS, dtype=np.uint64), axis=1)
    return scrambled


def _parity(words: Words) -> Words:
    """1 where a word has an odd number of ones, else 0."""
    for half in (32, 16, 8, 4, 2, 1):
        words = words ^ (words >> np.uint64(half))
    return words & np.uint64(1)
