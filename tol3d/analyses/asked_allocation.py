"""Input of an allocation by the user: measures with their limits, bounds of factors, limits that stay."""

from collections.abc import Mapping, Sequence

from tol3d.analyses.allocation import ppm_of_ppk
from tol3d.analyses.before_after import limits_of
from tol3d.analyses.limit_state import Side
from tol3d.analyses.response import Response
from tol3d.analyses.tolerance_search import Target
from tol3d.errors import InputError
from tol3d.statistics.distributions.base import Stays
from tol3d.statistics.estimates.limits import MOST_PPK

DEFAULT_PPK = 1.33


def targets_of(response: Response, measures: Sequence[str], ppm: float | None, ppk: float | None) -> list[Target]:
    """Targets of `--measure NAME[:low|high]`, `--ppm` or `--ppk`.

    Raises:
        InputError: both, no number above 0, no such measure, or none with limits.
    """
    if ppm is not None and ppk is not None:
        raise InputError("expected --ppm or --ppk, got both")
    if ppk is not None and not 0.0 < ppk < MOST_PPK:
        raise InputError(f"--ppk: expected a number above 0 and below {MOST_PPK:g}, got {ppk:g}")
    named = [_measure(measure) for measure in measures]
    if not named:
        named = [(measure.name, ()) for measure in response.measures if limits_of(measure)]
    if not named:
        raise InputError("expected a measure with limits, got none; state lower_limit or upper_limit in the scene")
    found = []
    for name, sides in named:
        (own,) = response.of(name).measures
        if ppm is not None:
            found.append(Target(name, sides, ppm))
        else:
            each: Sequence[Side] = sides or tuple(limits_of(own))
            found += [Target(name, (side,), ppm_of_ppk(ppk or DEFAULT_PPK)) for side in each] or [Target(name, (), 1.0)]
    return found


def _measure(text: str) -> tuple[str, tuple[Side, ...]]:
    name, _, side = text.rpartition(":")
    if side.strip() == "low":
        return name.strip(), ("low",)
    if side.strip() == "high":
        return name.strip(), ("high",)
    return text, ()


def bounds_of(option: str, text: str) -> tuple[float, float]:
    """Bounds of factors, such as `0.5..3`.

    Raises:
        InputError: they are none, or do not hold 1.
    """
    low, _, high = text.partition("..")
    try:
        found = float(low), float(high)
    except ValueError:
        raise InputError(f"{option}: expected bounds of factors such as 0.5..3, got {text!r}") from None
    if not 0.0 < found[0] <= 1.0 <= found[1] < float("inf"):
        raise InputError(f"{option}: expected bounds above 0 with 1 between them, such as 0.5..3, got {text!r}")
    return found


def named_bounds(texts: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Bounds by contributor, of `--bound NAME=0.8..1.2`.

    Raises:
        InputError: see `bounds_of`.
    """
    found = {}
    for text in texts:
        name, _, value = text.rpartition("=")
        found[name.strip()] = bounds_of(f"--bound {name.strip()!r}", value)
    return found


def stays_of(texts: Sequence[str], groups: Mapping[str, Sequence[str]]) -> dict[str, Stays]:
    """Limits that stay by contributor, of `--stays NAME=low`.

    Raises:
        InputError: it is neither low nor high.
    """
    found: dict[str, Stays] = {}
    for text in texts:
        name, _, value = (own.strip() for own in text.rpartition("="))
        own: Stays | None = "low" if value == "low" else "high" if value == "high" else None
        if own is None or not name:
            raise InputError(f"--stays: expected NAME=low or NAME=high, got {text!r}")
        for each in (name, *groups.get(name, ())):
            found[each] = own
    return found
