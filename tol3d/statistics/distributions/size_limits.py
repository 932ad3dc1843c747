"""Limits of a size itself as shops type them: `23.349 / 23.386 mm` of a span, instead of deviations from nominal."""

import re
from typing import Final

from tol3d.errors import InputError
from tol3d.statistics.standards.iso_286 import Limits
from tol3d.units import FACTORS, UNITS, Quantity

NUMBER: Final = r"(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
UNIT: Final = r"[^\s\d.,+±/-][^\s,+±/-]*(?:/[^\s\d,+±/-]+)*"
SIZES: Final = re.compile(
    rf"\s*(?P<one>{NUMBER})\s*(?P<one_unit>{UNIT})?\s*(?:/|\.\.\.?|…)\s*(?P<other>{NUMBER})\s*(?P<unit>{UNIT})\s*"
)
LONGEST: Final = 100  # characters
DIGITS: Final = 12  # of a size that is computed and written: 1e-10 mm of some hundred
UM_PER_MM: Final = 1e3


def sizes_written(text: object) -> tuple[Quantity, Quantity] | None:
    """Both limits of a size in the order of the text; None of any other text.

    >>> sizes_written("23.386/23.349 mm")
    (Quantity(number=23.386, unit='mm'), Quantity(number=23.349, unit='mm'))
    >>> sizes_written("40.1 mm +0.12/0"), sizes_written("0/30 um")
    (None, None)
    """
    match = SIZES.fullmatch(text) if isinstance(text, str) and len(text) <= LONGEST else None
    if match is None:
        return None
    units = match["one_unit"] or match["unit"], match["unit"]
    numbers = float(match["one"]), float(match["other"])
    if not all(numbers) or any(UNITS.get(unit) != "length" for unit in units):
        return None
    one, other = (Quantity(number, unit) for number, unit in zip(numbers, units, strict=True))
    return one, other


def size_limits(text: str, nominal: float) -> Limits:
    """Lower and upper deviation of limits of a size from its nominal value [um].

    >>> size_limits("20.25 / 20.75 mm", 20.5)
    Limits(lower=-250.0, upper=250.0)

    Args:
        text: the limits, in either order.
        nominal: the size [mm].

    Raises:
        InputError: they are none, or both are one size.
    """
    pair = sizes_written(text)
    if pair is None:
        raise InputError(f"expected limits of a size, such as 23.349 / 23.386 mm, got {text!r}")
    lower, upper = sorted(own.internal for own in pair)
    if lower == upper:
        raise InputError(f"expected two different limits (for no spread at all write kind: constant), got {text!r}")
    return Limits((lower - nominal) * UM_PER_MM, (upper - nominal) * UM_PER_MM)


def resized(text: str, lower: float, upper: float) -> str:
    """Limits of a size in the form, order and units of others.

    >>> resized("23.386/23.349 mm", 23.35, 23.38)
    '23.38/23.35 mm'

    Args:
        text: the others.
        lower, upper: the new ones [mm].
    """
    match, pair = SIZES.fullmatch(text), sizes_written(text)
    assert match is not None
    assert pair is not None
    ends = (lower, upper) if pair[0].internal < pair[1].internal else (upper, lower)
    one, other = (_number(own.unit, end) for own, end in zip(pair, ends, strict=True))
    (start, middle), (begin, end) = match.span("one"), match.span("other")
    return f"{text[:start]}{one}{text[middle:begin]}{other}{text[end:]}"


def _number(unit: str, size: float) -> str:
    return f"{size / FACTORS['length'][unit]:.{DIGITS}g}"
