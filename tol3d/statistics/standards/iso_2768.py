"""ISO 2768-1: general tolerances of linear sizes and of broken edges, by the class f, m, c or v of a drawing."""

from collections.abc import Mapping
from typing import Final

from tol3d.errors import InputError

SIZES: Final = (3.0, 6.0, 30.0, 120.0, 400.0, 1000.0, 2000.0, 4000.0)
"""Upper ends of the ranges [mm]; the first begins at 0.5 mm."""
LEAST_SIZE: Final = 0.5  # mm; under it the standard wants the deviations beside the size
LINEAR: Final[Mapping[str, tuple[float | None, ...]]] = {
    "f": (0.05, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, None),
    "m": (0.1, 0.1, 0.2, 0.3, 0.5, 0.8, 1.2, 2.0),
    "c": (0.2, 0.3, 0.5, 0.8, 1.2, 2.0, 3.0, 4.0),
    "v": (None, 0.5, 1.0, 1.5, 2.5, 4.0, 6.0, 8.0),
}
"""Table 1: plus and minus [mm]; None where the standard has none."""
EDGE_SIZES: Final = (3.0, 6.0)
"""Upper ends of the ranges of radii and chamfers [mm]; a third one has no end."""
EDGES: Final[Mapping[str, tuple[float, float, float]]] = {
    "f": (0.2, 0.5, 1.0),
    "m": (0.2, 0.5, 1.0),
    "c": (0.4, 1.0, 2.0),
    "v": (0.4, 1.0, 2.0),
}
"""Table 2: plus and minus of radii and chamfers [mm]."""

LEGS: Final = (10.0, 50.0, 120.0, 400.0)
"""Upper ends of the ranges of the shorter leg of an angle [mm]; a fifth one has no end."""
ANGLES: Final[Mapping[str, tuple[float, ...]]] = {
    "f": (60.0, 30.0, 20.0, 10.0, 5.0),
    "m": (60.0, 30.0, 20.0, 10.0, 5.0),
    "c": (90.0, 60.0, 30.0, 15.0, 10.0),
    "v": (180.0, 120.0, 60.0, 30.0, 20.0),
}
"""Table 3: plus and minus of angles [minutes]."""


def classes(text: str) -> tuple[str, str]:
    """Class of sizes and class of form and position of a title block: m and K of `mK`, m and "" of `m`.

    Raises:
        InputError: no such classes; the text says what to write.
    """
    words = text.removeprefix("ISO 2768").lstrip(" -").strip()
    if words.startswith("ISO 22081") or words.startswith("22081"):
        raise InputError(
            f"expected classes of ISO 2768 such as mK, got {text!r}; write a profile of ISO 22081 as zones"
        )
    if not 1 <= len(words) <= 2 or words[0] not in LINEAR or words[1:] not in ("", "H", "K", "L"):
        raise InputError(f"expected classes of ISO 2768 such as m or mK, got {text!r}")
    return words[0], words[1:]


def linear(tolerance_class: str, size: float) -> float:
    """Plus and minus [mm] of a linear size [mm] without a tolerance of its own.

    >>> linear("m", 60.0)
    0.3

    Raises:
        InputError: no such class, or it has no value for the size; the text gives the allowed ones.
    """
    _refuse_class(tolerance_class)
    _refuse_small(size)
    if size > SIZES[-1]:
        raise InputError(f"expected a size up to {SIZES[-1]:g} mm, got {size:g} mm; ISO 2768-1 has none above")
    found = LINEAR[tolerance_class][next(k for k, end in enumerate(SIZES) if size <= end)]
    if found is None:
        words = f"expected a class that ISO 2768-1 has for {size:g} mm, got {tolerance_class!r}"
        raise InputError(f"{words}; write the limits, or {'f, m or c' if tolerance_class == 'v' else 'm, c or v'}")
    return found


def broken_edge(tolerance_class: str, size: float) -> float:
    """Plus and minus [mm] of an external radius or a chamfer's height [mm].

    Raises:
        InputError: no such class, or a size under 0.5 mm.
    """
    _refuse_class(tolerance_class)
    _refuse_small(size)
    return EDGES[tolerance_class][sum(size > end for end in EDGE_SIZES)]


def angular(tolerance_class: str, leg: float) -> float:
    """Plus and minus [deg] of an angle without a tolerance of its own, by the length of its shorter leg [mm].

    >>> angular("m", 60.0) * 60  # minutes
    20.0

    Raises:
        InputError: no such class.
    """
    _refuse_class(tolerance_class)
    return ANGLES[tolerance_class][sum(leg > end for end in LEGS)] / 60


def _refuse_class(tolerance_class: str) -> None:
    if tolerance_class in LINEAR:
        return
    if len(tolerance_class) == 2 and tolerance_class[0] in LINEAR and tolerance_class[1] in "HKL":
        words = f"expected a class of ISO 2768-1 alone, got {tolerance_class!r}; write {tolerance_class[0]!r}"
        raise InputError(f"{words}, for {tolerance_class[1]} is of part 2: form and position, not sizes")
    raise InputError(f"expected a class f, m, c or v of ISO 2768-1, got {tolerance_class!r}")


def _refuse_small(size: float) -> None:
    if not size >= LEAST_SIZE:
        raise InputError(f"expected a size of at least 0.5 mm, got {size:g} mm; write its limits, as ISO 2768-1 asks")
