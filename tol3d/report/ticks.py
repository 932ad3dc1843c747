"""Ticks of axes: even steps of numbers, of angles and of powers of ten, with their words."""

import math
from typing import Final

import numpy as np

MINUTES = 60  # of a degree
ANGLE_STEPS: Final = (0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 20, 30, 60, 120, 300, 600, 900, 1800, 3600)  # arc seconds
STEPS: Final = (1.0, 2.0, 2.5, 5.0, 10.0)  # times a power of ten
MOST_TICKS: Final = 9
Ticks = list[tuple[float, str]]


def ticks_of(low: float, high: float, unit: str, most: int) -> Ticks:
    """Values within a span at even steps, `most` intervals at most, with their words.

    >>> ticks_of(0.03, 0.47, "um", 5), ticks_of(-1.2, 61.0, "um", 3)
    ([(0.1, '0.1'), (0.2, '0.2'), (0.3, '0.3'), (0.4, '0.4')], [(0.0, '0'), (25.0, '25'), (50.0, '50')])
    >>> ticks_of(0.9, 2.2, "arcmin", 1)
    [(1.0, '1′00″'), (1.5, '1′30″'), (2.0, '2′00″')]
    """
    seconds = angle_step(low, high, most + 2) if unit == "arcmin" else None
    step = seconds / 60 if seconds else even_step((high - low) / most)
    values = step * np.arange(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)
    if unit == "arcmin":
        return [(float(value), minutes_seconds(float(value))) for value in values]
    digits = max(0, -math.floor(math.log10(step) + 1e-9))
    digits += bool(round(step * 10**digits, 6) % 1)
    return [(float(own), f"{own + 0.0:.{digits}f}".replace("-", "−")) for own in np.round(values, digits)]


def even_step(least: float) -> float:
    """The least of 1, 2, 2.5 and 5 times a power of ten that is not less.

    >>> even_step(0.03), even_step(2.2), even_step(500.0)
    (0.05, 2.5, 500.0)
    """
    power = 10.0 ** math.floor(math.log10(least))
    return next(own for own in (power * step for step in STEPS) if own >= least * (1 - 1e-9))


def decades(low: float, high: float) -> Ticks:
    """Powers of ten within a span, with their words; of less than a decade its ends.

    >>> decades(8.0, 2000.0), decades(20.0, 70.0)
    ([(10.0, '10'), (100.0, '100'), (1000.0, '1 000')], [(20.0, '20'), (70.0, '70')])
    """
    powers = range(math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9) + 1)
    numbers = [10.0**power for power in powers] if len(powers) > 1 else [low, high]
    return [(number, f"{number:,.10g}".replace(",", " ")) for number in dict.fromkeys(numbers)]


def angle_step(low: float, high: float, most: int = MOST_TICKS) -> float | None:
    """The step [arc seconds] between `most` ticks of an axis in arc minutes; None where it is too long for one."""
    return next((step for step in ANGLE_STEPS if (high - low) * 60 <= most * step), None)


def minutes_seconds(arcmin: float) -> str:
    """The words of a tick in minutes and seconds, to a tenth of a second.

    >>> minutes_seconds(-1.5), minutes_seconds(61.0)
    ('−1′30″', '1°01′')
    """
    tenths = round(abs(arcmin) * 600)
    minutes, rest = divmod(tenths, 600)
    seconds = f"{rest / 10:.1f}″" if rest % 10 else f"{rest // 10}″"
    sign = "−" if arcmin < 0 and tenths else ""
    if minutes >= MINUTES:
        degrees = f"{sign}{minutes // MINUTES}°{minutes % MINUTES:02}′"
        return degrees + f"{'0' * (rest < 100)}{seconds}" if rest else degrees
    return f"{sign}{minutes}′{'0' * (rest < 100)}{seconds}" if minutes else f"{sign}{seconds}"
