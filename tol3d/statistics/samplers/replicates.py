"""Replicates: a sample cut into parts of equal size, each randomised anew, so that their spread gives the error."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal

SamplerKind = Literal["monte_carlo", "sobol", "latin_hypercube"]

REPLICATES: Final = 16  # if not stated: they give a standard error to 1 / sqrt(2 (16 - 1)), 18 %
MOST_SOBOL_POINTS: Final = 2**31  # of a replicate; scipy's points begin anew at 2^32


@dataclass(frozen=True)
class Piece:
    """Consecutive points of one replicate: `count` from its point `index` on."""

    replicate: int
    index: int
    count: int


def pieces(size: int, first: int, count: int) -> Iterator[Piece]:
    """Trials first ... first + count - 1 by replicates of `size` points: trial k is point k % size of k // size.

    >>> [(p.replicate, p.index, p.count) for p in pieces(8, 6, 12)]
    [(0, 6, 2), (1, 0, 8), (2, 0, 2)]
    """
    end = first + count
    while first < end:
        replicate, index = divmod(first, size)
        taken = min(size - index, end - first)
        yield Piece(replicate, index, taken)
        first += taken


def uneven(sampler: SamplerKind, trials: int, replicates: int) -> str:
    """Suitable number of trials, for messages; nothing where the given one can be drawn in such replicates.

    >>> uneven("sobol", 2000, 12), uneven("sobol", 5, 16), uneven("sobol", 2000, 16)
    ('a multiple of the 12 replicates, such as 1992 or 2004', 'a multiple of the 16 replicates, such as 16', '')
    """
    if sampler == "sobol" and trials > MOST_SOBOL_POINTS * replicates:
        return f"at most {MOST_SOBOL_POINTS * replicates} for {replicates} replicates of Sobol' points"
    below = trials // replicates * replicates
    if below == trials:
        return ""
    near = f"{below} or {below + replicates}" if below else f"{replicates}"
    return f"a multiple of the {replicates} replicates, such as {near}"


def balanced_trials(trials: int, replicates: int) -> str:
    """The numbers of trials next to one whose replicates hold no power of two points, for messages.

    >>> balanced_trials(2000, 16)
    '1024 (16 replicates of 64) or 2048 (16 of 128)'
    """
    below = 1 << ((trials // replicates).bit_length() - 1)
    return (
        f"{replicates * below} ({replicates} replicates of {below}) or "
        f"{2 * replicates * below} ({replicates} of {2 * below})"
    )


def is_power_of_two(number: int) -> bool:
    """True if a number of points is a power of two, at which Sobol' points are even.

    >>> [n for n in range(1, 20) if is_power_of_two(n)]
    [1, 2, 4, 8, 16]
    """
    return number & (number - 1) == 0
