"""ISO 286-1: limit deviations of a size by its tolerance class, such as H7 or g6, for sizes up to 500 mm.

Formulae and rounding are those of ISO 286-1:1988, annex A (2010: annex B). The standard's tables depart from them for
historical reasons, mostly under 18 mm; where they do, the table counts, and `EXCEPTIONS` and `TABULATED_GRADES` say
so, value by value. D is the geometric mean [mm] of the range that the size lies in, `above` one limit `up to and
including` the next.
"""

import math
import re
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Final, NamedTuple

from tol3d.errors import InputError
from tol3d.statistics.standards import half_up

RANGES: Final = (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500)
"""Upper ends of the main ranges [mm]: all standard tolerances and the deviations c, d to p."""
STEPS: Final = (
    *(3, 6, 10, 14, 18, 24, 30, 40, 50, 65, 80, 100, 120),
    *(140, 160, 180, 200, 225, 250, 280, 315, 355, 400, 450, 500),
)
"""Upper ends of the intermediate ranges [mm]: the deviations a to c and r to zc."""
LARGEST_SIZE: Final = 500.0  # mm
LEAST_OF_ALL_CLASSES: Final = 1.0  # mm; a, b, N above IT8 and IT14 to IT18 begin above it

MULTIPLES: Final[Mapping[int, int]] = {5: 7, 6: 10, 7: 16, 8: 25, 9: 40, 10: 64}
"""Multiples of the tolerance unit i, by grade; a grade five higher is ten times as wide."""
TABULATED_GRADES: Final[Mapping[tuple[int, int], float]] = {
    **{(3, 6): 6, (3, 7): 10, (3, 9): 25, (3, 10): 40},
    **{(6, 6): 8, (6, 9): 30, (6, 10): 48, (6, 11): 75},
    **{(10, 7): 15, (10, 10): 58, (18, 7): 18, (18, 10): 70},
    **{(400, 6): 36, (500, 6): 40, (500, 7): 63},
}
"""Standard tolerances [um] that depart from the formula, by the upper end of the range [mm] and the grade."""
FINE_GRADES: Final[Mapping[int, tuple[float, ...]]] = {
    1: (0.8, 1, 1, 1.2, 1.5, 1.5, 2, 2.5, 3.5, 4.5, 6, 7, 8),
    2: (1.2, 1.5, 1.5, 2, 2.5, 2.5, 3, 4, 5, 7, 8, 9, 10),
    3: (2, 2.5, 2.5, 3, 4, 4, 5, 6, 8, 10, 12, 13, 15),
    4: (3, 4, 4, 5, 6, 7, 8, 10, 12, 14, 16, 18, 20),
}
"""IT1 to IT4 [um] by range. IT1 is 0.8 + 0.020 D, the others lie between IT1 and IT5 in about a geometric progression;
the standard states no rounding for them, so its table is kept."""
GRADES: Final = range(1, 19)

EXCEPTIONS: Final[Mapping[str, Mapping[int, int]]] = {
    "a": {14: 290, 24: 300, 140: 460, 180: 580, 250: 820, 355: 1200, 400: 1350},
    "b": {6: 140, 10: 150, 18: 150, 30: 160, 120: 240, 140: 260, 160: 280, 250: 420, 315: 540, 500: 840},
    "c": {
        **{3: 60, 14: 95, 18: 95, 24: 110, 30: 110, 40: 120},
        **{80: 150, 100: 170, 120: 180, 200: 240, 280: 300, 450: 440, 500: 480},
    },
    "d": {10: 40},
    "e": {100: 72, 120: 72, 355: 125, 400: 125},
    "f": {3: 6, 355: 62, 400: 62, 450: 68, 500: 68},
    "fg": {3: 4},
    "g": {3: 2},
    "k": {3: 0},
    "m": {3: 2},
    "n": {3: 4, 100: 23, 120: 23},
    "p": {
        **{3: 6, 24: 22, 30: 22, 40: 26, 50: 26, 65: 32, 80: 32, 100: 37, 120: 37, 140: 43, 160: 43, 180: 43},
        **{200: 50, 225: 50, 250: 50, 280: 56, 315: 56, 355: 62, 400: 62, 450: 68, 500: 68},
    },
    "r": {3: 10, 14: 23, 18: 23, 40: 34, 50: 34, 160: 65, 200: 77, 225: 80, 500: 132},
    "s": {3: 14, 24: 35, 30: 35, 40: 43, 50: 43},
    "t": {30: 41, 40: 48, 50: 54},
    "u": {3: 18, 6: 23, 10: 28, 14: 33, 18: 33, 24: 41, 450: 490, 500: 540},
    "v": {18: 39},
    "x": {3: 20, 6: 28, 10: 34, 14: 40, 18: 45},
    "z": {3: 26, 6: 35, 10: 42, 14: 50, 18: 60},
    "za": {3: 32, 6: 42, 10: 52},
    "zb": {3: 40, 6: 50, 18: 108, 50: 242},
    "zc": {3: 60, 6: 80},
}
"""Fundamental deviations [um, without sign] that depart from formula and rounding, by the upper end of the step [mm].
Of p the formula leaves a margin of 0 to 5 um, of s up to 50 mm one of 1 to 4 um: their values are all here."""
J_SHAFTS: Final[Mapping[int, tuple[int, ...]]] = {
    5: (-2, -2, -2, -3, -4, -5, -7, -9, -11, -13, -16, -18, -20),
    6: (-2, -2, -2, -3, -4, -5, -7, -9, -11, -13, -16, -18, -20),
    7: (-4, -4, -5, -6, -8, -10, -12, -15, -18, -21, -26, -28, -32),
}
"""Lower deviation of j by grade and range [um]: there is no formula."""
J_HOLES: Final[Mapping[int, tuple[int, ...]]] = {
    6: (2, 5, 5, 6, 8, 10, 13, 16, 18, 22, 25, 29, 33),
    7: (4, 6, 8, 10, 12, 14, 18, 22, 26, 30, 36, 39, 43),
    8: (6, 10, 12, 15, 20, 24, 28, 34, 41, 47, 55, 60, 66),
}
"""Upper deviation of J, in the same way."""
M6_OF_280_TO_315: Final = -9  # um; the one special case of the rule for holes that the standard names

OUTSIDE: Final = ("a", "b", "c", "cd", "d", "e", "ef", "f", "fg", "g", "h")
"""Letters whose shafts lie below the nominal size, and whose holes lie above it."""
LETTERS: Final = (*OUTSIDE, *("js", "j", "k", "m", "n", "p", "r", "s", "t", "u", "v", "x", "y", "z", "za", "zb", "zc"))
OF_STEPS: Final = frozenset(("a", "b", "c", "r", "s", "t", "u", "v", "x", "y", "z", "za", "zb", "zc"))
"""Letters whose D is that of an intermediate range."""
OVER: Final[Mapping[str, tuple[int, float]]] = {
    "s": (7, 0.4),
    "t": (7, 0.63),
    "u": (7, 1.0),
    "v": (7, 1.25),
    "x": (7, 1.6),
    "y": (7, 2.0),
    "z": (7, 2.5),
    "za": (8, 3.15),
    "zb": (9, 4.0),
    "zc": (10, 5.0),
}
"""A standard tolerance and a multiple of D: the lower deviation of shafts."""
BEGINS: Final[Mapping[str, float]] = {"t": 24.0, "v": 14.0, "y": 18.0}
"""Letters that the standard has only above a size [mm]."""
ENDS: Final[Mapping[str, float]] = {"cd": 10.0, "ef": 10.0, "fg": 10.0}
"""Letters that it has only up to one [mm]."""
ROUNDING: Final = (
    *((45.0, 1, 1), (60.0, 2, 1), (100.0, 5, 1), (200.0, 5, 2), (300.0, 10, 2), (560.0, 10, 5)),
    *((600.0, 20, 5), (800.0, 20, 10), (1000.0, 20, 20), (2000.0, 50, 50), (math.inf, 100, 100)),
)
"""Up to a deviation [um]: multiples to which those of a to g are rounded, and those of k to zc."""
GRADE_ROUNDING: Final = ((60.0, 1), (100.0, 1), (200.0, 5), (500.0, 10), (math.inf, 20))
"""The same of standard tolerances up to IT11."""
CLASS: Final = re.compile(r"([A-Za-z]{1,2})(0?[0-9]{1,2})")


class Limits(NamedTuple):
    """Lower and upper deviation of a size [um]."""

    lower: float
    upper: float


@lru_cache(maxsize=4096)
def limits(tolerance_class: str, size: float) -> Limits:
    """Lower and upper deviation [um] of a nominal size [mm].

    >>> limits("H7", 32.0), limits("k6", 32.0)
    (Limits(lower=0, upper=25), Limits(lower=2, upper=18))

    Args:
        tolerance_class: letters and grade; capitals for holes, small ones for shafts.
        size: above 0, up to 500 mm.

    Raises:
        InputError: no class of ISO 286, or one that it does not have for this size; the text gives the existing ones.
    """
    letter, grade = _parsed(tolerance_class)
    _refuse_size(tolerance_class, letter.lower(), grade, size)
    width = tolerance(grade, size)
    small = letter.lower()
    if small == "js":
        return Limits(-width / 2, width / 2)
    if small == "j":
        return _irregular(tolerance_class, letter, grade, size, width)
    if letter.islower():
        near = shaft_deviation(small, grade, size)
        return Limits(-near - width, -near) if small in OUTSIDE else Limits(near, near + width)
    if small in OUTSIDE:
        near = shaft_deviation(small, grade, size)
        return Limits(near, near + width)
    upper = _hole_deviation(tolerance_class, small, grade, size)
    return Limits(upper - width, upper)


def tolerance(grade: int, size: float) -> float:
    """The standard tolerance of a grade [um]: the width between both limits of a size [mm]."""
    end = _end(size, RANGES)
    if grade <= 4:
        return FINE_GRADES[grade][RANGES.index(end)]
    tabulated = TABULATED_GRADES.get((end, grade))
    if tabulated is not None:
        return tabulated
    if grade > 10:
        return 10 * tolerance(grade - 5, size)
    mean = _mean(size, RANGES)
    return _rounded(MULTIPLES[grade] * (0.45 * math.cbrt(mean) + 0.001 * mean), GRADE_ROUNDING)


def shaft_deviation(letter: str, grade: int, size: float) -> float:
    """The deviation nearest to the nominal size of a shaft [um], without sign.

    Args:
        letter: of a shaft, neither j nor js.
        grade: which decides for k alone.
        size: nominal [mm].
    """
    if letter == "h" or (letter == "k" and not 4 <= grade <= 7):
        return 0
    known = EXCEPTIONS.get(letter, {}).get(_end(size, STEPS))
    if known is not None:
        return known
    column = [(top, low if letter in OUTSIDE else high) for top, low, high in ROUNDING]
    return _rounded(_calculated(letter, size), column)


def _calculated(letter: str, size: float) -> float:
    """The deviation before rounding [um]; of r of the rounded p and s."""
    mean = _mean(size, STEPS if letter in OF_STEPS else RANGES)
    if letter in FORMULAE:
        return FORMULAE[letter](mean)
    if letter in BETWEEN:
        first, second = BETWEEN[letter]
        return math.sqrt(FORMULAE[first](mean) * FORMULAE[second](mean))
    if letter == "m":
        return tolerance(7, size) - tolerance(6, size)
    if letter == "p":
        return tolerance(7, size)
    if letter == "r":
        return math.sqrt(shaft_deviation("p", 7, size) * shaft_deviation("s", 7, size))
    if letter == "s" and size <= 50.0:
        return tolerance(8, size) + 1
    over, factor = OVER[letter]
    return tolerance(over, size) + factor * mean


FORMULAE: Final[Mapping[str, Callable[[float], float]]] = {
    "a": lambda mean: 265 + 1.3 * mean if mean <= 120 else 3.5 * mean,
    "b": lambda mean: 140 + 0.85 * mean if mean <= 160 else 1.8 * mean,
    "c": lambda mean: 52 * mean**0.2 if mean <= 40 else 95 + 0.8 * mean,
    "d": lambda mean: 16 * mean**0.44,
    "e": lambda mean: 11 * mean**0.41,
    "f": lambda mean: 5.5 * mean**0.41,
    "g": lambda mean: 2.5 * mean**0.34,
    "k": lambda mean: 0.6 * math.cbrt(mean),
    "n": lambda mean: 5 * mean**0.34,
}
"""Deviations [um] of the mean of the range [mm]."""
BETWEEN: Final[Mapping[str, tuple[str, str]]] = {"cd": ("c", "d"), "ef": ("e", "f"), "fg": ("f", "g")}
"""Deviations that are the geometric mean of two others."""


def _hole_deviation(tolerance_class: str, small: str, grade: int, size: float) -> float:
    """Upper deviation [um] of a hole from K to ZC, above 3 mm by the special rule: as a shaft of the finer grade fits.

    ISO 286-1: K, M, N up to IT8 and P to ZC up to IT7 have the deviation of the shaft and IT(n) - IT(n - 1) more.
    """
    if small == "k" and grade > 8 and size > 3.0:
        raise InputError(f"expected a grade up to 8 of K above 3 mm, got {tolerance_class}; ISO 286 has none")
    if small == "n" and grade > 8 and size > 3.0:
        return 0
    near = shaft_deviation(small, 7 if small == "k" else grade, size)
    if size <= 3.0 or grade > (8 if small in ("k", "m", "n") else 7):
        return -near
    if grade < 3:
        raise InputError(f"expected a grade from 3 of {small.upper()}, got {tolerance_class}; ISO 286 has none")
    if small == "m" and grade == 6 and 250.0 < size <= 315.0:
        return M6_OF_280_TO_315
    return -near + tolerance(grade, size) - tolerance(grade - 1, size)


def _irregular(tolerance_class: str, letter: str, grade: int, size: float, width: float) -> Limits:
    """Limits of j and J, which ISO 286 states one by one."""
    table = J_SHAFTS if letter.islower() else J_HOLES
    if grade not in table:
        words = f"expected {letter} with a grade of {', '.join(map(str, table))}, got {tolerance_class}"
        raise InputError(f"{words}; no formula covers {letter}, and the table of ISO 286 has no others (js has all)")
    near = table[grade][RANGES.index(_end(size, RANGES))]
    return Limits(near, near + width) if letter.islower() else Limits(near - width, near)


def _parsed(text: str) -> tuple[str, int]:
    match = CLASS.fullmatch(text)
    if "/" in text:
        raise InputError(f"expected one class, such as H7 or g6, got {text!r}; write hole and shaft each by itself")
    if match is None:
        raise InputError(f"expected letters and a grade, such as H7 or g6, got {text!r}")
    letter = match[1]
    if letter.lower() not in LETTERS or not (letter.islower() or letter.isupper()):
        known = ", ".join(LETTERS)
        raise InputError(f"expected letters of ISO 286, {known} (capitals for holes), got {letter!r} in {text!r}")
    if match[2] in ("0", "01"):
        raise InputError(f"expected a grade from 1 to 18, got {match[2]!r} in {text!r}; IT0 and IT01 are not covered")
    if int(match[2]) not in GRADES:
        raise InputError(f"expected a grade from 1 to 18, got {match[2]!r} in {text!r}")
    return letter, int(match[2])


def _refuse_size(tolerance_class: str, small: str, grade: int, size: float) -> None:
    if not 0.0 < size <= LARGEST_SIZE:
        raise InputError(
            f"expected a size above 0 and up to 500 mm of {tolerance_class}, got {size:g} mm; "
            "larger ones have other formulae, which are not covered: write the limits"
        )
    if size <= LEAST_OF_ALL_CLASSES and (small in ("a", "b") or grade >= 14 or (small == "n" and grade > 8)):
        raise InputError(f"expected a size above 1 mm of {tolerance_class}, got {size:g} mm; ISO 286 has none below")
    if size <= BEGINS.get(small, 0.0):
        words = f"expected a size above {BEGINS[small]:g} mm of {tolerance_class}, got {size:g} mm"
        raise InputError(f"{words}; ISO 286 has none below")
    if size > ENDS.get(small, LARGEST_SIZE):
        words = f"expected a size up to {ENDS[small]:g} mm of {tolerance_class}, got {size:g} mm"
        raise InputError(f"{words}; ISO 286 has none above")


def _end(size: float, ends: tuple[int, ...]) -> int:
    return next(end for end in ends if size <= end)


def _mean(size: float, ends: tuple[int, ...]) -> float:
    """Geometric mean of the range that a size lies in [mm]; of the first one from 1 mm."""
    place = ends.index(_end(size, ends))
    return math.sqrt((ends[place - 1] if place else 1) * ends[place])


def _rounded(value: float, steps: tuple[tuple[float, int], ...] | list[tuple[float, int]]) -> float:
    return half_up(value, next(step for top, step in steps if value <= top))
