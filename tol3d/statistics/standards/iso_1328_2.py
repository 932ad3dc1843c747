"""ISO 1328-2:1997: run-out and radial composite deviations of cylindrical gears, by accuracy grade.

The standard was not at hand: its formulae of grade 5 are as a published calculator states them, and F_i'' = F_r + f_i''
holds between them term by term. m and d in them are the geometric means of the ranges that module and reference
diameter lie in; a grade more is sqrt(2) as much. Values are rounded to whole micrometres, up to 10 um to halves. The
edition of 2020 has other classes (R30 to R50), whose formulae are not here.
"""

import math
from collections.abc import Callable, Mapping
from typing import Final, NamedTuple

from tol3d.errors import InputError
from tol3d.statistics.standards import half_up

DIAMETERS: Final = (5.0, 20.0, 50.0, 125.0, 280.0, 560.0, 1000.0, 1600.0, 2500.0, 4000.0, 6000.0, 8000.0, 10000.0)
"""Ends of the ranges of reference diameters [mm]; those of composite deviations end at 1000."""
MODULES: Final = (0.5, 2.0, 3.5, 6.0, 10.0, 16.0, 25.0, 40.0, 70.0)
"""Ends of the ranges of modules for F_r [mm]."""
FINE_MODULES: Final = (0.2, 0.5, 0.8, 1.0, 1.5, 2.5, 4.0, 6.0, 10.0)
"""The same for composite deviations."""


class Kind(NamedTuple):
    """A deviation: its grades, its ranges [mm], and its tolerance of grade 5 [um] by m and d [mm]."""

    grades: range
    modules: tuple[float, ...]
    diameters: tuple[float, ...]
    of_grade_5: Callable[[float, float], float]


KINDS: Final[Mapping[str, Kind]] = {
    "F_r": Kind(range(13), MODULES, DIAMETERS, lambda m, d: 0.24 * m + 1.0 * math.sqrt(d) + 5.6),
    "F_i''": Kind(range(4, 13), FINE_MODULES, DIAMETERS[:7], lambda m, d: 3.2 * m + 1.01 * math.sqrt(d) + 6.4),
    "f_i''": Kind(range(4, 13), FINE_MODULES, DIAMETERS[:7], lambda m, d: 2.96 * m + 0.01 * math.sqrt(d) + 0.8),
}


def tolerance(deviation: str, grade: int, module: float, diameter: float) -> float:
    """The largest deviation that a grade allows [um].

    >>> tolerance("F_r", 5, module=1.0, diameter=10.0), tolerance("F_i''", 6, module=0.3, diameter=10.0)
    (9.0, 15.0)

    Args:
        deviation: a key of KINDS.
        grade: 0 to 12 of F_r, 4 to 12 of the others.
        module: m [mm].
        diameter: d, of the reference circle [mm].

    Raises:
        InputError: none of them, or a gear outside the ranges; the text says what there is.
    """
    kind = KINDS.get(deviation)
    if kind is None:
        raise InputError(f"expected {', '.join(KINDS)} of ISO 1328-2, got {deviation!r}")
    if grade not in kind.grades:
        words = f"expected a grade of {deviation} from {kind.grades[0]} to {kind.grades[-1]} of ISO 1328-2:1997"
        raise InputError(f"{words}, got {grade} (R classes of 2020 are not in tol3d: write the limit)")
    means = []
    for word, value, ends in (("module", module, kind.modules), ("diameter", diameter, kind.diameters)):
        if not ends[0] <= value <= ends[-1]:
            words = f"expected a {word} from {ends[0]:g} to {ends[-1]:g} mm, got {value:g} mm"
            raise InputError(f"{words}; ISO 1328-2 has no {deviation} of others: write the limit")
        place = max(sum(value > end for end in ends), 1)
        means.append(math.sqrt(ends[place - 1] * ends[place]))
    value = kind.of_grade_5(*means) * math.sqrt(2.0) ** (grade - 5)
    return half_up(value, 1.0 if value > 10.0 else 0.5)
