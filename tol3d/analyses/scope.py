"""Scope of a tolerance: the factors by which it can be scaled, and the reasons why no others."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from tol3d.errors import InputError

LEAST, MOST = 1e-3, 1e3
"""Factors between which is looked."""
HALVINGS: Final = 40
"""Halvings of the logarithm of a factor: to 1e-11."""
BEYOND: Final = 1.1
"""Factor beyond an end at which the reason is asked for: at the end itself it would speak of rounding."""


@dataclass(frozen=True)
class Scope:
    """Factors on a tolerance that a response accepts.

    Args:
        factors: the least and the largest; None where the tolerance cannot be scaled at all.
        below: why none is less; "" where none down to 0.001 is refused.
        above: why none is larger; "" where none up to 1000 is refused.
    """

    factors: tuple[float, float] | None
    below: str = ""
    above: str = ""

    def __contains__(self, factor: float) -> bool:
        return self.factors is not None and self.factors[0] <= factor <= self.factors[1]

    def __str__(self) -> str:
        if self.factors is None:
            return f"cannot be scaled: {self.above}"
        ends = zip(self.factors, (self.below, self.above), strict=True)
        return " to ".join(f"{factor:.6g}" + (f" ({why})" if why else "") for factor, why in ends)


def scope_of(scale: Callable[[float], object]) -> Scope:
    """The scope of a tolerance.

    Args:
        scale: scales it by a factor, or raises an InputError; what it accepts lies around 1 without gaps.
    """
    if reason := _refusal(scale, 1.0):
        return Scope(None, reason, reason)
    (low, below), (high, above) = (_end(scale, farthest) for farthest in (LEAST, MOST))
    return Scope((low, high), below, above)


def _end(scale: Callable[[float], object], farthest: float) -> tuple[float, str]:
    """The last factor that is accepted on the way to the farthest one, and why the next is not."""
    reason = _refusal(scale, farthest)
    if not reason:
        return farthest, ""
    good, bad = 1.0, farthest
    for _ in range(HALVINGS):
        middle = math.sqrt(good * bad)
        good, bad = (good, middle) if _refusal(scale, middle) else (middle, bad)
    return good, _refusal(scale, bad * (BEYOND if farthest > 1.0 else 1.0 / BEYOND)) or reason


def _refusal(scale: Callable[[float], object], factor: float) -> str:
    try:
        scale(factor)
    except InputError as error:
        return str(error)
    return ""
